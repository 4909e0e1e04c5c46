"""The obstacle map: distances, ellipses, the collision volume and the time to collision."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from space_library import BASELINE_M, FOCAL_PX, RADIUS_M, SPACE_FRAMES, UNMATCHED, Space, Wall, scene
from stage_library import Arena, ffi, frame_view, lib
from track_library import (
    BASELINE,
    CENTER,
    FOCAL,
    SIGMAS,
    Tracker,
    camera,
    detection,
    flight_path,
    jacobian,
    measure,
    motion,
    parameters_with,
    pose,
    seen_at,
)

NAN = float("nan")
FORWARD = (0.0, 0.0, 9.0)
EXACT = {"thickness_ratio": 0.0, "path_sigmas": 0.0}  # what is seen is the middle, and the path is certain
# Of track_obstacle.c: errors that last from frame to frame.
LASTING_PX, LASTING_M, CENTER_PX, CENTER_RATIO, SCATTER = 0.02, 0.02, 0.6, 0.35, 0.3


class Map:
    def __init__(self, max_tracks: int = 32, **changes: float) -> None:
        out = ffi.new("vista_obstacle_map **")
        self._arena = Arena(lambda arena: lib.vista_obstacle_map_layout(max_tracks, arena, out))
        assert self._arena.status == lib.VISTA_OK
        self.handle, self._parameters = out[0], parameters_with("obstacle_map", **EXACT | changes)
        self.params, self.camera = self._parameters.obstacle_map, camera()

    def update(
        self,
        tracks=(),
        velocity=FORWARD,
        raw_pose=None,
        blind_zone=ffi.NULL,
        length_m=None,
        terrain=ffi.NULL,
        **arc,
    ) -> None:
        """arc: normal and curvature_1_m."""
        items = ffi.new("vista_track[]", [track[0] for track in tracks])
        moved = motion(raw_pose, velocity)
        path = flight_path(moved, length_m or self.params.collision_length_m, **arc)
        frame = frame_view(self._parameters, self.camera, motion=moved, path=path)
        given = ffi.new("vista_map_input *", [items, len(tracks), terrain, blind_zone])
        lib.vista_obstacle_map_update(self.handle, frame, given)

    @property
    def obstacles(self) -> list:
        count = ffi.new("int32_t *")
        items = lib.vista_obstacle_map_obstacles(self.handle, count)
        return [ffi.new("vista_obstacle *", items[i]) for i in range(count[0])]

    @property
    def nearest(self):
        return lib.vista_obstacle_map_nearest(self.handle)

    def memory(self) -> bytes:
        return bytes(ffi.buffer(self._arena.arena.base, self._arena.size))


def track(position, id_: int = 1, sigma_m: float = 0.1, extent=(1.0, 0.8), **changes):
    values = {
        "id": id_,
        "confirmed": True,
        "credible": True,
        "coasting": True,  # so that its disc counts
        "hits": 7,
        "volume_window": 0b111,
        "age_frames": 7,
        "position_m": [float(x) for x in position],
        "covariance": (np.eye(6) * sigma_m**2).ravel().tolist(),
        "extent_m": list(extent),
        "ellipse": [100.0, 120.0, 20.0, 10.0, 30.0],
        "ellipse_depth_m": 40.0,
    }
    return ffi.new("vista_track *", values | changes)


def in_volume(position, velocity=FORWARD, raw_pose=None, changes=None, **keywords) -> bool:
    mapper = Map(**(changes or {}))
    mapper.update([track(position, **keywords)], velocity, raw_pose)
    return mapper.obstacles[0].in_collision_volume


def share_of_large(extent_m: float) -> float:
    return float(np.clip((extent_m - 3.0) / 1.5, 0.0, 1.0))


def test_what_is_large_is_met_where_it_is_closest_to_the_path() -> None:
    """It is met as a rectangle of the extent that faces the camera: from 4.5 m on there; up to 3 m half way
    to there, uncertain by as much. Which point of its surface is first, and where its end is, adds to that.
    """
    random = seeded(9)
    for _ in range(50):
        center, extent = random.uniform((-8, -5, 20), (8, 5, 60)), random.uniform(0.2, 20.0, 2)
        mapper = Map()
        item = track(center, extent=extent.tolist(), coasting=False)
        mapper.update([item])
        (obstacle,), nearest = mapper.obstacles, mapper.nearest
        middle, half = np.array(list(obstacle.position_m)), extent / 2
        share = np.array([0.5 + 0.5 * share_of_large(side) for side in extent])
        step = np.clip(-middle[:2], -half, half)
        expected = middle + np.append(share * step, 0.0)
        assert list(nearest.position_m) == pytest.approx(expected)
        assert nearest.distance_m == pytest.approx(np.linalg.norm(expected))
        assert nearest.time_to_collision_s == pytest.approx(expected[2] / 9.0)
        face = np.minimum(half / math.sqrt(3.0), math.sqrt(2.0 * 2.0 * 0.1))
        end = np.where(np.abs(middle[:2]) > half, 0.2 * half, 0.0)
        added = np.reshape(list(nearest.covariance_m2), (3, 3)) - np.reshape(
            list(obstacle.covariance_m2), (3, 3)
        )
        assert added == pytest.approx(
            np.diag([*((1 - share) ** 2 * step**2 + face**2 + end**2), 0.0]), abs=1e-9
        )


def test_what_is_large_is_met_in_its_surface() -> None:
    """Not in the middle behind it, which is that of an obstacle."""
    for extent, behind_m in ((1.0, 0.25), (2.9, 0.25), (4.6, 0.0)):
        mapper = Map(thickness_ratio=0.5)
        mapper.update([track((0.0, 0.0, 20.0), extent=(extent, extent))])
        assert mapper.obstacles[0].distance_m == pytest.approx(20.25)
        assert mapper.nearest.distance_m == pytest.approx(20.0 + behind_m)


def test_parts_of_one_thing_make_it_uncertain_which_is_met_first() -> None:
    """Posts in the way at about one range, 1.6 m apart; not what is farther away, or beside the volume."""
    post, other = track((-0.8, 0.0, 20.0), 1, extent=(0.1, 0.1)), {"extent": (0.1, 0.1)}
    for place, changes, apart_m in (
        ((0.8, 0.0, 20.5), {}, 1.6),
        ((0.8, 0.0, 24.0), {}, 0.0),
        ((0.8, 0.0, 20.5), {"volume_window": 0}, 0.0),
    ):
        alone, beside = Map(), Map()
        alone.update([post])
        beside.update([post, track(place, 2, **other, **changes)])
        assert beside.nearest.id == alone.nearest.id == 1
        added = np.subtract(list(beside.nearest.covariance_m2), list(alone.nearest.covariance_m2)).reshape(
            3, 3
        )
        assert added[0, 0] == pytest.approx(apart_m**2 / 3.0, rel=0.1)
        assert np.abs(added[2]).max() == pytest.approx(0.0, abs=1e-9)


def test_nearest_first_and_only_the_credible_collide() -> None:
    mapper = Map()
    tracks = [
        track((0, 0, 60.0), 1),
        track((0, 0, 20.0), 2, credible=False),
        track((0, 0, 35.0), 3),
        track((9, 0, 10.0), 4),
        track((0, 0, -1.0), 5),
    ]
    mapper.update(tracks)
    assert [o.id for o in mapper.obstacles] == [4, 2, 3, 1]
    assert [o.in_collision_volume for o in mapper.obstacles] == [False, False, True, True]
    assert mapper.nearest.valid
    assert mapper.nearest.id == 3
    assert mapper.nearest.distance_m == 35.0
    assert mapper.nearest.time_to_collision_s == pytest.approx(35.0 / 9.0)
    mapper.update(tracks[3:4])
    assert (mapper.nearest.valid, mapper.nearest.id) == (False, 0)


@pytest.mark.parametrize(
    ("hits", "member"),
    [(0b111, True), (0b011, True), (0b101, True), (0b110, True), (0b001, False), (0b1000, False)],
)
def test_what_is_seen_is_a_member_by_two_of_three_hits(hits: int, member: bool) -> None:
    """Wherever its centre is; while it coasts, or only edges are seen, if its disc is in the way, too."""
    for point, in_the_way in (((0, 0, 30.0), True), ((9, 0, 30.0), False)):
        assert in_volume(point, coasting=False, volume_window=hits) == member
        by_disc = member and in_the_way
        assert in_volume(point, coasting=True, volume_window=hits) == by_disc
        assert in_volume(point, coasting=False, edges_only=True, volume_window=hits) == by_disc
        assert in_volume(point, coasting=False, volume_window=hits & 1, hits=1) == hits & 1


@pytest.mark.parametrize(
    ("speed_m_s", "sigma_m_s", "entering"),
    [(-0.9, 0.1, True), (0.9, 0.1, False), (-0.4, 0.05, False), (-0.9, 0.4, False)],
)
def test_what_moves_across_is_a_member_before_it_is_there(
    speed_m_s: float, sigma_m_s: float, entering: bool
) -> None:
    """2.3 m beside the path, half as wide as that: it comes, goes, is too slow, or its speed is not known.
    One miss does not take that back; with two its velocity is a guess."""
    covariance = np.diag([0.01] * 3 + [sigma_m_s**2, sigma_m_s**2, 1.0])
    moves = {"velocity_m_s": [speed_m_s, 0.0, 0.0], "covariance": covariance.ravel().tolist()}
    seen, missed = {"coasting": False}, {"coasting": True, "misses": 1}
    for point, state, member in (
        ((2.8, 0, 30.0), seen, entering),
        ((2.8, 0, 30.0), missed, entering),
        ((2.8, 0, 30.0), missed | {"misses": 2}, False),
        ((2.8, 0, 30.0), seen | {"edges_only": True}, False),
        ((9, 0, 30.0), seen, False),
    ):
        assert in_volume(point, volume_window=0, **state, **moves) == member


@pytest.mark.parametrize(
    ("changes", "member"),
    [({}, True), ({"plain": False}, False), ({"met": False}, False), ({"volume_window": 0b100}, False)],
)
def test_a_plain_wall_that_is_held_is_met_where_it_was_met_last(
    changes: dict[str, object], member: bool
) -> None:
    """Its middle is 9 m beside the path, and half its known width is 5 m: the rest had left the image."""
    values = {"extent": (10.0, 13.0), "plain": True, "met": True, "met_m": [0.3, 0.5, 30.0]}
    assert in_volume((-9, 0, 30.0), **(values | changes)) == member
    assert not in_volume((-9, 0, 30.0), **(values | {"met_m": [-4.5, 0.0, 30.0]} | changes))


@pytest.mark.parametrize(("misses", "member"), [(0, True), (2, True), (3, False)])
def test_where_something_else_is_seen_for_long_nothing_is_warned_of(misses: int, member: bool) -> None:
    """That lasts until the track is given up: a fragment of a thing that another track follows drifts beside
    it."""
    assert in_volume((0.0, 0.0, 30.0), coasting=True, misses=misses) == member


def flier(across_m_s: float, meets_s: float, miss_m: float = 0.0, sigma_m: float = 0.1, **changes) -> bool:
    """Whether what crosses is in the volume; it would pass `miss_m` from the aircraft, `meets_s` from now."""
    velocity = [across_m_s, 0.0, -2.0]
    position = (miss_m - across_m_s * meets_s, 0.0, (FORWARD[2] + 2.0) * meets_s)
    values = {"coasting": False, "volume_window": 0, "velocity_m_s": velocity} | changes
    return in_volume(position, sigma_m=sigma_m, **values)


def test_what_flies_and_will_be_met_is_a_member_long_before_it_is_there() -> None:
    """Never at the side of the path where the aircraft is now, and always at the same bearing."""
    standing = {"foot_count": 5.0, "foot_share": 0.2}
    hanging = {"foot_count": 5.0, "foot_share": 2.0}
    assert flier(3.0, 2.5) and flier(-3.0, 2.5) and flier(3.0, 2.5, world=hanging)
    assert not flier(3.0, 2.5, miss_m=3.0) and not flier(3.0, 2.5, miss_m=-3.0)
    assert not flier(3.0, 4.0)  # later than is asked for
    assert flier(1.2, 2.5, miss_m=-1.2)
    assert not flier(0.9, 2.5, miss_m=-1.2)  # may be no motion at all
    assert not flier(3.0, 2.5, sigma_m=0.8)  # and so may this
    assert not flier(3.0, 2.5, hits=5)
    assert not flier(3.0, 2.5, world=standing)
    assert not flier(3.0, 2.5, misses=2, coasting=True)


def test_only_the_doubt_of_the_motion_across_the_path_counts() -> None:
    """The velocity is uncertain along the path alone, which is oblique to the axes of the world."""
    turn = Rotation.from_euler("y", 45.0, degrees=True).as_matrix()
    along = turn @ (0.0, 0.0, 1.0)
    covariance = 0.01 * np.eye(6)
    covariance[3:, 3:] += 2.0**2 * np.outer(along, along)
    values = {
        "coasting": False,
        "volume_window": 0,
        "velocity_m_s": list(turn @ (3.0, 0.0, -2.0)),
        "covariance": covariance.ravel().tolist(),
    }
    assert in_volume(turn @ (-7.5, 0.0, 27.5), tuple(turn @ FORWARD), pose((0, 0, 0), turn), **values)


def test_errors_that_last_add_to_the_covariance() -> None:
    """They add along the ray by disparity, depth and the place of the foot, across it by pixels and a share
    of what the width has more than twice the height, both by the scatter of the detections; camera turned."""
    turn = Rotation.from_euler("xyz", [4, -7, 3], degrees=True).as_matrix()
    mapper, point = Map(), np.array([3.0, -2.0, 40.0])
    seen = track(
        turn @ point, sigma_m=0.1, extent=(3.0, 1.0), scatter_px2=[36.0, 16.0, 0.04], lasting_sigma_m=0.7
    )
    mapper.update([seen], FORWARD, pose((0, 0, 0), turn))
    ray = point / point[2]
    along2 = (40.0**2 / (FOCAL * BASELINE)) ** 2 * (LASTING_PX**2 + (0.2 * SCATTER) ** 2)
    along2 += LASTING_M**2 + 0.7**2
    wander2 = (SCATTER * np.array([6.0, 4.0])) ** 2
    across = 0.04**2 * (CENTER_PX**2 + wander2) + [(0.5 * CENTER_RATIO) ** 2, 0.0]
    expected = 0.01 * np.eye(3) + along2 * np.outer(ray, ray) + np.diag([*across, 0.0])
    covariance = np.array(list(mapper.obstacles[0].covariance_m2)).reshape(3, 3)
    assert covariance == pytest.approx(turn @ expected @ turn.T)


def test_what_is_seen_steadily_is_more_certain() -> None:
    """It is in u, v and disparity, by as much as its detections scattered less than their noise would have
    it, down to a quarter of the variance; after a few hits by a part of that."""
    turn = Rotation.from_euler("xyz", [4, -7, 3], degrees=True).as_matrix()
    point = np.array([3.0, -2.0, 40.0])
    in_depth_px = LASTING_M * FOCAL * BASELINE / point[2] ** 2
    wander2 = SCATTER**2 * (9.0 - 4.0)  # of v alone
    lasting = np.diag([CENTER_PX**2, CENTER_PX**2 + wander2, LASTING_PX**2 + in_depth_px**2])
    from_px = jacobian(*measure(point))
    for hits, shares in ((10, (0.5, 1.0, 0.25)), (5, (0.75, 1.0, 0.625)), (30, (0.5, 1.0, 0.25))):
        mapper = Map()
        scatter = {"scatter_px2": [2.0, 9.0, 0.001], "expected_px2": [4.0, 4.0, 0.04]}
        mapper.update([track(turn @ point, hits=hits, **scatter)], FORWARD, pose((0, 0, 0), turn))
        covariance = np.array(list(mapper.obstacles[0].covariance_m2)).reshape(3, 3)
        to_px, root = np.linalg.inv(from_px), np.diag(np.sqrt(shares))
        in_px = to_px @ turn.T @ covariance @ turn @ to_px.T
        assert in_px == pytest.approx(root @ (0.01 * to_px @ to_px.T) @ root + lasting, rel=1e-9)


ERRORS = {  # white noise, lasting bias and wander (Gauss-Markov, 0.8 kept) of u, v and disparity, px
    "as assumed": ((1.0, 1.0, 0.25), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "steady": ((0.5, 0.5, 0.12), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "bias of the matcher": ((0.7, 0.7, 0.15), (0.5, 0.5, 0.02), (0.0, 0.0, 0.0)),
    "region that wanders": ((0.7, 0.7, 0.12), (0.3, 0.3, 0.02), (1.0, 1.0, 0.08)),
}
NEES_BANDS = {  # an honest covariance has 3; the bias that is allowed for is none of what is steady
    "as assumed": (1.3, 3.2),
    "steady": (0.6, 1.6),
    "bias of the matcher": (1.5, 3.6),
    "region that wanders": (3.0, 6.6),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ERRORS)
def test_the_covariance_is_that_of_the_errors(kind: str) -> None:
    """Things stand, 40 to 20 m ahead. The NEES is 3 on average where the covariance is that of the errors; it
    is 1.0 of what is steady, 2.1 of what is as noisy as assumed, 2.4 with the bias of the matcher and 4.7 of
    a region that wanders."""
    random, nees = seeded(1), []
    white, bias, wander = (np.array(sigma) for sigma in ERRORS[kind])
    for _ in range(60):
        tracker, mapper, point = Tracker(), Map(), np.array([0.3, -0.2, 60.0])
        lasting, wandered = random.normal(0, bias), random.normal(0, wander)
        for frame in range(44):
            place = np.array([0.0, 0.0, 0.9144 * frame])
            wandered = 0.8 * wandered + 0.6 * random.normal(0, wander)
            seen = detection(measure(point, place) + random.normal(0, white) + lasting + wandered)
            tracker.update(0.1 * frame, [seen], place)
            if frame < 22 or frame % 7:
                continue
            tracks = [one for one in tracker.tracks.values() if one.confirmed]
            mapper.update(tracks, FORWARD, pose(place))
            obstacle = mapper.obstacles[0]
            error = np.array(list(obstacle.position_m)) - point
            nees.append(error @ np.linalg.solve(np.array(list(obstacle.covariance_m2)).reshape(3, 3), error))
    low, high = NEES_BANDS[kind]
    assert low < np.mean(nees) < high


def test_the_middle_lies_behind_the_surface() -> None:
    """Half of half the width, uncertain by as much, as things are about as deep as they are wide; no more
    than half the height of what is low and long, and than that of 1 m of what is large."""
    cases = (((0.6, 4.0), 0.15), ((0.3, 0.2), 0.075), ((8.0, 0.1), 0.05), ((16.0, 9.0), 0.25))
    for extent, behind_m in cases:
        maps = [Map(thickness_ratio=ratio) for ratio in (0.0, 0.5)]
        point = np.array([3.0, -4.0, 12.0])
        for mapper in maps:
            mapper.update([track(point, extent=extent)])
        bare, thick = (mapper.obstacles[0] for mapper in maps)
        assert list(thick.position_m) == pytest.approx(point * (1.0 + behind_m / 13.0))
        assert thick.distance_m == pytest.approx(13.0 + behind_m)
        added = np.array(list(thick.covariance_m2)) - np.array(list(bare.covariance_m2))
        expected = ((behind_m + LASTING_M) ** 2 - LASTING_M**2) * np.outer(point, point) / 12.0**2
        assert added == pytest.approx(expected.ravel(), abs=1e-9)


def test_what_moves_with_the_aircraft_is_not_confirmed() -> None:
    mapper = Map()
    verdicts = [lib.VISTA_WORLD_OPEN, lib.VISTA_WORLD_STANDS, lib.VISTA_WORLD_MOVES, lib.VISTA_WORLD_REFUTED]
    tracks = [track((9, 0, 10.0 + k), k, world={"verdict": verdict}) for k, verdict in enumerate(verdicts)]
    mapper.update(tracks)
    assert [(o.world, o.confirmed) for o in mapper.obstacles] == list(
        zip(verdicts, [True, True, True, False], strict=True)
    )


def test_what_is_too_near_to_match_is_a_danger() -> None:
    """It comes before any track, on the flight path, at the end of the blind zone."""
    mapper, aside = Map(), (3.0, 0.0, 4.0)
    too_near = ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 14.5})
    mapper.update([track((0, 0, 30.0))], aside, None, too_near)
    assert [o.id for o in mapper.obstacles] == [0, 1]
    found, along = mapper.obstacles[0], np.array(aside) / 5.0
    assert found.confirmed and found.in_collision_volume and found.in_blind_zone
    assert list(found.position_m) == pytest.approx(14.5 * along)
    variance = np.linalg.eigvalsh(np.array(list(found.covariance_m2)).reshape(3, 3))
    assert np.sqrt(variance) == pytest.approx([2.0, 2.0, 14.5])
    assert (mapper.nearest.id, mapper.nearest.distance_m) == (0, 14.5)
    assert mapper.nearest.time_to_collision_s == pytest.approx(14.5 / 5.0)
    mapper.update([track((0, 0, 4.0))], FORWARD, None, too_near)
    assert mapper.nearest.id == 1  # nearer still, and tracked
    too_near.occupied = False
    mapper.update([], FORWARD, None, too_near)
    assert not mapper.nearest.valid and mapper.obstacles == []


@pytest.mark.parametrize("too_near_first", [False, True])
def test_what_is_too_near_to_match_never_hides_a_track_that_is_seen(too_near_first: bool) -> None:
    """Both are obstacles in the volume; the nearest collision is with the track while it is seen, and with
    what may hide it while it coasts."""
    mapper = Map()
    too_near = ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 7.3})
    if too_near_first:
        mapper.update([], FORWARD, None, too_near)
    coasts, seen = track((0, 0, 20.0), 4), track((0, 0, 30.0), 5, coasting=False)
    for tracks, nearest in (([seen], 5), ([coasts, seen], 4), ([coasts], 0), ([], 0)):
        mapper.update(tracks, FORWARD, None, too_near)
        assert [o.id for o in mapper.obstacles] == [0, *(t[0].id for t in tracks)]
        assert all(o.in_collision_volume for o in mapper.obstacles)
        assert mapper.nearest.id == nearest
    beside = track((9.0, 0, 30.0), 6, coasting=False, volume_window=0)
    mapper.update([beside], FORWARD, None, too_near)
    assert mapper.nearest.id == 0  # nothing tracked is in the way


def ground_ahead(along_m: float, **changes):
    """A slope of 30 degrees, met 2 m below a path along z."""
    normal = np.array([0.0, 0.5, np.sqrt(0.75)])
    point = np.array([0.0, 2.0, along_m])
    values = {
        "known": True,
        "ahead": True,
        "confirmed": True,
        "credible": True,
        "steady": True,
        "age_frames": 7,
        "plane": {"normal": list(normal), "offset_m": float(normal @ point)},
        "contact": {"along_m": along_m, "radius_m": 2.0, "point_m": list(point), "sine": float(normal[2])},
        "world": {"verdict": lib.VISTA_WORLD_STANDS},
        "sigma_m": 0.4,
    }
    return ffi.new("vista_terrain *", values | changes)


def test_ground_ahead_is_an_obstacle_with_distance_and_time() -> None:
    mapper = Map()
    mapper.update([], terrain=ground_ahead(27.0))
    (found,) = mapper.obstacles
    assert (found.id, found.kind) == (lib.VISTA_ID_GROUND, lib.VISTA_OBSTACLE_GROUND)
    assert found.confirmed and found.in_collision_volume and found.age_frames == 7
    assert list(found.position_m) == [0.0, 2.0, 27.0]
    assert found.distance_m == pytest.approx(np.hypot(27.0, 2.0))
    assert mapper.nearest.valid and mapper.nearest.id == lib.VISTA_ID_GROUND
    assert mapper.nearest.time_to_collision_s == pytest.approx(27.0 / 9.0)
    variance = np.array(list(found.covariance_m2)).reshape(3, 3)
    assert np.sqrt(variance[2, 2]) == pytest.approx(0.4) and np.sqrt(variance[0, 0]) == pytest.approx(0.2)
    for kept_off in (
        {"credible": False},
        {"steady": False},
        {"world": {"verdict": lib.VISTA_WORLD_REFUTED}, "credible": False},
    ):
        mapper.update([], terrain=ground_ahead(27.0, **kept_off))
        assert not mapper.nearest.valid and len(mapper.obstacles) == 1
    for absent in (ground_ahead(27.0, ahead=False), ground_ahead(-3.0)):
        mapper.update([], terrain=absent)
        assert not mapper.nearest.valid and mapper.obstacles == []


def test_what_lies_on_the_ground_ahead_is_met_where_that_is_met() -> None:
    """A region of the hillside itself, whose middle is before or behind the place; not what stands on it."""
    mapper, slope = Map(), ground_ahead(40.0)
    foot = track((0.0, 2.0 + 3.0 * np.sqrt(3.0), 37.0), 1, coasting=False)
    behind = track((0.0, 2.0 - 3.0 * np.sqrt(3.0), 43.0), 2, coasting=False)
    mapper.update([foot, behind], terrain=slope)
    assert {o.id: o.in_collision_volume for o in mapper.obstacles} == {1: False, -1: True, 2: False}
    assert mapper.nearest.id == lib.VISTA_ID_GROUND
    pole = track((0.0, 0.0, 37.0), 3)
    mapper.update([pole], terrain=slope)
    assert mapper.nearest.id == 3 and all(o.in_collision_volume for o in mapper.obstacles)
    mapper.update([foot], terrain=ground_ahead(40.0, credible=False))
    assert mapper.nearest.id == 1  # as long as the ground itself is not believed


def test_a_low_pole_on_ground_ahead_keeps_its_warning() -> None:
    """A descent of 5 degrees onto level ground 40 m ahead: far from the contact, a tenth of the distance is
    more than the height of the pole's middle."""
    along = np.array([0.0, np.sin(np.radians(5.0)), np.cos(np.radians(5.0))])
    normal, point = np.array([0.0, 1.0, 0.0]), 40.0 * along + (0.0, 2.0, 0.0)
    meadow = ground_ahead(
        40.0,
        plane={"normal": list(normal), "offset_m": float(normal @ point)},
        contact={"along_m": 40.0, "radius_m": 2.0, "point_m": list(point), "sine": along[1]},
    )
    height_m = 3.4
    pole = track((0.0, point[1] - 0.5 * height_m, 20.0), 4, extent=(0.3, height_m))
    mapper = Map()
    mapper.update([pole], tuple(9.0 * along), terrain=meadow)
    assert mapper.nearest.id == 4 and all(o.in_collision_volume for o in mapper.obstacles)


