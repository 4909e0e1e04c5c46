"""Scenes as data: solids in world coordinates with an albedo map, and what counts as an obstacle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Cylinder:
    name: str
    start_m: Point
    end_m: Point
    radius_m: float
    albedo: np.ndarray = field(repr=False, compare=False)


@dataclass(frozen=True)
class Sphere:
    name: str
    center_m: Point
    radius_m: float
    albedo: np.ndarray = field(repr=False, compare=False)


@dataclass(frozen=True)
class GroundStrip:
    """Part of the plane z = 0; albedo rows run along +x, columns along +y."""

    name: str
    x_m: tuple[float, float]
    y_m: tuple[float, float]
    albedo: np.ndarray = field(repr=False, compare=False)


@dataclass(frozen=True)
class Panel:
    """A flat rectangle anyhow in space, seen from both sides; row 0 is the edge at `center - half_down`."""

    name: str
    center_m: Point
    half_right_m: Point  # along the columns of the albedo
    half_down_m: Point  # along its rows
    albedo: np.ndarray = field(repr=False, compare=False)


@dataclass(frozen=True)
class Mesh:
    """Triangles, each vertex with its albedo; seen from both sides."""

    name: str
    vertices_m: np.ndarray = field(repr=False, compare=False)  # (N, 3)
    faces: np.ndarray = field(repr=False, compare=False)  # (M, 3), indices into the vertices
    albedo: np.ndarray = field(repr=False, compare=False)  # (N,)


@dataclass(frozen=True)
class HeightField:
    """Ground over a rectangle of the world. Rows of both arrays run along +x, their columns along +y.

    The outermost heights stand on the rectangle's rim and those between at even distances, with a flat
    triangle on either side of the diagonal from (x, y) to (x + dx, y + dy). The albedo is a map of the whole
    rectangle, usually much finer: the middle of its texel (0, 0) is half a texel from the rim."""

    name: str
    x_m: tuple[float, float]
    y_m: tuple[float, float]
    height_m: np.ndarray = field(repr=False, compare=False)  # (R, C), R and C at least 2
    albedo: np.ndarray = field(repr=False, compare=False)

    def vertices_m(self) -> np.ndarray:
        """(R * C, 3), row by row."""
        rows, columns = self.height_m.shape
        x, y = np.meshgrid(np.linspace(*self.x_m, rows), np.linspace(*self.y_m, columns), indexing="ij")
        return np.stack([x, y, self.height_m], axis=-1).reshape(-1, 3)

    def faces(self) -> np.ndarray:
        """(2 (R - 1) (C - 1), 3), indices into the vertices, counter-clockwise as seen from above."""
        rows, columns = self.height_m.shape
        index = np.arange(rows * columns).reshape(rows, columns)
        here, ahead, left, across = index[:-1, :-1], index[1:, :-1], index[:-1, 1:], index[1:, 1:]
        pairs = np.stack([np.stack([here, ahead, across], -1), np.stack([here, across, left], -1)], axis=2)
        return pairs.reshape(-1, 3)


Solid = Cylinder | Sphere | GroundStrip | Panel | Mesh | HeightField


@dataclass(frozen=True)
class Thing:
    """What one label of the truth stands for: a whole tree, a car, a facade, the ground."""

    name: str  # unique in its scene
    kind: str  # "sign", "pole", "tree", "car", "bale", "facade", "fence", "ground", "tarpaulin", ...
    solids: tuple[Solid, ...]
    standing: bool  # an obstacle in life, as against ground, road, tarpaulin, track
    center_m: Point
    width_m: float
    height_m: float
    target: bool = False  # what the aircraft flies at
    velocity_m_s: Point = (0.0, 0.0, 0.0)  # world; the solids stand where they are at the last frame
    sway: Sway | None = None  # in the wind


@dataclass(frozen=True)
class Sway:
    """Every solid but upright cylinders (trunks) moves to and fro across the wind, each in its own phase."""

    amplitude_m: float
    frequency_hz: float


@dataclass(frozen=True)
class Haze:
    """The haze of the air: over d metres radiance L becomes L exp(-e d) + airlight (1 - exp(-e d)), e the
    extinction."""

    extinction_per_m: float  # 3.9 / meteorological visibility
    airlight: float  # radiance


@dataclass(frozen=True)
class Scene:
    """Radiance 1 fills the sensor at exposure 1."""

    things: tuple[Thing, ...]
    to_sun: Point  # direction, world
    sun_irradiance: float = 4.2  # perpendicular to the light
    fill_irradiance: float = 1.1  # stands for the sky's light, from behind the aircraft
    sky: Literal["blue", "clouds", "overcast"] = "blue"  # overcast: uniform, without any texture
    overcast_radiance: float = 0.9
    haze: Haze | None = None
    exposure: float = 1.0  # times the sensor's own; above 1 clips what is bright

    @property
    def solids(self) -> tuple[Solid, ...]:
        return tuple(solid for thing in self.things for solid in thing.solids)


def board(name: str, center_m: Point, width_m: float, height_m: float, albedo: np.ndarray) -> Panel:
    """An upright panel that faces -x, towards the approaching aircraft."""
    return Panel(name, center_m, (0.0, -width_m / 2, 0.0), (0.0, 0.0, -height_m / 2), albedo)


def bounds_m(solid: Solid) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of the solid's bounding box along the world's axes."""
    match solid:
        case Cylinder():
            ends = np.array([solid.start_m, solid.end_m])
            axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
            half = np.abs(ends[1] - ends[0]) / 2 + solid.radius_m * np.sqrt(np.clip(1 - axis**2, 0, 1))
            center = ends.mean(axis=0)
        case Sphere():
            center, half = np.array(solid.center_m), np.full(3, solid.radius_m)
        case Panel():
            center = np.array(solid.center_m)
            half = np.abs(solid.half_right_m) + np.abs(solid.half_down_m)
        case Mesh():
            return solid.vertices_m.min(axis=0), solid.vertices_m.max(axis=0)
        case GroundStrip() | HeightField():
            low, high = np.array([*zip(solid.x_m, solid.y_m, strict=True)])
            heights_m = solid.height_m if isinstance(solid, HeightField) else np.zeros(1)
            return np.array([*low, heights_m.min()]), np.array([*high, heights_m.max()])
    return center - half, center + half


def thing(name: str, kind: str, solids: Iterable[Solid], standing: bool = True, **more) -> Thing:
    """A thing as large as the bounding box of its solids; width along y, height along z."""
    solids = tuple(solids)
    lows, highs = zip(*(bounds_m(solid) for solid in solids), strict=True)
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    x_m, y_m, z_m = (float(c) for c in (low + high) / 2)
    _, width_m, height_m = (float(side) for side in high - low)
    return Thing(name, kind, solids, standing, (x_m, y_m, z_m), width_m, height_m, **more)
