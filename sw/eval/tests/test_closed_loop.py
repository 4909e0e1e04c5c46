"""Flights in the loop: exact distances, walls that are hit by who does not look, and what seeds decide."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from command_line import assert_refused, call
from small_worlds import GREY, coarse_textures
from vista import parameters
from vista.geometry import Pose
from vista_eval.closed_loop.camera import BASELINE_M, calibration_of, rig_of
from vista_eval.closed_loop.collision import Geometry, prepared, to_cylinders_m, to_triangles_m
from vista_eval.closed_loop.loop import NOTHING, Conditions, Faults, Flight, Moment, fly
from vista_eval.closed_loop.outcome import Outcome, begins, outcome_of, stops_of
from vista_eval.closed_loop.painted import FAR_M, background_m
from vista_eval.closed_loop.pilots import BrakeOnly, Leg, Seen, Straight, along_leg
from vista_eval.closed_loop.places import boxes, forests
from vista_eval.closed_loop.places.catalog import FAMILIES
from vista_eval.closed_loop.places.parts import scene, upright_box
from vista_eval.closed_loop.progress import SWAY_S, Progress, speeds_of
from vista_eval.closed_loop.record import lines_of
from vista_eval.closed_loop.rivals import RIVALS
from vista_eval.closed_loop.setpoint import Setpoint
from vista_eval.closed_loop.suite import by_speed
from vista_eval.closed_loop.vehicle import STEP_S, Multirotor
from vista_eval.closed_loop.vehicles import VEHICLES
from vista_eval.closed_loop.world import World
from vista_eval.render.scene import Cylinder, Scene, Sphere, thing
from vista_eval.worlds.things import mesh
from vista_eval.worlds.triangles import box

pytest.importorskip("rotorpy")
QUICK = Conditions(width_px=160)
TO_SUN = (0.0, 0.0, 1.0)


def small_world(*standing, goal_m: float = 14.0) -> World:
    made = scene(3, "gravel", list(standing), (-2.0, 20.0), (-8.0, 8.0))
    return World("small", "small", made, ((0.0, 0.0, 3.0), (goal_m, 0.0, 3.0)), 3.0, seed=3)


# ---- distances ----


def test_distance_to_a_triangle_is_that_of_its_face_its_edges_and_its_corners():
    triangle = prepared(np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]]))
    above, beside, off_corner = [1.0, 1, 2], [1.0, -3, 4], [7.0, 0, 4]
    assert to_triangles_m(np.array(above), triangle)[0] == pytest.approx(2.0)
    assert to_triangles_m(np.array(beside), triangle)[0] == pytest.approx(5.0)
    assert to_triangles_m(np.array(off_corner), triangle)[0] == pytest.approx(5.0)
    assert to_triangles_m(np.array([4.0, 4, 0]), triangle)[0] == pytest.approx(math.sqrt(8))


def test_distance_to_a_cylinder_is_that_of_its_side_its_end_and_its_rim():
    start, end, radius = np.zeros((1, 3)), np.array([[0.0, 0, 10]]), np.array([0.5])
    for point, distance in (((2, 0, 5), 1.5), ((0.2, 0, 12), 2.0), ((3.5, 0, 14), 5.0), ((0.1, 0, 1), 0.0)):
        assert to_cylinders_m(np.array(point, float), start, end, radius)[0] == pytest.approx(distance)


def test_the_tree_finds_what_looking_at_every_triangle_finds():
    rng = np.random.default_rng(5)
    parts = [mesh(f"box{k}", box(rng.uniform(-9, 9, 3), rng.uniform(0.1, 2, 3), 0.3)) for k in range(40)]
    made = Geometry(Scene((thing("boxes", "box", parts),), TO_SUN))
    corners = np.concatenate([part.vertices_m[part.faces.astype(int)] for part in parts]).astype(float)
    for point in rng.uniform(-12, 12, (60, 3)):
        assert made.nearest(point).distance_m == pytest.approx(
            to_triangles_m(point, prepared(corners)).min(), abs=1e-9
        )


def test_each_of_many_things_is_named_by_what_is_nearest():
    """The last block of triangles is shorter than the others, and may be looked at before them."""
    rng = np.random.default_rng(17)
    things = [
        thing(f"box{k}", "box", [mesh(f"box{k}", box(center, (3.0, 3.0, 3.0), 0.3))])
        for k, center in enumerate(rng.uniform(-20, 20, (17, 3)))
    ]
    made, alone = Geometry(Scene(tuple(things), TO_SUN)), [Geometry(Scene((one,), TO_SUN)) for one in things]
    for point in rng.uniform(-25, 25, (200, 3)):
        assert made.nearest(point).name == min(one.nearest(point) for one in alone)[1]


def test_of_things_of_all_kinds_the_nearest_is_named():
    rod = thing("wire", "wire", [Cylinder("wire", (0.0, -5.0, 2.0), (0.0, 5.0, 2.0), 0.01, GREY)])
    ball = thing("ball", "ball", [Sphere("ball", (6.0, 0.0, 2.0), 1.0, GREY)])
    made = Geometry(Scene((rod, ball), TO_SUN))
    assert made.nearest(np.array([2.0, 0, 2])) == (pytest.approx(1.99), "wire")
    assert made.nearest(np.array([4.0, 0, 2])) == (pytest.approx(1.0), "ball")


def test_a_wire_that_lies_between_two_steps_is_met():
    rod = thing("wire", "wire", [Cylinder("wire", (0.5, -5.0, 2.0), (0.5, 5.0, 2.0), 0.01, GREY)])
    made = Geometry(Scene((rod,), TO_SUN))
    start, end = np.array([0.0, 0, 2]), np.array([1.1, 0, 2])
    met, last = made.nearest_on_way(made.nearest(start), start, end, 0.0, 0.1)
    assert met.distance_m < 0.01
    assert last == made.nearest(end)


def test_what_moves_is_where_it_has_moved_to():
    moving = thing(
        "mover", "box", [mesh("mover", box((10.0, 0, 0), (1.0, 1, 1), 0.3))], velocity_m_s=(-2.0, 0.0, 0.0)
    )
    made = Geometry(Scene((moving,), TO_SUN))
    assert made.nearest(np.zeros(3), 0.0).distance_m == pytest.approx(9.5)
    assert made.nearest(np.zeros(3), 3.0).distance_m == pytest.approx(3.5)


# ---- the vehicle ----


def flown(vehicle: Multirotor, setpoint: Setpoint, seconds: float, wind=(0.0, 0.0, 0.0)) -> None:
    for _ in range(round(seconds / STEP_S)):
        vehicle.step(setpoint, np.array(wind))


def test_the_vehicle_takes_up_a_velocity_and_holds_its_height():
    vehicle = Multirotor(np.array([0.0, 0, 10]), 0.0)
    flown(vehicle, Setpoint(np.array([5.0, 0, 0]), 0.0), 4.0)
    assert vehicle.state.velocity_m_s == pytest.approx([5.0, 0.0, 0.0], abs=0.1)
    assert vehicle.state.position_m[2] == pytest.approx(10.0, abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_the_vehicle_keeps_its_height_and_turns_where_it_is_told_to_go_to_and_fro(seed):
    random = np.random.default_rng(seed)
    vehicle = Multirotor(np.array([0.0, 0, 10]), 0.0)
    least_m, heading = 10.0, 0.0
    for _ in range(6):
        heading, velocity = random.uniform(-3.1, 3.1), random.uniform(-5, 5, 2)
        for _ in range(round(1.0 / STEP_S)):
            vehicle.step(Setpoint(np.array([*velocity, 0.0]), heading), np.zeros(3))
            least_m = min(least_m, vehicle.state.position_m[2])
    flown(vehicle, Setpoint(np.zeros(3), heading), 2.5)
    assert least_m > 9.5, f"seed {seed}"
    assert vehicle.state.heading_rad == pytest.approx(heading, abs=0.05), f"seed {seed}"
    assert vehicle.state.velocity_m_s == pytest.approx(np.zeros(3), abs=0.1), f"seed {seed}"


def test_it_holds_its_place_in_wind():
    place = np.array([0.0, 0, 10])
    vehicle = Multirotor(place, 1.0)
    flown(vehicle, Setpoint(np.zeros(3), 1.0, place), 8.0, (6.0, -3.0, 0.0))
    assert vehicle.state.position_m == pytest.approx(place, abs=0.3)
    assert vehicle.state.heading_rad == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_it_stops_no_shorter_than_its_limits_allow():
    vehicle = Multirotor(np.zeros(3) + 10.0, 0.0)
    flown(vehicle, Setpoint(np.array([6.0, 0, 0]), 0.0), 5.0)
    before = vehicle.state.position_m[0]
    flown(vehicle, Setpoint(np.zeros(3), 0.0), 5.0)
    assert 6.0**2 / (2 * 5.0) < vehicle.state.position_m[0] - before < 7.0


# ---- flights ----


def test_an_empty_world_is_flown_straight_to_the_goal():
    flight = fly(small_world(), lambda seen: Straight(), parameters.defaults(), QUICK, sees=False)
    outcome = outcome_of(flight, "none")
    assert (outcome.end, outcome.stops, outcome.evasions) == ("reached", 0, 0)
    assert max(abs(moment.state.position_m[1]) for moment in flight.moments) < 0.1
    assert abs(outcome.detour) < 0.2  # it is there when it is near


@pytest.mark.slow
def test_a_wall_is_hit_by_no_avoidance_and_not_by_who_brakes():
    wall = upright_box("wall", (12.0, 0.0), (1.0, 12.0, 8.0), 0.0, 5)
    world = small_world(wall, goal_m=18.0)
    hit = fly(world, lambda seen: Straight(), parameters.defaults(), QUICK, sees=False)
    assert (hit.end, hit.hit) == ("collision", "wall")
    braked = fly(world, lambda seen: BrakeOnly(), parameters.defaults(), QUICK)
    assert braked.end == "held"
    assert 0.5 < braked.nearest.distance_m < 6.0


@pytest.mark.slow
def test_the_same_seed_is_the_same_flight_to_the_byte():
    conditions = Conditions(width_px=160, drop_outs=0.2, pose_noise=True)
    world = small_world(goal_m=6.0)
    flights = [fly(world, lambda seen: BrakeOnly(), parameters.defaults(), conditions) for _ in range(2)]
    first, second = ("\n".join(lines_of(flight, "brake")) for flight in flights)
    assert first == second
    assert flights[0].lost_frames > 0


@pytest.mark.slow
def test_latency_shows_the_pilot_older_frames():
    class Noting:
        def __init__(self):
            self.ages_s = []

        def decide(self, seen):
            if seen.record is not None:
                self.ages_s.append(seen.t_ns - seen.record.t_ns)
            return Straight().decide(seen)

    for latency_s in (0.0, 0.05, 0.25):
        noting = Noting()
        conditions = Conditions(width_px=160, latency_s=latency_s)
        fly(small_world(goal_m=2.5), lambda seen, pilot=noting: pilot, parameters.defaults(), conditions)
        assert noting.ages_s
        assert set(noting.ages_s) == {round(latency_s * 1e9)}


def test_frames_are_lost_two_at_a_time():
    faults = Faults(7, 0.1)
    lost = "".join("x" if faults.loses_frame() else "." for _ in range(400))
    runs = [run for run in lost.split(".") if run]
    assert runs and all(len(run) % 2 == 0 for run in runs[:-1])


def test_who_flies_a_leg_slows_down_before_its_end_unless_it_is_passed():
    vehicle = Multirotor(np.array([9.0, 0.0, 3.0]), 0.0)
    flown(vehicle, Setpoint(np.array([5.0, 0, 0]), 0.0), 2.0)
    state = vehicle.state
    ends = state.position_m + np.array([1.0, 0.0, 0.0])
    start = np.array([0.0, 0.0, state.position_m[2]])
    slow, fast = (along_leg(state, Leg(start, ends, 5.0, passed)) for passed in (False, True))
    assert np.linalg.norm(slow.velocity_m_s) == pytest.approx(2.0)
    assert np.linalg.norm(fast.velocity_m_s) == pytest.approx(5.0)


# ---- outcomes ----


@pytest.mark.parametrize("speed_m_s", [0.0, 2.0])
def test_the_way_is_that_without_the_sway(speed_m_s: float):
    times_s = STEP_S * np.arange(1001)
    aside_m = 0.1 * np.sin(2 * np.pi * times_s / SWAY_S)
    places_m = np.stack([speed_m_s * times_s, aside_m, np.ones(1001)], 1)
    progress = Progress(places_m[0])
    for place_m in places_m[1:]:
        progress.take(place_m)
    assert progress.way_m == pytest.approx(10.0 * speed_m_s, abs=0.2)
    assert progress.speed_m_s == pytest.approx(speed_m_s, abs=0.01)
    told = speeds_of(times_s[::10], places_m[::10])
    assert told[20:] == pytest.approx(np.full(81, speed_m_s), abs=0.05)


def test_stops_are_counted_after_the_start_and_without_the_last():
    speeds = [0.0, 0.1, 2.0, 0.1, 0.1, 2.0, 0.1]
    assert stops_of(speeds, "reached") == 1
    assert stops_of(speeds, "held") == 2
    assert begins([True, True, False, True]) == 2


def flown_at(speed_m_s: float, family: str, end: str, way_m: float, stops: int = 0) -> Outcome:
    flight = Flight(small_world(), QUICK, end=end, way_m=way_m)
    vehicle = Multirotor(np.zeros(3), 0.0)
    decision = Straight().decide(
        Seen(
            0.0, 0, vehicle.state, Leg(np.zeros(3), np.ones(3), 1.0, False), None, 0.0, VEHICLES["multirotor"]
        )
    )
    moment = Moment(0.0, vehicle.state, NOTHING, None, decision, decision.trajectory.at(0.0), None)
    flight.moments = [moment, moment]
    found = outcome_of(flight, "planner")
    return replace(found, speed_m_s=speed_m_s, family=family, stops=stops)


def test_what_goes_wrong_in_a_kilometre_is_told_by_speed():
    flights = [
        flown_at(5.0, "boxes", "collision", 400.0),
        flown_at(5.0, "boxes", "reached", 600.0),
        flown_at(5.0, "clear", "reached", 500.0, stops=3),
        flown_at(9.0, "clear", "reached", 500.0),
    ]
    slow, fast = by_speed(flights).rows
    assert slow == (
        "5 m/s, planner",
        "1.00",
        "1.0 (0.0 to 5.6)",
        "0.0 (0.0 to 3.7)",
        "0.50",
        "2.0 (0.1 to 11.1)",
    )
    assert fast == ("9 m/s, planner", "0.00", "-", "-", "0.50", "0.0 (0.0 to 7.4)")


# ---- worlds ----


@pytest.mark.slow
def test_the_published_boxes_stand_where_they_were_published():
    world = boxes.build(1, 1, None)
    geometry = Geometry(world.scene)
    # Box 0 of that test: middle 4.208 north, 21.443 east, 17.174 along north, 2 wide.
    east, north = 21.443, 4.208
    assert geometry.nearest(np.array([east - 3.0, -north, 5.0])).distance_m == pytest.approx(2.0, abs=0.01)
    ends = np.array([east, -(north + 17.174 / 2 + 1.0), 5.0])
    assert geometry.nearest(ends).distance_m == pytest.approx(1.0, abs=0.01)
    assert world.speed_m_s == 5.0 and world.route_m[0][2] == 10.0


@pytest.mark.slow
def test_a_forest_keeps_to_its_rules():
    for number in range(3):
        world = forests.build_forest(number, 1, None)
        assert all(8.0 <= np.linalg.norm(end - start) <= 34.0 for start, end in world.legs_m)
        poles = [one for one in world.scene.things if one.kind == "pole"]
        assert len(poles) <= 10
        for pole in poles:
            away = [math.dist(pole.center_m[:2], waypoint[:2]) for waypoint in world.route_m]
            assert min(away) >= 3.0


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_builds_the_same_world_twice_and_begins_in_the_open(
    name: str, monkeypatch: pytest.MonkeyPatch
):
    coarse_textures(monkeypatch)
    family = FAMILIES[name]
    first, second = (family.world(family.fixed, 1) for _ in range(2))
    near = [Geometry(world.scene).nearest(np.array(world.route_m[0])) for world in (first, second)]
    assert near[0] == near[1]
    assert near[0].distance_m > first.radius_m


def test_images_of_another_width_show_the_same():
    small, large = rig_of(320, 90.0), rig_of(640, 90.0)
    assert (large.width_px, large.height_px) == (640, 480)
    assert small.focal_px == pytest.approx(160.0) and large.focal_px == pytest.approx(320.0)
    assert calibration_of(large).baseline_m == small.baseline_m


# ---- the command ----


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--family", "sea"], "no family sea"),
        (["--rival", "eagle"], "no rival eagle"),
        (["--rate", "7"], "must be one of 5, 10, 20, 25"),
        (["--width", "100"], "a multiple of 32"),
        (["--view", "170"], "from 20 to 110 degrees"),
        (["--drop-outs", "1"], "less than 1"),
        (["--speed", "0.5"], "at least 1 m/s"),
        (["--first", "-1"], "must not be negative"),
    ],
)
def test_bad_input_is_named_in_one_line(tmp_path, capsys, options, said):
    assert_refused(call(capsys, "fly", tmp_path, *options), said)


def test_the_list_names_families_and_rivals(tmp_path, capsys):
    status, listed, _ = call(capsys, "fly", tmp_path, "--list")
    assert status == 0
    assert all(name in listed for name in (*FAMILIES, "brake", "planner"))


@pytest.mark.slow
def test_the_command_writes_records_film_mcap_and_page(tmp_path, capsys):
    options = ["--family", "boxes", "--first", "5", "--count", "1", "--rival", "none", "--films", "--mcap"]
    assert call(capsys, "fly", tmp_path, *options, "--name", "mission-3", "--jobs", "1")[0] == 0
    folder = tmp_path / "boxes_005_none"
    names = {path.name for path in folder.iterdir()}
    assert names == {"flight.jsonl", "flight.webm", "flight.mcap", "outcome.json"}
    assert '"said": "at ' in (folder / "outcome.json").read_text()
    assert "no avoidance" in (tmp_path / "mission-3.html").read_text()
    tables = json.loads((tmp_path / "mission-3.json").read_text())["tables"]
    assert {table["name"] for table in tables} >= {"mission-3", "mission-3-families"}


@pytest.mark.slow
def test_the_planner_flies_round_a_box_that_true_disparities_show():
    pillar = upright_box("pillar", (10.0, 0.3), (1.5, 1.5, 9.0), 0.0, 5)
    world = small_world(pillar, goal_m=18.0)
    flight = RIVALS["perfect"].fly(world, parameters.defaults(), QUICK)
    outcome = outcome_of(flight, "perfect")
    assert outcome.end == "reached"
    assert outcome.nearest_m > 0.8
    assert outcome.evasions > 0


# ---- eyes without a map ----


def test_without_obstacles_all_is_free_to_the_wall_and_down_to_the_ground():
    rig = rig_of(160, 87.0)
    level = np.column_stack([(0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)])  # looks along x
    depth_m = background_m(rig, Pose(level, np.array([0.0, 0.0, 4.0])))
    assert depth_m[0] == pytest.approx(np.full(160, FAR_M))
    below = (119 - rig.center_px[1]) / rig.focal_px
    assert depth_m[119] == pytest.approx(np.full(160, 4.0 / below))


@pytest.mark.slow
@pytest.mark.parametrize("words", ["obstacles", "clusters"])
def test_a_wall_is_a_wall_to_who_knows_no_map(words):
    """What is painted where the wall stands, and beside it."""
    wall = upright_box("wall", (12.0, 0.0), (1.0, 5.0, 20.0), 0.0, 5)
    world, seen = small_world(wall, goal_m=9.0), []

    def noting(perception):
        inner = perception._words
        perception._words = lambda left, right, px: (seen.append(px), inner(left, right, px))[1]
        return Straight()

    fly(world, noting, parameters.defaults(), Conditions(width_px=320), words=words)
    px = max(seen, key=lambda one: one[120, 160])
    far_px = rig_of(320, 87.0).focal_px * BASELINE_M / FAR_M
    assert px[120, 160] > 3 * far_px
    assert px[20, 5] == pytest.approx(far_px, rel=0.01)
