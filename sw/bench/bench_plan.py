"""The planner in flight: how long a decision takes, by what was decided.

Flights in worlds of the closed loop at 640x480, with the planner and what it keeps of all frames before.
Times are processor time of the thread, since wall time counts what else the machine does.

    bench_plan.py [--out build/bench/plan.json]
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "build" / "python")]

from vista import parameters  # noqa: E402
from vista_eval.closed_loop.loop import Conditions  # noqa: E402
from vista_eval.closed_loop.perception import Perception  # noqa: E402
from vista_eval.closed_loop.pilots import Decision, Seen  # noqa: E402
from vista_eval.closed_loop.places.catalog import FAMILIES  # noqa: E402
from vista_eval.closed_loop.planned import WithPlanner  # noqa: E402
from vista_eval.closed_loop.rivals import RIVALS  # noqa: E402
from vista_eval.report.table import Table, write_measurement  # noqa: E402

FLIGHTS = {
    "multirotor": (("poisson", 60), ("forest", 61), ("city", 60), ("wires", 60)),
    "fixed-wing": (("wide_street", 61), ("forest_edge", 60)),
}
WIDTH_PX = 640
WITHOUT_WAY = ("escapes", "helpless")
TARGET_MS = 2.0  # at the 99.9th percentile


class Timed(WithPlanner):
    """A pilot that notes what was decided, and how many milliseconds it took."""

    def __init__(self, perception: Perception, values: parameters.Values) -> None:
        super().__init__(perception, values)
        self.noted: list[tuple[str, float]] = []

    def decide(self, seen: Seen) -> Decision:
        decision = super().decide(seen)
        if decision.action != "looks":
            self.noted.append((decision.action, self.planner.took_ms))
        return decision


def fly(vehicle: str, family: str, number: int) -> list[tuple[str, float]]:
    """What was decided in a flight, with the milliseconds of each decision."""
    pilots: list[Timed] = []

    def timed(perception: Perception, values: parameters.Values, conditions: Conditions) -> Timed:
        pilots.append(Timed(perception, values))
        return pilots[-1]

    world = FAMILIES[family].world(number, 1, None)
    conditions = Conditions(vehicle=vehicle, width_px=WIDTH_PX)
    replace(RIVALS["planner"], pilot=timed).fly(world, parameters.defaults(), conditions)
    return pilots[0].noted


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    print(f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors\n")
    rows, figures = [], {}
    for vehicle, flights in FLIGHTS.items():
        noted = [one for family, number in flights for one in fly(vehicle, family, number)]
        for what, kept in (
            ("all", noted),
            ("no manoeuvre passes", [one for one in noted if one[0] in WITHOUT_WAY]),
        ):
            if not kept:
                continue
            shares = [float(np.percentile([ms for _, ms in kept], share)) for share in (50.0, 99.0, 99.9)]
            figures[f"{vehicle}, {what}"] = {"decisions": len(kept), "median_p99_p999_ms": shares}
            rows.append((vehicle, what, f"{len(kept)}", *(f"{ms:.2f}" for ms in shares)))
    heads = ("vehicle", "decisions", "number", "median ms", "p99 ms", "p99.9 ms")
    flown = ", ".join(f"{family} {number}" for flights in FLIGHTS.values() for family, number in flights)
    legend = f"Flights at {WIDTH_PX} px: {flown}; target {TARGET_MS} ms at p99.9."
    table = Table("plan-decisions", heads, rows, legend)
    print(table.as_text())
    if arguments.out is not None:
        write_measurement(arguments.out, [table], figures, target_ms=TARGET_MS)
    return 0


if __name__ == "__main__":
    sys.exit(main())
