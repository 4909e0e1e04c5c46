"""The types of a sequence: its calibration and its frames, which are read when they are asked for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.geometry import Array, CameraModel, Pose, RawCalibration
from vista.sequence.image import read_grey


class StoredImage(Protocol):
    """An image inside a larger file, such as a video."""

    def __str__(self) -> str:
        """The file, and which image of it, for messages."""

    def read_grey(self) -> NDArray[np.uint8]:
        """HxW; raises InputError for an image that cannot be read."""


@dataclass(frozen=True)
class FrameFiles:
    """The places of the images of one frame. Nothing has been read yet."""

    index: int  #: in the sequence, from 0
    t_ns: int
    left: Path | StoredImage
    right: Path | StoredImage
    world_from_camera: Pose | None  #: of the left camera; None: the sequence has no poses
    anew: bool = False  #: the poses began anew since the frame before: what that one told is of no use


@dataclass(frozen=True)
class Frame:
    """One stereo pair, raw or rectified; uint8 grey, both of the calibrated size."""

    index: int
    t_ns: int
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    world_from_camera: Pose | None
    words: tuple[NDArray[np.int16], ...] | None = (
        None  #: of each level, of a pair whose images stayed elsewhere: they are black here
    )


@dataclass(frozen=True)
class Sequence:
    """A recorded sequence: its calibration and where its frames are."""

    name: str
    layout: str  #: its name in the documentation, such as "EuRoC ASL"
    calibration: RawCalibration
    frames: tuple[FrameFiles, ...]  #: times strictly increase; all with a pose or none
    up_world: Array | None = None  #: unit vector against gravity in the world frame, where the layout says it
    notes: tuple[str, ...] = ()  #: what the reader left out, for the user to know
    stills: bool = False  #: the frames show unrelated scenes: each is judged by itself, nothing is tracked
    odometry: bool = False  #: there are no poses, and they are to be estimated from the images

    def read(self, files: FrameFiles) -> Frame:
        """Reads both images. Raises InputError naming the image that is unreadable or of another size."""
        left = _read_sized(files.left, self.calibration.left)
        right = _read_sized(files.right, self.calibration.right)
        return Frame(files.index, files.t_ns, left, right, files.world_from_camera)


def read_image(source: Path | StoredImage) -> NDArray[np.uint8]:
    """HxW grey, of a file or of an image inside one."""
    return read_grey(source) if isinstance(source, Path) else source.read_grey()


def _read_sized(path: Path | StoredImage, camera: CameraModel) -> NDArray[np.uint8]:
    image = read_image(path)
    height, width = image.shape
    if (width, height) != (camera.width, camera.height):
        raise InputError(
            str(path), f"image is {width}x{height}, the calibration says {camera.width}x{camera.height}"
        )
    return image
