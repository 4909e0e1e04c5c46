"""Exact distances from a point to everything of a scene.

Cylinders and spheres are taken as what they are, everything else as its triangles. A tree over blocks of
triangles says which of them have to be looked at; it changes nothing of the result."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vista_eval.render.motion import moves
from vista_eval.render.outlines import outline_of
from vista_eval.render.scene import Cylinder, Scene, Solid, Sphere, Thing

BLOCK, AT_ONCE = 32, 4  # triangles in a block, and blocks that are looked at before any is ruled out
CLOSE_ENOUGH_M = 0.01  # to the least distance on a way
ROUNDING_M = 1e-6


class Near(NamedTuple):
    distance_m: float
    name: str  # of the thing


# ---- closed forms ----


def prepared(corners_m: np.ndarray) -> np.ndarray:
    """(n, 10, 3) what the distance from triangles (n, 3, 3) takes that does not depend on the point: where
    the edges begin, the edges, the inverse of their squared lengths, and the three vectors that turn a way
    from the first corner into its two shares of the edges there and its height above the plane. Triangles
    without area have no such vectors."""
    a, b, c = corners_m[:, 0], corners_m[:, 1], corners_m[:, 2]
    edges = np.stack([b - a, c - a, c - b], axis=1)
    inverse = 1.0 / np.maximum(np.einsum("nij,nij->ni", edges, edges), 1e-300)
    normal = np.cross(edges[:, 0], edges[:, 1])
    square = dots(normal, normal)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = [np.cross(edges[:, 1], normal) / square, np.cross(normal, edges[:, 0]) / square]
        plane = np.stack([*across, normal / np.sqrt(square)], axis=1)
    return np.concatenate([np.stack([a, a, b], axis=1), edges, inverse[:, None], plane], axis=1)


def to_triangles_m(point: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(n,) distances to prepared triangles, by the regions of Voronoi of corners, edges and face
    (Ericson 2005)."""
    starts, edges, inverse, plane = np.split(triangles, (3, 6, 7), axis=1)
    away = point - starts
    share = np.clip(np.einsum("nij,nij->ni", away, edges) * inverse[:, 0], 0.0, 1.0)
    gap = away - share[..., None] * edges
    nearest = np.sqrt(np.einsum("nij,nij->ni", gap, gap).min(axis=1))
    second, third, height = np.einsum("nij,nj->in", plane, away[:, 0])
    inside = (second >= 0) & (third >= 0) & (second + third <= 1)
    return np.where(inside, np.abs(height), nearest)


