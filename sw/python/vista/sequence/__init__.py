"""Recorded stereo sequences; the layout is recognised by what the file is, or what the folder holds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Protocol

from vista.errors import InputError
from vista.sequence import asl, bag, kitti, kitti_stereo, middlebury, pairs, tum, video
from vista.sequence.image import read_grey
from vista.sequence.options import Options, refuse_others
from vista.sequence.text import printable, shell_quoted
from vista.sequence.trajectory import with_poses
from vista.sequence.types import Frame, FrameFiles, Sequence

__all__ = ["Frame", "FrameFiles", "Options", "Sequence", "open_sequence", "read_grey"]

ODOMETRY_NOTE = "poses are estimated from the images (--poses odometry): they drift, and may be wrong"


class Layout(Protocol):
    """A module of this package."""

    @property
    def NAME(self) -> str: ...  # noqa: N802

    @property
    def TAKES(self) -> frozenset[str]: ...  # noqa: N802  # the options it knows

    def recognises(self, path: Path, /) -> bool: ...

    def open_source(self, path: Path, options: Options, /) -> Sequence:
        """Opens the source, without poses of its own if the options bring some."""


LAYOUTS: tuple[Layout, ...] = (video, bag, asl, kitti_stereo, kitti, middlebury, pairs)


def open_sequence(path: str | Path, options: Options = Options()) -> Sequence:  # noqa: B008
    """Opens a folder or a file in one of LAYOUTS. Calibration, times, poses and the presence of every image
    are checked here; the images are read one by one later.

    Raises InputError naming the file, and the line where there is one.
    """
    source = Path(path)
    layout = _layout_of(source)
    refuse_others(options, layout.NAME, layout.TAKES)
    sequence = layout.open_source(source, options)
    if sequence.stills and not options.of_source:
        raise InputError("--poses", f"does not go with {source}, which shows unrelated scenes")
    if options.odometry:
        sequence = replace(sequence, odometry=True, notes=(*sequence.notes, ODOMETRY_NOTE))
    if options.poses is not None:
        frames, notes = with_poses(sequence.frames, tum.read_trajectory(options.poses), options.poses)
        sequence = replace(sequence, frames=frames, notes=sequence.notes + notes)
    return replace(sequence, name=printable(sequence.name))


def _layout_of(source: Path) -> Layout:
    if not source.exists():
        raise InputError(source, "no such file or folder")
    for layout in LAYOUTS:
        if layout.recognises(source):
            return layout
    if not source.is_dir():
        raise InputError(source, "neither a folder nor a video nor a bag")
    if not any(source.iterdir()):
        raise InputError(source, "empty folder")
    if videos := sorted(path.name for path in source.iterdir() if video.recognises(path)):
        named = shell_quoted(source / videos[0])
        raise InputError(source, f"holds {len(videos)} videos and no pictures; name one, such as {named}")
    if (source / "sequences").is_dir():
        raise InputError(source, "holds several KITTI sequences; name one, such as sequences/00")
    if (source / "training").is_dir():
        raise InputError(source, "holds the parts of KITTI stereo; name one, such as training")
    raise InputError(
        source,
        "no sequence recognised: expected mav0/ (EuRoC ASL), image_0/ or image_2/ and calib.txt (KITTI "
        "odometry), NAME_left.EXT, NAME_right.EXT and calibration.toml, one scene of KITTI stereo or "
        "Middlebury, a bag; name a video itself",
    )
