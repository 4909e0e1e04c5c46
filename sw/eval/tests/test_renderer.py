"""The renderer: against the equations of the solids, between the cameras, between processes."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from random_seed import seed_of
from vista_eval.render.course import Course
from vista_eval.render.flight import Flight, render_flight
from vista_eval.render.motion import solids_at
from vista_eval.render.renderer import Renderer
from vista_eval.render.rig import LEFT, RIGHT, Rig
from vista_eval.render.scene import (
    Cylinder,
    GroundStrip,
    HeightField,
    Mesh,
    Panel,
    Scene,
    Solid,
    Sphere,
    board,
    thing,
)
from vista_eval.worlds.things import mesh
from vista_eval.worlds.triangles import box, placed

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
            thing("board", "sign", [board("board", (0.0, 0.0, 6.0), 2.0, 1.5, blotches(seed + 1))]),
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
            thing("box", "box", [mesh("box", placed(box((0, 0, 1), (2, 3, 2), 0.5), (8, -7, 0), 20))]),
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


def meets(solid: Solid, origin: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) distance along each ray (n, 3) at which it meets a solid, inf: not at all; (n, 3) normals there.
    By the equations of the solids; nothing here knows of triangles, but where the solid is one."""
    match solid:
        case Sphere():
            return meets_round(origin - solid.center_m, rays, solid.radius_m)
        case Cylinder():
            foot, height_m = np.array(solid.start_m), solid.end_m[2] - solid.start_m[2]
            level = np.array([1.0, 1.0, 0.0])
            side, normals = meets_round((origin - foot) * level, rays * level, solid.radius_m)
            z = origin[2] + side * rays[:, 2] - foot[2]
            side[~((z > 0) & (z < height_m))] = np.inf
            top = (solid.end_m[2] - origin[2]) / rays[:, 2]
            at = (origin + top[:, None] * rays - solid.end_m)[:, :2]
            top[(top <= 0) | (np.hypot(*at.T) > solid.radius_m)] = np.inf
            return np.minimum(side, top), np.where((top < side)[:, None], [0.0, 0.0, 1.0], normals)
        case Mesh():
            corners = solid.vertices_m[solid.faces]
            each = [meets_flat(a, b - a, c - a, origin, rays, True) for a, b, c in corners]
            near = np.array([reach for reach, _ in each])
            first = near.argmin(axis=0)
            return near.min(axis=0), np.array([normals for _, normals in each])[first, np.arange(len(rays))]
        case Panel():
            corner, u, v = np.array(solid.center_m), solid.half_right_m, solid.half_down_m
        case GroundStrip():
            (x0, x1), (y0, y1) = solid.x_m, solid.y_m
            corner = np.array([x0 + x1, y0 + y1, 0.0]) / 2
            u, v = [0.0, (y1 - y0) / 2, 0.0], [(x1 - x0) / 2, 0.0, 0.0]
        case HeightField():  # a plane, here
            a, b, c = solid.vertices_m()[[0, solid.height_m.shape[1] - 1, -1]]
            corner, u, v = (a + c) / 2, (b - a) / 2, (c - b) / 2
    return meets_flat(corner, u, v, origin, rays)


def meets_flat(
    corner: np.ndarray, u: np.ndarray, v: np.ndarray, origin: np.ndarray, rays: np.ndarray, three=False
) -> tuple[np.ndarray, np.ndarray]:
    """All within -1 to 1 times two vectors around a point, or the triangle between it and their ends."""
    normal = np.cross(u, v)
    reach = (corner - origin) @ normal / (rays @ normal)
    at = (origin + reach[:, None] * rays - corner) @ np.linalg.pinv(np.stack([u, v]))
    inside = np.all(at >= 0, axis=1) & (at.sum(axis=1) <= 1) if three else np.all(np.abs(at) <= 1, axis=1)
    reach[~inside | (reach <= 0)] = np.inf
    return reach, np.broadcast_to(normal / np.linalg.norm(normal), rays.shape)


def meets_round(start: np.ndarray, rays: np.ndarray, radius_m: float) -> tuple[np.ndarray, np.ndarray]:
    """A sphere around the origin; rays without a part along an axis: a cylinder along that axis."""
    a, b = np.einsum("ij,ij->i", rays, rays), rays @ start
    inner = b**2 - a * (start @ start - radius_m**2)
    with np.errstate(invalid="ignore"):
        near = (-b - np.sqrt(inner)) / a
    near[~(inner > 0) | (near <= 0)] = np.inf
    with np.errstate(invalid="ignore"):
        return near, np.nan_to_num((start + near[:, None] * rays) / radius_m)


