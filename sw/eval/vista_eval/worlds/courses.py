"""How a sampled flight is flown: drawn from the distributions of its family.

speed    3 to 25 m/s, each as likely, unless the family narrows it; the steeper the bank, the faster
rate     7.5 to 15 frames/s, the one that comes nearest to 25 frames
path     climbing or descending in 40 %, turning in 40 %, as far as the family allows: up to 45 degrees
         of bank; straight and level in what is left
gusts    in 40 %, with a standard deviation of up to 2.5 % of the speed: where the flight leads
         can still be told from how it has been flown
end      10 to 14 m before the point (0, 0, altitude), which the path leads through along +x
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vista_eval.render.course import GRAVITY_M_S2, Course, Gusts
from vista_eval.worlds.draws import draws, some_seed

RATES_HZ = (7.5, 10.0, 12.5, 15.0)
LAST_RANGE_M = (10.0, 14.0)
LEAST_FRAMES = 18
# Over level ground: no gust blows an aircraft lower than the one, or than the other of a low flight.
LEAST_HEIGHT_M, LEAST_SHARE = 2.5, 0.7
MOST_HEADING_RAD = 0.87  # that a flight turns, so that what it flies at comes into view early enough
CLIMBS, TURNS, GUSTS = 0.4, 0.4, 0.4  # shares
STEEP_SPEED_M_S = 25.0  # at 45 degrees of bank; a bank of less is flown slower, so that the turn is as wide


@dataclass(frozen=True)
class Courses:
    """What the flights of a family have in common."""

    altitude_m: tuple[float, float] = (4.0, 14.0)  # over the ground below (0, 0)
    speed_m_s: tuple[float, float] = (3.0, 25.0)
    span_m: tuple[float, float] = (38.0, 58.0)  # flown, unless that takes more frames than there may be
    most_frames: int = 28
    climb_deg: tuple[float, float] = (-10.0, 8.0)
    most_bank_deg: float = 30.0
    most_gust: float = 0.025  # standard deviation, of the speed

    def draw(self, seed: int) -> Course:
        rng = draws(seed, "course")
        altitude, last = float(rng.uniform(*self.altitude_m)), float(rng.uniform(*LAST_RANGE_M))
        bank = float(rng.uniform(-1, 1)) * self.most_bank_deg if rng.random() < TURNS else 0.0
        least = max(self.speed_m_s[0], STEEP_SPEED_M_S * float(np.sqrt(np.tan(np.radians(abs(bank))))))
        speed = float(rng.uniform(min(least, self.speed_m_s[1]), self.speed_m_s[1]))
        span = float(rng.uniform(*self.span_m))
        if bank:
            radius_m = speed**2 / (GRAVITY_M_S2 * float(np.tan(np.radians(abs(bank)))))
            span = min(span, MOST_HEADING_RAD * radius_m - last)
        wanted = speed * rng.uniform(22, 28) / span
        rate = min(RATES_HZ, key=lambda hz: abs(hz - wanted))
        frames = int(np.clip(round(span * rate / speed), LEAST_FRAMES, self.most_frames))
        climb = float(rng.uniform(*self.climb_deg)) if rng.random() < CLIMBS else 0.0
        way_m = last + frames * speed / rate
        steepest = max(0.0, altitude - LEAST_HEIGHT_M - 0.1) / way_m
        gust = float(rng.uniform(0, self.most_gust)) * speed if rng.random() < GUSTS else 0.0
        course = Course(
            altitude,
            speed,
            last,
            frames,
            rate,
            climb_deg=min(climb, float(np.degrees(np.arcsin(min(steepest, 0.5))))),
            bank_deg=bank,
            gusts=Gusts(gust, some_seed(rng)),
            sway_phase_s=float(rng.uniform(0, 1000)),
            sway_scale=float(rng.uniform(0.5, 1.5)),
        )
        while lowest_m(course) < min(LEAST_HEIGHT_M, LEAST_SHARE * altitude):
            course = replace(course, gusts=replace(course.gusts, sigma_m_s=course.gusts.sigma_m_s / 2))
        return course


def lowest_m(course: Course) -> float:
    return float(min(course.state_at(k).world_from_body[2, 3] for k in range(course.frames)))


ANY = Courses(most_bank_deg=45.0)
# First warnings count here: the target is in view from afar.
FROM_AFAR = Courses(
    speed_m_s=(13.0, 25.0), span_m=(66.0, 76.0), most_frames=40, climb_deg=(-4.0, 3.0), most_bank_deg=6.0
)
LOW = Courses(altitude_m=(1.0, 1.8), speed_m_s=(3.0, 12.0), climb_deg=(-3.0, 0.0), most_bank_deg=8.0)
