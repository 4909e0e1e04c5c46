"""Thin wires cover the share of each pixel that they cover in life."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from random_seed import seed_of
from vista_eval.render.renderer import Renderer
from vista_eval.render.rig import LEFT, Rig
from vista_eval.render.scene import Cylinder, Scene, board, thing
from vista_eval.render.strips import below

RIG = Rig(width_px=160, height_px=120, focal_px=1000.0, baseline_m=0.4572)
BLACK, GREY = np.zeros((2, 2), np.float32), np.full((2, 2), 0.5, np.float32)
SKY = 0.9


def pose_at(x_m: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x_m
    return pose @ RIG.body_from_camera(LEFT)


def dark(*things_m: tuple[tuple[float, float, float], ...], radius_m: float = 0.006) -> Scene:
    """Black wires through points, before a bright sky."""
    things = [
        thing(
            f"wire{k}",
            "wire",
            [
                Cylinder(f"wire{k}_{n}", start, end, radius_m, BLACK)
                for n, (start, end) in enumerate(pairwise(points))
            ],
        )
        for k, points in enumerate(things_m)
    ]
    return Scene(tuple(things), to_sun=(0.0, 0.0, 1.0), sky="overcast", overcast_radiance=SKY)


def cover(scene: Scene, x_m: float = -30.0) -> np.ndarray:
    return 1 - Renderer(scene, RIG).radiance(pose_at(x_m)) / SKY


@pytest.mark.parametrize("angle_deg", [0.0, 3.0, 30.0, 45.0, 77.0, 90.0])
@pytest.mark.parametrize("diameter_m", [0.005, 0.012, 0.030])
def test_a_wire_takes_its_width_of_every_line_of_pixels(angle_deg: float, diameter_m: float) -> None:
    """30 m away, square to the view: f d / r pixels wide, longer along rows or columns by the slant."""
    step = 10 * np.array([0.0, np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    center = np.random.default_rng(seed_of("wire")).uniform(-0.02, 0.02, 3) * [0, 1, 1] + [0, 0.2286, 0]
    found = cover(dark((tuple(center - step), tuple(center + step)), radius_m=diameter_m / 2))
    width_px = RIG.focal_px * diameter_m / 30.0
    slant = max(abs(np.cos(np.radians(angle_deg))), abs(np.sin(np.radians(angle_deg))))
    lines = found.sum(axis=0 if angle_deg < 45 else 1)[40:80]
    np.testing.assert_allclose(lines, width_px / slant, rtol=0.01)
    assert found.max() <= min(1, width_px * 1.4143) + 1e-5


def test_a_wire_anyhow_in_space_covers_what_rays_find() -> None:
    """576 rays a pixel, each of which meets the wire if it passes its axis within the radius. They count each
    outline to half a row of them."""
    random = np.random.default_rng(seed_of("anyhow"))
    cells = (np.arange(24) + 0.5) / 24 - 0.5
    for _ in range(6):
        start, end = random.uniform([-12, -1.5, -1.2], [12, 1.5, 1.2], (2, 3))
        radius_m = float(random.uniform(0.003, 0.03))
        found = cover(dark((tuple(start), tuple(end)), radius_m=radius_m))
        v, u = np.nonzero(found > 0.02)
        chosen = random.permutation(len(u))[:60]
        ends = (np.stack([start, end]) - pose_at(-30.0)[:3, 3]) @ pose_at(-30.0)[:3, :3]
        axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        for row, column in zip(v[chosen], u[chosen], strict=True):
            x, y = np.meshgrid(column + cells - RIG.center_px[0], row + cells - RIG.center_px[1])
            ray = np.stack([x / RIG.focal_px, y / RIG.focal_px, np.ones(x.shape)], axis=-1)
            square = np.cross(ray, axis)
            passes_m = np.abs(square @ ends[0]) / np.linalg.norm(square, axis=-1)
            across = np.cross(axis, square)  # the ray is nearest to the axis where it is square to this
            along_m = (ray * (across @ ends[0])[..., None] / np.sum(ray * across, -1, keepdims=True)) @ axis
            within = (along_m > ends[0] @ axis) & (along_m < ends[1] @ axis)
            expected = np.mean((passes_m < radius_m) & within)
            at_an_end = not np.all(within[passes_m < radius_m])  # which is drawn as cut off square
            assert found[row, column] == pytest.approx(expected, abs=0.15 if at_an_end else 1 / 24)


def test_a_wire_of_many_pieces_is_one_wire() -> None:
    ends = np.array([[0.0, 2.5, 0.9], [4.0, -2.0, -1.1]])
    points = [tuple(ends[0] + share * (ends[1] - ends[0])) for share in np.linspace(0, 1, 37)]
    whole = cover(dark((points[0], points[-1])))
    np.testing.assert_allclose(cover(dark(tuple(points))), whole, atol=2e-3)
    assert whole.max() > 0.3


def test_two_wires_hide_parts_of_each_other() -> None:
    first, second = ((0.0, -5.0, 0.0), (0.0, 5.0, 0.0)), ((3.0, 0.2286, -5.0), (3.0, 0.2286, 5.0))
    together = cover(dark(first, second))
    alone = [cover(dark(one)) for one in (first, second)]
    np.testing.assert_allclose(together, 1 - (1 - alone[0]) * (1 - alone[1]), atol=1e-5)


def test_the_truth_has_the_wire_where_the_middle_of_a_pixel_shows_it() -> None:
    """A wire of 12 mm at 30 m has 0.4 of all rows, or of all columns; its depth is that of its surface."""
    points = ((0.0, -4.0, -0.7), (0.0, 4.0, 0.9))
    renderer = Renderer(dark(points), RIG)
    view = renderer.view(pose_at(-30.0))
    shown = view.label == 1
    assert shown.sum() / RIG.width_px == pytest.approx(0.4 * np.hypot(1, 0.2), abs=0.03)
    assert np.all(np.isinf(view.depth_m[~shown]))
    assert np.all(np.abs(view.depth_m[shown] - 30.0) <= 0.0061)
    points_m = view.world_points_m(RIG, pose_at(-30.0))[shown]
    assert np.abs(points_m[:, 2] - (0.1 + 0.2 * points_m[:, 1])).max() < 0.0063


def test_a_board_hides_the_wire_behind_it_and_not_the_one_before_it() -> None:
    sign = thing("board", "sign", [board("board", (0.0, 0.2286, 0.0), 2.0, 20.0, GREY)])
    for x_m, hidden in ((5.0, True), (-5.0, False)):
        wires = dark(((x_m, -8.0, 0.0), (x_m, 8.0, 0.0)))
        scene = Scene((*wires.things, sign), wires.to_sun, sky="overcast")
        view = Renderer(scene, RIG).view(pose_at(-30.0))
        with_wire, without = (
            Renderer(each, RIG).radiance(pose_at(-30.0))
            for each in (scene, Scene((sign,), wires.to_sun, sky="overcast"))
        )
        over_board = np.abs(with_wire - without)[:, 70:90]
        assert (over_board.max() == 0) == hidden
        assert np.any(view.label[:, 70:90] == 1) == (not hidden and over_board.max() > 0.1)


def test_a_wire_is_lit_like_the_cylinder_that_it_is() -> None:
    """It is lit from its side: on average pi / 4 of what a wall gets that faces the sun."""
    wire = Cylinder("wire", (0.0, 0.0, -9.0), (0.0, 0.0, 9.0), 0.02, GREY)
    scene = Scene(
        (thing("wire", "wire", [wire]),), (-1.0, 0.0, 0.0), fill_irradiance=0.0, overcast_radiance=0
    )
    scene = Scene(scene.things, scene.to_sun, 4.0, 0.0, "overcast", 0.0)
    lines = Renderer(scene, RIG).radiance(pose_at(-30.0)).sum(axis=1)
    width_px = RIG.focal_px * 0.04 / 30.0
    np.testing.assert_allclose(lines, width_px * np.pi / 4 * 0.5 * 4.0 / np.pi, rtol=0.02)


def test_a_wire_overhead_is_cut_where_the_camera_is() -> None:
    found = cover(dark(((-80.0, 0.3, 2.0), (50.0, 0.3, 2.0)), radius_m=0.015))
    assert np.isfinite(found).all() and found.min() > -1e-6 and found.max() > 0.3


def test_the_share_below_a_line_is_that_of_points_spread_over_the_pixel() -> None:
    random = np.random.default_rng(seed_of("below"))
    grid = (np.stack(np.meshgrid(np.arange(400), np.arange(400)), -1).reshape(-1, 2) + 0.5) / 400 - 0.5
    for turn in [0.0, np.pi / 2, *random.uniform(0, np.pi / 2, 8)]:
        normal = np.array([np.cos(turn), np.sin(turn)])
        for limit in random.uniform(-0.8, 0.8, 6):
            expected = np.mean(grid @ normal < limit)
            assert below(np.array([limit]), normal[None])[0] == pytest.approx(expected, abs=3e-3)


def test_a_painted_wire_keeps_its_bands() -> None:
    """A rod of 4 cm, pale below and dark above."""
    shades = np.repeat([[0.8], [0.1]], 8, axis=0).astype(np.float32)
    rod = Cylinder("rod", (0.0, 0.0, -1.0), (0.0, 0.0, 1.0), 0.02, shades)
    scene = Scene((thing("rod", "pole", [rod]),), to_sun=(-1.0, 0.0, 0.0), sky="overcast")
    renderer = Renderer(scene, RIG)
    radiance, seen = renderer.radiance(pose_at(-10.0)), renderer.view(pose_at(-10.0)).label == 1
    middle = int(np.median(np.nonzero(seen)[1]))
    above, below_it = radiance[10:55, middle], radiance[65:110, middle]
    assert np.all(seen[10:110, middle])
    np.testing.assert_allclose(below_it / above[::-1], 8.0, rtol=0.02)
