"""Pictures: colours mean what the legend says, nothing breaks on odd input, regions keep their colour."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import cv2
import numpy as np
import pytest
from fake_pipeline import DescendingPipeline, FakePipeline, fake_ellipse, fake_nearest, fake_obstacle
from numpy.typing import NDArray
from vista import native
from vista.geometry import Calibration
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.pipeline import ID_GROUND, ID_PLACE, ID_TOO_NEAR, Nearest, Obstacle
from vista.report import overlay
from vista.report.labels import PADDING_PX, obstacle_name, text_size
from vista.report.overlay import Overlay, draw_disparity, draw_obstacles, draw_regions, panel_tiles
from vista.report.palette import GREY, INK, RED, YELLOW, RegionColours, distinct_colours
from vista.sequence import Frame

CAMERA = Calibration(640, 480, 450.0, 320.0, 240.0, 0.2)
BLACK = np.zeros((480, 640), np.uint8)


def count(picture: NDArray[np.uint8], colour: tuple[int, int, int]) -> int:
    return int(np.all(picture == colour, axis=-1).sum())


def at(u: float, v: float, **changes: object) -> Obstacle:
    values = {"ellipse": fake_ellipse(u, v, 60.0, 30.0, 0.0), "distance_m": 12.0}
    return fake_obstacle(3, 12.0, CAMERA, **(values | changes))


def nearest(obstacle: Obstacle, time_s: float | None = 2.5) -> Nearest:
    return fake_nearest(obstacle, time_s)


def test_colours_of_obstacles() -> None:
    """Red: on the collision course; yellow: tracked; grey: not confirmed."""
    obstacle = at(320, 240)
    tracked = draw_obstacles(BLACK, [obstacle], None)
    assert count(tracked, YELLOW) > 200 and count(tracked, RED) == 0
    behind = draw_obstacles(BLACK, [obstacle.but(in_collision_volume=True)], None)
    assert count(behind, RED) > 200 and count(behind, YELLOW) == 0
    warning = draw_obstacles(BLACK, [obstacle], nearest(obstacle))
    assert count(warning, RED) > 1.5 * count(behind, RED) and count(warning, YELLOW) == 0
    candidate = draw_obstacles(BLACK, [obstacle.but(confirmed=False)], None)
    assert np.ptp(candidate, axis=-1).max() == 6  # as grey as INK is, and no text
    assert np.sum(candidate[..., 0] > GREY.blue // 2) > 50


def test_the_ellipse_lies_where_it_should() -> None:
    """Semi-axes 60 and 30 px, turned by 90 degrees: the long one stands upright."""
    upright = at(200, 240, ellipse=fake_ellipse(200.0, 240.0, 60.0, 30.0, 90.0))
    v, u = np.nonzero(np.all(draw_obstacles(BLACK, [upright], None) == YELLOW, axis=-1))
    inside = np.abs(v - 240) <= 65  # without the label above
    assert (u[inside].min(), u[inside].max()) == pytest.approx((170, 230), abs=2)
    assert v.max() == pytest.approx(300, abs=2)


def test_an_ellipse_turns_clockwise() -> None:
    turned = at(200, 240, ellipse=fake_ellipse(200.0, 240.0, 80.0, 5.0, 30.0))  # v grows downwards
    v, u = np.nonzero(np.all(draw_obstacles(BLACK, [turned], None) == YELLOW, axis=-1))
    assert v[u > 255].mean() > 255


def test_a_coasting_track_is_dashed() -> None:
    solid, dashed = (
        count(draw_obstacles(BLACK, [at(320, 240, coasting=c)], None), YELLOW) for c in (False, True)
    )
    assert dashed < 0.85 * solid


@pytest.mark.parametrize(
    "ellipse", [(np.nan, 1, 2, 3, 4), (0, 0, 1e12, 1, 0), (-5000, 90, 5, 5, 0), (1e9, 1e9, 5, 5, 0)]
)
def test_odd_ellipses_do_not_break_the_drawing(ellipse: tuple[float, ...]) -> None:
    obstacle = at(0, 0, ellipse=fake_ellipse(*ellipse))
    draw_obstacles(BLACK, [obstacle], nearest(obstacle, None))


def test_labels_do_not_cover_each_other() -> None:
    """Six obstacles in one place: every label drawn adds its own dark ground, all apart."""
    white = np.full((480, 640), 255, np.uint8)
    crowd = [at(320, 240).but(id=k, distance_m=10.0 + k) for k in range(6)]
    alone = count(255 - draw_obstacles(white, crowd[:1], None), (0, 0, 0))
    together = count(255 - draw_obstacles(white, crowd, None), (0, 0, 0))
    width, height = text_size("#3  12 m", 0.5)
    assert alone - together > 4 * width * height


def test_obstacles_without_a_track_are_called_what_they_are() -> None:
    lib = native.load("vista")[1]
    ids = (ID_TOO_NEAR, ID_GROUND, ID_PLACE)
    assert ids == (lib.VISTA_ID_TOO_NEAR, lib.VISTA_ID_GROUND, lib.VISTA_ID_PLACE)
    assert [obstacle_name(k) for k in (*ids, 7)] == ["too near", "ground", "in the way", "#7"]


def test_disparity_colours() -> None:
    words = np.array([[-16, 0, 31 * 16]] * 400, np.int16).repeat(40, axis=1)
    picture = draw_disparity(words, 32)
    invalid, far, near = (picture[0, column].astype(int) for column in (10, 50, 100))
    assert tuple(invalid) == INK
    assert far[0] > far[2] or far.sum() < 200  # blue end
    assert near[2] > near[0]  # red end


def test_the_disparity_has_a_scale_in_metres(monkeypatch: pytest.MonkeyPatch) -> None:
    """Focal length times baseline 310 px m, 31 px at most: the scale starts at 10 m."""
    written: list[tuple[str, tuple[int, int]]] = []
    put_text = cv2.putText

    def record(picture: NDArray[np.uint8], text: str, place: tuple[int, int], *rest: Any) -> None:
        written.append((text, place))
        put_text(picture, text, place, *rest)

    monkeypatch.setattr(cv2, "putText", record)
    words = np.full((480, 640), -16, np.int16)
    picture = draw_disparity(words, 32, 310.0)
    labels = {text: place for text, place in written if text.endswith(" m")}
    assert list(labels)[:3] == ["10 m", "20 m", "50 m"]
    boxes = sorted((x, x + text_size(text, 0.45)[0]) for text, (x, _) in labels.items())
    assert all(left[1] < right[0] for left, right in itertools.pairwise(boxes))
    # Under each label the bar has the colour in which that distance is drawn.
    bar = picture[-2 * PADDING_PX - 3]
    for text, (x, _) in labels.items():
        disparity = 310.0 / float(text.split()[0])
        drawn = draw_disparity(np.full((480, 640), round(16 * disparity), np.int16), 32)[100, 100].astype(int)
        near = bar[x : x + text_size(text, 0.45)[0]].astype(int)
        assert np.abs(near - drawn).sum(axis=1).min() < 12, text


def test_accepted_regions_are_stronger_than_rejected_ones() -> None:
    labels = np.zeros((480, 640), np.int32)
    labels[:, 200:400], labels[:, 400:] = 1, -1
    colours = np.array([[255, 0, 0], [255, 0, 0]], np.uint8)
    grey = np.full((480, 640), 100, np.uint8)
    picture = draw_regions(grey, labels, colours, ["ACCEPTED", "TOO_SMALL"]).astype(int)
    accepted, rejected, none = (picture[100, u, 0] - picture[100, u, 2] for u in (100, 300, 500))
    assert accepted > 3 * rejected > 0
    assert none == 0 and tuple(picture[100, 500]) == (100, 100, 100)


@pytest.mark.parametrize("size", [(64, 48), (640, 480), (1226, 370)])
def test_the_panel_holds_four_tiles(size: tuple[int, int]) -> None:
    camera = dataclasses.replace(CAMERA, width=size[0], height=size[1], cx=size[0] / 2, cy=size[1] / 2)
    left = np.random.default_rng(0).integers(0, 256, size[::-1], np.uint8)
    words = np.full(size[::-1], -16, np.int16)
    pipeline = FakePipeline(camera)
    drawing = Overlay("flight", 32)
    for index in range(2):
        result = pipeline.process(left, words, index, None, None)
        picture = drawing.draw(Frame(index, index, left, left, None), result)
        assert picture.dtype == np.uint8
        assert picture.shape[0] > 2 * size[1] and picture.shape[1] > 2 * size[0]


def test_a_pair_without_images_shows_its_disparities() -> None:
    """The nearer the brighter, below the obstacles."""
    words = np.full(BLACK.shape, -16, np.int16)
    words[:240], words[240:, 320:] = 16 * 30, 16 * 10
    result = FakePipeline(CAMERA).process(BLACK, words, 0, None, None)
    picture = Overlay("flight", 32).obstacles(Frame(0, 0, BLACK, BLACK, None, (words,)), result, None)
    near, far, none = (
        np.median(picture[part]) for part in (np.s_[:240], np.s_[240:, 320:], np.s_[240:, :320])
    )
    assert near > 2 * far > 100 > none


def test_no_regions_at_all() -> None:
    colours = RegionColours().assign(np.full(5, -1, np.int32))
    assert colours.shape == (0, 3)
    draw_regions(BLACK, np.full(BLACK.shape, -1, np.int32), colours, [])


def test_regions_keep_their_colour_when_labels_change() -> None:
    region_colours = RegionColours()
    before = region_colours.assign(np.array([0, 0, 0, 1, 1, 2, 2, -1]))
    after = region_colours.assign(np.array([2, 2, 2, 0, 0, 1, 1, 1]))
    np.testing.assert_array_equal(after[[2, 0, 1]], before)


def test_a_region_that_splits_hands_its_colour_to_the_larger_part() -> None:
    region_colours = RegionColours()
    before = region_colours.assign(np.array([0, 0, 0, 0, 0, 1]))
    after = region_colours.assign(np.array([0, 0, 1, 1, 1, 2]))
    np.testing.assert_array_equal(after[1], before[0])
    np.testing.assert_array_equal(after[2], before[1])
    assert len(np.unique(after, axis=0)) == 3


def test_palette_has_no_colour_twice() -> None:
    assert len(np.unique(distinct_colours(), axis=0)) == len(distinct_colours())


def texts_of_headline(
    monkeypatch: pytest.MonkeyPatch,
    camera: Calibration,
    name: str = "flight",
    stills: bool = False,
    seen_m: float = 19.0,
) -> dict[str, tuple[int, int]]:
    """The texts above the tiles of a frame with a warning, and from where to where they reach, px."""
    found = {}
    bar_height = panel_tiles(camera.width, camera.height)[0][1]

    def record(picture: NDArray[np.uint8], text: str, x: int, y: int, scale: float, *_: object) -> None:
        if y < bar_height and picture.shape[1] > camera.width:
            found[text] = (x - PADDING_PX, x + text_size(text, scale)[0] + PADDING_PX)

    monkeypatch.setattr(overlay, "put_text", record)
    left = np.zeros((camera.height, camera.width), np.uint8)
    pipeline = DescendingPipeline(camera)
    for index in range(2):
        result = pipeline.process(left, np.full(left.shape, -16, np.int16), index, None, None)
    Overlay(name, 32, stills=stills).draw(
        Frame(1, 1, left, left, None),
        dataclasses.replace(result, outcome=result.outcome.but(path_seen_m=seen_m)),
    )
    return found


def test_the_headline_counts_things_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three confirmed tracks; what has no track is not one more."""
    facts, warning = texts_of_headline(monkeypatch, CAMERA)
    assert facts == "flight   frame 1   3 obstacles   path seen to 19 m"
    assert warning == "collision: #2  19.0 m  1.9 s"