def to_cylinders_m(point: np.ndarray, start: np.ndarray, end: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """(n,) distances to solid cylinders with flat ends; 0 inside."""
    along = end - start
    length = np.linalg.norm(along, axis=1)
    axis = along / length[:, None]
    height = dots(point - start, axis)
    off_axis = np.linalg.norm(point - start - height[:, None] * axis, axis=1)
    beyond = np.maximum(np.maximum(-height, height - length), 0.0)
    return np.hypot(beyond, np.maximum(off_axis - radius, 0.0))


def dots(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", np.broadcast_to(first, second.shape), second)


# ---- scenes ----


class Triangles:
    """Triangles in blocks, each with its bounding box."""

    def __init__(self, corners_m: np.ndarray, owner: np.ndarray) -> None:
        order = np.argsort(morton(corners_m.mean(axis=1)), kind="stable")
        self.corners_m, self.owner = corners_m[order].astype(float), owner[order]
        self.prepared: dict[int, np.ndarray] = {}  # by block, of those that were looked at
        starts = np.arange(0, len(order), BLOCK)
        self.low_m = np.minimum.reduceat(self.corners_m.min(axis=1), starts, axis=0)
        self.high_m = np.maximum.reduceat(self.corners_m.max(axis=1), starts, axis=0)

    def nearest(self, point: np.ndarray, most_m: float) -> tuple[float, int]:
        """Distance and owner of the nearest one; `most_m` and -1 if none is nearer than that."""
        outside = np.maximum(np.maximum(self.low_m - point, point - self.high_m), 0.0)
        bound = np.sqrt(dots(outside, outside))
        best, owner = most_m, -1
        blocks = np.flatnonzero(bound < best)
        blocks = blocks[np.argsort(bound[blocks], kind="stable")]
        for first, last in ((0, AT_ONCE), (AT_ONCE, len(blocks))):  # those first that leave few of the others
            chosen = blocks[first:last]
            chosen = chosen[bound[chosen] < best]
            if len(chosen):
                numbers = chosen.tolist()
                distance = to_triangles_m(point, np.concatenate([self.block(k) for k in numbers]))
                k = int(np.argmin(distance))
                if distance[k] < best:
                    owners = np.concatenate([self.owner[b * BLOCK : (b + 1) * BLOCK] for b in numbers])
                    best, owner = float(distance[k]), int(owners[k])
        return best, owner

    def block(self, k: int) -> np.ndarray:
        if k not in self.prepared:
            self.prepared[k] = prepared(self.corners_m[k * BLOCK : (k + 1) * BLOCK])
        return self.prepared[k]


def morton(points_m: np.ndarray) -> np.ndarray:
    """A number of each point, such that near points have near numbers."""
    low = points_m.min(axis=0)
    span = max(float((points_m.max(axis=0) - low).max()), 1e-9)
    place = ((points_m - low) / span * 1023).astype(np.int64)
    spread = np.zeros(len(points_m), np.int64)
    for bit in range(10):
        for axis in range(3):
            spread |= ((place[:, axis] >> bit) & 1) << (3 * bit + axis)
    return spread


class Standing:
    """Things that share one motion."""

    def __init__(self, things: list[tuple[int, Thing]]) -> None:
        parts = [(k, solid) for k, thing in things for solid in thing.solids]
        faces = [(k, triangles_of(solid)) for k, solid in parts if not isinstance(solid, Cylinder | Sphere)]
        self.triangles = None
        if faces:
            owner = np.repeat([k for k, _ in faces], [len(each) for _, each in faces])
            self.triangles = Triangles(np.concatenate([each for _, each in faces]), owner)
        rods = [(k, solid) for k, solid in parts if isinstance(solid, Cylinder)]
        self.rod_owner = [k for k, _ in rods]
        self.start_m, self.end_m = (
            np.array([getattr(rod, name) for _, rod in rods], float).reshape(-1, 3)
            for name in ("start_m", "end_m")
        )
        self.radius_m = np.array([rod.radius_m for _, rod in rods], float)
        balls = [(k, solid) for k, solid in parts if isinstance(solid, Sphere)]
        self.ball_owner = [k for k, _ in balls]
        self.center_m = np.array([ball.center_m for _, ball in balls], float).reshape(-1, 3)
        self.ball_m = np.array([ball.radius_m for _, ball in balls], float)

    def nearest(self, point: np.ndarray, most_m: float) -> tuple[float, int]:
        best, owner = most_m, -1
        round_ones = (
            (self.rod_owner, to_cylinders_m(point, self.start_m, self.end_m, self.radius_m)),
            (self.ball_owner, np.maximum(np.linalg.norm(point - self.center_m, axis=1) - self.ball_m, 0.0)),
        )
        for owners, distance in round_ones:
            if owners and distance.min() < best:
                best, owner = float(distance.min()), owners[int(np.argmin(distance))]
        if self.triangles is not None:
            distance_m, whose = self.triangles.nearest(point, best)
            if whose >= 0:
                best, owner = distance_m, whose
        return best, owner


def triangles_of(solid: Solid) -> np.ndarray:
    outline = outline_of(solid)
    return np.asarray(outline.vertices_m, float)[np.asarray(outline.faces, np.int64)]


class Geometry:
    """All that stands or moves in a scene; things that sway are taken where they stand."""

    def __init__(self, scene: Scene, ground: bool = False) -> None:
        """ground: whether it counts as well."""
        counted = [(k, thing) for k, thing in enumerate(scene.things) if thing.standing or ground]
        self.names = [thing.name for thing in scene.things]
        self.groups: list[tuple[np.ndarray, Standing]] = []
        still = [(k, thing) for k, thing in counted if not moves(thing) or thing.sway is not None]
        if still:
            self.groups.append((np.zeros(3), Standing(still)))
        for k, thing in counted:
            if moves(thing) and thing.sway is None:
                self.groups.append((np.array(thing.velocity_m_s, float), Standing([(k, thing)])))
        self.fastest_m_s = max((float(np.linalg.norm(velocity)) for velocity, _ in self.groups), default=0.0)

    def nearest(self, point_m: np.ndarray, t_s: float = 0.0, most_m: float = np.inf) -> Near:
        """The nearest surface at a time after which the scene stands as it is described."""
        best, owner = most_m, -1
        for velocity, group in self.groups:
            distance_m, whose = group.nearest(np.asarray(point_m, float) - velocity * t_s, best)
            if whose >= 0:
                best, owner = distance_m, whose
        return Near(best, self.names[owner] if owner >= 0 else "")

    def nearest_on_way(
        self, first: Near, start_m: np.ndarray, end_m: np.ndarray, t_s: float, duration_s: float
    ) -> tuple[Near, Near]:
        """The least distance, within CLOSE_ENOUGH_M, on a straight way that is flown from t_s on, and that at
        its end: no distance changes by more than the way and the motion of things together. first: that at
        the start."""
        way = float(np.linalg.norm(end_m - start_m)) + self.fastest_m_s * duration_s
        last = self.nearest(end_m, t_s + duration_s, first.distance_m + way + ROUNDING_M)
        least = min(first, last, key=lambda near: near.distance_m)
        if (first.distance_m + last.distance_m - way) / 2 >= least.distance_m - CLOSE_ENOUGH_M:
            return least, last
        half_s, middle_m = duration_s / 2, (start_m + end_m) / 2
        before, middle = self.nearest_on_way(first, start_m, middle_m, t_s, half_s)
        after, last = self.nearest_on_way(middle, middle_m, end_m, t_s + half_s, half_s)
        return min(before, after, key=lambda near: near.distance_m), last
