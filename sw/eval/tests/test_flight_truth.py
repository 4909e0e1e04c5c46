"""A frame's truth: depth, labels and objects agree with geometry, with the other camera, with time."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from vista_eval.render.course import Course
from vista_eval.render.flight import Flight, prepare, render_flight
from vista_eval.render.renderer import Renderer
from vista_eval.render.rig import LEFT, PAPER_RIG, RIGHT, Rig
from vista_eval.render.scene import GroundStrip, Haze, Mesh, Panel, Scene, Sphere, board, thing

SMALL_RIG = Rig(width_px=160, height_px=120, focal_px=250.0, baseline_m=0.4572)
GREY = np.full((4, 4), 0.5, np.float32)
ALTITUDE_M = 6.0
TRIANGLE = np.array([[0.0, -6.0, 5.0], [0.0, -3.0, 5.0], [0.0, -4.5, 8.0]])


def scene_with_everything(altitude_m: float, _: int) -> Scene:
    """A board ahead, a sphere that crosses behind it, and a panel and a triangle that turn their backs."""
    front = board("board", (0.0, 0.0, altitude_m), 2.0, 1.5, GREY)
    ball = Sphere("ball", (10.0, 3.0, altitude_m), 1.0, GREY)
    panel = Panel("panel", (5.0, 6.0, altitude_m), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), GREY)
    triangle = Mesh("triangle", TRIANGLE, np.array([[0, 2, 1]]), np.full(3, 0.5))
    reverse = Mesh("reverse", TRIANGLE - np.array([0.0, 0.0, 4.0]), np.array([[0, 1, 2]]), np.full(3, 0.5))
    ground = GroundStrip("ground", (-60.0, 300.0), (-200.0, 200.0), GREY)
    return Scene(
        (
            thing("board", "sign", [front], target=True),
            thing("ball", "ball", [ball], velocity_m_s=(0.0, 2.0, 0.0)),
            thing("backs", "panel", [panel, triangle, reverse]),
            thing("ground", "ground", [ground], standing=False),
        ),
        to_sun=(-0.6, 0.4, 0.7),
    )


FLIGHT = Flight(
    "everything",
    "a bit of everything",
    "dev",
    Course(ALTITUDE_M, 9.0, last_range_m=25.0, frames=3, rate_hz=10.0),
    scene_with_everything,
    rig=SMALL_RIG,
)


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("truth") / FLIGHT.name
    assert list(render_flight(FLIGHT, out)) == [0, 1, 2]
    return out


def read_truth(rendered: Path) -> dict:
    return json.loads((rendered / "truth.json").read_text())


def read_png(rendered: Path, kind: str, t_ns: int) -> np.ndarray:
    return cv2.imread(str(rendered / "truth" / kind / f"{t_ns}.png"), cv2.IMREAD_UNCHANGED)


def test_labels_count_the_pixels_of_each_object(rendered: Path) -> None:
    truth = read_truth(rendered)
    assert [thing["label"] for thing in truth["objects"]] == [1, 2, 3, 4]
    for frame in truth["frames"]:
        label = read_png(rendered, "label", frame["t_ns"])
        assert label.dtype == np.uint8
        seen = {each["label"]: each for each in frame["objects"]}
        assert set(np.unique(label)) - {0} == set(seen) == {1, 2, 3, 4}
        for k, each in seen.items():
            v, u = np.nonzero(label == k)
            assert each["pixels"] == len(u)
            assert each["bbox_px"] == [u.min(), v.min(), u.max(), v.max()]


def test_only_the_sky_is_without_disparity(rendered: Path) -> None:
    """What turns its back, or stands in a mesh of either winding, has a label and a depth as well."""
    for frame in read_truth(rendered)["frames"]:
        label = read_png(rendered, "label", frame["t_ns"])
        disparity = read_png(rendered, "disparity", frame["t_ns"])
        assert disparity.dtype == np.uint16
        np.testing.assert_array_equal(label == 0, disparity == 0)


def test_disparity_is_the_depth_of_the_board(rendered: Path) -> None:
    """The board stands square to the path, so its depth varies with the little that the camera yaws."""
    fb = SMALL_RIG.focal_px * SMALL_RIG.baseline_m
    for k, frame in enumerate(read_truth(rendered)["frames"]):
        pose = FLIGHT.approach.state_at(k).world_from_body @ SMALL_RIG.body_from_camera(LEFT)
        z_m = (np.linalg.inv(pose) @ [0.0, 0.0, ALTITUDE_M, 1.0])[2]
        words = read_png(rendered, "disparity", frame["t_ns"])
        label = read_png(rendered, "label", frame["t_ns"])
        assert np.median(words[label == 1]) / 256 == pytest.approx(fb / z_m, rel=2e-3)


def test_objects_are_where_they_are_in_the_world(rendered: Path) -> None:
    truth = read_truth(rendered)
    board, ball, _, ground = (
        [next(o for o in frame["objects"] if o["label"] == k) for frame in truth["frames"]]
        for k in (1, 2, 3, 4)
    )
    pixel_m = 30.0 / SMALL_RIG.focal_px
    for each in board:
        assert each["position_m"] == pytest.approx([0.0, 0.0, ALTITUDE_M], abs=pixel_m)
    for each in ground:
        assert each["position_m"][2] == pytest.approx(0.0, abs=0.01)
    moved_m = np.diff([each["position_m"][1] for each in ball])
    assert moved_m == pytest.approx(2.0 / FLIGHT.approach.rate_hz, abs=0.1)
    assert truth["objects"][1]["position_m"] == pytest.approx([10.0, 3.0 - 2 * 0.2, ALTITUDE_M])


def test_the_other_camera_sees_the_same_points() -> None:
    """A point of the left view, moved by its disparity, has the same depth in the right view or is hidden."""
    renderer = Renderer(scene_with_everything(ALTITUDE_M, 1), SMALL_RIG)
    body = FLIGHT.approach.state_at(0).world_from_body
    left, right = (renderer.view(body @ SMALL_RIG.body_from_camera(camera)) for camera in (LEFT, RIGHT))
    v, u = np.nonzero(np.isfinite(left.depth_m))
    depth = left.depth_m[v, u]
    column = np.rint(u - SMALL_RIG.focal_px * SMALL_RIG.baseline_m / depth).astype(int)
    inside = column >= 0
    v, depth, label, column = v[inside], depth[inside], left.label[v, u][inside], column[inside]
    same = np.abs(right.depth_m[v, column] - depth) < 0.02 * depth
    hidden = right.depth_m[v, column] < 0.98 * depth
    assert np.mean(same | hidden) > 0.99  # the rest: edges that fall on another pixel
    assert np.mean(right.label[v, column][same] == label[same]) > 0.99
    assert np.mean(same) > 0.9


def test_haze_takes_contrast_with_distance() -> None:
    clear = scene_with_everything(ALTITUDE_M, 1)
    haze = Haze(extinction_per_m=0.01, airlight=0.7)
    pose = FLIGHT.approach.state_at(2).world_from_body @ SMALL_RIG.body_from_camera(LEFT)
    hazy = Scene(clear.things, clear.to_sun, haze=haze)
    renderers = [Renderer(scene, SMALL_RIG) for scene in (clear, hazy)]
    before, after = (renderer.radiance(pose) for renderer in renderers)
    seen = (renderers[0].view(pose).label == 1).astype(np.uint8)
    front = cv2.erode(seen, np.ones((5, 5), np.uint8)) > 0  # at its rim a pixel shows what is behind, too
    depth_m = renderers[0].view(pose).depth_m[front]
    v, u = np.nonzero(front)
    (cu, cv), f = SMALL_RIG.center_px, SMALL_RIG.focal_px
    kept = np.exp(-0.01 * depth_m * np.sqrt(1 + ((u - cu) / f) ** 2 + ((v - cv) / f) ** 2))
    np.testing.assert_allclose(after[front], before[front] * kept + 0.7 * (1 - kept), rtol=1e-4)


def test_rows_of_the_right_camera_are_off_by_a_tenth_or_two_of_a_pixel() -> None:
    nominal, mounted = (
        PAPER_RIG.body_from_camera(RIGHT),
        PAPER_RIG.body_from_mounted_camera(RIGHT),
    )
    u, v = np.meshgrid([0.0, 319.5, 639.0], [0.0, 239.5, 479.0])
    (cu, cv), f = PAPER_RIG.center_px, PAPER_RIG.focal_px
    points = 30 * np.stack([(u - cu) / f, (v - cv) / f, np.ones_like(u)], axis=-1)
    seen = PAPER_RIG.project(points @ (np.linalg.inv(mounted) @ nominal)[:3, :3].T)
    rows_px = np.abs(seen[..., 1] - v)
    assert rows_px.min() > 0.04
    assert rows_px.max() < 0.2
    assert rows_px[1, 1] == pytest.approx(0.1, abs=0.05)
    assert np.abs(seen[..., 0] - u).max() < 0.06  # a quarter of a disparity step of 1/4 px at the most
    np.testing.assert_array_equal(PAPER_RIG.body_from_camera(LEFT), PAPER_RIG.body_from_mounted_camera(LEFT))


def test_a_flight_of_another_quality_is_not_thrown_away(tmp_path: Path) -> None:
    """It begins nearer, so its frames are others."""
    out, from_afar = tmp_path / "flight", replace(FLIGHT, approach=replace(FLIGHT.approach, frames=90))
    prepare(from_afar, out)
    with pytest.raises(OSError, match="full quality"):
        prepare(from_afar, out, "quick")
    assert (out / "content.json").exists()
