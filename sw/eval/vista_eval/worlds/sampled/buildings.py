"""Walls and buildings across the path: plain, of repeated windows, sheet metal, dark glass, corners."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vista_eval.render.scene import Panel, Scene, Solid, Thing, thing
from vista_eval.worlds import things, walls
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import some_seed
from vista_eval.worlds.grounds import BUILT_UP
from vista_eval.worlds.site import URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import box, joined, polygon

AT_BUILDINGS = Courses(altitude_m=(3.0, 14.0), climb_deg=(-8.0, 5.0), most_bank_deg=20.0)
FRONT_TEXEL_M, OTHER_TEXEL_M = 0.02, 0.04
SLOPE_OF_ROOF = (0.35, 1.0)

Range = tuple[float, float]


def block(
    name: str,
    corners_m: np.ndarray,
    height_m: float,
    faces: Sequence[walls.Wall],
    rng: np.random.Generator,
    pitched: bool = False,
    **more,
) -> Thing:
    """A block on four feet (4, 2), seen from outside from left to right, the first face nearest. `faces`: of
    each."""
    feet = np.column_stack([corners_m, np.zeros(4)])
    solids: list[Solid] = []
    for k, face in enumerate(faces):
        left, right = feet[k], feet[(k + 1) % 4]
        texel = FRONT_TEXEL_M if k == 0 else OTHER_TEXEL_M
        albedo = face(float(np.linalg.norm(right - left)), height_m, some_seed(rng), texel)
        solids.append(things.rectangle(f"{name}_face{k}", left, right, height_m, albedo))
    solids += roof(name, np.column_stack([corners_m, np.full(4, height_m)]), pitched, rng)
    return thing(name, "building", solids, **more)


def roof(name: str, eaves_m: np.ndarray, pitched: bool, rng: np.random.Generator) -> list[Solid]:
    shade = float(rng.uniform(0.08, 0.35))
    if not pitched:
        middle, across = eaves_m.mean(axis=0), (eaves_m[1] - eaves_m[0]) / 2
        along = (eaves_m[3] - eaves_m[0]) / 2
        wide, long = (2 * float(np.linalg.norm(half)) for half in (across, along))
        albedo = walls.roughcast(wide, long, some_seed(rng), 0.1) * shade * 2
        flat = Panel(f"{name}_roof", tuple(middle), tuple(across), tuple(-along), albedo)
        boxes = []
        for _ in range(int(rng.integers(0, 5))):
            u, v, side = *rng.uniform(-0.7, 0.7, 2), rng.uniform(0.6, 2.2)
            place = middle + u * across + v * along + [0, 0, side / 2]
            boxes.append(box(place, (side, 1.3 * side, side), float(rng.uniform(0.2, 0.6))))
        return [flat, *([things.mesh(f"{name}_units", joined(*boxes))] if boxes else [])]
    a, b, c, d = eaves_m
    depth = np.linalg.norm(d - a)
    up = np.array([0, 0, float(rng.uniform(*SLOPE_OF_ROOF)) * depth / 2])
    left, right = (a + d) / 2 + up, (b + c) / 2 + up
    seed = some_seed(rng)
    slopes = []
    for k, (low_left, low_right, high) in enumerate(((a, b, right), (c, d, left))):
        half_right, half_down = (low_right - low_left) / 2, (low_right - high) / 2
        wide, long = (2 * float(np.linalg.norm(half)) for half in (half_right, half_down))
        tiles = np.clip(walls.boards(wide, long, seed + k, 0.05) * shade * 4, 0.02, 0.85)
        middle = low_left + half_right - half_down
        slopes.append(Panel(f"{name}_slope{k}", tuple(middle), tuple(half_right), tuple(half_down), tiles))
    gables = joined(polygon([d, a, left], 2 * shade), polygon([b, c, right], 2 * shade))
    return [*slopes, things.mesh(f"{name}_gables", gables)]


def rectangle_m(nearest_m: tuple[float, float], width_m: float, depth_m: float, yaw_deg: float) -> np.ndarray:
    """Feet (4, 2) of a block whose front's middle is at a point and faces -x, turned by yaw."""
    turn = np.radians(yaw_deg)
    right, back = np.array([np.sin(turn), -np.cos(turn)]), np.array([np.cos(turn), np.sin(turn)])
    left_foot = np.array(nearest_m) - width_m / 2 * right
    ends = [left_foot, left_foot + width_m * right]
    return np.array([*ends, ends[1] + depth_m * back, ends[0] + depth_m * back])


