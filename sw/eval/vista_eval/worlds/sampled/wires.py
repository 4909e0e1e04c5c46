"""Wires of 5 to 30 mm: between poles, between pylons, from the ground up."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Sphere, Thing, thing
from vista_eval.render.textures import paint
from vista_eval.worlds import things
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import OPEN_COUNTRY
from vista_eval.worlds.rods import Rods, all_of, point, strand
from vista_eval.worlds.site import RURAL, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, tube

AT_WIRES = Courses(altitude_m=(5.0, 13.0), climb_deg=(-6.0, 6.0), most_bank_deg=20.0)
DIAMETER_M = (0.005, 0.030)


def sagging_through(
    point_m: np.ndarray, half_m: np.ndarray, share: float, sag: float
) -> tuple[np.ndarray, np.ndarray]:
    """Ends of a wire of direction and half length `half_m` that passes a point at `share` of its length."""
    start = point_m - 2 * share * half_m
    drop = 4 * sag * 2 * float(np.linalg.norm(half_m)) * share * (1 - share)
    raised = start + np.array([0.0, 0.0, drop])
    return raised, raised + 2 * half_m


def spans(here: Site, rng: np.random.Generator, incline_deg: float, count: int) -> tuple[list, list[Rods]]:
    """Wires side by side, the first through the path; their two ends each."""
    azimuth, incline = np.radians(rng.uniform(-40, 40)), np.radians(incline_deg)
    level = np.array([np.sin(azimuth), np.cos(azimuth), 0.0])
    half = rng.uniform(14, 35) * (np.cos(incline) * level + [0, 0, np.sin(incline)])
    share, sag = float(rng.uniform(0.35, 0.65)), float(rng.uniform(0.005, 0.03))
    radius = log_uniform(rng, *DIAMETER_M) / 2
    beside = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    through = np.array([0.0, 0.0, here.altitude_m + rng.uniform(-0.3, 0.3)])
    step = rng.choice([-1, 1]) * np.array([0, 0, rng.uniform(0.3, 1.2)]) + rng.uniform(0, 1.0) * beside
    ends = [sagging_through(through + k * step, half, share, sag) for k in range(count)]
    return ends, [strand(a, b, radius, sag, rng) for a, b in ends]


def wooden_poles(here: Site, ends: list, rng: np.random.Generator) -> Triangles:
    """Poles under each end of the wires, as high as the highest."""
    parts = []
    for k in (0, 1):
        tops = np.array([pair[k] for pair in ends])
        x, y = (float(c) for c in tops[:, :2].mean(axis=0))
        foot, top = here.foot_m(x, y), float(tops[:, 2].max()) + 0.4
        parts.append(tube([foot, (x, y, top)], [0.16, 0.11], float(rng.uniform(0.08, 0.3)), 9))
        for x_end, y_end, z in tops:
            arm = [(x, y, z - 0.12), (x_end, y_end, z - 0.12)]
            if np.hypot(x_end - x, y_end - y) > 0.05:
                parts.append(tube(arm, 0.05, 0.15, 5))
            parts.append(box((x_end, y_end, z - 0.06), (0.1, 0.1, 0.16), 0.5))
    return joined(*parts)


def around(here: Site) -> list[Thing]:
    return [*clutter(here, RURAL, 10), *background(here)]


def cable(altitude_m: float, seed: int) -> Scene:
    """One to four wires between two wooden poles, inclined up to 20 degrees."""
    here = site(altitude_m, seed, AT_WIRES, OPEN_COUNTRY)
    rng = here.draws("cable")
    ends, wires = spans(here, rng, float(rng.uniform(-20, 20)), int(rng.integers(1, 5)))
    holders = thing("poles", "pole", [things.mesh("poles", wooden_poles(here, ends, rng))])
    target = thing("target", "wire", all_of(*wires).solids("target_wire"), target=True)
    return scene_of(here, [target, holders], around(here))


def power_line(altitude_m: float, seed: int) -> Scene:
    """One to six wires at any inclination up to 60 degrees, some with marker balls."""
    here = site(altitude_m, seed, AT_WIRES, OPEN_COUNTRY)
    rng = here.draws("power line")
    incline = float(rng.choice([-1, 1]) * rng.uniform(0, 60))
    _, wires = spans(here, rng, incline, int(rng.integers(1, 7)))
    solids = all_of(*wires).solids("target_wire")
    if rng.random() < 0.2:
        for k, share in enumerate(np.arange(0.15, 0.9, 0.2)):
            x, y, z = point(wires[0].end_m[round(share * (len(wires[0].end_m) - 1))])
            ball = paint(0.25 + 0.5 * (k % 2), some_seed(rng))
            solids.append(Sphere(f"target_ball{k}", (x, y, z), 0.25, ball))
    target = thing("target", "wire", solids, target=True)
    return scene_of(here, [target], around(here))