def test_what_is_large_is_met_where_its_own_points_say_and_what_is_compact_near_its_middle() -> None:
    """A wall seen at an angle, its middle at 40 m; a board, half way from its middle to its edge."""
    met = {"met": True, "met_m": [0.5, 0.0, 31.0]}
    for extent, expected in (((12.0, 8.0), met["met_m"]), ((1.5, 2.0), [0.625, 0.0, 40.0])):
        mapper = Map()
        mapper.update([track((1.0, 0.0, 40.0), extent=extent, **met)])
        assert list(mapper.nearest.position_m) == pytest.approx(expected)
        assert mapper.nearest.distance_m == pytest.approx(np.linalg.norm(expected))


def test_what_began_as_a_part_is_met_where_its_own_points_say() -> None:
    """The extent of a track follows slowly: it is that of a window, 11 m below the path; its last region is
    the whole facade."""
    facade = {"ellipse": [320.0, 240.0, 300.0, 200.0, 0.0], "ellipse_depth_m": 40.0}  # 24 m wide
    values = {"extent": (0.9, 0.8), "met": True, "met_m": [0.5, 0.0, 39.0]}
    for changes, expected in (({}, [0.0, 10.8, 40.0]), (facade, values["met_m"])):
        mapper = Map()
        mapper.update([track((0.0, 11.0, 40.0), coasting=False, **values, **changes)])
        assert list(mapper.nearest.position_m) == pytest.approx(expected)