def across_the_path(
    here: Site,
    front: Sequence[walls.Wall],
    others: Sequence[walls.Wall],
    *,
    width_m: Range = (14, 45),
    over_m: Range = (2.5, 12),
    depth_m: Range = (7, 16),
) -> Thing:
    """A building whose front the path meets, up to 35 degrees askew and somewhere along it."""
    rng = here.draws("building")
    width, yaw = float(rng.uniform(*width_m)), float(rng.uniform(-35, 35))
    height = here.altitude_m + float(rng.uniform(*over_m))
    depth = float(rng.uniform(*depth_m))
    turn, off = np.radians(yaw), rng.uniform(-0.35, 0.35) * width
    middle = (float(off * np.sin(turn)), float(-off * np.cos(turn)))
    faces = [front[int(rng.integers(len(front)))], *[others[int(rng.integers(len(others)))]] * 3]
    corners = rectangle_m(middle, width, depth, yaw)
    return block("target", corners, height, faces, rng, rng.random() < 0.3, target=True)


def before_a_building(here: Site, target: Thing) -> Scene:
    return scene_of(here, [target], [*clutter(here, URBAN), *background(here)])


def plain_wall(altitude_m: float, seed: int) -> Scene:
    """Fresh plaster: a free-standing wall, or a house without windows."""
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    depth = (0.3, 0.5) if here.draws("free").random() < 0.5 else (7.0, 14.0)
    target = across_the_path(here, [walls.plain], [walls.plain], depth_m=depth, over_m=(1.5, 6.0))
    return before_a_building(here, target)


def repeated_windows(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    return before_a_building(here, across_the_path(here, [walls.windows], [walls.windows, walls.plain]))


def stone_house(altitude_m: float, seed: int) -> Scene:
    """Brick, rubble, weathered plaster, with windows that differ or none."""
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    front = [walls.lived_in, walls.brick, walls.ashlar, walls.roughcast]
    return before_a_building(here, across_the_path(here, front, [walls.roughcast, walls.brick]))


def hall(altitude_m: float, seed: int) -> Scene:
    """Sheet metal of one rib after another, cast slabs, boards: a works hall."""
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    front = [walls.corrugated, walls.corrugated, walls.concrete_panels, walls.boards]
    return before_a_building(here, across_the_path(here, front, [walls.corrugated], width_m=(20, 60)))


def glass_front(altitude_m: float, seed: int) -> Scene:
    """Dark panes that mirror an even sky."""
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    target = across_the_path(here, [walls.dark_glass], [walls.dark_glass], over_m=(4, 25), width_m=(16, 40))
    return before_a_building(here, target)


def corner(altitude_m: float, seed: int) -> Scene:
    """The edge between two faces, each seen at 25 to 65 degrees, within 1 m of the path."""
    here = site(altitude_m, seed, AT_BUILDINGS, BUILT_UP)
    rng = here.draws("corner")
    faces = [walls.plain, walls.windows, walls.dark_glass, *walls.TEXTURED, walls.corrugated]
    turn = np.radians(rng.uniform(25, 65))
    first, second = np.array([np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), -np.sin(turn)])
    edge = np.array([0.0, rng.uniform(-1.0, 1.0)])
    long, wide = rng.uniform(8, 30, 2)
    # The left face ends at the edge, where the right one begins.
    corners = np.array([edge + long * first, edge, edge + wide * second, edge + wide * second + long * first])
    chosen = [faces[k] for k in rng.integers(len(faces), size=4)]
    height = altitude_m + float(rng.uniform(2, 14))
    target = block("target", corners, height, chosen, rng, rng.random() < 0.3, target=True)
    return before_a_building(here, target)
