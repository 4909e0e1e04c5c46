"""An urban set: a street between houses with what stands in the way of a low flight.

Houses on both sides of a street of 16 to 24 m, flown at 5 to 12 m. Two to four of these stand in the way: a
building that juts out, a gate over the street, the mast of a crane with its jib, lamp posts, wires from house
to house. Seeds draw all of it. In a shorter street wires alone are in the way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.world import World
from vista_eval.render.scene import Thing, thing
from vista_eval.worlds import rods, things
from vista_eval.worlds.draws import draws, seed_of, some_seed
from vista_eval.worlds.triangles import placed

WAY_M, WIRES_WAY_M = 70.0, 36.0


def build(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "city", number)
    rng = draws(own, "city")
    height, half = float(rng.uniform(5.0, 12.0)), float(rng.uniform(8.0, 12.0))
    standing = houses(half, WAY_M, rng)
    count = int(rng.integers(2, 5))
    kinds = rng.choice(len(OBSTACLES), count, replace=False)
    places = np.linspace(20.0, WAY_M - 10.0, count) + rng.uniform(-3, 3, count)
    for k, (kind, x) in enumerate(zip(kinds, places, strict=True)):
        standing += OBSTACLES[int(kind)](f"obstacle{k}", float(x), half, height, rng)
    scene = parts.scene(own, "asphalt", standing, (-6.0, WAY_M + 25.0), (-half - 2, half + 2))
    start, goal = (0.0, 0.0, height), (WAY_M, 0.0, height)
    return World(f"city_{number:03d}", "city", scene, (start, goal), speed_m_s or 5.0, seed=own)


def build_wires(number: int, seed: int, speed_m_s: float | None) -> World:
    own = seed_of(seed, "wires", number)
    rng = draws(own, "wires")
    height, half = float(rng.uniform(5.0, 12.0)), float(rng.uniform(8.0, 12.0))
    standing = houses(half, WIRES_WAY_M, rng)
    standing += wires("obstacle0", 22.0 + float(rng.uniform(-3.0, 3.0)), half, height, rng)
    scene = parts.scene(own, "asphalt", standing, (-6.0, WIRES_WAY_M + 25.0), (-half - 2, half + 2))
    start, goal = (0.0, 0.0, height), (WIRES_WAY_M, 0.0, height)
    return World(f"wires_{number:03d}", "wires", scene, (start, goal), speed_m_s or 5.0, seed=own)


def houses(half_m: float, way_m: float, rng: np.random.Generator) -> list[Thing]:
    """A row on each side, with gaps."""
    found: list[Thing] = []
    for side in (-1, 1):
        x = -8.0
        while x < way_m + 20:
            long, deep, high = float(rng.uniform(8, 18)), 10.0, float(rng.uniform(7, 22))
            at = x + long / 2, side * (half_m + deep / 2 + float(rng.uniform(0, 1.5)))
            found.append(parts.upright_box(f"house{len(found)}", at, (long, deep, high), 0.0, some_seed(rng)))
            x += long + float(rng.choice([0.0, 0.0, rng.uniform(2, 6)]))
    return found


def jutting(name: str, x: float, half_m: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """A building that takes more than half of the street."""
    side, wide = float(rng.choice([-1, 1])), half_m * float(rng.uniform(1.1, 1.4))
    at = x + 3.0, side * (half_m - wide / 2)
    size = (6.0, wide, height_m + float(rng.uniform(3, 8)))
    return [parts.upright_box(name, at, size, 0.0, some_seed(rng))]


def gate(name: str, x: float, half_m: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """Two pillars and a beam between the houses, flown through below or over."""
    low = height_m - float(rng.uniform(-1.5, 1.5))
    pillars = [
        parts.upright_box(f"{name}_pillar{k}", (x, y), (1.5, 1.5, low + 2.0), 0.0, some_seed(rng))
        for k, y in enumerate((-half_m + 1.0, half_m - 1.0))
    ]
    shape = parts.grid_box(np.array([1.5, 2 * half_m, 2.0]), 0.0, rng)
    beam = thing(f"{name}_beam", "beam", [things.mesh(f"{name}_beam", placed(shape, (x, 0.0, low + 1.0)))])
    return [*pillars, beam]


def crane(name: str, x: float, half_m: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """The mast of a tower crane near the middle of the street, its jib far above."""
    high = height_m + float(rng.uniform(8, 15))
    mast = rods.lattice(high, 1.6, 0.06, float(rng.uniform(0.3, 0.6)), corners=4)
    at = (x, float(rng.uniform(-1.5, 1.5)), 0.0)
    jib = rods.rods([[(x, at[1] - 6.0, high), (x, at[1] + 18.0, high)]], 0.08, 0.4)
    solids = [*mast.moved(at, float(rng.uniform(0, 90))).solids(name), *jib.solids(f"{name}_jib")]
    return [thing(name, "crane", solids)]


def lamps(name: str, x: float, half_m: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """Posts as high as the flight, one of them on its line."""
    places = [(x, float(rng.uniform(-0.6, 0.6))), (x + 4.0, -half_m + 2.0), (x + 4.0, half_m - 2.0)]
    return [
        parts.pole(f"{name}_{k}", at, 0.09, height_m + float(rng.uniform(0.5, 3.0)), 0.35)
        for k, at in enumerate(places)
    ]


def wires(name: str, x: float, half_m: float, height_m: float, rng: np.random.Generator) -> list[Thing]:
    """Three wires from house to house at about the height of the flight."""
    strands = [
        rods.strand(
            (x, -half_m, height_m + up + rng.uniform(0.2, 1.0)),
            (x + rng.uniform(-4, 4), half_m, height_m + up + rng.uniform(0.2, 1.0)),
            0.012,
            0.02,
            rng,
        )
        for up in (-1.0, 0.0, 1.0)
    ]
    return [thing(f"{name}_wire{k}", "wire", s.solids(f"{name}_wire{k}")) for k, s in enumerate(strands)]


OBSTACLES: tuple[Callable[[str, float, float, float, np.random.Generator], list[Thing]], ...] = (
    jutting,
    gate,
    crane,
    lamps,
    wires,
)
