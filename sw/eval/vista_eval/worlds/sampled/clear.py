"""Nothing in the way, though much stands beside the path, below it and above it."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Thing, thing
from vista_eval.worlds import walls
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform
from vista_eval.worlds.grounds import BUILT_UP
from vista_eval.worlds.rods import all_of, lattice, strand
from vista_eval.worlds.sampled.buildings import block, rectangle_m
from vista_eval.worlds.sampled.machines import tower_crane
from vista_eval.worlds.site import RURAL, URBAN, Site, background, clutter, scene_of, site

AMONG_HOUSES = Courses(altitude_m=(5.0, 12.0), climb_deg=(0.0, 4.0), most_bank_deg=20.0)
FACES = (walls.plain, walls.windows, walls.lived_in, walls.dark_glass, walls.corrugated, *walls.TEXTURED)


def houses_beside(here: Site, rng: np.random.Generator) -> list[Thing]:
    """Houses along both sides, 8 to 25 m off, at any angle."""
    found = []
    for k, x in enumerate(np.arange(here.path.points_m[0, 0] + 10, 110, 13.0)):
        for side in (-1, 1):
            if rng.random() < 0.7:
                y = here.path.y_m(x) + side * log_uniform(rng, 8, 25)
                width, depth = rng.uniform(7, 14, 2)
                yaw = float(rng.choice([0.0, 90.0]) + rng.normal(0, 12))
                corners = rectangle_m((float(x), float(y)), float(width), float(depth), yaw)
                faces = [FACES[j] for j in rng.integers(len(FACES), size=4)]
                name, height = f"house{k}{'r' if side < 0 else 'l'}", float(rng.uniform(3, 14))
                found.append(block(name, corners, height, faces, rng, rng.random() < 0.6))
    return found


def clear_suburb(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AMONG_HOUSES, BUILT_UP)
    rng = here.draws("suburb")
    around = [*houses_beside(here, rng), *clutter(here, (*URBAN, *RURAL), 16), *background(here)]
    return scene_of(here, (), around, meets_at_m=None)


def wires_above(here: Site, rng: np.random.Generator) -> list[Thing]:
    """Wires across the path, high above it, between lattice masts."""
    found = []
    for k in range(int(rng.integers(1, 4))):
        x, half = float(rng.uniform(-40, 70)), float(rng.uniform(16, 40))
        height = here.altitude_m + 9 + 0.06 * max(0.0, x) + float(rng.uniform(0, 8))
        shade, tops = float(rng.uniform(0.15, 0.5)), [(x, s * half, height) for s in (-1, 1)]
        masts = [lattice(height + 1.0, 0.9, 0.05, shade, 4).moved((*top[:2], 0.0)) for top in tops]
        wires = [
            strand(np.add(tops[0], up), np.add(tops[1], up), log_uniform(rng, 0.003, 0.015), 0.01, rng)
            for up in ((0, 0, 0), (0.4, 0, 0.6), (-0.4, 0, 0.6))
        ]
        found.append(thing(f"line{k}", "wire", all_of(*masts, *wires).solids(f"line{k}")))
    return found


def clear_site(altitude_m: float, seed: int) -> Scene:
    """Cranes, masts, wires and buildings on both sides and above."""
    here = site(altitude_m, seed, AMONG_HOUSES, BUILT_UP)
    rng = here.draws("site")
    machines = []
    for k in range(int(rng.integers(1, 4))):
        x, y = float(rng.uniform(-20, 90)), float(rng.choice([-1, 1]) * rng.uniform(9, 30))
        machine = tower_crane(float(rng.uniform(18, 32)), float(rng.uniform(15, 28)), 12.0, rng)
        solids = machine.solids(f"crane{k}", (x, y, 0.0), float(rng.uniform(0, 360)))
        machines.append(thing(f"crane{k}", "crane", solids))
    around = [*machines, *wires_above(here, rng), *houses_beside(here, rng)[::2], *clutter(here, URBAN, 16)]
    return scene_of(here, (), [*around, *background(here)], meets_at_m=None)
