"""Disparity files: what other readers see in them."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from vista.disparity_file import write_disparity
from vista.errors import InputError


def every_word() -> np.ndarray:
    """Each word that an engine of 256 disparities can give, and invalid ones."""
    words = np.concatenate([np.full(8, -16), np.arange(0, 256 * 16)])
    return np.random.default_rng(0).permutation(words).astype(np.int16).reshape(108, 38)


def test_png_is_kittis(tmp_path: Path) -> None:
    write_disparity(tmp_path / "d.png", np.array([[-16, 0, 1, 24]], np.int16))
    levels = cv2.imread(str(tmp_path / "d.png"), cv2.IMREAD_UNCHANGED)
    assert levels.dtype == np.uint16
    assert levels.tolist() == [[0, 1, 16, 384]]  # invalid, zero, 1/16 px, 1.5 px
    assert [path.name for path in tmp_path.iterdir()] == ["d.png"]


def test_pfm_as_opencv_reads_it(tmp_path: Path) -> None:
    words = every_word()
    write_disparity(tmp_path / "d.pfm", words)
    seen = cv2.imread(str(tmp_path / "d.pfm"), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(seen, np.where(words < 0, np.inf, words / 16).astype(np.float32))


def test_npy_is_int16(tmp_path: Path) -> None:
    write_disparity(tmp_path / "d.npy", every_word())
    seen = np.load(tmp_path / "d.npy")
    assert seen.dtype == np.int16
    np.testing.assert_array_equal(seen, every_word())


def test_other_endings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"d\.tif: disparity files end in"):
        write_disparity(tmp_path / "d.tif", every_word())


def test_an_unwritable_target_leaves_nothing_behind(tmp_path: Path) -> None:
    (tmp_path / "d.png").mkdir()
    with pytest.raises(InputError, match=r"d\.png: cannot be written"):
        write_disparity(tmp_path / "d.png", every_word())
    with pytest.raises(InputError, match="cannot be written: no such file"):
        write_disparity(tmp_path / "missing" / "d.png", every_word())
    assert [p.name for p in tmp_path.iterdir()] == ["d.png"]
