"""OAK cameras of Luxonis, through depthai 3: both mono cameras as they are, and the device's calibration."""

from __future__ import annotations

from contextlib import suppress
from datetime import timedelta
from typing import Any

import depthai as dai
import numpy as np

from vista.calibration.formats.common import make_camera
from vista.errors import InputError
from vista.geometry import CameraModel, Lens, Pose, RawCalibration, is_rotation
from vista.live.stereo_camera import Pair, monotonic_ns, serial_of

DEFAULT_PX = (640, 400)  # half of the sensors' size in the devices of the series 2
RATE_HZ = 30.0
APART = timedelta(milliseconds=5)
QUEUE = 2


class Oak:
    def __init__(self, name: str, device: Any, size_px: tuple[int, int]) -> None:
        """device: dai.Device. InputError for a device without a calibration of its stereo pair."""
        stored = device.readCalibration()
        self.calibration = calibration_of(name, stored, size_px)
        self._pipeline = dai.Pipeline(device)
        pairs = self._pipeline.create(dai.node.Sync)
        pairs.setSyncThreshold(APART)
        for side, socket in sockets(stored).items():
            camera = self._pipeline.create(dai.node.Camera).build(socket)
            kind = dai.ImgFrame.Type.GRAY8
            camera.requestOutput(size_px, kind, fps=RATE_HZ, enableUndistortion=False).link(
                pairs.inputs[side]
            )
        self._pairs = pairs.out.createOutputQueue(maxSize=QUEUE, blocking=False)
        self._pipeline.start()

    def read(self, timeout_s: float) -> Pair | None:
        try:
            group = self._pairs.get(timedelta(seconds=timeout_s))
        except RuntimeError as error:  # the queue of a device that is gone
            raise OSError(str(error)) from None
        if group is None:
            return None
        left, right = group["left"], group["right"]
        age = dai.Clock.now() - left.getTimestamp()
        images = [np.array(frame.getFrame(), np.uint8) for frame in (left, right)]
        return Pair(images[0], images[1], monotonic_ns(age.total_seconds()))

    def close(self) -> None:
        with suppress(RuntimeError):  # it was unplugged
            self._pipeline.stop()


def open_device(name: str, size_px: tuple[int, int] | None) -> Oak:
    serial = serial_of(name)
    try:
        device = dai.Device() if serial is None else dai.Device(dai.DeviceInfo(serial))
    except RuntimeError as error:
        raise InputError(name, f"cannot be opened: {error}") from None
    return Oak(name, device, size_px or DEFAULT_PX)


def sockets(stored: Any) -> dict[str, Any]:
    return {"left": stored.getStereoLeftCameraId(), "right": stored.getStereoRightCameraId()}


def calibration_of(name: str, stored: Any, size_px: tuple[int, int]) -> RawCalibration:
    """stored: dai.CalibrationHandler."""
    left, right = sockets(stored).values()
    try:
        moved = np.array(stored.getCameraExtrinsics(left, right, unit=dai.LengthUnit.METER), np.float64)
        cameras = [camera_of(name, stored, socket, size_px) for socket in (left, right)]
    except RuntimeError as error:
        raise InputError(name, f"holds no calibration of its stereo pair: {error}") from None
    if not is_rotation(moved[:3, :3]):
        raise InputError(name, "holds no calibration of its stereo pair")
    return RawCalibration(cameras[0], cameras[1], Pose(moved[:3, :3], moved[:3, 3]), name)


def camera_of(name: str, stored: Any, socket: Any, size_px: tuple[int, int]) -> CameraModel:
    matrix = stored.getCameraIntrinsics(socket, *size_px)
    fisheye = stored.getDistortionModel(socket) == dai.CameraModel.Fisheye
    lens: Lens = "fisheye" if fisheye else "pinhole"
    distortion = [float(value) for value in stored.getDistortionCoefficients(socket)]
    K = matrix[0][0], matrix[1][1], matrix[0][2], matrix[1][2]
    return make_camera(name, size_px, K, distortion[:4] if fisheye else distortion, lens)
