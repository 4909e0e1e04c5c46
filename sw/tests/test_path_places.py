"""Places along the flight path: where they stand, what is told of them, what is warned of, how far the path
is free. Whatever the odds are, evidence that something is there makes it no less likely."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from space_library import (
    BASELINE_M,
    FOCAL_PX,
    HEIGHT,
    RADIUS_M,
    SPACE_FRAMES,
    UNMATCHED,
    WIDTH,
    Look,
    Space,
    Wall,
    scene,
)
from stage_library import camera, ffi, lib
from track_library import flight_path, motion, pose

LENGTH_M = 55.0  # no farther than disparities say something
FIRST_RADII = 2.0  # of path_places.c
FIRST_M = FIRST_RADII * RADIUS_M
RANGED_M = 30.0  # Up to here the range of what nobody tracks is known well enough to warn of it.
FAR = scene(ground_y_m=8.0)  # ground far below the path, and the sky


class Places:
    """The places of the frame that the map took last."""

    def __init__(self, space: Space) -> None:
        self.space, self.handle = space, ffi.new("vista_path_places *")
        lib.vista_path_places_look(space.frame, space.handle, self.handle)

    def judge(self, *obstacles) -> Places:
        items = ffi.new("vista_obstacle[]", list(obstacles))
        lib.vista_path_places_judge(items, len(obstacles), self.handle)
        return self

    @property
    def items(self) -> list:
        return [self.handle.items[k] for k in range(self.handle.count)]

    def at(self, along_m: float):
        return min(self.items, key=lambda place: abs(place.along_m - along_m))

    @property
    def contact_m(self) -> float | None:
        found = lib.vista_path_places_contact(self.handle)
        return None if found == ffi.NULL else found.along_m

    def bear_out(self, distance_m: float) -> bool:
        return lib.vista_path_places_bear_out(self.handle, distance_m)

    @property
    def free_m(self) -> float:
        return lib.vista_path_places_free_m(self.space.frame, self.space.handle, self.handle)


def places_of(look: Look, *obstacles, frames: int = SPACE_FRAMES, length_m: float = LENGTH_M) -> Places:
    space = Space()
    space.watch(look, frames, length_m=length_m)
    return Places(space).judge(*obstacles)


def obstacle(along_m: float, x_m: float = 0.0, **changes) -> dict:
    """A confirmed thing in the collision volume, unless told otherwise."""
    return {
        "id": 1,
        "confirmed": True,
        "kind": lib.VISTA_OBSTACLE_THING,
        "position_m": [x_m, 0.0, along_m],
        "distance_m": along_m,
        "extent_m": [1.0, 1.0],
        "in_collision_volume": True,
    } | changes


# ---- where ----


def test_every_point_of_the_path_is_within_reach_of_a_place() -> None:
    """Points from the first place on, up to where disparities say nothing or to the end of the path."""
    random = seeded(1)
    for _ in range(30):
        lens = camera(WIDTH, HEIGHT, random.uniform(200.0, 1200.0), random.uniform(0.1, 1.0))
        space, length_m = Space(lens), random.uniform(10.0, 150.0)
        space.take(
            Look(UNMATCHED.words, UNMATCHED.ground, pose(random.uniform(-9, 9, 3))), 0.0, length_m=length_m
        )
        places = Places(space).judge()
        says_m = lens.focal_px * lens.baseline_m / space.parameters.region.min_disparity_px
        last_m = min(says_m, length_m)
        if last_m < FIRST_M:
            assert places.items == []
            continue
        along_m = np.array([place.along_m for place in places.items])
        assert along_m[0] == FIRST_M and along_m[-1] <= last_m and np.all(np.diff(along_m) > 0.0)
        reach_m = np.array([place.reach_m for place in places.items])
        if len(along_m) < lib.VISTA_PATH_PLACES_MAX:
            assert along_m[-1] + 2.0 * reach_m[-1] > last_m
        for at_m in random.uniform(FIRST_M, along_m[-1], 50):
            assert np.any(np.abs(at_m - along_m) <= reach_m)


def test_a_small_vehicle_knows_how_far_a_room_is_free() -> None:
    """A wall 3 m ahead, seen by a vehicle of 0.3 m on its way to it."""
    lens = camera(WIDTH, HEIGHT, 300.0, 0.1)
    space = Space(lens, collision_radius_m=0.3)
    for k in range(SPACE_FRAMES):
        look = scene([Wall(3.0)], position=(0.0, 0.0, 0.05 * k), lens=lens)
        space.take(look, 0.1 * k, velocity=(0.0, 0.0, 0.5), length_m=10.0)
    places = Places(space).judge()
    assert places.items[0].along_m == pytest.approx(FIRST_RADII * 0.3)
    wall_m = 3.0 - 0.05 * (SPACE_FRAMES - 1)
    assert 0.8 * wall_m < places.free_m < wall_m
    assert lib.vista_path_places_probability(places.handle, wall_m) > 0.9


def test_places_are_on_the_path_and_not_along_the_camera() -> None:
    """A path that bends to the right, and one that climbs."""
    for direction, normal, curvature in (((0, 0, 1), (1, 0, 0), 0.02), ((0, -0.6, 0.8), (0, 0, 0), 0.0)):
        space = Space()
        space.take(UNMATCHED, 0.0)
        moved = motion(direction=[float(x) for x in direction])
        space.frame.path = flight_path(moved, 40.0, normal, curvature)[0]
        for place in Places(space).items:
            turn = curvature * place.along_m
            straight = np.array(direction) * place.along_m
            bent = np.array([(1 - np.cos(turn)) / 0.02, 0.0, np.sin(turn) / 0.02])
            assert list(place.point_m) == pytest.approx(bent if curvature else straight)


# ---- what is told ----


def test_a_wall_that_nobody_tracks_is_warned_of_and_ends_what_is_free() -> None:
    """Wherever it stands: there is no gap between two places."""
    random = seeded(2)
    for z_m in random.uniform(6.0, RANGED_M, 20):
        places = places_of(scene([Wall(z_m)]))
        reach_m = places.at(z_m).reach_m
        assert places.contact_m == pytest.approx(z_m, abs=2.0 * reach_m)
        assert places.contact_m - 4.0 * reach_m - 2.0 <= places.free_m < places.contact_m
        assert places.bear_out(z_m)


def test_it_takes_frames_to_warn_of_what_nobody_tracks() -> None:
    """The first of them say already that the path is not free there."""
    warned = [places_of(scene([Wall(20.0)]), frames=k).contact_m is not None for k in range(1, 7)]
    assert warned == sorted(warned) and not any(warned[:3]) and warned[-1]
    assert all(places_of(scene([Wall(20.0)]), frames=k).free_m < 20.0 for k in range(1, 7))


def test_what_two_frames_of_six_saw_is_not_warned_of_and_not_free() -> None:
    """Something passes behind a gap of the words: in the other frames the view is open."""
    space = Space()
    for k in range(SPACE_FRAMES):
        space.take(scene([Wall(20.0), Wall(60.0)]) if k in (1, 3) else scene([Wall(60.0)]), 0.1 * k)
    places = Places(space).judge()
    assert places.contact_m is None
    assert places.free_m < 20.0
    seen = places_of(scene([Wall(60.0)]))
    assert seen.contact_m is None and seen.free_m > 40.0


def test_after_a_start_what_all_frames_saw_is_not_free() -> None:
    """A post that hides a tenth of the place, which one frame of six is too few to believe."""
    post = scene([Wall(20.0, x_m=(-0.15, 0.15)), Wall(60.0)])
    assert all(places_of(post, frames=k).free_m < 20.0 for k in (1, 2, 3))
    space = Space()
    for k in range(3):
        space.take(post if k == 0 else scene([Wall(60.0)]), 0.1 * k)
    assert Places(space).judge().free_m > 40.0


def test_a_plain_wall_is_never_free() -> None:
    """Neither where its foot is matched nor where nothing is."""
    random = seeded(3)
    for _ in range(10):
        z_m = random.uniform(10.0, 40.0)
        assert places_of(scene([Wall(z_m, textured=False)], ground_y_m=3.0)).free_m < z_m
        assert places_of(scene([Wall(z_m, textured=False)])).free_m == 0.0


def test_without_words_nothing_is_free_and_nothing_is_warned_of() -> None:
    places = places_of(UNMATCHED)
    assert places.free_m == 0.0 and places.contact_m is None
    assert all(place.shown.beyond == 0.0 for place in places.items)


def test_an_open_view_is_free_to_the_end() -> None:
    for length_m in (30.0, LENGTH_M, 90.0):
        places = places_of(FAR, length_m=length_m)
        says_m = FOCAL_PX * BASELINE_M / places.space.parameters.region.min_disparity_px
        assert places.contact_m is None
        assert places.free_m == pytest.approx(min(length_m, says_m))


def test_what_is_beside_the_path_leaves_it_free() -> None:
    """Walls to both sides of a lane of 6 m."""
    lane = [Wall(z_m, x_m=side) for z_m in (15.0, 25.0, 35.0) for side in ((-30.0, -3.0), (3.0, 30.0))]
    places = places_of(scene([*lane, Wall(500.0)], ground_y_m=8.0))
    assert places.contact_m is None and places.free_m > 50.0


def test_the_path_ahead_of_a_moving_aircraft_is_looked_at_through_all_frames() -> None:
    """A sign 2 m wide comes nearer; each time it is where it stands."""
    space = Space()
    sign = Wall(50.0, x_m=(-1.0, 1.0), y_m=(-1.5, 1.5))
    for k in range(20):
        look = scene([sign, Wall(900.0)], position=(0.0, 0.0, 1.5 * k), ground_y_m=10.0)
        space.take(look, 0.1 * k, velocity=(0.0, 0.0, 15.0), length_m=LENGTH_M)
        left_m, places = 50.0 - 1.5 * k, Places(space).judge()
        assert places.free_m < left_m
        if left_m < RANGED_M:
            assert places.contact_m == pytest.approx(left_m, abs=2.0 * places.at(left_m).reach_m)


# ---- what the obstacles of the frame say ----


def test_what_the_frames_see_through_is_not_borne_out() -> None:
    """A thing that is not confirmed is as much in the way as the frames say."""
    thing = obstacle(20.0, confirmed=False)
    assert not places_of(FAR, thing).bear_out(20.0)
    assert places_of(scene([Wall(20.0)]), thing).bear_out(20.0)


def test_a_thing_in_the_volume_is_warned_of_where_nothing_is_seen() -> None:
    """Its middle is beside the path: it is a member by its own pixels."""
    places = places_of(UNMATCHED, obstacle(20.0, 10.0))
    assert places.bear_out(20.0)
    assert places.contact_m == pytest.approx(20.0, abs=places.at(20.0).reach_m)


def test_what_is_small_is_borne_out_by_its_track() -> None:
    """The frames see past it: a bird of 0.4 m covers a hundredth of a place's cross-section."""
    bird = obstacle(20.0, extent_m=[0.4, 0.4])
    places = places_of(scene([Wall(20.0, x_m=(-0.2, 0.2), y_m=(-0.2, 0.2))], ground_y_m=8.0), bird)
    assert places.at(20.0).shown.beyond > 0.9
    assert places.bear_out(20.0) and places.free_m < 20.0


