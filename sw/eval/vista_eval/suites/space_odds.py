"""The odds that places on the path are occupied, learned from flights, and judged on families held back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

from vista import parameters

from vista_eval.jobs import Job, jobs_of
from vista_eval.report.flight_plots import plot_reliability
from vista_eval.report.page import Page, Section
from vista_eval.report.table import Table, rounded
from vista_eval.score import Scoring
from vista_eval.training.evidence import FlightEvidence, collect_cached
from vista_eval.training.odds import WARN, Odds, learn

FACTS = (
    "Log-odds that a place on the flight path is occupied, by logistic regression in which every family of "
    "flights weighs the same. What is said of a family is said by odds that it had no part in."
)


@dataclass(frozen=True)
class SpaceOdds:
    folders: list[Path]
    cache: Path
    learned: Callable[[Odds], None] = lambda odds: None
    name: str = "space-odds"

    @property
    def page_name(self) -> str:
        return f"{self.name}.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        work = partial(collect_cached, values=values, cache=self.cache)
        return jobs_of(work, self.folders, lambda folder: folder.name)

    def scoring(self, results: list[FlightEvidence], values: parameters.Values) -> Scoring:
        odds = learn(results)
        self.learned(odds)
        shown = [weights_table(odds), families_table(odds), reliability_table(odds)]
        sections = [Section(table.title, [table]) for table in shown]
        sections[-1] = Section(shown[-1].title, [shown[-1]], plots=[plot_reliability(odds)])
        useless = f"Of no use to families held back: {', '.join(odds.useless)}.\n" if odds.useless else ""
        return Scoring(
            shown,
            Page("What is in the way, learned", FACTS, sections, parameters=values),
            {"parameters": values},
            shown,
            rounded(asdict(odds), 4),
            remark=useless,
        )


def weights_table(odds: Odds) -> Table:
    rows = [
        (
            name.lower().replace("_", " "),
            f"{value:+.2f}",
            f"{1e3 * odds.gain[name]:+.2f}" if name in odds.gain else "",
        )
        for name, value in odds.weights.items()
    ]
    return Table(
        "space-odds-weights",
        ("piece of evidence", "log-odds", "gain"),
        rows,
        "Gain: by how many thousandths of a nat the log loss of a place rises without the piece, mean of the "
        "families, each judged by odds that it had no part in. With all pieces it is "
        f"{1e3 * odds.log_loss:.1f} thousandths; by the odds that the detector had, from which no family "
        f"was held back, {1e3 * odds.before:.1f}.",
        "Log-odds that a place is occupied",
    )


def families_table(odds: Odds) -> Table:
    rows = [
        (
            family.name + ("" if family.fitted else " (not fitted on)"),
            str(family.places),
            f"{1e3 * family.log_loss:.0f}",
            f"{family.hits}/{family.asked}" if family.asked else "",
            f"{family.false_contacts}/{family.frames}",
        )
        for family in odds.families
    ]
    fitted = [family for family in odds.families if family.fitted]
    total = [
        sum(values)
        for values in zip(
            *((f.places, f.hits, f.asked, f.false_contacts, f.frames) for f in fitted), strict=True
        )
    ]
    rows.append(
        (
            "all that are fitted on",
            str(total[0]),
            f"{1e3 * odds.log_loss:.0f}",
            f"{total[1]}/{total[2]}",
            f"{total[3]}/{total[4]}",
        )
    )
    return Table(
        "space-odds-families",
        ("family held back", "places", "log loss, 0.001", "hits", "false contacts"),
        rows,
        f"A frame warns of the first place that is occupied with {WARN:g} or more. Hits: it truly is, within "
        "2 dz and 0.5 m, of the frames in which the first that is occupied lies at 14.5 to 45 m; false "
        "contacts: frames in which nothing is near it.",
        "Families held back",
    )


def reliability_table(odds: Odds) -> Table:
    rows = [
        (
            f"{k / len(odds.bins):.1f} to {(k + 1) / len(odds.bins):.1f}",
            str(one.places),
            f"{one.given:.3f}",
            f"{one.occupied:.3f}",
        )
        for k, one in enumerate(odds.bins)
        if one.places
    ]
    return Table(
        "space-odds-reliability",
        ("probability", "places", "given, mean", "truly occupied"),
        rows,
        "Places of families held back, each family weighing the same.",
        "Whether the probabilities are what they say",
    )
