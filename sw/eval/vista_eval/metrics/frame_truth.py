"""The truth of each frame of a flight: surfaces around the flight's path, and the target."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.geometry import Array, Pose
from vista.sequence import open_sequence

from vista_eval.dataset.truth import FlightTruth, TrueObject, read_truth
from vista_eval.metrics.flight_path import (
    CYLINDER_LENGTH_M,
    CYLINDER_RADIUS_M,
    Curved,
    FlightPath,
    Straight,
    flight_direction,
    true_paths,
)
from vista_eval.metrics.meeting import contact, ground_radius_m
from vista_eval.metrics.rules import PAPER, Rules

COMPACT_M = 3.0  # largest side of a target whose centre is a point to aim at
CENTER_M = 0.5  # and farthest from what is seen of it
DANGER_PIXELS = 20  # of the target in the cylinder; the sign has 40 at 150 m
THIN_ABOVE_PIXELS, THIN_STRIDE_PX = 4000, 3  # a wall needs no point a pixel; within BEARING_MARGIN_PX
STILL_M = 0.1
KEPT_M, KEPT_BESIDE_M = 40.0, 4.0  # ground that earlier frames showed: within this range, and of the path
NEAREST_M = 0.2  # along the optical axis: nearer or behind, a point has no pixel


@dataclass(frozen=True)
class Points:
    """Points of pixels of the exact disparity map, one an entry; also of ground that earlier frames have
    shown, at the pixels that a larger image would have."""

    view: View
    u_px: NDArray[np.int32]
    v_px: NDArray[np.int32]
    label: NDArray[np.uint16]
    depth_m: NDArray[np.float32]  # along the optical axis
    range_m: NDArray[np.float32]  # from the left camera
    aside_m: NDArray[np.float32]  # from the flight path
    along_m: NDArray[np.float32]  # on it

    def __len__(self) -> int:
        return len(self.u_px)

    def where(self, chosen: NDArray) -> Points:
        names = [name for name in self.__dataclass_fields__ if name != "view"]
        return Points(self.view, *(getattr(self, name)[chosen] for name in names))

    @functools.cached_property
    def position_m(self) -> Array:
        """(n, 3) world."""
        x, y = self.view.rays(self.u_px, self.v_px)
        camera_m = np.stack([x, y, np.ones(len(x))], axis=-1) * self.depth_m[:, np.newaxis]
        pose = self.view.world_from_camera
        return camera_m @ pose.rotation.T + pose.translation_m


@dataclass(frozen=True)
class View:
    """The left camera of one frame."""

    world_from_camera: Pose
    focal_px: float
    center_px: tuple[float, float]

    def rays(self, u_px: NDArray, v_px: NDArray) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """x and y of each pixel's ray at depth 1, camera."""
        cu, cv = self.center_px
        x, y = (u_px - cu) / self.focal_px, (v_px - cv) / self.focal_px
        return x.astype(np.float32), y.astype(np.float32)


@dataclass(frozen=True)
class Target:
    """The target that is a true danger in a frame."""

    object: TrueObject
    reference_m: Array  # (3,) P
    range_m: float  # of P
    nearest_depth_m: float  # along the optical axis, of its points in the cylinder
    surface_m: Array | None  # (n, 3) what is seen of it; None: errors are those from P
    asked_m: tuple[float, float]  # from where to where a hit is asked for
    met: bool  # P is where the path meets it, so a warning of it has to give P's range


@dataclass(frozen=True)
class FrameTruth:
    t_ns: int
    world_from_camera: Pose
    around_path: Points  # in the inflated cylinder
    in_cylinder: NDArray[np.bool_]  # of around_path
    target: Target | None  # None: no target is a true danger
    ground_m: dict[int, float]  # of ground that is in the way, by label: the range where the path meets it
    real: Points  # of around_path; without ground, where that is judged by where the path meets it
    path_m: float  # as far as the path is followed

    @functools.cached_property
    def contact_m(self) -> float:
        """How far along the path the first thing within its cylinder lies, or the ground that it meets;
        infinite without any."""
        real = self.real
        ahead = (real.aside_m <= CYLINDER_RADIUS_M) & (real.along_m > 0.0) & (real.along_m <= self.path_m)
        return min([*real.along_m[ahead].tolist(), *self.ground_m.values()], default=np.inf)

    @functools.cached_property
    def of_target(self) -> Points:
        """The target's points in the cylinder; none without a target."""
        label = -1 if self.target is None else self.target.object.label
        return self.around_path.where(self.in_cylinder & (self.around_path.label == label))


