"""The parts that the worlds are built from: level ground, textured boxes, trees with a bare trunk, poles."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Cylinder, GroundStrip, Panel, Point, Scene, Solid, Thing, thing
from vista_eval.worlds import things, walls
from vista_eval.worlds.draws import draws, some_seed
from vista_eval.worlds.grounds import COVERS
from vista_eval.worlds.light import light
from vista_eval.worlds.sampled.trees import pine
from vista_eval.worlds.triangles import Triangles, joined, placed, turned
from vista_eval.worlds.vegetation import conifer

WALL_M = 0.04
FINE_M, COARSE_M = 0.06, 0.5  # texels of the ground where the flight goes, and around it
AROUND_M, HORIZON_M = 60.0, 700.0
GRID = 8  # cells along each edge of a box of triangles
TUFT_M = 0.4


def level_ground(x_m: tuple[float, float], y_m: tuple[float, float], cover: str, seed: int) -> Thing:
    """Ground that is fine within the rectangle, coarser around it, and plain to the horizon."""
    kind = COVERS[cover]

    def strip(name: str, xs: tuple[float, float], ys: tuple[float, float], texel_m: float) -> GroundStrip:
        rows, columns = (max(2, round((b - a) / texel_m)) for a, b in (xs, ys))
        x = np.linspace(*xs, rows, endpoint=False, dtype=np.float32)[:, None]
        y = np.linspace(*ys, columns, endpoint=False, dtype=np.float32)[None, :]
        return GroundStrip(name, xs, ys, np.clip(kind.albedo(x, y, seed), 0.02, 0.9).astype(np.float32))

    (x0, x1), (y0, y1) = x_m, y_m
    solids: list[Solid] = [strip("ground", x_m, y_m, FINE_M)]
    inner = (x0, x1, y0, y1)
    for ring, (reach, texel) in enumerate(((AROUND_M, COARSE_M), (HORIZON_M, 4 * COARSE_M))):
        a, b, c, d = inner
        outer = a - reach, b + reach, c - reach, d + reach
        sides = (
            ((outer[0], a), (outer[2], outer[3])),
            ((b, outer[1]), (outer[2], outer[3])),
            ((a, b), (outer[2], c)),
            ((a, b), (d, outer[3])),
        )
        solids += [strip(f"ground{ring}{k}", xs, ys, texel) for k, (xs, ys) in enumerate(sides)]
        inner = outer
    return thing("ground", "ground", solids, standing=False)


def scene(
    seed: int, cover: str, standing: list[Thing], x_m: tuple[float, float], y_m: tuple[float, float]
) -> Scene:
    """Ground of this cover under everything, in light that follows from the seed."""
    base = level_ground(x_m, y_m, cover, seed)
    return Scene((base, *standing), **light(seed, COVERS[cover].mean))


def upright_box(
    name: str,
    foot_m: tuple[float, float],
    size_m: tuple[float, float, float],
    turn_deg: float,
    seed: int,
    texel_m: float = WALL_M,
) -> Thing:
    """A box on the ground, its first side along x before it is turned, each side faced with its own wall."""
    rng = draws(seed, name)
    length, width, height = size_m
    corners = np.array([[-1, 1], [-1, -1], [1, -1], [1, 1]]) * [length / 2, width / 2]
    feet = turned(np.column_stack([corners, np.zeros(4)]), turn_deg) + np.array([*foot_m, 0.0])
    solids: list[Solid] = []
    for k in range(4):
        left, right = feet[k], feet[(k + 1) % 4]
        face = walls.TEXTURED[int(rng.integers(len(walls.TEXTURED)))]
        albedo = face(float(np.linalg.norm(right - left)), height, some_seed(rng), texel_m)
        solids.append(things.rectangle(f"{name}_{k}", left, right, height, albedo))
    top = walls.roughcast(length, width, some_seed(rng), max(texel_m, 0.1))
    middle, along, aside = feet.mean(axis=0), (feet[3] - feet[0]) / 2, (feet[0] - feet[1]) / 2
    middle[2] = height
    solids.append(Panel(f"{name}_top", tuple(middle), tuple(aside), tuple(along), top))
    return thing(name, "box", solids)


def grid_box(size_m: np.ndarray, turn_deg: float, rng: np.random.Generator) -> Triangles:
    """A box around the origin as triangles whose shade changes from corner to corner: it can move, since
    nothing of it has a map that would have to be made anew."""
    steps = np.linspace(-0.5, 0.5, GRID + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    index = np.arange((GRID + 1) ** 2).reshape(GRID + 1, GRID + 1)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    parts = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            points = np.insert(np.column_stack([u, v]), axis, side, axis=1) * size_m
            shade = np.clip(rng.uniform(0.15, 0.5) * rng.lognormal(0.0, 0.5, len(points)), 0.03, 0.8)
            parts.append(Triangles(points, faces, shade))
    return placed(joined(*parts), (0, 0, 0), turn_deg)


def small_conifer(rng: np.random.Generator) -> Triangles:
    """A young spruce with branches down to the ground."""
    height = float(rng.uniform(3.0, 5.5))
    return conifer(height, 0.2 * height, rng, 0.25)


def trees(places_m: list[tuple[float, float]], seed: int, young: float = 0.2, kinds: int = 6) -> list[Thing]:
    """Trees at these places, of a few kinds that are turned and scaled. young: share of small conifers."""
    rng = draws(seed, "trees")
    tall = [
        pine(float(rng.uniform(7, 12)), float(rng.uniform(0.12, 0.35)), rng, TUFT_M) for _ in range(kinds)
    ]
    low = [small_conifer(rng) for _ in range(kinds)]
    found = []
    for k, (x, y) in enumerate(places_m):
        among = low if rng.random() < young else tall
        shape = placed(
            among[int(rng.integers(kinds))],
            (x, y, 0.0),
            float(rng.uniform(0, 360)),
            float(rng.uniform(0.85, 1.15)),
        )
        found.append(thing(f"tree{k}", "tree", [things.mesh(f"tree{k}", shape)]))
    return found


def pole(name: str, foot_m: tuple[float, float], radius_m: float, height_m: float, albedo: float) -> Thing:
    """An upright pole with bands."""
    bands = np.repeat(np.clip(albedo * np.array([1.0, 0.4, 1.3, 0.6]), 0.03, 0.85), 2)[:, None]
    x, y = foot_m
    solid = Cylinder(
        name, (x, y, 0.0), (x, y, height_m), radius_m, np.repeat(bands, 2, axis=1).astype(np.float32)
    )
    return thing(name, "pole", [solid])


def away_from(
    points_m: list[tuple[float, float]], keep_m: list[tuple[Point, float]]
) -> list[tuple[float, float]]:
    """Those that are as far from each place as is asked."""
    return [
        (x, y) for x, y in points_m if all(np.hypot(x - at[0], y - at[1]) > apart for at, apart in keep_m)
    ]


def distance_to_leg_m(x: float, y: float, start: Point, end: Point) -> float:
    a, b, p = np.array(start[:2]), np.array(end[:2]), np.array([x, y])
    share = float(np.clip((p - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-12), 0, 1))
    return float(np.linalg.norm(p - a - share * (b - a)))
