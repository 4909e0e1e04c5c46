"""The plane of the ground below, against planes set up in space: found below things, and not elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import LEVEL_UP, Stages, camera, plane_disparity, words_of


def rays_of_cells(stages: Stages) -> np.ndarray:
    f, c = stages.foveation, stages.camera
    x, y = (f.center_u - c.center_u_px) / c.focal_px, (f.center_v - c.center_v_px) / c.focal_px
    return np.stack([x, y, np.ones_like(x)], axis=-1).astype(float)


def disparity_of(stages: Stages, normal, height_m: float) -> np.ndarray:
    """The disparities of the plane normal . P = height_m at every cell's centre; not above 0 where it is not
    seen."""
    scale = stages.camera.focal_px * stages.camera.baseline_m
    return scale * (rays_of_cells(stages) @ np.asarray(normal, float)) / height_m


def tilted(degrees: float, towards_deg: float) -> np.ndarray:
    """Normal, pointing down, of a plane that leans from the horizontal."""
    tilt, towards = np.radians([degrees, towards_deg])
    return np.array([np.sin(tilt) * np.cos(towards), np.cos(tilt), np.sin(tilt) * np.sin(towards)])


def found_px(stages: Stages) -> np.ndarray:
    """Disparity of the plane that was found, at every cell."""
    s, c, f = stages.surfaces, stages.camera, stages.foveation
    assert s.ground_found
    u, v = f.center_u - c.center_u_px, f.center_v - c.center_v_px
    return s.ground.offset + s.ground.slope_u * u + s.ground.slope_v * v


def set_cells(stages: Stages, disparity_px: np.ndarray) -> None:
    stages.disparity_px[:] = np.where(disparity_px > 0, disparity_px, -1)


def things(stages: Stages, random: np.random.Generator, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Which cells show boards of 24 px width that face the camera, and each one's disparity as a share of the
    ground's at the lower edge of the image, times 3."""
    f = stages.foveation
    column = (f.center_u // 24).astype(int)
    chosen = random.random(column.max() + 1) < share
    return chosen[column], random.uniform(1.5, 4.0, chosen.size)[column]


@pytest.mark.parametrize(("most_deg", "share"), [(10.0, 0.3), (6.0, 0.6)])
def test_the_ground_is_found_below_things_that_hide_it(most_deg: float, share: float) -> None:
    """Planes that lean, noise of 0.2 px, boards over that share of the image: found within 0.5 px over all
    cells that show it, in four scenes of five; where only slivers of ground remain, others are as likely."""
    random = seeded(1)
    errors_px = []
    for _ in range(60):
        stages = Stages(camera())
        normal, height_m = (
            tilted(random.uniform(0, most_deg), random.uniform(0, 360)),
            random.uniform(1.5, 5.0),
        )
        ground = disparity_of(stages, normal, height_m)
        hidden, nearer = things(stages, random, share)
        foot_px = ground[stages.foveation.center_v > 200].mean() * nearer / 3
        stands = hidden & (ground < foot_px)  # a board has one disparity, from its foot up
        disparity = np.where(stands, foot_px, ground) + random.normal(0, 0.2, ground.size)
        known = disparity < 60
        set_cells(stages, np.where(known, disparity, -1.0))
        stages.find_surfaces()
        shown = known & ~stands & (ground > 2.0)
        found = stages.surfaces.ground_found
        errors_px.append(np.abs(found_px(stages) - ground)[shown].max() if found else np.inf)
    assert np.median(errors_px) < 0.25
    assert np.quantile(errors_px, 0.8) < 0.5


def test_a_wall_that_fills_the_image_is_no_ground() -> None:
    """It is 5 to 16 m away: farther off, noise of 0.1 px makes it seem to lean, and its foot may pass for
    ground."""
    random = seeded(2)
    for _ in range(30):
        stages = Stages(camera())
        disparity = np.full(stages.foveation.node_count, random.uniform(12, 40))
        set_cells(stages, disparity + random.normal(0, 0.1, disparity.size))
        stages.find_surfaces()
        assert not stages.surfaces.ground_found


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_a_table_above_the_floor_is_not_the_floor(share: float) -> None:
    """It is level, too, and covers that share of the image's width below the horizon."""
    random = seeded(3)
    for _ in range(20):
        stages = Stages(camera())
        floor = disparity_of(stages, (0, 1, 0), 1.6)
        table = disparity_of(stages, (0, 1, 0), 0.9)
        from_u = random.uniform(0, 320 * (1 - share))
        on_table = (stages.foveation.center_u > from_u) & (stages.foveation.center_u < from_u + 320 * share)
        on_table &= (stages.foveation.center_v > 150) & (stages.foveation.center_v < 215)
        disparity = np.where(on_table, table, floor) + random.normal(0, 0.1, floor.size)
        set_cells(stages, np.where(floor > 1.0, disparity, -1.0))
        stages.find_surfaces()
        below = floor > 2.0
        assert np.abs(found_px(stages) - floor)[below].max() < 0.5
        assert not stages.horizontal[on_table & (stages.foveation.center_v > 165)].any()


def test_a_platform_that_shows_more_than_the_ground_is_not_the_ground() -> None:
    """It covers six tenths of what is below the horizon. No cell lies below the ground; those of the ground
    lie below the platform."""
    stages = Stages(camera())
    ground, platform = (disparity_of(stages, (0, 1, 0), height_m) for height_m in (2.0, 1.0))
    u = stages.foveation.center_u
    set_cells(stages, np.where(ground > 1.0, np.where(u > 0.4 * 320, platform, ground), -1.0))
    stages.find_surfaces()
    assert np.abs(found_px(stages) - ground)[ground > 2.0].max() < 0.5


def test_the_sky_has_no_ground() -> None:
    random = seeded(4)
    stages = Stages(camera())
    above = (
        stages.foveation.center_v < stages.camera.center_v_px - 110
    )  # 15 degrees and more above the horizon
    nothing = np.full(above.size, -1.0)
    for disparity in (nothing, np.where(above, 3.0 + random.normal(0, 0.2, above.size), -1.0)):
        set_cells(stages, disparity)
        stages.find_surfaces()
        assert not stages.surfaces.ground_found


def test_a_ceiling_is_no_ground() -> None:
    stages = Stages(camera())
    set_cells(stages, disparity_of(stages, (0, -1, 0), 2.0))
    stages.find_surfaces()
    assert not stages.surfaces.ground_found


def test_a_frame_gives_the_same_plane_whatever_came_before() -> None:
    random = seeded(5)
    first, second = Stages(camera()), Stages(camera())
    ground = disparity_of(first, tilted(4.0, 30.0), 2.0)
    noisy = ground + random.normal(0, 0.5, ground.size)
    set_cells(second, random.uniform(0, 60, ground.size))
    second.find_surfaces(LEVEL_UP)
    planes = []
    for stages in (first, second, second):
        set_cells(stages, noisy)
        stages.find_surfaces()
        s = stages.surfaces
        planes.append((s.ground_found, s.ground.offset, s.ground.slope_u, s.ground.slope_v))
    assert planes[0] == planes[1] == planes[2]
    assert planes[0][0]


def test_near_the_camera_lower_things_stand() -> None:
    """A box 4 m away, 1 m below the camera: a limit in metres is at most 6 % of the range, so 0.24 m and not
    0.35 m above the ground its cells stand."""
    stages = Stages(camera())
    disparity = np.maximum(plane_disparity(stages.camera, (0, 1, 0), (0, 1, 0)), 0.5)
    foot_row = 120 + 400.0 * 1.0 / 4.0  # f y / z
    v, u = np.mgrid[:240, :320]
    disparity[(v <= foot_row) & (v > foot_row - 60) & (np.abs(u - 160) < 60)] = 50.0  # f B / z; 0.6 m high
    stages.foveate(np.full((240, 320), 90, np.uint8), words_of(disparity))
    stages.find_surfaces(LEVEL_UP)
    assert stages.surfaces.ground_found
    f = stages.foveation
    height_m = (foot_row - f.center_v) * 4.0 / 400.0
    inside = (np.abs(f.center_u - 160) < 45) & (stages.disparity_px > 49.5)
    at_limit = inside & (height_m > 0.28) & (height_m < 0.32)
    assert np.any(at_limit) and not np.any(stages.horizontal[at_limit])
    assert np.all(stages.horizontal[inside & (height_m > 0.05) & (height_m < 0.2)])
