"""Ground that rises: hillsides, ridges, valley sides, quarries, and country that leaves the path free.

Reliefs are functions of world x and y in metres. Those in the way pass through the path's point (0, 0,
altitude)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vista_eval.render.scene import Scene, Thing
from vista_eval.render.textures import noise, smoothstep
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import some_seed
from vista_eval.worlds.grounds import OPEN_COUNTRY
from vista_eval.worlds.landscape import HILLS_FOOT_X_M
from vista_eval.worlds.laying import Relief
from vista_eval.worlds.site import RURAL, Site, clutter, ridges, scene_of, site

SLOPE_DEG = (5.0, 40.0)
# A shallow slope is flown along so low that a gust would set the aircraft down.
OVER_SLOPE = Courses((6.0, 16.0), climb_deg=(-6.0, 0.0), most_bank_deg=12.0, most_gust=0.02)
ALONG_SLOPE = replace(OVER_SLOPE, most_bank_deg=0.0)
CLEAR_HEIGHT = Courses(altitude_m=(9.0, 20.0), climb_deg=(0.0, 3.0), most_bank_deg=0.0)
CORRIDOR_M = 12.0  # to either side of the path, for what shall stay below it


def rounded(height_m: np.ndarray, over_m: float) -> np.ndarray:
    """What is below 0 becomes 0, over a bend about `over_m` wide; high above nothing changes."""
    return over_m * np.logaddexp(0.0, height_m / over_m)


def bumps(x_m: np.ndarray, y_m: np.ndarray, seed: int) -> np.ndarray:
    """Small relief, in -0.5..0.5."""
    return 0.7 * noise(x_m, y_m, 24.0, seed) + 0.3 * noise(x_m, y_m, 9.0, seed + 1)


def through_the_path(relief: Relief, altitude_m: float) -> Relief:
    """Raised or lowered so that it meets the path at (0, 0, altitude)."""
    origin = np.zeros((1, 1))
    by_m = altitude_m - float(relief(origin, origin)[0, 0])
    return lambda x, y: relief(x, y) + by_m


def ramp(site: Site, slope_deg: float, azimuth_deg: float, top_m: float) -> Relief:
    """Level, then up at the slope towards `azimuth_deg` from +x to +y, then level `top_m` above the path."""
    seed = some_seed(site.draws("ramp"))
    rise, turn = np.tan(np.radians(slope_deg)), np.radians(azimuth_deg)

    def plane(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        along = np.cos(turn) * x_m + np.sin(turn) * y_m
        return site.altitude_m + rise * (along + min(6.0, 2.0 / rise) * bumps(x_m, y_m, seed))

    def shape(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        up = rounded(plane(x_m, y_m), 0.8)
        ceiling = site.altitude_m + top_m
        return ceiling - rounded(ceiling - up, 1.5)

    return through_the_path(shape, site.altitude_m)


def on_slopes(here: Site) -> list[Thing]:
    foot_m = here.ground_m(HILLS_FOOT_X_M, 0.0) - 2.0
    return [*clutter(here, RURAL, 10), *ridges(here.altitude_m, here.seed, foot_m)]


def risen(here: Site, relief: Relief) -> Scene:
    """The ground is what stands in the way."""
    there = replace(here, relief=relief)
    return scene_of(there, (), on_slopes(there), meets_ground=True)


def hillside(altitude_m: float, seed: int) -> Scene:
    """A slope of 5 to 40 degrees, up to 25 degrees askew."""
    here = site(altitude_m, seed, OVER_SLOPE, OPEN_COUNTRY)
    rng = here.draws("hillside")
    slope, azimuth = rng.uniform(*SLOPE_DEG), rng.uniform(-25, 25)
    return risen(here, ramp(here, slope, azimuth, rng.uniform(6, 60)))


def valley_side(altitude_m: float, seed: int) -> Scene:
    """A slope of 12 to 40 degrees, met 35 to 60 degrees askew."""
    here = site(altitude_m, seed, ALONG_SLOPE, OPEN_COUNTRY)
    rng = here.draws("valley side")
    azimuth = rng.choice([-1, 1]) * rng.uniform(35, 60)
    return risen(here, ramp(here, rng.uniform(12, 40), azimuth, rng.uniform(20, 70)))


def ridge(altitude_m: float, seed: int) -> Scene:
    """A ridge up at 10 to 40 degrees to a crest 1 to 10 m above the path, and down behind."""
    here = site(altitude_m, seed, OVER_SLOPE, OPEN_COUNTRY)
    rng = here.draws("ridge")
    rise, over_m, askew = np.tan(np.radians(rng.uniform(10, 40))), rng.uniform(1, 10), rng.uniform(-0.4, 0.4)
    wave_seed, crest_x_m = some_seed(rng), over_m / rise

    def shape(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        along = x_m + askew * y_m - crest_x_m
        bent = 2.0 * bumps(x_m, y_m, wave_seed)
        return rounded(altitude_m + over_m + bent - rise * rounded(np.abs(along), 1.0), 0.8)

    return risen(here, through_the_path(shape, altitude_m))


def quarry(altitude_m: float, seed: int) -> Scene:
    """A face of 55 to 78 degrees, in one to three steps, 4 to 25 m higher than the path."""
    here = site(altitude_m, seed, OVER_SLOPE, ("scree", "gravel", "heath"))
    rng = here.draws("quarry")
    rise, askew = np.tan(np.radians(rng.uniform(55, 78))), rng.uniform(-0.1, 0.1)
    top_m, steps, wave_seed = altitude_m + rng.uniform(4, 25), int(rng.integers(1, 4)), some_seed(rng)
    bench_m = rng.uniform(2.0, 7.0)
    step_m = top_m / steps
    # The path meets a face and not a bench.
    first_x_m = -(altitude_m // step_m) * (step_m / rise + bench_m) - (altitude_m % step_m) / rise

    def shape(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        along = x_m + askew * y_m - first_x_m + 2.5 * bumps(x_m, y_m, wave_seed)
        faces = [along - k * (step_m / rise + bench_m) for k in range(steps)]
        steps_up = [step_m * smoothstep(0.0, 1.6 * step_m / rise, face) for face in faces]
        return np.sum(steps_up, axis=0)

    return risen(here, through_the_path(shape, altitude_m))


def below_the_path(relief: Relief, here: Site, clearance_m: float) -> Relief:
    """Lowered or raised so that it stays `clearance_m` below the path's corridor."""
    x = np.arange(here.path.points_m[0, 0], here.path.points_m[-1, 0] + 10, 2.0)[:, None]
    y = np.arange(-CORRIDOR_M, CORRIDOR_M + 1, 2.0)[None, :]
    by_m = here.altitude_m - clearance_m - float(relief(x, y).max())
    return lambda x, y: relief(x, y) + by_m


