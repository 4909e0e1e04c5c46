"""The frame loop: read, rectify, match, then the host's pipeline, and out."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from vista.history import FrameRecord, StageClock
from vista.obstacle_line import obstacle_line
from vista.overlay import Overlay
from vista.recording import Recorder
from vista.rectify import Rectifier
from vista.result_folder import ResultFolder
from vista.sequence import Frame, FrameFiles
from vista.sequence import Sequence as StereoSequence

if TYPE_CHECKING:
    from vista.engine import Engine
    from vista.geometry import Array, Pose
    from vista.pipeline import Result


class HostPipeline(Protocol):
    """What the loop knows of the host: vista.pipeline.Pipeline, or a stand-in of a test."""

    def reset(self) -> None: ...

    def process(
        self,
        left: NDArray[np.uint8],
        disparity: NDArray[np.int16],
        t_ns: int,
        pose: Pose | None,
        up_world: Array | None,
    ) -> Result: ...


@dataclass(frozen=True)
class Chain:
    """The stages of a run, in the order in which the data passes them."""

    sequence: StereoSequence
    rectifier: Rectifier
    engine: Engine
    pipeline: HostPipeline


class Interruption:
    """Set by the first Ctrl-C or SIGTERM; a second one ends the program at once."""

    def __init__(self) -> None:
        self.requested = False

    @contextmanager
    def watch(self) -> Iterator[None]:
        before = {number: signal.signal(number, self._request) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _request(self, number: int, _frame: Any) -> None:
        self.requested = True
        signal.signal(number, signal.SIG_DFL)


def run_frames(
    chain: Chain,
    frames: Sequence[FrameFiles],
    folder: ResultFolder,
    records: list[FrameRecord],
    overlay: Overlay | None,
    recorder: Recorder | None,
    interruption: Interruption,
) -> None:
    """Runs the chain over the frames and appends a record of each to `records`: an error in the middle
    leaves those of the frames before. Stops after the frame in which an interruption is requested.

    Raises InputError for an image that cannot be read; what is in the folder stays valid.
    """
    for files in tqdm(frames, desc=chain.sequence.name, unit="frame", disable=None):
        record = _run_frame(chain, files, folder, overlay, recorder)
        records.append(record)
        if interruption.requested:
            return


def _run_frame(
    chain: Chain, files: FrameFiles, folder: ResultFolder, overlay: Overlay | None, recorder: Recorder | None
) -> FrameRecord:
    clock = StageClock()
    step = run_frame(chain, files)
    with clock.stage("output"):  # not part of the total: pictures are for people
        if recorder is not None:
            recorder.write(step.frame, step.words)
        picture = None if overlay is None else overlay.draw(step.frame, step.words, step.result)
        folder.write_frame(files.index, obstacle_line(step.record), picture)
    step.record.stage_ms["output"] = clock.stage_ms["output"]
    return step.record


@dataclass(frozen=True)
class Step:
    """One frame on its way through the chain."""

    frame: Frame  # rectified
    words: NDArray[np.int16]
    result: Result
    record: FrameRecord


def run_frame(chain: Chain, files: FrameFiles) -> Step:
    """Raises InputError for an image that cannot be read."""
    clock = StageClock()
    with clock.stage("read"):
        raw = chain.sequence.read(files)
    with clock.stage("rectify"):
        frame = chain.rectifier.rectify(raw)
    with clock.stage("stereo"):
        words = chain.engine.compute(frame.left, frame.right)
    if chain.sequence.stills:
        chain.pipeline.reset()
    result = chain.pipeline.process(
        frame.left, words, frame.t_ns, frame.world_from_camera, chain.sequence.up_world
    )

    stage_ms = clock.stage_ms | result.stage_ms
    stage_ms["total"] = sum(stage_ms[name] for name in ("read", "rectify", "stereo", "host"))
    record = FrameRecord(
        frame.index,
        frame.t_ns,
        frame.world_from_camera,
        tuple(result.obstacles),
        result.nearest_collision,
        result.regions,
        result.valid_fraction,
        stage_ms,
        result.dropped_tracks,
    )
    return Step(frame, words, result, record)
