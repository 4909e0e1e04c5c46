"""Record a pair of cameras as a folder of pairs, which the other commands read.

FOLDER receives NNNNNN_left.png, NNNNNN_right.png, and times.csv with the times of arrival by the clock of the
day; poses of another recorder can be added as poses.csv. When the disk is too slow, pairs are left out, and
counted. Ctrl-C ends the recording.

DEVICE is a number or a path of V4L2 (0, /dev/video0), an address (rtsp://...) or a pipeline of GStreamer, as
far as the installed OpenCV knows them; or oak[:SERIAL] or realsense[:SERIAL], whose own calibration is put
beside the pairs unless --calibration names another.
"""

from __future__ import annotations

import argparse
import sys
import time
from contextlib import closing
from pathlib import Path

from tqdm import tqdm

from vista.calibration.formats.toml import written
from vista.calibration.rig import rig_of
from vista.command.arguments import not_negative
from vista.command.source_arguments import (
    add_camera,
    add_pair_tolerance,
    add_size_px,
    frames_per_second,
    open_cameras,
)
from vista.errors import EXIT_INTERRUPTED, EXIT_OK
from vista.interruption import Interruption
from vista.live.camera import Cameras
from vista.live.latest import Latest
from vista.live.recorder import PairFolder
from vista.live.source import Shot, newest_shots
from vista.live.stereo_camera import StereoCamera
from vista.report.labels import counted
from vista.sequence.pairs import read_calibration_file


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_camera(parser, "left and right camera, or one that delivers both views side by side", required=True)
    add_size_px(parser)
    add_pair_tolerance(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="new folder to write into")
    parser.add_argument(
        "--calibration",
        type=Path,
        metavar="FILE.toml",
        help="calibration of the cameras, to be put beside the pairs; not needed to calibrate with them",
    )
    parser.add_argument(
        "--duration", type=not_negative, metavar="S", help="end after so many seconds (default: with Ctrl-C)"
    )
    parser.add_argument(
        "--rate",
        type=frames_per_second,
        metavar="HZ",
        help="keep at most so many pairs a second (default: all)",
    )


def execute(arguments: argparse.Namespace) -> int:
    with closing(open_cameras(arguments)) as cameras:
        if arguments.calibration is not None:
            read_calibration_file(arguments.calibration, cameras.size_px)
        folder = PairFolder(arguments.out, calibration_text(arguments.calibration, cameras))
        interruption, queue = Interruption(), Latest[Shot]()
        try:
            with interruption.watch():
                record(cameras, queue, folder, arguments, interruption)
        finally:
            folder.close()
            left_out = f"{queue.dropped} left out, since they came faster than they could be written"
            alone = f"{cameras.skipped} pictures without a partner"
            print(f"{arguments.out}: {counted(folder.pairs, 'pair')}; {left_out}; {alone}", file=sys.stderr)
    if interruption.requested:
        print("vista: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    return EXIT_OK


def calibration_text(path: Path | None, cameras: Cameras | StereoCamera) -> str | None:
    """The calibration.toml to put beside the pairs, if there is one."""
    if path is not None:
        return path.read_text(encoding="utf-8")
    return written(rig_of(cameras.calibration)) if isinstance(cameras, StereoCamera) else None


def record(
    cameras: Cameras | StereoCamera,
    queue: Latest[Shot],
    folder: PairFolder,
    arguments: argparse.Namespace,
    interruption: Interruption,
) -> None:
    end_s = time.monotonic() + (float("inf") if arguments.duration is None else arguments.duration)
    between_ns = 0 if arguments.rate is None else int(1e9 / arguments.rate)
    due_ns: int | None = None
    with tqdm(unit=" pairs", leave=False, disable=not sys.stderr.isatty()) as progress:
        for shot in newest_shots(cameras, queue, lambda: interruption.requested or time.monotonic() >= end_s):
            if due_ns is not None and shot.exposed_ns < due_ns:
                continue
            # Half a period of leave: the next frame of a camera never comes exactly when it is due.
            late_ns = 0 if due_ns is None else shot.exposed_ns - due_ns
            due_ns = shot.exposed_ns + between_ns - min(late_ns, between_ns // 2)
            folder.write(shot)
            progress.update()
