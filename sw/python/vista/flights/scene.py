"""Scenes as data: solids in world coordinates with an albedo map, and what counts as an obstacle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from . import textures

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    name: str
    center_m: Point
    size_m: Point  # along its own x, y, z
    albedo: np.ndarray = field(repr=False, compare=False)
    yaw_deg: float = 0.0


@dataclass(frozen=True)
class Board:
    """A flat upright rectangle facing -x, towards the approaching aircraft."""

    name: str
    center_m: Point
    width_m: float
    height_m: float
    albedo: np.ndarray = field(repr=False, compare=False)


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


Solid = Box | Board | Cylinder | Sphere | GroundStrip | Panel | Mesh


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
    """Over d metres of air radiance L becomes L exp(-e d) + airlight (1 - exp(-e d)), e the extinction."""

    extinction_per_m: float  # 3.9 / meteorological visibility
    airlight: float  # radiance


@dataclass(frozen=True)
class Scene:
    """Radiance 1 fills the sensor at exposure 1."""

    things: tuple[Thing, ...]
    to_sun: Point  # direction, world
    sun_irradiance: float = 4.2  # perpendicular to the light
    fill_irradiance: float = 1.1  # stands for the sky's light, from behind the aircraft
    sky: Literal["blue", "overcast"] = "blue"  # overcast: uniform, without any texture
    overcast_radiance: float = 0.9
    haze: Haze | None = None
    exposure: float = 1.0  # times the sensor's own; above 1 clips what is bright

    @property
    def solids(self) -> tuple[Solid, ...]:
        return tuple(solid for thing in self.things for solid in thing.solids)


def bounds_m(solid: Solid) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of the solid's bounding box along the world's axes."""
    match solid:
        case Box():
            cos, sin = abs(np.cos(np.radians(solid.yaw_deg))), abs(np.sin(np.radians(solid.yaw_deg)))
            x, y, z = (side / 2 for side in solid.size_m)
            center, half = np.array(solid.center_m), np.array([cos * x + sin * y, sin * x + cos * y, z])
        case Board():
            center, half = np.array(solid.center_m), np.array([0.0, solid.width_m / 2, solid.height_m / 2])
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
        case GroundStrip():
            low, high = np.array([*zip(solid.x_m, solid.y_m, strict=True)])
            return np.array([*low, 0.0]), np.array([*high, 0.0])
    return center - half, center + half


def thing(name: str, kind: str, solids: Iterable[Solid], standing: bool = True, **more) -> Thing:
    """A thing as large as the bounding box of its solids; width along y, height along z."""
    solids = tuple(solids)
    lows, highs = zip(*(bounds_m(solid) for solid in solids), strict=True)
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    center = tuple(float(c) for c in (low + high) / 2)
    _, width_m, height_m = (float(side) for side in high - low)
    return Thing(name, kind, solids, standing, center, width_m, height_m, **more)


def ground_strip(
    name: str, x_m: tuple[float, float], half_width_m: float, texel_m: float, along: int, seed: int
):
    """A strip whose texels match a pixel's footprint: `texel_m` across, `along` times as long along x.

    The footprint on the ground is stretched by range / height; averaging the albedo over it beforehand is
    what lets a few rays a pixel do without aliasing.
    """
    x = np.arange(x_m[0] + texel_m / 2, x_m[1], texel_m)
    y = np.arange(-half_width_m + texel_m / 2, half_width_m, texel_m)
    fine = textures.ground(*np.meshgrid(x, y, indexing="ij"), seed=seed)
    rows = len(x) // along
    albedo = fine[: rows * along].reshape(rows, along, len(y)).mean(axis=1)
    return GroundStrip(name, x_m, (-half_width_m, half_width_m), albedo)


def meadow(seed: int) -> Thing:
    """Ground out to the horizon, for a flight that ends some 20 m before x = 0."""
    strips = [
        ground_strip("ground_near", (-36.0, 0.0), 24.0, 0.04, 3, seed),
        ground_strip("ground_middle", (0.0, 60.0), 45.0, 0.06, 5, seed),
        ground_strip("ground_far", (60.0, 180.0), 90.0, 0.15, 8, seed),
        ground_strip("ground_horizon", (180.0, 900.0), 360.0, 0.6, 8, seed),
    ]
    return thing("ground", "ground", strips, standing=False)


def tree_line(seed: int, x_m: tuple[float, float] = (95.0, 135.0), half_width_m: float = 64.0) -> list[Thing]:
    """Single trees: clumps of leaves within an ellipsoid crown on a trunk."""
    rng = np.random.default_rng(seed)
    leaves = [textures.foliage(seed + k) for k in range(4)]
    bark = textures.paint(0.12, seed)
    trees: list[Thing] = []
    for tree, y in enumerate(np.arange(-half_width_m, half_width_m, 3.2)):
        foot = np.array([rng.uniform(*x_m), y + rng.uniform(-1.5, 1.5), 0.0])
        height, spread = rng.uniform(6.0, 11.5), rng.uniform(1.8, 2.8)
        top = foot + np.array([0.0, 0.0, 0.6 * height])
        solids: list[Solid] = [Cylinder(f"tree{tree}_trunk", tuple(foot), tuple(top), 0.22, bark)]
        for clump in range(18):
            up = rng.uniform(0.12, 0.95)
            reach = spread * np.sqrt(1 - ((up - 0.5) / 0.52) ** 2) * rng.uniform(0.0, 1.0)
            angle = rng.uniform(0, 2 * np.pi)
            center = foot + np.array([reach * np.cos(angle), reach * np.sin(angle), up * height])
            radius = spread * rng.uniform(0.35, 0.55)
            solids.append(Sphere(f"tree{tree}_clump{clump}", tuple(center), radius, leaves[rng.integers(4)]))
        trees.append(thing(f"tree{tree}", "tree", solids))
    return trees


