"""The obstacle map: distances, ellipses, the collision volume and the time to collision."""

from __future__ import annotations

import math

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from stage_arena import Arena, ffi, lib, status_name
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
    params,
    pose,
    seen_at,
)

NAN = float("nan")
FORWARD = (0.0, 0.0, 9.0)
LASTING = ("disparity_px", "range_m", "center_px", "center_ratio", "scatter")


class Map:
    def __init__(self, max_tracks: int = 32, **changes: float) -> None:
        out = ffi.new("vista_obstacle_map **")
        self._arena = Arena(lambda arena: lib.vista_obstacle_map_layout(max_tracks, arena, out))
        assert self._arena.status == lib.VISTA_OK
        self.handle, self.params = out[0], params("obstacle_map", **{"thickness_ratio": 0.0} | changes)
        self.camera = camera()

    def update(
        self,
        tracks=(),
        velocity=FORWARD,
        raw_pose=None,
        blind_zone=ffi.NULL,
        length_m=None,
        terrain=ffi.NULL,
        **arc,
    ) -> str:
        """arc: normal and curvature_1_m."""
        items = ffi.new("vista_track[]", [track[0] for track in tracks])
        moved = motion(raw_pose, velocity)
        path = flight_path(moved, length_m or self.params.collision_length_m, **arc)
        return status_name(
            lib.vista_obstacle_map_update(
                self.handle,
                self.params,
                self.camera,
                moved,
                path,
                blind_zone,
                terrain,
                items,
                len(tracks),
            )
        )

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
    assert mapper.update([track(position, **keywords)], velocity, raw_pose) == "VISTA_OK"
    return mapper.obstacles[0].in_collision_volume


def share_of_large(extent_m: float) -> float:
    return float(np.clip((extent_m - 3.0) / 1.5, 0.0, 1.0))


def test_what_is_large_is_met_where_its_own_points_say_and_what_is_compact_is_not() -> None:
    """A wall seen at an angle, its middle at 40 m; a board."""
    met = {"met": True, "met_m": [0.5, 0.0, 31.0]}
    for extent, range_m in (((12.0, 8.0), 31.0), ((1.5, 2.0), 40.0)):
        mapper = Map()
        assert mapper.update([track((1.0, 0.0, 40.0), extent=extent, **met)]) == "VISTA_OK"
        assert mapper.nearest.position_m[2] == pytest.approx(range_m)
        assert mapper.nearest.distance_m == pytest.approx(range_m, abs=0.02)


def test_a_hillside_that_is_a_region_too_is_no_collision_of_its_own() -> None:
    """Its middle is far off the plane that the ground is met on; where the path meets it is not."""
    slope = ground_ahead(30.0)
    hill = track((4.0, -9.0, 38.0), 5, extent=(40.0, 25.0), met=True, met_m=[0.3, 1.7, 30.2])
    mapper = Map()
    assert mapper.update([hill], terrain=slope) == "VISTA_OK"
    assert mapper.nearest.id == lib.VISTA_ID_GROUND
    assert [o.id for o in mapper.obstacles if o.in_collision_volume] == [lib.VISTA_ID_GROUND]


def test_what_is_too_near_never_hides_ground_that_is_seen() -> None:
    mapper = Map()
    too_near = ffi.new("vista_blind_zone *", {"occupied": True, "range_m": 7.3})
    for coasting, nearest in ((False, lib.VISTA_ID_GROUND), (True, lib.VISTA_ID_TOO_NEAR)):
        ground = ground_ahead(20.0, coasting=coasting)
        assert mapper.update([], FORWARD, None, too_near, terrain=ground) == "VISTA_OK"
        assert [o.kind for o in mapper.obstacles] == [lib.VISTA_OBSTACLE_TOO_NEAR, lib.VISTA_OBSTACLE_GROUND]
        assert mapper.nearest.id == nearest


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
    assert in_volume((0, 0, 50.0), velocity=(0.3, 0, 0))  # slower than motion.speed_min_m_s


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
    for away in (8.6, 9.0, 12.0):  # closing by less than closing_min_m_s: anything from minutes to never
        mapper.update([track((0, 0, 30.0), velocity_m_s=[0, 0, away])])
        assert mapper.nearest.valid
        assert math.isnan(mapper.nearest.time_to_collision_s)
    mapper.update([track((0, 0, 30.0))], (0, 0, 0))
    assert math.isnan(mapper.nearest.time_to_collision_s)


def test_without_velocity_there_is_no_time_to_collision() -> None:
    mapper = Map()
    assert mapper.update([track((0, 0, 30.0))], None) == "VISTA_OK"
    assert mapper.nearest.valid
    assert math.isnan(mapper.nearest.time_to_collision_s)


