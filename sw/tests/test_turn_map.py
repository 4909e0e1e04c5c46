"""The map of a camera that has turned, and the correction that makes it in parts (vista/correction.h)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import turned_camera as turned
from random_seed import seeded
from stage_library import ffi, lib, status_name
from turned_camera import degrees
from turned_recordings import CAMERA, RAW
from vista.alignment import Turn
from vista.detector import c_raw_camera
from vista.geometry import camera_matrix
from vista.rectify import Map, Rectifier, exact_map
from vista.sequence.pairs import read_calibration_file
from vista.structs import c_camera

PARTS = 4


@pytest.fixture
def rectifier(tmp_path: Any, request: pytest.FixtureRequest) -> Rectifier:
    path = tmp_path / "calibration.toml"
    path.write_text(RAW[request.param])
    return Rectifier(read_calibration_file(path, (CAMERA.width, CAMERA.height)).calibration)


def places(of: Map) -> np.ndarray:
    """1/32 px of the raw image."""
    return 32 * of[0].astype(int) + np.stack([of[1] % 32, of[1] // 32], -1)


@pytest.mark.parametrize("rectifier", RAW, indirect=True)
def test_the_map_is_that_of_opencv(rectifier: Rectifier) -> None:
    """It is, up to a rounding, seldom: processors order the sums of OpenCV differently."""
    random, camera = seeded(1), rectifier.calibration
    P = np.zeros((3, 4))
    P[:, :3] = camera_matrix(camera.focal_px, camera.focal_px, camera.cx, camera.cy)
    for turn in (Turn(), *(degrees(*random.uniform(-2.0, 2.0, 2)) for _ in range(5))):
        R = turn.rotation().T @ rectifier.right.rectified_from_raw
        off = np.abs(
            places(turned.turned_map(rectifier, turn)) - places(exact_map(rectifier.right.model, R, P))
        )
        assert off.max() <= 1 and np.mean(off > 0) < 1e-3


@pytest.mark.parametrize("rectifier", ["radial"], indirect=True)
def test_a_map_takes_effect_when_it_is_whole(rectifier: Rectifier) -> None:
    """The first correction is found with the fifth pair; until its map is made nothing changes."""
    pairs, turn = turned.textured_flight(rectifier.calibration, seeded(2)), degrees(0.5, 0.0)
    corrector, changed = turned.Corrector(rectifier), []
    for k in range(12):
        left, right = pairs(k)
        before = corrector.applied
        right = turned.seen(right, rectifier.calibration, turn, before)
        found = corrector.update(left, right, 1 + 40_000_000 * k, rectified=True).alignment
        assert found.changed == (corrector.applied != before)
        if found.changed:
            changed.append(k)
    assert changed[0] == 4 + PARTS - 1
    assert corrector.applied.pitch_deg == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("rectifier", ["radial"], indirect=True)
@pytest.mark.parametrize(
    ("member", "value", "status"),
    [
        ("lens", 2, "VISTA_ERROR_NUMBER"),
        ("focal_u_px", 0.0, "VISTA_ERROR_NUMBER"),
        ("center_v_px", np.nan, "VISTA_ERROR_NUMBER"),
        ("distortion", [np.inf], "VISTA_ERROR_NUMBER"),
        ("distortion", [1e300] * 8, "VISTA_OK"),  # seen nowhere, which is no error
        ("rectified_from_raw", [0.0] * 9, "VISTA_OK"),
    ],
)
def test_cameras_that_are_none_are_refused(
    rectifier: Rectifier, member: str, value: Any, status: str
) -> None:
    raw, camera = c_raw_camera(ffi, rectifier.right), c_camera(ffi, rectifier.calibration)
    setattr(raw, member, value)
    height, width = rectifier.calibration.height, rectifier.calibration.width
    whole, fraction = ffi.new("int16_t[]", 2 * height * width), ffi.new("uint16_t[]", height * width)
    turn = ffi.new("vista_turn *", (0.01, 0.0))
    assert status_name(lib.vista_turn_map(turn, camera, raw, 0, height, whole, fraction)) == status
    assert max(fraction) < 1024


@pytest.mark.parametrize("rectifier", ["radial"], indirect=True)
def test_only_the_rows_asked_for_are_written(rectifier: Rectifier) -> None:
    raw, camera = c_raw_camera(ffi, rectifier.right), c_camera(ffi, rectifier.calibration)
    height, width = rectifier.calibration.height, rectifier.calibration.width
    all_of = turned.turned_map(rectifier, degrees(0.3, 0.1))
    found = np.full((height, width, 2), 7777, np.int16), np.full((height, width), 7777, np.uint16)
    turn = degrees(0.3, 0.1)
    rows = (ffi.from_buffer("int16_t[]", found[0]), ffi.from_buffer("uint16_t[]", found[1]))
    c_turn = ffi.new("vista_turn *", (turn.pitch_rad, turn.roll_rad))
    assert lib.vista_turn_map(c_turn, camera, raw, 50, 60, *rows) == lib.VISTA_OK
    for part, whole in zip(found, all_of, strict=True):
        np.testing.assert_array_equal(part[50:60], whole[50:60])
        assert (part[:50] == 7777).all() and (part[60:] == 7777).all()
    for first, end in ((-1, 5), (5, height + 1), (6, 5)):
        assert status_name(lib.vista_turn_map(c_turn, camera, raw, first, end, *rows)) == "VISTA_ERROR_RANGE"


def test_memory_of_any_alignment_is_enough_and_less_is_refused() -> None:
    values = ffi.new("vista_parameters *")
    lib.vista_parameters_init(values, ffi.sizeof(values[0]))
    camera, size = c_camera(ffi, CAMERA), ffi.new("size_t *")
    right = ffi.new("vista_right_rectification *")
    right.raw.focal_u_px = right.raw.focal_v_px = 300.0
    right.raw.rectified_from_raw = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert lib.vista_correction_bytes(values, camera, right, size) == lib.VISTA_OK
    memory, made = ffi.new("unsigned char[]", size[0] + 64), ffi.new("vista_correction **")
    for offset in (0, 1, 63):
        place = memory + offset
        assert lib.vista_correction_create(place, size[0], values, camera, right, made) == lib.VISTA_OK
    few = lib.vista_correction_create(memory, size[0] // 2, values, camera, right, made)
    assert status_name(few) == "VISTA_ERROR_MEMORY"
    grid = ffi.new("int16_t[]", 4)
    right.grid, right.columns, right.rows = grid, 1, 2
    assert status_name(lib.vista_correction_bytes(values, camera, right, size)) == "VISTA_ERROR_SIZE"
