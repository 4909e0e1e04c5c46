"""Video files: one with both images side by side or one above the other, or one for each camera.

Two files are NAME_left.EXT with NAME_right.EXT beside it, or any two, of which `--right` names the second.
The times are those of the container, or come from `--rate`; the calibration is a calibration.toml (pairs.py)
beside the video or elsewhere. Two files count from the same start; they are paired by their times.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.sequence.options import SIDE_BY_SIDE, TOP_BOTTOM, Options
from vista.sequence.pairing import notes_on_drops, pair_by_time
from vista.sequence.pairs import read_calibration_file
from vista.sequence.text import seconds_ns
from vista.sequence.types import FrameFiles, Sequence
from vista.sequence.video_file import VideoFile

NAME = "video"
TAKES = frozenset({"calibration", "right", "split", "rate", "start", "pair_tolerance_ms"})
EXTENSIONS = frozenset((".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".ogv", ".webm", ".wmv"))


def recognises(path: Path) -> bool:
    return path.is_file() and path.suffix.lower() in EXTENSIONS


@dataclass(frozen=True)
class VideoImage:
    """Frame `index` of a video, or a part of it."""

    video: VideoFile
    index: int
    part: tuple[slice, slice]

    def __str__(self) -> str:
        return f"{self.video.path}, frame {self.index}"

    def read_grey(self) -> NDArray[np.uint8]:
        return np.ascontiguousarray(self.video.read_grey(self.index)[self.part])


@dataclass(frozen=True)
class Images:
    frames: tuple[FrameFiles, ...]
    size: tuple[int, int]  # width, height of each image
    notes: tuple[str, ...] = ()


def open_source(path: Path, options: Options) -> Sequence:
    right_path = _path_of_right(path, options)
    images = _of_one(path, options) if right_path is None else _of_two(path, right_path, options)
    calibration_path = options.calibration or path.parent / "calibration.toml"
    described = read_calibration_file(calibration_path, images.size)
    if described.stills:
        raise InputError(calibration_path, f"stills = true does not go with {path}, a video")
    name = path.stem.removesuffix("_left") if right_path else path.stem
    return Sequence(name, NAME, described.calibration, images.frames, described.up_world, images.notes)


def _path_of_right(path: Path, options: Options) -> Path | None:
    if options.right is not None:
        if options.split is not None:
            raise InputError("--split", "does not go with --right: each video holds one image")
        return options.right
    beside = path.with_stem(path.stem.removesuffix("_left") + "_right")
    return beside if path.stem.endswith("_left") and beside.is_file() else None


def _of_one(path: Path, options: Options) -> Images:
    if options.pair_tolerance_ms is not None:
        raise InputError("--pair-tolerance-ms", f"does not go with {path}, whose images share their times")
    video = VideoFile(path)
    left, right = _halves(video, options.split)
    times_ns = _times_ns(video, options)
    frames = (
        FrameFiles(at, t_ns, VideoImage(video, at, left), VideoImage(video, at, right), None)
        for at, t_ns in enumerate(times_ns)
    )
    height, width = video.read_grey(0)[left].shape
    return Images(tuple(frames), (width, height), notes_on_drops(times_ns))


def _of_two(left: Path, right: Path, options: Options) -> Images:
    videos = VideoFile(left), VideoFile(right)
    if videos[0].read_size() != videos[1].read_size():
        sizes = " and ".join(f"{width}x{height}" for width, height in (video.read_size() for video in videos))
        raise InputError(right, f"the left and the right video differ in size, {sizes}")
    left_ns, right_ns = (_times_ns(video, options) for video in videos)
    pairs = pair_by_time(left_ns, right_ns, options.pair_tolerance_ms, right)
    whole = (slice(None), slice(None))
    frames = (
        FrameFiles(
            at, left_ns[at], VideoImage(videos[0], at, whole), VideoImage(videos[1], partner, whole), None
        )
        for at, partner in pairs.indices
    )
    return Images(tuple(frames), videos[0].read_size(), pairs.notes)


def _halves(video: VideoFile, split: str | None) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """What of a frame is the left image, and what the right one. The upper one is the left one."""
    width, height = video.read_size()
    if split is None:
        split = SIDE_BY_SIDE if width >= 2 * height else TOP_BOTTOM if height >= width else None
    if split is None:
        raise InputError(
            video.path,
            f"{width}x{height} does not tell whether the images are side by side or one above the other; "
            "give --split, or the right camera's video with --right",
        )
    side, name = (width, "width") if split == SIDE_BY_SIDE else (height, "height")
    if side % 2:
        raise InputError(video.path, f"cannot be split in two: its {name} is {side} px, an odd number")
    everything, first, second = slice(None), slice(0, side // 2), slice(side // 2, side)
    if split == SIDE_BY_SIDE:
        return (everything, first), (everything, second)
    return (first, everything), (second, everything)


def _times_ns(video: VideoFile, options: Options) -> list[int]:
    start_ns = seconds_ns("--start", options.start) if options.start is not None else 0
    if options.rate is None:
        return [start_ns + t_ns for t_ns in video.times_ns()]
    return [start_ns + round(1e9 * index / options.rate) for index in range(video.count)]
