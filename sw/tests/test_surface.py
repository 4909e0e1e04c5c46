"""Inclinations and the ground against planes set up in space, for cameras held at any angle."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import (
    INVALID,
    LEVEL_UP,
    Stages,
    camera,
    ffi,
    lib,
    plane_disparity,
    rays,
    words_of,
)


def unit(vector) -> np.ndarray:
    return np.asarray(vector, float) / np.linalg.norm(vector)


def lean_deg(normal, up) -> float:
    """The angle from the vertical: a wall's normal is level, the ground's points up."""
    return np.degrees(np.pi / 2 - np.arccos(np.clip(abs(unit(normal) @ unit(up)), 0, 1)))


def roll(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def random_plane(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Normal and a point before the camera, 4 to 40 m away."""
    return unit(random.normal(size=3)), np.array([*random.uniform(-3, 3, 2), random.uniform(4, 40)])


@pytest.mark.same_c
def test_the_inclination_of_a_plane_is_that_of_its_normal() -> None:
    random = seeded(1)
    view = camera(320, 240, focal=random.uniform(100, 1000), baseline=random.uniform(0.05, 1.0))
    compared = 0
    while compared < 300:
        normal, point = random_plane(random)
        up = unit(random.normal(size=3))
        disparity = plane_disparity(view, normal, point)
        v, u = (int(x) for x in random.integers(0, (239, 319)))
        patch = disparity[v : v + 2, u : u + 2]
        if patch.min() <= 0.1 or patch.max() > 200:
            continue
        slope_u, slope_v = patch[0, 1] - patch[0, 0], patch[1, 0] - patch[0, 0]
        up_camera = ffi.new("double[3]", up.tolist())
        found = lib.vista_plane_inclination_deg(view, up_camera, u, v, patch[0, 0], slope_u, slope_v)
        assert found == pytest.approx(lean_deg(normal, up), abs=0.01)
        compared += 1


def test_a_degenerate_plane_has_no_inclination() -> None:
    up = ffi.new("double[3]", LEVEL_UP)
    assert np.isnan(lib.vista_plane_inclination_deg(camera(), up, 10, 20, 0.0, 0.0, 0.0))


def set_plane(stages: Stages, normal, point) -> None:
    """The plane's exact disparity at every cell's centre; none where it is not seen."""
    f, c = stages.foveation, stages.camera
    ray = np.stack(
        [
            (f.center_u - c.center_u_px) / c.focal_px,
            (f.center_v - c.center_v_px) / c.focal_px,
            np.ones_like(f.center_u),
        ],
        axis=-1,
    ).astype(float)
    disparity = c.focal_px * c.baseline_m * (ray @ normal) / (normal @ point)
    stages.disparity_px[:] = np.where(disparity > 0, disparity, -1)


def test_cells_on_an_exact_plane_lean_as_it_does() -> None:
    random = seeded(2)
    stages = Stages(camera(160, 120))
    for _ in range(50):
        (normal, point), up = random_plane(random), unit(random.normal(size=3))
        set_plane(stages, normal, point)
        stages.find_surfaces(up)
        known = stages.inclination_deg >= 0
        assert np.all(stages.disparity_px[known] >= 0)
        # disparities are floats: cells a pixel apart at a slope of 1/1000 keep three digits of it
        clear = known & (stages.disparity_px < 100) & (stages.foveation.size_px > 2)
        if abs(normal @ point) > 1.0:
            assert np.allclose(stages.inclination_deg[clear], lean_deg(normal, up), atol=0.2)


LEVER_PX = 8.0  # of inclination.c