@pytest.mark.slow
def test_what_a_pixel_sees_follows_from_the_equations_of_the_solids() -> None:
    """Depth, labels, and in the light of the sun alone the grey of what has one shade, shadows included. Rays
    that graze an edge may miss it here and meet it there."""
    scene = replace(everything(ALTITUDE_M, 1), fill_irradiance=0.0)
    renderer, sun = Renderer(scene, RIG), np.array(scene.to_sun) / np.linalg.norm(scene.to_sun)
    v, u = (index.ravel() for index in np.indices((RIG.height_px, RIG.width_px)))
    (cu, cv), f = RIG.center_px, RIG.focal_px
    for x_m, t_s in ((-30.0, 0.0), (-22.0, -1.0)):
        renderer.move_to(t_s)
        solids = [(k, solid) for k, its in enumerate(scene.things, 1) for solid in solids_at(its, t_s)]
        pose = pose_at(x_m)
        rays = np.stack([(u - cu) / f, (v - cv) / f, np.ones(len(u))], axis=1) @ pose[:3, :3].T
        found = [meets(solid, pose[:3, 3], rays) for _, solid in solids]
        reach = np.array([near for near, _ in found])
        which, depth_m = reach.argmin(axis=0), reach.min(axis=0)
        label = np.where(np.isfinite(depth_m), np.array([k for k, _ in solids])[which], 0)
        view = renderer.view(pose)
        same = view.label.ravel() == label
        assert set(np.unique(label)) == set(range(9))
        assert same.mean() > 0.998
        assert np.all(np.isinf(view.depth_m) == (view.label == 0))
        seen = same & (label > 0)
        assert np.quantile(np.abs(view.depth_m.ravel()[seen] / depth_m[seen] - 1), 0.99) < 1e-3

        normal = np.array([normals for _, normals in found])[which, np.arange(len(u))]
        normal *= -np.sign(np.einsum("ij,ij->i", normal, rays))[:, None]
        plain = seen & np.isin(label, [2, 5, 6])  # the ball, the box, the mast
        expected = 0.5 / np.pi * scene.sun_irradiance * np.maximum(normal @ sun, 0)
        for k in np.flatnonzero(plain):
            start = pose[:3, 3] + depth_m[k] * rays[k] + 1e-3 * normal[k]
            if any(np.isfinite(meets(solid, start, sun[None])[0][0]) for _, solid in solids):
                expected[k] = 0.0
        errors = np.abs(renderer.radiance(pose).ravel() - expected)[plain]
        assert plain.sum() > 300 and np.median(errors) < 0.005 and np.quantile(errors, 0.9) < 0.05


def test_the_cameras_share_what_they_see() -> None:
    """A fine texture far away, where a pixel covers many of its specks: between the cameras, after the
    disparity is undone, about 0.16 of the contrast differs, which is resampling. Single rays make it 0.40:
    they find other specks in each."""
    texture = blotches(seed_of("shared"), 800, 480)
    ground = thing(
        "ground", "ground", [GroundStrip("g", (-10.0, 150.0), (-48.0, 48.0), texture)], standing=False
    )
    renderer = Renderer(Scene((ground,), to_sun=(0.0, 0.0, 1.0), sky="overcast"), RIG)
    left, right = (renderer.radiance(pose_at(-20.0, camera)) for camera in (LEFT, RIGHT))
    disparity = RIG.focal_px * RIG.baseline_m / renderer.view(pose_at(-20.0)).depth_m
    rows = slice(75, 110)
    u = np.arange(RIG.width_px)
    moved = np.stack([np.interp(u - disparity[v, 0], u, right[v]) for v in range(rows.start, rows.stop)])
    inside = slice(10, -10)
    difference = (left[rows] - moved)[:, inside].std()
    assert left[rows, inside].std() > 0.03
    assert difference < 0.25 * left[rows, inside].std()


@pytest.mark.slow
def test_what_is_too_fine_becomes_grey() -> None:
    chequers = np.indices((2000, 2000)).sum(axis=0) % 2
    wall = thing("wall", "wall", [board("wall", (0.0, 0.0, 6.0), 20.0, 20.0, chequers.astype(np.float32))])
    scene = Scene((wall,), to_sun=(-1.0, 0.0, 0.0), fill_irradiance=0.0)
    radiance = Renderer(scene, RIG).radiance(pose_at(-20.0))
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
    renderer, pose = Renderer(scene, RIG), pose_at(-20.0)
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
    Course(ALTITUDE_M, 9.0, last_range_m=25.0, frames=2, rate_hz=10.0),
    everything,
    rig=RIG,
    family="everything",
)


def bytes_of(out: Path) -> dict[str, bytes]:
    assert list(render_flight(FLIGHT, out)) == [0, 1]
    return {
        str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()
    }


@pytest.mark.slow
def test_a_flight_is_the_same_whoever_renders_it(tmp_path: Path) -> None:
    """Here, and in two processes at the same time."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        elsewhere = list(pool.map(bytes_of, [tmp_path / "a", tmp_path / "b"]))
    here = bytes_of(tmp_path / "c")
    assert here == elsewhere[0] == elsewhere[1]
    assert b'"family": "everything"' in here["truth.json"]
