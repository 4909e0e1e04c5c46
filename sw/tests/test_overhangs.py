"""What has no texture and hangs above the ground: an aircraft that flies towards it sees that it does not
stand where its lower edge is seen."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from space_library import BASELINE_M, FOCAL_PX, HEIGHT, SPACE_FRAMES, WIDTH, Look, Space, Wall, scene
from stage_library import INVALID, camera, ffi, lib

GROUND_Y_M, BRIGHT, DARK = 3.0, 160, 90


def picture(look: Look) -> np.ndarray:
    """Bright where something is matched, dark where nothing is."""
    return np.where(look.words > 0, BRIGHT, DARK).astype(np.uint8)


def approach(walls, ways_m, sway=None, lens=None, noise=None, **given) -> Space:
    """A space that has seen the walls from these places along the way, at 10 Hz. sway: rotation of each."""
    space = Space(lens)
    for k, way_m in enumerate(ways_m):
        look = scene(
            walls,
            GROUND_Y_M,
            (0.0, 0.0, way_m),
            None if sway is None else sway[k].as_matrix(),
            lens=lens,
        )
        image = picture(look)
        if noise is not None:
            lone = noise.random(look.words.shape) < 0.01
            look.words[lone] = noise.integers(16, 16 * 40, np.count_nonzero(lone))
        space.take(look, 0.1 * k, image=image, **given)
    return space


BEAM = Wall(20.0, (-30.0, 30.0), (-8.0, 1.5), textured=False)
WALL = Wall(20.0, (-30.0, 30.0), (-8.0, GROUND_Y_M), textured=False)


def seen_through(space: Space, way_m: float, x_m: float = 0.0) -> float:
    """How much is seen through of a place half of the way to the beam, all of which lies before the beam."""
    ahead_m = 0.5 * (BEAM.z_m - way_m)
    return space.look((x_m, 0.0, way_m + ahead_m), 0.1 * ahead_m).beyond_newest


@pytest.mark.parametrize("width", [WIDTH, 2 * WIDTH])
@pytest.mark.parametrize("way", [(4.0, 9.0), (7.0, 11.0), (10.5, 12.0)])
def test_a_plain_beam_that_is_flown_to_is_not_seen_through(width: int, way: tuple[float, float]) -> None:
    """A wall at the same place stands where it is seen to."""
    times = width // WIDTH
    lens = camera(width, times * HEIGHT, times * FOCAL_PX, BASELINE_M)
    ways = np.linspace(*way, SPACE_FRAMES)
    space = approach([BEAM], ways, lens=lens)
    assert seen_through(space, way[1]) < 0.1
    space = approach([WALL], ways, lens=lens)
    assert seen_through(space, way[1]) > 0.9


def test_before_an_aircraft_has_moved_a_beam_may_be_a_wall() -> None:
    """Once it has moved, it remembers while it stands, until it turns away."""
    ways = [9.0] * SPACE_FRAMES
    assert seen_through(approach([BEAM], ways), 9.0) > 0.9
    ways = [*np.linspace(5.0, 9.0, SPACE_FRAMES), *([9.0] * 30)]
    assert seen_through(approach([BEAM], ways), 9.0) < 0.1


def test_what_one_frame_alone_says_of_an_overhang_is_not_believed() -> None:
    """Ground that fades now here, now there may look like ground behind a beam. Half a beam stays one."""
    beam = Wall(20.0, (-30.0, 0.0), (-8.0, 1.5), textured=False)
    ways = np.linspace(5.0, 11.0, 9)
    hidden, believed = [], []
    for count in range(1, len(ways) + 1):
        ahead_m = 0.5 * (beam.z_m - ways[count - 1])
        place = (0.0, 0.0, ways[count - 1] + ahead_m)
        found = approach([beam], ways[:count]).look(place, 0.1 * ahead_m)
        hidden.append(found.beyond_newest < 0.7)
        believed.append(found.overhung > 0.2)
    assert sum(hidden) > 2 and believed == [False, *hidden[:-1]]


def test_noise_and_a_camera_that_sways() -> None:
    """Words by chance in the beam and in the wall. Most frames know of the beam, none doubts the wall."""
    random = seeded(1)
    beams, walls = [], []
    for _ in range(30):
        ways = np.linspace(3.0, 8.0, 8)
        sway = Rotation.from_euler("zyx", random.uniform(-12.0, 12.0, (8, 3)) * (1.0, 0.5, 0.5), degrees=True)
        beams.append(seen_through(approach([BEAM], ways, sway, noise=random), 8.0))
        walls.append(seen_through(approach([WALL], ways, sway, noise=random), 8.0))
    assert np.mean(np.array(beams) < 0.1) > 0.5
    assert min(walls) > 0.8


def test_a_beam_is_marked_along_its_edge_before_whatever_is_behind() -> None:
    """A house behind one half of it hides the ground there."""
    house = Wall(45.0, (0.5, 60.0), (-20.0, GROUND_Y_M))
    space = approach([BEAM, house], np.linspace(5.0, 9.0, SPACE_FRAMES))
    for x_m in (-3.0, 3.0):
        assert seen_through(space, 9.0, x_m) < 0.1


@pytest.mark.parametrize(("above", "hangs"), [(BRIGHT, False), (DARK, True)])
def test_where_no_edge_of_brightness_begins_it_is_ground_that_fades(above: int, hangs: bool) -> None:
    """How far the ground is matched differs from frame to frame, as it does in haze."""
    space = Space()
    for k, way_m in enumerate(np.linspace(5.0, 9.0, SPACE_FRAMES)):
        look = scene((), GROUND_Y_M, (0.0, 0.0, way_m))
        matched_m = 12.0 if k == SPACE_FRAMES - 1 else 20.0
        ends = HEIGHT // 2 + round(FOCAL_PX * GROUND_Y_M / matched_m)
        look.words[:ends] = INVALID
        image = np.full((HEIGHT, WIDTH), BRIGHT, np.uint8)
        image[:ends] = above
        space.take(look, 0.1 * k, image=image)
    assert (seen_through(space, 9.0) < 0.1) == hangs


def test_a_patch_of_ground_that_is_not_matched_hangs_nowhere() -> None:
    """It was matched before, and does not reach the horizon."""
    space = Space()
    for k, way_m in enumerate(np.linspace(5.0, 9.0, SPACE_FRAMES)):
        look = scene((), GROUND_Y_M, (0.0, 0.0, way_m))
        image = picture(look)
        if k == SPACE_FRAMES - 1:
            look.words[160:190, 100:220] = INVALID
            image[160:190, 100:220] = DARK
        space.take(look, 0.1 * k, image=image)
    newest = lib.vista_space_map_frame(space.handle, 0)
    kinds = np.frombuffer(ffi.buffer(newest.kind, newest.width * newest.height), np.uint8)
    assert lib.VISTA_SIGHT_BOUNDED in kinds and lib.VISTA_SIGHT_OVERHANG not in kinds
