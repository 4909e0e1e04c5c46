"""One recording, for tests to write in the format of every source."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from flight_on_disk import write_flight
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from vista.geometry import CameraModel, RawCalibration
from vista.sequence import Frame, open_sequence

LOSSLESS = cv2.VideoWriter_fourcc(*"FFV1")
QUATERNION_WXYZ = (0.5, -0.5, 0.5, -0.5)  # of the camera of flight_on_disk, which looks along x of the world
UP = "up_world = [0.0, 0.0, 1.0]\n"


@dataclass(frozen=True)
class Recording:
    frames: list[Frame]
    raw: RawCalibration
    up: str = ""  # of calibration.toml

    @property
    def rate_hz(self) -> float:
        return 1e9 / (self.frames[1].t_ns - self.frames[0].t_ns)

    @property
    def calibration(self) -> str:
        """calibration.toml, with all digits."""
        motion = self.raw.right_from_left
        return (
            f"{self.up}{_camera('left', self.raw.left)}{_camera('right', self.raw.right)}[right_from_left]\n"
            f"rotation = {motion.rotation.ravel().tolist()}\n"
            f"translation_m = {motion.translation_m.tolist()}\n"
        )


def _camera(name: str, model: CameraModel) -> str:
    (fx, _, cx), (_, fy, cy) = model.matrix[:2].tolist()
    numbers = f"fx_px = {fx}\nfy_px = {fy}\ncx = {cx}\ncy = {cy}\n"
    return f"[{name}]\n{numbers}distortion = {list(model.distortion)}\n"


def record_flight(folder: Path, frames: int = 20) -> Recording:
    """A flight towards a sign, also as a folder in the EuRoC layout."""
    sequence = open_sequence(write_flight(folder, frames=frames, last_range_m=14.0))
    return Recording([sequence.read(files) for files in sequence.frames], sequence.calibration, UP)


def seconds(t_ns: int) -> str:
    return f"{t_ns // 10**9}.{t_ns % 10**9:09d}"


def write_trajectory(path: Path, recording: Recording) -> Path:
    """Writes a trajectory in the TUM format."""
    lines = []
    for frame in recording.frames:
        assert frame.world_from_camera is not None
        position = " ".join(repr(float(value)) for value in frame.world_from_camera.translation_m)
        x, y, z, w = Rotation.from_matrix(frame.world_from_camera.rotation).as_quat().tolist()
        lines.append(f"{seconds(frame.t_ns)} {position} {x!r} {y!r} {z!r} {w!r}\n")
    path.write_text("# timestamp tx ty tz qx qy qz qw\n" + "".join(lines))
    return path


def write_video(path: Path, images: list[NDArray[np.uint8]], rate_hz: float, codec: int = LOSSLESS) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = images[0].shape
    writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, codec, rate_hz, (width, height), False)
    assert writer.isOpened()
    for image in images:
        writer.write(image)
    writer.release()
    return path


def write_stacked(path: Path, recording: Recording, axis: int, rate_hz: float | None = None) -> Path:
    """Both images in one video, axis 1: side by side; with calibration.toml beside it."""
    images = [np.concatenate([frame.left, frame.right], axis) for frame in recording.frames]
    write_video(path, images, rate_hz or recording.rate_hz)
    (path.parent / "calibration.toml").write_text(recording.calibration)
    return path


def write_two_videos(folder: Path, recording: Recording) -> Path:
    """The left one."""
    for side in ("left", "right"):
        images = [getattr(frame, side) for frame in recording.frames]
        write_video(folder / f"flight_{side}.mkv", images, recording.rate_hz)
    (folder / "calibration.toml").write_text(recording.calibration)
    return folder / "flight_left.mkv"


def write_pairs(folder: Path, recording: Recording) -> Path:
    """Writes pairs with times.csv, without poses."""
    folder.mkdir(parents=True)
    rows = []
    for index, frame in enumerate(recording.frames):
        for side in ("left", "right"):
            assert cv2.imwrite(str(folder / f"{index:03d}_{side}.png"), getattr(frame, side))
        rows.append(f"{index:03d},{frame.t_ns}\n")
    (folder / "times.csv").write_text("name,t_ns\n" + "".join(rows))
    (folder / "calibration.toml").write_text(recording.calibration)
    return folder


def write_kitti(root: Path, recording: Recording) -> Path:
    """sequences/00 with its poses; the layout does not say where up is."""
    folder = root / "sequences" / "00"
    poses = []
    for index, frame in enumerate(recording.frames):
        for camera, image in enumerate((frame.left, frame.right)):
            (folder / f"image_{camera}").mkdir(parents=True, exist_ok=True)
            assert cv2.imwrite(str(folder / f"image_{camera}" / f"{index:06d}.png"), image)
        pose = frame.world_from_camera
        assert pose is not None
        rows = np.column_stack([pose.rotation, pose.translation_m]).ravel()
        poses.append(" ".join(repr(float(value)) for value in rows) + "\n")
    focal, cx, cy = (float(recording.raw.left.matrix[at]) for at in ((0, 0), (0, 2), (1, 2)))
    lines = (
        f"{k}: {focal} 0 {cx} {x} 0 {focal} {cy} 0 0 0 1 0\n"
        for k, x in (("P0", 0), ("P1", focal * float(recording.raw.right_from_left.translation_m[0])))
    )
    (folder / "calib.txt").write_text("".join(lines))
    (folder / "times.txt").write_text("".join(f"{seconds(frame.t_ns)}\n" for frame in recording.frames))
    (root / "poses").mkdir()
    (root / "poses" / "00.txt").write_text("".join(poses))
    return folder
