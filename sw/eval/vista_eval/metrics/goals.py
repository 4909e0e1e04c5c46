"""The goals of the test flights, and what was reached."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from vista_eval.metrics.comparison import Comparison
from vista_eval.metrics.flight_score import FIRST_DETECTION_M, FlightScore
from vista_eval.metrics.group import group_score, nees, percent, share
from vista_eval.metrics.rules import HIT_RANGE, HIT_RANGE_M
from vista_eval.report.table import Table, fixed

AIMED_KINDS = ("sign", "pole")  # the paper's obstacles
HIT_RATE, WITHIN_2DZ, MEDIAN_DZ = 0.95, 0.95, 0.5
ERROR_AT_50_FT = 3.3  # 2 dz(50 ft); the paper: 6 ft
HOST_MS = 1000.0 / 60.0
NOISE_POINTS = 0.03  # that the hit rate may fall by under pose noise


@dataclass(frozen=True)
class Goal:
    demand: str
    reached: str
    met: bool | None  # None: nothing to judge it by


def goals(scores: list[FlightScore], noisy: list[FlightScore], comparison: Comparison | None) -> list[Goal]:
    """scores: of the flights not tuned on, noisy: the same flights under pose noise or none."""
    group = group_score("test", scores)
    targeted = [s for s in scores if s.hit_rate is not None]
    return [
        Goal(
            "no false collision alarm in any frame",
            f"{group.false_alarm_frames} of {group.frames} frames, {group.false_alarm_obstacles} obstacles, "
            f"{group.ghost_frames} frames with nothing there at all",
            group.false_alarm_frames == 0 if scores else None,
        ),
        _each_from(
            HIT_RANGE_M[1],
            f"hit rate at {HIT_RANGE} at least {percent(HIT_RATE)} % in each flight",
            [(s, s.hit_rate or 0.0, share(s.hits, s.band_frames)) for s in targeted],
            lambda rate: rate >= HIT_RATE,
        ),
        _first_goal("as a tracked obstacle", targeted, lambda s: s.tracked_from_m),
        _first_goal("as a warning", targeted, lambda s: s.first_detection_m),
        Goal(
            f"|P - P^| within 2 dz(r) in at least {percent(WITHIN_2DZ)} % of the tracked frames",
            f"{percent(group.within_2dz) or '-'} % of {group.matched_frames}",
            None if group.within_2dz is None else group.within_2dz >= WITHIN_2DZ,
        ),
        Goal(
            f"median |P - P^| below {MEDIAN_DZ} dz(r)",
            fixed(group.median_dz, 2) or "no samples",
            None if group.median_dz is None else group.median_dz < MEDIAN_DZ,
        ),
        _each(
            f"error at 50 ft below {ERROR_AT_50_FT} ft",
            [
                (s.name, s.error_at_50_ft, f"{s.error_at_50_ft:.1f} ft")
                for s in targeted
                if s.error_at_50_ft is not None
            ],
            lambda error_ft: error_ft < ERROR_AT_50_FT,
        ),
        _each(
            "RMS error of a flight below the companion paper's",
            [
                (s.name, s.rms_ft - s.companion_rms_ft, f"{s.rms_ft:.1f} against {s.companion_rms_ft} ft")
                for s in targeted
                if s.companion_rms_ft is not None and s.rms_ft is not None
            ],
            lambda excess_ft: excess_ft < 0.0,
        ),
        _stereo_goal(comparison),
        Goal(
            "average NEES within its 95 % band",
            nees(group.consistency) or "no samples",
            None if group.consistency is None else group.consistency.within,
        ),
        _each(
            "host stage at 60 Hz in the median frame",
            [(s.name, s.host_ms, f"{s.host_ms:.1f} ms") for s in scores],
            lambda host_ms: host_ms <= HOST_MS,
        ),
        _noise_goal(scores, noisy),
        Goal(
            "an obstacle nearer than the disparity range is still warned of",
            f"{share(group.blind_reported, group.blind_frames) or 'no such frames'}",
            group.blind_reported == group.blind_frames if group.blind_frames else None,
        ),
    ]


def _each(demand: str, values: list[tuple[str, float, str]], good: Callable[[float], bool]) -> Goal:
    """values: flight, figure, its text; the text names the flights that fall short."""
    if not values:
        return Goal(demand, "no such flight", None)
    short = [f"{name} {text}" for name, value, text in values if not good(value)]
    reached = f"{len(values) - len(short)} of {len(values)} flights"
    return Goal(demand, reached + (f"; not {', '.join(short)}" if short else ""), not short)


def _each_from(
    begin_m: float,
    demand: str,
    values: list[tuple[FlightScore, float, str]],
    good: Callable[[float], bool],
) -> Goal:
    """_each of the flights that begin at begin_m or farther; the others are named with what they show."""
    near = [f"{s.name} from {s.begins_m:.1f} m {text}" for s, _, text in values if s.begins_within(begin_m)]
    far = [(s.name, value, text) for s, value, text in values if not s.begins_within(begin_m)]
    goal = _each(demand, far, good)
    return replace(goal, reached=goal.reached + (f"; begins nearer: {', '.join(near)}" if near else ""))


def _first_goal(
    what: str, targeted: list[FlightScore], first_m: Callable[[FlightScore], float | None]
) -> Goal:
    aimed = [(s, first_m(s)) for s in targeted if s.target_kind in AIMED_KINDS]
    return _each_from(
        FIRST_DETECTION_M,
        f"first detection of sign and pole at {FIRST_DETECTION_M:.0f} m or farther: {what}",
        [(s, range_m or 0.0, "never" if range_m is None else f"{range_m:.1f} m") for s, range_m in aimed],
        lambda range_m: range_m >= FIRST_DETECTION_M,
    )


def _stereo_goal(comparison: Comparison | None) -> Goal:
    demand = "better than stereo alone: no threshold with fewer misses and fewer false alarms"
    if comparison is None:
        return Goal(demand, "not compared", None)
    beating = len(comparison.beating)
    return Goal(demand, f"{beating or 'none'} of {len(comparison.alone)}", not beating)


def _noise_goal(scores: list[FlightScore], noisy: list[FlightScore]) -> Goal:
    points = f"{100 * NOISE_POINTS:.0f} points"
    demand = f"with pose noise the hit rate falls by at most {points}, and no false alarm appears"
    if not noisy:
        return Goal(demand, "not flown (--pose-noise)", None)
    exact, disturbed = group_score("test", scores), group_score("test", noisy)
    if exact.hit_rate is None or disturbed.hit_rate is None:
        return Goal(demand, "no such flight", None)
    return Goal(
        demand,
        f"{100 * exact.hit_rate:.1f} to {100 * disturbed.hit_rate:.1f} %, "
        f"{exact.false_alarm_frames} to {disturbed.false_alarm_frames} frames with a false alarm",
        disturbed.hit_rate >= exact.hit_rate - NOISE_POINTS
        and disturbed.false_alarm_frames <= exact.false_alarm_frames,
    )


def table(reached: list[Goal]) -> Table:
    marks = {True: "met  ", False: "SHORT", None: "-    "}
    lines = [(f"{marks[goal.met]} {goal.demand}: {goal.reached}",) for goal in reached]
    return Table("goals", (), lines, title="What the flights not tuned on have to show")
