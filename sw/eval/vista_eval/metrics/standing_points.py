"""What becomes of the points that stand, on single real pairs whose disparities were measured otherwise.

All counts but one are of pixels inside the area that the shipped engine matches, with a true disparity among
its candidates: the same pixels, whatever is measured.

standing point  0.5 m or more above the road's plane, NEAR_M to FAR_M away (depth). The plane is fitted to
                the true points of the lower image: RANSAC, then least squares over its inliers
road point      within 0.15 m of that plane, at the same distances
recall          share of the standing points that lie in an accepted region whose valid words (2nd to 98th
                percentile, widened by 1.5 px) contain the point's true disparity
on surface      share of the standing points that are recalled, and within 1.5 px or 6 % of the plane that
                fits their region's words: a region that spans everything recalls all, but is no surface
engine          share of the standing points that themselves have a word within 3 px of the truth
wrong           share of the pixels of accepted regions with a word that differs from the truth by more than
                3 px and by more than 5 %
road            share of the road points that lie inside accepted regions
cylinder        recall of the standing points within 2 m of the optical axis
too near        recall of the points that would be standing points, had the shipped engine their disparities
verdict         by the verdict of the region that holds it, the share of the standing points

Intervals hold 95 %: bootstrap over pairs, because the points of one pair are not independent. Shares are of
the points of all pairs together.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from vista.engine import SCALE
from vista.geometry import Array, Calibration

from vista_eval.metrics.flight_path import CYLINDER_RADIUS_M

NEAR_M, FAR_M = 5.0, 45.0
STANDING_M, ROAD_M = 0.5, 0.15
BANDS_M = (5.0, 10.0, 20.0, 30.0, 45.0)
ENGINE_PX, WRONG_SHARE = 3.0, 0.05
PERCENTILES, WIDENED_PX = (2.0, 98.0), 1.5
SURFACE_PX, SURFACE_SHARE = 1.5, 0.06
ACCEPTED, NONE = "ACCEPTED", "NONE"  # NONE: the pixel belongs to no region

Mask = NDArray[np.bool_]


# ---- the road ----

ROAD_TRIALS, ROAD_REFINEMENTS, ROAD_POINTS = 500, 5, 20000
LEAST_ROAD_POINTS, STEEPEST_SLOPE = 200, 0.27  # the plane leans by 15 degrees at most
CAMERA_ABOVE_M = (0.5, 4.0)


@dataclass(frozen=True)
class RoadPlane:
    """y = slope_x x + slope_z z + height_m in the camera's frame (y points down)."""

    slope_x: float
    slope_z: float
    height_m: float

    def above_m(self, points_m: Array) -> Array:
        """Distance of (n, 3) points above the plane."""
        down = self.slope_x * points_m[:, 0] + self.slope_z * points_m[:, 2] + self.height_m - points_m[:, 1]
        return down / np.sqrt(1.0 + self.slope_x**2 + self.slope_z**2)


def fit_road(points_m: Array, seed: int = 0) -> RoadPlane | None:
    """The plane below the camera that most points lie on; None where hardly any do."""
    if len(points_m) < LEAST_ROAD_POINTS:
        return None
    random = np.random.default_rng(seed)
    if len(points_m) > ROAD_POINTS:
        points_m = points_m[random.choice(len(points_m), ROAD_POINTS, replace=False)]
    design = np.column_stack([points_m[:, 0], points_m[:, 2], np.ones(len(points_m))])
    y = points_m[:, 1]
    best, most = None, LEAST_ROAD_POINTS - 1
    for _ in range(ROAD_TRIALS):
        drawn = random.choice(len(y), 3, replace=False)
        try:
            plane = np.linalg.solve(design[drawn], y[drawn])
        except np.linalg.LinAlgError:
            continue
        if np.abs(plane[:2]).max() > STEEPEST_SLOPE or not CAMERA_ABOVE_M[0] < plane[2] < CAMERA_ABOVE_M[1]:
            continue
        inliers = int(np.count_nonzero(np.abs(design @ plane - y) < ROAD_M))
        if inliers > most:
            best, most = plane, inliers
    if best is None:
        return None
    for _ in range(ROAD_REFINEMENTS):
        near = np.abs(design @ best - y) < ROAD_M
        if np.count_nonzero(near) < 3:
            break
        best = np.linalg.lstsq(design[near], y[near], rcond=None)[0]
    return RoadPlane(*map(float, best))


