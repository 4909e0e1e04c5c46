"""Detect obstacles while the frames come, show them on a page, and tell an autopilot.

SEQUENCE is a recording, as `vista run` takes it; it is played as fast as it was taken. --camera takes two
cameras in its place, or one that delivers both views side by side. Of the frames that have come the newest is
processed: when the machine falls behind, older ones are dropped, and nothing queues up. The page is at
http://127.0.0.1:8642/ and can be seen on this machine alone. Ctrl-C ends the run.

DEVICE is a number or a path of V4L2 (0, /dev/video0), an address (rtsp://...) or a pipeline of GStreamer, as
far as the installed OpenCV knows them; or oak[:SERIAL] or realsense[:SERIAL], which need no --calibration; or
board:HOST[:PORT], the two sensors of a board, which matches their pairs itself: words come, and no images.

TARGET is one of:
  udp:HOST:PORT         where the autopilot, its simulator or a MAVLink router listens
  serial:DEVICE[:BAUD]  a serial line to it, such as serial:/dev/ttyUSB0:921600
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from vista import parameters
from vista.chain import Chain, make_chain
from vista.command.arguments import add_board_timeout, add_config, add_engine, load_parameters, positive
from vista.command.mavlink import sent_messages
from vista.command.run import frame_range, select_frames
from vista.command.source_arguments import (
    add_camera,
    add_size_px,
    add_source,
    open_cameras,
    source_options,
)
from vista.errors import EXIT_INTERRUPTED, EXIT_OK, InputError
from vista.interruption import Interruption
from vista.live.board import BoardSource, is_board
from vista.live.camera import PAIR_TOLERANCE_MS
from vista.live.listeners import Autopilot, Lines
from vista.live.loop import Listener, LiveLoop, Totals
from vista.live.page import LivePage
from vista.live.source import Replay, Source
from vista.live.stereo_camera import StereoCamera, is_stereo_camera
from vista.mavlink.link import Link
from vista.mavlink.transport import open_transport
from vista.report.labels import counted
from vista.sequence import Sequence, open_sequence
from vista.sequence.options import refuse_others
from vista.sequence.pairs import read_calibration_file, read_size_px, read_table
from vista.sequence.text import finite

PAGE_PORT = 8642

Opened = tuple[Sequence, Callable[[Chain], Source]]  # what is known of a source, and what makes it


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_source(parser, needed=False)
    what = "in place of SEQUENCE: left and right camera, or one that delivers both views side by side"
    takes = f"takes --calibration, and --pair-tolerance-ms (default {PAIR_TOLERANCE_MS:g})"
    add_camera(parser, f"{what}; {takes}", required=False)
    add_size_px(parser)
    parser.add_argument("--to", metavar="TARGET", help="the autopilot: udp:HOST:PORT or serial:DEVICE[:BAUD]")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="write a line for each frame, as those of obstacles.jsonl; - is stdout",
    )
    parser.add_argument(
        "--page",
        type=port,
        default=PAGE_PORT,
        metavar="PORT",
        help=f"port of the page (default {PAGE_PORT}; 0: a free one)",
    )
    parser.add_argument("--no-page", action="store_true", help="serve no page")
    parser.add_argument("--repeat", action="store_true", help="begin again after the last frame")
    parser.add_argument(
        "--speed",
        type=speed,
        default=1.0,
        metavar="X",
        help="play it X times as fast (default 1)",
    )
    parser.add_argument("--frames", type=frame_range, metavar="A:B", help="play frames A to B - 1 alone")
    add_engine(parser, "golden: the engine's C model; opencv: StereoBM, for comparison")
    add_board_timeout(parser)
    parser.add_argument(
        "--threads", type=positive, default=1, metavar="N", help="threads of the engine (default 1)"
    )
    add_config(parser)


def port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port, 0 to 65535")
    return int(text)


def speed(text: str) -> float:
    number = finite("--speed", text)
    if not 0.01 <= number <= 100.0:
        raise argparse.ArgumentTypeError(f"{text} is not from 0.01 to 100")
    return number


def execute(arguments: argparse.Namespace) -> int:
    check_source(arguments)
    values = load_parameters(arguments.config, arguments.engine)
    with ExitStack() as open_ones:
        recorded, source_of = open_source(arguments, open_ones)
        for note in recorded.notes:
            print(f"{recorded.name}: note: {note}", file=sys.stderr)
        chain = make_chain(recorded, arguments.engine, values, arguments.threads, every_pair=False)
        loop = LiveLoop(chain, source_of(chain))
        listeners, autopilot = make_listeners(arguments, values, loop, open_ones)
        interruption = Interruption()
        try:
            with interruption.watch():
                loop.run(listeners, lambda: interruption.requested)
        finally:
            print(closing_lines(recorded.name, loop.totals, autopilot, arguments.to), file=sys.stderr)
    if interruption.requested:
        print("vista: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    return EXIT_OK


def check_source(arguments: argparse.Namespace) -> None:
    """Raises InputError for options that would be ignored."""
    if (arguments.sequence is None) == (arguments.camera is None):
        raise InputError("vista live", "takes SEQUENCE or --camera")
    if arguments.camera is None:
        if arguments.size_px is not None:
            raise InputError("--size-px", "goes with --camera, not with a recording")
        return
    refuse_others(source_options(arguments), "camera", frozenset({"calibration", "pair_tolerance_ms"}))
    of_recording = {"repeat": False, "speed": 1.0, "frames": None, "poses": None}
    for name, unsaid in of_recording.items():
        if getattr(arguments, name) != unsaid:
            raise InputError(f"--{name}", "goes with a recording, not with --camera")
    if arguments.calibration is None and not is_stereo_camera(arguments.camera[0]):
        raise InputError("--camera", "needs --calibration FILE.toml")
    if is_board(arguments.camera[0]):
        check_board(arguments)


def check_board(arguments: argparse.Namespace) -> None:
    """Raises InputError for what a board does by itself."""
    board, *others = arguments.camera
    if others:
        raise InputError(others[0], f"{board} has both sensors by itself")
    own = {"pair-tolerance-ms": None, "engine": "golden", "threads": 1}
    for name, unsaid in own.items():
        if getattr(arguments, name.replace("-", "_")) != unsaid:
            raise InputError(f"--{name}", f"{board} pairs and matches by itself")


def open_source(arguments: argparse.Namespace, open_ones: ExitStack) -> Opened:
    if arguments.camera is None:
        return open_replay(arguments)
    if is_board(arguments.camera[0]):
        return open_board(arguments, open_ones)
    return open_camera(arguments, open_ones)


def open_replay(arguments: argparse.Namespace) -> Opened:
    recorded = open_sequence(arguments.sequence, source_options(arguments))
    if recorded.stills:
        raise InputError(arguments.sequence, "stills, which show unrelated scenes: use vista run")
    frames = select_frames(recorded, arguments.frames)
    return recorded, lambda _: Replay(recorded, frames, arguments.speed, arguments.repeat)


def open_board(arguments: argparse.Namespace, open_ones: ExitStack) -> Opened:
    name, path = arguments.camera[0], arguments.calibration
    size_px = arguments.size_px or read_size_px(path, read_table(path))
    if size_px is None:
        raise InputError("--size-px", f"is needed: neither {path} nor {name} says how large the images are")

    def source_of(chain: Chain) -> Source:
        source = BoardSource(name, chain, arguments.board_timeout)
        open_ones.callback(source.close)
        return source

    return Sequence(name, "camera", read_calibration_file(path, size_px).calibration, ()), source_of


def open_camera(arguments: argparse.Namespace, open_ones: ExitStack) -> Opened:
    path = arguments.calibration
    asked = None if path is None else read_size_px(path, read_table(path))
    cameras = open_cameras(arguments, asked)
    open_ones.callback(cameras.close)
    if path is None and isinstance(cameras, StereoCamera):
        calibration = cameras.calibration
    else:
        calibration = read_calibration_file(path, cameras.size_px).calibration
    return Sequence(" and ".join(arguments.camera), "camera", calibration, ()), lambda _: cameras


def make_listeners(
    arguments: argparse.Namespace, values: parameters.Values, loop: LiveLoop, open_ones: ExitStack
) -> tuple[list[Listener], Autopilot | None]:
    """What was asked for, the most urgent first; `open_ones` closes them."""
    listeners: list[Listener] = []
    autopilot = None
    if arguments.to is not None:
        autopilot = Autopilot(Link(values), open_transport(arguments.to))
        open_ones.callback(autopilot.close)
        listeners.append(autopilot)
    page = None
    if not arguments.no_page:
        page = LivePage(arguments.page, loop.chain, loop.totals, lambda: link_facts(autopilot, arguments.to))
        open_ones.callback(page.close)
    if arguments.out is not None:  # last: it empties a file that is there
        lines = Lines(arguments.out)
        open_ones.callback(lines.close)
        listeners.append(lines)
    if page is not None:
        listeners.append(page)
        print(f"vista: {page.address}", file=sys.stderr)
    return listeners, autopilot


def link_facts(autopilot: Autopilot | None, target: str | None) -> dict[str, Any]:
    if autopilot is None:
        return {"autopilot": None}
    latency = autopilot.latency
    facts = {
        "target": target,
        "sent": autopilot.messages.total(),
        "lost": autopilot.transport.lost,
        "median_ms": latency.percentile_ms(50.0),
        "p99_ms": latency.percentile_ms(99.0),
    }
    return {"autopilot": facts}


def closing_lines(name: str, totals: Totals, autopilot: Autopilot | None, target: str | None) -> str:
    left_out = [f"{totals.dropped} dropped for newer ones", f"{totals.duplicates} duplicates"]
    if totals.restarts:
        left_out.append(counted(totals.restarts, "restart"))
    lines = [
        f"{name}: {counted(totals.processed, 'frame')} processed, {', '.join(left_out)}",
        f"{name}: from the exposure to the result {totals.latency.summary()}",
    ]
    if autopilot is not None:
        sent = sent_messages(autopilot.messages, autopilot.transport)
        lines.append(f"{target}: from the exposure to the message {autopilot.latency.summary()}; {sent}")
    return "\n".join(lines)
