"""The pictures that a pair is calibrated with: folders of images, or video files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.sequence.image import EXTENSIONS, read_grey

Grey = NDArray[np.uint8]

VIDEO_EXTENSIONS = (".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpg", ".webm")
SIDE_FOLDERS = (("left", "right"), ("image_0", "image_1"), ("cam0/data", "cam1/data"), ("cam0", "cam1"))
SIDE_IN_NAME = re.compile(r"^(.*?)(left|right)(.*)$", re.IGNORECASE)
VIDEO_STEP_S = 0.4  # between the frames of a video that are looked at: a hand moves a board slowly
DEFAULT_RATE_HZ = 30.0  # of a video whose container does not say


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


def read_pictures(sources: list[Path]) -> Iterator[Picture]:
    """Pairs from folders, from one video that shows both cameras side by side, or from two videos.

    Raises InputError for what cannot be read, and when the size changes."""
    for source in sources:
        if not source.exists():
            raise InputError(source, "no such file or folder")
    first: Picture | None = None
    for picture in _pictures(sources):
        if picture.left.shape != picture.right.shape:
            sizes = [f"{image.shape[1]}x{image.shape[0]}" for image in (picture.left, picture.right)]
            raise InputError(picture.name, f"the left image is {sizes[0]}, the right one {sizes[1]}")
        first = first or picture
        if picture.size != first.size:
            sizes = ["{}x{}".format(*one.size) for one in (picture, first)]
            raise InputError(picture.name, f"images are {sizes[0]}, those of {first.name} {sizes[1]}")
        yield picture


def _pictures(sources: list[Path]) -> Iterator[Picture]:
    videos = [source for source in sources if source.is_file()]
    if not videos:
        for folder in sources:
            yield from _folder_pictures(folder)
        return
    if len(videos) < len(sources) or len(videos) > 2:
        raise InputError(videos[0], "name folders, or one video (side by side), or two (left and right)")
    for video in videos:
        if video.suffix.lower() not in VIDEO_EXTENSIONS:
            raise InputError(video, f"neither a folder nor a video ({', '.join(VIDEO_EXTENSIONS)})")
    yield from video_pictures(videos)


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


def video_pictures(files: list[Path]) -> Iterator[Picture]:
    """Some frames a second of one video with both cameras side by side, or of a left and a right one."""
    captures = [_open_video(file) for file in files]
    rate_hz = captures[0].get(cv2.CAP_PROP_FPS)
    step = max(1, round(VIDEO_STEP_S * (rate_hz if 1.0 <= rate_hz <= 1000.0 else DEFAULT_RATE_HZ)))
    index = 0
    while all(capture.grab() for capture in captures):
        if index % step == 0:
            images = [_grey(capture) for capture in captures]
            if any(image is None for image in images):
                break
            yield _picture(f"{files[0]} frame {index}", [image for image in images if image is not None])
        index += 1
    if index == 0:
        raise InputError(files[0], "no frame of this video can be read")


def _open_video(file: Path) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(str(file))
    if not capture.isOpened():
        raise InputError(file, "cannot be read as a video")
    return capture


def _grey(capture: cv2.VideoCapture) -> Grey | None:
    read, image = capture.retrieve()
    if not read:
        return None
    return np.asarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def _picture(name: str, images: list[Grey]) -> Picture:
    if len(images) == 2:
        return Picture(name, images[0], images[1])
    half = images[0].shape[1] // 2
    if 2 * half != images[0].shape[1]:
        raise InputError(name, f"a width of {images[0].shape[1]} px cannot hold two cameras side by side")
    left, right = (np.ascontiguousarray(images[0][:, side : side + half]) for side in (0, half))
    return Picture(name, left, right)
