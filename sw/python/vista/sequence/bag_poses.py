"""Poses of the left camera from a bag: a topic of odometry or of poses, with tf from the body to the camera,
or tf alone.

World frames of ROS have z up (REP 103). Where tf has several, `odom` is taken, which moves without jumps
(REP 105), else the root.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from vista import parameters
from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence.bag_file import Bag
from vista.sequence.bag_images import stamp_ns
from vista.sequence.bag_topics import TRANSFORMS, pose_topic
from vista.sequence.options import FRAME_OF_LEFT_CAMERA, NO_POSES, Options
from vista.sequence.trajectory import PoseSource, Sample, Trajectory
from vista.sequence.transforms import Transforms, sample_of, trajectory_of

CONTINUOUS_WORLD = "odom"
LATE_NS = 1_000_000_000  # no message is overtaken by others for so long
CORRECTION_M = 2.0
SAID = 3  # restarts that a note names


@dataclass(frozen=True)
class BagPoses:
    poses: PoseSource
    name: str  # for messages
    note: str
    anew_ns: tuple[int, ...] = ()  # when they began anew, at another place


@dataclass(frozen=True)
class ByTransforms:
    """All from tf."""

    transforms: Transforms
    world: str
    camera: str

    def at(self, t_ns: int) -> Pose | None:
        return self.transforms.at(self.world, self.camera, t_ns)

    def span(self) -> str:
        return f"the transforms from {self.world} to {self.camera} lie elsewhere"


@dataclass(frozen=True)
class ByTopic:
    """The body's pose from a topic, the camera's place on it from tf."""

    world_from_body: Trajectory
    transforms: Transforms
    body: str
    camera: str
    gaps_ns: tuple[tuple[int, int], ...] = ()  # where they began anew: the times around it

    def at(self, t_ns: int) -> Pose | None:
        if any(before_ns < t_ns < after_ns for before_ns, after_ns in self.gaps_ns):
            return None
        world_from_body = self.world_from_body.at(t_ns)
        body_from_camera = self.transforms.at(self.body, self.camera, t_ns)
        if world_from_body is None or body_from_camera is None:
            return None
        return world_from_body @ body_from_camera

    def span(self) -> str:
        return self.world_from_body.span()


def read_poses(bag: Bag, camera: str, options: Options) -> BagPoses | None:
    """camera: the frame of reference of the left images. None: there are no poses, or the user wants none."""
    if options.pose_topic == NO_POSES:
        return None
    topic = pose_topic(bag, options)
    camera = camera.lstrip("/")
    transforms = Transforms(bag)
    if topic is None or bag.types[topic] in TRANSFORMS:
        if options.pose_frame is not None:
            raise InputError("--pose-frame", f"goes with a topic of poses; tf of {bag.path} names all frames")
        return _by_transforms(bag, topic, transforms, camera)
    return _by_topic(bag, topic, transforms, camera, options.pose_frame)


def _by_transforms(bag: Bag, topic: str | None, transforms: Transforms, camera: str) -> BagPoses | None:
    above = transforms.above(camera)
    world = CONTINUOUS_WORLD if CONTINUOUS_WORLD in above else above[-1] if above else None
    if world is None or not transforms.moves(world, camera):
        if topic is None:
            return None
        raise InputError(
            f"{bag.path}, topic {topic}", f"does not tell how the camera's frame {camera!r} moves"
        )
    note = f"poses are those of {camera} in {world}, by tf"
    return BagPoses(ByTransforms(transforms, world, camera), f"{bag.path}, tf", note)


def _by_topic(bag: Bag, topic: str, transforms: Transforms, camera: str, named_body: str | None) -> BagPoses:
    name = f"{bag.path}, topic {topic}"
    samples: dict[int, Sample] = {}
    bodies, newest_ns = set(), 0
    for number, (_, message) in enumerate(bag.messages(topic)):
        t_ns = stamp_ns(message.header)
        newest_ns = max(newest_ns, t_ns)
        if newest_ns - t_ns > LATE_NS:
            raise InputError(
                f"{name}, message {number}",
                f"its time goes back by {1e-9 * (newest_ns - t_ns):.1f} s: the poses of two runs; "
                f"choose --pose-topic ({NO_POSES}: no poses)",
            )
        samples[t_ns] = sample_of(f"{name}, message {number}", t_ns, pose_in(message))
        bodies.add(str(getattr(message, "child_frame_id", "")).lstrip("/"))
    body = named_body or (bodies.pop() if len(bodies) == 1 else "")
    if not body:
        raise InputError(
            name,
            "does not say whose poses it holds; name their frame with --pose-frame, or give "
            f"--pose-frame {FRAME_OF_LEFT_CAMERA} if they are those of the left camera",
        )
    if body == FRAME_OF_LEFT_CAMERA:
        body = camera
    if body != camera and body not in transforms.above(camera):
        raise InputError(
            name,
            f"holds poses of {body!r}, and tf does not say where the camera's frame {camera!r} is on it; "
            f"choose --pose-frame, or --pose-topic {NO_POSES}",
        )
    gaps_ns = restarts(samples)
    poses = ByTopic(trajectory_of(samples.values()), transforms, body, camera, gaps_ns)
    note, anew_ns = f"poses are those of {body} in {topic}", tuple(after_ns for _, after_ns in gaps_ns)
    if anew_ns:
        times = ", ".join(f"{1e-9 * t_ns:.3f} s" for t_ns in anew_ns[:SAID])
        more = ", ..." if len(anew_ns) > SAID else ""
        note += f", which began anew at another place at {times}{more}: all tracks are dropped there"
    return BagPoses(poses, name, note, anew_ns)


def restarts(samples: dict[int, Sample]) -> tuple[tuple[int, int], ...]:
    """Neighbouring times between which the place jumps. The detector refuses such a jump between frames, but
    frames may be too far apart to show it. A correction of a filter is no restart."""
    speed_m_s = float(parameters.defaults()["motion"]["speed_max_m_s"])

    def jumps(before_ns: int, after_ns: int) -> bool:
        way_m = np.linalg.norm(samples[after_ns].position_m - samples[before_ns].position_m)
        return bool(way_m > CORRECTION_M + 1e-9 * speed_m_s * (after_ns - before_ns))

    return tuple(times_ns for times_ns in pairwise(sorted(samples)) if jumps(*times_ns))


def pose_in(message: Any) -> Any:
    """Odometry and PoseWithCovarianceStamped have it one step deeper."""
    if hasattr(message, "transform"):
        return message.transform
    return message.pose.pose if hasattr(message.pose, "pose") else message.pose