@functools.lru_cache(maxsize=64)
def flight_frames(folder: Path, rules: Rules = PAPER) -> tuple[FlightTruth, tuple[FrameTruth, ...]]:
    """The truth of a flight on disk. Raises InputError."""
    truth = read_truth(folder)
    poses = true_poses(truth)
    if rules.meeting:
        paths: list[FlightPath] = [*true_paths(poses, truth.times_ns)]
    else:
        paths = [Straight(flight_direction(poses))] * len(poses)
    ground = SeenGround() if rules.meeting else None
    frames = []
    for k, (pose, path) in enumerate(zip(poses, paths, strict=True)):
        frames.append(frame_truth(truth, k, pose, path, rules, ground))
    return truth, tuple(frames)


def true_poses(truth: FlightTruth) -> list[Pose]:
    """Poses of the left camera in each frame: those that the truth tells, else those of the recording."""
    if truth.poses is not None:
        return list(truth.poses)
    frames = open_sequence(truth.folder).frames
    poses = {f.t_ns: f.world_from_camera for f in frames if f.world_from_camera is not None}
    missing = [t_ns for t_ns in truth.times_ns if t_ns not in poses]
    if missing:
        raise InputError(truth.folder, f"no pose at {missing[0]}, a frame of truth.json")
    return [poses[t_ns] for t_ns in truth.times_ns]


def unique_rows(cubes: NDArray[np.int64]) -> NDArray[np.int64]:
    """np.unique(cubes, axis=0) of (n, 3) numbers between -2^20 and 2^20 - 1, many times as fast."""
    packed = np.unique((cubes + (1 << 20)) @ np.array([1 << 42, 1 << 21, 1]))
    return np.stack([packed >> 42, packed >> 21, packed], axis=1) % (1 << 21) - (1 << 20)


class SeenGround:
    """Ground that the frames so far have shown near the path, a point a STILL_M cube: where an aircraft will
    touch it is below the image in the last second."""

    def __init__(self) -> None:
        self._cubes: dict[int, NDArray[np.int64]] = {}  # (n, 3), by label

    def add(self, truth: FlightTruth, points: Points) -> None:
        near = points.where((points.range_m <= KEPT_M) & (points.aside_m <= KEPT_BESIDE_M))
        for label in np.unique(near.label).tolist():
            thing = truth.objects.get(label)
            if thing is None or thing.standing or np.any(thing.velocity_m_s):
                continue
            found = np.rint(near.where(near.label == label).position_m / STILL_M).astype(np.int64)
            before = self._cubes.get(label, np.zeros((0, 3), np.int64))
            self._cubes[label] = unique_rows(np.concatenate([before, found]))

    def outside(self, truth: FlightTruth, view: View, path: FlightPath) -> list[Points]:
        """What of it lies outside the image, as the view would have it were the image larger."""
        pose, (cu, cv) = view.world_from_camera, view.center_px
        found = []
        for label, cubes in self._cubes.items():
            x_m, y_m, depth_m = ((cubes * STILL_M - pose.translation_m) @ pose.rotation).T
            ahead = depth_m > NEAREST_M
            x, y, depth_m = x_m[ahead] / depth_m[ahead], y_m[ahead] / depth_m[ahead], depth_m[ahead]
            u_px, v_px = cu + truth.focal_px * x, cv + truth.focal_px * y
            hidden = (u_px < 0) | (u_px > 2 * cu) | (v_px < 0) | (v_px > 2 * cv)
            x, y, depth_m = (a[hidden].astype(np.float32) for a in (x, y, depth_m))
            aside_m, along_m = path.measure(pose, x, y, depth_m)
            u, v = (np.rint(a[hidden]).astype(np.int32) for a in (u_px, v_px))
            labels = np.full(len(x), label, np.uint16)
            range_m = depth_m * np.sqrt(x * x + y * y + 1)
            found.append(Points(view, u, v, labels, depth_m, range_m, aside_m, along_m))
        return found


def joined(first: Points, others: list[Points]) -> Points:
    names = [name for name in first.__dataclass_fields__ if name != "view"]
    return Points(
        first.view, *(np.concatenate([getattr(p, name) for p in (first, *others)]) for name in names)
    )


