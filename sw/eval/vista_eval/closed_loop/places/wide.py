"""Worlds that a fixed wing can turn round in, of our own: 18 m/s need 40 m for a turn.

wide_street  towers of 30 to 60 m on both sides, 80 to 110 m from the middle; flown at 20 to 30 m height. Two
             or three of these are in the way: a slab that reaches over the middle, a tower, a chimney, the
             mast of a crane
forest_edge  a wood on one side, its edge along the route, open land on the other; flown at 5 to 7 m height.
             Two or three spits of the wood reach over the route, and a tree or two stand by themselves
wide_clear   towers, none within 60 m of the route: every evasion is needless"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.world import World
from vista_eval.render.scene import Point, Thing, thing
from vista_eval.worlds import rods
from vista_eval.worlds.draws import draws, seed_of, some_seed
from vista_eval.worlds.grounds import WOODED

WAY_M, SPEED_M_S = 320.0, 18.0
FIRST_M, LAST_M = 110.0, 70.0  # from the start to the first in the way, from the last to the goal
TREES_M = 6.0  # between the trees of a wood
TEXEL_M = 0.1  # of walls, which are seen from farther away than in other worlds


def world(
    name: str, seed: int, standing: list[Thing], cover: str, height_m: float, speed_m_s: float | None
) -> World:
    scene = parts.scene(seed, cover, standing, (-10.0, WAY_M + 60.0), (-40.0, 40.0))
    start, goal = (0.0, 0.0, height_m), (WAY_M, 0.0, height_m)
    family = name.rsplit("_", 1)[0]
    return World(name, family, scene, (start, goal), speed_m_s or SPEED_M_S, seed=seed)


def places_x_m(rng: np.random.Generator, count: int) -> np.ndarray:
    """Positions along the way that are apart from each other."""
    step = (WAY_M - FIRST_M - LAST_M) / max(count - 1, 1)
    return np.asarray(FIRST_M + step * np.arange(count) + rng.uniform(-0.2, 0.2, count) * step)


# ---- a wide street ----


def build_street(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "wide_street", number)
    rng = draws(own, "street")
    height, count = float(rng.uniform(20.0, 30.0)), int(rng.integers(2, 4))
    standing = towers(rng, float(rng.uniform(80.0, 110.0)))
    kinds = rng.choice(len(IN_THE_STREET), count, replace=False)
    for k, (kind, x) in enumerate(zip(kinds, places_x_m(rng, count), strict=True)):
        standing += IN_THE_STREET[int(kind)](f"obstacle{k}", float(x), height, rng)
    return world(f"wide_street_{number:03d}", own, standing, "asphalt", height, speed_m_s)


def build_clear(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "wide_clear", number)
    rng = draws(own, "clear")
    standing = towers(rng, float(rng.uniform(60.0, 90.0)))
    return world(f"wide_clear_{number:03d}", own, standing, "asphalt", float(rng.uniform(20, 30)), speed_m_s)


def towers(rng: np.random.Generator, half_m: float) -> list[Thing]:
    """A row on each side, with gaps."""
    found: list[Thing] = []
    for side in (-1, 1):
        x = float(rng.uniform(0.0, 40.0))
        while x < WAY_M + 80:
            long, deep, high = float(rng.uniform(20, 45)), 20.0, float(rng.uniform(30, 60))
            at = x + long / 2, side * (half_m + deep / 2)
            found.append(
                parts.upright_box(f"tower{len(found)}", at, (long, deep, high), 0.0, some_seed(rng), TEXEL_M)
            )
            x += long + float(rng.uniform(10, 60))
    return found


def slab(name: str, x: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """A building across the street that reaches from one side over the middle."""
    over, wide = float(rng.uniform(3.0, 12.0)), float(rng.uniform(40.0, 60.0))
    at = x, float(rng.choice([-1, 1])) * (wide / 2 - over)
    size = (12.0, wide, height_m + float(rng.uniform(8, 20)))
    return [parts.upright_box(name, at, size, float(rng.uniform(-15, 15)), some_seed(rng), TEXEL_M)]


def tower(name: str, x: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """A tower in the middle."""
    at = x, float(rng.uniform(-6, 6))
    size = (float(rng.uniform(10, 20)), float(rng.uniform(10, 20)), height_m + float(rng.uniform(8, 20)))
    return [parts.upright_box(name, at, size, float(rng.uniform(0, 90)), some_seed(rng), TEXEL_M)]


def chimney(name: str, x: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    at, radius = (x, float(rng.uniform(-2, 2))), float(rng.uniform(1.0, 2.5))
    return [parts.pole(name, at, radius, height_m + float(rng.uniform(5, 20)), 0.35)]


def crane(name: str, x: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """The mast of a tower crane, its jib above the flight."""
    high = height_m + float(rng.uniform(10, 20))
    at = (x, float(rng.uniform(-2, 2)), 0.0)
    mast = rods.lattice(high, 2.0, 0.08, float(rng.uniform(0.3, 0.6)), corners=4)
    jib = rods.rods([[(x, at[1] - 10.0, high), (x, at[1] + 30.0, high)]], 0.1, 0.4)
    solids = [*mast.moved(at, float(rng.uniform(0, 90))).solids(name), *jib.solids(f"{name}_jib")]
    return [thing(name, "crane", solids)]


IN_THE_STREET: tuple[Callable[[str, float, float, np.random.Generator], list[Thing]], ...] = (
    slab,
    tower,
    chimney,
    crane,
)


# ---- the edge of a wood ----


def build_edge(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "forest_edge", number)
    rng = draws(own, "edge")
    height, side = float(rng.uniform(5.0, 7.0)), float(rng.choice([-1, 1]))
    spits = places_x_m(rng, int(rng.integers(2, 4)))
    places = wood(rng, float(rng.uniform(12.0, 25.0)), spits, rng.uniform(4.0, 20.0, len(spits)))
    places += [(float(rng.uniform(FIRST_M, WAY_M)), -float(rng.uniform(5.0, 50.0))) for _ in range(2)]
    start: Point = (0.0, 0.0, height)
    places = parts.away_from([(x, side * y) for x, y in places], [(start, 40.0), ((WAY_M, 0, height), 30.0)])
    standing = parts.trees(places, own, young=0.1)
    return world(f"forest_edge_{number:03d}", own, standing, str(rng.choice(WOODED)), height, speed_m_s)


def wood(
    rng: np.random.Generator, edge_m: float, spits_x_m: np.ndarray, over_m: np.ndarray
) -> list[tuple[float, float]]:
    """Trees on a jittered grid from the edge to 30 m behind it, and spits that reach over the route."""
    found = []
    for x in np.arange(-10.0, WAY_M + 60.0, TREES_M):
        for y in np.arange(-20.0, edge_m + 30.0, TREES_M):
            at = x + rng.uniform(-2, 2), y + rng.uniform(-2, 2)
            reach = edge_m + 4 * np.sin(x / 25)
            for spit, over in zip(spits_x_m, over_m, strict=True):
                if abs(at[0] - spit) < 12.0:
                    reach = min(reach, -over)
            if at[1] > reach:
                found.append((float(at[0]), float(at[1])))
    return found