def test_only_what_is_confirmed_and_tracked_is_evidence() -> None:
    silent = [places_of(UNMATCHED).at(20.0).probability]
    for changes in ({"confirmed": False}, {"kind": lib.VISTA_OBSTACLE_TOO_NEAR}):
        silent.append(places_of(UNMATCHED, obstacle(20.0, **changes)).at(20.0).probability)
    silent.append(places_of(UNMATCHED, obstacle(40.0)).at(20.0).probability)  # elsewhere
    assert len(set(silent)) == 1
    assert places_of(UNMATCHED, obstacle(20.0)).at(20.0).probability > silent[0]


def test_ground_that_is_met_is_warned_of() -> None:
    ground = obstacle(25.0, kind=lib.VISTA_OBSTACLE_GROUND)
    places = places_of(UNMATCHED, ground)
    assert places.at(25.0).ground and not places.at(25.0).thing
    assert places.contact_m == pytest.approx(25.0, abs=places.at(25.0).reach_m)
    assert places_of(UNMATCHED, ground | {"in_collision_volume": False}).contact_m is None


def test_where_no_place_is_looked_at_everything_is_borne_out() -> None:
    places = places_of(FAR)
    for distance_m in (1.0, LENGTH_M + 20.0, 1e9):
        assert places.bear_out(distance_m)
    assert not places.bear_out(20.0)


