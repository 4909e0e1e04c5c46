"""Render flights through sampled worlds, run the detector on them, and score it by family of content.

DIR holds one folder for each flight; what it lacks is rendered, and an interrupted run continues. Families
are drawn from stated distributions (vista_eval.worlds.sampled); `--list` names them. Parameters may be chosen
on those of the split dev. A scoring of the splits test and test2 needs a clean checkout and flights that are
those of the frozen set, and appends one line to doc/results/scorings.jsonl.

Judging is strict (vista_eval.metrics). Beside the detector fly a spanning forest in place of the cut, SGBM's
words, perfect disparities, and stereo alone with the host's tracker at each of many thresholds.

The tables are printed. DIR receives worlds-dev.json, or that of another split, which has every figure, and a
report of the same name, which shows the frames that fail first.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vista import parameters
from vista.command.arguments import add_config, load_parameters, positive
from vista.errors import EXIT_OK, InputError

from vista_eval.cache import digest_of
from vista_eval.command.arguments import add_sensor_noise
from vista_eval.jobs import Place, add_place, chosen_place, jobs_of, run

if TYPE_CHECKING:
    from vista_eval.metrics.world_score import WorldScore
    from vista_eval.worlds.sampled.family import Family

SPLITS = ("dev", "test", "test2")
Key = tuple[str, int, int]  # family, number, seed of the set


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the flights")
    parser.add_argument(
        "--family", nargs="+", default=[], metavar="NAME", help="handle only these families of the split"
    )
    parser.add_argument("--split", choices=SPLITS, default="dev", help="families to handle (default dev)")
    parser.add_argument("--count", type=positive, metavar="N", help="flights of each family (default 7)")
    parser.add_argument("--seed", type=int, metavar="N", help="seed that all flights follow from (default 1)")
    parser.add_argument("--list", action="store_true", help="list the families and stop")
    parser.add_argument("--render-only", action="store_true", help="render what is missing and stop")
    parser.add_argument(
        "--freeze",
        action="store_true",
        help="write down what the flights of a test split are made of, or, once they are scored, check "
        "that they still are; and stop",
    )
    parser.add_argument(
        "--no-controls",
        action="store_true",
        help="score the detector alone, without what is flown and segmented beside it",
    )
    parser.add_argument(
        "--no-sweep",
        action="store_true",
        help="fly stereo alone with the host's tracker at one threshold and not at each, which takes longest",
    )
    parser.add_argument(
        "--beside",
        nargs="+",
        default=[],
        metavar="NAME",
        help="score only these rivals beside the detector (vista_eval.rivals), and nothing else",
    )
    add_sensor_noise(parser)
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    if arguments.list:
        list_families()
        return EXIT_OK
    place = chosen_place(arguments)
    if arguments.freeze:
        freeze(arguments.split, place)
        return EXIT_OK
    families, rivals = chosen(arguments.split, arguments.family), chosen_rivals(arguments.beside)
    count, seed = size_of_set(arguments)
    folder = place.known_to_all(arguments.folder)
    keys = [(family.name, number, seed) for family in families for number in range(count)]
    run(jobs_of(partial(render, folder), keys, name_of), place, "render", "flight")
    if arguments.render_only:
        return EXIT_OK
    folders = [folder / name_of(key) for key in keys]
    judged = None if arguments.split == "dev" else before_a_scoring(arguments.split, folders)
    from vista_eval.score import score
    from vista_eval.suites.worlds import (  # loads libvista, which `--help` need not
        AT_ONE_THRESHOLD,
        EVERYTHING,
        NOTHING,
        Worlds,
    )

    beside = replace(EVERYTHING, sweep=AT_ONE_THRESHOLD) if arguments.no_sweep else EVERYTHING
    beside = NOTHING if arguments.no_controls else replace(NOTHING, controls=rivals) if rivals else beside
    beside = replace(beside, noise_grey=tuple(arguments.noise))
    suite = Worlds(folders, beside, f"worlds-{arguments.split}")
    if judged is not None:
        suite = replace(suite, before_shown=partial(log_scoring, judged))
    score(suite, arguments.folder, values, place)
    return EXIT_OK


def list_families() -> None:
    from vista_eval.worlds.sampled.catalog import FAMILIES  # loads what draws, which `--help` need not

    for name, family in FAMILIES.items():
        print(f"{name:18s} {family.split:5s} {family.title}")


def chosen(split: str, names: list[str]) -> list[Family]:
    from vista_eval.worlds.sampled.catalog import FAMILIES

    families = {name: family for name, family in FAMILIES.items() if family.split == split}
    unknown = [name for name in names if name not in families]
    if unknown:
        reason = f"no family {unknown[0]} in the split {split}; `vista worlds DIR --list` names them"
        raise InputError("--family", reason)
    return [family for name, family in families.items() if not names or name in names]


def chosen_rivals(names: list[str]) -> tuple[str, ...]:
    if not names:
        return ()
    from vista_eval.rivals import ASKED_FOR

    unknown = [name for name in names if name not in ASKED_FOR]
    if unknown:
        raise InputError("--beside", f"no rival {unknown[0]!r}, only {', '.join(ASKED_FOR)}")
    return tuple(names)


def size_of_set(arguments: argparse.Namespace) -> tuple[int, int]:
    """Flights of each family and the seed of all. A test set has one seed; the first flights of each of its
    families may be scored without the others."""
    from vista_eval.worlds.sampled.catalog import COUNT, SEED

    count, seed = arguments.count or COUNT, SEED if arguments.seed is None else arguments.seed
    as_frozen = count <= COUNT and (seed, arguments.family) == (SEED, [])
    if arguments.split != "dev" and not arguments.render_only and not as_frozen:
        reason = f"is scored as frozen: without --family and --seed, with a --count of at most {COUNT}"
        raise InputError(f"--split {arguments.split}", reason)
    return count, seed


def name_of(key: Key) -> str:
    return f"{key[0]}_{key[1]:03d}"


def render(folder: Path, key: Key) -> None:
    """What the folder lacks of one flight."""
    from vista_eval.render.flight import render_flight
    from vista_eval.worlds.sampled.catalog import FAMILIES

    family, number, seed = key
    try:
        for _ in render_flight(FAMILIES[family].flight(number, seed), folder / name_of(key)):
            pass
    except OSError as error:
        raise InputError(error.filename or name_of(key), error.strerror or str(error)) from None


# ---- the test sets ----


def freeze(split: str, place: Place) -> None:
    from vista_eval.metrics import scoring_log
    from vista_eval.worlds.sampled import frozen

    if split not in frozen.FROZEN:
        raise InputError("--freeze", "of a test split: with --split test or --split test2")
    root = scoring_log.checkout_of(Path(__file__))
    path = root / frozen.FROZEN[split]
    jobs = jobs_of(frozen.content_digest, frozen.flights_of_the_set(split), lambda flight: flight.name)
    found = dict(run(jobs, place, "digest", "flight"))
    if split not in scoring_log.scored_splits(root):
        frozen.write_frozen(root, split, found)
        print(f"{path}: {len(found)} flights")
        return
    differing = frozen.changed(frozen.read_frozen(root, split), found)
    if differing:
        raise InputError(path, f"{len(differing)} flights changed, the first {differing[0]}")
    print(f"{path}: {len(found)} flights, all as they were frozen")


def before_a_scoring(split: str, folders: list[Path]) -> dict[str, Any]:
    """What is scored; raises InputError unless it may be."""
    from vista_eval.metrics import scoring_log
    from vista_eval.worlds.sampled import frozen

    root = scoring_log.checkout_of(Path(__file__))
    scoring_log.read_log(root)
    commit, digests = scoring_log.clean_commit(root), frozen.read_frozen(root, split)
    frozen.check_rendered(digests, folders)
    return {
        "commit": commit,
        "date": scoring_log.now(),
        "split": split,
        "set": frozen.digest_of_set(digests),
    }


def log_scoring(judged: dict[str, Any], worlds: list[WorldScore], values: parameters.Values) -> None:
    from vista_eval.metrics import scoring_log
    from vista_eval.metrics.world_score import family_scores, logged_figures

    figures = {family.name: logged_figures(family) for family in family_scores(worlds)}
    used = digest_of(json.dumps(values, sort_keys=True))
    root = scoring_log.checkout_of(Path(__file__))
    scoring_log.append(root, judged | {"parameters": used, "families": figures})
    print(f"logged: {root / scoring_log.LOG}\n")
