"""What the planner decides before simple views."""

from __future__ import annotations

import numpy as np
import pytest
from plan_library import (
    AHEAD,
    RADIUS_M,
    UP,
    Flight,
    Planner,
    Surroundings,
    distance_m,
    goal_of,
    seen_world,
    state_of,
)
from random_seed import seeded
from space_library import SPACE_FRAMES, UNMATCHED, Space, Wall, scene, seen_ellipse
from stage_library import ffi, lib


def test_before_open_space_it_flies_straight_at_the_speed_of_the_goal() -> None:
    decision = Planner().decide(seen_world(), state_of(velocity=(0.0, 0.0, 5.0)), goal_of())
    assert decision.action == "proceeds"
    chosen = decision.options[decision.chosen]
    assert (chosen.primitive, chosen.ruling) == ("straight", "chosen")
    np.testing.assert_allclose(decision.setpoint.velocity_m_s, [0.0, 0.0, 5.0], atol=0.1)


def test_a_vehicle_at_rest_begins_straight_on_where_other_ways_cost_as_much() -> None:
    """The first arc is 6 degrees aside: little but the change of velocity keeps it from being cheapest."""
    decision = Planner().decide(seen_world(), state_of(), goal_of())
    straight, arc = decision.options[:2]
    assert (straight.primitive, arc.primitive) == ("straight", "arc")
    assert arc.cost_s - straight.cost_s > 0.1


def test_each_plan_ends_in_a_stop_that_is_held() -> None:
    decision = Planner().decide(seen_world(), state_of(velocity=(0.0, 0.0, 8.0)), goal_of(speed_m_s=8.0))
    assert not decision.points[-1]["velocity_m_s"].any()
    late = decision.at(100.0)
    np.testing.assert_array_equal(late.position_m, decision.points[-1]["position_m"])


@pytest.mark.parametrize("z_m", [12.0, 20.0])
def test_it_leaves_its_way_before_a_board(z_m: float) -> None:
    space = seen_world([Wall(z_m, (-2.0, 2.0))])
    decision = Planner(plan__climb_max_m_s=0.0).decide(space, state_of(velocity=(0.0, 0.0, 5.0)), goal_of())
    assert decision.action == "evades"
    assert abs(decision.options[decision.chosen].direction[0]) > 0.1


def test_an_arc_evades_nothing_where_nothing_is_in_the_way() -> None:
    """Just before a goal aside of the way that is flown, an arc costs less than to turn to it at once."""
    planner, flying = Planner(), state_of(velocity=(0.0, 0.0, 5.0))
    planner.decide(seen_world(), flying, goal_of())
    decision = planner.decide(seen_world(), flying, goal_of(to=(1.0, 0.0, 5.0), origin=(0.0, 0.0, 0.0)))
    assert decision.options[decision.chosen].primitive == "arc"
    assert decision.action == "proceeds"


def test_it_evades_until_it_flies_straight_on() -> None:
    planner, goal = Planner(plan__climb_max_m_s=0.0), goal_of()
    board, moving = seen_world([Wall(12.0, (-2.0, 2.0))]), {"velocity": (0.0, 0.0, 5.0)}
    assert planner.decide(board, state_of(**moving), goal).action == "evades"
    for k in range(1, 40):
        decision = planner.decide(seen_world(), state_of(t_s=1.0 + 0.1 * k, **moving), goal)
        straight = decision.options[decision.chosen].primitive == "straight"
        assert decision.action == ("proceeds" if straight else "evades")
        if straight:
            return
    pytest.fail("it never flew straight on")


def test_before_a_wall_that_fills_the_view_it_stops_and_says_what_is_there() -> None:
    space = seen_world([Wall(8.0)])
    decision = Planner().decide(space, state_of(), goal_of())
    straight = next(o for o in decision.options if o.primitive == "straight")
    assert straight.ends == "by_place" and straight.free_m == pytest.approx(8.0, rel=0.1)
    end = decision.points[-1]["position_m"]
    assert end[2] < 8.0 - 1.0


def test_what_nobody_has_seen_is_not_flown_into() -> None:
    space = seen_world()
    space.reset()
    for k in range(6):
        space.take(UNMATCHED, 1.0 + 0.1 * k)
    decision = Planner().decide(space, state_of(t_s=2.0), goal_of())
    assert decision.action == "holds"
    assert {o.ends for o in decision.options if o.primitive == "straight"} == {"by_unknown"}
    aside_m, leans_m_s2 = decision.points["position_m"][:, 0], decision.points["acceleration_m_s2"][:, 0]
    assert np.abs(aside_m).max() < 0.25 * RADIUS_M  # it sways where it stands
    assert np.abs(leans_m_s2).max() > 1.3
    assert not decision.points[-1]["velocity_m_s"].any()


