"""The renderer that casts rays: against the path tracer, against geometry, between the cameras."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from random_seed import seed_of
from vista_eval.render.fast.renderer import FastRenderer
from vista_eval.render.flight import Flight, content_of, render_flight
from vista_eval.render.rig import LEFT, RIGHT, Rig
from vista_eval.render.scene import (
    Board,
    Box,
    Cylinder,
    GroundStrip,
    Haze,
    HeightField,
    Mesh,
    Panel,
    Scene,
    Sphere,
    thing,
)
from vista_eval.render.trajectory import Approach

RIG = Rig(width_px=160, height_px=120, focal_px=250.0, baseline_m=0.4572, right_pitch_deg=0, right_roll_deg=0)
GREY = np.full((4, 4), 0.5, np.float32)
ALTITUDE_M = 6.0
TRIANGLE = np.array([[0.0, -6.0, 5.0], [0.0, -3.0, 5.0], [0.0, -4.5, 8.0]])


def blotches(seed: int, rows: int = 12, columns: int = 12) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.1, 0.8, (rows, columns)).astype(np.float32)


def everything(altitude_m: float, seed: int) -> Scene:
    """Every kind of solid; the ball moves."""
    x, y = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 7), indexing="ij")
    hill = HeightField("hill", (40.0, 90.0), (-30.0, 30.0), 9 * x + 2 * y, blotches(seed))
    return Scene(
        (
            thing("board", "sign", [Board("board", (0.0, 0.0, 6.0), 2.0, 1.5, blotches(seed + 1))]),
            thing(
                "ball", "ball", [Sphere("ball", (10.0, 3.0, 6.0), 1.0, GREY)], velocity_m_s=(0.0, 2.0, 0.0)
            ),
            thing(
                "panel",
                "panel",
                [Panel("panel", (5.0, 6.0, 6.0), (0.3, 1.0, 0.0), (0.0, 0.0, -1.0), blotches(seed + 2))],
            ),
            thing(
                "mesh",
                "mesh",
                [Mesh("mesh", TRIANGLE, np.array([[0, 2, 1]]), np.array([0.2, 0.5, 0.8]))],
            ),
            thing("box", "box", [Box("box", (8.0, -7.0, 1.0), (2.0, 3.0, 2.0), GREY, 20.0)]),
            thing("mast", "mast", [Cylinder("mast", (4.0, -2.5, 0.0), (4.0, -2.5, 7.5), 0.3, GREY)]),
            thing(
                "ground",
                "ground",
                [GroundStrip("ground", (-60.0, 40.0), (-30.0, 30.0), blotches(seed + 3, 40, 24))],
                standing=False,
            ),
            thing("hill", "ground", [hill], standing=False),
        ),
        to_sun=(-0.6, 0.4, 0.7),
        sky="overcast",
    )


def pose_at(x_m: float, camera: int = LEFT, altitude_m: float = ALTITUDE_M) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x_m, 0.0, altitude_m
    return pose @ RIG.body_from_camera(camera)


def test_it_sees_what_the_path_tracer_sees() -> None:
    """Depth, labels, and, in the light of the sun alone, grey levels with their textures and shadows. Rays
    that graze an edge may miss it here and meet it there."""
    from vista_eval.render.renderer import Renderer

    scene = replace(everything(ALTITUDE_M, 1), fill_irradiance=0.0, haze=Haze(0.01, 0.7))
    path, fast = Renderer(scene, RIG, rays=16), FastRenderer(scene, RIG)
    for x_m, t_s in ((-30.0, 0.0), (-22.0, -1.0)):
        for renderer in (path, fast):
            renderer.move_to(t_s)
        theirs, ours = path.view(pose_at(x_m)), fast.view(pose_at(x_m))
        same = theirs.label == ours.label
        assert set(np.unique(ours.label)) == set(range(9))
        assert same.mean() > 0.998
        seen = same & (ours.label > 0)
        relative = np.abs(ours.depth_m[seen] / theirs.depth_m[seen] - 1)
        assert np.quantile(relative, 0.99) < 1e-3
        assert np.all(np.isinf(ours.depth_m) == (ours.label == 0))
        errors = np.abs(fast.radiance(pose_at(x_m)) - path.radiance(pose_at(x_m), seed=1))
        assert np.median(errors) < 0.005
        assert errors.mean() < 0.012


def test_the_cameras_share_what_they_see() -> None:
    """A fine texture far away, where a pixel covers many of its specks: between the cameras, after the
    disparity is undone, about 0.16 of the contrast differs, which is resampling. Single rays make it 0.40:
    they find other specks in each."""
    texture = blotches(seed_of("shared"), 800, 480)
    ground = thing(
        "ground", "ground", [GroundStrip("g", (-10.0, 150.0), (-48.0, 48.0), texture)], standing=False
    )
    renderer = FastRenderer(Scene((ground,), to_sun=(0.0, 0.0, 1.0), sky="overcast"), RIG)
    left, right = (renderer.radiance(pose_at(-20.0, camera)) for camera in (LEFT, RIGHT))
    disparity = RIG.focal_px * RIG.baseline_m / renderer.view(pose_at(-20.0)).depth_m
    rows = slice(75, 110)
    u = np.arange(RIG.width_px)
    moved = np.stack([np.interp(u - disparity[v, 0], u, right[v]) for v in range(rows.start, rows.stop)])
    inside = slice(10, -10)
    difference = (left[rows] - moved)[:, inside].std()
    assert left[rows, inside].std() > 0.03
    assert difference < 0.25 * left[rows, inside].std()


def test_what_is_too_fine_becomes_grey() -> None:
    chequers = np.indices((2000, 2000)).sum(axis=0) % 2
    wall = thing("wall", "wall", [Board("wall", (0.0, 0.0, 6.0), 20.0, 20.0, chequers.astype(np.float32))])
    scene = Scene((wall,), to_sun=(-1.0, 0.0, 0.0), fill_irradiance=0.0)
    radiance = FastRenderer(scene, RIG).radiance(pose_at(-20.0))
    middle = radiance[20:100, 20:140]
    assert middle == pytest.approx(0.5 * scene.sun_irradiance / np.pi, rel=0.02)


def test_shadows_fall_away_from_the_sun() -> None:
    """A board over level ground, the sun straight above: the ground below it gets the sky's light only."""
    roof = Panel("roof", (10.0, 0.0, 8.0), (0.0, -2.0, 0.0), (-2.0, 0.0, 0.0), GREY)
    ground = GroundStrip("ground", (-60.0, 200.0), (-60.0, 60.0), GREY)
    scene = Scene(
        (thing("roof", "roof", [roof]), thing("ground", "ground", [ground], standing=False)),
        to_sun=(0.0, 0.0, 1.0),
        fill_irradiance=0.0,
    )
    renderer, pose = FastRenderer(scene, RIG), pose_at(-20.0)
    view = renderer.view(pose)
    points = view.world_points_m(RIG, pose)
    below = (view.label == 2) & np.all(np.abs(points[..., :2] - [10.0, 0.0]) < 1.5, axis=-1)
    beside = (view.label == 2) & np.any(np.abs(points[..., :2] - [10.0, 0.0]) > 2.5, axis=-1)
    assert below.sum() > 20
    assert np.all(renderer.radiance(pose)[below] == 0)
    np.testing.assert_allclose(
        renderer.radiance(pose)[beside & (points[..., 0] < 60)], 0.5 * 4.2 / np.pi, 0.02
    )


FLIGHT = Flight(
    "everything",
    "a bit of everything",
    "dev",
    Approach(ALTITUDE_M, 9.0, last_range_m=25.0, frames=2, rate_hz=10.0),
    everything,
    rig=RIG,
    family="everything",
    renderer="fast",
)


def bytes_of(out: Path) -> dict[str, bytes]:
    assert list(render_flight(FLIGHT, out)) == [0, 1]
    return {
        str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()
    }


def test_a_flight_is_the_same_whoever_renders_it(tmp_path: Path) -> None:
    """Here, and in two processes at the same time."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        elsewhere = list(pool.map(bytes_of, [tmp_path / "a", tmp_path / "b"]))
    here = bytes_of(tmp_path / "c")
    assert here == elsewhere[0] == elsewhere[1]
    assert b'"family": "everything"' in here["truth.json"]
    assert content_of(FLIGHT, "full") != content_of(replace(FLIGHT, renderer="path"), "full")
