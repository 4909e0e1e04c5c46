"""A stand-in for the package depthai, as far as vista.live.oak calls it, with one device.

It follows the interface of depthai 3.12. The calibration is an object of the same calls as
dai.CalibrationHandler, with which `calibration_of` was compared once by hand.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from datetime import timedelta
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

PERSPECTIVE, FISHEYE = "Perspective", "Fisheye"


@dataclass
class Calibration:
    """What is stored in the device: intrinsics of 1280x800."""

    focal_px: float = 800.0
    distortion: tuple[float, ...] = (0.1, -0.2, 0.001, 0.002, 0.05, 0.01, 0.02, 0.03, *[0.0] * 6)
    model: str = PERSPECTIVE
    baseline_m: float = 0.075
    stored: bool = True

    def getStereoLeftCameraId(self) -> str:  # noqa: N802
        return "CAM_B"

    def getStereoRightCameraId(self) -> str:  # noqa: N802
        return "CAM_C"

    def getCameraExtrinsics(self, left: str, right: str, unit: str) -> list[list[float]]:  # noqa: N802
        assert (left, right, unit) == ("CAM_B", "CAM_C", "METER")
        if not self.stored:
            raise RuntimeError(
                "There is no Camera data available corresponding to the the requested cameraID"
            )
        return [[1, 0, 0, -self.baseline_m], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]

    def getCameraIntrinsics(self, socket: str, width: int, height: int) -> list[list[float]]:  # noqa: N802
        scale = width / 1280
        return [[scale * self.focal_px, 0, width / 2], [0, scale * self.focal_px, height / 2], [0, 0, 1]]

    def getDistortionModel(self, socket: str) -> str:  # noqa: N802
        return self.model

    def getDistortionCoefficients(self, socket: str) -> tuple[float, ...]:  # noqa: N802
        return self.distortion


@dataclass
class Frame:
    image: NDArray[np.uint8]
    stamp: timedelta

    def getFrame(self) -> NDArray[np.uint8]:  # noqa: N802
        return self.image

    def getTimestamp(self) -> timedelta:  # noqa: N802
        return self.stamp


@dataclass
class Bench:
    """What a test does with the device."""

    calibration: Calibration = field(default_factory=Calibration)
    serial: str = "14442C10"
    plugged: bool = True
    pairs: deque[tuple[NDArray[np.uint8], NDArray[np.uint8]]] = field(default_factory=deque)
    asked: list[tuple[str, tuple[int, int], str, float, bool]] = field(default_factory=list)
    opened: int = 0
    age_s: float = 0.02

    def module(self) -> ModuleType:
        made = ModuleType("depthai")
        made.__dict__.update(
            Device=self._device,
            DeviceInfo=lambda serial: serial,
            Pipeline=self._pipeline,
            node=SimpleNamespace(Sync="Sync", Camera="Camera"),
            ImgFrame=SimpleNamespace(Type=SimpleNamespace(GRAY8="GRAY8")),
            CameraModel=SimpleNamespace(Fisheye=FISHEYE),
            LengthUnit=SimpleNamespace(METER="METER"),
            Clock=SimpleNamespace(now=lambda: timedelta(seconds=100.0)),
        )
        return made

    def _device(self, serial: str | None = None) -> Any:
        if not self.plugged or serial not in (None, self.serial):
            raise RuntimeError("No available devices")
        self.opened += 1
        return SimpleNamespace(readCalibration=lambda: self.calibration)

    def _pipeline(self, device: Any) -> Any:
        return SimpleNamespace(create=self._create, start=lambda: None, stop=lambda: None)

    def _create(self, kind: str) -> Any:
        if kind == "Camera":
            return SimpleNamespace(build=lambda socket: SimpleNamespace(requestOutput=self._output(socket)))
        return SimpleNamespace(
            setSyncThreshold=lambda apart: None,
            inputs={"left": "left", "right": "right"},
            out=SimpleNamespace(createOutputQueue=lambda maxSize, blocking: SimpleNamespace(get=self._get)),
        )

    def _output(self, socket: str) -> Any:
        def request(size: tuple[int, int], kind: str, fps: float, enableUndistortion: bool) -> Any:
            self.asked.append((socket, size, kind, fps, enableUndistortion))
            return SimpleNamespace(link=lambda to: None)

        return request

    def _get(self, timeout: timedelta) -> Any:
        if not self.plugged:
            raise RuntimeError("Communication exception - possible device error/misconfiguration")
        if not self.pairs:
            return None
        left, right = self.pairs.popleft()
        stamp = timedelta(seconds=100.0 - self.age_s)
        return {"left": Frame(left, stamp), "right": Frame(right, stamp)}
