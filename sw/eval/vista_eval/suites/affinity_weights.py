"""The weights of affinities, learned from pairs of neighbouring cells and judged on families held back."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

from vista import parameters

from vista_eval.jobs import Job, jobs_of
from vista_eval.report.page import Page, Section
from vista_eval.report.table import Table, rounded
from vista_eval.score import Scoring
from vista_eval.training.affinity import Affinities, FlightPairs, collect_cached, learn

FACTS = (
    "Whether two neighbouring cells show one object, told by the affinity of the paper's equation 3 and by "
    "what else can be made of the same differences of intensity and disparity."
)


@dataclass(frozen=True)
class AffinityWeights:
    folders: list[Path]
    cache: Path
    name: str = "affinity-weights"

    @property
    def page_name(self) -> str:
        return f"{self.name}.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        work = partial(collect_cached, values=values, cache=self.cache)
        return jobs_of(work, self.folders, lambda folder: folder.name)

    def scoring(self, results: list[FlightPairs], values: parameters.Values) -> Scoring:
        found = learn(results, values)
        shown = [table(found)]
        return Scoring(
            shown,
            Page("Affinities, learned", FACTS, [Section(shown[0].title, shown)], parameters=values),
            {"parameters": values},
            shown,
            rounded(asdict(found), 4),
        )


def table(found: Affinities) -> Table:
    rows = [
        (
            way.name,
            f"{1e3 * way.log_loss:.0f}",
            f"{100.0 * way.wrong:.1f} %",
            ", ".join(map("{:+.2f}".format, way.weights)) if len(way.weights) <= 3 else "",
        )
        for way in found.ways
    ]
    least, most = min(found.weight_by_family.values()), max(found.weight_by_family.values())
    return Table(
        "affinity-weights",
        ("affinity", "log loss, 0.001", "wrong", "prior and weights"),
        rows,
        f"{found.pairs} pairs of neighbouring cells, both with a disparity, of {found.flights} flights of "
        f"{len(found.weight_by_family)} families; half of them show one object, half two. Log loss and the "
        "share of pairs on the wrong side of one half are means of the families, each judged by weights that "
        "it had no part in; guessing has 693 and 50 %. In the learned sum intensity has "
        f"{found.weight_of_intensity:.2f} of the weight ({least:.2f} to {most:.2f} with one family held "
        f"back). Digest of what was learned from: {found.digest}",
        "Affinities of neighbouring cells",
    )
