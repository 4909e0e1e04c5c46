"""What stands on building sites: cranes and scaffolding."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vista_eval.render.scene import Scene, Solid, Thing, thing
from vista_eval.worlds import things, walls
from vista_eval.worlds.courses import ANY
from vista_eval.worlds.grounds import BUILT_UP
from vista_eval.worlds.rods import Rods, all_of, lattice, rods, strand
from vista_eval.worlds.sampled.buildings import block, rectangle_m
from vista_eval.worlds.site import URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, placed, tube


class Crane(NamedTuple):
    members: Rods
    body: Triangles
    hook_out_m: float  # from the mast to the hook, along +y

    def solids(self, name: str, foot_m: ArrayLike, yaw_deg: float) -> list[Solid]:
        body = things.mesh(f"{name}_body", placed(self.body, foot_m, yaw_deg))
        return [body, *self.members.moved(foot_m, yaw_deg).solids(f"{name}_member")]


def tower_crane(height_m: float, jib_m: float, hook_m: float, rng: np.random.Generator) -> Crane:
    """Mast at the origin, jib along +y at `height_m`, its hook `hook_m` above the ground."""
    shade, side = float(rng.uniform(0.2, 0.65)), float(rng.uniform(1.0, 1.8))
    out_m = float(rng.uniform(0.5, 0.9)) * jib_m
    apex = (0, 0, height_m + 0.16 * jib_m)
    stays = [[apex, (0, y, height_m + 0.5)] for y in (-0.28 * jib_m, 0.75 * jib_m)]
    members = all_of(
        lattice(height_m, side, 0.07, shade, corners=4),
        lattice(jib_m, 0.9, 0.04, shade).lying().moved((0, 0, height_m)),
        lattice(0.3 * jib_m, 0.9, 0.04, shade).lying().moved((0, -0.3 * jib_m, height_m)),
        rods(stays, 0.02, 0.2),
        *(strand((dx, out_m, height_m), (dx, out_m, hook_m), 0.009, 0.0, rng) for dx in (-0.15, 0.15)),
    )
    body = joined(
        box((0, -0.28 * jib_m, height_m - 1.2), (1.4, 2.0, 2.2), float(rng.uniform(0.25, 0.5))),
        box((0.9, 0.8, height_m - 1.3), (1.2, 1.4, 1.8), float(rng.uniform(0.3, 0.7))),
        tube([(0, 0, height_m), apex], 0.15, shade, 5),
        box((0, out_m, hook_m - 0.3), (0.3, 0.5, 0.7), float(rng.choice([0.1, 0.55]))),
        box((0, 0, 0.4), (3 * side, 3 * side, 0.8), 0.35),
    )
    return Crane(members, body, out_m)


def crane(altitude_m: float, seed: int) -> Scene:
    """Its mast, its jib or its hook with a load is in the way."""
    here = site(altitude_m, seed, ANY, BUILT_UP)
    rng = here.draws("crane")
    part = str(rng.choice(["mast", "jib", "hook"]))
    height = altitude_m if part == "jib" else altitude_m + float(rng.uniform(6, 22))
    jib, hook = float(rng.uniform(18, 35)), altitude_m if part == "hook" else rng.uniform(0.3, 0.8) * height
    machine, yaw = tower_crane(height, jib, float(hook), rng), float(rng.uniform(-40, 40))
    along = np.array([-np.sin(np.radians(yaw)), np.cos(np.radians(yaw)), 0.0])
    out_m = {"mast": 0.0, "jib": float(rng.uniform(0.25, 0.7)) * jib, "hook": machine.hook_out_m}[part]
    solids = machine.solids("target_crane", -out_m * along, yaw)
    if part == "hook" and rng.random() < 0.6:
        load = box(
            (0, 0, altitude_m - 1.2), rng.uniform(0.8, 2.5, 3) * [1, 1, 0.4], float(rng.uniform(0.15, 0.6))
        )
        solids.append(things.mesh("target_load", load))
    target = thing("target", "crane", solids, target=True)
    return scene_of(here, [target], around(here))


def scaffold(length_m: float, height_m: float, rng: np.random.Generator) -> tuple[Rods, Triangles]:
    """Tubes of 48 mm in bays along y, planks on every level, netting or boards here and there."""
    bay, level, deep, shade = rng.uniform(2.0, 3.0), 2.0, rng.uniform(0.7, 1.1), float(rng.uniform(0.2, 0.6))
    y_ends = np.arange(-length_m / 2, length_m / 2 + 0.1, bay)
    levels = np.arange(level, height_m + 0.1, level)
    low, high = float(y_ends[0]), float(y_ends[-1])
    tubes = [[(x, y, 0), (x, y, levels[-1] + 1.1)] for x in (-deep, 0.0) for y in y_ends]
    tubes += [[(-deep, low, z + up), (-deep, high, z + up)] for z in levels for up in (0.0, 0.5, 1.0)]
    sheets = []
    for z in levels:
        plank = float(rng.uniform(0.2, 0.45))
        sheets.append(box((-deep / 2, (low + high) / 2, z), (0.9 * deep, high - low, 0.05), plank))
        for y, y_next in pairwise(y_ends):
            if rng.random() < 0.3:
                tubes.append([(-deep, y, z - level), (-deep, y_next, z)])
            if rng.random() < 0.12:
                middle = (-deep - 0.03, (y + y_next) / 2, z + 0.5)
                sheets.append(box(middle, (0.01, y_next - y, 1.0), float(rng.uniform(0.2, 0.7))))
    return rods(tubes, 0.024, shade), joined(*sheets)


def scaffolding(altitude_m: float, seed: int) -> Scene:
    """Scaffolding before a front, or free-standing, met head-on or up to 30 degrees askew."""
    here = site(altitude_m, seed, ANY, BUILT_UP)
    rng = here.draws("scaffolding")
    length, yaw = float(rng.uniform(12, 30)), float(rng.uniform(-30, 30))
    height = altitude_m + float(rng.uniform(2, 8))
    tubes, sheets = scaffold(length, height, rng)
    planks = things.mesh("target_planks", placed(sheets, (0, 0, 0), yaw))
    solids = [planks, *tubes.moved((0, 0, 0), yaw).solids("target_tube")]
    target = thing("target", "scaffolding", solids, target=True)
    return scene_of(here, [target, *building_behind(here, length, height, yaw)], around(here))


def building_behind(here: Site, length_m: float, height_m: float, yaw_deg: float) -> list[Thing]:
    rng = here.draws("behind")
    if rng.random() < 0.25:
        return []
    faces = [walls.roughcast, walls.windows, walls.concrete_panels, walls.plain]
    turn = np.radians(yaw_deg)
    off = 0.5 * np.array([np.cos(turn), np.sin(turn)])
    corners = rectangle_m((float(off[0]), float(off[1])), length_m + 2, 9.0, yaw_deg)
    front = faces[int(rng.integers(len(faces)))]
    return [block("behind", corners, height_m + 0.5, [front, *[walls.roughcast] * 3], rng)]


def around(here: Site) -> list[Thing]:
    return [*clutter(here, URBAN), *background(here, ("houses", "open", "trees"))]