def test_fields_of_a_tracked_obstacle() -> None:
    """Through the tracker, camera turned: what was seen keeps its ellipse, what coasts is predicted."""
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
        assert tracker.update(0.1 * frame, items, position) == "VISTA_OK"
        assert mapper.update(list(tracker.tracks.values()), (0, 0, speed), here) == "VISTA_OK"
        if position[2] < 30.0:
            continue  # until its own travel tells that the sign does not move along
        assert mapper.nearest.valid
        distance = sign[2] - position[2]
        error = np.linalg.norm(np.subtract(list(mapper.nearest.position_m), sign))
        assert error <= 2 * max(distance, 14.7) ** 2 / (FOCAL * BASELINE)  # the paper's bound, 2 dz(r)
        announced.append(mapper.nearest.time_to_collision_s - distance / speed)
    assert tracker.tracks[mapper.nearest.id].in_blind_zone
    assert np.abs(announced[-int(20 / speed) :]).max() < 1.0 / speed + 0.1


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (([], (0, NAN, 0)), "VISTA_ERROR_NUMBER"),
        (([], FORWARD, pose((NAN, 0, 0))), "VISTA_ERROR_NUMBER"),
        (([], FORWARD, pose((0, 0, 0), np.eye(3) * 2)), "VISTA_ERROR_RANGE"),
        (([track((0, 0, NAN))], FORWARD), "VISTA_ERROR_NUMBER"),
        (([track((0, 0, 9))] * 33, FORWARD), "VISTA_ERROR_CAPACITY"),
    ],
)
def test_on_errors_nothing_changes(arguments, status: str) -> None:
    mapper = Map()
    mapper.update([])
    mapper.update([track((0, 0, 30.0))], None, pose((0, 0, 3.0)))
    before = mapper.memory()
    assert mapper.update(*arguments) == status
    assert mapper.memory() == before


@pytest.mark.parametrize(
    ("name", "value"), [("collision_radius_m", 0.0), ("collision_length_m", NAN), ("inflation_sigma", -1.0)]
)
def test_parameters_out_of_range_are_refused(name: str, value: float) -> None:
    mapper = Map()
    setattr(mapper.params, name, value)
    assert mapper.update() == "VISTA_ERROR_RANGE"
    out = ffi.new("vista_obstacle_map **")
    short = Arena(lambda arena: lib.vista_obstacle_map_layout(8, arena, out), missing_bytes=1)
    assert status_name(short.status) == "VISTA_ERROR_MEMORY"


# ---- in a bend ----

BEND_M = 30.0  # radius, to the right


def on_bend(along_m: float, aside_m: float = 0.0) -> tuple[float, float, float]:
    """aside_m: to the outside."""
    angle, radius_m = along_m / BEND_M, BEND_M + aside_m
    return BEND_M - radius_m * math.cos(angle), 0.0, radius_m * math.sin(angle)


def bend(position, **keywords) -> Map:
    mapper = Map()
    arc = {"normal": (1.0, 0.0, 0.0), "curvature_1_m": 1.0 / BEND_M, "length_m": 25.0}
    assert mapper.update([track(position, extent=(0.2, 1.0), **keywords)], **arc) == "VISTA_OK"
    return mapper


@pytest.mark.parametrize("along_m", [6.0, 15.0, 24.0])
def test_a_post_on_the_arc_is_in_the_way_and_one_beside_it_is_not(along_m: float) -> None:
    on_it = bend(on_bend(along_m))
    assert on_it.nearest.valid
    assert on_it.nearest.time_to_collision_s == pytest.approx(along_m / FORWARD[2], rel=1e-6)
    assert bend(on_bend(along_m, 1.7)).nearest.valid and bend(on_bend(along_m, -1.7)).nearest.valid
    assert not bend(on_bend(along_m, 2.6)).nearest.valid
    assert not bend(on_bend(along_m, -2.6)).nearest.valid


def test_straight_ahead_of_a_bend_is_the_outside() -> None:
    assert in_volume((0.0, 0.0, 20.0)) and not bend((0.0, 0.0, 20.0)).nearest.valid
    assert not bend(on_bend(30.0)).nearest.valid  # beyond the length
    assert not bend(on_bend(-3.0)).obstacles


def test_time_to_collision_in_a_bend_is_along_it() -> None:
    """What comes towards the aircraft on the arc, at 3 m/s."""
    angle = 20.0 / BEND_M
    mapper = bend(on_bend(20.0), velocity_m_s=[-3.0 * math.sin(angle), 0.0, -3.0 * math.cos(angle)])
    assert mapper.nearest.time_to_collision_s == pytest.approx(20.0 / 12.0, rel=1e-6)
