"""Run the whole chain on a recorded stereo sequence.

SEQUENCE is a folder or a file:
  EuRoC ASL       mav0/cam0, cam1 and optionally state_groundtruth_estimate0
  KITTI odometry  sequences/NN with image_0, image_1, calib.txt, times.txt, optionally ../../poses/NN.txt
  pairs           NAME_left.EXT, NAME_right.EXT and calibration.toml, optionally times.csv and poses.csv
  KITTI stereo    training or testing of 2012 or 2015; each pair is judged by itself
  Middlebury      a scene: im0, im1 and calib.txt, or im2, im6 (view1, view5) and calibration.toml
  video           side by side, one above the other, or NAME_left.EXT and NAME_right.EXT; calibration.toml
  ROS bag         a bag of ROS 1, the folder of a bag of ROS 2, or an MCAP file

DIR receives obstacles.jsonl (one line per frame), frames/ (pictures), summary.json and report.html.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vista import parameters
from vista.chain import Chain, fitted_to, make_chain
from vista.command.arguments import add_board_timeout, add_config, add_engine, load_parameters, positive
from vista.command.source_arguments import add_source, source_options
from vista.engine import REMOTE_ENGINES
from vista.engine.rtl import DEFAULT_WIDTH_PX
from vista.errors import EXIT_INTERRUPTED, EXIT_OK, InputError
from vista.health.alignment_summary import summarize_alignment
from vista.health.summary import health_sentence, summarize_health
from vista.history import FrameRecord, stage_statistics
from vista.interruption import Interruption
from vista.recording import Content, Recorder
from vista.report.labels import counted
from vista.report.overlay import Overlay
from vista.report.run_report import render_report
from vista.result_folder import ResultFolder
from vista.run import Outputs, run_frames
from vista.sequence import FrameFiles, Sequence, open_sequence
from vista.sequence.text import shell_quoted
from vista.version import commit, installing, version

if TYPE_CHECKING:
    from vista.bag.writer import BagWriter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_source(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    add_engine(
        parser,
        "golden: the engine's C model; rtl: the engine in SystemVerilog, simulated, with its front end "
        "where that is needed, and the same words, at seconds a frame; opencv: StereoBM, for comparison; "
        "board: the same hardware on a board, at --address",
        REMOTE_ENGINES,
    )
    parser.add_argument("--address", metavar="HOST[:PORT]", help="where the board is, for --engine board")
    add_board_timeout(parser)
    parser.add_argument(
        "--rtl-width",
        type=positive,
        metavar="PX",
        help=f"widest image of the RTL build to run (default {DEFAULT_WIDTH_PX})",
    )
    add_config(parser)
    parser.add_argument(
        "--frames",
        type=frame_range,
        metavar="A:B",
        help="run frames A to B - 1 alone; either number may be left out",
    )
    parser.add_argument(
        "--threads", type=positive, default=1, metavar="N", help="threads of the engine (default 1)"
    )
    parser.add_argument(
        "--record",
        type=Path,
        metavar="FILE",
        help="record the rectified pairs and their disparities, for vista-fly",
    )
    parser.add_argument(
        "--bag",
        type=Path,
        metavar="DIR",
        help="write a bag of ROS 2 (MCAP) with images, disparities, obstacles, poses and diagnostics",
    )
    parser.add_argument("--no-overlay", action="store_true", help="draw no pictures, which saves time")
    parser.add_argument(
        "--all-tracks",
        action="store_true",
        help="write tracks that are not confirmed to obstacles.jsonl, too",
    )


def frame_range(text: str) -> tuple[int, int | None]:
    first, colon, last = text.partition(":")
    if not colon or not all(part == "" or part.isdecimal() for part in (first, last)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a range A:B of frame numbers, such as 10:20")
    return int(first or 0), int(last) if last else None


def execute(arguments: argparse.Namespace) -> int:
    if (arguments.engine in REMOTE_ENGINES) != (arguments.address is not None):
        raise InputError("--address", "goes with --engine board, and that with it")
    values = load_parameters(arguments.config, arguments.engine)
    folder = ResultFolder(arguments.out)
    sequence = open_sequence(arguments.sequence, source_options(arguments))
    values = fitted_to(sequence, values)
    frames = select_frames(sequence, arguments.frames)
    chain = make_chain(
        sequence,
        arguments.engine,
        values,
        arguments.threads,
        arguments.rtl_width,
        arguments.address,
        arguments.board_timeout,
    )
    candidates = chain.engine.parameters.num_disparities
    camera = chain.rectifier.calibration
    overlay = None if arguments.no_overlay else Overlay(sequence.name, candidates, camera, sequence.stills)

    records: list[FrameRecord] = []
    interruption = Interruption()
    outcome: dict[str, Any] = {}
    try:
        with (
            interruption.watch(),
            open_recorder(arguments.record, chain, values) as recorder,
            open_bag(arguments.bag, chain) as bag,
        ):
            outputs = Outputs(folder, overlay, recorder, arguments.all_tracks, bag)
            run_frames(chain, frames, outputs, records, interruption)
    except InputError as error:
        outcome["error"] = str(error)
        raise
    finally:
        folder.close()
        if records:
            outcome["interrupted"] = interruption.requested
            summary = make_summary(chain, arguments.engine, values, records) | outcome
            folder.write_summary(summary)
    if interruption.requested:
        print(f"vista: interrupted after {counted(len(records), 'frame')}", file=sys.stderr)
        return EXIT_INTERRUPTED
    report = folder.write_report(render_report(summary, records, folder))
    print(closing_lines(summary, report))
    return EXIT_OK


def open_recorder(
    path: Path | None, chain: Chain, values: parameters.Values
) -> AbstractContextManager[Recorder | None]:
    if path is None:
        return nullcontext()
    return Recorder(path, chain.sequence, chain.rectifier, values, Content.PAIR)


def open_bag(path: Path | None, chain: Chain) -> AbstractContextManager[BagWriter | None]:
    if path is None:
        return nullcontext()
    try:
        from vista.bag.writer import BagWriter  # its library is an extra
    except ModuleNotFoundError:
        raise InputError("--bag needs the extra [bags]", installing("bags")) from None
    candidates = chain.engine.parameters.num_disparities
    return BagWriter(path, chain.rectifier.calibration, candidates, chain.sequence.up_world)


def select_frames(sequence: Sequence, wanted: tuple[int, int | None] | None) -> tuple[FrameFiles, ...]:
    first, end = wanted or (0, None)
    frames = tuple(f for f in sequence.frames if f.index >= first and (end is None or f.index < end))
    if not frames:
        last = sequence.frames[-1].index
        raise InputError(
            "--frames", f"selects none; the sequence has frames {sequence.frames[0].index} to {last}"
        )
    return frames


def make_summary(
    chain: Chain, engine_name: str, values: parameters.Values, records: list[FrameRecord]
) -> dict[str, Any]:
    things = {obstacle.id for record in records for obstacle in record.things}
    return {
        "version": version(),
        "commit": commit(),
        "command": shlex.join(["vista", *sys.argv[1:]]),
        "sequence": chain.sequence.name,
        "layout": chain.sequence.layout,
        "notes": list(chain.sequence.notes),
        "stills": chain.sequence.stills,
        "frames": len(records),
        "health": summarize_health(records),
        "alignment": summarize_alignment(records),
        "engine": engine_name,
        "camera": asdict(chain.rectifier.calibration),
        "rectified": not chain.rectifier.is_passthrough,
        "obstacles_confirmed": len(things),
        "tracks_dropped": sum(record.outcome.dropped_tracks for record in records),
        "frames_with_collision": sum(record.warning is not None for record in records),
        "frames_with_ground_ahead": sum(
            o.kind == "ground" and o.confirmed and o.in_collision_volume
            for record in records
            if not record.blind
            for o in record.obstacles
        ),
        "path_seen_m": path_seen(records),
        "parameters": values,
        "stages_ms": stage_statistics(records),
    }


def path_seen(records: list[FrameRecord]) -> dict[str, float]:
    """How far the flight path was seen: in the median frame, and in the worst."""
    seen_m = [record.path_seen_m for record in records]
    return {"median": round(float(np.median(seen_m)), 1), "least": round(min(seen_m), 1)}


def closing_lines(summary: dict[str, Any], report: Path) -> str:
    """What is printed at the end of a run: notes, what was found, its health, and where the report is."""
    host, frames = summary["stages_ms"]["host"], summary["frames"]
    found = f"{counted(summary['obstacles_confirmed'], 'obstacle')} tracked"
    warned = f"{counted(summary['frames_with_collision'], 'frame')} with a collision warning"
    figures = f"{counted(frames, 'frame')}, {found}, {warned}"
    if summary["stills"]:
        hits = summary["frames_with_collision"]
        stills = counted(frames, "still")
        figures = f"{stills}, each judged alone: {hits} with something in the collision volume"
    lines = [f"note: {note}" for note in summary["notes"]]
    lines.append(f"{figures}, host {host['median']:.1f} ms (p99 {host['p99']:.1f})")
    lines.append(health_sentence(summary["health"], "still" if summary["stills"] else "frame"))
    return "\n".join(
        [f"{summary['sequence']}: {line}" for line in lines] + [f"report: {shell_quoted(report)}"]
    )
