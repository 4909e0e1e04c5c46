"""Fly the detector and the planner in the loop, through worlds that others defined.

What the cameras show decides what is flown, and that decides what they show next. Each flight is a multirotor
with motors that saturate, or a fixed wing of JSBSim, in wind and before rendered cameras; collisions are
exact. DIR receives a folder for each flight with its record, fly.json and fly.html, which begins with the
worst flights. `--vehicle betaflight` is the multirotor with the flight controller Betaflight, which
`make betaflight` builds.

`--list` names the families of worlds and what flies them. A multirotor needs rotorpy, which is installed
without its own dependencies (pip install --no-deps rotorpy==3.0.0), and scipy; a fixed wing needs jsbsim.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_config, load_parameters, not_negative, positive
from vista.errors import EXIT_OK, InputError

from vista_eval.jobs import add_place, chosen_place

VEHICLES = "multirotor", "fixed-wing", "betaflight"
DEFAULT_RIVALS = ("none", "brake", "planner")
LEAST_WIDTH_PX = 160
VIEW_DEG = (20.0, 110.0)
RATES_HZ = (5.0, 10.0, 20.0, 25.0)  # whose period is a whole number of steps of the vehicle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the flights")
    parser.add_argument("--list", action="store_true", help="list families and rivals and stop")
    parser.add_argument(
        "--vehicle",
        choices=VEHICLES,
        default=VEHICLES[0],
        help=f"what is flown (default {VEHICLES[0]})",
    )
    parser.add_argument(
        "--family",
        nargs="+",
        default=[],
        metavar="NAME",
        help="fly only these families of worlds (default: those for the vehicle)",
    )
    parser.add_argument(
        "--count", type=positive, default=3, metavar="N", help="worlds of each family (default 3)"
    )
    parser.add_argument(
        "--first", type=int, default=0, metavar="N", help="number of the first one (default 0)"
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="seed that all worlds follow from (default 1)"
    )
    parser.add_argument(
        "--rival",
        nargs="+",
        default=[],
        metavar="NAME",
        help=f"what flies them (default {' '.join(DEFAULT_RIVALS)}, of those that the vehicle can)",
    )
    parser.add_argument(
        "--speed",
        nargs="+",
        type=not_negative,
        default=[],
        metavar="M_S",
        help="fly at each of these speeds, not at that of the family",
    )
    parser.add_argument(
        "--latency",
        type=not_negative,
        default=0.05,
        metavar="S",
        help="from the exposure to the command, in seconds; `vista throughput` measures it (default 0.05)",
    )
    parser.add_argument("--rate", type=float, default=10.0, metavar="HZ", help="frames a second (default 10)")
    parser.add_argument(
        "--width",
        type=positive,
        metavar="PX",
        help="width of the images (default 320, before a fixed wing 640)",
    )
    parser.add_argument(
        "--view",
        type=float,
        metavar="DEG",
        help="field of view from side to side (default 87, before a fixed wing 70)",
    )
    parser.add_argument(
        "--noise",
        type=not_negative,
        default=1.5,
        metavar="GREY_LEVELS",
        help="sensor noise of both cameras (default 1.5)",
    )
    parser.add_argument(
        "--drop-outs",
        type=not_negative,
        default=0.0,
        metavar="P",
        help="probability of each frame that two frames are lost",
    )
    parser.add_argument("--pose-noise", action="store_true", help="poses like those of a navigation filter")
    parser.add_argument(
        "--name",
        default="fly",
        metavar="NAME",
        help="name of the page, its JSON and its tables (default fly)",
    )
    parser.add_argument("--films", action="store_true", help="write a film of each flight")
    parser.add_argument("--mcap", action="store_true", help="write an MCAP file of each flight, for Foxglove")
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    if arguments.list:
        list_all()
        return EXIT_OK
    values = load_parameters(arguments.config, "golden")
    complete(arguments)
    check(arguments)
    place = chosen_place(arguments)
    folder = place.known_to_all(arguments.folder)
    from vista_eval.closed_loop.loop import Conditions
    from vista_eval.closed_loop.suite import ClosedLoop, Key  # loads libvista, which `--help` need not
    from vista_eval.closed_loop.vehicles import VEHICLES
    from vista_eval.score import score

    VEHICLES[arguments.vehicle].needs()
    conditions = Conditions(
        arguments.rate,
        arguments.latency,
        arguments.width,
        arguments.view,
        arguments.noise,
        arguments.drop_outs,
        arguments.pose_noise,
        vehicle=arguments.vehicle,
    )
    numbers = range(arguments.first, arguments.first + arguments.count)
    keys = [
        Key(family, number, arguments.seed, speed, rival)
        for family in families(arguments)
        for number in numbers
        for speed in arguments.speed or [None]
        for rival in arguments.rival
    ]
    score(
        ClosedLoop(folder, keys, conditions, arguments.films, arguments.mcap, arguments.name),
        folder,
        values,
        place,
    )
    return EXIT_OK


def complete(arguments: argparse.Namespace) -> None:
    """Fills in what the vehicle decides."""
    from vista_eval.closed_loop.rivals import RIVALS
    from vista_eval.closed_loop.vehicles import VEHICLES

    kind = VEHICLES[arguments.vehicle]
    arguments.rival = arguments.rival or [n for n in DEFAULT_RIVALS if kind.hovers or not RIVALS[n].hovers]
    arguments.width = arguments.width or kind.width_px
    arguments.view = arguments.view or kind.view_deg


def families(arguments: argparse.Namespace) -> list[str]:
    from vista_eval.closed_loop.places.catalog import FAMILIES
    from vista_eval.closed_loop.vehicles import VEHICLES

    unknown = [name for name in arguments.family if name not in FAMILIES]
    if unknown:
        raise InputError("--family", f"no family {unknown[0]}; `vista fly DIR --list` names them")
    wide = not VEHICLES[arguments.vehicle].hovers
    return arguments.family or [name for name, family in FAMILIES.items() if family.wide == wide]


def check(arguments: argparse.Namespace) -> None:
    """Raises InputError."""
    from vista_eval.closed_loop.rivals import RIVALS

    unknown = [name for name in arguments.rival if name not in RIVALS]
    if unknown:
        raise InputError("--rival", f"no rival {unknown[0]}; `vista fly DIR --list` names them")
    if arguments.vehicle == "fixed-wing" and any(RIVALS[name].hovers for name in arguments.rival):
        raise InputError("--rival", "a fixed wing cannot stop; leave out `brake`")
    families(arguments)
    if arguments.rate not in RATES_HZ:
        raise InputError("--rate", f"must be one of {', '.join(f'{rate:g}' for rate in RATES_HZ)}")
    if arguments.width < LEAST_WIDTH_PX or arguments.width % 32:
        raise InputError("--width", f"must be a multiple of 32 from {LEAST_WIDTH_PX} on")
    if not VIEW_DEG[0] <= arguments.view <= VIEW_DEG[1]:
        raise InputError("--view", f"must be from {VIEW_DEG[0]:g} to {VIEW_DEG[1]:g} degrees")
    if arguments.drop_outs >= 1.0:
        raise InputError("--drop-outs", "must be less than 1")
    if any(speed < 1.0 for speed in arguments.speed):
        raise InputError("--speed", "must be at least 1 m/s")
    if arguments.first < 0:
        raise InputError("--first", "must not be negative")


def list_all() -> None:
    from vista_eval.closed_loop.places.catalog import FAMILIES
    from vista_eval.closed_loop.rivals import RIVALS

    for name, family in FAMILIES.items():
        fixed = f" (the first {family.fixed} are published cases)" if family.fixed else ""
        print(f"{name:14s} {family.title}{fixed}")
    print()
    for name, rival in RIVALS.items():
        print(f"{name:14s} {rival.title}")
