"""What the map of space shows of a place, against what geometry says of simple worlds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pipeline_library import plain
from random_seed import seeded
from scipy.spatial.transform import Rotation
from space_library import (
    BASELINE_M,
    FOCAL_PX,
    HEIGHT,
    RADIUS_M,
    SPACE_FRAMES,
    SPACING_S,
    UNMATCHED,
    WIDTH,
    Look,
    Space,
    Wall,
    disparity_px,
    scene,
    tolerances_off_m,
)
from stage_library import INVALID, camera, ffi, lib
from track_library import matched, pose


def shown_by(look: Look, point, radius_m: float = RADIUS_M, **given):
    space = Space()
    space.watch(look, **given)
    return space.look(point, radius_m)


# ---- one view ----


DISC, BALL = 20, 12  # lines of sight across, at most


def shares_of(space: Space, point: np.ndarray, radius_m: float, across: int) -> tuple[float, float]:
    """Shares of the lines of sight to a disc or a ball: in the picture, and going on, of those that are."""
    e, lens = lib.vista_space_map_frame(space.handle, 0), space.camera
    kind = np.frombuffer(ffi.buffer(e.kind, e.width * e.height), np.uint8).reshape(e.height, e.width)
    word = np.frombuffer(ffi.buffer(e.word, 2 * e.width * e.height), np.int16).reshape(e.height, e.width)
    x_m, y_m, z_m = point
    u = (lens.center_u_px + lens.focal_px * x_m / z_m) / e.step_px
    v = (lens.center_v_px + lens.focal_px * y_m / z_m) / e.step_px
    fits_m = min(radius_m, 0.5 * z_m) if across == BALL else radius_m
    reach = lens.focal_px * fits_m / z_m / e.step_px
    step = max(1.0, 2.0 * reach / across)
    x, y = np.meshgrid(*2 * [np.arange(-reach + 0.5 * step, reach, step)])
    in_disc = np.hypot(x, y) < reach
    column, row = (np.floor(axis[in_disc] + at + 0.5).astype(int) for axis, at in ((x, u), (y, v)))
    inside = (column >= 0) & (column < e.width) & (row >= 0) & (row < e.height)
    kind, word = kind[row[inside], column[inside]], word[row[inside], column[inside]]
    told = kind != lib.VISTA_SIGHT_OUTSIDE
    wanted_px = disparity_px(lens, z_m + (radius_m if across == BALL else 0.0))
    on = (kind < lib.VISTA_SIGHT_HANGING) & (word < 16.0 * (wanted_px - max(0.75, 0.03 * wanted_px)))
    return float(told.sum() / in_disc.sum()), float(on.sum() / max(told.sum(), 1))


def test_a_place_is_looked_at_through_its_disc_in_the_picture_up_to_the_border() -> None:
    random, compared = seeded(12), 0
    for _ in range(5):
        space = Space()
        walls = [Wall(random.uniform(4.0, 20.0), sorted(random.uniform(-6.0, 6.0, 2))) for _ in range(6)]
        space.take(scene([*walls, Wall(40.0)]), 0.1)
        for _ in range(80):
            z_m, radius_m = random.uniform(2.5, 30.0), random.uniform(0.5, 2.0)
            point = z_m * np.array([random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), 1.0])
            found = {BALL: space.look_around(point, radius_m), DISC: space.look(point, radius_m)}
            for across, least in ((BALL, 0.6), (DISC, 0.25)):
                in_picture, on = shares_of(space, point, radius_m, across)
                if abs(in_picture - least) < 0.02:
                    continue  # one line of sight more or less decides
                assert found[across].frames == (in_picture > least)
                if found[across].frames:
                    assert found[across].beyond_newest == pytest.approx(on, abs=1e-12)
                    compared += 1
    assert compared > 200


@pytest.mark.parametrize("width", [WIDTH, 1280])
def test_a_wall_is_at_its_range_and_not_three_tolerances_off(width: int) -> None:
    """There is room to see through before it; behind it nothing is known."""
    random = seeded(1)
    for _ in range(8):
        lens = camera(width, HEIGHT, random.uniform(300.0, 600.0), random.uniform(0.2, 0.6))
        z_m = lens.focal_px * lens.baseline_m / random.uniform(5.0, 20.0)
        radius_m = 6.0 * (width / 320) * z_m / lens.focal_px  # of the picture that the map keeps, 6 px
        space = Space(lens)
        space.watch(scene([Wall(z_m)], lens=lens))
        at = space.look((0.0, 0.0, z_m), radius_m)
        assert (at.frames, at.votes, at.feet, at.beyond, at.age) == (SPACE_FRAMES, SPACE_FRAMES, 0, 0.0, 0)
        assert at.disparity_px == pytest.approx(disparity_px(lens, z_m), abs=1 / 16)
        assert at.spread_px <= 1e-6
        middle = (lens.center_u_px, lens.center_v_px)
        assert (at.u_px, at.v_px) == pytest.approx(middle, abs=2.0 + lens.width_px / 320)
        before = space.look((0.0, 0.0, tolerances_off_m(lens, z_m, -3.0)), radius_m)
        assert (before.frames, before.votes, before.feet, before.beyond) == (SPACE_FRAMES, 0, 0, 1.0)
        behind = space.look((0.0, 0.0, tolerances_off_m(lens, z_m, 3.0)), radius_m)
        assert (behind.frames, behind.votes, behind.feet, behind.beyond) == (SPACE_FRAMES, 0, 0, 0.0)


def test_what_is_seen_through_is_the_share_that_nothing_nearer_covers() -> None:
    """A place at 20 m, behind its right part a wall at 40 m, before its left part one at 10 m."""
    random = seeded(2)
    for _ in range(10):
        edge_m = random.uniform(-0.9, 0.9)
        walls = [Wall(10.0, x_m=(-50.0, edge_m / 2)), Wall(40.0)]
        share = (np.arccos(edge_m) - edge_m * np.sqrt(1.0 - edge_m**2)) / np.pi  # of a disc, beyond a chord
        found = shown_by(scene(walls), (0.0, 0.0, 20.0), 1.0)
        assert found.beyond == pytest.approx(share, abs=0.06)
        assert found.votes == 0


def test_a_few_words_are_no_vote() -> None:
    """One line of sight in a hundred, scattered over the place."""
    v, u = np.indices((HEIGHT, WIDTH))
    words = np.where((u % 10 == 0) & (v % 10 == 0), 16 * FOCAL_PX * BASELINE_M / 20.0, 16).astype(np.int16)
    look = Look(words, UNMATCHED.ground, pose())
    found = shown_by(look, (0.0, 0.0, 20.0))
    assert found.votes == 0 and found.beyond > 0.95
    assert shown_by(scene([Wall(20.0)]), (0.0, 0.0, 20.0)).votes == SPACE_FRAMES


@pytest.mark.parametrize("width", [WIDTH, 640])
def test_a_plain_wall_stands_on_ground_that_only_the_coarser_level_has_words_of(width: int) -> None:
    """A noisy image: chance matches of that level, which have no neighbours, bound nothing."""
    lens = camera(width, 240, 300.0, 0.8)
    seen = scene([Wall(20.0, textured=False)], ground_y_m=3.0, lens=lens)
    unmatched = Look(np.full_like(seen.words, INVALID), np.zeros_like(seen.ground), seen.pose)
    coarser = np.where(seen.words > 0, seen.words // 2, INVALID)[::2, ::2].astype(np.int16)
    alone = np.full_like(coarser, INVALID)
    alone[::8, ::8] = coarser[::8, ::8]
    for levels, feet in (([], 0), ([coarser], SPACE_FRAMES), ([alone], 0)):
        space = Space(lens)
        space.watch(unmatched, levels=[unmatched.words, *levels])
        assert space.look((0.0, 0.0, 20.0), 1.0).feet == feet
        assert space.look((0.0, 0.0, 14.0), 1.0).beyond == pytest.approx(feet / SPACE_FRAMES, abs=0.05)


@pytest.mark.parametrize("width", [WIDTH, 640, pytest.param(1280, marks=pytest.mark.slow)])
def test_a_wire_that_only_the_engine_has_words_of_is_at_its_range(width: int) -> None:
    """One row of words that the filters have dropped; in the others what is behind it, or nothing."""
    lens = camera(width, 240, 300.0, 0.8)
    for row in range(100, 104):
        for behind in (scene([Wall(60.0)], lens=lens), scene(ground_y_m=8.0, lens=lens)):
            own = behind.words.copy()
            own[row] = round(16.0 * disparity_px(lens, 30.0))
            place = (0.0, (row - lens.center_v_px) * 30.0 / lens.focal_px, 30.0)
            space = Space(lens)
            space.watch(behind, levels=[own])
            found = space.look(place, 1.0)
            assert found.votes == SPACE_FRAMES
            assert found.disparity_px == pytest.approx(disparity_px(lens, 30.0), abs=0.1)
            space.reset()
            space.watch(behind)
            assert space.look(place, 1.0).votes == 0


def test_what_only_the_engine_has_words_of_bounds_nothing() -> None:
    """Words by chance at the lower edge of the sky leave the sky as far away as the ground is there."""
    ground = scene(ground_y_m=5.0)
    own = ground.words.copy()
    own[118, ::3] = round(16.0 * FOCAL_PX * BASELINE_M / 15.0)
    found = shown_by(ground, (0.0, -4.0, 25.0), levels=[own])
    assert found.votes == 0 and found.beyond > 0.95


@pytest.mark.parametrize("columns", [1, 2])
def test_words_of_the_engine_in_small_groups_are_no_vote(columns: int) -> None:
    """The noise of the sky has such words, near enough for a place by the camera. A line of two columns is a
    vote."""
    random, behind = seeded(9), scene([Wall(60.0)])
    own = behind.words.copy()
    v, u = np.indices(own.shape)
    grouped = (v % 4 < 2) & (u % 4 < columns)
    chance = random.integers(16 * 20, 16 * 64, (own.shape[0] // 4 + 1, own.shape[1] // 4 + 1))
    own[grouped] = chance[v // 4, u // 4][grouped]
    near = (0.0, 0.0, FOCAL_PX * BASELINE_M / 40.0)
    space = Space()
    space.watch(behind, levels=[own])
    found = space.look_around(near, 2.0)
    assert (found.frames, found.votes) == (SPACE_FRAMES, 0)
    own[u % 4 < 2] = 16 * 40
    space.reset()
    space.watch(behind, levels=[own])
    assert space.look_around(near, 2.0).votes == SPACE_FRAMES


def test_sky_above_a_far_horizon_is_free() -> None:
    ground = scene(ground_y_m=5.0)
    for z_m in (10.0, 25.0, 50.0):
        found = shown_by(ground, (0.0, -4.0, z_m))
        assert (found.votes, found.feet) == (0, 0) and found.beyond > 0.95
    nothing = shown_by(UNMATCHED, (0.0, -4.0, 25.0))
    assert (nothing.frames, nothing.votes, nothing.feet, nothing.beyond) == (SPACE_FRAMES, 0, 0, 0.0)


def test_a_plain_wall_stands_where_its_foot_is_and_hides_what_is_behind_it() -> None:
    random = seeded(3)
    for _ in range(10):
        z_m = random.uniform(12.0, 35.0)
        space = Space()
        space.watch(scene([Wall(z_m, textured=False)], ground_y_m=3.0))
        at = space.look((0.0, 0.0, z_m))
        assert (at.frames, at.votes, at.feet) == (SPACE_FRAMES, 0, SPACE_FRAMES)
        assert at.disparity_px == pytest.approx(disparity_px(space.camera, z_m), abs=0.5)
        before = space.look((0.0, 0.0, tolerances_off_m(space.camera, z_m, -3.0)))
        assert (before.votes, before.feet) == (0, 0) and before.beyond > 0.9
        behind = space.look((0.0, 0.0, tolerances_off_m(space.camera, z_m, 3.0)))
        assert (behind.votes, behind.feet) == (0, 0) and behind.beyond < 0.1


MATCHED_TO_M, SKY_GREY = 60.0, 140


def hazy(look: Look) -> tuple[Look, np.ndarray]:
    """Its ground is matched up to MATCHED_TO_M, and lies deep below the horizon there; an image of ground
    that fades into the sky."""
    horizon, words = HEIGHT // 2, look.words.copy()
    words[: horizon + round(FOCAL_PX * 8.0 / MATCHED_TO_M)] = INVALID
    below = np.clip(np.arange(HEIGHT) - horizon, 0, None)
    image = np.repeat((SKY_GREY + below // 2).astype(np.uint8)[:, None], WIDTH, axis=1)
    return replace(look, words=words), image


def painted(image: np.ndarray, board: Wall, grey: int) -> np.ndarray:
    """The image with a plain board in it."""
    (left, right), (top, bottom) = (FOCAL_PX * np.array(side) / board.z_m for side in (board.x_m, board.y_m))
    rows = slice(max(round(HEIGHT / 2 + top), 0), round(HEIGHT / 2 + bottom))
    columns = slice(max(round(WIDTH / 2 + left), 0), round(WIDTH / 2 + right))
    image[rows, columns] = grey
    return image


NEAR_AND_FAR_M = (6.0, 10.0, 14.0)


@pytest.mark.parametrize(
    ("height_m", "grey"), [(20.0, 90), (20.0, 190), (3.0, SKY_GREY + 8), (3.0, SKY_GREY - 8)]
)
@pytest.mark.parametrize("spread_px", [0, 3])
def test_what_hangs_before_the_horizon_is_no_sky(height_m: float, grey: int, spread_px: int) -> None:
    """A plain board 15 m ahead whose lower edge is 1 m below the path: the ground that shows below it is far,
    as it is below the sky. It differs from the ground by far, or its upper edge can be seen. Words of the
    ground may reach beyond its lower edge."""
    board = Wall(15.0, (-6.0, 6.0), (-height_m, 1.0), textured=False)
    look, image = hazy(scene([board], ground_y_m=8.0))
    if spread_px:
        rows = slice(round(HEIGHT / 2 + FOCAL_PX / board.z_m) - spread_px, None)
        look.words[rows] = np.maximum(look.words[-1] // 8, look.words[rows])
    for z_m in NEAR_AND_FAR_M:
        assert shown_by(look, (0.0, 0.0, z_m), image=painted(image, board, grey)).beyond < 0.4


@pytest.mark.parametrize("off_px", [-2, 0, 2])
@pytest.mark.parametrize("width", [WIDTH, 2 * WIDTH])
def test_sky_above_ground_that_fades_is_free(width: int, off_px: int) -> None:
    """It is not where nobody saw whether it fades. The horizon is no edge, also when off by pixels."""
    times = width // WIDTH
    lens = camera(width, times * HEIGHT, times * FOCAL_PX, BASELINE_M / times)
    look, image = hazy(scene(ground_y_m=8.0))
    image[HEIGHT // 2 + off_px :] += 30
    words, ground, image = (
        np.kron(x, np.ones((times, times), x.dtype)) for x in (look.words, look.ground, image)
    )
    random = seeded(8)
    image = np.clip(np.rint(image + random.normal(0.0, 2.0, image.shape)), 0, 255).astype(np.uint8)
    for seen in (True, False):
        space = Space(lens)
        space.watch(Look(words, ground, look.pose), image=image, seen=seen, noise=2.0)
        for z_m in NEAR_AND_FAR_M:
            assert (space.look((0.0, 0.0, z_m)).beyond > 0.9) == seen


def test_haze_that_brightens_the_ground_up_to_the_horizon_is_no_edge() -> None:
    """It brightens by 30 grey levels in six rows. Where a board as bright as the sky begins, that ends."""
    look, image = hazy(scene(ground_y_m=8.0))
    below = np.clip(np.arange(HEIGHT) - HEIGHT // 2, 0, 40)
    image[:] = (220 - 5 * below)[:, None]
    for z_m in NEAR_AND_FAR_M:
        assert shown_by(look, (0.0, 0.0, z_m), image=image).beyond > 0.9
    image = painted(image, Wall(15.0, (-6.0, 6.0), (-20.0, 1.0)), 220)
    for z_m in NEAR_AND_FAR_M:
        assert shown_by(look, (0.0, 0.0, z_m), image=image).beyond < 0.4


def test_sky_above_hills_too_far_to_have_a_disparity_is_free() -> None:
    """The ground is matched up to MATCHED_TO_M only, and a row of trees there hides its horizon."""
    look, image = hazy(scene(ground_y_m=8.0))
    image[HEIGHT // 2 - 20 : HEIGHT // 2 - 12] = 60
    assert shown_by(look, (0.0, 0.0, 10.0), image=image).beyond < 0.4
    look.words[HEIGHT // 2 - 20 : HEIGHT // 2] = 0
    for z_m in NEAR_AND_FAR_M:
        assert shown_by(look, (0.0, 0.0, z_m), image=image).beyond > 0.9


def test_a_surface_to_fly_along_is_no_vote() -> None:
    """The same words are one where they are of something that stands."""
    ground = scene(ground_y_m=2.0)
    stands = Look(ground.words, np.zeros_like(ground.ground), ground.pose)
    for z_m in (10.0, 20.0, 30.0):
        place = (0.0, 2.0, z_m)
        assert shown_by(ground, place, 1.0).votes == 0
        assert shown_by(stands, place, 1.0).votes == SPACE_FRAMES


def test_what_is_not_matched_by_the_engine_tells_nothing() -> None:
    """Whatever words are there; a place that is there is not in view. They bound no plain wall, either."""
    random = seeded(4)
    area = matched(disparity_max_px=63.0, margin_left_px=68.0, margin_px=25.0)
    wall, bare = scene([Wall(20.0)]), scene([Wall(20.0, textured=False)])
    v, u = np.indices(wall.words.shape)
    outside = (u < 68) | (u >= WIDTH - 25) | (v < 25) | (v >= HEIGHT - 25)
    noise = random.integers(-16, 1000, wall.words.shape).astype(np.int16)
    for look in (wall, bare):
        spoilt = Look(np.where(outside, noise, look.words), look.ground, look.pose)
        clean = Look(np.where(outside, INVALID, look.words).astype(np.int16), look.ground, look.pose)
        spaces = Space(), Space()
        for space, shown in zip(spaces, (spoilt, clean), strict=True):
            space.watch(shown, matched=area)
        for _ in range(20):
            z_m = random.uniform(8.0, 30.0)
            place = (*(random.uniform(-0.6, 0.6, 2) * z_m), z_m)
            told = [plain(space.look(place, 1.0)) for space in spaces]
            assert told[0] == told[1]
    left = shown_by(wall, (-0.45 * 20.0, 0.0, 20.0), 1.0, matched=area)
    assert plain(left) == plain(ffi.new("vista_place_evidence *")[0])
    assert shown_by(wall, (-0.45 * 20.0, 0.0, 20.0), 1.0).votes == SPACE_FRAMES


def test_a_place_outside_of_the_image_or_behind_the_camera_is_not_in_view() -> None:
    random = seeded(5)
    space = Space()
    space.watch(scene([Wall(20.0)]))
    for _ in range(100):
        z_m = random.uniform(2.0, 60.0)
        aside = (random.uniform(-2.0, 2.0, 2) * z_m * (WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX)).tolist()
        rim = np.array([WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX]) * z_m + RADIUS_M + 2.0 * z_m / FOCAL_PX
        if np.any(np.abs(aside) > rim):
            assert space.look((*aside, z_m)).frames == 0
        assert space.look((*aside, -z_m)).frames == 0
    assert space.look((0.0, 0.0, 0.5)).frames == 0  # beside the camera


# ---- over frames ----


def test_only_the_last_frames_are_kept() -> None:
    space = Space()
    for k in range(2 * SPACE_FRAMES):
        space.take(scene([Wall(20.0)]), 0.1 * k)
        found = space.look((0.0, 0.0, 20.0))
        assert found.frames == found.votes == min(k + 1, SPACE_FRAMES)


def test_frames_that_follow_closely_replace_one_another() -> None:
    """The newest is always kept; those before it are apart by no less than the spacing, and hardly more."""
    random = seeded(6)
    for _ in range(10):
        space, longest_s = Space(), random.uniform(0.005, 0.15)
        t_s = 100.0 + np.cumsum(random.uniform(0.2 * longest_s, longest_s, 60))
        for k, t in enumerate(t_s):
            space.take(UNMATCHED, t)
            kept = space.times_s
            assert kept[0] == pytest.approx(t, abs=1e-8)
            apart = -np.diff(kept[1:])
            assert np.all(apart >= SPACING_S - 1e-8)
            assert np.all(apart <= SPACING_S + longest_s + 1e-8)
            if t - t_s[0] > 2 * SPACE_FRAMES * (SPACING_S + longest_s):
                assert len(kept) == SPACE_FRAMES, k


def test_reset_forgets() -> None:
    space = Space()
    space.watch(scene([Wall(20.0)]))
    space.reset()
    nothing = plain(ffi.new("vista_place_evidence *")[0])
    assert plain(space.look((0.0, 0.0, 20.0))) == nothing
    space.take(UNMATCHED, 5.0)
    found = space.look((0.0, 0.0, 20.0))
    assert (found.frames, found.votes) == (1, 0)


def test_the_newest_frame_that_votes_says_where() -> None:
    space, place = Space(), (0.0, 0.0, 20.0)
    for k, words in enumerate([scene([Wall(20.0)]), scene([Wall(20.3)]), UNMATCHED, UNMATCHED]):
        space.take(words, 0.1 * k)
    found = space.look(place)
    assert (found.frames, found.votes, found.age) == (4, 2, 2)
    assert found.disparity_px == pytest.approx(disparity_px(space.camera, 20.3), abs=1 / 16)


def test_a_vote_says_where_rather_than_a_foot() -> None:
    """The newest frame has but the foot of the wall."""
    space = Space()
    for k, textured in enumerate((True, True, False)):
        space.take(scene([Wall(20.0, textured=textured)], ground_y_m=3.0), 0.1 * k)
    found = space.look((0.0, 0.0, 20.0))
    assert (found.votes, found.feet, found.age) == (2, 1, 1)
    assert found.spread_px <= 1e-6


def somewhere(random: np.random.Generator):
    """A place and a turn from which 20 m ahead is in view."""
    turn = Rotation.from_euler("zyx", random.uniform((-25, -10, -8), (25, 10, 8)), degrees=True)
    return random.uniform((-3, -2, -4), (3, 2, 4)), turn.as_matrix()


def test_a_place_is_the_same_from_wherever_it_is_seen() -> None:
    """The board is found at its place in the world, and nothing before it or beside it."""
    random = seeded(7)
    for _ in range(10):
        space = Space()
        board = Wall(25.0, x_m=(-1.5, 1.5), y_m=(-1.5, 1.5))
        for k in range(SPACE_FRAMES):
            position, rotation = somewhere(random)
            space.take(scene([board, Wall(80.0)], position=position, rotation=rotation), 0.1 * k)
        at = space.look((0.0, 0.0, 25.0), 1.5)
        assert (at.frames, at.votes) == (SPACE_FRAMES, SPACE_FRAMES) and at.beyond < 0.1
        off_px = at.u_px - space.camera.center_u_px, at.v_px - space.camera.center_v_px
        found_m = position + rotation @ (BASELINE_M / at.disparity_px * np.array([*off_px, FOCAL_PX]))
        assert found_m == pytest.approx([0.0, 0.0, 25.0], abs=0.7)
        for place in ((0.0, 0.0, 13.0), (0.0, -5.0, 25.0), (0.0, 5.0, 25.0)):
            elsewhere = space.look(place, 1.5)
            assert elsewhere.votes == 0 and elsewhere.beyond > 0.9


def test_the_same_frames_show_the_same_and_numbers_whatever_the_poses() -> None:
    random = seeded(8)
    spaces = Space(), Space()
    for k in range(3 * SPACE_FRAMES):
        look = scene([Wall(random.uniform(5.0, 40.0))], ground_y_m=2.0)
        place = random.uniform(-1.0, 1.0, 3) * 10.0 ** random.choice([0, 2, 9, 150, 300])
        turn = Rotation.random(random_state=random).as_matrix()
        for space in spaces:
            space.take(Look(look.words, look.ground, pose(place, turn)), 0.1 * k)
        for _ in range(20):
            point = place + random.uniform(-1.0, 1.0, 3) * 10.0 ** random.choice([-300, 0, 1, 2, 9, 200, 300])
            radius_m = random.choice([0.0, 1e-9, 0.1, 2.0, 1e3, 1e6])
            one, other = (plain(space.look(point, radius_m)) for space in spaces)
            assert one == other
            assert all(np.isfinite(value) for value in one.values())
            assert 0 <= one["votes"] <= one["frames"] and 0 <= one["feet"] <= one["frames"] <= SPACE_FRAMES
            assert 0.0 <= one["beyond"] <= 1.0
