"""RealSense cameras with two infrared imagers (D400 family), through pyrealsense2.

The device delivers rectified images; their calibration is that of the device.
"""

from __future__ import annotations

import time
from contextlib import suppress
from typing import Any

import numpy as np
import pyrealsense2 as rs

from vista.errors import InputError
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix
from vista.live.stereo_camera import Pair, monotonic_ns, serial_of

DEFAULT_PX = (848, 480)  # what Intel recommends for the D400 family
QUEUE = 2
KNOWN_DISTORTION = (rs.distortion.none, rs.distortion.brown_conrady)


class RealSense:
    def __init__(self, name: str, device: Any, size_px: tuple[int, int]) -> None:
        """device: rs.device or rs.software_device. InputError without two infrared images of this size."""
        self._sensor, profiles = find_profiles(name, device, size_px)
        self.calibration = calibration_of(name, *profiles)
        self._frames = rs.syncer(QUEUE)
        try:
            self._sensor.open(list(profiles))
            self._sensor.start(self._frames)
        except RuntimeError as error:
            raise InputError(name, str(error)) from None

    def read(self, timeout_s: float) -> Pair | None:
        try:
            there, frames = self._frames.try_wait_for_frames(int(1e3 * timeout_s))
        except RuntimeError as error:
            raise OSError(str(error)) from None
        if not there:
            return None
        left, right = frames.get_infrared_frame(1), frames.get_infrared_frame(2)
        if not (left and right):
            return None
        images = [np.array(frame.get_data(), np.uint8) for frame in (left, right)]
        return Pair(images[0], images[1], monotonic_ns(age_s(left)))

    def close(self) -> None:
        with suppress(RuntimeError):  # it was unplugged
            self._sensor.stop()
            self._sensor.close()


def open_device(name: str, size_px: tuple[int, int] | None) -> RealSense:
    serial = serial_of(name)
    for device in rs.context().query_devices():
        if serial in (None, device.get_info(rs.camera_info.serial_number)):
            return RealSense(name, device, size_px or DEFAULT_PX)
    raise InputError(name, "no such camera is connected")


def find_profiles(name: str, device: Any, size_px: tuple[int, int]) -> tuple[Any, tuple[Any, Any]]:
    """The sensor, and its profiles of the left and the right imager at the highest rate that both have."""
    for sensor in device.query_sensors():
        found: dict[int, dict[int, Any]] = {1: {}, 2: {}}
        for profile in sensor.get_stream_profiles():
            if profile.stream_type() != rs.stream.infrared or profile.format() != rs.format.y8:
                continue
            video = profile.as_video_stream_profile()
            if profile.stream_index() in found and (video.width(), video.height()) == size_px:
                found[profile.stream_index()][profile.fps()] = video
        rates = found[1].keys() & found[2].keys()
        if rates:
            return sensor, (found[1][max(rates)], found[2][max(rates)])
    raise InputError(name, "has no pair of infrared images of {}x{} px".format(*size_px))


def calibration_of(name: str, left: Any, right: Any) -> RawCalibration:
    moved = left.get_extrinsics_to(right)
    rotation = np.array(moved.rotation).reshape(3, 3).T  # column by column
    pose = Pose(rotation, np.array(moved.translation, np.float64))
    return RawCalibration(camera_of(name, left), camera_of(name, right), pose, name)


def camera_of(name: str, profile: Any) -> CameraModel:
    seen = profile.get_intrinsics()
    coefficients = tuple(float(value) for value in seen.coeffs)
    if seen.model not in KNOWN_DISTORTION and any(coefficients):
        raise InputError(name, f"the distortion model {seen.model} is not known")
    matrix = camera_matrix(seen.fx, seen.fy, seen.ppx, seen.ppy)
    return CameraModel(seen.width, seen.height, matrix, coefficients)


def age_s(frame: Any) -> float:
    """The time since the exposure, where the camera's clock is compared with this machine's; else 0."""
    if frame.get_frame_timestamp_domain() == rs.timestamp_domain.hardware_clock:
        return 0.0
    return time.time() - 1e-3 * float(frame.get_timestamp())