# ---- points ----


@dataclass(frozen=True)
class Points:
    """Pixels of one pair with truth, one an entry."""

    v: NDArray[np.int64]
    u: NDArray[np.int64]
    disparity_px: Array
    band: NDArray[np.int64]  # of the names; -1: outside of all
    bands: tuple[str, ...]
    standing: Mask
    road: Mask
    cylinder: Mask  # of those that stand
    too_near: Mask  # nearer than the shipped engine matches; all others are not


def camera_points_m(
    camera: Calibration, v: NDArray[np.integer], u: NDArray[np.integer], disparity_px: Array
) -> Array:
    """(n, 3) in the camera's frame."""
    z = camera.focal_px * camera.baseline_m / disparity_px
    return (
        np.column_stack(
            [(u - camera.cx) / camera.focal_px, (v - camera.cy) / camera.focal_px, np.ones(len(z))]
        )
        * z[:, None]
    )


def road_of(camera: Calibration, disparity_px: NDArray[np.float32]) -> RoadPlane | None:
    v, u = np.nonzero(disparity_px > 0.0)
    all_m = camera_points_m(camera, v, u, disparity_px[v, u].astype(np.float64))
    in_reach = (all_m[:, 2] >= NEAR_M) & (all_m[:, 2] <= FAR_M)
    return fit_road(all_m[(v > camera.cy) & in_reach])


def standing_pixels(camera: Calibration, disparity_px: NDArray[np.float32]) -> Mask | None:
    """Pixels of the truth that stand on the road, whatever their distance; None where no road is found."""
    road = road_of(camera, disparity_px)
    if road is None:
        return None
    v, u = np.nonzero(disparity_px > 0.0)
    points_m = camera_points_m(camera, v, u, disparity_px[v, u].astype(np.float64))
    stands = np.zeros(disparity_px.shape, np.bool_)
    stands[v, u] = road.above_m(points_m) >= STANDING_M
    return stands


