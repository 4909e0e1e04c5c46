"""Large fronts of which hardly anything can be matched: dark panes between thin mullions, in one plane or
folded into bays, and the painted steel of a storage tank."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Cylinder, Scene, Solid, Thing, thing
from vista_eval.worlds import things
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import BUILT_UP
from vista_eval.worlds.patterns import cloudy, laid
from vista_eval.worlds.site import URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, placed

AT_FRONTS = Courses(altitude_m=(3.0, 13.0), climb_deg=(-6.0, 5.0), most_bank_deg=20.0)
TEXEL_M = 0.03
PLATE_M = (2.4, 9.0)  # of a tank: height of a course of plates, length of a plate


def bay(width_m: float, height_m: float, cell_m: tuple[float, float], rng: np.random.Generator) -> Triangles:
    """A flat front in x = 0 from y = 0 on: a pane a cell, sunk behind mullions; whole cells, edge to edge."""
    columns, rows = max(1, round(width_m / cell_m[0])), max(1, round(height_m / cell_m[1]))
    wide, high = width_m / columns, height_m / rows
    k, j = (grid.ravel() for grid in np.mgrid[:columns, :rows])
    corner = np.stack([np.stack([0 * k, k + a, j + b], 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))], 1)
    panes = corner.reshape(-1, 3) * [1.0, wide, high] + [0.12, 0.0, 0.0]
    # What is mirrored is brighter towards the zenith, a little askew in each pane.
    level = 0.02 + 0.06 * panes[:, 2] / height_m + np.repeat(rng.normal(0, 0.006, len(k)), 4)
    blinds = np.repeat(rng.random(len(k)) < rng.uniform(0.0, 0.08), 4)
    albedo = np.clip(np.where(blinds, 0.3, level), 0.01, 0.85)
    first = 4 * np.arange(len(k))[:, None]
    glass = Triangles(panes, np.vstack([first + np.array(half) for half in ((0, 1, 2), (0, 2, 3))]), albedo)
    bar, shade = float(rng.uniform(0.04, 0.08)), log_uniform(rng, 0.03, 0.3)
    upright = [box((0.05, wide * i, height_m / 2), (0.1, bar, height_m), shade) for i in range(columns + 1)]
    level_bars = [box((0.07, width_m / 2, high * i), (0.06, width_m, bar), shade) for i in range(rows + 1)]
    return joined(glass, *upright, *level_bars)


def folded(here: Site) -> Thing:
    """One to three bays, each turned by up to 60 degrees against the path, up to 5 to 20 m above it."""
    rng = here.draws("bays")
    height = here.altitude_m + float(rng.uniform(3, 18))
    cell = (float(rng.uniform(0.9, 2.6)), float(rng.uniform(1.2, 3.6)))
    count = int(rng.integers(1, 4))
    turns = np.sort(rng.uniform(-60, 60, count))[::-1] if count > 1 else rng.uniform(-35, 35, 1)
    widths = rng.uniform(8, 24, count)
    met, share = int(rng.integers(count)), float(rng.uniform(0.2, 0.8))
    step = np.stack([-np.sin(np.radians(turns)), np.cos(np.radians(turns)), 0 * turns], axis=1)
    feet = np.vstack([np.zeros(3), np.cumsum(widths[:, None] * step, axis=0)])
    feet -= feet[met] + share * widths[met] * step[met]
    solids: list[Solid] = []
    for k in range(count):
        shape = placed(bay(float(widths[k]), height, cell, rng), feet[k], float(turns[k]))
        solids.append(things.mesh(f"target_bay{k}", shape))
    deep = box((0, 0, height / 2), (6.0, 0.6 * float(widths.min()), height - 0.5), 0.3)
    middle = (feet[met] + feet[met + 1]) / 2
    core = placed(placed(deep, (3.6, 0, 0)), middle, float(turns[met]))
    return thing("target", "building", [*solids, things.mesh("target_core", core)], target=True)


def plates(girth_m: float, height_m: float, seed: int) -> np.ndarray:
    """Paint in one shade; seams between courses of plates, runs of dirt below the edge."""
    rng = np.random.default_rng(seed)
    rows, columns = round(height_m / TEXEL_M), round(girth_m / TEXEL_M)
    z = (np.arange(rows, dtype=np.float32) + 0.5)[:, None] * TEXEL_M
    y = (np.arange(columns, dtype=np.float32) + 0.5)[None, :] * TEXEL_M
    high, long = PLATE_M
    course = np.floor(z / high)
    seam = (np.mod(z, high) < TEXEL_M) | (np.mod(y + 0.5 * long * np.mod(course, 2), long) < TEXEL_M)
    runs = laid(cloudy(seed, 1.2, 0.1), z, y, 11.0, np.pi / 2)
    shade = rng.uniform(0.3, 0.75) * (1 + rng.uniform(0.0, 0.02) * runs) * np.where(seam, 0.93, 1.0)
    return np.clip(shade, 0.02, 0.85).astype(np.float32)


def tank(here: Site) -> Thing:
    """Round, 10 to 28 m across, 1 to 8 m higher than the path, which meets it within half its radius."""
    rng = here.draws("tank")
    radius, height = float(rng.uniform(5, 14)), here.altitude_m + float(rng.uniform(1.0, 8.0))
    off = float(rng.uniform(-0.5, 0.5)) * radius
    x, y = float(np.sqrt(radius**2 - off**2)), off
    albedo = plates(2 * np.pi * radius, height, some_seed(rng))
    shell = Cylinder("target_shell", (x, y, 0.0), (x, y, height), radius, albedo[::-1])
    rail = [
        box(
            (x + 0.97 * radius * np.cos(a), y + 0.97 * radius * np.sin(a), height + 0.5),
            (0.05, 0.05, 1.0),
            0.5,
        )
        for a in np.linspace(0, 2 * np.pi, 40, endpoint=False)
    ]
    solids: list[Solid] = [shell]
    if rng.random() < 0.5:
        solids.append(things.mesh("target_rail", joined(*rail)))
    return thing("target", "building", solids, target=True)


def smooth_front(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AT_FRONTS, BUILT_UP)
    target = (folded if here.draws("form").random() < 0.6 else tank)(here)
    return scene_of(here, [target], [*clutter(here, URBAN), *background(here)])
