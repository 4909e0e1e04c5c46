"""OBSTACLE_DISTANCE and OBSTACLE_DISTANCE_3D: every obstacle in its sector, clear only what was seen."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from mavlink_link import (
    COLUMNS,
    FIRST_DEG,
    UNKNOWN,
    Aircraft,
    Link,
    Thing,
    clear_sectors,
    columns,
    dialect,
    obstacle_sectors,
    of_kind,
)
from random_seed import seeded
from stage_library import lib

HEADINGS_DEG = range(0, 360, 45)
ATTITUDES_DEG = [(0.0, 0.0), (20.0, -10.0), (-15.0, 25.0)]  # roll, pitch
LEVEL_M = 12.0


def mounts_deg(sector: int) -> tuple[float, float, float]:
    """A camera that has the sector in view, and hangs neither level nor straight."""
    return (3.0, -5.0, float(round(5 * sector / 45) * 45))


@pytest.mark.parametrize("attitude_deg", ATTITUDES_DEG)
@pytest.mark.parametrize("heading_deg", HEADINGS_DEG)
def test_an_obstacle_is_in_its_sector_and_nowhere_else(heading_deg: int, attitude_deg) -> None:
    for sector in range(72):
        aircraft = Aircraft((*attitude_deg, heading_deg), mounts_deg(sector))
        thing = Thing(aircraft.at_bearing(5.0 * sector, LEVEL_M))
        assert thing.position_camera_m[2] > 0.0  # in front of the camera
        link = Link("px4", aircraft)
        assert link.update([thing]) == "VISTA_OK"
        message = link.one("OBSTACLE_DISTANCE")
        assert message.frame == dialect.MAV_FRAME_BODY_FRD
        assert (message.increment, message.increment_f, message.angle_offset) == (5, 0.0, 0.0)
        found = obstacle_sectors(message)
        assert list(found) == [sector]
        assert 100 * LEVEL_M - 10 <= found[sector] <= 100 * LEVEL_M
        assert {d for k, d in enumerate(message.distances) if k != sector} == {UNKNOWN}


@pytest.mark.parametrize("attitude_deg", ATTITUDES_DEG)
@pytest.mark.parametrize("heading_deg", HEADINGS_DEG)
def test_a_point_is_in_its_place_in_the_body(heading_deg: int, attitude_deg) -> None:
    for sector in range(72):
        aircraft = Aircraft((*attitude_deg, heading_deg), mounts_deg(sector))
        thing = Thing(aircraft.at_bearing(5.0 * sector, LEVEL_M))
        link = Link("ardupilot", aircraft)
        assert link.update([thing]) == "VISTA_OK"
        message = link.one("OBSTACLE_DISTANCE_3D")
        assert message.frame == dialect.MAV_FRAME_BODY_FRD
        body_m = aircraft.body_from_camera @ thing.position_camera_m
        np.testing.assert_allclose([message.x, message.y, message.z], body_m, atol=0.06)


@pytest.mark.parametrize("attitude_deg", ATTITUDES_DEG)
def test_clear_is_what_the_camera_saw_in_the_whole_sector(attitude_deg) -> None:
    """Brute force tells: every hundredth of a degree of a clear sector lies in a free column."""
    random = seeded(1)
    for _ in range(20):
        yaw_deg = random.uniform(-180.0, 180.0)
        aircraft = Aircraft((*attitude_deg, random.uniform(0.0, 360.0)), (2.0, -4.0, yaw_deg))
        half_deg = random.integers(10, 50)
        hole = random.integers(-half_deg, half_deg)
        free_m = columns(-half_deg, half_deg)
        free_m[hole - FIRST_DEG] = 35.0  # less than max_distance_m
        link = Link("px4", aircraft)
        link.update([], free_m)
        message = link.one("OBSTACLE_DISTANCE")
        surely, perhaps = (free_sectors(aircraft, free_m, half) for half in (2.51, 2.49))
        assert surely <= clear_sectors(message) <= perhaps
        assert set(message.distances) <= {UNKNOWN, message.max_distance + 1}


def free_sectors(aircraft: Aircraft, free_m: np.ndarray, half_deg: float) -> set[int]:
    """Those that are free up to 40 m within so much of their middle."""
    found = set()
    for sector in range(72):
        bearings = np.append(5.0 * sector + np.arange(-half_deg, half_deg, 0.01), 5.0 * sector + half_deg)
        from_camera = (bearings - aircraft.camera_bearing_deg + 180.0) % 360.0 - 180.0
        column = np.floor(from_camera - FIRST_DEG).astype(int)
        inside = (column >= 0) & (column < COLUMNS)
        if inside.all() and (free_m[column] >= 40.0).all():
            found.add(sector)
    return found


def test_the_field_of_view_follows_the_mount() -> None:
    for turn in range(0, 360, 5):
        aircraft = Aircraft((0.0, 0.0, 77.0), (0.0, 0.0, float(turn)))
        link = Link("px4", aircraft)
        link.update([], columns(-30, 30))
        middle = turn // 5
        expected = {k % 72 for k in range(middle - 5, middle + 6)}
        assert clear_sectors(link.one("OBSTACLE_DISTANCE")) == expected


def test_without_a_known_up_the_aircraft_counts_as_level() -> None:
    aircraft = Aircraft((0.0, 0.0, 0.0), (0.0, -20.0, 90.0))
    link = Link("px4", aircraft)
    link.update([Thing(aircraft.at_bearing(90.0, LEVEL_M))], up_known=False)
    assert list(obstacle_sectors(link.one("OBSTACLE_DISTANCE"))) == [18]


@pytest.mark.parametrize("pitch_deg, clear", [(0.0, True), (-2.0, True), (-5.0, False), (20.0, False)])
def test_without_a_known_up_only_a_level_camera_sees_what_is_clear(pitch_deg: float, clear: bool) -> None:
    link = Link("px4", Aircraft(mount_deg=(0.0, pitch_deg, 0.0)))
    link.update([], columns(-30, 30), up_known=False)
    assert bool(clear_sectors(link.one("OBSTACLE_DISTANCE"))) == clear


def test_width_fills_the_sectors_that_it_reaches_into() -> None:
    """A board of 10 m at 10 m spans 26.6 degrees to each side: sectors -5 to 5."""
    link = Link()
    link.update([Thing(np.array([0.0, 0.0, 10.0]), width_m=10.0)], 100.0)
    message = link.one("OBSTACLE_DISTANCE")
    assert {(k + 36) % 72 - 36 for k in obstacle_sectors(message)} == set(range(-5, 6))
    assert clear_sectors(message) and not clear_sectors(message) & set(obstacle_sectors(message))


def test_the_point_that_the_path_meets_is_told_too() -> None:
    """The thing is a wall at an angle, whose middle is 20 m away and aside."""
    collision = {"valid": True, "id": 3, "position_camera_m": [0.0, 0.5, 8.0], "time_s": 1.0}
    wall = Thing(np.array([14.0, 0.0, 14.0]), width_m=6.0, height_m=6.0, id=3)
    link = Link("px4")
    link.update([wall], collision=collision)
    found = obstacle_sectors(link.one("OBSTACLE_DISTANCE"))
    assert found.pop(0) == 800
    assert set(found) == {7, 8, 9, 10, 11} and min(found.values()) > 1900
    link = Link("ardupilot")
    link.update([wall], collision=collision)
    first = of_kind(link.poll(), "OBSTACLE_DISTANCE_3D")[0]
    assert (first.x, first.y, first.z, first.obstacle_id) == (8.0, 0.0, 0.5, 3)


@pytest.mark.parametrize("number", [lib.VISTA_ID_GROUND, lib.VISTA_ID_PLACE])
def test_what_has_no_track_is_told_as_other_things_are_but_for_its_number(number: int) -> None:
    told = {}
    for id_ in (1, number):
        collision = {"valid": True, "id": id_, "position_camera_m": [0.0, 0.0, 8.0], "time_s": 1.0}
        thing = Thing(np.array([0.5, 0.0, 9.0]), width_m=4.0, height_m=4.0, id=id_)
        link, other = Link("px4"), Link("ardupilot")
        for one in (link, other):
            one.update([thing], collision=collision)
        messages = [*link.poll(), *other.poll()]
        points = of_kind(messages, "OBSTACLE_DISTANCE_3D")
        (sectors,), collisions = of_kind(messages, "OBSTACLE_DISTANCE"), of_kind(messages, "COLLISION")
        told[id_] = [(p.x, p.y, p.z) for p in points], obstacle_sectors(sectors)
        numbers = {p.obstacle_id for p in points} | {collision.id for collision in collisions}
        assert collisions and numbers == {1 if id_ == 1 else UNKNOWN}
    assert told[1] == told[number] and all(told[1])


def test_the_nearest_of_a_sector_is_told() -> None:
    things = [Thing(np.array([0.0, 0.0, z]), id=k) for k, z in enumerate((9.0, 20.0, 7.0), start=1)]
    for order in itertools.permutations(things):
        link = Link()
        link.update(list(order))
        assert obstacle_sectors(link.one("OBSTACLE_DISTANCE")) == pytest.approx({0: 695}, abs=1)


@pytest.mark.parametrize(
    "height_m, inside", [(0.0, True), (2.4, True), (2.6, False), (-2.4, True), (-2.6, False)]
)
def test_sectors_are_about_the_height_of_the_camera(height_m: float, inside: bool) -> None:
    """Half a height of 2 m, and a thing 1 m high; as a point it is told wherever it is."""
    aircraft = Aircraft((10.0, 15.0, 120.0))
    thing = Thing(aircraft.at_bearing(20.0, LEVEL_M, height_m))
    link = Link("px4", aircraft)
    link.update([thing])
    assert (list(obstacle_sectors(link.one("OBSTACLE_DISTANCE"))) == [4]) == inside
    link = Link("ardupilot", aircraft)
    link.update([thing])
    point = link.one("OBSTACLE_DISTANCE_3D")
    assert np.linalg.norm([point.x, point.y, point.z]) <= point.max_distance


@pytest.mark.parametrize("offset_deg", [-180.0, -45.0, -20.0, 5.0, 90.0])
def test_the_offset_is_where_sector_zero_is(offset_deg: float) -> None:
    for bearing_deg in range(0, 360, 5):
        aircraft = Aircraft(mount_deg=(0.0, 0.0, float(bearing_deg)))
        link = Link("px4", aircraft, {"angle_offset_deg": offset_deg})
        link.update([Thing(np.array([0.0, 0.0, LEVEL_M]))], columns(-30, 30))
        message = link.one("OBSTACLE_DISTANCE")
        (sector,) = obstacle_sectors(message)
        assert (message.angle_offset + sector * message.increment - bearing_deg) % 360.0 == 0.0
        clear_deg = {
            (message.angle_offset + k * 5 - bearing_deg + 180) % 360 - 180 for k in clear_sectors(message)
        }
        assert clear_deg == set(range(-25, 30, 5)) - {0}


def test_36_sectors_of_ten_degrees() -> None:
    for sector in range(36):
        aircraft = Aircraft(mount_deg=(0.0, 0.0, 10.0 * sector))
        link = Link("px4", aircraft, {"sectors": lib.VISTA_MAVLINK_SECTORS_36})
        link.update([Thing(np.array([0.0, 0.0, LEVEL_M]))], columns(-30, 30))
        message = link.one("OBSTACLE_DISTANCE")
        assert message.increment == 10
        assert list(obstacle_sectors(message)) == [sector]
        assert clear_sectors(message) == {(sector + k) % 36 for k in (-2, -1, 1, 2)}
        assert set(message.distances[36:]) == {UNKNOWN}


def test_something_wide_is_several_points_on_its_board() -> None:
    link = Link("ardupilot")
    link.update([Thing(np.array([0.0, 0.0, 10.0]), width_m=16.0, height_m=4.0, id=7)])
    points = of_kind(link.poll(), "OBSTACLE_DISTANCE_3D")
    assert len(points) == 5 and {p.obstacle_id for p in points} == {7}
    assert len({p.time_boot_ms for p in points}) == 1
    for point in points:
        assert point.x == pytest.approx(9.75) and abs(point.y) <= 8.01 and point.z == 0.0
    left_m, right_m = min(p.y for p in points), max(p.y for p in points)
    assert right_m == pytest.approx(-left_m) and right_m > 7.0


def test_of_something_tall_the_point_at_the_height_of_the_camera() -> None:
    link = Link("ardupilot")
    link.update([Thing(np.array([0.0, 3.0, 10.0]), height_m=8.0)])  # its middle is 3 m below
    assert link.one("OBSTACLE_DISTANCE_3D").z == 0.0
    link = Link("ardupilot")
    link.update([Thing(np.array([0.0, 3.0, 10.0]), height_m=2.0)])
    assert link.one("OBSTACLE_DISTANCE_3D").z == pytest.approx(2.0)


def test_a_camera_that_looks_down_sees_nothing_level() -> None:
    link = Link("px4", Aircraft(mount_deg=(0.0, -90.0, 0.0)))
    link.update([], 100.0)
    assert set(link.one("OBSTACLE_DISTANCE").distances) == {UNKNOWN}


def test_an_aircraft_on_its_tail_has_no_sectors() -> None:
    aircraft = Aircraft((0.0, 90.0, 0.0))
    link = Link("px4", aircraft)
    link.update([Thing(np.array([0.0, 0.0, 10.0]))], 100.0)
    assert set(link.one("OBSTACLE_DISTANCE").distances) == {UNKNOWN}


MIDDLES_DEG = FIRST_DEG + np.arange(COLUMNS) + 0.5


def wall(aside_m: float, first_deg: float, last_deg: float) -> tuple[Thing, np.ndarray]:
    """A wall along the path, so far to the right, as a board at its middle; and where it blocks columns."""
    azimuths = np.radians([first_deg, last_deg])
    depth_m = float(np.mean(aside_m / np.tan(azimuths)))
    across_m = depth_m * np.tan(azimuths)
    board = Thing(
        np.array([across_m.mean(), 0.0, depth_m]), width_m=float(np.ptp(across_m)), height_m=6.0, id=3
    )
    inside = (first_deg < MIDDLES_DEG) & (last_deg > MIDDLES_DEG)
    return board, np.where(inside, aside_m / np.sin(np.radians(np.where(inside, MIDDLES_DEG, 90.0))), 0.0)


@pytest.mark.parametrize("mount_deg", [0.0, 90.0, -135.0])
def test_a_wall_at_an_angle_is_as_near_as_it_is_seen_in_each_sector(mount_deg: float) -> None:
    """5 m beside the path, from 10 to 35 degrees. Its far half is no nearer than its middle is."""
    board, blocked_m = wall(5.0, 10.0, 35.0)
    middle_m = np.hypot(*board.position_camera_m[[0, 2]]) - 0.25
    link = Link("px4", Aircraft(mount_deg=(0.0, 0.0, mount_deg)))
    link.update([board], blocked_m=blocked_m)
    found = obstacle_sectors(link.one("OBSTACLE_DISTANCE"))
    turn = round(mount_deg / 5)
    assert {(k - turn) % 72 for k in found} == set(range(2, 8))
    for sector in range(2, 8):
        told_m = found[(sector + turn) % 72] / 100
        left_deg, right_deg = max(5.0 * sector - 2.5, 10.0), min(5.0 * sector + 2.5, 35.0)
        nearest_m, at_middle_m = 5.0 / np.sin(np.radians([right_deg, 0.5 * (left_deg + right_deg)]))
        assert min(nearest_m, middle_m) - 0.1 <= told_m <= min(at_middle_m, middle_m) + 0.1
    link = Link("ardupilot", Aircraft(mount_deg=(0.0, 0.0, mount_deg)))
    link.update([board], blocked_m=blocked_m)
    turned = link.aircraft.body_from_camera.T
    for point in of_kind(link.poll(), "OBSTACLE_DISTANCE_3D"):
        x_m, _, z_m = turned @ [point.x, point.y, point.z]
        assert x_m <= 5.1 and z_m <= 5.0 / np.tan(np.radians(10.0))


def test_other_things_do_not_bring_an_obstacle_nearer() -> None:
    """What blocks beyond it, far before it, or beside it; and a pole before a wall is the pole's own."""
    board = Thing(np.array([0.0, 0.0, 20.0]), width_m=2.0, height_m=2.0)
    for blocked_m in (
        np.full(COLUMNS, 30.0),
        np.full(COLUMNS, 12.0),
        np.where(np.abs(MIDDLES_DEG) < 4.0, 0.0, 18.0),
        np.full(COLUMNS, np.nan),
        np.full(COLUMNS, -19.0),
    ):
        alone, other = Link(), Link()
        alone.update([board])
        other.update([board], blocked_m=blocked_m)
        found = other.one("OBSTACLE_DISTANCE").distances
        assert found == alone.one("OBSTACLE_DISTANCE").distances
    pole = Thing(np.array([0.0, 0.0, 20.0]), width_m=0.2, height_m=2.0)
    link = Link()
    link.update([pole], blocked_m=18.0)
    assert obstacle_sectors(link.one("OBSTACLE_DISTANCE")) == pytest.approx({0: 1995}, abs=1)


def test_where_up_is_not_known_columns_of_a_tilted_camera_tell_nothing_of_an_obstacle() -> None:
    for pitch_deg, nearer in ((0.0, True), (-5.0, False)):
        link = Link("px4", Aircraft(mount_deg=(0.0, pitch_deg, 0.0)))
        link.update([Thing(np.array([0.0, 0.0, 20.0]), width_m=4.0)], blocked_m=17.0, up_known=False)
        found = obstacle_sectors(link.one("OBSTACLE_DISTANCE"))
        assert (min(found.values()) == 1700) == nearer