def true_pixels(
    disparity_px: NDArray[np.float32], area: tuple[slice, slice]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the pixels with truth within the area."""
    inside = np.zeros(disparity_px.shape, np.bool_)
    inside[area] = True
    v, u = np.nonzero(inside & (disparity_px > 0.0))
    return v, u


def band_names(bounds_m: tuple[float, ...]) -> tuple[str, ...]:
    return tuple(f"{a:g} to {b:g} m" for a, b in itertools.pairwise(bounds_m))


def street_points(
    camera: Calibration, disparity_px: NDArray[np.float32], area: tuple[slice, slice], largest_px: float
) -> Points | None:
    """Standing and road points; None where no road is found."""
    road = road_of(camera, disparity_px)
    if road is None:
        return None
    v, u = true_pixels(disparity_px, area)
    truth_px = disparity_px[v, u].astype(np.float64)
    points_m = camera_points_m(camera, v, u, truth_px)
    above_m, depth_m = road.above_m(points_m), points_m[:, 2]
    in_reach = (depth_m >= NEAR_M) & (depth_m <= FAR_M)
    too_near = truth_px > largest_px
    in_reach &= ~too_near
    standing = in_reach & (above_m >= STANDING_M)
    band = np.where(in_reach, np.searchsorted(BANDS_M, depth_m, side="right") - 1, -1)
    band[depth_m == FAR_M] = len(BANDS_M) - 2
    return Points(
        v,
        u,
        truth_px,
        band,
        band_names(BANDS_M),
        standing,
        in_reach & (np.abs(above_m) <= ROAD_M),
        standing & (np.hypot(points_m[:, 0], points_m[:, 1]) <= CYLINDER_RADIUS_M),
        too_near & (depth_m >= NEAR_M) & (above_m >= STANDING_M),
    )


# ---- one pair ----


@dataclass(frozen=True)
class Judged:
    """What a detector made of one pair."""

    words: NDArray[np.int16]
    region_of_pixel: NDArray[np.int32]  # -1: none
    verdict_of_region: list[str]


Counts = dict[str, int]


def word_ranges_px(words: NDArray[np.int16], region: NDArray[np.int32], regions: int) -> tuple[Array, Array]:
    """Lowest and highest disparity of each region's valid words, without the percentiles at either end and
    widened; an empty range where a region has none."""
    valid = (words >= 0) & (region >= 0)
    label, word = region[valid].astype(np.int64), words[valid].astype(np.int64)
    order = np.argsort(label * (1 << 16) + word, kind="stable")
    word, count = word[order], np.bincount(label, minlength=regions)
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    ends = []
    for percent, sign in zip(PERCENTILES, (-1.0, 1.0), strict=True):
        at = first + np.rint(percent / 100.0 * np.maximum(count - 1, 0)).astype(np.int64)
        end = (
            word[np.minimum(at, len(word) - 1)] / SCALE + sign * WIDENED_PX
            if len(word)
            else np.zeros(regions)
        )
        ends.append(np.where(count > 0, end, -sign * np.inf))
    return ends[0], ends[1]


FIT_SCALES_PX = (16.0, 8.0, 4.0, 2.0, 1.0, 1.0, 1.0)  # of Cauchy's weights, pass by pass
LEAST_FIT_WORDS = 6


def region_planes(words: NDArray[np.int16], region: NDArray[np.int32], regions: int) -> Array:
    """(regions, 3): disparity = a + b u + c v over each region's words, robustly; NaN where they are few."""
    v, u = np.nonzero((words >= 0) & (region >= 0))
    label, disparity_px = region[v, u], words[v, u] / SCALE
    count = np.bincount(label, minlength=regions)

    def sums(values: Array) -> Array:
        return np.bincount(label, values, minlength=regions).astype(np.float64, copy=False)

    middle_u, middle_v = (sums(x.astype(np.float64)) / np.maximum(count, 1) for x in (u, v))
    terms = np.stack([np.ones(len(u)), u - middle_u[label], v - middle_v[label]])
    weight, plane = np.ones(len(u)), np.zeros((regions, 3), np.float64)
    ridge = np.diag([1e-9, 1e-3, 1e-3])  # a region one pixel wide has no slope across
    for scale_px in FIT_SCALES_PX:
        normal = np.stack([[sums(weight * a * b) for a in terms] for b in terms]).transpose(2, 0, 1)
        right = np.stack([sums(weight * a * disparity_px) for a in terms], axis=-1)
        plane[:] = np.linalg.solve(normal + ridge, right[..., np.newaxis])[..., 0]
        residual_px = disparity_px - np.einsum("ki,ik->k", plane[label], terms)
        weight = 1.0 / (1.0 + (residual_px / scale_px) ** 2)
    plane[:, 0] -= plane[:, 1] * middle_u + plane[:, 2] * middle_v
    plane[count < LEAST_FIT_WORDS] = np.nan
    return plane


@dataclass(frozen=True)
class PointFates:
    """The fate of each point, one an entry."""

    verdict: NDArray[np.str_]
    accepted: Mask
    recalled: Mask  # accepted, at the disparity of its region
    on_surface: Mask  # recalled, near the plane of its region
    matched: Mask  # has a word of its own within ENGINE_PX
    valid: Mask  # has a word
    wrong: Mask  # has one that is wrong


def fates(points: Points, judged: Judged) -> PointFates:
    region = judged.region_of_pixel[points.v, points.u]
    word = judged.words[points.v, points.u]
    names = np.array([*judged.verdict_of_region, NONE])
    verdict = names[region]  # -1 is the last
    accepted = verdict == ACCEPTED
    regions = len(judged.verdict_of_region)
    low, high = word_ranges_px(judged.words, judged.region_of_pixel, regions)
    low, high = np.append(low, np.inf), np.append(high, -np.inf)
    truth_px = points.disparity_px
    recalled = accepted & (low[region] <= truth_px) & (truth_px <= high[region])
    plane = np.vstack([region_planes(judged.words, judged.region_of_pixel, regions), np.full(3, np.nan)])[
        region
    ]
    fitted_px = plane[:, 0] + plane[:, 1] * points.u + plane[:, 2] * points.v
    error_px = np.abs(word / SCALE - truth_px)
    valid = word >= 0
    return PointFates(
        verdict,
        accepted,
        recalled,
        recalled & (np.abs(fitted_px - truth_px) <= np.maximum(SURFACE_PX, SURFACE_SHARE * truth_px)),
        valid & (error_px <= ENGINE_PX),
        valid,
        valid & (error_px > ENGINE_PX) & (error_px > WRONG_SHARE * truth_px),
    )


def count_points(points: Points, judged: Judged) -> Counts:
    """Whole numbers that sum over pairs; shares are quotients of them."""
    fate, seen = fates(points, judged), ~points.too_near
    counts: Counts = {
        "too near": int(points.too_near.sum()),
        "too near recalled": int((points.too_near & fate.recalled).sum()),
    }
    for name, where in [("", np.ones(len(points.v), np.bool_))] + [
        (f" | {band}", points.band == k) for k, band in enumerate(points.bands)
    ]:
        standing = points.standing & where
        counts |= {
            f"standing{name}": int(standing.sum()),
            f"recalled{name}": int((standing & fate.recalled).sum()),
            f"on surface{name}": int((standing & fate.on_surface).sum()),
            f"matched{name}": int((standing & fate.matched).sum()),
            f"judged{name}": int((fate.accepted & fate.valid & seen & where).sum()),
            f"wrong{name}": int((fate.accepted & fate.wrong & seen & where).sum()),
            f"on road{name}": int((points.road & where).sum()),
            f"road accepted{name}": int((points.road & fate.accepted & where).sum()),
            f"in cylinder{name}": int((points.cylinder & where).sum()),
            f"cylinder recalled{name}": int((points.cylinder & fate.recalled & where).sum()),
        }
        found, numbers = np.unique(fate.verdict[standing], return_counts=True)
        counts |= {f"verdict {v}{name}": int(n) for v, n in zip(found, numbers, strict=True)}
    return counts


# ---- many pairs ----

MEASURES = {  # share: of which counts it is the quotient
    "recall": ("recalled", "standing"),
    "on surface": ("on surface", "standing"),
    "engine": ("matched", "standing"),
    "wrong": ("wrong", "judged"),
    "road": ("road accepted", "on road"),
    "cylinder": ("cylinder recalled", "in cylinder"),
}
TOO_NEAR = {"too near": ("too near recalled", "too near")}  # not by distance
VERDICT = "verdict "
RESAMPLES = 2000


@dataclass(frozen=True)
class Share:
    value: float  # NaN: there is nothing to be a share of
    low: float  # of the 95 % interval
    high: float


def shares(pairs: list[Counts], wanted: dict[str, tuple[str, str]], seed: int = 0) -> dict[str, Share]:
    """Name -> quotient of the sums of two counts; every draw of the bootstrap serves all of them."""
    names = sorted({name for both in wanted.values() for name in both})
    table = np.array([[counts.get(name, 0) for name in names] for counts in pairs], dtype=np.float64)
    random = np.random.default_rng(seed)
    drawn = random.multinomial(len(pairs), np.full(len(pairs), 1.0 / len(pairs)), RESAMPLES)
    total, resampled = table.sum(axis=0), drawn @ table
    result = {}
    for name, (part, whole) in wanted.items():
        i, j = names.index(part), names.index(whole)
        with np.errstate(invalid="ignore", divide="ignore"):
            value, values = total[i] / total[j], resampled[:, i] / resampled[:, j]
        values = values[np.isfinite(values)]
        low, high = np.percentile(values, [2.5, 97.5]) if len(values) else (np.nan, np.nan)
        result[name] = Share(float(value), float(low), float(high))
    return result


def verdict_names(pairs: list[Counts]) -> list[str]:
    """Names of all verdicts that any standing point met, the most frequent first."""
    total: dict[str, int] = {}
    for counts in pairs:
        for name, number in counts.items():
            if name.startswith(VERDICT) and " | " not in name:
                total[name] = total.get(name, 0) + number
    return [name.removeprefix(VERDICT) for name in sorted(total, key=lambda name: -total[name])]


def in_band(measures: dict[str, tuple[str, str]], band: str | None) -> dict[str, tuple[str, str]]:
    tail = "" if band is None else f" | {band}"
    return {name: (f"{a}{tail}", f"{b}{tail}") for name, (a, b) in measures.items()}


def verdict_measures(pairs: list[Counts]) -> dict[str, tuple[str, str]]:
    return {name: (VERDICT + name, "standing") for name in verdict_names(pairs)}
