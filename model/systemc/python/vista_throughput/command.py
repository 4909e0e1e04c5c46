"""Say whether a camera, an FPGA and a host keep up with each other, by a simulation in time.

A model in SystemC runs the camera, the memory, the stereo engines and the host in simulated time; its engine
equals the RTL clock by clock. The times of the host's stages are measured on this machine unless they are
given. The command prints the frame rate, the latency and what limits them. With --out DIR it also writes
throughput.json, report.html, timeline.png and sweep.png.
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
        "--preset",
        choices=tuple(PRESETS),
        help=f"start from a named system, which other options change. {meanings}",
    )
    add_options(parser)
    host = parser.add_mutually_exclusive_group()
    host.add_argument(
        "--host-ms",
        type=samples,
        metavar="MS[,MS...]",
        help="time of the host for a frame, or samples to draw it from",
    )
    host.add_argument(
        "--sequence",
        type=Path,
        metavar="SEQUENCE",
        help="measure the host on this sequence (default: on synthetic frames)",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="also write the report, plots and JSON into this folder"
    )


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
