"""Freight containers, stacked across the path and beside it. Their sheets are folded, not painted: light and
shadow of the folds repeat at one pitch along a side."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vista_eval.render.scene import Scene, Thing, thing
from vista_eval.worlds import things
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform
from vista_eval.worlds.grounds import BUILT_UP
from vista_eval.worlds.site import URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, placed

AT_STACKS = Courses(altitude_m=(2.8, 9.5), climb_deg=(-4.0, 4.0), most_bank_deg=15.0)
LONG_M, WIDE_M, HIGH_M = (6.06, 12.19), 2.44, 2.59
GAP_M = 0.08  # between neighbours
PITCH_M, FOLD_M = 0.278, 0.036
FOLD_AT = (0.0, 0.26, 0.5, 0.76)  # of a pitch: where the sheet turns in, is in, turns out, is out again
RAIL_M = 0.14  # frame around the sheets
PIECES = 5  # of a sheet, one above the other, each of its own shade
BESIDE_M = (6.0, 14.0)


class Stack(NamedTuple):
    """Columns of containers side by side along y, each `levels[k]` high; the front is x = 0."""

    long_m: float
    levels: tuple[int, ...]
    rows: int  # behind each other

    @property
    def width_m(self) -> float:
        return len(self.levels) * (self.long_m + GAP_M)

    @property
    def depth_m(self) -> float:
        return self.rows * (WIDE_M + GAP_M)


def sheet(width_m: float, shade: float, rng: np.random.Generator) -> Triangles:
    """Folded, upright, in x = 0 .. FOLD_M from y = 0 to `width_m` and z = 0 to HIGH_M; grimy by strips."""
    pitches = max(1, round(width_m / PITCH_M))
    y = (np.arange(pitches)[:, None] + np.array(FOLD_AT)).ravel() / pitches * width_m
    y = np.append(y, width_m)
    x = np.append(np.tile([0.0, FOLD_M, FOLD_M, 0.0], pitches), 0.0)
    z = np.linspace(0.0, HIGH_M, PIECES + 1)
    low, high = np.arange(PIECES)[:, None], np.arange(PIECES)[:, None] + 1
    left, right = np.arange(len(y) - 1)[None], np.arange(1, len(y))[None]
    corners = [
        np.stack(np.broadcast_arrays(x[k], y[k], z[j]), axis=-1)
        for k, j in ((left, low), (right, low), (right, high), (left, high))
    ]
    vertices = np.stack(corners, axis=2).reshape(-1, 3)
    strips = len(vertices) // 4
    grime = 1 - np.abs(rng.normal(0, rng.uniform(0.0, 0.05), strips))
    rust = np.where(rng.random(strips) < rng.uniform(0.0, 0.01), 0.6, 1.0)
    first = 4 * np.arange(strips)[:, None]
    faces = np.vstack([first + np.array(half) for half in ((0, 1, 2), (0, 2, 3))])
    return Triangles(vertices, faces, np.repeat(np.clip(shade * grime * rust, 0.02, 0.85), 4))


def frame(width_m: float, shade: float) -> Triangles:
    """Posts and rails around a sheet of that width, flush with what the sheet stands out to."""
    dark = 0.8 * shade
    posts = [box((0.02, y, HIGH_M / 2), (0.06, RAIL_M, HIGH_M), dark) for y in (0.0, width_m)]
    rails = [box((0.02, width_m / 2, z), (0.06, width_m, RAIL_M), dark) for z in (0.07, HIGH_M - 0.07)]
    return joined(*posts, *rails)


def sign(width_m: float, shade: float, rng: np.random.Generator) -> Triangles:
    """Some letters of a name, as bars before the sheet."""
    ink = 0.75 if shade < 0.35 else 0.06
    size = float(rng.uniform(0.25, 0.8))
    first, z = float(rng.uniform(0.1, 0.4)) * width_m, float(rng.uniform(1.2, 1.9))
    bars = []
    for k in range(int(rng.integers(3, 8))):
        y = first + 0.9 * k * size
        if y + size > 0.95 * width_m:
            break
        for aside, up, wide, high in rng.uniform([-0.3, -0.3, 0.12, 0.2], [0.3, 0.3, 0.6, 0.8], (3, 4)):
            middle = (-0.01, y + aside * size, z + up * size)
            bars.append(box(middle, (0.01, wide * size, high * size), ink))
    return joined(*bars) if bars else box((-0.01, first, z), (0.01, size, size), ink)


def door(shade: float) -> Triangles:
    """Two flat leaves with four locking bars."""
    leaf = box((0.03, WIDE_M / 2, HIGH_M / 2), (0.04, WIDE_M, HIGH_M), shade)
    gap = box((0.0, WIDE_M / 2, HIGH_M / 2), (0.03, 0.03, HIGH_M - 0.3), 0.5 * shade)
    bars = [
        box((-0.03, y * WIDE_M, HIGH_M / 2), (0.04, 0.04, HIGH_M - 0.2), 0.55)
        for y in (0.15, 0.38, 0.62, 0.85)
    ]
    return joined(leaf, gap, *bars)


def container(long_m: float, rng: np.random.Generator, owner: float | None) -> Triangles:
    """A container from the origin along y, its front in x = 0; painted in one shade. `owner`: its shade, no
    names."""
    shade = owner or log_uniform(rng, 0.04, 0.6)
    long_side = joined(sheet(long_m, shade, rng), frame(long_m, shade))
    if owner is None and rng.random() < 0.5:
        long_side = joined(long_side, sign(long_m, shade, rng))
    end = joined(sheet(WIDE_M, shade, rng) if rng.random() < 0.5 else door(shade), frame(WIDE_M, shade))
    back = placed(joined(sheet(long_m, shade, rng), frame(long_m, shade)), (WIDE_M, long_m, 0), 180)
    ends = [placed(end, (0, long_m, 0), -90), placed(end, (WIDE_M, 0, 0), 90)]
    roof = box((WIDE_M / 2, long_m / 2, HIGH_M - 0.05), (WIDE_M - 0.05, long_m - 0.05, 0.04), 0.9 * shade)
    return joined(long_side, back, *ends, roof)


def built(stack: Stack, rng: np.random.Generator) -> Triangles:
    """Builds a stack, of one owner in half of the cases."""
    owner = log_uniform(rng, 0.1, 0.6) if rng.random() < 0.5 else None
    parts = []
    for column, levels in enumerate(stack.levels):
        for row in range(stack.rows):
            for level in range(levels):
                jitter = rng.normal(0, 0.02, 2)
                foot = (
                    row * (WIDE_M + GAP_M) + jitter[0],
                    column * (stack.long_m + GAP_M) + jitter[1],
                    level * HIGH_M,
                )
                parts.append(placed(container(stack.long_m, rng, owner), foot))
    return joined(*parts)


def stack_across(altitude_m: float, rng: np.random.Generator) -> Stack:
    """Every column is higher than the path by a third of a container or more."""
    least = int(np.ceil(altitude_m / HIGH_M + 0.35))
    long_m = float(rng.choice(LONG_M))
    count = int(rng.integers(1, 4)) if long_m > 10 else int(rng.integers(2, 6))
    levels = tuple(int(n) for n in least + (rng.random(count) < 0.3))
    return Stack(long_m, levels, int(rng.integers(2, 5)))


def across(here: Site) -> Thing:
    """Half of the stacks at up to 20 degrees, the others at up to 70, so that side and ends are met."""
    rng = here.draws("stack")
    stack = stack_across(here.altitude_m, rng)
    steep = rng.random() < 0.5
    yaw = float(rng.choice([-1, 1]) * (rng.uniform(20, 70) if steep else rng.uniform(0, 20)))
    met = float(rng.uniform(0.2, 0.8)) * stack.width_m
    # The point of the front that is met comes to the origin.
    shape = placed(placed(built(stack, rng), (0.0, -met, 0.0)), (0, 0, 0), yaw)
    return thing("target", "building", [things.mesh("target_stack", shape)], target=True)


def beside(here: Site) -> list[Thing]:
    """Adds up to three lower or higher stacks along the path."""
    rng = here.draws("lane")
    found = []
    for k in range(int(rng.integers(0, 4))):
        stack = Stack(LONG_M[1], (int(rng.integers(1, 4)),) * int(rng.integers(1, 3)), 1)
        x, side = float(rng.uniform(-35, 10)), float(rng.choice([-1, 1]))
        y = here.path.y_m(x) + side * float(rng.uniform(*BESIDE_M))
        shape = placed(built(stack, rng), (x, y, 0), -90 + float(rng.normal(0, 4)))
        found.append(things.one(f"beside{k}", "building", shape))
    return found


def containers(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AT_STACKS, BUILT_UP)
    return scene_of(here, [across(here)], [*beside(here), *clutter(here, URBAN, 8), *background(here)])
