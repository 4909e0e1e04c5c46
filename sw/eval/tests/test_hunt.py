"""The search for flights that fail: what cases are, how failures become simple, and those that are kept."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from command_line import assert_refused, call
from vista.errors import InputError
from vista_eval.closed_loop import hunt
from vista_eval.closed_loop.camera import StereoCamera
from vista_eval.closed_loop.collision import Geometry
from vista_eval.closed_loop.outcome import Outcome
from vista_eval.jobs import HERE

pytestmark = pytest.mark.skipif(find_spec("cma") is None, reason="no cma")  # its import takes 2 s


def outcome(nearest_m: float, end: str = "reached", stops: int = 0) -> Outcome:
    return Outcome(
        world="hunted",
        family="hunted",
        rival="planner",
        speed_m_s=5.0,
        end=end,
        hit="",
        cause="",
        time_s=10.0,
        way_m=45.0,
        route_m=45.0,
        nearest_m=nearest_m,
        clearance_m=nearest_m - 0.35,
        stops=stops,
        evasions=0,
        top_speed_m_s=5.0,
        frames=100,
        lost_frames=0,
    )


def flown_into_plain_walls(seed: int, width_px: int, case: hunt.Case) -> Outcome:
    """A pilot who comes the nearer the plainer walls are and the faster he is, whatever else there is."""
    told = hunt.whole(case)
    return outcome(8.0 - 6.0 * told["plainness"] - 0.25 * told["speed_m_s"])


@pytest.mark.slow
def test_a_case_without_parameters_is_a_box_on_the_route():
    world = hunt.world_of({}, 3)
    geometry = Geometry(world.scene)
    assert geometry.nearest(np.array([22.0 - 1.5 - 2.0, 0.0, 10.0])).distance_m == pytest.approx(2.0)
    assert hunt.clear_m({}) == 0.0
    assert hunt.clear_m({"aside_m": 6.0}) == pytest.approx(4.5)
    assert hunt.whole(hunt.at(hunt.beginning())) == pytest.approx(hunt.whole({}))


def test_a_parameter_that_is_not_there_is_refused():
    with pytest.raises(InputError, match="no parameter colour"):
        hunt.world_of({"colour": 1.0}, 1)


def test_walls_become_plain_and_repeat():
    wall = np.random.default_rng(2).uniform(0.1, 0.8, (100, 150)).astype(np.float32)
    assert np.array_equal(hunt.faced(wall, 0.0, 0.0), wall)
    assert np.ptp(hunt.faced(wall, 1.0, 0.3)) < 1e-6
    repeated, period = hunt.faced(wall, 0.0, 1.0), hunt.PERIOD_TEXELS
    assert repeated[:, period:] == pytest.approx(repeated[:, :-period], abs=1e-6)


@pytest.mark.slow
def test_a_stop_is_needless_only_where_the_way_is_clear():
    beside, before = {"aside_m": 7.0}, {}
    assert hunt.kind_of(outcome(5.0, stops=1), beside) == "needless stop"
    assert hunt.kind_of(outcome(5.0, "held"), before) == "none"
    assert hunt.kind_of(outcome(1.4), before) == "near miss"
    assert hunt.kind_of(outcome(0.2, "collision"), before) == "collision"
    assert hunt.badness("stop", outcome(5.0, "held"), beside) < hunt.badness("stop", outcome(5.0), beside)
    assert hunt.badness("stop", outcome(5.0), beside) < hunt.badness("stop", outcome(5.0), before)


def test_the_search_finds_what_makes_flights_fail_and_drops_the_rest():
    found = hunt.hunt("near", 1, hunt.Budget(150, 5, 2), HERE, flown_into_plain_walls)
    simple = found[:2]
    assert all(failure.kind == "near miss" for failure in found)
    assert all(set(failure.case) <= {"plainness", "speed_m_s"} for failure in simple)
    assert all(failure.case["plainness"] > 0.5 for failure in simple)
    for failure in simple:
        assert failure.nearest_m == flown_into_plain_walls(1, 320, failure.case).nearest_m


def test_an_aim_that_is_not_there_is_refused(tmp_path, capsys):
    assert_refused(call(capsys, "hunt", tmp_path, "--aim", "moon"), "moon")


@pytest.mark.slow
def test_glare_and_faults_reach_the_flight(monkeypatch):
    monkeypatch.setattr(hunt, "WAY_M", 14.0)
    assert hunt.conditions_of({"pose_noise": 0.7, "glare": 0.3}, 160).pose_noise
    sun = {"sun_from_deg": 0.0, "sun_height_deg": 10.0, "speed_m_s": 8.0, "aside_m": 2.0}
    seen = []

    def expose(camera, *moment):
        seen[-1].append(exposed(camera, *moment))
        return seen[-1][-1]

    exposed = StereoCamera.expose
    monkeypatch.setattr(StereoCamera, "expose", expose)
    for glare in (0.0, 0.6):
        seen.append([])
        hunt.fly(1, 160, sun | {"glare": glare})
    (plain, _), (glaring, _) = seen[0][0], seen[1][0]
    assert glaring.mean() > plain.mean() + 5.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "failure", hunt.kept(), ids=lambda failure: f"{failure.kind} {hunt.name_of(failure.case)}"
)
def test_what_was_found_has_not_become_worse(failure):
    """A failure that is mended is kept as `none`."""
    again = hunt.fly(failure.seed, hunt.FLOWN_PX, failure.case)
    assert hunt.KINDS.index(hunt.kind_of(again, failure.case)) <= hunt.KINDS.index(failure.kind)
