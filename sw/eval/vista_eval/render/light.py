"""What light falls on surfaces, and what the air and the sky add."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Haze, Scene
from vista_eval.render.surfaces import Surfaces
from vista_eval.render.textures import layered, smoothstep

# The sky's light comes from all sides, more from above, and a part of it from one direction, above and
# behind the aircraft, with shadows: what stands is darker below, and so is the ground beneath it.
FROM_ALL_SIDES, FROM_ABOVE = 1.0, 0.5
ABOVE = np.array([-0.45, 0.10, 0.89]) / np.linalg.norm([-0.45, 0.10, 0.89])
HORIZON, ZENITH, AROUND_SUN = 0.85, 0.40, 0.5  # radiance of a blue sky
SUN_GLOW = 12.0  # how closely its glow surrounds the sun
# Fair-weather clouds: how high they float, waves in their outline, and how bright they are in a sky that they
# leave darker, as a camera shows it that is exposed for the ground.
CLOUDS_M, CLOUD_WAVES_M = 1100.0, {3100.0: 0.8, 1300.0: 0.6, 560.0: 0.35, 240.0: 0.2, 100.0: 0.12}
CLOUD, BETWEEN_CLOUDS = 0.72, 0.52
CLOUD_SEED, PER_ROW = 5, 128
LOWEST_CLOUD = 0.012  # sine of the elevation; lower ones are lost in the haze


def unit(vector: tuple[float, float, float] | np.ndarray) -> np.ndarray:
    return np.array(vector) / np.linalg.norm(vector)


def reached(
    groups: list[Surfaces], point_m: np.ndarray, normal: np.ndarray, towards: np.ndarray
) -> np.ndarray:
    """(n,) whether the light gets to a surface: it faces the light, and nothing is in between."""
    direction = towards.astype(np.float32)
    found = np.asarray(normal @ direction > 0)
    for group in groups:
        group.hide(found, point_m, normal, direction)
    return found


def sky_share(normal: np.ndarray) -> np.ndarray:
    """(n,) what reaches a surface from all sides, of what a surface turned upwards gets; the ground gives
    some of it back."""
    return np.float32(0.62) + np.float32(0.38) * normal[:, 2]


def irradiance(scene: Scene, normal: np.ndarray, sun: np.ndarray, above: np.ndarray) -> np.ndarray:
    """(n,) of a surface; sun, above: whether, or which share of, these lights reach it."""
    sunlight, from_above = (
        np.maximum(normal @ towards.astype(np.float32), 0) * share
        for towards, share in ((unit(scene.to_sun), sun), (ABOVE, above))
    )
    sky = FROM_ALL_SIDES * sky_share(normal) + FROM_ABOVE * from_above
    return (scene.sun_irradiance * sunlight + scene.fill_irradiance * sky).astype(np.float32)


def through_air(haze: Haze | None, radiance: np.ndarray, distance_m: np.ndarray) -> np.ndarray:
    if haze is None:
        return radiance
    clear = np.exp(-haze.extinction_per_m * distance_m)
    return radiance * clear + haze.airlight * (1 - clear)


def sky_radiance(scene: Scene, direction: np.ndarray) -> np.ndarray:
    """(n,) of the sky along unit vectors (n, 3)."""
    if scene.haze is not None:
        return np.full(len(direction), scene.haze.airlight, np.float32)
    if scene.sky == "overcast":
        return np.full(len(direction), scene.overcast_radiance, np.float32)
    up = np.sqrt(np.maximum(direction[:, 2], 0))
    glow = np.exp(SUN_GLOW * (direction @ unit(scene.to_sun) - 1))
    clear = HORIZON + (ZENITH - HORIZON) * up + AROUND_SUN * glow
    if scene.sky == "clouds":
        clear *= BETWEEN_CLOUDS
        dense = cloud(direction)
        clear += smoothstep(-0.02, 0.3, dense) * (CLOUD - 0.3 * np.clip(dense - 0.25, 0, 1) - clear)
    return clear.astype(np.float32)


def cloud(direction: np.ndarray) -> np.ndarray:
    """(n,) how dense the clouds are along unit vectors: more than 0 where there are any."""
    up = np.maximum(direction[:, 2], LOWEST_CLOUD)
    place_m = CLOUDS_M * direction[:, :2] / up[:, None]
    # OpenCV is slow with single columns.
    padded = np.pad(place_m, ((0, PER_ROW - len(place_m) % PER_ROW), (0, 0)))
    x_m, y_m = padded.T.reshape(2, -1, PER_ROW)
    dense = layered(x_m, y_m, CLOUD_WAVES_M, CLOUD_SEED).ravel()[: len(place_m)]
    return np.asarray(dense * smoothstep(LOWEST_CLOUD, 5 * LOWEST_CLOUD, direction[:, 2]))