def test_a_planner_begins_anew_after_a_reset() -> None:
    planner = Planner()
    space, state, goal = seen_world([Wall(15.0, (-1.0, 3.0))]), state_of(velocity=(0.0, 0.0, 5.0)), goal_of()
    first = planner.decide(space, state, goal)
    lib.vista_planner_reset(planner.handle)
    again = planner.decide(space, state, goal)
    assert first.memory == again.memory


def test_a_trajectory_goes_on_from_the_one_that_is_flown() -> None:
    """An error of the vehicle is left to its controller; who is off the trajectory begins where it is."""
    random = seeded(6)
    for off_m, goes_on in ((0.4 * RADIUS_M, True), (0.6 * RADIUS_M, False)):
        planner, space = Planner(), seen_world()
        first = planner.decide(space, state_of(velocity=(0.0, 0.0, 5.0)), goal_of())
        told = first.at(0.1)
        aside = random.normal(size=3)
        position_m = told.position_m + off_m * aside / np.linalg.norm(aside)
        then = planner.decide(space, state_of(position_m, told.velocity_m_s, 1.1), goal_of())
        begins_m = then.points[0]["position_m"]
        np.testing.assert_allclose(begins_m, told.position_m if goes_on else position_m, atol=1e-9)


def test_what_is_no_state_is_refused() -> None:
    planner, space, goal = Planner(), seen_world(), goal_of()
    for changes, status in (
        ({"position_m": [float("nan"), 0.0, 0.0]}, "VISTA_ERROR_NUMBER"),
        ({"position_m": [2e6, 0.0, 0.0]}, "VISTA_ERROR_RANGE"),
        ({"velocity_m_s": [0.0, -1e300, 0.0]}, "VISTA_ERROR_RANGE"),
        ({"up": [0.0, -2.0, 0.0]}, "VISTA_ERROR_RANGE"),
        ({"heading": [0.0, 1.0, 0.0]}, "VISTA_ERROR_RANGE"),
    ):
        state = ffi.new("vista_plan_state *", {"t_ns": 1, "up": [0, -1, 0], "heading": [0, 0, 1]} | changes)
        assert planner.try_to(space, state, goal)[0] == status
    assert planner.try_to(space, state_of(t_s=2.0), goal)[0] == "VISTA_OK"
    assert planner.try_to(space, state_of(t_s=1.0), goal)[0] == "VISTA_ERROR_ORDER"


# ---- flights: what the camera sees decides, and that decides what it sees next ----


def flown(walls: list[Wall], speed_m_s: float = 5.0, seconds: float = 40.0, **changes) -> Flight:
    flight = Flight(walls, goal_of((0.0, 0.0, 60.0), speed_m_s, (0.0, 0.0, 0.0), passed=False), **changes)
    while flight.t_s < seconds and flight.step().action != "arrived":
        pass
    return flight


def forest(random: np.random.Generator) -> list[Wall]:
    """Trunks at least 3 m apart."""
    places: list[np.ndarray] = []
    while len(places) < 20:
        place = random.uniform((-12.0, 8.0), (12.0, 52.0))
        if all(np.hypot(*(place - other)) > 3.0 for other in places):
            places.append(place)
    return [Wall(z_m, (x_m - 0.15, x_m + 0.15)) for x_m, z_m in places]


@pytest.mark.slow
@pytest.mark.same_c
def test_it_flies_through_forests() -> None:
    """Clearance is less than the radius by what a ball that is looked at may lack at its rim."""
    random = seeded(2)
    for _ in range(3):
        flight = flown(forest(random))
        assert flight.decisions[-1].action == "arrived"
        assert flight.clearance_m > 0.6 * RADIUS_M


@pytest.mark.same_c
@pytest.mark.slow
def test_it_flies_around_a_wall_that_is_wider_than_the_view() -> None:
    flight = flown([Wall(30.0, (-12.0, 10.0))])
    assert flight.decisions[-1].action == "arrived"
    assert flight.clearance_m > 0.8 * RADIUS_M and flight.way_m < 90.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "to",
    [
        pytest.param((-8.0, 0.0, 10.0), id="beside"),
        pytest.param((0.0, 0.0, -15.0), id="behind", marks=pytest.mark.same_c),
    ],
)
def test_it_turns_to_a_goal_that_is_out_of_view(to: tuple[float, float, float]) -> None:
    """Who flies on at speed past a goal that he does not see circles around it."""
    flight = Flight([], goal_of((0.0, 0.0, 60.0), 3.0, (0.0, 0.0, 0.0), passed=False))
    while flight.t_s < 5.0:
        flight.step()
    flight.goal = goal_of(to, 3.0, to, passed=False)
    while flight.t_s < 30.0 and flight.step().action != "arrived":
        pass
    assert flight.decisions[-1].action == "arrived" and flight.t_s < 30.0