def test_any_cell_takes_the_least_squares_plane_of_its_neighbours() -> None:
    """numpy's, over the cell and those in the eight directions; less than five make no plane."""
    random = seeded(4)
    stages = Stages(camera(160, 120))
    f, c, up = stages.foveation, stages.camera, unit((0.2, -1, 0.1))
    stages.disparity_px[:] = random.uniform(5, 20, f.node_count)
    stages.disparity_px[random.random(f.node_count) < 0.3] = -1
    stages.find_surfaces(up)
    grid = f.node_of_grid
    compared = 0
    for ring in range(1, grid.shape[0] - 1):
        for sector in range(grid.shape[1]):
            node = grid[ring, sector]
            if node < 0 or f.size_px[node] < 1.5 or stages.disparity_px[node] < 0:
                continue
            steps = int(np.ceil(LEVER_PX / f.size_px[node]))
            if not steps <= ring < grid.shape[0] - steps or steps > 4:
                continue  # near the hub the library compares what lies closer
            rings, sectors = (at + steps * np.arange(-1, 2) for at in (ring, sector))
            around = grid[rings].take(sectors, axis=1, mode="wrap").ravel()
            around = around[around >= 0]
            around = around[stages.disparity_px[around] >= 0]
            if around.size < 5:
                assert stages.inclination_deg[node] < 0
                continue
            offsets = np.stack([f.center_u[around], f.center_v[around]]) - [[c.center_u_px], [c.center_v_px]]
            system = np.column_stack([*offsets, np.ones(around.size)])
            slope_u, slope_v, at_center = np.linalg.lstsq(system, stages.disparity_px[around])[0]
            found = lean_deg((slope_u, slope_v, at_center / c.focal_px), up)
            assert stages.inclination_deg[node] == pytest.approx(found, abs=0.05)
            compared += 1
    assert compared > 300


PLANES = {
    "ground": ((0, 1, 0), (0, 3, 10)),
    "wall ahead": ((0, 0, 1), (0, 0, 5)),
    "wall at an angle": ((np.sin(0.7), 0, np.cos(0.7)), (0, 0, 6)),
    "wall along the way": ((1, 0, 0.1), (-2, 0, 5)),
    "ramp of 45 deg": ((0, 1, 1), (0, 0, 6)),
    "ceiling": ((0, 1, 0), (0, -3, 10)),
}


@pytest.mark.parametrize("roll_deg", [0, 20, -90, 180])
@pytest.mark.parametrize("name", PLANES)
def test_cells_of_a_rendered_plane_lean_as_it_does(name: str, roll_deg: float) -> None:
    """Words are rounded to 1/16 px, and the camera may be rolled with the up vector known."""
    stages = Stages(camera())
    turned = roll(roll_deg)
    up = turned @ LEVEL_UP
    normal, point = (turned @ np.asarray(x, float) for x in PLANES[name])
    disparity = plane_disparity(stages.camera, normal, point)
    words = np.where(disparity < 60, words_of(disparity), INVALID).astype(np.int16)
    stages.foveate(np.full(words.shape, 90, np.uint8), words)
    stages.find_surfaces(up)

    f = stages.foveation
    inside = (f.size_px > 4) & (stages.disparity_px > 8) & (stages.disparity_px < 50)
    inside &= (np.abs(f.center_u - 159.5) < 100) & (np.abs(f.center_v - 119.5) < 70)
    inside &= stages.inclination_deg >= 0
    assert np.count_nonzero(inside) > 30
    true_deg = lean_deg(normal, up)
    error = np.abs(stages.inclination_deg[inside] - true_deg)
    assert np.median(error) < 1.0 and np.quantile(error, 0.9) < 3.0
    assert np.mean(stages.horizontal[inside] == (true_deg > 60)) > 0.98


def test_cells_without_disparity_have_no_inclination() -> None:
    stages = Stages(camera(160, 120))
    set_plane(stages, *(np.asarray(x, float) for x in PLANES["ground"]))
    gone = np.arange(stages.foveation.node_count) % 5 == 0
    stages.disparity_px[gone] = -1
    stages.find_surfaces()
    assert np.all(stages.inclination_deg[gone] < 0)
    assert not stages.horizontal[gone].any()
    stages.disparity_px[:] = -1
    stages.find_surfaces()
    assert np.all(stages.inclination_deg < 0)
    assert not stages.horizontal.any()
    assert not stages.surfaces.ground_found


