"""The flights by name: those of the companion paper's table, and twenty more.

Half of them, `dev`, is what parameters may be chosen on; `test` is what results are told of. Every kind of
scene is in both as far as it goes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from vista_eval.render.course import FOOT_M, Course
from vista_eval.render.flight import Flight
from vista_eval.render.scene import Scene
from vista_eval.worlds import meadow_flights as meadow
from vista_eval.worlds import street_flights as street

ALTITUDE_M = 21 * FOOT_M
FAST_M_S, SLOW_M_S = 30 * FOOT_M, 10 * FOOT_M
RATE_HZ = 10.0
# Where the paper's tracks begin: signs and poles are to be seen from 60 m on, after up to 10 m of travel over
# which what is seen is tested.
TABLE_FIRST_RANGE_M = 88.0
CROSSING_M = 75.0  # so that most of the flight shows the drone before it is in the way
LARGE_M = 64.0  # whatever else stands in the way, and nothing at all
LAST_RANGE_M = 14.0
# From beyond the band of hits to where nothing is matched: 64 disparities end at 457.2 / 63 = 7.3 m.
CLOSE_M = 55.0, 4.0


def flight(
    name: str, title: str, split: Literal["dev", "test"], scene: Callable[[float, int], Scene], seed: int,
    first_m: float = TABLE_FIRST_RANGE_M, last_m: float = LAST_RANGE_M, speed_m_s: float = FAST_M_S,
    altitude_m: float = ALTITUDE_M,
) -> Flight:  # fmt: skip
    frames = round((first_m - last_m) * RATE_HZ / speed_m_s) + 1
    course = Course(altitude_m, speed_m_s, last_m, frames, RATE_HZ, sway_phase_s=7.3 * seed)
    return Flight(name, title, split, course, scene, seed=seed)


COMPANION_TABLE = (
    flight("sign_10", "1 sign, 10 ft/s", "test", meadow.sign_site_before_hills, 1, speed_m_s=SLOW_M_S),
    flight("sign_30", "2 sign, 30 ft/s", "dev", meadow.sign_site_at_noon, 2),
    flight("pole_30", "3 pole, 30 ft/s", "test", meadow.pole_site, 3),
    flight("pole_10", "4 pole, 10 ft/s", "dev", meadow.pole_site_in_shade, 4, speed_m_s=SLOW_M_S),
)
OTHERS = (
    flight("overcast", "sign under an overcast sky", "dev", meadow.overcast_sign, 5),
    flight("low_sun", "pole against a low sun", "test", meadow.low_sun_pole, 6),
    flight("haze", "sign in haze", "test", meadow.hazy_sign, 7),
    flight("wind", "pole between trees in the wind", "dev", meadow.windy_pole, 8),
    flight("fences", "sign between picket fences", "test", meadow.fenced_sign, 9),
    flight("thin_pole", "thin pole", "dev", meadow.thin_pole, 10),
    flight("tree", "tree, down to 8 m", "test", meadow.lone_tree, 11, LARGE_M, last_m=8.0),
    flight("wall", "wall without texture", "dev", meadow.plain_wall, 12, LARGE_M),
    flight("drone_ahead", "drone coming the other way", "test", meadow.approaching_drone, 13, LARGE_M),
    flight("drone_across", "drone crossing", "dev", meadow.crossing_drone, 14, CROSSING_M),
    flight("clear_meadow", "meadow, no obstacle", "dev", meadow.clear_meadow, 15, LARGE_M),
    flight("clear_fences", "over fences and hedges, no obstacle", "test", meadow.clear_fences, 16, LARGE_M),
    flight("clear_street", "street, no obstacle", "dev", street.clear_street, 17, LARGE_M),
    flight("clear_facades", "facades on three sides, no obstacle", "test", street.clear_facades, 18, LARGE_M),
    flight("clear_lane", "forest lane, no obstacle", "dev", street.clear_lane, 19, LARGE_M),
    flight("urban", "tree, lamp post and board in a street", "test", street.urban, 20, LARGE_M),
    flight("sign_facade", "sign before a facade", "dev", street.sign_before_facade, 21),
    flight("lamp_facade", "lamp post before a facade", "test", street.lamp_post_before_facade, 22),
    flight("van", "van crossing, low flight", "test", street.van_in_the_way, 23, LARGE_M, altitude_m=2.6),
    flight("close", "brick pier, down to 4 m, 10 ft/s", "test", meadow.brick_pier, 24, *CLOSE_M, SLOW_M_S),
)
FLIGHTS = {each.name: each for each in (*COMPANION_TABLE, *OTHERS)}
