"""Search for flights in the loop that fail, and make each failure as simple as it can be.

An evolution strategy varies boxes, texture, light, speed, latency, lost frames and noise of poses and images.
It flies images of half the width; the worst cases are flown again at full width, and of those that fail each
parameter goes back to its default while they still fail. DIR receives hunt.json with seed and parameters of
all failures. It needs what `vista fly` needs, and the package cma.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import positive
from vista.errors import EXIT_OK
from vista.output import make_folder, write_atomically

from vista_eval.jobs import add_place, chosen_place

AIMS = ("near", "stop")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the findings")
    parser.add_argument(
        "--aim",
        choices=AIMS,
        default="near",
        help="collisions and near misses, or needless stops (default near)",
    )
    parser.add_argument(
        "--budget", type=positive, default=200, metavar="N", help="flights of the search (default 200)"
    )
    parser.add_argument(
        "--confirm", type=positive, default=20, metavar="N", help="cases flown at full width (default 20)"
    )
    parser.add_argument(
        "--simplify", type=positive, default=3, metavar="N", help="failures made simple (default 3)"
    )
    parser.add_argument(
        "--seed", type=positive, default=1, metavar="N", help="seed of the search and its worlds (default 1)"
    )
    parser.add_argument(
        "--keep", action="store_true", help="add the simple ones to those that the tests fly again"
    )
    add_place(parser)


def execute(arguments: argparse.Namespace) -> int:
    from vista_eval.closed_loop import hunt  # loads libvista, which `--help` need not
    from vista_eval.closed_loop.vehicle import airframe
    from vista_eval.report.table import Table

    airframe()
    budget = hunt.Budget(arguments.budget, arguments.confirm, arguments.simplify)
    found = hunt.hunt(arguments.aim, arguments.seed, budget, chosen_place(arguments))
    make_folder(arguments.folder)
    path = arguments.folder / "hunt.json"
    write_atomically(path, hunt.as_text(found))
    if arguments.keep:
        write_atomically(hunt.HUNTED, hunt.as_text([*hunt.kept(), *found[: budget.simplified]]))
    rows = [(one.kind, one.end, f"{one.nearest_m:.2f} m", hunt.name_of(one.case)) for one in found]
    print(Table("hunt", ("", "end", "nearest", "differs from the defaults"), rows).as_text())
    print(f"\n{len(found)} of {arguments.confirm} confirmed; {path}")
    return EXIT_OK
