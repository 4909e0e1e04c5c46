"""How a sampled flight is flown: drawn from the distributions of its family.

speed    3 to 25 m/s, each as likely, unless the family narrows it
rate     7.5 to 15 frames/s, the slowest that gives about 25 frames
end      10 to 14 m before the point (0, 0, altitude), which the path leads through along +x
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vista_eval.render.trajectory import Approach, Course
from vista_eval.worlds.sampled.draws import draws

RATES_HZ = (7.5, 10.0, 12.5, 15.0)
LAST_RANGE_M = (10.0, 14.0)
LEAST_FRAMES = 18


@dataclass(frozen=True)
class Courses:
    """What the flights of a family have in common."""

    altitude_m: tuple[float, float] = (4.0, 14.0)  # over the ground below (0, 0)
    speed_m_s: tuple[float, float] = (3.0, 25.0)
    span_m: tuple[float, float] = (38.0, 58.0)  # flown, unless that takes more frames than there may be
    most_frames: int = 28

    def draw(self, seed: int) -> Course:
        rng = draws(seed, "course")
        speed, span = float(rng.uniform(*self.speed_m_s)), float(rng.uniform(*self.span_m))
        wanted = speed * rng.uniform(22, 28) / span
        rate = min(RATES_HZ, key=lambda hz: abs(hz - wanted))
        frames = int(np.clip(round(span * rate / speed), LEAST_FRAMES, self.most_frames))
        return Approach(
            float(rng.uniform(*self.altitude_m)),
            speed,
            float(rng.uniform(*LAST_RANGE_M)),
            frames,
            rate,
            sway_phase_s=float(rng.uniform(0, 1000)),
            sway_scale=float(rng.uniform(0.5, 1.5)),
        )


ANY = Courses()
FROM_AFAR = Courses(speed_m_s=(13.0, 25.0), span_m=(66.0, 76.0), most_frames=40)  # first warnings count
LOW = Courses(altitude_m=(1.0, 1.8), speed_m_s=(3.0, 12.0))
