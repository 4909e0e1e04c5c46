"""Make the files that vista-fly takes along on an aircraft without Python.

SEQUENCE is a recording, as `vista run` takes it: its rig (the rectified cameras, and how their images are
rectified) goes with the parameters to DIR/rig.vista, the same with its frames to DIR/frames.vista. Cameras
need a rig alone: for them give --calibration and --size-px in place of SEQUENCE.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from tqdm import tqdm

from vista.command.arguments import add_config
from vista.command.run import frame_range, select_frames
from vista.command.source_arguments import add_size_px, add_source, source_options
from vista.errors import EXIT_OK, InputError
from vista.interruption import Interruption
from vista.output import make_folder, write_atomically
from vista.parameters import load
from vista.recording import Recorder, head_bytes
from vista.rectify import Rectifier
from vista.report.labels import counted
from vista.sequence import FrameFiles, Sequence, open_sequence
from vista.sequence.pairs import read_calibration_file

RIG, FRAMES = "rig.vista", "frames.vista"  # names of the files


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_source(parser, needed=False)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder to write to")
    add_size_px(parser, "for cameras")
    parser.add_argument("--frames", type=frame_range, metavar="A:B", help="write frames A to B - 1 alone")
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    recorded, frames = opened(arguments)
    values = load(arguments.config)
    rectifier = Rectifier(recorded.calibration, int(values["stereo"]["rectify_rows"]))
    rig = head_bytes(recorded, rectifier, values)
    make_folder(arguments.out)
    interruption = Interruption()
    if frames:
        recorder = Recorder(arguments.out / FRAMES, recorded, rectifier, values)
        with interruption.watch(), recorder:
            for files in uninterrupted(frames, recorded.name, interruption):
                recorder.write(recorded.read(files), anew=files.anew)
    write_atomically(arguments.out / RIG, rig)
    print(f"{arguments.out}: {RIG}" + (f", {counted(len(frames), 'frame')} in {FRAMES}" if frames else ""))
    return EXIT_OK


def uninterrupted(frames: list[FrameFiles], name: str, interruption: Interruption) -> Iterator[FrameFiles]:
    for files in tqdm(frames, desc=name, unit="frame", disable=None):
        if interruption.requested:
            raise KeyboardInterrupt  # what has been written is taken away, and the status is that of a Ctrl-C
        yield files


def opened(arguments: argparse.Namespace) -> tuple[Sequence, list[FrameFiles]]:
    """Raises InputError for a source that does not open, and for options that would be ignored."""
    if arguments.sequence is not None:
        if arguments.size_px is not None:
            raise InputError("--size-px", "goes with cameras, not with a recording")
        recorded = open_sequence(arguments.sequence, source_options(arguments))
        if recorded.stills:
            raise InputError(arguments.sequence, "stills, which show unrelated scenes: use vista run")
        if recorded.odometry:
            raise InputError("--poses", "are not estimated from images by vista-fly")
        return recorded, list(select_frames(recorded, arguments.frames))
    if arguments.calibration is None or arguments.size_px is None:
        raise InputError("vista prepare", "takes SEQUENCE, or --calibration and --size-px")
    described = read_calibration_file(arguments.calibration, arguments.size_px)
    return Sequence("cameras", "camera", described.calibration, ()), []