def frame_truth(
    truth: FlightTruth,
    index: int,
    world_from_camera: Pose,
    path: FlightPath,
    rules: Rules,
    ground: SeenGround | None,
) -> FrameTruth:
    """ground: what the frames before have shown of it, to which this frame adds; None: it does not count."""
    t_ns = truth.times_ns[index]
    points = true_points(truth, t_ns, world_from_camera, path)
    if ground is not None:
        shown_before = ground.outside(truth, points.view, path)
        ground.add(truth, points)
        points = joined(points, shown_before)
    moving = points if isinstance(path, Straight) else as_they_move(truth, points, path)
    length_m = path.length_m if isinstance(path, Curved) else CYLINDER_LENGTH_M
    reach_m = CYLINDER_RADIUS_M + rules.inflation_m
    near = np.zeros(len(points), bool)
    for each in (points, moving):
        beside = (each.aside_m <= reach_m) & (each.along_m > 0.0)
        near |= beside & (each.along_m <= length_m + rules.inflation_m)
    around = moving.where(near)
    inside = (around.aside_m <= CYLINDER_RADIUS_M) & (around.along_m > 0.0) & (around.along_m <= length_m)
    age_s = (t_ns - truth.times_ns[0]) / 1e9
    shown = around.where(inside)
    ground_m = ground_contacts(truth, path, shown, moving) if isinstance(path, Curved) else {}
    target = find_target(truth, age_s, path, shown, moving, rules)
    kept = thinned(around)
    around = around.where(kept)
    real = around
    if rules.meeting:
        lying = [label for label, thing in truth.objects.items() if not thing.standing]
        real = around.where(~np.isin(around.label, lying))
    return FrameTruth(t_ns, world_from_camera, around, inside[kept], target, ground_m, real, length_m)


def true_points(truth: FlightTruth, t_ns: int, world_from_camera: Pose, path: FlightPath) -> Points:
    """One a pixel that shows a surface."""
    view = View(world_from_camera, truth.focal_px, truth.center_px)
    disparity_px = truth.disparity_px(t_ns)
    v, u = np.nonzero(disparity_px)
    depth_m = truth.focal_baseline_px_m / disparity_px[v, u]
    x, y = view.rays(u, v)
    aside_m, along_m = path.measure(world_from_camera, x, y, depth_m)
    return Points(
        view,
        u.astype(np.int32),
        v.astype(np.int32),
        truth.labels(t_ns)[v, u],
        depth_m,
        depth_m * np.sqrt(x * x + y * y + 1),
        aside_m,
        along_m,
    )


def as_they_move(truth: FlightTruth, points: Points, path: Curved) -> Points:
    """The same points, those of things that move beside and along the path as these see it."""
    aside_m, along_m = points.aside_m.copy(), points.along_m.copy()
    for thing in truth.objects.values():
        if not np.any(thing.velocity_m_s):
            continue
        own = np.flatnonzero(points.label == thing.label)
        origin_m = points.view.world_from_camera.translation_m
        offset_m = points.where(own).position_m - origin_m
        aside_m[own], along_m[own] = path.relative_to(thing.velocity_m_s).beside(offset_m, origin_m)
    return replace(points, aside_m=aside_m, along_m=along_m)


def ground_contacts(truth: FlightTruth, path: Curved, inside: Points, everything: Points) -> dict[int, float]:
    """Ranges of what does not stand and is in the way: the range where the collision volume first meets
    it."""
    found = {}
    for label in np.unique(inside.label).tolist():
        thing = truth.objects.get(label)
        if thing is None or thing.standing:
            continue
        met = meeting_point(path, inside, everything, label, standing=False)
        if met is not None:
            found[label] = float(np.linalg.norm(met - everything.view.world_from_camera.translation_m))
    return found


def meeting_point(
    path: Curved, inside: Points, everything: Points, label: int, standing: bool
) -> Array | None:
    """The point where the collision volume first meets a thing; None: too few pixels to tell."""
    shown = inside.where(inside.label == label)
    radius_m = CYLINDER_RADIUS_M
    if not standing:
        whole = everything.where(everything.label == label)
        drop_m = path.height_m(whole.along_m) - whole.position_m[:, 2]
        radius_m = ground_radius_m(whole.aside_m, whole.along_m, drop_m, radius_m)
    first = contact(shown.aside_m, shown.along_m, radius_m, DANGER_PIXELS)
    return None if first is None else shown.where(first).position_m.mean(axis=0)