def test_what_its_own_points_tell_has_their_range_and_their_doubt_of_it() -> None:
    """Not those of the filter of its middle; across the line of sight the covariance is that of the thing.
    The range of a plain wall is told by its outline. Which point of a face is met first adds to either."""
    random, face = seeded(11), np.diag([2.0 * 2.0 * 0.1, 2.0 * 2.0 * 0.1, 0.0])
    for _ in range(50):
        met_m, sigma_m = random.uniform((-4, -3, 10), (4, 3, 60)), float(random.uniform(0.05, 2.0))
        sight, told = met_m / np.linalg.norm(met_m), {}
        across = np.eye(3) - np.outer(sight, sight)
        for plain in (False, True):
            wall = track(
                met_m + np.array([1.0, 1.0, 2.0]),
                sigma_m=0.5,
                extent=(12.0, 8.0),
                met=True,
                met_m=met_m.tolist(),
                met_sigma_m=sigma_m,
                plain=plain,
            )
            mapper = Map()
            mapper.update([wall])
            told[plain] = np.reshape(list(mapper.nearest.covariance_m2), (3, 3)) - face
            of_thing = np.reshape(list(mapper.obstacles[0].covariance_m2), (3, 3))
        assert sight @ told[False] @ sight == pytest.approx(sigma_m**2, rel=1e-6)
        assert across @ told[False] @ across == pytest.approx(across @ of_thing @ across, abs=1e-9)
        assert told[True] == pytest.approx(of_thing, abs=1e-9)


