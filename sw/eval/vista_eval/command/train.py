"""Learn from flights how much each piece of evidence says that something is in the way.

FLIGHTS are folders of flights with their truth: sampled worlds, flights of the paper, or flights by others,
whose truth.json lists obstacles. A folder that is not there is named and left out; a flight of the split test
is refused. Each is flown, and all places on its path give their evidence and what truly is there; what is
kept in DIR is not flown again. A family of flights weighs as much as any other. What the odds are worth is
said of each family by odds that it had no part in.

The flights with labels of objects also show how well the affinity of neighbouring cells (the paper's equation
3) tells one object from two, and what other weights would make of the same features.

The tables are printed. DIR receives space-odds.json and affinity-weights.json, each with a page; the checkout
receives sw/src/space/space_odds.h, unless --dry-run is given.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from vista.command.arguments import add_config, load_parameters
from vista.errors import EXIT_OK, InputError
from vista.output import write_atomically

from vista_eval.dataset.truth import TRUTH, has_labels
from vista_eval.jobs import add_place, chosen_place


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of what is kept, and of the results")
    parser.add_argument(
        "flights", type=Path, nargs="+", metavar="FLIGHTS", help="a flight, or a folder of flights"
    )
    parser.add_argument("--dry-run", action="store_true", help="leave the checkout as it is")
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    place = chosen_place(arguments)
    folders = [place.known_to_all(folder) for given in arguments.flights for folder in flights_in(given)]
    if not folders:
        raise InputError("FLIGHTS", "none of these folders holds a flight with its truth")
    from vista_eval.metrics.scoring_log import checkout_of
    from vista_eval.score import score
    from vista_eval.suites.affinity_weights import AffinityWeights  # loads libvista, which `--help` need not
    from vista_eval.suites.space_odds import SpaceOdds
    from vista_eval.training.odds import HEADER, Odds, header

    def write(odds: Odds) -> None:
        path = checkout_of(Path(__file__)) / HEADER
        write_atomically(path, header(odds))
        print(f"written: {path}\n")

    cache = place.known_to_all(arguments.folder) / "evidence"
    suite = SpaceOdds(folders, cache) if arguments.dry_run else SpaceOdds(folders, cache, write)
    score(suite, arguments.folder, values, place)
    labelled = [folder for folder in folders if has_labels(folder)]
    if labelled:
        score(AffinityWeights(labelled, cache), arguments.folder, values, place)
    return EXIT_OK


def flights_in(folder: Path) -> Iterator[Path]:
    """The folder itself, or those in it that are flights."""
    if not folder.exists():
        print(f"left out: {folder} is not there")
    elif (folder / TRUTH).exists():
        yield folder
    else:
        yield from sorted(path.parent for path in folder.glob(f"*/{TRUTH}"))
