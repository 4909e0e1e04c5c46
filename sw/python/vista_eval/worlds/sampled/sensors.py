"""The cameras of a sampled flight.

85 %  fair: noise of 1 to 2.5 grey levels, gains that agree within 3 %
15 %  poor: noise of 2.5 to 10 grey levels, gains that agree within 10 %
"""

from __future__ import annotations

from vista_eval.render.sensor import Sensor
from vista_eval.worlds.sampled.draws import draws, log_uniform

POOR = 0.15
FULL_WELL_E = 12000.0


def sensor(seed: int) -> Sensor:
    rng = draws(seed, "sensor")
    poor = rng.random() < POOR
    noise_grey = log_uniform(rng, 2.5, 10.0) if poor else log_uniform(rng, 1.0, 2.5)
    mismatch = rng.uniform(-0.1, 0.1) if poor else rng.uniform(-0.03, 0.03)
    return Sensor(
        full_well_e=FULL_WELL_E,
        read_noise_e=noise_grey * FULL_WELL_E / 255,
        gain=(1.0, float(1 + mismatch)),
    )
