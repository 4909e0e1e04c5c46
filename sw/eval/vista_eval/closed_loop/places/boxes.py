"""The boxes of the UAV testing competition of SBFT and ICST 2024 and 2025.

At most three boxes with x from -40 to 30 and y from 10 to 40 m, sides of 2 to 20 m, 10 to 25 m high, turned
by 0 to 90 degrees; the flight is at 10 m height and 5 m/s, and nearer than 1.5 m fails. The named cases are
those of the sixteen published tests of one team (gulicatta/UAV-Testing-Competition) whose route is published
too: five of mission 1 and six of mission 3. The route of mission 2 is not.

Their frame is north, east; here x leads east and y north to the other side, so a flight leads along x.

Differences: the original flies PX4 with one depth camera in Gazebo, from the ground up; here the flight
begins at its height, boxes are faced with textured walls, and the ground has a texture."""

from __future__ import annotations

import numpy as np

from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.world import World
from vista_eval.render.scene import Point, Thing
from vista_eval.worlds.draws import draws, seed_of

Box = tuple[
    float, float, float, float, float, float
]  # x, y, turn in degrees, length, width, height: as published

HEIGHT_M, SPEED_M_S = 10.0, 5.0
NORTH_M, EAST_M = (-40.0, 30.0), (10.0, 40.0)
# From the geographic coordinates of the plans.
MISSION_1: tuple[Point, ...] = ((0.0, 0.0, HEIGHT_M), (53.0, -3.7, HEIGHT_M))
MISSION_3: tuple[Point, ...] = (
    (0.0, 0.0, HEIGHT_M),
    (53.0, -3.7, HEIGHT_M),
    (54.0, 14.3, HEIGHT_M),
    (0.9, 17.4, HEIGHT_M),
)

# Mission, the distance that the authors' flight reached, boxes.
PUBLISHED: tuple[tuple[int, float, tuple[Box, ...]], ...] = (
    (1, 1.403, ((7.195, 32.558, 37.974, 20.0, 3.270, 24.640),)),
    (1, 0.128, ((4.208, 21.443, 0.0, 17.174, 2.0, 10.0), (-8.492, 25.405, 84.411, 14.785, 6.896, 25.0))),
    (1, 0.786, ((8.095, 33.649, 13.899, 20.0, 4.198, 17.057), (-0.629, 20.437, 90.0, 12.557, 15.140, 10.0))),
    (
        1,
        1.323,
        ((8.482, 34.275, 5.392, 20.0, 2.018, 14.822), (-0.753, 18.232, 85.150, 10.987, 13.324, 11.655)),
    ),
    (
        1,
        0.000,
        (
            (8.058, 33.876, 5.374, 20.0, 3.620, 18.625),
            (-0.717, 21.124, 90.0, 11.753, 14.249, 10.191),
            (21.937, 35.408, 4.072, 6.135, 3.014, 23.117),
        ),
    ),
    (3, 0.460, ((-18.337, 30.687, 19.637, 10.668, 2.0, 24.120),)),
    (3, 0.962, ((1.482, 21.487, 51.448, 18.786, 3.219, 17.296),)),
    (3, 1.496, ((-18.293, 29.733, 62.347, 2.0, 20.0, 19.335),)),
    (3, 0.730, ((-1.344, 19.172, 50.277, 14.879, 2.0, 19.070), (11.662, 23.160, 72.982, 2.530, 8.3, 19.629))),
    (3, 1.165, ((-16.681, 26.752, 0.0, 2.0, 20.0, 25.0), (-2.843, 29.315, 43.245, 19.989, 8.953, 14.378))),
    (
        3,
        1.253,
        ((-17.018, 26.952, 19.437, 2.0, 20.0, 19.422), (-0.019, 30.325, 78.640, 16.785, 14.696, 18.680)),
    ),
)


def build(number: int, seed: int, speed_m_s: float | None) -> World:
    if number < len(PUBLISHED):
        mission, reached_m, boxes = PUBLISHED[number]
        own = seed_of("published boxes", number)
        name = f"boxes_mission{mission}_{number:02d}_{reached_m:.3f}"
        return world(name, boxes, MISSION_1 if mission == 1 else MISSION_3, own, speed_m_s)
    own = seed_of(seed, "boxes", number)
    return world(f"boxes_{number:03d}", drawn(own), MISSION_1, own, speed_m_s)


def drawn(seed: int) -> tuple[Box, ...]:
    """One to three boxes that do not overlap and keep off the start; the first one stands on the route."""
    rng = draws(seed, "boxes")
    found: list[Box] = []
    count = int(rng.integers(1, 4))
    while len(found) < count:
        length, width = rng.uniform(2, 20, 2)
        y = float(rng.uniform(*EAST_M))
        x = float(rng.uniform(*NORTH_M)) if found else 3.7 * y / 53.0 + float(rng.uniform(-0.5, 0.5) * length)
        box = (x, y, float(rng.uniform(0, 90)), float(length), float(width), float(rng.uniform(10, 25)))
        apart = [np.hypot(length, width) / 2 + np.hypot(b[3], b[4]) / 2 for b in found]
        clear = all(np.hypot(x - b[0], y - b[1]) > a for b, a in zip(found, apart, strict=True))
        if clear and np.hypot(x, y) > 8 + np.hypot(length, width) / 2:
            found.append(box)
    return tuple(found)


def world(
    name: str, boxes: tuple[Box, ...], route: tuple[Point, ...], seed: int, speed_m_s: float | None
) -> World:
    standing: list[Thing] = [
        parts.upright_box(f"box{k}", (y, -x), (length, width, height), turn - 90.0, seed)
        for k, (x, y, turn, length, width, height) in enumerate(boxes)
    ]
    cover = str(draws(seed, "cover").choice(["pasture", "meadow", "gravel", "stubble", "crop"]))
    scene = parts.scene(seed, cover, standing, (-5.0, 70.0), (-30.0, 42.0))
    return World(name, "boxes", scene, route, speed_m_s or SPEED_M_S, seed=seed)


def build_clear(number: int, seed: int, speed_m_s: float | None) -> World:
    """The same boxes, none within 8 m of the route: every stop and every evasion is needless."""
    own = seed_of(seed, "clear", number)
    rng = draws(own, "aside")
    boxes: list[Box] = []
    while len(boxes) < 3:
        length, width = rng.uniform(2, 20, 2)
        x, y = float(rng.uniform(*NORTH_M)), float(rng.uniform(*EAST_M))
        if abs(x - 3.7 * y / 53.0) > 8.0 + np.hypot(length, width) / 2:
            boxes.append(
                (x, y, float(rng.uniform(0, 90)), float(length), float(width), float(rng.uniform(10, 25)))
            )
    made = world(f"clear_{number:03d}", tuple(boxes), MISSION_1, own, speed_m_s)
    return World(made.name, "clear", made.scene, made.route_m, made.speed_m_s, seed=own)
