"""The families of the second test set: what a low flight meets and no family of the first two sets holds.

turbine       hub within 6 to 14 m of a blade's tip; a blade or the smooth tower is met, turned by up to 60
              degrees
billboard     6 to 14 m wide on posts, or a banner of 5 to 10 m between two poles, up to 40 degrees askew
overpass      a deck of 0.8 to 1.6 m on round piers with a parapet; deck or pier is met
net           cords of 2 to 4 mm at 8 to 16 cm between posts, or vines on a trellis
portal_crane  two pairs of legs under a girder, 14 to 30 m apart; leg, girder or hanging load is met
traffic       signals on an arm over a street, the mast of one, or a sign board across the road
harbour       the mast of a sailing boat with stays, among others, over water
marquee       tents in one pale shade: slanted sheets without texture
clear_water   between boats and over them, nothing in the way
clear_rows    between two rows of trees and posts, nothing in the way

Of flights under a blue sky 40 % have clouds. Everything else is drawn as for the other sampled flights."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from vista_eval.render.scene import Panel, Scene, Solid, Thing, thing
from vista_eval.worlds import things, vegetation
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import BUILT_UP, COUNTRY_AND_TOWN, OPEN_COUNTRY
from vista_eval.worlds.rods import Rods, all_of, point, rods, strand
from vista_eval.worlds.sampled.clear import houses_beside
from vista_eval.worlds.sampled.family import Family
from vista_eval.worlds.sampled.poles import printed, round_pole
from vista_eval.worlds.site import RURAL, URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, lump, placed, polygon, prism, tube

CLOUDS = 0.4
Parts = tuple[Rods | None, Triangles]  # both around the vertical through the point that is met
Make = Callable[[Site, np.random.Generator], Parts]


def turbine(here: Site, rng: np.random.Generator) -> Parts:
    span, is_blade = float(rng.uniform(6, 14)), bool(rng.random() < 0.5)
    azimuth = float(np.radians(rng.uniform(-50, 50))) if is_blade else float(rng.uniform(0, 2 * np.pi))
    share = float(rng.uniform(0.35, 0.8)) * span
    hub_m = here.altitude_m + (share * np.cos(azimuth) if is_blade else span + rng.uniform(-2, 6))
    hub = np.array([0.0 if is_blade else -1.5, share * np.sin(azimuth) if is_blade else 0.0, hub_m])
    shade, thick, behind = (
        float(rng.uniform(0.5, 0.8)),
        float(rng.uniform(0.35, 0.9)),
        hub + np.eye(3)[0] * 1.5,
    )
    parts = [
        tube([behind * [1, 1, 0], behind], [1.4 * thick, thick], shade, 24),
        box(behind, (3.0, 1.1, 1.1), 0.9 * shade),
    ]
    for turn in azimuth + np.arange(3) * 2 * np.pi / 3:
        out, across = np.array([0, -np.sin(turn), -np.cos(turn)]), np.array([0, np.cos(turn), -np.sin(turn)])
        chord = [(0.02, -0.03), (0.2, -0.07), (1.0, -0.01), (1.0, 0.01), (0.2, 0.04), (0.02, 0.03)]
        outline = [hub + span * (along * out + aside * across) for along, aside in chord]
        parts.append(prism(outline, (0.12, 0.0, 0.0), shade))
    return None, joined(*parts)


def overpass(here: Site, rng: np.random.Generator) -> Parts:
    deep, wide, long = float(rng.uniform(0.8, 1.6)), float(rng.uniform(7, 13)), 70.0
    apart, radius, shade = rng.uniform(11, 20), rng.uniform(0.4, 0.9), float(rng.uniform(0.3, 0.55))
    at_pier = bool(rng.random() < 0.4)
    low_m = here.altitude_m + (rng.uniform(3.5, 6.0) if at_pier else -deep / 2 + rng.uniform(-0.4, 0.4))
    first = 0.0 if at_pier else apart * rng.uniform(0.3, 0.7)
    piers = [
        tube([(radius, y, 0), (radius, y, low_m)], radius, 0.9 * shade, 20)
        for y in first + apart * np.arange(-2, 3)
    ]
    deck_x = radius if at_pier else wide / 2
    parts = [box((deck_x, 0, low_m + deep / 2), (wide, long, deep), shade), *piers]
    bars = [(-wide / 2 + 0.1, wide / 2 - 0.1)[k] + deck_x for k in (0, 1)]
    if rng.random() < 0.5:
        parts += [box((x, 0, low_m + deep + 0.45), (0.2, long, 0.9), 1.1 * shade) for x in bars]
        return None, joined(*parts)
    top = low_m + deep
    posts = [[(x, y, top), (x, y, top + 1.1)] for x in bars for y in np.arange(-long / 2, long / 2, 1.5)]
    rails = [[(x, -long / 2, top + z), (x, long / 2, top + z)] for x in bars for z in (0.4, 0.75, 1.1)]
    return rods([*posts, *rails], 0.025, 0.3), joined(*parts)


def net(here: Site, rng: np.random.Generator) -> Parts:
    long, high = float(rng.uniform(12, 20)), here.altitude_m + float(rng.uniform(1.0, 4.0))
    side = float(rng.uniform(-0.3, 0.3)) * long
    ys = side + np.linspace(-long / 2, long / 2, 1 + round(long / rng.uniform(4, 6)))
    posts = [tube([(0.05, y, 0), (0.05, y, high + 0.2)], 0.05, float(rng.uniform(0.1, 0.5)), 8) for y in ys]
    ends = (side - long / 2, side + long / 2)
    if rng.random() < 0.6:
        mesh_m, cord, shade = (
            rng.uniform(0.08, 0.16),
            rng.uniform(0.001, 0.002),
            float(rng.uniform(0.03, 0.5)),
        )
        upright = [[(0, y, 0.1), (0, y, high)] for y in np.arange(*ends, mesh_m)]
        level = [[(0, ends[0], z), (0, ends[1], z)] for z in np.arange(0.1, high, mesh_m)]
        return rods([*upright, *level], cord, shade), joined(*posts)
    wires = [[(0, ends[0], z), (0, ends[1], z)] for z in np.arange(0.8, high, 0.5)]
    leaves = placed(vegetation.hedge(long, high - 0.5, rng, depth_m=0.4), (0, side, 0.5))
    return rods(wires, 0.0015, 0.3), joined(*posts, leaves)


def portal_crane(here: Site, rng: np.random.Generator) -> Parts:
    part, span = str(rng.choice(["leg", "girder", "load"])), float(rng.uniform(14, 30))
    over_m = {"girder": 0.0, "leg": float(rng.uniform(3, 9)), "load": float(rng.uniform(4, 8))}[part]
    high, shade = here.altitude_m + over_m, float(rng.uniform(0.15, 0.6))
    middle = {"leg": span / 2, "girder": float(rng.uniform(-0.35, 0.35)) * span, "load": 0.0}[part]
    foot_x = 0.25 * high
    shift = foot_x * over_m / high if part == "leg" else 0.0  # a leg leans: at the path it is so far ahead
    parts = [box((shift, middle, high), (1.0, span + 4, 1.4), shade)]
    for y in middle + np.array([-span / 2, span / 2]):
        legs = [tube([(shift + s * foot_x, y, 0), (shift, y, high)], 0.3, shade, 10) for s in (-1, 1)]
        parts += [*legs, box((shift, y, 0.4), (2 * foot_x, 0.5, 0.5), 0.8 * shade)]
    trolley = 0.0 if part == "load" else middle + float(rng.uniform(-0.3, 0.3)) * span
    load_m = here.altitude_m if part == "load" else float(rng.uniform(1.5, 0.6 * high))
    size = rng.uniform([1.5, 2.5, 1.2], [2.5, 6.0, 2.6])
    parts += [box((shift, trolley, high + 0.9), (1.6, 2.2, 0.6), 0.3)]
    parts += [box((shift, trolley, load_m), size, float(rng.uniform(0.1, 0.6)))]
    ropes = [
        [(shift, trolley + s, high), (shift, trolley + s * size[1] / 2.2, load_m + size[2] / 2)]
        for s in (-0.6, 0.6)
    ]
    return rods(ropes, 0.012, 0.1), joined(*parts)


def marquee(here: Site, rng: np.random.Generator) -> Parts:
    wide, eaves = float(rng.uniform(5, 10)), float(rng.uniform(2.4, 3.4))
    ridge = max(here.altitude_m + float(rng.uniform(0.8, 3.0)), eaves + 1.2)
    shade, count, is_peaked = float(rng.uniform(0.5, 0.8)), int(rng.integers(2, 5)), rng.random() < 0.5
    side = wide * (float(rng.uniform(-0.3, 0.3)) - (count // 2 + 0.5))
    share = float(np.clip((here.altitude_m - eaves) / (ridge - eaves), 0.0, 1.0))
    ahead = share * wide / 2 if is_peaked else 0.0  # so far behind its eaves a slanted roof is met
    parts = []
    for k in range(count):
        y, own = side + k * wide, shade * float(rng.uniform(0.97, 1.0))
        a, b, c, d = ((x - ahead, y + dy) for x, dy in ((0, 0), (0, wide), (wide, wide), (wide, 0)))
        parts += [
            polygon([(*p, 0), (*q, 0), (*q, eaves), (*p, eaves)], own * float(rng.uniform(0.97, 1.0)))
            for p, q in ((a, b), (b, c), (c, d), (d, a))
        ]
        tops = [(wide / 2 - ahead, y + wide / 2)] * 4
        if not is_peaked:  # the gable is met
            tops = [(0.0, y + wide / 2), (0.0, y + wide / 2), (wide, y + wide / 2), (wide, y + wide / 2)]
        for (p, q), (s, t) in zip(
            ((a, b), (b, c), (c, d), (d, a)), ((0, 1), (1, 2), (2, 3), (3, 0)), strict=True
        ):
            corners = [(*p, eaves), (*q, eaves), (*tops[t], ridge), (*tops[s], ridge)]
            parts.append(polygon(corners, own * float(rng.uniform(0.95, 1.0))))
    return None, joined(*parts)


def sailing_boat(mast_m: float, rng: np.random.Generator) -> Parts:
    """The mast at the origin, forward is +x."""
    long, shade, dark = 0.75 * mast_m, float(rng.uniform(0.3, 0.7)), float(rng.uniform(0.05, 0.6))
    top, reach = np.array([0.0, 0.0, mast_m]), 0.16 * long
    feet = [(0.45 * long, 0, 1.0), (-0.5 * long, 0, 1.0), (0, -reach, 1.0), (0, reach, 1.0)]
    stays = all_of(*(strand(foot, top, float(rng.uniform(0.002, 0.004)), 0.001, rng) for foot in feet))
    hull = lump((0, 0, 0.3), (0.55 * long, 1.1 * reach, 0.8), float(rng.uniform(0.05, 0.75)), 8, 16)
    boom = [(0, 0, 2.0), (-0.42 * long, 0, 2.1)]
    parts = [
        hull,
        box((-0.05 * long, 0, 1.2), (0.4 * long, 1.2 * reach, 0.5), shade),
        tube([(0, 0, 0.5), (0, 0, mast_m)], [0.1, 0.06], dark, 10),
        tube(boom, float(rng.uniform(0.06, 0.2)), shade, 8),
        box((0, 0, 0.6 * mast_m), (0.05, 1.5 * reach, 0.04), dark),
    ]
    return stays, joined(*parts)


def harbour(here: Site, rng: np.random.Generator) -> Parts:
    return sailing_boat(here.altitude_m + float(rng.uniform(1.5, 7.0)), rng)


def boats(here: Site, rng: np.random.Generator) -> Iterator[Thing]:
    """Sailing boats and buoys, 7 to 40 m beside the path."""
    for k, x in enumerate(np.arange(here.path.points_m[0, 0] + 12, 105, rng.uniform(8, 16))):
        place = (float(x), here.path.y_m(x) + rng.choice([-1, 1]) * log_uniform(rng, 7, 40), 0.0)
        wires, body = sailing_boat(float(rng.uniform(7, 15)), rng)
        if rng.random() < 0.2:
            wires, body = None, tube([(0, 0, 0), (0, 0, 2.2)], [0.7, 0.15], float(rng.choice([0.1, 0.5])), 12)
        yield whole(f"boat{k}", "boat", wires, body, place, float(rng.uniform(0, 360)))


def whole(
    name: str,
    kind: str,
    wires: Rods | None,
    body: Triangles,
    foot_m: Sequence[float] = (0, 0, 0),
    yaw_deg: float = 0.0,
    **more,
) -> Thing:
    solids: list[Solid] = [things.mesh(f"{name}_body", placed(body, foot_m, yaw_deg))]
    solids += [] if wires is None else wires.moved(foot_m, yaw_deg).solids(f"{name}_rod")
    return thing(name, kind, solids, **more)


def under_its_sky(here: Site, scene: Scene) -> Scene:
    clouded = scene.sky == "blue" and here.draws("clouds").random() < CLOUDS
    return replace(scene, sky="clouds") if clouded else scene


def met(
    make: Make, courses: Courses, covers: Sequence[str], around: Sequence[str], most_deg: float
) -> Callable[[float, int], Scene]:
    """The maker of scenes in which what `make` builds stands in the path, turned by up to `most_deg`."""

    def scene(altitude_m: float, seed: int) -> Scene:
        here = site(altitude_m, seed, courses, covers)
        rng = here.draws(make.__name__)
        yaw = float(rng.uniform(-most_deg, most_deg))
        target = whole("target", make.__name__, *make(here, rng), yaw_deg=yaw, target=True)
        others = boats(here, rng) if covers == WATER else clutter(here, around)
        return under_its_sky(here, scene_of(here, [target], [*others, *background(here)]))

    return scene


def billboard(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, AHEAD, COUNTRY_AND_TOWN)
    rng, is_banner = here.draws("billboard"), here.draws("banner").random() < 0.35
    wide, high = rng.uniform(5, 10) if is_banner else rng.uniform(6, 14), rng.uniform(2.5, 4.5)
    high = float(0.3 * high if is_banner else high)
    turn, side = np.radians(rng.uniform(-40, 40)), float(rng.uniform(-0.35, 0.35))
    right = wide / 2 * np.array([np.sin(turn), -np.cos(turn), 0.0])
    middle = side * 2 * right + [0, 0, here.altitude_m + rng.uniform(-0.25, 0.25) * high]
    front = printed(float(wide), high, some_seed(rng))
    solids: list[Solid] = [Panel("target_board", point(middle), point(right), (0.0, 0.0, -high / 2), front)]
    back, shares = (
        0.2 * np.array([np.cos(turn), np.sin(turn)]),
        (-1.0, 1.0) if is_banner else (-0.6, 0.0, 0.6),
    )
    for k, share in enumerate(shares):
        x, y = (middle + share * right)[:2] + back
        top = (float(x), float(y), float(middle[2]) + (0.7 if is_banner else 0.45) * high)
        radius = float(rng.uniform(0.04, 0.09) if is_banner else rng.uniform(0.08, 0.2))
        foot = here.foot_m(float(x), float(y))
        solids.append(round_pole(f"target_post{k}", foot, top, radius, some_seed(rng), "steel"))
    target = thing("target", "billboard", solids, target=True)
    scene = scene_of(here, [target], [*clutter(here, (*RURAL, *URBAN)), *background(here)])
    return under_its_sky(here, scene)


def traffic(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, IN_A_STREET, ("asphalt",))
    rng = here.draws("traffic")
    part, seed_of_board = str(rng.choice(["mast", "arm", "board"])), some_seed(rng)
    if part == "board":
        half, high = float(rng.uniform(5, 8)), float(rng.uniform(1.2, 2.6))
        middle = here.altitude_m + float(rng.uniform(-0.3, 0.3))
        target = things.overhead_board("target", 0.0, half, middle, high, seed_of_board, target=True)
    else:
        side, reach = float(rng.choice([-1, 1])), float(rng.uniform(4, 7))
        mast_y = 0.0 if part == "mast" else side * float(rng.uniform(0.3, 0.9)) * reach
        arm_m = here.altitude_m + (float(rng.uniform(1.0, 2.5)) if part == "mast" else 0.4)
        shade, end = float(rng.uniform(0.15, 0.5)), mast_y - side * reach
        parts = [
            tube([(0, mast_y, 0), (0, mast_y, arm_m + 0.3)], [0.14, 0.1], shade, 12),
            tube([(0, mast_y, arm_m), (0, end, arm_m + 0.2)], 0.06, shade, 8),
        ]
        for y in np.linspace(mast_y - side * 0.35 * reach, end, int(rng.integers(2, 4))):
            parts.append(box((-0.15, y, arm_m - 0.3), (0.25, 0.36, 1.0), 0.05))
            parts += [box((-0.28, y, arm_m - 0.3 + dz), (0.02, 0.2, 0.2), 0.3) for dz in (-0.3, 0.0, 0.3)]
        plate = placed(box((-0.1, 0, 0), (0.02, 0.9, 0.6), float(rng.uniform(0.3, 0.7))), (0, mast_y, 2.6))
        target = whole("target", "signal", None, joined(*parts, plate), target=True)
    kinds = ("lamp post", "car", "van", "thin post", "person")
    around = [*houses_beside(here, rng), *clutter(here, kinds, 16), *background(here, ("houses",))]
    return under_its_sky(here, scene_of(here, [target], around))


def clear_water(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, CLEAR, WATER)
    around = [*boats(here, here.draws("boats")), *background(here)]
    return under_its_sky(here, scene_of(here, (), around, meets_at_m=None))


def clear_rows(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, CLEAR, OPEN_COUNTRY)
    rng = here.draws("rows")
    apart, aside, form = (
        rng.uniform(5, 9),
        rng.uniform(7.5, 11),
        str(rng.choice(["broadleaf", "poplar", "bare"])),
    )
    found: list[Thing] = []
    for side in (-1, 1):
        for k, x in enumerate(np.arange(here.path.points_m[0, 0] + 8, 95, apart)):
            foot = here.foot_m(float(x), here.path.y_m(x) + side * aside + float(rng.normal(0, 0.3)))
            name, leaf = f"tree{side}_{k}", float(np.clip(6e-3 * (x + 16), 0.12, 0.5))
            if rng.random() < 0.25:
                top = (foot[0], foot[1], foot[2] + float(rng.uniform(4, 9)))
                post = round_pole(name, foot, top, float(rng.uniform(0.05, 0.15)), some_seed(rng), "wood")
                found.append(thing(name, "pole", [post]))
            else:
                found.append(things.tree(name, form, foot, float(rng.uniform(5, 11)), some_seed(rng), leaf))
    around = [*found, *background(here, ("trees", "forest", "open"))]
    return under_its_sky(here, scene_of(here, (), around, meets_at_m=None))


# ---- how they are flown, and where ----

WATER = ("water",)
AHEAD = Courses(altitude_m=(4.0, 13.0), speed_m_s=(6.0, 25.0), climb_deg=(-5.0, 4.0), most_bank_deg=15.0)
NEAR_GROUND = replace(AHEAD, altitude_m=(1.5, 5.0), speed_m_s=(3.0, 14.0), climb_deg=(-2.0, 2.0))
IN_A_STREET = replace(AHEAD, altitude_m=(3.5, 7.0), speed_m_s=(4.0, 16.0), most_bank_deg=6.0)
CLEAR = replace(AHEAD, altitude_m=(4.0, 10.0), climb_deg=(0.0, 3.0), most_bank_deg=6.0)


def family(
    name: str, title: str, scene: Callable[[float, int], Scene], courses: Courses, clear: bool = False
) -> Family:
    return Family(name, title, "test2", scene, courses, clear)


TEST2 = (
    family("turbine", "wind turbine", met(turbine, AHEAD, OPEN_COUNTRY, RURAL, 60), AHEAD),
    family("billboard", "billboard or banner", billboard, AHEAD),
    family("overpass", "bridge over a road", met(overpass, AHEAD, BUILT_UP, URBAN, 30), AHEAD),
    family("net", "net or trellis", met(net, NEAR_GROUND, COUNTRY_AND_TOWN, RURAL, 30), NEAR_GROUND),
    family("portal_crane", "portal crane", met(portal_crane, AHEAD, BUILT_UP, URBAN, 30), AHEAD),
    family("traffic", "signals and signs in a street", traffic, IN_A_STREET),
    family("harbour", "mast of a boat", met(harbour, AHEAD, WATER, (), 180), AHEAD),
    family("marquee", "tent in one shade", met(marquee, NEAR_GROUND, BUILT_UP, URBAN, 30), NEAR_GROUND),
    family("clear_water", "between boats, no obstacle", clear_water, CLEAR, clear=True),
    family("clear_rows", "between rows of trees, no obstacle", clear_rows, CLEAR, clear=True),
)
