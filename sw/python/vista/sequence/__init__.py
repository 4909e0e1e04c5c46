"""Recorded stereo sequences; the layout is recognised by what the folder holds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from vista.errors import InputError
from vista.sequence import asl, kitti, pairs
from vista.sequence.image import read_grey
from vista.sequence.text import printable
from vista.sequence.types import Frame, FrameFiles, Sequence

__all__ = ["Frame", "FrameFiles", "Sequence", "open_sequence", "read_grey"]

LAYOUTS = (asl, kitti, pairs)


def open_sequence(path: str | Path, pair_tolerance_ms: float | None = None) -> Sequence:
    """Opens an EuRoC ASL, KITTI odometry or pairs folder. Calibration, times, poses and the presence of every
    image are checked here; the images are read one by one later.

    pair_tolerance_ms: of the EuRoC layout, where each image has a time of its own (asl.open_folder).
    Raises InputError naming the file, and the line where there is one.
    """
    folder = Path(path)
    if not folder.exists():
        raise InputError(folder, "no such folder")
    if not folder.is_dir():
        raise InputError(folder, "not a folder; a sequence is a folder")
    for layout in LAYOUTS:
        if layout.recognises(folder):
            timed = layout is asl
            sequence = asl.open_folder(folder, pair_tolerance_ms) if timed else layout.open_folder(folder)
            return replace(sequence, name=printable(sequence.name))
    if not any(folder.iterdir()):
        raise InputError(folder, "empty folder")
    if (folder / "sequences").is_dir():
        raise InputError(folder, "holds several KITTI sequences; name one, such as sequences/00")
    raise InputError(
        folder,
        "no sequence recognised: expected mav0/ (EuRoC ASL), image_0/ and calib.txt (KITTI odometry), "
        "or NAME_left.EXT, NAME_right.EXT and calibration.toml",
    )