def test_a_hillside_that_is_a_region_too_is_no_collision_of_its_own() -> None:
    """Its middle is far off the plane that the ground is met on; where the path meets it is not."""
    slope = ground_ahead(30.0)
    met = {"met": True, "met_m": [0.3, 1.7, 30.2]}
    hill = track((4.0, -9.0, 38.0), 5, extent=(40.0, 25.0), **met)
    grown = track((4.0, -9.0, 38.0), 5, extent=(2.0, 1.5), ellipse=[100.0, 120.0, 390.0, 160.0, 0.0], **met)
    for seen in (hill, grown):  # of a small part of the slope the track has just become all of it
        mapper = Map()
        mapper.update([seen], terrain=slope)
        assert mapper.nearest.id == lib.VISTA_ID_GROUND
        assert [o.id for o in mapper.obstacles if o.in_collision_volume] == [lib.VISTA_ID_GROUND]


def test_what_is_too_near_never_hides_ground_that_is_seen() -> None:
    mapper = Map()
    too_near = ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 7.3})
    for coasting, nearest in ((False, lib.VISTA_ID_GROUND), (True, lib.VISTA_ID_TOO_NEAR)):
        ground = ground_ahead(20.0, coasting=coasting)
        mapper.update([], FORWARD, None, too_near, terrain=ground)
        assert [o.kind for o in mapper.obstacles] == [lib.VISTA_OBSTACLE_TOO_NEAR, lib.VISTA_OBSTACLE_GROUND]
        assert mapper.nearest.id == nearest


