"""Vehicles in a low path; drones and birds in the air."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Thing
from vista_eval.worlds import things, vehicle
from vista_eval.worlds.courses import ANY, Courses
from vista_eval.worlds.draws import log_uniform
from vista_eval.worlds.grounds import BUILT_UP, COUNTRY_AND_TOWN, OPEN_COUNTRY
from vista_eval.worlds.site import RURAL, URBAN, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, lump, placed

OVER_A_ROAD = Courses(altitude_m=(1.2, 2.4), speed_m_s=(3.0, 15.0), climb_deg=(-3.0, 0.0), most_bank_deg=10.0)
MOST_ASIDE = 0.2  # speed across, of that of the approach; half the view is 0.32


def lorry(paint: float, rng: np.random.Generator) -> Triangles:
    """A box body 2.5 m wide and 3.4 to 3.9 m high behind a cab; forward is +x, wheels on z = 0."""
    length, height = rng.uniform(6.5, 10.0), rng.uniform(3.4, 3.9)
    body = box((-1.2, 0, 0.55 + height / 2), (length, 2.5, height - 1.1), paint)
    cab = vehicle.reflecting(box((length / 2 + 0.1, 0, 1.7), (2.0, 2.4, 2.4), 0.4), 0.15, 0.5)
    screen = box((length / 2 + 1.1, 0, 2.2), (0.04, 2.1, 0.9), 0.06)
    band = box(
        (-1.2, 0, rng.uniform(1.6, 2.8)), (length + 0.02, 2.52, rng.uniform(0.2, 0.8)), rng.uniform(0.05, 0.8)
    )
    wheels = vehicle.wheels((length / 2 - 0.2, -length / 2 - 0.2), 2.3, 0.5)
    return joined(
        body, cab, screen, band, wheels, vehicle.ends(length / 2 + 1.15, -length / 2 - 1.2, 2.4, 0.9)
    )


def bus(paint: float, rng: np.random.Generator) -> Triangles:
    """11 m long, a row of dark windows all round."""
    length = rng.uniform(9.5, 12.0)
    body = vehicle.reflecting(box((0, 0, 1.75), (length, 2.5, 2.8), paint), 0.7 * paint, paint)
    glass = [box((0, 0, 2.0), (length + 0.02, 2.52, 0.9), 0.06)]
    posts = [
        box((x, 0, 2.0), (0.12, 2.54, 0.9), paint) for x in np.arange(1.5 - length / 2, length / 2 - 0.1, 1.5)
    ]
    wheels = vehicle.wheels((length / 2 - 2.4, -length / 2 + 2.8), 2.3, 0.48)
    return joined(body, *glass, *posts, wheels, vehicle.ends(length / 2, -length / 2, 2.4, 0.8))


def crossing_m_s(here: Site, rng: np.random.Generator, most: float) -> float:
    """Speed across the path of what will be met."""
    return in_view_m_s(here, float(rng.choice([-1, 1]) * rng.uniform(0.0, most)), 0.0)


def in_view_m_s(here: Site, across_m_s: float, along_m_s: float) -> float:
    """The speed across, but so much less that all the way to where it is met the thing is in view."""
    most = MOST_ASIDE * (here.course.speed_m_s - along_m_s)
    return float(np.clip(across_m_s, -most, most))


def beside_m(here: Site, across_m_s: float, along_m_s: float = 0.0) -> float:
    """How far beside the path a thing ahead is in the last frame, that will be met in the middle of it."""
    return -across_m_s * here.course.last_range_m / (here.course.speed_m_s - along_m_s)


def road_vehicle(altitude_m: float, seed: int) -> Scene:
    """A car, a van, a lorry or a bus, standing, going ahead or crossing; as high as the path or higher."""
    here = site(altitude_m, seed, OVER_A_ROAD, BUILT_UP)
    rng = here.draws("vehicle")
    kinds = [vehicle.van, lorry, bus, *([vehicle.car] if altitude_m < 1.9 else [])]
    build, paint = kinds[int(rng.integers(len(kinds)))], float(rng.choice([0.05, 0.15, 0.4, 0.7]))
    motion = str(rng.choice(["stands", "stands", "ahead", "crosses"]))
    across = crossing_m_s(here, rng, 3.0) if motion == "crosses" else 0.0
    y = beside_m(here, across) if across else float(rng.uniform(-0.6, 0.6))
    yaw = {"crosses": 90.0 * np.sign(across), "ahead": 0.0}.get(motion, float(rng.uniform(0, 360)))
    along = float(rng.uniform(0.5, 2.5)) if motion == "ahead" else 0.0
    target = things.one(
        "target", "vehicle", build(paint, rng), (0, y, 0), yaw, target=True, velocity_m_s=(along, across, 0.0)
    )
    return scene_of(here, [target], [*clutter(here, URBAN), *background(here)])


def drone(altitude_m: float, seed: int) -> Scene:
    """0.5 to 1.5 m across: hovering, coming the other way or crossing."""
    here = site(altitude_m, seed, ANY, COUNTRY_AND_TOWN)
    rng = here.draws("drone")
    scale, motion = float(rng.uniform(0.4, 1.15)), str(rng.choice(["hovers", "comes", "crosses"]))
    across = crossing_m_s(here, rng, 2.5) if motion == "crosses" else 0.0
    y = beside_m(here, across) if across else float(rng.uniform(-0.5, 0.5))
    velocity = (-float(rng.uniform(1, 6)) if motion == "comes" else 0.0, across, 0.0)
    shape = placed(vehicle.drone(rng), (0, 0, 0), float(rng.uniform(0, 360)), scale)
    place = (0.0, y, altitude_m + float(rng.uniform(-0.5, 0.5)))
    target = things.one("target", "drone", shape, place, target=True, velocity_m_s=velocity)
    return scene_of(here, [target], [*clutter(here, RURAL, 10), *background(here)])


def bird(span_m: float, flap_deg: float, rng: np.random.Generator) -> Triangles:
    """Body, tail and two wings raised by an angle; forward is +x."""
    dark = log_uniform(rng, 0.04, 0.5)
    body = lump((0, 0, 0), (0.28 * span_m, 0.07 * span_m, 0.07 * span_m), dark, 6, 8)
    parts = [body]
    for side in (-1, 1):
        turn = np.radians(flap_deg)
        tip = np.array([-0.12 * span_m, side * 0.5 * span_m * np.cos(turn), 0.5 * span_m * np.sin(turn)])
        root = np.array([[0.12, 0, 0.02], [-0.1, 0, 0.02]]) * span_m
        middle = 0.5 * tip + [0.1 * span_m, 0, 0.03 * span_m]
        corners = np.array([root[0], middle, tip, root[1]])
        shades = np.full(4, dark * rng.uniform(0.7, 1.3))
        parts.append(Triangles(corners, np.array([[0, 1, 3], [1, 2, 3]]), np.clip(shades, 0.02, 0.8)))
    fan = np.array([[-0.2, 0, 0], [-0.42, -0.09, 0], [-0.42, 0.09, 0]]) * span_m
    parts.append(Triangles(fan, np.array([[0, 1, 2]]), np.full(3, dark)))
    return joined(*parts)


def birds(altitude_m: float, seed: int) -> Scene:
    """One to twelve of 0.7 to 2 m span, gliding or crossing; one of them is met."""
    here = site(altitude_m, seed, ANY, OPEN_COUNTRY)
    rng = here.draws("birds")
    span, course = float(rng.uniform(0.7, 2.0)), float(rng.uniform(0, 2 * np.pi))
    speed = float(rng.uniform(0.5, 6.0))
    along = speed * float(np.cos(course)) * (1.0 if np.cos(course) < 0 else 0.3)
    across = in_view_m_s(here, float(np.clip(speed * np.sin(course), -2.0, 2.0)), along)
    velocity = (along, across, 0.0)
    yaw = float(np.degrees(np.arctan2(velocity[1], velocity[0])))

    def one(name: str, place: np.ndarray, **more) -> Thing:
        shape = bird(span * float(rng.uniform(0.9, 1.1)), float(rng.uniform(-25, 45)), rng)
        return things.one(name, "bird", shape, place, yaw, velocity_m_s=velocity, **more)

    first = np.array([0.0, beside_m(here, across, along), altitude_m])
    flock = [
        one(f"bird{k}", first + rng.normal(0, 1, 3) * [6, 5, 2] + [4, 0, 0])
        for k in range(int(rng.integers(0, 12)))
    ]
    around = [*clutter(here, RURAL, 10), *background(here)]
    # The flock may be in the way as a whole.
    return scene_of(here, [one("target", first, target=True), *flock], around)
