"""The frame loop of a run: every frame through the chain and the checks, and out."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tqdm import tqdm

from vista.chain import Chain, run_frame
from vista.history import FrameRecord, StageClock
from vista.interruption import Interruption
from vista.obstacle_line import obstacle_line
from vista.recording import Recorder
from vista.report.overlay import Overlay
from vista.result_folder import ResultFolder, encoded
from vista.sequence import FrameFiles

if TYPE_CHECKING:
    from vista.bag.writer import BagWriter


@dataclass(frozen=True)
class Outputs:
    """Receivers of the results of each frame."""

    folder: ResultFolder
    overlay: Overlay | None  # None: no pictures
    recorder: Recorder | None
    all_tracks: bool = False  # write tracks that are not confirmed, too
    bag: BagWriter | None = None


class Announcer:
    """Prints each kind of problem on stderr when a check finds it for the first time."""

    def __init__(self) -> None:
        self._announced: set[str] = set()

    def announce(self, record: FrameRecord) -> None:
        for finding in record.health.findings:
            if finding.reason not in self._announced:
                self._announced.add(finding.reason)
                tqdm.write(f"vista: frame {record.index}: {finding.state}: {finding.text}", file=sys.stderr)


def run_frames(
    chain: Chain,
    frames: Sequence[FrameFiles],
    outputs: Outputs,
    records: list[FrameRecord],
    interruption: Interruption,
) -> None:
    """Runs the chain over the frames and appends a record of each to `records`: an error in the middle
    leaves those of the frames before. Stops after the frame in which an interruption is requested.

    A problem that a check finds for the first time is printed on stderr at once.
    Raises InputError for an image that cannot be read; what is in the folder stays valid.
    """
    announcer = Announcer()
    for files in tqdm(frames, desc=chain.sequence.name, unit="frame", disable=None):
        record = _run_frame(chain, files, outputs)
        records.append(record)
        announcer.announce(record)
        if interruption.requested:
            return


def _run_frame(chain: Chain, files: FrameFiles, outputs: Outputs) -> FrameRecord:
    clock, step = StageClock(), run_frame(chain, files)
    record = step.record
    with clock.stage("output"):  # no part of the total
        if outputs.recorder is not None:
            outputs.recorder.write(step.frame, step.pair.levels, step.anew)
        jpeg = None
        if outputs.overlay is not None:
            jpeg = encoded(outputs.overlay.draw(step.frame, step.result, record.health))
        if outputs.bag is not None:
            outputs.bag.write(step, record, jpeg)
        outputs.folder.write_frame(files.index, obstacle_line(record, outputs.all_tracks), jpeg)
    record.stage_ms.update({"checks": step.checks_ms} | clock.stage_ms)
    return record
