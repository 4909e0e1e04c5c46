"""One way to score: a suite says what is made of each of its items, as jobs, and what all of it comes to.

    suite.jobs ─> jobs.run ─> suite.scoring ─> tables on the screen, NAME.json, one page

The suites are `vista_eval.suites`: flights, worlds, pairs with measured truth, faults.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from vista import parameters
from vista.output import write_atomically

from vista_eval.jobs import Job, Place, run
from vista_eval.report.page import Page
from vista_eval.report.table import Table, write_measurement


@dataclass(frozen=True)
class Scoring:
    """What the items of a suite come to together."""

    shown: Sequence[Table]  # printed
    page: Page
    content: dict[str, Any]  # of the JSON file, beside what the documentation keeps
    stated: Sequence[Table] = ()  # in the documentation
    figures: Any = None  # that the documentation keeps
    headline: tuple[str, str] | None = None
    remark: str = ""  # printed below the tables


class Suite(Protocol):
    @property
    def name(self) -> str:
        """Name of the JSON file."""

    @property
    def page_name(self) -> str: ...

    def jobs(self, values: parameters.Values) -> list[Job]: ...

    def scoring(self, results: list[Any], values: parameters.Values) -> Scoring: ...


def score(
    suite: Suite, folder: Path, values: parameters.Values, place: Place, kept: Path | None = None
) -> None:
    """Print the tables; the folder receives the JSON file and the page. Raises InputError and JobsError.

    kept: folder of the results of jobs, where an interrupted scoring goes on."""
    results = run(suite.jobs(values), place, "score", kept=kept)
    found = suite.scoring(results, values)
    path, page = folder / f"{suite.name}.json", folder / suite.page_name
    rendered = found.page.render()
    write_measurement(path, found.stated, found.figures, found.headline, **found.content)
    write_atomically(page, rendered)
    print("\n\n".join(table.as_text() for table in found.shown))
    print(f"\n{found.remark}report: {page}, figures: {path}")
