"""Measures of what stands, on points and regions drawn by hand, with the shares worked out on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from vista.geometry import Calibration
from vista_eval.metrics import standing_points as standing
from vista_eval.metrics.standing_points import Judged, Points

CAMERA = Calibration(400, 200, 400.0, 200.0, 80.0, 0.5)  # f B = 200 px m
HEIGHT_M = 1.6
WHOLE = (slice(None), slice(None))


def road_disparity_px(slope_z: float = 0.0) -> np.ndarray:
    """The disparity of the plane y = 1.6 + slope_z z, wherever it is seen."""
    v = np.arange(CAMERA.height)[:, None] + np.zeros((1, CAMERA.width))
    inverse_depth = ((v - CAMERA.cy) / CAMERA.focal_px - slope_z) / HEIGHT_M
    disparity_px = CAMERA.focal_px * CAMERA.baseline_m * inverse_depth
    return np.where(disparity_px > 2.0, disparity_px, 0.0).astype(np.float32)


def with_board(disparity_px: np.ndarray, depth_m: float = 10.0) -> np.ndarray:
    """Columns 180 to 219: a board from the ground at that depth up to 2.4 m above it."""
    foot_v, top_v = (int(CAMERA.cy + CAMERA.focal_px * y / depth_m) for y in (HEIGHT_M, HEIGHT_M - 2.4))
    disparity_px = disparity_px.copy()
    disparity_px[top_v:foot_v, 180:220] = 200.0 / depth_m
    return disparity_px


def test_a_road_is_found_below_and_beside_what_stands_on_it() -> None:
    disparity_px = with_board(road_disparity_px(slope_z=0.02))
    random = np.random.default_rng(1)
    noisy = np.where(disparity_px > 0, disparity_px + random.normal(0.0, 0.05, disparity_px.shape), 0.0)
    v, u = np.nonzero(noisy > 0)
    points_m = standing.camera_points_m(CAMERA, v, u, noisy[v, u])
    near = (points_m[:, 2] > 5) & (points_m[:, 2] < 45)
    road = standing.fit_road(points_m[near])
    assert road is not None
    assert (road.slope_x, road.slope_z) == pytest.approx((0.0, 0.02), abs=2e-3)
    assert road.height_m == pytest.approx(HEIGHT_M, abs=0.02)
    assert standing.fit_road(points_m[near]) == road  # the seed is fixed


def test_a_wall_alone_has_no_road() -> None:
    random = np.random.default_rng(0)
    wall_m = np.column_stack(
        [random.uniform(-5, 5, 4000), random.uniform(-3, 1.5, 4000), random.normal(12.0, 0.01, 4000)]
    )
    assert standing.fit_road(wall_m) is None
    assert standing.fit_road(wall_m[:10]) is None


def test_points_stand_half_a_metre_above_the_road_and_upward() -> None:
    points = standing.street_points(CAMERA, with_board(road_disparity_px()), WHOLE, largest_px=63.0)
    assert points is not None
    on_board = (points.u >= 180) & (points.u < 220) & (points.disparity_px == 20.0)
    # At 10 m a pixel is 25 mm: 1.6 m above the road is row 80, 0.5 m is row 124, on the limit.
    assert set(points.v[points.standing]) == set(range(48, 124))
    assert np.count_nonzero(points.standing) == 76 * 40
    assert not np.any(points.standing & ~on_board)
    assert [points.bands[k] for k in np.unique(points.band[points.standing])] == ["10 to 20 m"]
    assert np.all(points.road[~on_board & (points.band >= 0)])
    # Within 2 m of the axis at 10 m: 80 px; the board is 1 m wide and at most 1.1 m below it, 0.8 m above.
    assert np.array_equal(points.cylinder, points.standing)


def test_only_what_the_shipped_engine_can_match_counts() -> None:
    near = standing.street_points(CAMERA, with_board(road_disparity_px()), WHOLE, largest_px=19.0)
    assert near is not None
    assert not near.standing.any()
    assert np.count_nonzero(near.too_near) == 76 * 40
    right = (slice(None), slice(200, None))
    half = standing.street_points(CAMERA, with_board(road_disparity_px()), right, largest_px=63.0)
    assert half is not None
    assert np.count_nonzero(half.standing) == 76 * 20


def row_of_points(disparity_px: list[float], **masks: list[bool]) -> Points:
    """One pixel a point, in one row; all stand unless said otherwise."""
    n = len(disparity_px)
    of = {"standing": [True] * n, "road": [False] * n, "cylinder": [False] * n, "too_near": [False] * n}
    chosen = {name: np.array(mask) for name, mask in (of | masks).items()}
    return Points(
        np.zeros(n, np.int64),
        np.arange(n),
        np.array(disparity_px),
        np.zeros(n, np.int64),
        ("near",),
        **chosen,
    )


def judged(words_px: list[float], region: list[int], verdicts: list[str]) -> Judged:
    """A negative disparity: no word."""
    words = np.array([[-16 if d < 0 else round(16 * d) for d in words_px]], np.int16)
    return Judged(words, np.array([region], np.int32), verdicts)


def test_the_fate_of_each_point() -> None:
    points = row_of_points(
        [20.0, 22.0, 26.0, 20.0, 20.0, 20.0, 20.0],
        standing=[True, True, True, True, True, True, False],
        road=[False] * 6 + [True],
        cylinder=[True, False, True, False, False, False, False],
    )
    made = judged(
        [20.0, 21.0, 21.0, -1.0, 30.0, -1.0, 20.0],
        [0, 0, 0, 0, 1, -1, 0],
        ["ACCEPTED", "INCONSISTENT"],
    )
    counts = standing.count_points(points, made)
    # Region 0 has words of 20 to 21 px: it holds 18.5 to 22.5, so not the 26 at its third pixel.
    assert counts["standing"] == 6 and counts["recalled"] == 3
    assert counts["matched"] == 2  # 20 at 20, 21 at 22; 21 is 5 px from 26, and 30 is 10 px from 20
    assert counts["judged"] == 4 and counts["wrong"] == 1  # the third pixel
    assert counts["on road"] == 1 and counts["road accepted"] == 1
    assert counts["in cylinder"] == 2 and counts["cylinder recalled"] == 1
    verdicts = {k: n for k, n in counts.items() if k.startswith("verdict ") and " | " not in k}
    assert verdicts == {"verdict ACCEPTED": 4, "verdict INCONSISTENT": 1, "verdict NONE": 1}
    assert counts["recalled | near"] == 3


def test_an_accepted_region_without_words_recalls_nothing() -> None:
    counts = standing.count_points(row_of_points([20.0]), judged([-1.0], [0], ["ACCEPTED"]))
    assert (counts["verdict ACCEPTED"], counts["recalled"], counts["judged"]) == (1, 0, 0)


def test_stray_words_do_not_widen_a_region() -> None:
    """One word of 100 is beyond the 98th percentile."""
    words = [20.0] * 99 + [60.0]
    counts = standing.count_points(row_of_points([60.0] * 100), judged(words, [0] * 100, ["ACCEPTED"]))
    assert counts["recalled"] == 0


def test_small_errors_of_near_things_are_not_wrong() -> None:
    """3.5 px is more than 3 px, but less than 5 % of 100 px."""
    counts = standing.count_points(row_of_points([100.0, 40.0]), judged([103.5, 43.5], [0, 0], ["ACCEPTED"]))
    assert (counts["judged"], counts["wrong"]) == (2, 1)


def test_shares_are_of_the_points_of_all_pairs() -> None:
    pairs = [{"recalled": 90, "standing": 100}, {"recalled": 0, "standing": 100}, {"standing": 100}]
    found = standing.shares(pairs, standing.MEASURES | {"same": ("standing", "standing")})
    assert found["recall"].value == pytest.approx(0.3)
    assert found["recall"].low == 0.0 and 0.6 <= found["recall"].high <= 0.9
    assert (found["same"].low, found["same"].high) == (1.0, 1.0)
    assert math.isnan(found["road"].value)
    assert found["recall"] == standing.shares(pairs, standing.MEASURES)["recall"]  # drawn from the same seed


def test_a_region_that_spans_two_surfaces_recalls_both_but_is_neither() -> None:
    """Left half at 20 px, right half at 30: the words of the whole hold both; each half is a surface."""
    words_px = [20.0] * 60 + [30.0] * 60
    points = row_of_points(words_px)
    one = standing.count_points(points, judged(words_px, [0] * 120, ["ACCEPTED"]))
    assert one["recalled"] == 120 and one["on surface"] < 60
    two = standing.count_points(points, judged(words_px, [0] * 60 + [1] * 60, ["ACCEPTED"] * 2))
    assert two["recalled"] == two["on surface"] == 120


def test_the_plane_of_a_region_ignores_false_words() -> None:
    random = np.random.default_rng(0)
    v, u = np.mgrid[:30, :40]
    disparity_px = 20.0 + 0.2 * u - 0.1 * v
    words = np.rint(16 * disparity_px).astype(np.int16)
    false = random.random(words.shape) < 0.15
    words[false] = random.integers(0, 1000, np.count_nonzero(false))
    region = np.zeros(words.shape, np.int32)
    region[:, -1] = 1
    words[5:, -1] = -16
    planes = standing.region_planes(words, region, 2)
    assert planes[0] == pytest.approx((20.0, 0.2, -0.1), abs=0.1)
    assert np.isnan(planes[1]).all()  # five words are too few