def test_the_ground_is_found_below_what_stands_on_it() -> None:
    """A box before it, and a tenth of the disparities wrong."""
    random = seeded(3)
    for height_m, roll_deg in ((1.5, 0), (3.0, 15), (6.0, -30)):
        stages = Stages(camera())
        turned = roll(roll_deg)
        normal = turned @ np.array([0.0, 1.0, 0.0])
        ground = plane_disparity(stages.camera, normal, normal * height_m)
        disparity = np.where(ground > 60, -1, ground)
        disparity[100:200, 120:180] = 18.0
        wrong = random.random(disparity.shape) < 0.1
        disparity[wrong] = random.uniform(0.1, 60, np.count_nonzero(wrong))
        stages.foveate(np.full(disparity.shape, 90, np.uint8), words_of(disparity))
        stages.find_surfaces(turned @ LEVEL_UP)
        s = stages.surfaces
        assert s.ground_found
        gradient = stages.camera.baseline_m / height_m * normal  # d = f B (n . ray) / h
        assert (s.ground.slope_u, s.ground.slope_v) == pytest.approx(tuple(gradient[:2]), abs=0.01)
        assert s.ground.offset == pytest.approx(0.0, abs=0.5)


def test_what_rises_from_the_ground_stands_and_the_noisy_ground_does_not() -> None:
    """A bale of 1.5 m, seen from 6.4 m above a meadow: its upper half is 1 to 2 px in front of the ground."""
    random = seeded(5)
    stages = Stages(camera(640, 480, focal=1000.0, baseline=0.4572))
    ground = plane_disparity(stages.camera, np.array([0.0, 1.0, 0.0]), np.array([0.0, 6.4, 0.0]))
    bale_px, foot_v = 10.0, 239.5 + 1000 * 6.4 / 45.72
    rows, columns = slice(round(foot_v - 1.5 / 45.72 * 1000), round(foot_v)), slice(300, 340)
    disparity = ground.copy()
    disparity[rows, columns] = bale_px
    stages.foveate(np.full(disparity.shape, 90, np.uint8), words_of(disparity, random, sigma_px=0.2))
    stages.find_surfaces()
    horizontal = stages.horizontal[stages.foveation.cell_of_pixel] != 0
    upper = slice(rows.start + 8, (rows.start + rows.stop) // 2)  # a cell is 6 px wide
    assert not horizontal[upper, 308:332].any()
    meadow = np.ones(disparity.shape, bool)
    meadow[:280] = False
    meadow[rows.start - 12 : rows.stop + 12, 288:352] = False
    assert horizontal[meadow].mean() > 0.999
    assert stages.disparity_px.max() > bale_px  # the meadow before the bale is nearer than the bale


def test_walls_are_no_ground() -> None:
    stages = Stages(camera())
    for name in ("wall ahead", "wall at an angle"):
        set_plane(stages, *(np.asarray(x, float) for x in PLANES[name]))
        stages.find_surfaces()
        assert not stages.surfaces.ground_found


def test_rays_meet_the_pixels_that_they_came_from() -> None:
    """The reference itself: a point on a plane projects to the pixel whose ray met it, with its disparity."""
    c = camera()
    normal, point = unit((0.3, -0.5, 0.8)), np.array([0.4, 0.2, 7.0])
    disparity = plane_disparity(c, normal, point)
    spot = rays(c)[30, 200] * c.focal_px * c.baseline_m / disparity[30, 200]
    assert normal @ (spot - point) == pytest.approx(0, abs=1e-9)
    assert c.focal_px * spot[:2] / spot[2] + (159.5, 119.5) == pytest.approx((200, 30))
