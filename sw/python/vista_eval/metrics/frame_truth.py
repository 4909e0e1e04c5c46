"""The truth of each frame of a flight: surfaces around the flight's path, target, standing obstacles."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.geometry import Array, Pose
from vista.sequence import open_sequence

from vista_eval.dataset.truth import FlightTruth, TrueObject, read_truth

CYLINDER_RADIUS_M, CYLINDER_LENGTH_M = 2.0, 100.0
INFLATION_M = 1.0
COMPACT_M = 3.0  # largest side of a target whose centre is a point to aim at
DANGER_PIXELS = 20  # of the target in the cylinder; the sign has 40 at 150 m
STANDING_PIXELS = 50  # fewer: no obstacle of this frame to GOSPA
THIN_ABOVE_PIXELS, THIN_STRIDE_PX = 4000, 3  # a wall needs no point a pixel; within BEARING_MARGIN_PX
STILL_M = 0.1
SURFACE_POINTS = 256  # of a standing object, for its distance from a track


@dataclass(frozen=True)
class Points:
    """Points of pixels of the exact disparity map, one an entry."""

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
    surface_m: Array | None  # (n, 3) what is seen of it; None: it is compact, P is its own centre


@dataclass(frozen=True)
class FrameTruth:
    t_ns: int
    world_from_camera: Pose
    around_path: Points  # in the inflated cylinder
    in_cylinder: NDArray[np.bool_]  # of around_path
    target: Target | None  # None: no target is a true danger
    surfaces: dict[int, Array]  # (k, 3) seen points of each standing object, by label

    @functools.cached_property
    def of_target(self) -> Points:
        """The target's points in the cylinder; none without a target."""
        label = -1 if self.target is None else self.target.object.label
        return self.around_path.where(self.in_cylinder & (self.around_path.label == label))


@functools.lru_cache(maxsize=64)
def flight_frames(folder: Path) -> tuple[FlightTruth, tuple[FrameTruth, ...]]:
    """The truth of a flight on disk. Raises InputError."""
    truth = read_truth(folder)
    frames = open_sequence(folder).frames
    poses = {f.t_ns: f.world_from_camera for f in frames if f.world_from_camera is not None}
    missing = [t_ns for t_ns in truth.times_ns if t_ns not in poses]
    if missing:
        raise InputError(folder, f"no pose at {missing[0]}, a frame of truth.json")
    direction = flight_direction([poses[t_ns] for t_ns in truth.times_ns])
    return truth, tuple(frame_truth(truth, k, poses[t], direction) for k, t in enumerate(truth.times_ns))


def flight_direction(poses: list[Pose]) -> Array:
    """Unit vector of the whole flight's travel, world; of a still camera its optical axis."""
    travel_m = poses[-1].translation_m - poses[0].translation_m
    length_m = float(np.linalg.norm(travel_m))
    return travel_m / length_m if length_m > 1e-6 else poses[0].rotation[:, 2]


def frame_truth(truth: FlightTruth, index: int, world_from_camera: Pose, direction: Array) -> FrameTruth:
    t_ns = truth.times_ns[index]
    points = true_points(truth, t_ns, world_from_camera, direction)
    reach_m = CYLINDER_RADIUS_M + INFLATION_M
    near = (points.aside_m <= reach_m) & (points.along_m > 0.0)
    near &= points.along_m <= CYLINDER_LENGTH_M + INFLATION_M
    around = points.where(near)
    inside = (around.aside_m <= CYLINDER_RADIUS_M) & (around.along_m <= CYLINDER_LENGTH_M)
    age_s = (t_ns - truth.times_ns[0]) / 1e9
    target = find_target(truth, age_s, world_from_camera, around.where(inside), points)
    kept = thinned(around)
    surfaces = standing_surfaces(truth, points)
    return FrameTruth(t_ns, world_from_camera, around.where(kept), inside[kept], target, surfaces)


def true_points(truth: FlightTruth, t_ns: int, world_from_camera: Pose, direction: Array) -> Points:
    """One a pixel that shows a surface; direction: unit vector of the flight path."""
    view = View(world_from_camera, truth.focal_px, truth.center_px)
    disparity_px = truth.disparity_px(t_ns)
    v, u = np.nonzero(disparity_px)
    depth_m = truth.focal_baseline_px_m / disparity_px[v, u]
    x, y = view.rays(u, v)
    d = (world_from_camera.rotation.T @ direction).astype(np.float32)
    along_m = depth_m * (x * d[0] + y * d[1] + d[2])
    square_m2 = depth_m**2 * (x * x + y * y + 1)
    return Points(
        view,
        u.astype(np.int32),
        v.astype(np.int32),
        truth.labels(t_ns)[v, u],
        depth_m,
        np.sqrt(square_m2),
        np.sqrt(np.maximum(square_m2 - along_m**2, 0)),
        along_m,
    )


def find_target(
    truth: FlightTruth, age_s: float, world_from_camera: Pose, inside: Points, everything: Points
) -> Target | None:
    """The nearest target with enough pixels among the points in the cylinder; age_s: of the flight."""
    camera_m = world_from_camera.translation_m
    found: list[Target] = []
    for thing in truth.targets:
        shown = inside.where(inside.label == thing.label)
        if len(shown) < DANGER_PIXELS:
            continue
        compact = max(thing.extent_m) <= COMPACT_M
        center_m = thing.position_m + thing.velocity_m_s * age_s
        reference_m = center_m if compact else shown.position_m.mean(axis=0)
        surface_m = None if compact else surface_of(everything, thing.label)
        range_m = float(np.linalg.norm(reference_m - camera_m))
        found.append(Target(thing, reference_m, range_m, float(shown.depth_m.min()), surface_m))
    return min(found, key=lambda target: target.range_m, default=None)


def surface_of(points: Points, label: int) -> Array:
    shown = points.where(points.label == label)
    return shown.position_m[thinned(shown)]


def still_surfaces(truth: FlightTruth, frames: tuple[FrameTruth, ...]) -> Array:
    """(n, 3) points around the flight path of what does not move, as any of the frames shows it: what is
    narrower than a pixel from afar has pixels of its own in the nearer ones. One point a STILL_M cube."""
    still = [label for label, thing in truth.objects.items() if not np.any(thing.velocity_m_s)]
    cubes = [np.zeros((0, 3), np.int64)]
    for frame in frames:
        shown = frame.around_path.where(np.isin(frame.around_path.label, still))
        cubes.append(np.unique(np.rint(shown.position_m / STILL_M).astype(np.int64), axis=0))
    return np.asarray(np.unique(np.concatenate(cubes), axis=0) * STILL_M, np.float64)


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


def standing_surfaces(truth: FlightTruth, points: Points) -> dict[int, Array]:
    order = np.argsort(points.label, kind="stable")
    labels, first = np.unique(points.label[order], return_index=True)
    surfaces = {}
    for label, members in zip(labels, np.split(order, first[1:]), strict=True):
        thing = truth.objects.get(int(label))
        if thing is not None and thing.standing and len(members) >= STANDING_PIXELS:
            chosen = np.linspace(0, len(members) - 1, min(len(members), SURFACE_POINTS)).astype(int)
            surfaces[int(label)] = points.where(members[chosen]).position_m
    return surfaces