def test_a_distance_is_as_likely_occupied_as_the_likeliest_place_there() -> None:
    random = seeded(6)
    places = places_of(scene([Wall(20.0)]), obstacle(12.0))
    for distance_m in random.uniform(5.0, 40.0, 50):
        there = [p.probability for p in places.items if abs(p.along_m - distance_m) <= p.reach_m]
        assert lib.vista_path_places_probability(places.handle, distance_m) == max(there)
    assert np.isnan(lib.vista_path_places_probability(places.handle, LENGTH_M + 20.0))


def test_more_evidence_is_never_less_probability() -> None:
    """Any two places of which one has all that the other has are compared."""
    random = seeded(4)
    flags, counts = ("thing", "ground"), ("votes", "feet")
    space = Space()
    space.take(UNMATCHED, 0.0, length_m=LENGTH_M)
    for _ in range(100):
        places = Places(space)
        less, more = places.items[:2]
        less.shown.frames = more.shown.frames = SPACE_FRAMES
        for name in flags:
            value = random.random() < 0.5
            setattr(less, name, value)
            setattr(more, name, value or random.random() < 0.5)
        for name in counts:
            value = random.integers(0, SPACE_FRAMES + 1)
            setattr(less.shown, name, value)
            setattr(more.shown, name, random.integers(value, SPACE_FRAMES + 1))
        less.shown.beyond = random.random()
        more.shown.beyond = less.shown.beyond * random.random()
        places.judge()
        assert 0.0 < less.probability <= more.probability < 1.0


