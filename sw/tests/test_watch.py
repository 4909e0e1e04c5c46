"""The watch of the detector: faults of cameras, engines, poses and clocks are named within three frames, by
what is seen against what was seen before, and what has no fault is not.

The scene is two walls with texture, side by side at two distances, towards which the cameras fly."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from random_seed import seeded
from vista import parameters
from vista.chain import engine_parameters
from vista.detector import Detector
from vista.engine import create_engine
from vista.geometry import Calibration, Pose, rectified_rig
from vista.health.finding import Reason
from vista.rectify import Rectifier

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 480.0, 0.5
WALLS_M = (16.0, 30.0)  # left and right of the middle
STEP_M, PERIOD_NS = 0.7, 100_000_000
FRAMES, ONSET, END = 14, 5, 9
CAMERA = Calibration(WIDTH, HEIGHT, FOCAL_PX, (WIDTH - 1) / 2, (HEIGHT - 1) / 2, BASELINE_M)
UP = np.array([0.0, -1.0, 0.0])
TEXTURE_PX = 30.0  # of a metre of the walls

Images = tuple[NDArray[np.uint8], NDArray[np.uint8]]
Words = list[NDArray[np.int16]]


@dataclass(frozen=True)
class Given:
    images: Images
    t_ns: int
    pose: Pose | None
    words: Words | None = None  # None: those that the engine in C gives


@cache
def texture(number: int) -> NDArray[np.float32]:
    noise = seeded(10 + number).normal(size=(1400, 2000)).astype(np.float32)
    coarse = cv2.GaussianBlur(noise, (0, 0), 3.0)
    fine = cv2.GaussianBlur(noise[::-1], (0, 0), 1.2)
    return 110.0 + 30.0 * coarse / coarse.std() + 15.0 * fine / fine.std()


def seen(along_m: float, right_m: float, frame: int) -> NDArray[np.uint8]:
    """What a camera at this place sees, with the noise of a sensor."""
    v, u = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
    image = np.full((HEIGHT, WIDTH), 110.0, np.float32)  # what is seen between the walls
    for wall, wall_m in enumerate(WALLS_M):
        scale = np.float32((wall_m - along_m) / FOCAL_PX)
        x_m, y_m = (u - (WIDTH - 1) / 2) * scale + np.float32(right_m), (v - (HEIGHT - 1) / 2) * scale
        drawn = cv2.remap(texture(wall), 1000 + TEXTURE_PX * x_m, 700 + TEXTURE_PX * y_m, cv2.INTER_LINEAR)
        here = x_m < 0.0 if wall == 0 else x_m >= 0.0
        image[here] = drawn[here]
    noise = seeded(1000 + 2 * frame + (right_m > 0.0)).normal(0.0, 1.0, image.shape)
    return np.clip(np.rint(image + noise), 0, 255).astype(np.uint8)


@cache
def flight() -> list[Given]:
    return [
        Given(
            (seen(STEP_M * k, 0.0, k), seen(STEP_M * k, BASELINE_M, k)),
            k * PERIOD_NS,
            Pose(np.eye(3), np.array([0.0, 0.0, STEP_M * k])),
        )
        for k in range(FRAMES)
    ]


def fly(change: Callable[[int], Given], given_words: bool = False) -> Iterator[set[Reason]]:
    """The reasons of each frame."""
    values = parameters.defaults()
    rectifier = Rectifier(rectified_rig(CAMERA, "two walls"))
    detector = Detector(rectifier, values)
    engine = create_engine("golden", engine_parameters(values))
    for k in range(FRAMES):
        given = change(k)
        detector.take(*given.images, given.t_ns)
        words = given.words
        if words is None and given_words:
            words = list(engine.levels(*given.images))
        detector.match(words)
        try:
            detector.judge(given.pose, UP)
        except ValueError:
            detector.forget()
            yield {Reason.POSE_JUMP}
            continue
        yield {finding.reason for finding in detector.findings()}


def faulty(fault: Callable[[int, Given], Given]) -> Callable[[int], Given]:
    return lambda k: fault(k, flight()[k]) if ONSET <= k < END else flight()[k]


def moved(image: NDArray[np.uint8], right_px: float, down_px: float) -> NDArray[np.uint8]:
    move = np.array([[1.0, 0.0, right_px], [0.0, 1.0, down_px]])
    return np.asarray(cv2.warpAffine(image, move, (WIDTH, HEIGHT), borderMode=cv2.BORDER_REPLICATE), np.uint8)


def other_right(change: Callable[[int, Images], NDArray[np.uint8]]) -> Callable[[int, Given], Given]:
    return lambda k, given: replace(given, images=(given.images[0], change(k, given.images)))


def other_place(
    change: Callable[[int, NDArray[np.float64]], NDArray[np.float64]],
) -> Callable[[int, Given], Given]:
    def fault(k: int, given: Given) -> Given:
        assert given.pose is not None
        return replace(given, pose=Pose(given.pose.rotation, change(k, given.pose.translation_m)))

    return fault


def bar(_: int, given: Given) -> Given:
    """Columns in the middle that both cameras no longer read."""
    images = tuple(image.copy() for image in given.images)
    for image in images:
        image[:, WIDTH // 2 - 24 : WIDTH // 2 + 24] = 0
    return replace(given, images=(images[0], images[1]))


def dirt(_: int, given: Given) -> Given:
    """A dark blot with a soft rim on both lenses, which hides most of the noise of the images."""
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    cover = np.clip(2.0 - 2.0 * np.hypot(u - WIDTH / 2, v - HEIGHT / 2) / (0.6 * HEIGHT), 0.0, 1.0)
    left, right = (np.rint(i * (1.0 - cover) + 40.0 * cover).astype(np.uint8) for i in given.images)
    return replace(given, images=(left, right))


def slow_clock(k: int, given: Given) -> Given:
    return replace(given, t_ns=given.t_ns - (k - ONSET + 1) * PERIOD_NS // 2)


FAULTS: dict[str, tuple[Callable[[int, Given], Given], Reason]] = {
    "both cameras frozen": (lambda _, g: replace(g, images=flight()[ONSET - 1].images), Reason.IMAGES_FROZEN),
    "left camera frozen": (
        lambda _, g: replace(g, images=(flight()[ONSET - 1].images[0], g.images[1])),
        Reason.IMAGES_FROZEN,
    ),
    "right camera frozen": (other_right(lambda *_: flight()[ONSET - 1].images[1]), Reason.IMAGES_FROZEN),
    "right camera late": (other_right(lambda k, _: flight()[k - 3].images[1]), Reason.MOMENTS_DIFFER),
    "rows off": (other_right(lambda _, images: moved(images[1], 0.0, 1.5)), Reason.ROWS_MISALIGNED),
    "turned in yaw to the left": (
        other_right(lambda _, images: moved(images[1], 3.0, 0.0)),
        Reason.DISPARITIES_OFF,
    ),
    "turned in yaw to the right": (
        other_right(lambda _, images: moved(images[1], -3.0, 0.0)),
        Reason.DISPARITIES_OFF,
    ),
    "columns in the middle": (bar, Reason.VIEW_STUCK),
    "dirt in the middle": (dirt, Reason.VIEW_STUCK),
    "a clock at half its pace": (slow_clock, Reason.TIME_JUMP),
    "a pose that jumps": (other_place(lambda _, at: np.add(at, [1.0, 0.0, 0.0])), Reason.MOTION_DOUBTFUL),
    "a pose that jumps far": (other_place(lambda _, at: np.add(at, [0.0, 0.0, 5.0])), Reason.POSE_JUMP),
    "a way told longer and longer": (
        other_place(lambda k, at: np.add(at, [0.0, 0.0, 0.09 * (k - ONSET + 1) * (k - ONSET + 2)])),
        Reason.DISPARITIES_OFF,
    ),
    "a time far ahead": (lambda _, g: replace(g, t_ns=g.t_ns + 10**10), Reason.TIME_JUMP),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named_within_three_frames_and_no_longer_when_it_has_gone(name: str) -> None:
    fault, reason = FAULTS[name]
    found = list(fly(faulty(fault)))
    assert all(reasons == set() for reasons in found[:ONSET])
    assert any(reason in reasons for reasons in found[ONSET : ONSET + 3])
    held = reason in (
        Reason.POSE_JUMP,
        Reason.MOTION_DOUBTFUL,
        Reason.TIME_JUMP,
    )  # the map holds what was seen then
    assert held or all(reason not in reasons for reasons in found[END + 1 :])


@cache
def at_rest() -> list[Given]:
    images = [(seen(0.0, 0.0, k), seen(0.0, BASELINE_M, k)) for k in range(FRAMES)]
    return [replace(flight()[0], images=pair, t_ns=k * PERIOD_NS) for k, pair in enumerate(images)]


def few_corners(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """All plain but one place on each wall."""
    plain = np.full_like(image, 110)
    for left in (120, 400):
        plain[160:280, left : left + 140] = image[160:280, left : left + 140]
    return plain


@pytest.mark.parametrize("right_px", [1.0, -1.0, 5.0])
@pytest.mark.parametrize("given", ["as it is", "few corners", "at rest"])
def test_a_sudden_turn_in_yaw_is_named_in_its_frame_and_as_long_as_it_lasts(
    given: str, right_px: float
) -> None:
    def shot(k: int) -> Given:
        of = at_rest()[k] if given == "at rest" else flight()[k]
        left, right = of.images if given != "few corners" else map(few_corners, of.images)
        return replace(of, images=(left, moved(right, right_px, 0.0) if ONSET <= k < END else right))

    named = [Reason.DISPARITIES_OFF in reasons for reasons in fly(shot)]
    assert named == [ONSET <= k < END for k in range(FRAMES)]


@cache
def gusty(k: int, yaw_rad: float) -> Given:
    """A frame of a vehicle that yaws and pitches as gusts take it."""
    matrix = np.array([[FOCAL_PX, 0, (WIDTH - 1) / 2], [0, FOCAL_PX, (HEIGHT - 1) / 2], [0, 0, 1]])
    turn = cv2.Rodrigues(yaw_rad * np.array([0.7 * np.cos(1.3 * k), np.sin(1.9 * k), 0.0]))[0]
    view = matrix @ turn.T @ np.linalg.inv(matrix)
    left, right = (
        np.asarray(cv2.warpPerspective(seen(STEP_M * k, right_m, k), view, (WIDTH, HEIGHT)), np.uint8)
        for right_m in (0.0, BASELINE_M)
    )
    return Given((left, right), k * PERIOD_NS, Pose(turn, np.array([0.0, 0.0, STEP_M * k])))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("yaw_rad", "late"), [*((0.003, late) for late in (-2, -1, 0, 1, 2, 3)), (0.018, 0), (0.018, 2)]
)
def test_images_and_poses_of_other_times_are_doubted_while_the_vehicle_turns(
    yaw_rad: float, late: int
) -> None:
    """They have been apart from the first frame on, as those of a clock that is off: nothing jumps. With
    strong gusts nothing is found where the poses say."""
    found = fly(lambda k: replace(gusty(k + 3, yaw_rad), images=gusty(k + 3 - late, yaw_rad).images))
    doubted = [Reason.MOTION_DOUBTFUL in reasons for reasons in found]
    assert all(doubted[6:]) if late else not any(doubted)


@pytest.mark.slow
def test_nothing_is_said_of_a_flight_without_fault() -> None:
    assert list(fly(lambda k: flight()[k])) == [set()] * FRAMES


def test_nothing_is_said_of_a_camera_that_stands_still() -> None:
    """Such a camera even shows the same image again and again where there is no noise."""

    def still(k: int) -> Given:
        return replace(flight()[0], t_ns=k * PERIOD_NS)

    assert all(not reasons for reasons in fly(still))


def of_level_0(
    change: Callable[[NDArray[np.int16]], NDArray[np.int16]],
) -> Callable[[int, Given, Words], Words]:
    return lambda _, __, words: [change(words[0]), *words[1:]]


WORDS: dict[str, Callable[[int, Given, Words], Words]] = {
    "of one value": of_level_0(lambda words: np.full_like(words, 8 * 16)),
    "a bit stuck": of_level_0(
        lambda words: np.where(words >= 0, words | np.int16(64), words).astype(np.int16)
    ),
    "a coarser level empty": lambda _, __, words: [*words[:-1], np.full_like(words[-1], -16)],
}


@pytest.mark.parametrize("name", [*WORDS, "of the pair before"])
def test_words_that_are_not_those_of_the_images_are_found_at_once(name: str) -> None:
    """None is trusted for eight frames more, because a few rows alone are compared."""
    engine = create_engine("golden", engine_parameters(parameters.defaults()))

    def words(k: int, given: Given) -> Given:
        if name == "of the pair before":
            return replace(given, words=list(engine.levels(*flight()[k - 1].images)))
        return replace(given, words=WORDS[name](k, given, list(engine.levels(*given.images))))

    for k, reasons in enumerate(fly(faulty(words), given_words=True)):
        assert (Reason.WORDS_DIFFER in reasons) == (k >= ONSET)


def other_poses(change: Callable[[int], Pose | None], words: Words | None = None) -> Callable[[int], Given]:
    return lambda k: replace(flight()[k], pose=change(k), words=words)


def aside(k: int, right_m: float) -> Pose:
    pose = flight()[k].pose
    assert pose is not None
    return Pose(pose.rotation, np.add(pose.translation_m, [right_m, 0.0, 0.0]))


@pytest.mark.parametrize(("right_m", "named"), [(0.0, False), (2.0, True)])
def test_a_pose_after_missing_ones_has_to_go_on_where_they_led(right_m: float, named: bool) -> None:
    found = list(fly(other_poses(lambda k: None if 3 <= k < 6 else aside(k, right_m if k >= 6 else 0.0))))
    assert [Reason.POSE_JUMP in reasons for reasons in found[6:]] == [named] * 8


def test_a_vehicle_that_stops_between_two_poses_is_not_believed() -> None:
    """A pose that stays the same counts as one of a vehicle that stands after a second."""
    found = list(fly(other_poses(lambda k: flight()[min(k, 2)].pose)))
    assert [Reason.POSE_JUMP in reasons for reasons in found] == [False] * (FRAMES - 1) + [True]


def test_a_pose_that_leads_elsewhere_is_doubted_where_no_image_shows_it() -> None:
    nothing = [np.full((HEIGHT >> k, WIDTH >> k), -16, np.int16) for k in range(3)]
    found = list(fly(other_poses(lambda k: aside(k, 0.6 if k >= ONSET else 0.0), nothing)))
    assert [Reason.MOTION_DOUBTFUL in reasons for reasons in found] == [False] * ONSET + [True] * 8 + [False]


@pytest.mark.parametrize(("degrees", "named"), [(3.0, False), (10.0, True)])
def test_an_attitude_that_jumps_is_doubted_where_no_image_shows_it(degrees: float, named: bool) -> None:
    nothing = [np.full((HEIGHT >> k, WIDTH >> k), -16, np.int16) for k in range(3)]
    turn = cv2.Rodrigues(np.radians([0.0, degrees, 0.0]))[0]

    def turned(k: int) -> Pose:
        pose = aside(k, 0.0)
        return Pose(pose.rotation @ turn if k >= ONSET else pose.rotation, pose.translation_m)

    found = list(fly(other_poses(turned, nothing)))
    doubted = [Reason.MOTION_DOUBTFUL in reasons for reasons in found]
    assert doubted == [False] * ONSET + ([True] * 9 if named else [False] * 9)


def test_after_a_frame_that_is_refused_there_is_little_to_be_relied_on() -> None:
    impossible = Pose(2.0 * np.eye(3), np.zeros(3))
    found = list(fly(other_poses(lambda k: impossible if k == 2 else flight()[k].pose)))
    assert [Reason.POSE_JUMP in reasons for reasons in found] == [False] * 2 + [True] * 9 + [False] * 3


def test_times_that_go_back_are_named_until_enough_was_seen_again() -> None:
    def back(k: int) -> Given:
        return replace(flight()[k], t_ns=flight()[k].t_ns - (10 * PERIOD_NS if k >= ONSET else 0))

    found = [Reason.TIME_JUMP in reasons for reasons in fly(back)]
    assert found[:ONSET] == [False] * ONSET and all(found[ONSET : ONSET + 6]) and not found[-1]
