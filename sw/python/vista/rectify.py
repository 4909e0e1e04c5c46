"""Rectifies raw pairs, so that matching pixels lie on one row: exactly, or as hardware does it."""

from __future__ import annotations

import dataclasses
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista import native
from vista.control_grid import BUFFER_ROWS, Filter, Grid, GridPair, check_rows, control_grid
from vista.errors import InputError
from vista.fisheye import rectified_fisheyes
from vista.geometry import Array, Calibration, CameraModel, Pose, RawCalibration
from vista.lens import rectifying_map
from vista.sequence.types import Frame
from vista.structs import c_image

Map = tuple[
    NDArray[np.int16], NDArray[np.uint16]
]  # cv2's fixed-point form: faster, and the same on every machine

LENSES = ("pinhole", "fisheye")  # as vista_lens numbers them
DISTORTION_MOST = 8  # numbers of a lens in C

MAX_ZOOM = (
    4.0  # what rectification may crop to or shrink by; more comes from a wrong number in the calibration
)
MIN_COS_BETWEEN_AXES = 0.5  # optical axes within 60 degrees: else the two views hardly overlap


@dataclasses.dataclass(frozen=True)
class RawCamera:
    """One camera as calibrated, with the rotation of its rectification; vista_raw_camera in C."""

    model: CameraModel
    rectified_from_raw: Array  # (3, 3)

    @property
    def intrinsics_px(self) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy."""
        K = self.model.matrix
        return float(K[0, 0]), float(K[1, 1]), float(K[0, 2]), float(K[1, 2])

    @property
    def distortion(self) -> list[float]:
        """All numbers that C has room for."""
        given = list(self.model.distortion)
        return given + [0.0] * (DISTORTION_MOST - len(given))

    @property
    def lens(self) -> int:
        return LENSES.index(self.model.lens)


class Rectifier:
    """Rectifies every frame of one calibration.

    calibration: of the rectified pair, same size as the input.
    is_passthrough: the input is rectified already (no distortion, equal cameras, aligned rows); frames then
    come back as they are, not resampled.
    grids: what rectifies them, if control grids do.
    buffer_rows: of the line buffer that it was made for; 0: none.
    maps: of the left and the right image as calibrated, if whole maps do.
    right: the right camera as calibrated.
    left_from_rectified: the rotation of the rectified left camera in the raw one.
    """

    def __init__(self, raw: RawCalibration, buffer_rows: int = 0) -> None:
        """Raises InputError when the cameras make no left-right pair, or none that can be rectified.

        buffer_rows: 0 rectifies by whole maps; otherwise a control grid does it, as in hardware whose line
        buffer holds so many rows, and what needs more of them is refused.
        """
        if buffer_rows not in (0, *BUFFER_ROWS):
            allowed = ", ".join(map(str, BUFFER_ROWS))
            raise InputError("stereo.rectify_rows", f"must be 0 or one of {allowed}, not {buffer_rows}")
        check_side_by_side(raw)
        self.buffer_rows = buffer_rows
        self.grids: GridPair | None = None
        self.maps: tuple[Map, ...] = ()
        self._left: Filter = _unchanged
        self._right: Filter = _unchanged
        self.is_passthrough = _is_rectified(raw)
        if self.is_passthrough:
            self.left_from_rectified = Pose()
            self.calibration = _calibration(
                raw.left, raw.left.matrix, -float(raw.right_from_left.translation_m[0])
            )
            self.right = RawCamera(raw.right, np.eye(3))
            return
        left, right = rectified_cameras(raw)
        cameras = ((raw.left, *left), (raw.right, *right))
        self.right = RawCamera(raw.right, right[0])
        if buffer_rows == 0:
            self.maps = tuple(exact_map(camera, R, P) for camera, R, P in cameras)
            self._left, self._right = (by_table(source) for source in self.maps)
        else:
            grids = [_fitting_grid(camera, R, P, buffer_rows, raw.source) for camera, R, P in cameras]
            size = raw.left.width, raw.left.height
            self.grids = GridPair(grids[0], grids[1], size, buffer_rows)
            self._left, self._right = (by_table(grid) for grid in grids)
        self.left_from_rectified = Pose(left[0].T)
        self.calibration = _calibration(raw.left, left[1], float(-right[1][0, 3] / right[1][0, 0]))

    @property
    def grids_or_maps(self) -> tuple[Grid, ...] | tuple[Map, ...]:
        """What rectifies the left and the right image as calibrated; empty where they come rectified."""
        grids = self.grids
        return self.maps if grids is None else (grids.left, grids.right)

    def rectify(self, frame: Frame) -> Frame:
        """The rectified pair, with the pose of the rectified left camera."""
        if self.is_passthrough:
            return frame
        pose = frame.world_from_camera
        return dataclasses.replace(
            frame,
            left=self._left(frame.left),
            right=self._right(frame.right),
            world_from_camera=None if pose is None else pose @ self.left_from_rectified,
        )


def rectified_cameras(raw: RawCalibration) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Rotation and projection of the rectified left camera, and of the right one.

    InputError when the images would be zoomed beyond reason."""
    if "fisheye" in (raw.left.lens, raw.right.lens):
        return rectified_fisheyes(raw)
    # alpha = 0: zoomed until no pixel lies outside the raw images, where it would be matched as texture.
    R_left, R_right, P_left, P_right = (
        np.asarray(matrix, np.float64)
        for matrix in cv2.stereoRectify(
            raw.left.matrix,
            np.array(raw.left.distortion),
            raw.right.matrix,
            np.array(raw.right.distortion),
            (raw.left.width, raw.left.height),
            raw.right_from_left.rotation,
            raw.right_from_left.translation_m.reshape(3, 1),
            flags=cv2.CALIB_ZERO_DISPARITY,
            alpha=0,
        )[:4]
    )
    zoom = P_left[0, 0] / raw.left.matrix[0, 0]
    if not (np.all(np.isfinite([P_left, P_right])) and 1.0 / MAX_ZOOM < zoom < MAX_ZOOM):
        raise InputError(raw.source, f"cannot be rectified: the image would be zoomed {zoom:.3g} times")
    return (R_left, P_left), (R_right, P_right)