def left_free(here: Site, relief: Relief) -> Scene:
    """Nothing is met: below the path the ground stays 0.5 to 3 m under what has to be clear."""
    clear_m = float(here.path.clear_m[-1]) + float(here.draws("clearance").uniform(0.5, 3.0))
    lower = below_the_path(relief, here, clear_m)
    there = replace(here, relief=lower)
    return scene_of(there, (), on_slopes(there), meets_at_m=None)


def clear_rolling(altitude_m: float, seed: int) -> Scene:
    """Waves of 40 to 120 m and up to 6 m, none as high as the path."""
    here = site(altitude_m, seed, CLEAR_HEIGHT, OPEN_COUNTRY)
    rng = here.draws("rolling")
    long_m, high_m, wave_seed = rng.uniform(40, 120), rng.uniform(1.5, 6.0), some_seed(rng)
    return left_free(
        here, lambda x, y: high_m * noise(x, y, long_m / 2, wave_seed) + 0.5 * bumps(x, y, wave_seed + 2)
    )


def clear_crest(altitude_m: float, seed: int) -> Scene:
    """A slope of 8 to 35 degrees straight ahead, whose top lies below the path."""
    here = site(altitude_m, seed, CLEAR_HEIGHT, OPEN_COUNTRY)
    rng = here.draws("crest")
    low = replace(here, altitude_m=float(rng.uniform(3.0, 0.6 * altitude_m)))
    return left_free(here, ramp(low, rng.uniform(8, 35), rng.uniform(-30, 30), rng.uniform(0.2, 2.0)))


def clear_valley(altitude_m: float, seed: int) -> Scene:
    """A flight along a valley whose sides rise at 15 to 40 degrees far above the path."""
    here = site(altitude_m, seed, CLEAR_HEIGHT, OPEN_COUNTRY)
    rng = here.draws("valley")
    rises, wave_seed = np.tan(np.radians(rng.uniform(15, 40, 2))), some_seed(rng)
    floor_m = CORRIDOR_M + rng.uniform(1, 14, 2)

    def shape(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
        sides = zip(rises, floor_m, (1, -1), strict=True)
        left, right = (rise * rounded(side * y_m - wide, 1.0) for rise, wide, side in sides)
        return np.minimum(left + right, 60.0) + bumps(x_m, y_m, wave_seed)

    return left_free(here, shape)