@pytest.mark.slow
def test_what_is_likely_occupied_is_neither_free_nor_unsaid() -> None:
    """Nothing is warned of up to where the path is free, whatever is seen and told."""
    random = seeded(5)
    for _ in range(30):
        walls = [
            Wall(z, x_m=(x, x + random.uniform(0.5, 5.0)), textured=random.random() < 0.7)
            for z, x in zip(random.uniform(6.0, 50.0, 4), random.uniform(-6.0, 4.0, 4), strict=True)
        ]
        things = [
            obstacle(z, in_collision_volume=random.random() < 0.5) for z in random.uniform(5.0, 50.0, 2)
        ]
        places = places_of(scene(walls, ground_y_m=random.uniform(1.5, 9.0)), *things)
        if places.contact_m is not None:
            assert places.free_m < places.contact_m
        for place in places.items:
            if place.along_m <= places.free_m:
                assert place.shown.beyond >= 0.5 and place.probability < 0.5


def test_the_path_is_free_only_as_far_around_as_the_aircraft_may_be_off_it() -> None:
    """A wall passes the place on the path and not the place that one standard deviation more makes of it."""
    space = Space()
    space.watch(
        scene([Wall(20.0, x_m=(1.2 * RADIUS_M, 9.0)), Wall(500.0)], ground_y_m=9.0), length_m=LENGTH_M
    )
    assert Places(space).judge().free_m > 30.0
    space.frame.path.sigma_rad = 0.6 * RADIUS_M / 20.0
    wandering = Places(space).judge()
    assert 15.0 < wandering.free_m < 20.0 and wandering.contact_m is None
