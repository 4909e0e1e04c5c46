"""A pair of cameras as calibration files have it: their lenses, and where each is."""

from __future__ import annotations

from dataclasses import dataclass

from vista.geometry import CameraModel, Pose, RawCalibration


@dataclass(frozen=True)
class Rig:
    """Formats state the motion between the cameras in one direction or the other, or by way of the vehicle.

    Poses are kept as the file has them, as those of both cameras in one frame: what is written in the format
    that it was read from is then what was read, to the last digit.
    """

    left: CameraModel
    right: CameraModel
    frame_from_left: Pose
    frame_from_right: Pose
    is_body: bool = False  # the frame is that of the vehicle, or of its IMU

    @property
    def right_from_left(self) -> Pose:
        return self.frame_from_right.inverse() @ self.frame_from_left

    @property
    def left_from_right(self) -> Pose:
        return self.frame_from_left.inverse() @ self.frame_from_right

    def raw(self, source: str) -> RawCalibration:
        return RawCalibration(self.left, self.right, self.right_from_left, source)


def rig_of(raw: RawCalibration) -> Rig:
    return Rig(raw.left, raw.right, raw.right_from_left, Pose())
