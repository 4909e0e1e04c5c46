"""Put faults into recordings at random times, and see what becomes of the detector's warnings.

Cameras freeze, come late, turn, fog up or lose columns; words stand still or hold a stuck bit; poses jump,
drift or are missing; clocks run wrongly; bits turn over. Each kind comes at several strengths. An injection
is silent where a warning of the recording as it is has gone, the frame is healthy, and the path is called
free as far as what was warned of. The table is printed; DIR receives faults.json, which has every injection,
and faults.html. An interrupted campaign continues.

`--kind grain` is a control: noise of half a grey level and of one, which no camera is without. What is silent
with it is lost by chance, and not by a fault.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_config, load_parameters, positive
from vista.errors import EXIT_OK, InputError

from vista_eval.jobs import add_place, chosen_place


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the results")
    parser.add_argument(
        "recordings", type=Path, nargs="+", metavar="RECORDING", help="a recording with poses"
    )
    parser.add_argument(
        "--count",
        type=positive,
        default=100,
        metavar="N",
        help="injections into each, in parts of 50 (default 100)",
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="seed that all draws follow from (default 1)"
    )
    parser.add_argument(
        "--kind", nargs="+", default=[], metavar="NAME", help="put in only these kinds of faults"
    )
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load_parameters(arguments.config, "golden")
    place = chosen_place(arguments)
    from vista_eval.disturbances import CONTROL, KINDS  # loads libvista, which `--help` need not
    from vista_eval.score import score
    from vista_eval.suites.faults import PART, Faults, Part

    unknown = [kind for kind in arguments.kind if kind not in KINDS]
    if unknown:
        raise InputError("--kind", f"{unknown[0]} is none of: {', '.join(KINDS)}")
    kinds = arguments.kind or [kind for kind in KINDS if kind != CONTROL]
    for path in arguments.recordings:
        if not path.exists():
            raise InputError(path, "no such file or folder")
    recordings = [place.known_to_all(path) for path in arguments.recordings]
    parts = [Part(arguments.seed, number, tuple(kinds)) for number in range(-(-arguments.count // PART))]
    score(Faults(recordings, parts), arguments.folder, values, place, arguments.folder / "kept")
    return EXIT_OK
