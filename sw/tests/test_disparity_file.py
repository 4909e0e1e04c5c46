"""Disparity files: round trips, and what other readers see in them."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from vista.disparity_file import read_disparity, write_disparity
from vista.errors import InputError

FORMATS = [".png", ".pfm", ".npy"]


def every_word() -> np.ndarray:
    """Each word that an engine of 256 disparities can give, and invalid ones."""
    words = np.concatenate([np.full(8, -16), np.arange(0, 256 * 16)])
    return np.random.default_rng(0).permutation(words).astype(np.int16).reshape(108, 38)


@pytest.mark.parametrize("extension", FORMATS)
def test_round_trip_is_exact(tmp_path: Path, extension: str) -> None:
    path = tmp_path / f"disparity{extension}"
    write_disparity(path, every_word())
    np.testing.assert_array_equal(read_disparity(path), every_word())
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_png_is_kittis(tmp_path: Path) -> None:
    write_disparity(tmp_path / "d.png", np.array([[-16, 0, 1, 24]], np.int16))
    levels = cv2.imread(str(tmp_path / "d.png"), cv2.IMREAD_UNCHANGED)
    assert levels.dtype == np.uint16
    assert levels.tolist() == [[0, 1, 16, 384]]  # invalid, zero, 1/16 px, 1.5 px


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


def test_big_endian_pfm_is_read(tmp_path: Path) -> None:
    pixels = np.array([[1.5, np.inf], [np.nan, 0.0]], ">f4")
    (tmp_path / "d.pfm").write_bytes(b"Pf\n2 2\n1.0\n" + pixels[::-1].tobytes())
    assert read_disparity(tmp_path / "d.pfm").tolist() == [[24, -16], [-16, 0]]


@pytest.mark.parametrize("extension", FORMATS)
def test_damaged_files_are_refused(tmp_path: Path, extension: str) -> None:
    path = tmp_path / f"d{extension}"
    with pytest.raises(InputError, match="no such file"):
        read_disparity(path)
    for content in (b"", b"hello"):
        path.write_bytes(content)
        with pytest.raises(InputError, match=f"d{extension}: (not a|empty)"):
            read_disparity(path)
    write_disparity(path, every_word())
    path.write_bytes(path.read_bytes()[:-50])
    with pytest.raises(InputError):
        read_disparity(path)


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
