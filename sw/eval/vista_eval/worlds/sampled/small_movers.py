"""Small things that fly, 0.4 to 1.5 m across and 2 to 15 m/s fast: a kite, a balloon, a model aircraft,
a flock of gulls.

They come the other way or cross; all of them are met."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Thing
from vista_eval.worlds import things
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import log_uniform
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN
from vista_eval.worlds.sampled.movers import beside_m
from vista_eval.worlds.site import RURAL, Site, background, clutter, scene_of, site
from vista_eval.worlds.triangles import Triangles, box, joined, lump, polygon, tube

IN_THE_AIR = Courses(
    altitude_m=(5.0, 16.0),
    speed_m_s=(5.0, 20.0),
    span_m=(42.0, 58.0),
    climb_deg=(-5.0, 6.0),
    most_bank_deg=15.0,
)
SIZE_M, SPEED_M_S = (0.4, 1.5), (2.0, 15.0)
MOST_BEARING = 0.24  # tangent, of what comes: it stays in view
MOST_OFF_AXIS = 0.31  # tangent, in the last frame; the edge of the image is at 0.32
PLACE_M = 0.4  # its place varies by so much to either side
CAMERA_M = 0.25  # half a baseline, and a little: from the body to a camera


def kite(size_m: float, rng: np.random.Generator) -> Triangles:
    """A diamond that faces forward, leaning back, in two shades, with a tail of bows; forward is +x."""
    half, lean = 0.4 * size_m, rng.uniform(0.2, 0.5)
    top, low = np.array([-lean * half, 0, 0.5 * size_m]), np.array([lean * half, 0, -0.5 * size_m])
    left, right = np.array([0, half, 0.12 * size_m]), np.array([0, -half, 0.12 * size_m])
    shades = rng.uniform(0.05, 0.7, 2)
    sail = [polygon([top, left, low], shades[0]), polygon([top, low, right], shades[1])]
    bows = [
        box(
            low - np.array([0.1 * k, 0, 0.16 * k]) * size_m,
            (0.02, 0.12 * size_m, 0.05 * size_m),
            shades[k % 2],
        )
        for k in range(1, int(rng.integers(3, 7)))
    ]
    return joined(*sail, *bows)


def balloon(size_m: float, rng: np.random.Generator) -> Triangles:
    """Egg-shaped, in bands, with a basket or a card below."""
    half, shades = size_m / 2, rng.uniform(0.05, 0.7, 2)
    hull = lump((0, 0, 0), (0.8 * half, 0.8 * half, half), float(shades[0]), 14, 16)
    bands = shades[np.floor(hull.vertices_m[:, 2] / (0.4 * half)).astype(int) % 2]
    card = box((0, 0, -1.25 * half), (0.05 * size_m, 0.2 * size_m, 0.15 * size_m), float(shades[1]))
    return joined(hull._replace(albedo=bands), card)


def model_aircraft(span_m: float, rng: np.random.Generator) -> Triangles:
    """A fuselage, a wing over it, a tail; forward is +x."""
    length, shades = span_m * rng.uniform(0.65, 0.9), rng.uniform(0.05, 0.75, 2)
    nose, end = np.array([0.4 * length, 0, 0]), np.array([-0.6 * length, 0, 0.02 * span_m])
    thick = rng.uniform(0.035, 0.06) * span_m
    hull = tube([nose, 0.5 * nose, 0.3 * end, end], thick * np.array([0.5, 1, 1, 0.3]), float(shades[0]), 8)
    wing = box((0.06 * length, 0, 1.2 * thick), (0.17 * span_m, span_m, 0.025 * span_m), float(shades[1]))
    plane = box(end, (0.1 * span_m, 0.35 * span_m, 0.02 * span_m), float(shades[1]))
    fin = box(
        end + np.array([0, 0, 0.09 * span_m]), (0.11 * span_m, 0.02 * span_m, 0.18 * span_m), float(shades[0])
    )
    return joined(hull, wing, plane, fin)


def gull(span_m: float, rng: np.random.Generator) -> Triangles:
    """A body and two angled wings with dark tips."""
    pale, dark, raised = rng.uniform(0.35, 0.7), rng.uniform(0.04, 0.15), rng.uniform(-0.2, 0.45)
    body = lump((0, 0, 0), (0.22 * span_m, 0.05 * span_m, 0.06 * span_m), pale, 6, 8)
    wings = []
    for side in (-1, 1):
        wrist = np.array([0.07, side * 0.22, 0.22 * raised]) * span_m
        tip = np.array([-0.08, side * 0.5, 0.32 * raised]) * span_m
        front, back = np.array([0.09, 0, 0.02]) * span_m, np.array([-0.09, 0, 0.02]) * span_m
        wings += [
            polygon([front, wrist, back], pale),
            polygon([wrist, wrist - [0.14 * span_m, 0, 0], back], pale),
            polygon([wrist, tip, wrist - [0.14 * span_m, 0, 0]], dark),
        ]
    return joined(body, *wings)


def velocity_m_s(here: Site, fastest_m_s: float, rng: np.random.Generator) -> np.ndarray:
    """Head on or across, or anything between; so that it stays in view until it is met."""
    speed, turn = log_uniform(rng, SPEED_M_S[0], fastest_m_s), rng.uniform(0, np.pi / 2)
    along, across = -speed * np.cos(turn), float(rng.choice([-1, 1])) * speed * np.sin(turn)
    closing = here.course.speed_m_s - along
    axis, most = bearing_of_the_axis(here), MOST_OFF_AXIS - (PLACE_M + CAMERA_M) / here.course.last_range_m
    bearings = np.clip([axis - most, axis + most], -MOST_BEARING, MOST_BEARING)
    return np.array([along, np.clip(across, *(-closing * bearings[::-1])), 0.0])


def bearing_of_the_axis(here: Site) -> float:
    """Tangent of the bearing, from the end of the path, of what is straight ahead in the last frame: a slow
    aircraft in a turn looks elsewhere than where it goes."""
    pose = here.course.state_at(here.course.frames - 1).world_from_body
    return float(pose[1, 0] / pose[0, 0] + pose[1, 3] / here.course.last_range_m)


def small_movers(altitude_m: float, seed: int) -> Scene:
    here = site(altitude_m, seed, IN_THE_AIR, COUNTRY_AND_TOWN)
    rng = here.draws("small movers")
    build, fastest_m_s = [(kite, 5.0), (balloon, 6.0), (model_aircraft, 15.0), (gull, 12.0)][
        int(rng.integers(4))
    ]
    velocity = velocity_m_s(here, fastest_m_s, rng)
    yaw_deg = float(rng.uniform(0, 360))
    if build in (model_aircraft, gull):
        yaw_deg = float(np.degrees(np.arctan2(velocity[1], velocity[0])))
    size_m = log_uniform(rng, *SIZE_M)
    moving = (float(velocity[0]), float(velocity[1]), 0.0)

    def one(name: str, place_m: np.ndarray, **more) -> Thing:
        shape = build(size_m, rng)
        return things.one(name, build.__name__, shape, place_m, yaw_deg, velocity_m_s=moving, **more)

    aside_m = beside_m(here, moving[1], moving[0]) + float(rng.uniform(-PLACE_M, PLACE_M))
    place = np.array([0.0, aside_m, altitude_m + float(rng.uniform(-0.5, 0.5))])
    flock = int(rng.integers(3, 11)) if build is gull else 0
    others = [one(f"gull{k}", place + rng.normal(0, 1, 3) * [4, 3, 1.2] + [3, 0, 0]) for k in range(flock)]
    around = [*clutter(here, RURAL, 10), *background(here)]
    return scene_of(here, [one("target", place, target=True), *others], around)
