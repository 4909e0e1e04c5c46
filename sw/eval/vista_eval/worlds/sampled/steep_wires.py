"""Single wires of 8 to 30 mm at 30 to 90 degrees from the horizontal: stays of a mast beside the path, and
tethers. They are met before the sky, before trees or before a building that stands 14 to 35 m behind them."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Solid, Sphere, Thing, thing
from vista_eval.render.textures import paint
from vista_eval.worlds import walls
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN
from vista_eval.worlds.landscape import tree_row
from vista_eval.worlds.rods import Rods, lattice, point, strand
from vista_eval.worlds.sampled.buildings import block, rectangle_m
from vista_eval.worlds.sampled.poles import round_pole
from vista_eval.worlds.site import RURAL, Site, background, clutter, scene_of, site

# So fast that a range of 20 m is less than 3 s before the wire is met, where a hit is asked for.
AT_STEEP_WIRES = Courses(
    altitude_m=(5.0, 13.0), speed_m_s=(8.0, 25.0), climb_deg=(-6.0, 6.0), most_bank_deg=20.0
)
DIAMETER_M = (0.008, 0.030)
INCLINE_DEG = (30.0, 90.0)
STEEPEST_STAY_DEG = 70.0  # what is steeper is the tether of a balloon
MAST_OFF_M = (6.5, 9.0)
BEHIND_M = (14.0, 35.0)
FACES = (walls.brick, walls.roughcast, walls.lived_in, walls.windows, walls.concrete_panels)


def steep_wire(altitude_m: float, seed: int) -> Scene:
    """A stay or a tether across the path, and what holds it."""
    here = site(altitude_m, seed, AT_STEEP_WIRES, COUNTRY_AND_TOWN)
    rng = here.draws("steep wire")
    incline, azimuth = np.radians(rng.uniform(*INCLINE_DEG)), np.radians(rng.uniform(-45, 45))
    towards = rng.choice([-1, 1]) * np.array([np.sin(azimuth), np.cos(azimuth)])
    through = np.array([0.0, 0.0, altitude_m + rng.uniform(-0.3, 0.3)])
    is_stay = np.degrees(incline) < STEEPEST_STAY_DEG
    out_m = float(rng.uniform(*MAST_OFF_M)) if is_stay else float(rng.uniform(12, 35)) / np.tan(incline)
    top = through + out_m * np.array([*towards, np.tan(incline)])
    foot = through - through[2] * np.array([*(towards / np.tan(incline)), 1.0])
    sag = float(rng.uniform(0.001, 0.008)) * np.cos(incline)
    middle = float(
        through[2] / top[2]
    )  # share of the wire's length at the path, where the sag must not lower it
    drop = np.array([0.0, 0.0, 4 * sag * np.linalg.norm(top - foot) * middle * (1 - middle)])
    wire = strand(foot + drop, top + drop, log_uniform(rng, *DIAMETER_M) / 2, sag, rng)
    holder = mast(here, point(top + drop), rng) if is_stay else balloon(top + drop, rng)
    return scene_of(here, [target(wire), holder, *behind(here, rng)], around(here))


def target(wire: Rods) -> Thing:
    return thing("target", "wire", wire.solids("target_wire"), target=True)


def mast(here: Site, top_m: tuple[float, float, float], rng: np.random.Generator) -> Thing:
    """A tube or a lattice that reaches a little higher than the stay is fixed."""
    x, y, z = top_m
    foot, height = here.foot_m(x, y), z + float(rng.uniform(0.3, 2.0))
    solids: list[Solid]
    if rng.random() < 0.5:
        radius = float(rng.uniform(0.04, 0.12))
        solids = [round_pole("mast", foot, (x, y, height), radius, some_seed(rng), "steel")]
    else:
        solids = lattice(height, 0.3, 0.02, float(rng.uniform(0.1, 0.6))).moved(foot).solids("mast")
    return thing("mast", "mast", solids)


def balloon(top_m: np.ndarray, rng: np.random.Generator) -> Thing:
    radius = float(rng.uniform(0.6, 1.2))
    middle = point(top_m + np.array([0.0, 0.0, radius]))
    return thing("balloon", "balloon", [Sphere("balloon", middle, radius, paint(0.7, some_seed(rng)))])


def behind(here: Site, rng: np.random.Generator) -> list[Thing]:
    """Nothing, trees, or the front of a building."""
    kind, off_m = str(rng.choice(["sky", "trees", "building"])), float(rng.uniform(*BEHIND_M))
    if kind == "trees":
        return [tree_row((off_m, off_m + 12), 22.0, some_seed(rng), name="behind")]
    if kind == "building":
        width, askew = float(rng.uniform(12, 26)), float(rng.uniform(-30, 30))
        front, *others = (FACES[k] for k in rng.integers(len(FACES), size=4))
        corners = rectangle_m((off_m, float(rng.uniform(-5, 5))), width, 9.0, askew)
        height = here.altitude_m + float(rng.uniform(1, 8))
        return [block("behind", corners, height, [front, *others], rng, rng.random() < 0.4)]
    return []


def around(here: Site) -> list[Thing]:
    return [*clutter(here, RURAL, 10), *background(here)]
