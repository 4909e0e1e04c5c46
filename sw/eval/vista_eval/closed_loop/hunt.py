"""A search for flights that fail: an evolution strategy moves worlds, textures, light, faults and speed.

    CMA-ES ─> many flights at half the width ─> the worst at full width ─> each failure as simple as it can be

The family is that of boxes on a straight route. A case is a value for each of PARAMETERS; one that is not
named has its default, at which one small textured box stands on the route under a high sun from behind. A
failure is made simple by moving one parameter after the other back to its default while it still fails."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from vista import parameters
from vista.errors import InputError

from vista_eval.closed_loop.collision import Geometry
from vista_eval.closed_loop.loop import Conditions
from vista_eval.closed_loop.outcome import Outcome, outcome_of
from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.rivals import RIVALS
from vista_eval.closed_loop.world import World
from vista_eval.jobs import Place, jobs_of, run
from vista_eval.render.scene import Panel, Thing
from vista_eval.worlds.grounds import COVERS

Case = dict[str, float]
Aim = Literal["near", "stop"]
Kind = Literal["none", "needless stop", "near miss", "collision"]  # the worse the later
KINDS: tuple[Kind, ...] = ("none", "needless stop", "near miss", "collision")
PROPOSING_PX, FLOWN_PX = 160, 320  # widths of the images
AT_ONCE = 10  # cases of a generation
SPREAD = 0.3  # of the first generation, as a share of each range
CLEAR_M = 3.0  # between route and boxes: whoever stops there does so needlessly
WAY_M, HEIGHT_M, BOX_HEIGHT_M = 45.0, 10.0, 16.0
PERIOD_TEXELS = 32  # of a wall that repeats
COVER, SUN, FILL = "pasture", 4.0, 1.8
HUNTED = Path(__file__).with_name("hunted.json")
INSTALL = "pip install cma"


class Parameter(NamedTuple):
    low: float
    high: float
    default: float


PARAMETERS: dict[str, Parameter] = {
    "aside_m": Parameter(-8.0, 8.0, 0.0),
    "ahead_m": Parameter(14.0, 34.0, 22.0),
    "turn_deg": Parameter(0.0, 90.0, 0.0),
    "length_m": Parameter(1.0, 12.0, 3.0),
    "width_m": Parameter(1.0, 12.0, 3.0),
    "second_m": Parameter(0.0, 10.0, 0.0),  # side of a second box; there is none below 1
    "second_aside_m": Parameter(-10.0, 10.0, 0.0),
    "second_ahead_m": Parameter(14.0, 40.0, 32.0),
    "plainness": Parameter(0.0, 1.0, 0.0),  # share of the walls' contrast that is taken away
    "repetition": Parameter(0.0, 1.0, 0.0),  # share of the walls' texture that is one piece over and over
    "sun_from_deg": Parameter(0.0, 180.0, 180.0),  # off the route: 0 shines into the cameras
    "sun_height_deg": Parameter(5.0, 65.0, 45.0),
    "glare": Parameter(0.0, 0.6, 0.0),
    "speed_m_s": Parameter(2.0, 8.0, 5.0),
    "latency_s": Parameter(0.05, 0.25, 0.05),
    "drop_outs": Parameter(0.0, 0.2, 0.0),
    "pose_noise": Parameter(0.0, 1.0, 0.0),  # on from 0.5 on
    "noise_grey": Parameter(1.5, 6.0, 1.5),
}


@dataclass(frozen=True)
class Failure:
    kind: Kind
    case: Case  # what differs from the defaults
    seed: int
    nearest_m: float
    end: str


# ---- cases ----


def at(place: Sequence[float]) -> Case:
    """The case at a place in the unit cube."""
    return {
        name: range_.low + float(share) * (range_.high - range_.low)
        for (name, range_), share in zip(PARAMETERS.items(), place, strict=True)
    }


def beginning() -> list[float]:
    """The place of the defaults."""
    return [(each.default - each.low) / (each.high - each.low) for each in PARAMETERS.values()]


def whole(case: Case) -> Case:
    """The case with all of its parameters. Raises InputError."""
    unknown = [name for name in case if name not in PARAMETERS]
    if unknown:
        raise InputError("hunt", f"no parameter {unknown[0]}")
    return {name: each.default for name, each in PARAMETERS.items()} | case


def world_of(case: Case, seed: int) -> World:
    told = whole(case)
    size = told["length_m"], told["width_m"], BOX_HEIGHT_M
    boxes = [parts.upright_box("box0", (told["ahead_m"], told["aside_m"]), size, told["turn_deg"], seed)]
    if told["second_m"] >= 1.0:
        place = told["second_ahead_m"], told["second_aside_m"]
        boxes.append(parts.upright_box("box1", place, (*2 * (told["second_m"],), BOX_HEIGHT_M), 0.0, seed))
    boxes = [dressed(box, told["plainness"], told["repetition"]) for box in boxes]
    scene = parts.scene(seed, COVER, boxes, (-5.0, 60.0), (-20.0, 20.0))
    height, aside = math.radians(told["sun_height_deg"]), math.radians(told["sun_from_deg"])
    falling = SUN * math.sin(height) + 0.55 * FILL
    scene = replace(
        scene,
        to_sun=(math.cos(height) * math.cos(aside), math.cos(height) * math.sin(aside), math.sin(height)),
        sun_irradiance=SUN,
        fill_irradiance=FILL,
        sky="blue",
        haze=None,
        exposure=0.3 * math.pi / (COVERS[COVER].mean * falling),
    )
    route = (0.0, 0.0, HEIGHT_M), (WAY_M, 0.0, HEIGHT_M)
    return World("hunted", "hunted", scene, route, told["speed_m_s"], seed=seed)


def dressed(box: Thing, plainness: float, repetition: float) -> Thing:
    return replace(
        box,
        solids=tuple(
            replace(solid, albedo=faced(solid.albedo, plainness, repetition))
            if isinstance(solid, Panel)
            else solid
            for solid in box.solids
        ),
    )


def faced(albedo: np.ndarray, plainness: float, repetition: float) -> np.ndarray:
    """A wall of which a share repeats along both sides, with a share of its contrast taken away."""
    piece = albedo[:PERIOD_TEXELS, :PERIOD_TEXELS]
    times = [-(-size // of) for size, of in zip(albedo.shape, piece.shape, strict=True)]
    repeated = np.tile(piece, times)[: albedo.shape[0], : albedo.shape[1]]
    mixed = albedo + repetition * (repeated - albedo)
    return np.asarray(mixed + plainness * (mixed.mean() - mixed), np.float32)


def conditions_of(case: Case, width_px: int) -> Conditions:
    told = whole(case)
    return Conditions(
        latency_s=told["latency_s"],
        width_px=width_px,
        noise_grey=told["noise_grey"],
        drop_outs=told["drop_outs"],
        pose_noise=told["pose_noise"] >= 0.5,
        glare=told["glare"],
    )


def clear_m(case: Case) -> float:
    """How far the boxes are from the straight route."""
    geometry = Geometry(world_of(case, 1).scene)
    places = np.arange(1.0, WAY_M - 1.0, 0.5)
    return min(geometry.nearest(np.array([x, 0.0, HEIGHT_M])).distance_m for x in places)


# ---- flights ----

Fly = Callable[[int, int, Case], Outcome]  # of seed, width of the images, and case


def fly(seed: int, width_px: int, case: Case) -> Outcome:
    """Flies the planner by the chain that ships."""
    flight = RIVALS["planner"].fly(world_of(case, seed), parameters.defaults(), conditions_of(case, width_px))
    return outcome_of(flight, "planner")


def kind_of(outcome: Outcome, case: Case) -> Kind:
    if outcome.crashed:
        return "collision"
    room_m = World.room_m
    if outcome.nearest_m < room_m:
        return "near miss"
    stopped = outcome.stops > 0 or outcome.end != "reached"
    return "needless stop" if stopped and clear_m(case) >= CLEAR_M else "none"


def badness(aim: Aim, outcome: Outcome, case: Case) -> float:
    """What the search makes small."""
    if aim == "near":
        return -1.0 if outcome.crashed else outcome.nearest_m
    blocked_m = max(0.0, CLEAR_M - clear_m(case))  # there a stop would not be needless
    swift = outcome.route_m / outcome.time_s / outcome.speed_m_s if outcome.end == "reached" else 0.0
    return swift + blocked_m


# ---- the search ----


@dataclass(frozen=True)
class Budget:
    """Flights at most: of the search, of confirmation, and failures that are made simple."""

    proposed: int
    confirmed: int
    simplified: int


def hunt(aim: Aim, seed: int, budget: Budget, place: Place, fly_case: Fly = fly) -> list[Failure]:
    """The failures that were found, those that are simple first."""
    proposals = sorted(proposed(aim, seed, budget.proposed, place, fly_case), key=lambda one: one[0])
    chosen = [case for _, case in proposals[: budget.confirmed]]
    flown = run(jobs_of(partial(fly_case, seed, FLOWN_PX), chosen, name_of), place, "confirm", "flight")
    failed = [
        failure_of(case, seed, outcome)
        for case, outcome in zip(chosen, flown, strict=True)
        if kind_of(outcome, case) != "none"
    ]
    failed.sort(key=lambda failure: (-KINDS.index(failure.kind), failure.nearest_m))
    work = partial(simplified, fly_case)
    simple = run(
        jobs_of(work, failed[: budget.simplified], lambda one: one.kind), place, "simplify", "failure"
    )
    return [*simple, *failed[budget.simplified :]]


def proposed(aim: Aim, seed: int, count: int, place: Place, fly_case: Fly) -> Iterator[tuple[float, Case]]:
    """Cases with how bad their flights at half the width were."""
    try:
        import cma  # type: ignore[import-untyped]
    except ModuleNotFoundError:
        raise InputError("vista hunt", f"cma is not installed: {INSTALL}") from None
    options: dict[str, Any] = {"bounds": [0, 1], "popsize": AT_ONCE, "seed": seed, "verbose": -9}
    search = cma.CMAEvolutionStrategy(beginning(), SPREAD, options)
    for first in range(0, count, AT_ONCE):
        places = search.ask()
        cases = [at(each) for each in places]
        title = f"propose {first} to {first + len(cases)}"
        flown = run(jobs_of(partial(fly_case, seed, PROPOSING_PX), cases, name_of), place, title, "flight")
        found = [badness(aim, outcome, case) for outcome, case in zip(flown, cases, strict=True)]
        search.tell(places, found)
        yield from zip(found, cases, strict=True)


def name_of(case: Case) -> str:
    return ", ".join(f"{name} {value:.3g}" for name, value in case.items())


def failure_of(case: Case, seed: int, outcome: Outcome) -> Failure:
    different = {name: round(value, 4) for name, value in case.items() if value != PARAMETERS[name].default}
    return Failure(kind_of(outcome, case), different, seed, outcome.nearest_m, outcome.end)


def simplified(fly_case: Fly, failure: Failure) -> Failure:
    """The failure with as many parameters at their defaults as it takes for it to remain of its kind."""
    for name in PARAMETERS:
        if name not in failure.case:
            continue
        case = {other: value for other, value in failure.case.items() if other != name}
        outcome = fly_case(failure.seed, FLOWN_PX, case)
        if kind_of(outcome, case) == failure.kind:
            failure = failure_of(case, failure.seed, outcome)
    return failure


# ---- what is kept ----


def as_text(failures: Sequence[Failure]) -> str:
    return json.dumps([vars(failure) for failure in failures], indent=1) + "\n"


def kept() -> list[Failure]:
    """The failures that are flown again by the tests."""
    return [Failure(**one) for one in json.loads(HUNTED.read_text())]