def find_target(
    truth: FlightTruth, age_s: float, path: FlightPath, inside: Points, everything: Points, rules: Rules
) -> Target | None:
    """The nearest target with enough pixels among the points in the cylinder; age_s: of the flight."""
    camera_m = inside.view.world_from_camera.translation_m
    found: list[Target] = []
    for thing in truth.targets:
        shown = inside.where(inside.label == thing.label)
        if len(shown) < DANGER_PIXELS:
            continue
        center_m = thing.position_m + thing.velocity_m_s * age_s
        compact = max(thing.extent_m) <= COMPACT_M
        if rules.meeting and compact:
            compact = thing.standing and shows_center(shown, center_m)
        if compact:
            reference_m = center_m
        elif isinstance(path, Curved):
            met = meeting_point(path, inside, everything, thing.label, thing.standing)
            if met is None:
                continue
            reference_m = met
        else:
            reference_m = shown.position_m.mean(axis=0)
        surface_m = None if compact or rules.meeting else surface_of(everything, thing.label)
        range_m = float(np.linalg.norm(reference_m - camera_m))
        asked_m = rules.band_m(closing_m_s(truth, path, thing))
        nearest_m = float(shown.depth_m.min())
        found.append(
            Target(thing, reference_m, range_m, nearest_m, surface_m, asked_m, rules.meeting and not compact)
        )
    return min(found, key=lambda target: target.range_m, default=None)


def shows_center(shown: Points, center_m: Array) -> bool:
    """A board's or a pole's centre lies at what is seen of it, a vehicle's behind its face."""
    return bool(np.linalg.norm(shown.position_m - center_m, axis=1).min() <= CENTER_M)


def closing_m_s(truth: FlightTruth, path: FlightPath, thing: TrueObject) -> float:
    if isinstance(path, Straight):
        return truth.speed_m_s
    return path.relative_to(thing.velocity_m_s).speed_m_s


def surface_of(points: Points, label: int) -> Array:
    shown = points.where(points.label == label)
    return shown.position_m[thinned(shown)]


def still_surfaces(truth: FlightTruth, frames: tuple[FrameTruth, ...], rules: Rules = PAPER) -> Array:
    """(n, 3) points around the flight path of what does not move, as any of the frames shows it: what is
    narrower than a pixel from afar has pixels of its own in the nearer ones. One point a STILL_M cube. Not of
    ground, where that is judged by the point where the path meets it."""
    still = [
        label
        for label, thing in truth.objects.items()
        if not np.any(thing.velocity_m_s) and (thing.standing or not rules.meeting)
    ]
    cubes = [np.zeros((0, 3), np.int64)]
    for frame in frames:
        shown = frame.around_path.where(np.isin(frame.around_path.label, still))
        cubes.append(np.unique(np.rint(shown.position_m / STILL_M).astype(np.int64), axis=0))
    return np.asarray(np.unique(np.concatenate(cubes), axis=0) * STILL_M, np.float64)


@functools.lru_cache(maxsize=64)
def flight_surfaces(folder: Path, rules: Rules = PAPER) -> Array:
    """The still surfaces of a flight on disk. Raises InputError."""
    return still_surfaces(*flight_frames(folder, rules), rules)


def thinned(points: Points) -> NDArray[np.bool_]:
    """Which points to keep: all of small things; of large ones every ninth and where rows and columns begin,
    since a large thing may have thin parts (the pole below a sign)."""
    counts = np.bincount(points.label, minlength=1)
    on_grid = (points.u_px % THIN_STRIDE_PX == 0) & (points.v_px % THIN_STRIDE_PX == 0)
    begins = run_starts(points.label, points.v_px, points.u_px) | run_starts(
        points.label, points.u_px, points.v_px
    )
    return on_grid | begins | (counts[points.label] <= THIN_ABOVE_PIXELS)


def run_starts(label: NDArray, line_px: NDArray, along_px: NDArray) -> NDArray[np.bool_]:
    """Points whose predecessor on their line is of another label or not there."""
    order = np.lexsort((along_px, line_px))
    kept = np.ones(len(order), bool)
    same = np.diff(label[order].astype(int)) == 0
    kept[1:] = ~(same & (np.diff(line_px[order]) == 0) & (np.diff(along_px[order]) == 1))
    found = np.empty(len(order), bool)
    found[order] = kept
    return found