def test_what_is_too_near_is_seen_where_the_path_leads_whatever_the_camera_looks_at() -> None:
    for velocity in (FORWARD, (4.0, -1.0, 8.0), (5.0, 0.0, 0.0), (0.0, 0.0, -5.0)):
        mapper = Map()
        mapper.update([], velocity, None, ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 2.0}))
        (found,) = mapper.obstacles
        face = lib.vista_obstacle_map_faces(mapper.handle)[0]
        beside = np.array(list(found.position_m))[:2]
        assert list(face.middle_m)[:2] == pytest.approx(beside, abs=1e-9)
        assert face.range_m == pytest.approx(2.0) or found.position_m[2] < 0.05
        assert np.isfinite([*face.half_m, *face.aside, *face.up, face.range_m]).all()


def test_the_volume_is_2_m_by_100_m_and_discs_count_with_their_edge() -> None:
    none = {"inflation_sigma": 0.0}
    for x, inside in ((2.49, True), (2.51, False), (-2.49, True), (-2.51, False)):
        assert in_volume((x, 0, 50.0), changes=none) == inside
    for y, inside in ((2.39, True), (2.41, False)):
        assert in_volume((0, y, 50.0), changes=none) == inside
    assert in_volume((0, 0, 101.9), changes=none)
    assert not in_volume((0, 0, 102.1), changes=none)


