"""Pairs whose right camera has turned against its calibration, and a run that corrects it, for tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import native, parameters
from vista.alignment import Alignment, Turn
from vista.control_grid import Grid
from vista.detector import Detector, c_raw_camera
from vista.engine import INVALID
from vista.engine.hardware import level_shapes
from vista.geometry import Calibration, camera_matrix, rectified_rig
from vista.pipeline import c_parameters
from vista.rectify import Map, Rectifier, by_table
from vista.sequence import Frame
from vista.structs import c_camera, c_image

Grey = NDArray[np.uint8]
Pairs = Callable[[int], tuple[Grey, Grey]]  # number of a frame -> left and right image
RATE_HZ = 25.0


def degrees(pitch: float, roll: float) -> Turn:
    return Turn(math.radians(pitch), math.radians(roll))


def homography(camera: Calibration, turn: Turn) -> NDArray[np.float64]:
    """Maps pixels of the right camera as calibrated to those of the one that has turned."""
    K = camera_matrix(camera.focal_px, camera.focal_px, camera.cx, camera.cy)
    return np.asarray(K @ turn.rotation() @ np.linalg.inv(K), np.float64)


def seen(right: Grey, camera: Calibration, turn: Turn, applied: Turn | None = None) -> Grey:
    """What a camera that has turned shows in place of `right`, after it was rectified for `applied`."""
    there = np.linalg.inv(homography(camera, turn)) @ homography(camera, applied or Turn())
    if np.allclose(there / there[2, 2], np.eye(3), atol=1e-12):
        return right
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    moved = cv2.warpPerspective(right, there, right.shape[::-1], flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(moved, np.uint8)


def turned_map(rectifier: Rectifier, turn: Turn) -> Map:
    """The whole map of the right camera, as libvista makes it."""
    ffi, lib = native.load("vista")
    camera = rectifier.calibration
    whole = np.empty((camera.height, camera.width, 2), np.int16)
    fraction = np.empty((camera.height, camera.width), np.uint16)
    status = lib.vista_turn_map(
        ffi.new("vista_turn *", (turn.pitch_rad, turn.roll_rad)),
        c_camera(ffi, camera),
        c_raw_camera(ffi, rectifier.right),
        0,
        camera.height,
        ffi.from_buffer("int16_t[]", whole),
        ffi.from_buffer("uint16_t[]", fraction),
    )
    assert status == lib.VISTA_OK
    return whole, fraction


def turned_grid(rectifier: Rectifier, turn: Turn) -> Grid:
    """The control grid of the right camera, from that of its calibration."""
    ffi, lib = native.load("vista")
    assert rectifier.grids is not None
    calibrated = np.ascontiguousarray(rectifier.grids.right)
    turned = np.empty_like(calibrated)
    rows, columns, _ = calibrated.shape
    status = lib.vista_turn_grid(
        ffi.new("vista_turn *", (turn.pitch_rad, turn.roll_rad)),
        c_camera(ffi, rectifier.calibration),
        ffi.from_buffer("int16_t[]", calibrated),
        columns,
        rows,
        ffi.from_buffer("int16_t[]", turned),
    )
    assert status == lib.VISTA_OK
    return turned


def rectified_right(rectifier: Rectifier, turn: Turn, image: Grey) -> Grey:
    """A right image, rectified for a camera that has turned."""
    make = turned_map if rectifier.grids is None else turned_grid
    return by_table(make(rectifier, turn))(image)


def rows_left_px(camera: Calibration, turn: Turn, applied: Turn) -> NDArray[np.float64]:
    """The error of the rows, which is known, all over the image once it is rectified for `applied`."""
    v, u = np.mgrid[0 : camera.height : 16, 0 : camera.width : 16].astype(float)
    points = (
        np.stack([u, v, np.ones_like(u)], -1)
        @ (np.linalg.inv(homography(camera, applied)) @ homography(camera, turn)).T
    )
    return np.abs(points[..., 1] / points[..., 2] - v).ravel()


@dataclass(frozen=True)
class Corrected:
    """A frame, and how its right image was rectified."""

    frame: Frame  # rectified
    applied: Turn
    alignment: Alignment


def time_ns(frame: int) -> int:
    return round(1e9 * (1.0 + frame / RATE_HZ))


def correcting(values: parameters.Values | None = None, buffer_rows: int = 0) -> parameters.Values:
    """The values with the correction, for a rectification that buffers so many rows."""
    values = values or parameters.defaults()
    return values | {
        "alignment": values["alignment"] | {"correct": "on"},
        "stereo": values["stereo"] | {"rectify_rows": buffer_rows},
    }


class Estimator:
    """Finds the turn of the right camera of one pair, from one pair of images to the next."""

    def __init__(self, camera: Calibration, values: parameters.Values | None = None) -> None:
        """ValueError for images that are too small."""
        self._ffi, self._lib = ffi, lib = native.load("vista")
        c_values = c_parameters(ffi, lib, values or parameters.defaults())
        camera_c = c_camera(ffi, camera)
        size = ffi.new("size_t *")
        self._check(lib.vista_alignment_bytes(c_values, camera_c, size))
        self._memory = ffi.new("unsigned char[]", size[0])
        handle = ffi.new("vista_alignment **")
        self._check(lib.vista_alignment_create(self._memory, size[0], c_values, camera_c, handle))
        self._alignment = handle[0]
        self._result = ffi.new("vista_alignment_result *")

    def reset(self) -> None:
        """Forgets everything but the calibration."""
        self._lib.vista_alignment_reset(self._alignment)

    def update(
        self, left: NDArray[np.uint8], right: NDArray[np.uint8], t_ns: int, applied: Turn
    ) -> Alignment:
        """A rectified pair; applied: what its right image was rectified for. ValueError for images of another
        size and times that do not increase."""
        turn = self._ffi.new("vista_turn *", (applied.pitch_rad, applied.roll_rad))
        whole = [np.ascontiguousarray(image) for image in (left, right)]
        images = [c_image(self._ffi, image) for image in whole]
        status = self._lib.vista_alignment_update(self._alignment, *images, t_ns, turn, self._result)
        self._check(status)
        return Alignment.copied(self._ffi, self._result)

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)


class Corrector:
    """The detector as far as the correction goes: nothing is matched."""

    def __init__(self, rectifier: Rectifier, values: parameters.Values | None = None) -> None:
        camera, values = rectifier.calibration, correcting(values)
        self.detector, self.applied = Detector(rectifier, values), Turn()
        shapes = level_shapes((camera.height, camera.width), values["stereo"]["levels"])
        self._blank = [np.full(shape, INVALID, np.int16) for shape in shapes]
        self._frames = 0

    def update(self, left: Grey, right: Grey, t_ns: int, rectified: bool = False) -> Corrected:
        self.detector.take(left, right, t_ns, rectified=rectified)
        self.detector.match(self._blank)
        pair = self.detector.pair()
        frame = Frame(self._frames, t_ns, pair.left, pair.right, None)
        self.detector.judge(None, None)
        alignment, applied = self.detector.alignment, self.applied
        assert alignment is not None
        self.applied = alignment.correction
        self._frames += 1
        return Corrected(frame, applied, alignment)


def flown(
    rectifier: Rectifier, pairs: Pairs, frames: int, values: parameters.Values | None = None
) -> Iterator[Corrected]:
    """What the detector does with raw pairs, as far as the correction goes."""
    corrector = Corrector(rectifier, values)
    for k in range(frames):
        yield corrector.update(*pairs(k), time_ns(k))


def corrected(
    camera: Calibration,
    pairs: Pairs,
    turn_at: Callable[[int], Turn],
    frames: int,
    values: parameters.Values | None = None,
    change: Callable[[int, Grey, Grey], tuple[Grey, Grey]] | None = None,
) -> Iterator[Corrected]:
    """Corrects rectified pairs. change: what else becomes of the images before they are read."""

    def taken(k: int) -> tuple[Grey, Grey]:
        left, right = pairs(k)
        right = seen(right, camera, turn_at(k))
        return (left, right) if change is None else change(k, left, right)

    return flown(Rectifier(rectified_rig(camera, "")), taken, frames, values)


def textured_flight(camera: Calibration, random: np.random.Generator, speed_px: int = 3) -> Pairs:
    """Texture, slanted like ground below and like a wall above, that moves by so many pixels a frame."""
    height, width = camera.height, camera.width
    wide = width + 400
    canvas = sum(
        weight * cv2.GaussianBlur(random.normal(size=(height, wide)), (0, 0), sigma) * sigma
        for sigma, weight in ((1.5, 60.0), (4.0, 120.0), (12.0, 120.0))
    )
    canvas = np.clip(128.0 + canvas, 0, 255).astype(np.float32)
    v, u = np.mgrid[:height, :width].astype(np.float32)
    disparity = np.where(v > 0.5 * height, 4.0 + 0.15 * (v - 0.5 * height), 10.0 + 0.02 * u).astype(
        np.float32
    )

    def pair(k: int) -> tuple[Grey, Grey]:
        start = 150 + speed_px * k % 200
        right = np.rint(canvas[:, start : start + width]).astype(np.uint8)
        left = cv2.remap(canvas, u - disparity + start, v, cv2.INTER_CUBIC)
        return np.clip(np.rint(left), 0, 255).astype(np.uint8), right

    return pair
