"""Frames of reference of a bag, as tf tells them: each has one parent, at rest or moving."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence.bag_file import Bag
from vista.sequence.bag_images import stamp_ns
from vista.sequence.bag_topics import TRANSFORMS
from vista.sequence.trajectory import Sample, Trajectory, make_sample


class Transforms:
    """All transforms of the topics of tf."""

    def __init__(self, bag: Bag) -> None:
        self.parent: dict[str, str] = {}
        samples: dict[str, dict[int, Sample]] = {}
        self._at_rest: set[str] = set()
        for topic in bag.topics(*TRANSFORMS):
            for _, message in bag.messages(topic):
                for transform in message.transforms:
                    self._add(f"{bag.path}, topic {topic}", transform, topic.endswith("static"), samples)
        self._motion = {child: trajectory_of(found.values()) for child, found in samples.items()}

    def _add(
        self, culprit: str, transform: Any, at_rest: bool, samples: dict[str, dict[int, Sample]]
    ) -> None:
        parent, child = (name.lstrip("/") for name in (transform.header.frame_id, transform.child_frame_id))
        if self.parent.setdefault(child, parent) != parent:
            raise InputError(culprit, f"{child} has two parents, {self.parent[child]} and {parent}")
        sample = sample_of(culprit, stamp_ns(transform.header), transform.transform)
        if at_rest:
            self._at_rest.add(child)
        samples.setdefault(child, {})[sample.t_ns] = sample

    def above(self, frame: str) -> list[str]:
        """The frames from this one, exclusive, to the root."""
        chain: list[str] = []
        while frame in self.parent and self.parent[frame] not in chain:
            frame = self.parent[frame]
            chain.append(frame)
        return chain

    def moves(self, parent: str, child: str) -> bool:
        return any(frame not in self._at_rest for frame in self._between(parent, child))

    def at(self, parent: str, child: str, t_ns: int) -> Pose | None:
        """parent_from_child; None outside the time of the transforms. child lies below parent."""
        pose = Pose()
        for frame in self._between(parent, child):
            motion = self._motion[frame]
            step = motion.first() if frame in self._at_rest else motion.at(t_ns)
            if step is None:
                return None
            pose = step @ pose
        return pose

    def _between(self, parent: str, child: str) -> Iterator[str]:
        while child != parent:
            yield child
            child = self.parent[child]


def trajectory_of(samples: Any) -> Trajectory:
    return Trajectory(sorted(samples, key=lambda sample: sample.t_ns))


def sample_of(culprit: str, t_ns: int, transform: Any) -> Sample:
    """Reads a geometry_msgs/Transform or a geometry_msgs/Pose."""
    place = transform.translation if hasattr(transform, "translation") else transform.position
    turn = transform.rotation if hasattr(transform, "rotation") else transform.orientation
    position_m = np.array([place.x, place.y, place.z], np.float64)
    quaternion = np.array([turn.w, turn.x, turn.y, turn.z], np.float64)
    if not np.all(np.isfinite([*position_m, *quaternion])):
        raise InputError(culprit, "a pose holds a number that is not finite")
    return make_sample(culprit, t_ns, position_m, quaternion)