def far_forest(seed: int) -> Thing:
    """A closed canopy behind the trees, which hides the edge of the ground."""
    rng = np.random.default_rng(seed)
    leaves = textures.foliage(seed + 7)
    solids: list[Solid] = []
    for k, y in enumerate(np.arange(-90.0, 90.0, 2.5)):
        center = (rng.uniform(180.0, 200.0), float(y), rng.uniform(1.0, 3.5))
        solids.append(Sphere(f"forest{k}", center, rng.uniform(4.0, 6.0), leaves))
    return thing("forest", "forest", solids)


def hay_bale(name: str, x_m: float, y_m: float, yaw_deg: float, seed: int) -> Thing:
    """A round bale, 1.5 m across and 1.2 m wide, lying on its side."""
    axis = 0.6 * np.array([np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg)), 0.0])
    center = np.array([x_m, y_m, 0.75])
    bale = Cylinder(name, tuple(center - axis), tuple(center + axis), 0.75, textures.straw(seed))
    return thing(name, "bale", [bale])


def car(name: str, x_m: float, y_m: float, yaw_deg: float, seed: int) -> Thing:
    """Body, glass cabin, roof and four wheels."""
    forward = np.array([np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg)), 0.0])
    left = np.array([-forward[1], forward[0], 0.0])
    foot = np.array([x_m, y_m, 0.0])
    body, glass, tyre = (textures.paint(a, seed + k) for k, a in enumerate((0.55, 0.05, 0.04)))

    def at(ahead_m: float, aside_m: float, up_m: float) -> Point:
        return tuple(foot + ahead_m * forward + aside_m * left + [0, 0, up_m])

    solids: list[Solid] = [
        Box(f"{name}_body", at(0, 0, 0.65), (4.3, 1.75, 0.70), body, yaw_deg),
        Box(f"{name}_cabin", at(-0.2, 0, 1.20), (2.3, 1.55, 0.42), glass, yaw_deg),
        Box(f"{name}_roof", at(-0.2, 0, 1.44), (2.1, 1.55, 0.06), body, yaw_deg),
    ]
    for wheel, (ahead, aside) in enumerate(((1.35, 0.8), (1.35, -0.8), (-1.35, 0.8), (-1.35, -0.8))):
        inner, outer = at(ahead, aside - 0.1, 0.32), at(ahead, aside + 0.1, 0.32)
        solids.append(Cylinder(f"{name}_wheel{wheel}", inner, outer, 0.32, tyre))
    return thing(name, "car", solids)


SIGN_WIDTH_M, SIGN_HEIGHT_M = 40 * 0.0254, 30 * 0.0254
SIGN_POLE_DIAMETER_M = 0.75 * 0.0254


def sign(altitude_m: float, seed: int, x_m: float = 0.0, y_m: float = 0.0) -> Thing:
    """The paper's obstacle: white foamcore 40 in x 30 in on a 0.75 in pole."""
    center = (x_m, y_m, altitude_m)
    print_ = textures.printed_sign(SIGN_WIDTH_M, SIGN_HEIGHT_M, seed)
    radius = SIGN_POLE_DIAMETER_M / 2
    behind = x_m + 2 * radius
    top_m = altitude_m + SIGN_HEIGHT_M / 2
    solids = (
        Board("sign_board", center, SIGN_WIDTH_M, SIGN_HEIGHT_M, print_),
        Cylinder("sign_pole", (behind, y_m, 0.0), (behind, y_m, top_m), radius, textures.paint(0.35, seed)),
    )
    return Thing("sign", "sign", solids, True, center, SIGN_WIDTH_M, SIGN_HEIGHT_M, target=True)


def sign_in_meadow(altitude_m: float, seed: int) -> Scene:
    bales = [
        (3.0, -5.5, 70),
        (9.0, 9.5, 20),
        (24.0, -12.5, 100),
        (31.0, 4.5, 50),
        (52.0, 17.0, 10),
        (47.0, -6.0, 80),
    ]
    things = (
        sign(altitude_m, seed),
        meadow(seed),
        *tree_line(seed),
        far_forest(seed),
        *(hay_bale(f"bale{k}", x, y, yaw, seed + k) for k, (x, y, yaw) in enumerate(bales)),
        car("car", 17.0, -8.0, 62.0, seed),
    )
    return Scene(things, to_sun=(-0.62, 0.48, 0.62))
