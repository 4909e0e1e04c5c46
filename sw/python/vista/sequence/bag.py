"""Recordings of ROS 1 and ROS 2: an image pair with camera_info, and poses (bag_poses.py).

The times are those of the headers. Left and right images are paired by them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.geometry import RawCalibration
from vista.sequence.asl import UP_WORLD
from vista.sequence.bag_file import STORAGES, Bag
from vista.sequence.bag_images import ImageTopic
from vista.sequence.bag_poses import read_poses
from vista.sequence.bag_topics import CAMERA_INFO, camera_info_topics, image_topics, names_rectified
from vista.sequence.camera_info import pair_from_camera_info
from vista.sequence.options import Options
from vista.sequence.pairing import pair_by_time
from vista.sequence.pairs import Described, read_calibration_file
from vista.sequence.trajectory import with_poses
from vista.sequence.types import FrameFiles, Sequence

NAME = "ROS bag"
TAKES = frozenset(
    {"calibration", "pair_tolerance_ms", "left_topic", "right_topic", "pose_topic", "pose_frame"}
)


def recognises(path: Path) -> bool:
    if path.is_file():
        return path.suffix in (".bag", *STORAGES)
    return (path / "metadata.yaml").is_file() or any(p.suffix in STORAGES for p in path.iterdir())


@dataclass(frozen=True)
class BagImage:
    topic: ImageTopic
    index: int

    def __str__(self) -> str:
        return f"{self.topic.name}, message {self.topic.entries[self.index].number}"

    def read_grey(self) -> NDArray[np.uint8]:
        return self.topic.read_grey(self.index)


def open_source(path: Path, options: Options) -> Sequence:
    bag = Bag(path)
    names = image_topics(bag, options)
    left, right = (ImageTopic(path, name) for name in names)
    left_ns, right_ns = ([entry.t_ns for entry in topic.entries] for topic in (left, right))
    pairs = pair_by_time(left_ns, right_ns, options.pair_tolerance_ms, right.name)
    frames = tuple(
        FrameFiles(at, left_ns[at], BagImage(left, at), BagImage(right, partner), None)
        for at, partner in pairs.indices
    )
    described = _calibration(bag, names, left, options)
    notes = (f"images are {names[0]} and {names[1]}", *left.notes, *right.notes, *pairs.notes)
    poses = read_poses(bag, left.frame_id, options) if options.of_source else None
    up_world = described.up_world
    if poses is not None:
        frames, left_out = with_poses(frames, poses.poses, poses.name)
        up = "" if up_world is not None else "; up is taken to be the z axis of their world"
        frames = tuple(_marked(frames, poses.anew_ns))
        notes += (poses.note + up, *left_out)
        up_world = UP_WORLD if up_world is None else up_world
    return Sequence(path.resolve().stem, NAME, described.calibration, frames, up_world, notes)


def _marked(frames: Iterable[FrameFiles], anew_ns: tuple[int, ...]) -> Iterator[FrameFiles]:
    """The first frame since the poses began anew says so."""
    before_ns: int | None = None
    for files in frames:
        since_ns = files.t_ns if before_ns is None else before_ns
        yield replace(files, anew=any(since_ns < t_ns <= files.t_ns for t_ns in anew_ns))
        before_ns = files.t_ns


def _calibration(bag: Bag, names: tuple[str, str], left: ImageTopic, options: Options) -> Described:
    """The calibration of calibration.toml where the user names one, else of camera_info."""
    if options.calibration is not None:
        height, width = left.read_grey(0).shape
        described = read_calibration_file(options.calibration, (width, height))
        if described.stills:
            raise InputError(options.calibration, f"stills = true does not go with {bag.path}, a bag")
        return described
    topics = camera_info_topics(bag, names)
    if topics is None:
        known = ", ".join(bag.topics(CAMERA_INFO)) or "none"
        raise InputError(
            bag.path, f"no camera_info beside {names[0]} and {names[1]} (it has: {known}); give --calibration"
        )
    return Described(_of_camera_info(bag, topics, names), None, False)


def _of_camera_info(bag: Bag, topics: tuple[str, str], images: tuple[str, str]) -> RawCalibration:
    infos = [next(bag.messages(topic))[1] for topic in topics]
    culprits = f"{bag.path}, topic {topics[0]}", f"{bag.path}, topic {topics[1]}"
    return pair_from_camera_info(
        infos[0], infos[1], culprits, (names_rectified(images[0]), names_rectified(images[1]))
    )