def test_a_wide_wall_beside_its_centre_is_in_the_way() -> None:
    assert in_volume((30.0, 0, 60.0), extent=(60.0, 4.0))
    assert not in_volume((34.0, 0, 60.0), extent=(60.0, 4.0))


def test_range_uncertainty_alone_puts_nothing_into_the_volume() -> None:
    """10 m beside the path at 80 m, the range uncertain by 20 m along the line of sight."""
    ray = np.array([10.0, 0.0, 80.0])
    unit = ray / np.linalg.norm(ray)
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = 20.0**2 * np.outer(unit, unit) + 0.01 * np.eye(3)
    for inflation in (1.0, 3.0):
        changes = {"inflation_sigma": inflation}
        assert not in_volume(ray, changes=changes, covariance=covariance.ravel().tolist())
    bearing = 0.01 * np.eye(6)
    bearing[0, 0] = 4.0**2  # across the line of sight it does count
    assert in_volume(ray, changes={"inflation_sigma": 2.0}, covariance=bearing.ravel().tolist())


def test_inflation_is_the_stated_number_of_bearing_sigmas() -> None:
    sigma, z = 0.4, 50.0
    for k in (0.0, 1.0, 2.5):
        edge = 2.0 + 0.5 + k * sigma
        assert in_volume((edge - 0.01, 0, z), sigma_m=sigma * (1 - 0.002), changes={"inflation_sigma": k})
        assert not in_volume((edge + 0.02, 0, z), sigma_m=sigma, changes={"inflation_sigma": k})


def test_the_volume_lies_along_the_flight_not_the_optical_axis() -> None:
    slip = np.array([3.0, 0.0, 9.0])
    along = 50 * slip / np.linalg.norm(slip)
    assert in_volume(along, velocity=slip)
    assert not in_volume((0, 0, 50.0), velocity=slip)
    assert in_volume((0, 0, 50.0), velocity=(0, 0, 0))  # standing still: the optical axis
    assert in_volume((0, 0, 50.0), velocity=(0.3, 0, 0))  # slower than VISTA_SPEED_MIN_M_S


def test_against_dense_sampling_of_disc_and_cylinder() -> None:
    random = seeded(1)
    t, r = np.meshgrid(np.linspace(0, 2 * np.pi, 180), np.linspace(0, 1, 40))
    answers = []
    for _ in range(300):
        turn = Rotation.from_euler("xyz", random.normal(0, 15, 3), degrees=True).as_matrix()
        position = random.uniform(-20, 20, 3)
        velocity = turn @ (random.normal(size=3) * [1.5, 1.5, 1] + [0, 0, 9])
        center = position + turn @ (random.uniform(-1, 1, 3) * [8, 8, 25] + [0, 0, 30])
        extent = random.uniform(0.2, 12, 2)
        found = in_volume(
            center, velocity, pose(position, turn), {"inflation_sigma": 0.0}, extent=extent.tolist()
        )
        points = (
            center
            + (0.5 * extent[0] * r * np.cos(t))[..., None] * turn[:, 0]
            + (0.5 * extent[1] * r * np.sin(t))[..., None] * turn[:, 1]
        )
        offset, direction = points - position, velocity / np.linalg.norm(velocity)
        along = np.clip(offset @ direction, 0, 100)[..., None]
        nearest = np.linalg.norm(offset - along * direction, axis=-1).min()
        if abs(nearest - 2.0) > 0.1:  # twice the sampling distance
            assert found == (nearest < 2.0)
            answers.append(found)
    assert 30 < sum(answers) < len(answers) - 30


def test_time_to_collision_counts_along_the_flight_and_with_the_obstacle() -> None:
    mapper = Map()
    mapper.update([track((1.0, 0, 30.0))])
    assert mapper.nearest.distance_m == pytest.approx(math.hypot(0.75, 30))  # half way to its edge
    assert mapper.nearest.time_to_collision_s == pytest.approx(30 / 9)
    mapper.update([track((0, 0, 30.0), velocity_m_s=[0, 0, -6.0])])
    assert mapper.nearest.time_to_collision_s == pytest.approx(2.0)
    for away in (8.6, 9.0, 12.0):  # closing by less than CLOSING_MIN_M_S: anything from minutes to never
        mapper.update([track((0, 0, 30.0), velocity_m_s=[0, 0, away])])
        assert mapper.nearest.valid
        assert math.isnan(mapper.nearest.time_to_collision_s)
    mapper.update([track((0, 0, 30.0))], (0, 0, 0))
    assert math.isnan(mapper.nearest.time_to_collision_s)


def test_without_velocity_there_is_no_time_to_collision() -> None:
    mapper = Map()
    mapper.update([track((0, 0, 30.0))], None)
    assert mapper.nearest.valid
    assert math.isnan(mapper.nearest.time_to_collision_s)


def test_fields_of_a_tracked_obstacle() -> None:
    """They come through the tracker, camera turned: what was seen keeps its ellipse, what coasts is
    predicted."""
    turn = Rotation.from_euler("xyz", [4, -7, 3], degrees=True).as_matrix()
    point, tracker, mapper = np.array([2.0, -1.0, 40.0]), Tracker(), Map()
    for frame in range(5):
        position = np.array([0, 0, 0.8 * frame])
        seen = seen_at(point, position, turn)
        tracker.update(0.1 * frame, [seen], position, turn)
        mapper.update(list(tracker.tracks.values()), None, pose(position, turn))
    (found,) = mapper.obstacles
    assert (found.id, found.confirmed, found.coasting, found.age_frames) == (1, True, False, 5)
    assert found.distance_m == pytest.approx(np.linalg.norm(point - position), abs=0.01)
    assert list(found.position_m) == pytest.approx(point, abs=0.01)
    assert list(found.extent_m) == pytest.approx([1.0, 0.8])
    assert found.disparity_px == pytest.approx(seen["disparity_px"], abs=0.01)
    assert [found.ellipse.center_u_px, found.ellipse.center_v_px] == pytest.approx(seen["ellipse"][:2])
    position = np.array([0, 0, 12.0])
    tracker.update(0.5, [], position, turn)
    mapper.update(list(tracker.tracks.values()), None, pose(position, turn))
    (found,) = mapper.obstacles
    u, v, d = measure(point, position, turn)
    assert found.coasting
    assert [found.ellipse.center_u_px, found.ellipse.center_v_px] == pytest.approx([u, v], abs=0.5)
    assert found.disparity_px == pytest.approx(d, abs=0.05)
    z = FOCAL * BASELINE / d
    assert found.ellipse.axis_a_px == pytest.approx(0.5 * FOCAL / z, rel=0.01)
    assert found.ellipse.axis_b_px == pytest.approx(0.4 * FOCAL / z, rel=0.01)
    assert CENTER[0] != u


