"""The light of a flight: sun from any side, overcast, low sun, haze.

45 %  sun, 20 to 65 degrees high             25 %  overcast (uniform grey sky)
15 %  low sun, 5 to 15 degrees high          15 %  haze, 250 to 1500 m visibility, under sun or cloud
"""

from __future__ import annotations

from typing import Any

import numpy as np

from vista_eval.render.scene import Haze
from vista_eval.worlds.draws import draws, log_uniform

SHARES = {"sun": 0.45, "overcast": 0.25, "low sun": 0.15, "haze": 0.15}
EXTINCTION_AT_VISIBILITY = 3.9
GREY_OF_GROUND = (0.22, 0.40)  # what the automatic exposure makes of the ground, as a share of white


def kind_of_light(seed: int) -> str:
    rng = draws(seed, "kind of light")
    return str(rng.choice(list(SHARES), p=list(SHARES.values())))


def light(seed: int, albedo: float) -> dict[str, Any]:
    """Fields of the scene. albedo: of the ground, for the exposure."""
    kind, rng = kind_of_light(seed), draws(seed, "light")
    overcast = kind == "overcast" or (kind == "haze" and rng.random() < 0.5)
    elevation = np.radians(rng.uniform(5, 15) if kind == "low sun" else rng.uniform(20, 65))
    azimuth = rng.uniform(0, 2 * np.pi)
    sun = float(rng.uniform(0.0, 0.6) if overcast else rng.uniform(3.0, 4.6))
    fill = float(rng.uniform(2.0, 2.6) if overcast else rng.uniform(1.3, 2.2))
    falling = sun * np.sin(elevation) + 0.55 * fill
    exposure = float(np.clip(rng.uniform(*GREY_OF_GROUND) * np.pi / (albedo * falling), 0.5, 3.0))
    air = None
    if kind == "haze":
        extinction = EXTINCTION_AT_VISIBILITY / log_uniform(rng, 250, 1500)
        air = Haze(extinction, float(rng.uniform(0.45, 0.85)) / exposure)
    level = np.cos(elevation)
    to_sun = (level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation))
    return {
        "to_sun": tuple(float(c) for c in to_sun),
        "sun_irradiance": sun,
        "fill_irradiance": fill,
        "sky": "overcast" if overcast else "blue",
        "overcast_radiance": float(rng.uniform(0.5, 1.2)) / exposure,
        "haze": air,
        "exposure": exposure,
    }