def test_what_was_seen_to_be_free_stays_so_for_a_while_when_it_leaves_the_view() -> None:
    """The frames that the map still keeps were taken farther ahead, with the vehicle behind the camera."""
    for seconds, known in ((2.0, True), (20.0, False)):
        kept = Surroundings()
        for k in range(SPACE_FRAMES):
            kept.take((), (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
        for k in range(SPACE_FRAMES):
            kept.take((), (0.0, 0.0, 7.0), 1.0 + seconds + 0.1 * k)
        state = state_of((0.0, 0.0, 3.0), t_s=1.5 + seconds)
        decision = kept.planner.decide(kept.space, state, goal_of(speed_m_s=3.0))
        assert (decision.action != "holds") == known


def test_what_has_just_come_into_view_is_not_free_yet() -> None:
    """One frame in three that has a place in view is too few to be right about it."""
    for frames, action in ((3, "holds"), (4, "proceeds")):
        assert Planner().decide(seen_world(frames=frames), state_of(), goal_of()).action == action


def free_after(frames: int, points: list[tuple[float, float, float]], walls=()) -> list[bool]:
    """Whether places are free that so many frames have had in view, now that they are behind the camera."""
    kept = Surroundings()
    for k in range(frames):
        kept.take(walls, (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
    for k in range(SPACE_FRAMES):
        kept.take(walls, (0.0, 0.0, 7.0), 2.0 + 0.1 * k)
    return [kept.is_free(point) for point in points]


def test_out_of_view_a_place_is_free_if_two_frames_saw_through_all_of_what_is_near_it() -> None:
    """Half of the view is as wide as half of the way to it: at 5 m it ends 2.7 m beside its middle."""
    points = [(x_m, 0.0, 5.0) for x_m in (0.0, 1.5, 2.5)]
    assert free_after(2, points) == [True, True, False]
    assert free_after(1, points) == [False, False, False]


def test_a_place_out_of_view_needs_more_room_by_what_the_vehicle_is_off_its_trajectory() -> None:
    kept = Surroundings()
    for k in range(3):
        kept.take([], (0.0, 0.0, 0.0), 1.0 + 0.1 * k)
    free = []
    for off_m in (0.0, 0.3, 0.9):
        kept.ask_at((0.0, 0.0, 7.0), 2.0)
        kept.asked.off_m = off_m
        free.append([kept.is_free((x_m, 0.0, 5.0)) for x_m in (1.1, 1.8, 2.2)])
    assert free == [[True, True, True], [True, False, False], [False, False, False]]


def test_a_vehicle_that_is_off_its_trajectory_finds_fewer_ways_to_what_is_out_of_view() -> None:
    flight = Flight([], goal_of((0.0, 0.0, 7.0)))
    for _ in range(60):
        flight.step()
    before, by_view = bytes(ffi.buffer(flight.planner.handle)), []
    for off_m in (0.0, 0.45):
        ffi.buffer(flight.planner.handle)[:] = before
        state = state_of(
            flight.position_m + off_m * AHEAD,
            flight.velocity,
            flight.t_s,
            flight.heading,
            acceleration_m_s2=flight.acceleration.tolist(),
        )
        aside = (5.0, 0.0, flight.position_m[2] - 3.0)
        decision = flight.planner.decide(flight.space, state, goal_of(aside))
        by_view.append(sum(option.ruling == "by_view" for option in decision.options))
    assert by_view[0] == 0 and by_view[1] > 5


def test_what_is_too_near_to_be_matched_was_free_only_if_something_was_matched_behind_it() -> None:
    """The full resolution matches from 1.9 m on. Of the sky behind the nearer place nothing is matched."""
    points, wall = [(0.0, 0.0, 1.85), (0.0, 0.0, 4.0)], [Wall(9.0)]
    assert free_after(2, points) == [False, True]
    assert free_after(2, points, wall) == [True, True]


def test_what_was_seen_to_stand_is_not_seen_through_from_where_it_is_too_near_to_be_matched() -> None:
    """The full resolution matches from 1.9 m on. A pole is let go of where it would be matched and is not."""
    kept, house, t_s, free = Surroundings(), Wall(30.0), 1.0, []
    pole = Wall(7.0, (-0.15, 0.15), (-0.4, 0.4))
    for walls, z_m in (([pole, house], 1.0), ([house], 5.6), ([house], 1.0), ([house], 5.6)):
        for _ in range(SPACE_FRAMES):
            kept.take(walls, (0.0, 0.0, z_m), t_s)
            t_s += 0.1
        free.append(kept.is_free((0.0, 0.0, 7.0)))
    assert free == [False, False, True, True]


def test_what_is_too_near_is_not_in_the_way_of_getting_away_from_it() -> None:
    """The vehicle flies on beside it, and not straight through it."""
    for position, passes in (
        ([-0.5, 0.0, 0.15], True),
        ([0.0, 0.0, 0.8], False),
        ([0.0, 0.0, 0.3], False),  # nearer than half way to the first place ahead
    ):
        thing = {
            "id": 7,
            "confirmed": True,
            "position_m": position,
            "extent_m": [0.2, 0.2],
            "covariance_m2": (1e-4 * np.eye(3)).ravel().tolist(),
        }
        decision = Planner().decide(seen_world(), state_of(), goal_of(), [thing])
        chosen = decision.options[decision.chosen]
        assert (decision.chosen >= 0 and chosen.direction[2] > 0.9 and chosen.speed_m_s > 0.9) == passes


def test_what_is_seen_through_is_free_before_an_obstacle_whose_range_is_hardly_known() -> None:
    """Ground that is seen at a grazing angle is such an obstacle, and so is a track that has just begun."""
    for range_m, free in ((30.0, True), (6.0, False)):
        thing = {
            "id": 7,
            "confirmed": True,
            "position_m": [0.0, 0.0, range_m],
            "extent_m": [4.0, 4.0],
            "covariance_m2": np.diag([1.0, 1.0, 400.0]).ravel().tolist(),
        }
        decision = Planner().decide(seen_world(), state_of(velocity=(0.0, 0.0, 5.0)), goal_of(), [thing])
        straight = next(o for o in decision.options if o.primitive == "straight")
        assert (straight.ruling == "chosen") == free
        assert (straight.ruling == "by_obstacle") == (not free)


def test_what_the_border_cuts_off_is_in_the_way_where_it_is_seen() -> None:
    """The middle of its track is on the way, or beside it, and what is seen of it is not."""
    space = seen_world()
    for middle_m, seen_m, free in ((0.0, 3.5, True), (3.5, 0.0, False)):
        thing = {
            "id": 7,
            "confirmed": True,
            "position_m": [middle_m, 0.0, 6.0],
            "extent_m": [3.0, 3.0],
            "ellipse": seen_ellipse(space.frame, (seen_m, 0.0, 6.0), (3.0, 3.0)),
            "covariance_m2": np.diag([1.0, 0.1, 0.1]).ravel().tolist(),
        }
        decision = Planner().decide(space, state_of(velocity=(0.0, 0.0, 2.0)), goal_of(), [thing])
        straight = next(o for o in decision.options if o.primitive == "straight")
        assert (straight.ruling == "chosen") == free


def lengths(planner: Planner, **state) -> set[float]:
    """What the cells of the grid cost, as they are at that place and time."""
    lib.vista_plan_spread(planner.handle, state_of(**state), [0.0, 0.0, 200.0])
    grid = ffi.buffer(planner.handle.length)
    return set(np.frombuffer(grid, np.float32).round(2).tolist())


def test_a_cell_costs_by_what_was_seen_of_it_within_a_minute_at_its_height_and_place() -> None:
    """12: something stands there, or nearer than the vehicle is wide; 1.5: it is near; 1.3: nobody saw it."""
    planner, unseen = Planner(), pytest.approx([1.3])
    planner.decide(seen_world([Wall(12.0, (-2.0, 2.0))]), state_of(), goal_of())
    assert sorted(lengths(planner, t_s=60.0)) == pytest.approx([1.0, 1.3, 1.5, 12.0])
    assert list(lengths(planner, t_s=62.0)) == unseen
    assert list(lengths(planner, position=(0.0, -3.0 * RADIUS_M, 0.0))) == unseen
    assert list(lengths(planner, position=(0.0, 0.0, -48.0))) == unseen


def swept(length: np.ndarray, way: np.ndarray) -> np.ndarray:
    """What fast sweeping makes of ways with a rim: each cell after those beside it and in the row before."""
    way, corners = way.copy(), [(up, left) for up in (1, -1) for left in (1, -1)]
    for _ in range(4):
        shorter = False
        for up, left in corners:
            ways, lengths = way[::up, ::left], length[::up, ::left]
            for diagonal in range(2 * len(length) - 1):
                y = np.arange(max(0, diagonal - len(length) + 1), min(diagonal + 1, len(length)))
                x = diagonal - y
                beside = np.minimum(ways[y + 1, x], ways[y + 1, x + 2])
                across = np.minimum(ways[y, x + 1], ways[y + 2, x + 1])
                apart, here = np.abs(beside - across), lengths[y, x]
                root = np.sqrt(np.maximum(np.float32(2.0) * here * here - apart * apart, np.float32(0.0)))
                slanted = np.float32(0.5) * (beside + across + root)
                found = np.where(apart >= here, np.minimum(beside, across) + here, slanted)
                old = ways[y + 1, x + 1]
                shorter |= bool((old - found > np.float32(0.02)).any())
                ways[y + 1, x + 1] = np.minimum(found, old)
        if not shorter:
            break
    return way


def test_rows_that_are_swept_together_give_what_one_after_the_other_does() -> None:
    rng, planner = seeded(8), Planner().handle
    length, way = (np.frombuffer(ffi.buffer(a), np.float32) for a in (planner.length, planner.way))
    length, way = length.reshape(lib.VISTA_PLAN_GRID, -1), way.reshape(lib.VISTA_PLAN_GRID + 2, -1)
    for things in (0, 3, 40):
        length[:] = rng.choice(np.float32([1.0, 1.3]), length.shape)
        for x, y in rng.integers(0, lib.VISTA_PLAN_GRID, (things, 2)):
            length[y : y + rng.integers(1, 20), x : x + rng.integers(1, 20)] = rng.choice([1.5, 12.0])
        way[:] = 1e9
        way[1, 1:-1] = way[-2, 1:-1] = way[1:-1, 1] = way[1:-1, -2] = rng.uniform(0.0, 99.0, len(length))
        way[tuple(rng.integers(1, len(length), 2))] = 0.5
        expected = swept(length, way)
        lib.vista_plan_sweep(planner)
        np.testing.assert_array_equal(way, expected)


@pytest.mark.parametrize("right", [-1.0, 1.0])
@pytest.mark.parametrize("ahead", [-1.0, 1.0])
def test_a_way_across_the_axes_of_the_grid_is_no_longer_than_others(right: float, ahead: float) -> None:
    """Nothing is known any more: each metre costs 1.3 in any direction. The way begins towards the goal."""
    planner, level = Planner(), np.array([right, 0.0, ahead]) * np.sqrt(0.5)
    planner.decide(seen_world(), state_of(), goal_of())
    lib.vista_plan_spread(planner.handle, state_of(t_s=100.0), (20.0 * level).tolist())
    way = lib.vista_plan_way_along(planner.handle, [0.0, 0.0, 0.0], level.tolist(), 4.0)
    assert way.length_m == pytest.approx(1.3 * 20.0, rel=0.05) and way.turn < 0.1


def test_of_two_ways_around_the_shorter_one_is_told() -> None:
    """The wall reaches 3 m to the left and 9 m to the right; what leads to the left is the shorter way."""
    planner, along = Planner(), []
    state, goal_m = state_of(), [0.0, 0.0, 20.0]
    planner.decide(seen_world([Wall(10.0, (-3.0, 9.0))]), state, goal_of())
    lib.vista_plan_spread(planner.handle, state, goal_m)
    for right in (-1.0, 1.0):
        level = [right * np.sqrt(0.5), 0.0, np.sqrt(0.5)]
        along.append(lib.vista_plan_way_along(planner.handle, [0.0, 0.0, 0.0], level, 4.0))
    assert 20.0 < along[0].length_m < along[1].length_m < 60.0
    back = lib.vista_plan_way_along(planner.handle, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0], 4.0)
    assert back.length_m > along[0].length_m and back.turn > along[0].turn


def test_the_grid_keeps_what_was_seen_on_both_sides_of_the_worlds_origin() -> None:
    """A grid is 48 m wide here. From z = 12 m it still holds what was seen from -20 m beyond z = -12 m."""
    planner, kept = Planner(), []
    for t_s, z_m in ((1.0, -20.0), (3.0, 12.0)):
        space, at = Space(collision_radius_m=RADIUS_M), np.array([0.0, 0.0, z_m])
        for k in range(3):
            space.take(scene((), 20.0, at), t_s - 0.1 * (2 - k), up_camera=UP)
        planner.decide(space, state_of(at, t_s=t_s), goal_of())
        cells = planner.handle.cells
        kept.append({(c.x, c.y) for c in cells if c.kind == 1 and c.t_ns and -24 <= c.y < 0})
    assert len(kept[0]) > 100 and kept[0] <= kept[1]


@pytest.mark.same_c
@pytest.mark.slow
def test_before_a_wall_without_end_it_keeps_off() -> None:
    flight = flown([Wall(25.0)], seconds=20.0)
    assert flight.clearance_m > 0.8 * RADIUS_M


@pytest.mark.slow
@pytest.mark.same_c
def test_each_decision_of_a_flight_ends_in_a_stop_that_is_free() -> None:
    """What was committed to keeps off everything, not only what was flown of it."""
    random = seeded(3)
    walls = forest(random)
    flight = flown(walls)
    for decision in flight.decisions:
        if decision.chosen < 0 or decision.action == "helpless":
            continue
        points = decision.points["position_m"]
        assert not decision.points[-1]["velocity_m_s"].any()
        assert min(distance_m(point, wall) for point in points for wall in walls) > 0.5 * RADIUS_M


@pytest.mark.slow
@pytest.mark.same_c
def test_two_frames_that_are_missing_do_no_harm() -> None:
    random = seeded(4)
    walls = forest(random)
    flight = Flight(walls, goal_of((0.0, 0.0, 60.0), 5.0, (0.0, 0.0, 0.0), passed=False))
    while flight.t_s < 40.0 and flight.step(0.3 if random.random() < 0.2 else 0.1).action != "arrived":
        pass
    assert flight.decisions[-1].action == "arrived" and flight.clearance_m > 0.5 * RADIUS_M


def test_what_flies_across_is_where_it_will_be() -> None:
    """A thing to the right that moves to the left, into the way: nothing is in the way now."""
    space, state = seen_world(), state_of(velocity=(0.0, 0.0, 5.0))
    thing = {
        "id": 7,
        "confirmed": True,
        "world": lib.VISTA_WORLD_MOVES,
        "position_m": [5.0, 0.0, 4.5],
        "extent_m": [1.0, 1.0],
        "covariance_m2": (0.04 * np.eye(3)).ravel().tolist(),
    }
    track = {"id": 7, "position_m": [5.0, 0.0, 4.5], "velocity_m_s": [-5.0, 0.0, 0.0]}
    for velocity, hit in ((track["velocity_m_s"], True), ([5.0, 0.0, 0.0], False)):
        decision = Planner().decide(space, state, goal_of(), [thing], [track | {"velocity_m_s": velocity}])
        straight = next(o for o in decision.options if o.primitive == "straight")
        assert (straight.ruling == "by_obstacle" and straight.obstacle_id == 7) == hit


@pytest.mark.slow
@pytest.mark.same_c
def test_a_fixed_wing_flies_around_and_its_plan_is_a_circle_that_closes() -> None:
    walls = [Wall(120.0, (-8.0, 8.0))]
    goal = goal_of((0.0, 0.0, 400.0), 12.0, (0.0, 0.0, 0.0))
    flight = Flight(walls, goal, velocity=(0.0, 0.0, 12.0), plan__vehicle="fixed_wing")
    while flight.position_m[2] < 150.0 and flight.t_s < 30.0:
        decision = flight.step()
        circle = decision.points["position_m"][decision.circle_from :]
        np.testing.assert_allclose(circle[0], circle[-1], atol=0.05)
        speeds = np.linalg.norm(decision.points["velocity_m_s"], axis=1)
        np.testing.assert_allclose(speeds, 12.0, rtol=0.05)
        far = decision.at(1e4).position_m
        assert np.linalg.norm(circle - far, axis=1).min() < 3.0
    assert flight.position_m[2] >= 150.0 and flight.clearance_m > 0.8 * RADIUS_M


@pytest.mark.parametrize("climb_m_s", [0.0, 3.0])
def test_a_fixed_wing_climbs_while_it_turns_back_and_circles_level_from_there(climb_m_s: float) -> None:
    """Half a turn with 17 m takes 4.5 s, to roll and to level off a little more."""
    planner = Planner(plan__vehicle="fixed_wing", plan__climb_max_m_s=climb_m_s)
    goal = goal_of((0.0, 0.0, 300.0), 12.0, (0.0, 0.0, 0.0))
    decision = planner.decide(seen_world(), state_of(velocity=(0.0, 0.0, 12.0)), goal)
    height_m, back = -decision.points["position_m"][:, 1], decision.circle_from
    assert 3.5 * climb_m_s <= height_m[back] <= 6.0 * climb_m_s
    assert np.ptp(height_m[back:]) == pytest.approx(0.0, abs=1e-6)
    assert np.all(np.diff(height_m) >= -1e-9)
    ahead = decision.points["heading"] @ decision.points["heading"][0]
    assert ahead[: back + 1].min() < -0.95


def test_a_fixed_wing_flies_on_between_boards_that_hide_what_its_circles_cross() -> None:
    """Nobody knows what is behind them, and the circle is flown only if nothing else passes later."""
    space = seen_world([Wall(20.0, (5.0, 18.0)), Wall(20.0, (-18.0, -5.0))])
    goal = goal_of((0.0, 0.0, 300.0), 12.0, (0.0, 0.0, 0.0))
    decision = Planner(plan__vehicle="fixed_wing").decide(space, state_of(velocity=(0.0, 0.0, 12.0)), goal)
    assert decision.action == "proceeds" and not decision.escape_seen
    space.reset()
    for k in range(6):
        space.take(UNMATCHED, 1.0 + 0.1 * k)
    blind = Planner(plan__vehicle="fixed_wing").decide(
        space, state_of(velocity=(0.0, 0.0, 12.0), t_s=2.0), goal
    )
    assert all(option.ruling != "chosen" for option in blind.options if option.primitive == "straight")


@pytest.mark.slow
def test_a_fixed_wing_goes_on_rolling_when_it_decides_anew() -> None:
    """Half a turn at 40 degrees of bank, to a goal behind it, takes less than 5 s, ten decisions a second."""
    goal = goal_of((0.0, 0.0, -400.0), 12.0)
    flight = Flight([], goal, velocity=(0.0, 0.0, 12.0), plan__vehicle="fixed_wing")
    for _ in range(50):
        flight.step()
    assert flight.velocity[2] < -0.95 * np.linalg.norm(flight.velocity)


def test_a_fixed_wing_puts_its_turn_off_where_it_can_only_fly_on() -> None:
    """Both turns after 0.75 s lead into a board, and between the two it is seen to be free for far longer."""
    space = seen_world([Wall(20.0, (1.8, 9.0)), Wall(20.0, (-9.0, -1.8))])
    goal = goal_of((0.0, 0.0, 300.0), 12.0, (0.0, 0.0, 0.0))
    decision = Planner(plan__vehicle="fixed_wing").decide(space, state_of(velocity=(0.0, 0.0, 12.0)), goal)
    assert decision.action == "proceeds" and decision.escape_s > 0.75
    before = decision.points["position_m"][: round(decision.escape_s / decision.step_s) + 1]
    assert np.abs(before[:, 0]).max() < 0.1


def test_a_fixed_wing_that_has_left_its_trajectory_keeps_its_bank() -> None:
    """The acceleration lags behind a bank, and a turn that has begun would be taken back."""
    planner, goal = Planner(plan__vehicle="fixed_wing"), goal_of((-300.0, 0.0, 20.0), 12.0)
    first = planner.decide(seen_world(), state_of(velocity=(0.0, 0.0, 12.0)), goal)
    told = first.at(0.5)
    off_m = told.position_m + np.array([RADIUS_M, 0.0, 0.0])
    then = planner.decide(seen_world(), state_of(off_m, told.velocity_m_s, 1.5, told.heading), goal)
    np.testing.assert_allclose(then.points[0]["position_m"], off_m, atol=1e-9)
    np.testing.assert_allclose(then.points[0]["acceleration_m_s2"], told.acceleration_m_s2, atol=0.1)
    assert np.linalg.norm(told.acceleration_m_s2) > 2.0


@pytest.mark.parametrize("ahead_m", [18.0, 20.0])
def test_a_helpless_fixed_wing_keeps_turning_to_one_side(ahead_m: float) -> None:
    """A wall of which now this half seems to be the farther one, and now the other."""
    goal = goal_of((0.0, 0.0, 400.0), 12.0, (0.0, 0.0, 0.0))
    flight = Flight([], goal, velocity=(0.0, 0.0, 12.0), plan__vehicle="fixed_wing")
    for _ in range(6):
        flight.step()
    z_m, halves, turned = flight.position_m[2] + ahead_m, [(-150.0, 0.0), (0.0, 150.0)], []
    for k in range(10):
        flight.walls = [Wall(z_m, halves[1 - k % 2]), Wall(z_m + 3.0, halves[k % 2])]
        decision = flight.step()
        if decision.action == "helpless":
            turned.append(float(np.sign(decision.points[decision.circle_from - 4]["acceleration_m_s2"][0])))
    assert len(turned) > 3 and len(set(turned)) == 1


def test_a_fixed_wing_that_is_too_slow_to_fly_is_told_to_stay() -> None:
    position = (3.0, -2.0, 1.0)
    decision = Planner(plan__vehicle="fixed_wing").decide(seen_world(), state_of(position), goal_of())
    assert decision.chosen == -1 and len(decision.points) == 1
    for told in (decision.setpoint, decision.at(10.0)):
        assert told.position_m.tolist() == list(position) and not told.velocity_m_s.any()
        assert told.heading.tolist() == AHEAD.tolist()


@pytest.mark.slow
def test_an_escape_that_meets_what_stands_is_never_called_one() -> None:
    """Not even where the manoeuvres that were ruled out have taken all that may be asked for."""
    goal = goal_of((0.0, 0.0, 400.0), 12.0, (0.0, 0.0, 0.0))
    flight = Flight([], goal, velocity=(0.0, 0.0, 12.0), plan__vehicle="fixed_wing")
    for _ in range(6):
        flight.step()
    wall = Wall(flight.position_m[2] + 22.0, (-150.0, 150.0))
    flight.walls = [wall]
    for _ in range(2):  # until the map holds it
        flight.step()
    for _ in range(6):
        decision = flight.step()
        met = any(distance_m(point, wall) < 0.5 * RADIUS_M for point in decision.points["position_m"])
        assert not (met and decision.action == "escapes")


def test_decisions_are_bounded_by_count() -> None:
    random = seeded(5)
    for _ in range(5):
        walls = [Wall(z, (x, x + 1.0)) for x, z in random.uniform((-15, 4), (15, 30), (40, 2))]
        decision = Planner().decide(
            seen_world(walls), state_of(velocity=(0.0, 0.0, 8.0)), goal_of(speed_m_s=8.0)
        )
        assert decision.looks <= lib.VISTA_PLAN_LOOKS
        assert len(decision.options) <= lib.VISTA_PLAN_MOST_OPTIONS


def test_a_multirotor_leans_to_both_sides_and_keeps_its_way() -> None:
    """So level wires cross the rows of its images."""
    flight = Flight([], goal_of((0.0, 0.0, 400.0), 5.0, (0.0, 0.0, 0.0)), velocity=(0.0, 0.0, 5.0))
    for _ in range(10):
        flight.step()
    aside = []
    for _ in range(28):
        flight.step()
        aside.append((flight.position_m[0], flight.acceleration[0]))
    off_m, leans_m_s2 = np.array(aside).T
    assert np.ptp(off_m) < 0.5 * RADIUS_M
    assert leans_m_s2.max() > 1.3
    assert leans_m_s2.min() < -1.3


def test_a_multirotor_that_has_arrived_does_not_lean() -> None:
    arrived = Planner().decide(seen_world(), state_of(), goal_of((0.0, 0.0, 0.1), passed=False))
    assert not arrived.points["acceleration_m_s2"].any()


def test_beside_what_it_would_sway_into_it_flies_without() -> None:
    """A gap that leaves 3 to 4 cm on both sides of the radius, and one that leaves room for both."""
    for side_m, sways in ((RADIUS_M + 0.08, False), (RADIUS_M + 0.5, True)):
        sides = [
            {
                "id": k + 1,
                "confirmed": True,
                "position_m": [side * side_m, 0.0, 0.6],
                "extent_m": [0.2, 2.0],
                "covariance_m2": (1e-6 * np.eye(3)).ravel().tolist(),
            }
            for k, side in enumerate((-1.0, 1.0))
        ]
        decision = Planner(plan__climb_max_m_s=0.0).decide(seen_world(), state_of(), goal_of(), sides)
        assert decision.action == "proceeds"
        assert (np.ptp(decision.points["position_m"][:, 0]) > 0.05) == sways


def test_where_nothing_passes_any_more_it_stops_at_once() -> None:
    """It was about to fly faster for 0.4 s. Two frames of six see that something may be in the way."""
    planner, goal = Planner(plan__climb_max_m_s=0.0), goal_of()
    told = planner.decide(seen_world(), state_of(velocity=(0.0, 0.0, 2.0)), goal).at(0.1)
    space = seen_world(frames=4)
    for k in range(2):
        space.take(scene([Wall(2.6)]), 1.05 + 0.05 * k, up_camera=UP)
    acceleration = told.acceleration_m_s2.tolist()
    state = state_of(told.position_m, told.velocity_m_s, 1.1, acceleration_m_s2=acceleration)
    decision = planner.decide(space, state, goal)
    assert decision.action == "escapes"
    assert decision.options[decision.chosen].primitive == "stop"
    assert decision.at(0.4).velocity_m_s[2] < 1.7


def test_before_what_it_cannot_avoid_it_brakes() -> None:
    """It does not fly on as it was committed to, if that is not free for longer."""
    planner, goal = Planner(), goal_of()
    told = planner.decide(seen_world(), state_of(velocity=(0.0, 0.0, 5.0)), goal).at(0.1)
    near = seen_world([Wall(3.0)])
    decision = planner.decide(near, state_of(told.position_m, told.velocity_m_s, 1.1), goal)
    assert decision.action == "helpless"
    assert decision.at(0.4).velocity_m_s[2] < 4.5  # what was committed to begins to stop only then