@pytest.mark.parametrize("speed", [3.048, 9.144])  # the paper's 10 and 30 ft/s
def test_a_sign_in_the_flight_path_is_announced_until_it_is_passed(speed: float) -> None:
    random, sign, aside = seeded(3), np.array([0.3, -0.2, 70.0]), np.array([12.0, 0.0, 60.0])
    tracker, mapper, announced = Tracker(), Map(), []
    for frame in range(int(69.5 / speed / 0.1)):
        position = np.array([0.0, 0.0, speed * 0.1 * frame])
        items = []
        for point in (sign, aside):
            u, v, d = measure(point, position) + random.normal(size=3) * SIGMAS
            if d < 31 and 36 < u < 634 and point[2] > position[2]:
                items.append(detection((u, v, d)))
        here = pose(position)
        tracker.update(0.1 * frame, items, position)
        mapper.update(list(tracker.tracks.values()), (0, 0, speed), here)
        if position[2] < 30.0:
            continue  # until its own travel tells that the sign does not move along
        assert mapper.nearest.valid
        distance = sign[2] - position[2]
        error = np.linalg.norm(np.subtract(list(mapper.nearest.position_m), sign))
        assert error <= 2 * max(distance, 14.7) ** 2 / (FOCAL * BASELINE)  # the paper's bound, 2 dz(r)
        announced.append(mapper.nearest.time_to_collision_s - distance / speed)
    assert tracker.tracks[mapper.nearest.id].in_blind_zone
    assert np.abs(announced[-int(20 / speed) :]).max() < 1.0 / speed + 0.1


# ---- in a bend ----

BEND_M = 30.0  # radius, to the right


def on_bend(along_m: float, aside_m: float = 0.0) -> tuple[float, float, float]:
    """aside_m: to the outside."""
    angle, radius_m = along_m / BEND_M, BEND_M + aside_m
    return BEND_M - radius_m * math.cos(angle), 0.0, radius_m * math.sin(angle)


def bend(position, changes=None, **keywords) -> Map:
    mapper = Map(**(changes or {}))
    arc = {"normal": (1.0, 0.0, 0.0), "curvature_1_m": 1.0 / BEND_M, "length_m": 25.0}
    mapper.update([track(position, extent=(0.2, 1.0), **keywords)], **arc)
    return mapper


@pytest.mark.parametrize("along_m", [6.0, 15.0, 24.0])
def test_a_post_on_the_arc_is_in_the_way_and_one_beside_it_is_not(along_m: float) -> None:
    on_it = bend(on_bend(along_m))
    assert on_it.nearest.valid
    assert on_it.nearest.time_to_collision_s == pytest.approx(along_m / FORWARD[2], rel=1e-6)
    assert bend(on_bend(along_m, 1.7)).nearest.valid and bend(on_bend(along_m, -1.7)).nearest.valid
    assert not bend(on_bend(along_m, 2.6)).nearest.valid
    assert not bend(on_bend(along_m, -2.6)).nearest.valid


def test_what_coasts_far_along_a_bend_has_to_be_nearer_to_it() -> None:
    """Its curvature may be a quarter more or less: 24 m on, half a sigma of that is 1.2 m."""
    narrower = {"path_sigmas": 0.5}
    assert not bend(on_bend(24.0, 1.7), narrower).nearest.valid
    assert bend(on_bend(24.0, 0.7), narrower).nearest.valid
    assert bend(on_bend(6.0, 1.7), narrower).nearest.valid


def test_straight_ahead_of_a_bend_is_the_outside() -> None:
    assert in_volume((0.0, 0.0, 20.0)) and not bend((0.0, 0.0, 20.0)).nearest.valid
    assert not bend(on_bend(30.0)).nearest.valid  # beyond the length
    assert not bend(on_bend(-3.0)).obstacles


def test_time_to_collision_in_a_bend_is_along_it() -> None:
    """What comes towards the aircraft on the arc, at 3 m/s."""
    angle = 20.0 / BEND_M
    mapper = bend(on_bend(20.0), velocity_m_s=[-3.0 * math.sin(angle), 0.0, -3.0 * math.cos(angle)])
    assert mapper.nearest.time_to_collision_s == pytest.approx(20.0 / 12.0, rel=1e-6)


# ---- places on the path that the last frames show ----


class MapOverSpace(Map):
    """The map of the frame that a map of space took last."""

    def __init__(self, space: Space, tracks=(), terrain=ffi.NULL, blind_zone=ffi.NULL, max_tracks=8) -> None:
        super().__init__(max_tracks)
        items, places = ffi.new("vista_track[]", [one[0] for one in tracks]), ffi.new("vista_path_places *")
        lib.vista_path_places_look(space.frame, space.handle, places)
        given = [items, len(tracks), terrain, blind_zone, space.handle, places]
        lib.vista_obstacle_map_update(self.handle, space.frame, ffi.new("vista_map_input *", given))

    @property
    def ids(self) -> list[int]:
        return [obstacle.id for obstacle in self.obstacles]

    @property
    def in_the_way(self) -> list[int]:
        return [obstacle.id for obstacle in self.obstacles if obstacle.in_collision_volume]


PLACE = lib.VISTA_ID_PLACE


def watched(*walls: Wall, **keywords) -> Space:
    """Walls before a far one, of which the frames that are kept all show the same."""
    space = Space()
    space.watch(scene([*walls, Wall(500.0)], ground_y_m=9.0), velocity=FORWARD, length_m=60.0, **keywords)
    return space


def test_what_no_track_stands_for_is_an_obstacle_as_wide_as_the_volume() -> None:
    random = seeded(12)
    for z_m in random.uniform(7.0, 30.0, 10):
        mapper = MapOverSpace(watched(Wall(z_m)))
        (found,) = mapper.obstacles
        assert (found.id, found.kind) == (PLACE, lib.VISTA_OBSTACLE_PLACE)
        assert found.confirmed and found.in_collision_volume
        assert not found.coasting and not found.in_blind_zone and found.world == lib.VISTA_WORLD_OPEN
        assert found.age_frames == SPACE_FRAMES
        assert list(found.position_m) == pytest.approx([0.0, 0.0, z_m], abs=0.05 * z_m)
        assert found.position_m[2] == pytest.approx(z_m, abs=z_m**2 / (FOCAL_PX * BASELINE_M) / 16)
        assert found.distance_m == pytest.approx(np.linalg.norm(list(found.position_m)))
        assert list(found.extent_m) == [2.0 * RADIUS_M] * 2
        assert found.disparity_px == pytest.approx(FOCAL_PX * BASELINE_M / z_m, abs=1 / 16)
        assert found.ellipse.axis_a_px == pytest.approx(RADIUS_M * FOCAL_PX / found.position_m[2])
        covariance = np.array(list(found.covariance_m2)).reshape(3, 3)
        assert np.all(np.linalg.eigvalsh(covariance) > 0) and covariance == pytest.approx(covariance.T)
        dz_m = z_m**2 / (FOCAL_PX * BASELINE_M)
        assert 0.2 * dz_m < np.sqrt(covariance[2, 2]) < dz_m
        assert mapper.nearest.valid and mapper.nearest.id == PLACE
        assert mapper.nearest.distance_m == pytest.approx(z_m, rel=0.05)
        assert mapper.nearest.time_to_collision_s == pytest.approx(z_m / FORWARD[2], rel=0.05)


