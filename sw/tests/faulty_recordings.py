"""Real pairs, as recorded and with faults in their images, and what the checks of a run say of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import real_pairs as real
from numpy.typing import NDArray
from shared_data import REPOSITORY, SHARED_DATA
from vista import parameters
from vista.chain import finish, make_chain, take
from vista.health.finding import FrameHealth, Reason
from vista.history import StageClock
from vista.sequence import Frame, Sequence, open_sequence

OAK_D = REPOSITORY / "build" / "demo" / "oak-d"

# Where each recording is, and how it becomes a sequence in a folder.
RECORDINGS: dict[str, tuple[Path, Callable[[Path], Path]]] = {
    "KITTI odometry 00": (SHARED_DATA / "kitti_odometry", lambda _: STREET),
    "EuRoC V1_01": (SHARED_DATA / "euroc_v101", lambda _: SHARED_DATA / "euroc_v101"),
    "OAK-D": (OAK_D, lambda _: OAK_D),
    "Bumblebee2": (
        SHARED_DATA / "bumblebee2",
        lambda folder: real.make_bumblebee2(
            folder, ["garden01", "garden02", "lantern01", "stones01", "sundial01", "wall01"]
        ),
    ),
    "KITTI 2012": (
        SHARED_DATA / "kitti2012",
        lambda folder: real.make_kitti2012(folder, (1226, 370)),
    ),
    "Middlebury": (SHARED_DATA / "middlebury", lambda folder: real.make_middlebury(folder, "teddy")),
}
STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"

Grey = NDArray[np.uint8]
Pair = tuple[Grey, Grey]
Fault = Callable[[Pair, Pair], Pair]

# What becomes of the images of a frame; the second argument are those of the frame after the next.
FAULTS: dict[str, tuple[Fault, Reason]] = {
    "left and right swapped": (lambda pair, _: (pair[1], pair[0]), Reason.LEFT_RIGHT_SWAPPED),
    "right image 6 rows off": (
        lambda pair, _: (pair[0], np.roll(pair[1], 6, axis=0)),
        Reason.ROWS_MISALIGNED,
    ),
    "right image of another frame": (lambda pair, other: (pair[0], other[1]), Reason.MOMENTS_DIFFER),
    "right image black": (lambda pair, _: (pair[0], np.zeros_like(pair[1])), Reason.NO_CONTRAST),
    "left image black": (lambda pair, _: (np.zeros_like(pair[0]), pair[1]), Reason.NO_CONTRAST),
    "identical images": (lambda pair, _: (pair[0], pair[0]), Reason.IMAGES_IDENTICAL),
}


def open_recording(name: str, folder: Path) -> Sequence:
    return open_sequence(RECORDINGS[name][1](folder))


def read(sequence: Sequence, index: int, fault: Fault | None) -> Frame:
    """The raw pair, with the fault."""
    raw = sequence.read(sequence.frames[index])
    if fault is None:
        return raw
    other = sequence.read(sequence.frames[(index + 2) % len(sequence.frames)])
    left, right = fault((raw.left, raw.right), (other.left, other.right))
    return replace(raw, left=left, right=right)


def judged(
    sequence: Sequence, count: int, fault: Callable[[Pair, Pair], Pair] | None = None
) -> Iterator[FrameHealth]:
    """Health of the first `count` frames, each with the fault."""
    chain = make_chain(sequence, "golden", parameters.defaults(), threads=1)
    for index in range(min(count, len(sequence.frames))):
        raw = read(sequence, index, fault)
        take(chain, raw)
        yield finish(chain, raw, StageClock()).record.health