def check_side_by_side(raw: RawCalibration) -> None:
    """Raises InputError for cameras that make no left-right pair."""
    # The right camera's centre in the left camera's frame: c = -R^T t.
    centre_m = raw.right_from_left.inverse().translation_m
    if not np.any(centre_m):
        raise InputError(raw.source, "baseline is 0 m, must be positive")
    if centre_m[0] <= max(abs(centre_m[1]), abs(centre_m[2])):
        x, y, z = centre_m
        raise InputError(
            raw.source, f"the right camera lies at ({x:g}, {y:g}, {z:g}) m, not right of the left camera"
        )
    if raw.right_from_left.rotation[2, 2] < MIN_COS_BETWEEN_AXES:
        raise InputError(raw.source, "the cameras look in different directions")
    if (raw.left.width, raw.left.height) != (raw.right.width, raw.right.height):
        raise InputError(raw.source, "the left and the right image differ in size")


def _is_rectified(raw: RawCalibration) -> bool:
    """Deviations that move no pixel by more than a hundredth count as none: calibrations carry rounding."""
    left, right, motion = raw.left, raw.right, raw.right_from_left
    tolerance_px = 0.01
    tolerance_rad = tolerance_px / float(left.matrix[0, 0])
    off_axis = np.abs(motion.translation_m[1:]) / abs(motion.translation_m[0])
    return bool(
        left.lens == right.lens == "pinhole"
        and not any(left.distortion)
        and not any(right.distortion)
        and np.allclose(left.matrix, right.matrix, rtol=0.0, atol=tolerance_px)
        and abs(left.matrix[0, 0] - left.matrix[1, 1]) <= tolerance_px
        and np.allclose(motion.rotation, np.eye(3), atol=tolerance_rad)
        and np.all(off_axis <= tolerance_rad)
    )


def _calibration(camera: CameraModel, K: Array, baseline_m: float) -> Calibration:
    return Calibration(
        camera.width, camera.height, float(K[0, 0]), float(K[0, 2]), float(K[1, 2]), baseline_m
    )


def _unchanged(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return image


def _fitting_grid(camera: CameraModel, R: Array, P: Array, buffer_rows: int, source: str) -> Grid:
    grid = control_grid(camera, R, P, source)
    check_rows(grid, (camera.width, camera.height), buffer_rows, source)
    return grid


def exact_map(camera: CameraModel, R: Array, P: Array) -> Map:
    """The place of each rectified pixel in the raw image: whole pixels, and index of the fractions."""
    whole, fraction = rectifying_map(camera, R, P, (camera.width, camera.height), cv2.CV_16SC2)
    return np.asarray(whole, np.int16), np.asarray(fraction, np.uint16)


def by_table(table: Map | Grid) -> Filter:
    """Rectifies one image after the other by a map or a control grid, as libvista does it (vista/rig.h)."""
    ffi, lib = native.load("vista")
    c_table = ffi.new("vista_right_table *")
    if isinstance(table, tuple):
        whole, fraction = (np.ascontiguousarray(part) for part in table)
        c_table.whole, c_table.fraction = (
            ffi.from_buffer("int16_t[]", whole),
            ffi.from_buffer("uint16_t[]", fraction),
        )
        kept: tuple[NDArray[Any], ...] = (whole, fraction)  # C goes on reading them
    else:
        kept = (np.ascontiguousarray(table),)
        c_table.grid = ffi.from_buffer("int16_t[]", kept[0])

    def rectify(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        assert kept
        image = np.ascontiguousarray(image)
        height, width = image.shape
        out = np.empty_like(image)
        camera = ffi.new("vista_camera *", {"width_px": width, "height_px": height})
        status = lib.vista_rectify(camera, c_table, c_image(ffi, image), ffi.from_buffer("uint8_t[]", out))
        native.check(ffi, lib, status)
        return out

    return rectify