@pytest.mark.parametrize(("seen_m", "shown"), [(100.0, "19 m"), (7.0, "7 m")])
def test_behind_the_nearest_collision_the_path_is_not_said_to_be_seen(
    monkeypatch: pytest.MonkeyPatch, seen_m: float, shown: str
) -> None:
    facts, _ = texts_of_headline(monkeypatch, CAMERA, seen_m=seen_m)
    assert facts.endswith(f"path seen to {shown}")


def test_a_still_picture_has_no_flight_path(monkeypatch: pytest.MonkeyPatch) -> None:
    facts, _ = texts_of_headline(monkeypatch, CAMERA, stills=True)
    assert facts == "flight   picture 1   3 obstacles"


@pytest.mark.parametrize("width", [320, 400, 640, 1226])
def test_the_headline_does_not_run_below_the_warning(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    """It leaves out on small pictures how far the path is seen."""
    camera = Calibration(width, 3 * width // 4, 450.0, width / 2, 3 * width / 8, 0.2)
    (facts, (_, facts_end)), (_, (warning_start, _)) = texts_of_headline(
        monkeypatch, camera, "V1_01_easy"
    ).items()
    assert facts_end <= width < warning_start
    assert facts.startswith("V1_01_easy   frame 1   3 obstacles")
    assert ("path seen to" in facts) == (width > 320)


def test_the_headline_says_that_a_frame_is_blind() -> None:
    """It stands on the red ground of warnings, also when nothing is on the collision course."""
    left, words = np.zeros((480, 640), np.uint8), np.full((480, 640), -16, np.int16)
    result = FakePipeline(CAMERA).process(left, words, 0, None, None)  # no collision in the first frame
    blind = FrameHealth((Finding(next(iter(Reason)), State.BLIND, "The image is black."),))
    bar_height = panel_tiles(640, 480)[0][1]
    healthy, warned = (
        Overlay("flight", 32).draw(Frame(0, 0, left, left, None), result, health)[:bar_height].astype(int)
        for health in (FrameHealth(), blind)
    )
    reddish = [int((bar[..., 2] - bar[..., 0] > 100).sum()) for bar in (healthy, warned)]
    assert reddish[0] == 0 and reddish[1] > 500