def test_without_anything_on_the_path_there_is_no_such_obstacle() -> None:
    assert MapOverSpace(watched()).obstacles == []
    assert MapOverSpace(watched(Wall(20.0, x_m=(3.5, 9.0)))).obstacles == []
    few = watched(Wall(20.0), frames=2)
    assert MapOverSpace(few).obstacles == []


def test_a_confirmed_track_stands_for_what_is_matched_at_it() -> None:
    mapper = MapOverSpace(watched(Wall(20.0)), [track((0.0, 0.0, 20.0), 5)])
    assert mapper.ids == mapper.in_the_way == [5]
    assert mapper.nearest.id == 5


def test_a_wall_at_an_angle_stands_for_what_is_matched_where_it_is_met() -> None:
    """Its middle is 7 m behind that, and beside the path."""
    angled = {"extent": (16.0, 6.0), "met": True, "met_m": [0.2, 0.0, 20.1], "met_sigma_m": 0.3}
    mapper = MapOverSpace(watched(Wall(20.0)), [track((8.0, 0.0, 26.0), 5, coasting=False, **angled)])
    assert mapper.ids == mapper.in_the_way == [5]
    assert mapper.nearest.distance_m == pytest.approx(20.1, abs=0.1)


def test_another_track_does_not_stand_for_it() -> None:
    """One that is not confirmed, one behind it, one beside the path, one that is far aside."""
    space = watched(Wall(20.0))
    for item in (
        track((0.0, 0.0, 20.0), 5, confirmed=False),
        track((0.0, 0.0, 32.0), 5),
        track((2.5, 0.0, 20.3), 5, extent=(3.0, 3.0), coasting=False, volume_window=0),
        track((9.0, 0.0, 18.0), 5, coasting=False, volume_window=0),
    ):
        mapper = MapOverSpace(space, [item])
        assert sorted(mapper.ids) == [PLACE, 5]
        assert mapper.nearest.id == PLACE


def test_it_is_held_where_it_was_seen_last() -> None:
    """Nothing is matched in the last two frames, while the aircraft flies on."""
    space = Space()
    wall = Wall(24.0)
    for k in range(6):
        look = scene([wall], position=(0.0, 0.0, 0.9 * k))
        if k > 3:
            look = replace(look, words=UNMATCHED.words)
        space.take(look, 0.1 * k, velocity=FORWARD, length_m=60.0)
    (found,) = MapOverSpace(space).obstacles
    assert found.id == PLACE and found.coasting
    assert found.position_m[2] == pytest.approx(24.0, rel=0.02)
    assert found.distance_m == pytest.approx(24.0 - 4.5, rel=0.03)


def test_what_is_not_confirmed_is_in_the_way_where_the_frames_do_not_see_through() -> None:
    """What moves is not where they saw it, and what enters is not there yet: neither is asked."""
    free, wall = watched(), watched(Wall(20.0))
    stands = track((0.0, 0.0, 20.0), 5, confirmed=False)
    assert MapOverSpace(free, [stands]).in_the_way == []
    assert 5 in MapOverSpace(wall, [stands]).in_the_way
    moves = track((0.0, 0.0, 20.0), 5, confirmed=False, world={"verdict": lib.VISTA_WORLD_MOVES})
    assert MapOverSpace(free, [moves]).in_the_way == [5]
    across = {"coasting": False, "volume_window": 0, "misses": 0, "velocity_m_s": [-4.0, 0.0, 0.0]}
    enters = track((3.2, 0.0, 20.0), 5, confirmed=False, extent=(0.5, 0.5), **across)
    assert MapOverSpace(free, [enters]).in_the_way == [5]


def test_the_path_is_free_no_farther_than_what_may_fly_into_it() -> None:
    """It is where the aircraft will be in 3.5 s. One that goes away, or stands, does not bound it; three hits
    whose motion is two standard deviations are enough, and no warning."""
    space = watched()

    def free_m(velocity, sigma_m: float = 0.3, **changes) -> float:
        flies = {"coasting": False, "volume_window": 0, "velocity_m_s": velocity, "hits": 3}
        flies |= {"credible": False, "confirmed": False}
        mapper = MapOverSpace(space, [track((7.0, 0.0, 31.5), 5, sigma_m, **flies | changes)])
        assert mapper.in_the_way == []
        return lib.vista_obstacle_map_free_m(mapper.handle)

    assert free_m([-2.0, 0.0, 0.0]) == pytest.approx(31.5)
    assert free_m([2.0, 0.0, 0.0]) == free_m([0.0, 0.0, 0.0]) > 50.0
    assert free_m([-2.0, 0.0, 0.0], hits=2) > 50.0
    assert free_m([-2.0, 0.0, 0.0], sigma_m=1.5) > 50.0
    assert free_m([-2.0, 0.0, 0.0], world={"foot_count": 5.0, "foot_share": 0.2}) > 50.0


def test_there_is_room_for_all_that_has_no_track() -> None:
    """The map has room for as many tracks as there may be and a place; nearest first."""
    random = seeded(13)
    too_near = ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 5.0})
    tracks = [track((random.uniform(8, 12), 0, random.uniform(5, 60)), 1 + k) for k in range(8)]
    mapper = MapOverSpace(watched(Wall(15.0)), tracks, ground_ahead(35.0), too_near)
    without = {lib.VISTA_ID_TOO_NEAR, lib.VISTA_ID_GROUND, PLACE}
    assert set(mapper.ids) == without | {1 + k for k in range(8)}
    assert [o.distance_m for o in mapper.obstacles] == sorted(o.distance_m for o in mapper.obstacles)
    assert mapper.nearest.id == PLACE  # it is seen, beyond what is too near to match
