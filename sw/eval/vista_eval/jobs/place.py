"""The place where jobs run, as the command line says it."""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from pathlib import Path

from vista.command.arguments import positive


@dataclass(frozen=True)
class Place:
    processes: int = 1  # of this machine; 1: the one that asks
    cluster: str | None = None  # address of a Dask scheduler, which then decides

    def known_to_all(self, folder: Path) -> Path:
        """The folder as every worker finds it: workers of a cluster have working directories of their own."""
        return folder if self.cluster is None else folder.absolute()


HERE = Place()


def add_place(parser: argparse.ArgumentParser) -> None:
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--jobs",
        type=positive,
        metavar="N",
        help="processes that work at the same time; 1: this one alone (default: one for each core)",
    )
    where.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="work on the Dask cluster whose scheduler is at this address, such as tcp://10.0.0.5:8786",
    )


def chosen_place(arguments: argparse.Namespace, processes: int | None = None) -> Place:
    """processes: how many unless --jobs is given; None: one for each core."""
    return Place(arguments.jobs or processes or len(os.sched_getaffinity(0)), arguments.cluster)
