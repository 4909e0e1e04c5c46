"""Say whether a system keeps up: frames a second, latency, and what limits them, simulated clock by clock.

A camera, memory, stereo engines and the host are run in time by model/systemc, whose engine is that of the
RTL to the clock. The host's stage times are measured on this machine unless given. Prints a table; with --out
DIR also writes throughput.json, report.html, timeline.png and sweep.png.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from vista.engine import EngineParameters
from vista.errors import EXIT_OK

from vista_throughput.host_times import HostTimes, sequence_host_times, synthetic_host_times
from vista_throughput.options import OPTIONS, add_options, configure, samples
from vista_throughput.presets import PRESETS
from vista_throughput.system import SystemConfig


def add_arguments(parser: argparse.ArgumentParser) -> None:
    meanings = "; ".join(f"{name}: {preset.meaning}" for name, preset in PRESETS.items())
    parser.add_argument(
        "--preset", choices=tuple(PRESETS), help=f"a named system, changed by other options. {meanings}"
    )
    add_options(parser)
    host = parser.add_mutually_exclusive_group()
    host.add_argument(
        "--host-ms", type=samples, metavar="MS[,MS...]", help="host's time a frame, or samples to draw from"
    )
    host.add_argument(
        "--sequence", type=Path, metavar="SEQUENCE", help="measure the host on it (default: synthetic frames)"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder for report, plots and JSON")


def execute(arguments: argparse.Namespace) -> int:
    from vista_throughput.assess import assess, sweeps  # matplotlib and libvista, which `--help` need not
    from vista_throughput.results import check_folder, write_results
    from vista_throughput.simulate import Simulator, find_program
    from vista_throughput.table import table

    config, clock = configure(arguments)
    if arguments.out is not None:
        check_folder(arguments.out)
    simulator = Simulator(find_program(), {option.key: option.name for option in OPTIONS})
    simulator.run(replace(config, frames=1))  # ranges are judged before minutes are spent
    answer = assess(simulator, arguments.preset, config, clock, host_times(arguments, config))
    print(table(answer), flush=True)
    if arguments.out is not None:
        report = write_results(arguments.out, answer, sweeps(simulator, answer), len(simulator.runs))
        print(f"report: {report}")
    return EXIT_OK


def host_times(arguments: argparse.Namespace, config: SystemConfig) -> HostTimes:
    engine = EngineParameters(config.disparities, config.block_px)
    if arguments.host_ms is not None:
        return HostTimes("as given", (), {"host": arguments.host_ms})
    if arguments.sequence is not None:
        return sequence_host_times(arguments.sequence, config.width_px, config.height_px, engine)
    return synthetic_host_times(config.width_px, config.height_px, engine, config.seed)
