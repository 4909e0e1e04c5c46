"""The pictures that a pair is calibrated with: folders of images, or video files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.sequence import video
from vista.sequence.image import EXTENSIONS, read_grey
from vista.sequence.options import Options, refuse_others
from vista.sequence.types import read_image

Grey = NDArray[np.uint8]

SIDE_FOLDERS = (("left", "right"), ("image_0", "image_1"), ("cam0/data", "cam1/data"), ("cam0", "cam1"))
SIDE_IN_NAME = re.compile(r"^(.*?)(left|right)(.*)$", re.IGNORECASE)
VIDEO_STEP_NS = 400_000_000  # between the frames of a video that are looked at: a hand moves a board slowly


@dataclass(frozen=True)
class Picture:
    """One pair, of one moment; both images have the same size."""

    name: str
    left: Grey
    right: Grey

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.left.shape[1], self.left.shape[0]


def read_pictures(sources: list[Path], options: Options) -> Iterator[Picture]:
    """Pairs from folders, or from one or two videos (vista.sequence.video), of which the options say more.

    Raises InputError for what cannot be read, and when the size changes."""
    for source in sources:
        if not source.exists():
            raise InputError(source, "no such file or folder")
    first: Picture | None = None
    for picture in _pictures(sources, options):
        if picture.left.shape != picture.right.shape:
            sizes = [f"{image.shape[1]}x{image.shape[0]}" for image in (picture.left, picture.right)]
            raise InputError(picture.name, f"the left image is {sizes[0]}, the right one {sizes[1]}")
        first = first or picture
        if picture.size != first.size:
            sizes = ["{}x{}".format(*one.size) for one in (picture, first)]
            raise InputError(picture.name, f"images are {sizes[0]}, those of {first.name} {sizes[1]}")
        yield picture


def _pictures(sources: list[Path], options: Options) -> Iterator[Picture]:
    videos = [source for source in sources if source.is_file()]
    refuse_others(options, "pictures" if not videos else video.NAME, video.TAKES if videos else frozenset())
    if not videos:
        for folder in sources:
            yield from _folder_pictures(folder)
        return
    for file in videos:
        if not video.recognises(file):
            raise InputError(file, f"neither a folder nor a video ({', '.join(sorted(video.EXTENSIONS))})")
    if len(videos) < len(sources) or len(videos) > 2:
        raise InputError(videos[0], "name folders, or one video, or two (left and right)")
    yield from _video_pictures(videos, options)


# ---- folders ----


def _folder_pictures(folder: Path) -> Iterator[Picture]:
    for left, right in find_pairs(folder):
        yield Picture(str(left), read_grey(left), read_grey(right))


def find_pairs(folder: Path) -> list[tuple[Path, Path]]:
    """Left and right images: equal names in left/ and right/ or the like, or names with left and right."""
    for root in (folder, folder / "mav0"):
        for left, right in SIDE_FOLDERS:
            if (root / left).is_dir() and (root / right).is_dir():
                sides = [{path.stem: path for path in _images(root / side)} for side in (left, right)]
                return _paired(folder, *sides)
    named: dict[str, dict[str, Path]] = {"left": {}, "right": {}}
    for path in _images(folder):
        match = SIDE_IN_NAME.match(path.stem)
        if match:
            before, side, after = match.groups()
            named[side.lower()][f"{before}*{after}"] = path
    return _paired(folder, named["left"], named["right"])


def _images(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in EXTENSIONS and path.is_file())


def _paired(folder: Path, left: dict[str, Path], right: dict[str, Path]) -> list[tuple[Path, Path]]:
    alone = sorted(left.keys() ^ right.keys())
    if alone:
        path, other = (left[alone[0]], "right") if alone[0] in left else (right[alone[0]], "left")
        raise InputError(path, f"its {other} image is missing")
    if not left:
        raise InputError(
            folder, "holds no pairs: expected NAME_left.EXT and NAME_right.EXT, or folders left and right"
        )
    return [(left[key], right[key]) for key in left]


# ---- videos ----


def _video_pictures(files: list[Path], options: Options) -> Iterator[Picture]:
    """Some frames a second."""
    if len(files) == 2:
        options = replace(options, right=files[1])
    last_ns = None
    for frame in video.open_images(files[0], options).frames:
        if last_ns is None or frame.t_ns - last_ns >= VIDEO_STEP_NS:
            last_ns = frame.t_ns
            yield Picture(str(frame.left), read_image(frame.left), read_image(frame.right))
