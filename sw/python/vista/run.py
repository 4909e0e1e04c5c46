"""The frame loop of a run: every frame through the chain, and out."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm

from vista.chain import Chain, run_frame
from vista.history import FrameRecord, StageClock
from vista.obstacle_line import obstacle_line
from vista.recording import Recorder
from vista.report.overlay import Overlay
from vista.result_folder import ResultFolder
from vista.sequence import FrameFiles


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
