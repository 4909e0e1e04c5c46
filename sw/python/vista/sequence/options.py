"""What the user may say about a source besides its path; each source takes some of it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

from vista.errors import InputError

FRAME_OF_LEFT_CAMERA = "camera"  # as pose_frame: the poses are those of the left camera itself
NO_POSES = "none"  # as pose_topic
BY_ODOMETRY = "odometry"  # in place of a file of poses


@dataclass(frozen=True)
class Options:
    """None: not said. Each name is that of an option of the command line, with an underscore for a hyphen."""

    calibration: Path | None = None  #: calibration.toml, where it does not lie beside the images
    odometry: bool = False  #: estimate the poses from the images
    poses: Path | None = None  #: trajectory of the left camera, in the format of the TUM RGB-D benchmark
    pair_tolerance_ms: float | None = None  #: how far the times of left and right image may lie apart
    first_frame: int = 0  #: the first that is wanted: KITTI stereo has a calibration for each pair
    right: Path | None = None  #: video of the right camera
    split: str | None = None  #: how one video holds both images, SPLITS
    rate: float | None = None  #: frames per second of a video, in place of the times in the file
    start: str | None = None  #: time of the first frame of a video, in seconds
    left_topic: str | None = None
    right_topic: str | None = None
    pose_topic: str | None = None
    pose_frame: str | None = None  #: the frame of reference whose poses a topic holds that does not say it

    @property
    def of_source(self) -> bool:
        """The poses are those that the source has."""
        return self.poses is None and not self.odometry


SIDE_BY_SIDE, TOP_BOTTOM = SPLITS = ("side-by-side", "top-bottom")
OF_EVERY_SOURCE = {"poses", "odometry", "first_frame"}


def refuse_others(options: Options, layout: str, taken: frozenset[str]) -> None:
    """InputError for an option that the layout would ignore."""
    for field in fields(Options):
        said = getattr(options, field.name) != field.default
        if said and field.name not in taken | OF_EVERY_SOURCE:
            name = "--" + field.name.replace("_", "-")
            raise InputError(name, f"does not go with this source, whose layout is {layout}")
