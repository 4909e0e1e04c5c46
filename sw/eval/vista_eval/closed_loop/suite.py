"""Many flights in the loop, each by itself, and one page of all, which begins with the worst."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup
from vista import native, parameters
from vista.output import make_folder

from vista_eval.cache import code_digest, digest_of, kept
from vista_eval.closed_loop.film import Map, frame_of, write_film
from vista_eval.closed_loop.loop import Conditions, Flight, Moment
from vista_eval.closed_loop.outcome import NEAR_MISS_M, Outcome, first_wrong, outcome_of
from vista_eval.closed_loop.places.catalog import CLEAR, FAMILIES
from vista_eval.closed_loop.record import write_mcap, write_record
from vista_eval.closed_loop.rivals import RIVALS
from vista_eval.fly import LIBRARIES
from vista_eval.jobs import Job, jobs_of
from vista_eval.metrics.intervals import clopper_pearson, poisson
from vista_eval.report.page import Page, Picture, Section, as_jpeg
from vista_eval.report.table import Table
from vista_eval.score import Scoring

MOST_WORST = 40  # flights with pictures on the page


class Key(NamedTuple):
    family: str
    number: int
    seed: int
    speed_m_s: float | None
    rival: str


class Flown(NamedTuple):
    outcome: Outcome
    folder: Path
    still: bytes | None  # of the decision to look at first,
    said: str  # and what it was


def name_of(key: Key) -> str:
    speed = "" if key.speed_m_s is None else f"_{key.speed_m_s:g}"
    return f"{key.family}_{key.number:03d}{speed}_{key.rival}"


def fly_one(
    folder: Path, values: parameters.Values, conditions: Conditions, films: bool, mcap: bool, key: Key
) -> Flown:
    """One flight, unless it is kept from a run before; its folder receives the record and what else is asked
    for."""
    out = folder / name_of(key)
    deciding = json.dumps([key, values, asdict(conditions), films, mcap], sort_keys=True)
    digest = digest_of(
        deciding, code_digest(__name__), *map(native.library_path, (*LIBRARIES, "vista_render"))
    )

    def flown() -> dict[str, Any]:
        world = FAMILIES[key.family].world(key.number, key.seed, key.speed_m_s)
        rival = RIVALS[key.rival]
        flight = rival.fly(world, values, conditions)
        make_folder(out)
        write_record(out / "flight.jsonl", flight, rival.name)
        if films:
            write_film(out / "flight.webm", flight)
        if mcap:
            write_mcap(out / "flight.mcap", flight)
        moment = first_look(flight)
        still = still_of(flight, moment)
        picture = None if still is None else base64.b64encode(still).decode()
        outcome = asdict(outcome_of(flight, rival.name))
        return {"outcome": outcome, "still": picture, "said": said_of(moment)}

    found = kept(out / "outcome.json", digest, flown, as_found)
    still = found["still"]
    picture = None if still is None else base64.b64decode(still)
    return Flown(Outcome(**found["outcome"]), out, picture, found["said"])


def as_found(content: Any) -> dict[str, Any]:
    return dict(content)


def first_look(flight: Flight) -> Moment:
    """The decision that a crash begins with, else that of the nearest moment."""
    return first_wrong(flight) or min(flight.moments, key=lambda m: m.near.distance_m)


def said_of(moment: Moment) -> str:
    """What was decided, and why."""
    action = f"{moment.decision.action}, {moment.decision.why}".removesuffix(", ")
    speed = float(np.linalg.norm(moment.state.velocity_m_s))
    return f"at {moment.t_s:.1f} s and {speed:.1f} m/s: {action}"


def still_of(flight: Flight, moment: Moment) -> bytes | None:
    if moment.record is None:
        return None
    return as_jpeg(frame_of(flight, Map(flight), moment, flight.moments.index(moment)))


@dataclass(frozen=True)
class ClosedLoop:
    folder: Path
    keys: Sequence[Key]
    conditions: Conditions
    films: bool = False
    mcap: bool = False
    name: str = "fly"

    @property
    def page_name(self) -> str:
        return f"{self.name}.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        work = partial(fly_one, self.folder, values, self.conditions, self.films, self.mcap)
        return jobs_of(work, self.keys, name_of)

    def scoring(self, results: list[Flown], values: parameters.Values) -> Scoring:
        outcomes = [flown.outcome for flown in results]
        made = [by_rival(outcomes), by_family(outcomes), by_speed(outcomes), losses(outcomes)]
        shown = [replace(table, name=table.name.replace("fly", self.name)) for table in made if table.rows]
        return Scoring(
            shown,
            page(results, shown, self.conditions, values),
            {"flights": [asdict(outcome) for outcome in outcomes], "conditions": asdict(self.conditions)},
            shown,
        )


# ---- tables ----

HEADS = (
    "flights",
    "crashed",
    "95 %",
    "reached",
    f"under {NEAR_MISS_M} m",
    "stopped",
    "detour",
    "evasions",
    "km",
)


def row_of(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    crashed = sum(outcome.crashed for outcome in outcomes)
    low, high = clopper_pearson(crashed, len(outcomes))
    reached = [outcome for outcome in outcomes if outcome.end == "reached"]
    return (
        str(len(outcomes)),
        str(crashed),
        f"{low:.2f} to {high:.2f}",
        str(len(reached)),
        str(sum(outcome.nearest_m < NEAR_MISS_M for outcome in outcomes)),
        str(sum(outcome.stops > 0 for outcome in outcomes)),
        f"{100 * median(outcome.detour for outcome in reached):.0f} %" if reached else "-",
        str(sum(outcome.evasions for outcome in outcomes)),
        f"{sum(outcome.way_m for outcome in outcomes) / 1000:.2f}",
    )


def by_rival(outcomes: Sequence[Outcome]) -> Table:
    rows = [
        (RIVALS[rival].title, *row_of([one for one in outcomes if one.rival == rival]))
        for rival in rivals_of(outcomes)
    ]
    legend = (
        "95 %: exact interval of the share that crashed, over flights. Under 1.5 m: of the vehicle's middle. "
        "Stopped: flights that came to rest on the way. Detour: median of those that reached the goal."
    )
    return Table("fly", ("", *HEADS), rows, legend, title="All worlds")


def by_family(outcomes: Sequence[Outcome]) -> Table:
    rows: list[tuple[str, ...]] = []
    for family, speed in sorted({(one.family, round(one.speed_m_s)) for one in outcomes}):
        for rival in rivals_of(outcomes):
            chosen = [
                one
                for one in outcomes
                if (one.family, round(one.speed_m_s), one.rival) == (family, speed, rival)
            ]
            if chosen:
                rows.append((f"{family}, {speed} m/s, {RIVALS[rival].title}", *row_of(chosen)))
    return Table("fly-families", ("", *HEADS), rows, title="By family and speed")


def by_speed(outcomes: Sequence[Outcome]) -> Table:
    """What goes wrong in a kilometre, where something is in the way and where nothing is."""
    rows: list[tuple[str, ...]] = []
    for speed in sorted({round(one.speed_m_s) for one in outcomes}):
        for rival in rivals_of(outcomes):
            chosen = [one for one in outcomes if (round(one.speed_m_s), one.rival) == (speed, rival)]
            clear = [one for one in chosen if one.family in CLEAR]
            blocked = [one for one in chosen if one.family not in CLEAR]
            if not chosen:
                continue
            rows.append(
                (
                    f"{speed} m/s, {RIVALS[rival].title}",
                    *per_km(blocked, [one.crashed for one in blocked]),
                    *per_km(blocked, [not one.crashed and one.nearest_m < NEAR_MISS_M for one in blocked])[
                        1:
                    ],
                    *per_km(clear, [one.stops > 0 or one.end == "held" for one in clear]),
                )
            )
    legend = (
        "In brackets the exact Poisson interval of 95 %. At most one collision, near miss (nearer than "
        f"{NEAR_MISS_M} m) and needless stop counts for each flight. Needless: in worlds with nothing in the "
        "way."
    )
    heads = ("", "km", "collisions/km", "near misses/km", "km clear", "needless stops/km")
    return Table("fly-speeds", heads, rows, legend, title="By speed")


def per_km(outcomes: Sequence[Outcome], had: list[bool]) -> tuple[str, str]:
    """The way of the flights, and how many of them had something, a kilometre."""
    way_km = sum(one.way_m for one in outcomes) / 1000
    if way_km == 0:
        return "0.00", "-"
    low, high = poisson(sum(had))
    return f"{way_km:.2f}", f"{sum(had) / way_km:.1f} ({low / way_km:.1f} to {high / way_km:.1f})"


def losses(outcomes: Sequence[Outcome]) -> Table:
    """Crashes by what was hit and why."""
    crashed = [one for one in outcomes if one.crashed]
    groups = sorted({(one.rival, one.cause, kind_of(one.hit)) for one in crashed})
    rows = [
        (
            RIVALS[rival].title,
            hit,
            cause,
            str(sum((one.rival, one.cause, kind_of(one.hit)) == (rival, cause, hit) for one in crashed)),
        )
        for rival, cause, hit in groups
    ]
    return Table("fly-losses", ("", "hit", "cause", "flights"), rows, title="Crashes by cause")


def kind_of(hit: str) -> str:
    return hit.rstrip("0123456789_")


def rivals_of(outcomes: Sequence[Outcome]) -> list[str]:
    return [name for name in RIVALS if any(one.rival == name for one in outcomes)]


# ---- the page ----


def page(
    results: Sequence[Flown], shown: list[Table], conditions: Conditions, values: parameters.Values
) -> Page:
    worst = sorted(results, key=lambda flown: badness(flown.outcome))[:MOST_WORST]
    facts = (
        f"{len(results)} flights ({conditions.vehicle}) at {conditions.rate_hz:g} frames/s, "
        f"{conditions.latency_s:g} s from the exposure to the command, images {conditions.width_px} px wide "
        f"over {conditions.view_deg:g} degrees with a noise of {conditions.noise_grey:g} grey levels."
    )
    sections = [Section(table.title, [table]) for table in shown]
    pictures = [worst_section(flown) for flown in worst if flown.still is not None]
    definitions = (__doc__ or "") + "\n" + DEFINITIONS
    return Page(
        "Flights in the loop",
        facts,
        [*pictures[:3], *sections, *pictures[3:]],
        definitions,
        values,
        wide=True,
    )


DEFINITIONS = """
A flight crashes when the sphere around the vehicle touches anything. Its picture is of the last decision at
which there was still room to avoid it; that of a flight that did not crash is of its nearest moment. Right:
the view from above. Black: what stands at the height of the flight. Green: directions that the detector calls
free. Yellow and red circles: obstacles that it tracks, red those in the way. Blue: the way so far."""


def badness(outcome: Outcome) -> tuple[int, float]:
    """Crashes first, then what came nearest; of a rival without eyes last."""
    order = ("collision", "late", "held", "reached")
    return (order.index(outcome.end) + 10 * (not RIVALS[outcome.rival].sees), outcome.nearest_m)


def worst_section(flown: Flown) -> Section:
    found = flown.outcome
    said = f"{found.end} {found.hit}".strip() + (f" ({found.cause})" if found.cause else "")
    title = f"{found.world}, {RIVALS[found.rival].title}: {said}, nearest {found.nearest_m:.2f} m"
    film = flown.folder / "flight.webm"
    link = Markup('<a href="{0}/flight.jsonl">record</a>').format(flown.folder.name)
    if film.exists():
        link += Markup(', <a href="{0}/flight.webm">film</a>').format(flown.folder.name)
    assert flown.still is not None
    return Section(
        title, text=link, pictures=[Picture(f"{flown.said} (of {found.time_s:.1f} s)", flown.still)]
    )
