"""The turn of the right camera is found from the rows of features, and followed when it is sudden. Beyond the
limits there is an alarm; where there is too little to see, nothing changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import turned_camera as turned
from random_seed import seeded
from stage_library import ffi, lib
from turned_camera import Corrected, Estimator, Grey, degrees
from vista import parameters
from vista.alignment import State, Turn
from vista.geometry import Calibration
from vista.health.finding import State as Health

pytestmark = pytest.mark.slow

CAMERA = Calibration(640, 480, 500.0, 319.5, 239.5, 0.3)
BEFORE, AFTER = 10, 36  # frames: 1.4 s after the turn
JUMPS = [(0.5, -0.5), (-0.5, 0.5)]


def run(turn: Turn, change=None, frames: int = BEFORE + AFTER, scene=None) -> list[Corrected]:
    """The turn comes suddenly after BEFORE frames. scene: what is there, in place of the flight; change: what
    becomes of the images."""
    flight = turned.textured_flight(CAMERA, seeded(1))

    def pairs(k: int) -> tuple[Grey, Grey]:
        return flight(k) if scene is None else scene(k, *flight(k))

    def turn_at(k: int) -> Turn:
        return turn if k >= BEFORE else Turn()

    return list(turned.corrected(CAMERA, pairs, turn_at, frames, change=change))


def noisy(sigma: float):
    random = seeded(2)

    def change(_: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
        return tuple(
            np.clip(np.rint(image + random.normal(0.0, sigma, image.shape)), 0, 255).astype(np.uint8)
            for image in (left, right)
        )

    return change


def assert_rows_match(frame: Corrected, turn: Turn, median_px: float = 0.2) -> None:
    off_px = turned.rows_left_px(CAMERA, turn, frame.applied)
    assert np.median(off_px) < median_px, (frame.applied, np.median(off_px))
    assert np.percentile(off_px, 90) < 2 * median_px


# ---- a turn that can be corrected ----


@pytest.mark.same_c
@pytest.mark.parametrize(("pitch", "roll"), JUMPS)
def test_rows_match_again_soon_after_a_sudden_turn(pitch: float, roll: float) -> None:
    turn = degrees(pitch, roll)
    frames = run(turn)
    assert np.median(turned.rows_left_px(CAMERA, turn, frames[BEFORE].applied)) > 1.0
    for frame in frames[BEFORE + 12 :]:  # 0.5 s
        assert_rows_match(frame, turn)
        assert frame.alignment.state == State.MEASURED
        assert frame.alignment.row_error_px < 0.2
        assert frame.alignment.health == Health.HEALTHY
    assert all(frame.alignment.health == Health.HEALTHY for frame in frames[:BEFORE])
    row_error_px = frames[BEFORE].alignment.row_error_px
    assert row_error_px is not None and row_error_px > 1.0
    assert frames[BEFORE].alignment.health == (Health.BLIND if row_error_px > 2.0 else Health.DEGRADED)


@pytest.mark.same_c
@pytest.mark.parametrize(("pitch", "roll"), [(0.5, 0.0), (0.0, 0.5)])
def test_noise_of_six_grey_levels_does_not_matter(pitch: float, roll: float) -> None:
    turn = degrees(pitch, roll)
    for frame in run(turn, noisy(6.0))[BEFORE + 25 :]:
        assert_rows_match(frame, turn)


@pytest.mark.same_c
def test_a_second_turn_the_other_way_is_followed_too() -> None:
    pairs = turned.textured_flight(CAMERA, seeded(3))
    turns = [Turn()] * 10 + [degrees(0.4, 0.3)] * 15 + [degrees(-0.3, -0.2)] * 15
    frames = list(turned.corrected(CAMERA, pairs, turns.__getitem__, len(turns)))
    for k in (24, 39):
        assert_rows_match(frames[k], turns[k])


@pytest.mark.same_c
def test_a_slow_drift_is_followed() -> None:
    """0.1 degrees in 8 s: the correction follows in steps."""
    pairs = turned.textured_flight(CAMERA, seeded(4))
    frames = list(turned.corrected(CAMERA, pairs, lambda k: degrees(0.0005 * k, 0.0), 200))
    for k, frame in enumerate(frames):
        assert_rows_match(frame, degrees(0.0005 * k, 0.0), 0.35)
    assert any(frame.alignment.changed for frame in frames)


@pytest.mark.same_c
def test_a_good_calibration_is_left_as_it_is() -> None:
    for frame in run(degrees(0.005, -0.005)):
        assert frame.applied == Turn()
        assert frame.alignment.state == State.MEASURED


def test_the_estimate_is_that_of_the_turn_from_any_correction() -> None:
    """What was applied may be anything: the estimate is of the whole turn."""
    pairs, turn, applied = turned.textured_flight(CAMERA, seeded(5)), degrees(0.3, 0.2), degrees(0.25, 0.25)
    estimator = Estimator(CAMERA)
    for k in range(8):
        left, right = pairs(k)
        right = turned.seen(right, CAMERA, turn, applied)
        found = estimator.update(left, right, 1 + 40_000_000 * k, applied)
    assert found.estimate.pitch_deg == pytest.approx(0.3, abs=0.01)
    assert found.estimate.roll_deg == pytest.approx(0.2, abs=0.02)


# ---- what cannot be corrected ----


@pytest.mark.same_c
@pytest.mark.parametrize(("pitch", "roll"), [(0.0, 3.0), (-3.0, 3.0), (1.3, 0.0), (0.0, -1.4)])
def test_a_turn_beyond_the_limits_raises_the_alarm(pitch: float, roll: float) -> None:
    frames = run(degrees(pitch, roll))
    assert frames[BEFORE - 1].alignment.health == Health.HEALTHY
    for frame in frames[BEFORE + 30 :]:
        assert frame.alignment.state in (State.BEYOND, State.LOST)
        assert frame.alignment.health == Health.BLIND
        assert frame.applied == Turn()  # what cannot be corrected is not corrected halfway


@pytest.mark.same_c
def test_the_alarm_ends_when_the_camera_is_back() -> None:
    pairs = turned.textured_flight(CAMERA, seeded(6))
    frames = list(
        turned.corrected(CAMERA, pairs, lambda k: degrees(3.0, 0.0) if 10 <= k < 40 else Turn(), 50)
    )
    assert frames[39].alignment.health == Health.BLIND
    assert frames[49].alignment.health == Health.HEALTHY


@pytest.mark.same_c
def test_a_pair_that_agrees_by_chance_does_not_end_the_alarm() -> None:
    pairs = turned.textured_flight(CAMERA, seeded(15))
    frames = list(
        turned.corrected(
            CAMERA, pairs, lambda k: degrees(3.0, 0.0) if k >= 10 and k not in (40, 44) else Turn(), 48
        )
    )
    assert frames[40].alignment.agreeing > 0
    assert frames[40].alignment.health == Health.DEGRADED  # its rows are right, but who knows of the next
    assert {frame.alignment.state for frame in frames[39:]} == {State.LOST}


@pytest.mark.same_c
def test_the_limits_are_those_of_the_parameters() -> None:
    values = parameters.defaults()
    values["alignment"] = values["alignment"] | {"pitch_max_deg": 0.3}
    pairs = turned.textured_flight(CAMERA, seeded(7))
    frames = list(turned.corrected(CAMERA, pairs, lambda _: degrees(0.4, 0.0), 12, values))
    assert frames[-1].alignment.state == State.BEYOND
    values["alignment"]["pitch_max_deg"] = 0.5
    frames = list(turned.corrected(CAMERA, pairs, lambda _: degrees(0.4, 0.0), 12, values))
    assert_rows_match(frames[-1], degrees(0.4, 0.0))


# ---- too little to see ----


def flat(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
    """A sky without a feature."""
    return np.full_like(left, 200 - k % 3), np.full_like(right, 198 - k % 3)


def stripes(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
    """Edges that lie slightly off the rows, and nothing else."""
    v, u = np.indices(left.shape)
    return tuple(
        np.where((v - 0.05 * (u + shift)) // 12 % 2, 190, 60).astype(np.uint8)
        for shift in (5 * k, 5 * k + 20)
    )


def tiles(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
    """A facade that repeats itself every 16 px in both directions, seen 20 px apart."""
    v, u = np.indices(left.shape)
    return tuple(
        (128 + 60 * np.sin(2 * np.pi * (u + shift) / 16) * np.sin(2 * np.pi * v / 16)).astype(np.uint8)
        for shift in (3 * k, 3 * k + 20)
    )


def unrelated_noise(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
    """Only what the sensors add: a night."""
    random = seeded(1000 + k)
    return tuple(
        np.clip(np.rint(random.normal(40.0, 8.0, left.shape)), 0, 255).astype(np.uint8) for _ in "lr"
    )


SEEN = {"scene": (stripes, tiles), "change": (flat, unrelated_noise)}


@pytest.mark.same_c
@pytest.mark.parametrize(
    ("where", "nothing"), [(where, nothing) for where, all_of in SEEN.items() for nothing in all_of]
)
def test_nothing_changes_where_there_is_too_little_to_see(where: str, nothing) -> None:
    """Neither without any correction, nor with one that was found before."""
    frames = run(Turn(), frames=30, **{where: nothing})
    assert {frame.applied for frame in frames} == {Turn()}
    assert {frame.alignment.state for frame in frames} == {State.HELD}

    def later(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
        return nothing(k, left, right) if k >= 30 else (left, right)

    frames = run(degrees(0.5, 0.5), frames=70, **{where: later})
    kept = frames[30].applied
    assert_rows_match(frames[30], degrees(0.5, 0.5))
    assert {frame.applied for frame in frames[30:]} == {kept}
    assert {frame.alignment.health for frame in frames[25:]} == {Health.HEALTHY}


@pytest.mark.same_c
def test_noise_on_plain_images_changes_nothing() -> None:
    def change(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
        return noisy(6.0)(k, *flat(k, left, right))

    assert {frame.alignment.state for frame in run(Turn(), change, 30)} == {State.HELD}


# ---- faults of the cameras ----


@pytest.mark.same_c
def test_a_camera_that_hangs_turns_nothing() -> None:
    """The left one moves on, also up and down; the right one delivers one image again and again."""
    pairs = turned.textured_flight(CAMERA, seeded(8))
    frozen = pairs(20)[1]

    def change(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
        return (np.roll(left, k % 7, axis=0), frozen) if k >= 20 else (left, right)

    frames = list(turned.corrected(CAMERA, pairs, lambda _: Turn(), 60, change=change))
    assert {frame.applied for frame in frames} == {Turn()}
    assert {frame.alignment.state for frame in frames[21:]} == {State.HELD}


@pytest.mark.same_c
def test_frames_that_drop_out_change_nothing() -> None:
    """Black images of either camera, and pairs of two moments, up to 3 in a row."""
    pairs = turned.textured_flight(CAMERA, seeded(9))

    def change(k: int, left: Grey, right: Grey) -> tuple[Grey, Grey]:
        if 20 <= k < 23:
            return np.zeros_like(left), right
        if 30 <= k < 33:
            return left, np.zeros_like(right)
        if 40 <= k < 43:
            return left, np.roll(right, 5, axis=0)
        return left, right

    frames = list(turned.corrected(CAMERA, pairs, lambda _: Turn(), 60, change=change))
    assert {frame.applied for frame in frames} == {Turn()}
    blind = [k for k, frame in enumerate(frames) if frame.alignment.health != Health.HEALTHY]
    assert blind == [40, 41, 42]  # whose rows are 5 px off
    assert frames[-1].alignment.state == State.MEASURED


# ---- the fit ----


def fit(rows: np.ndarray):
    """rows: (count, 4) u, v in the right image, row error and its sigma, px."""
    matches = ffi.new("vista_row_match[]", [tuple(map(float, row)) for row in rows])
    camera = ffi.new("vista_camera *", (640, 480, 500.0, 319.5, 239.5, 0.3))
    return lib.vista_row_fit_make(camera, matches, len(rows))


def rows_of(random: np.random.Generator, count: int, pitch_rad: float, roll_rad: float, sigma_px: float):
    u, v = random.uniform(0, 640, count), random.uniform(0, 480, count)
    y = (v - 239.5) / 500.0
    errors = 500.0 * pitch_rad * (1.0 + y * y) - roll_rad * (u - 319.5) + random.normal(0.0, sigma_px, count)
    return np.column_stack([u, v, errors, np.full(count, sigma_px)])


def test_the_fit_finds_a_known_turn_among_outliers() -> None:
    random = seeded(10)
    for _ in range(50):
        pitch, roll = random.uniform(-0.017, 0.017, 2)
        rows = rows_of(random, 100, pitch, roll, 0.1)
        rows[:35, 2] = random.uniform(-20.0, 20.0, 35)
        found = fit(rows)
        assert found.agreed and 60 <= found.agreeing <= 75
        assert found.turn.pitch_rad == pytest.approx(pitch, abs=1.5e-4)  # 0.08 px
        assert found.turn.roll_rad == pytest.approx(roll, abs=5e-4)


def test_features_that_do_not_agree_make_no_fit() -> None:
    random = seeded(11)
    for count in (0, 1, 15, 40, 128):
        rows = rows_of(random, count, 0.0, 0.0, 0.1)
        rows[:, 2] = random.uniform(-20.0, 20.0, count)
        assert not fit(rows).agreed


def test_the_covariance_says_how_well_the_turn_is_known() -> None:
    random = seeded(12)
    found = [fit(rows_of(random, 60, 0.005, -0.005, 0.3)) for _ in range(200)]
    for value, truth, variance in (("pitch_rad", 0.005, "pp"), ("roll_rad", -0.005, "rr")):
        errors = np.array([getattr(one.turn, value) - truth for one in found])
        stated = np.sqrt([getattr(one.covariance, variance) for one in found])
        assert 0.5 < np.std(errors / stated) < 1.3


# ---- what is refused ----


def test_bad_input_is_refused_and_changes_nothing() -> None:
    estimator, (left, right) = Estimator(CAMERA), turned.textured_flight(CAMERA, seeded(13))(0)
    assert estimator.update(left, right, 100, Turn()).state == State.MEASURED
    with pytest.raises(ValueError, match="size"):
        estimator.update(left[:-1], right[:-1], 200, Turn())
    with pytest.raises(ValueError, match="increase"):
        estimator.update(left, right, 100, Turn())
    with pytest.raises(ValueError, match=r"NaN|number|finite"):
        estimator.update(left, right, 200, Turn(float("nan"), 0.0))
    with pytest.raises(ValueError, match="size"):
        Estimator(replace(CAMERA, width=63, cx=31.0))
    estimator.reset()
    assert estimator.update(left, right, 100, Turn()).state == State.MEASURED


@pytest.mark.parametrize("size", [(64, 64), (65, 81), (320, 240), (1001, 333)])
def test_images_of_any_size(size: tuple[int, int]) -> None:
    camera = replace(CAMERA, width=size[0], height=size[1], cx=size[0] / 2, cy=size[1] / 2)
    pairs = turned.textured_flight(camera, seeded(14))
    for frame in turned.corrected(camera, pairs, lambda _: degrees(0.2, 0.0), 12):
        assert frame.alignment.features > 0
