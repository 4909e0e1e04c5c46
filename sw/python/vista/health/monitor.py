"""The checks that need matched features, over the frames of a run: libvista makes all others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vista.health import checks
from vista.health.features import image_motion_px, match_pair
from vista.health.finding import Finding, Reason, State
from vista.sequence import Frame, Sequence

if TYPE_CHECKING:
    from vista.alignment import Alignment
    from vista.pipeline import Health

FEATURES = 400
PERIOD = 20  # frames from one matching of features to the next, while nothing is wrong
SUDDEN_LOSS = 0.5  # of the matched share since the last matching: match features at once


class HealthMonitor:
    """Matches features of the frames of one run, in their order."""

    def __init__(self, sequence: Sequence) -> None:
        calibration = sequence.calibration
        self.of_run = _present(checks.check_baseline(calibration), checks.check_calibration(calibration))
        self._stills = sequence.stills
        told = sequence.stills or sequence.odometry or any(f.world_from_camera for f in sequence.frames)
        self._watch_motion = not told
        self.reset()

    def reset(self) -> None:
        """Forgets what was seen: what comes next does not continue it."""
        self._before: Frame | None = None
        self._pair: Finding | None = None
        self._motion: Finding | None = None
        self._frames = 0
        self._checked_fraction = 0.0

    def check(
        self, frame: Frame, matched_fraction: float, alignment: Alignment | None = None, shown: bool = True
    ) -> tuple[Finding, ...]:
        """Checks a rectified frame. matched_fraction: of its pixels; alignment: of the cameras, where that is
        looked at; shown: whether the images show anything."""
        if alignment is not None and alignment.row_error_px is not None:
            # What agrees on a turn of the camera has been matched, at one moment and in the right order.
            pair = self._pair = None
            self._checked_fraction = matched_fraction
        else:
            pair = self._check_pair(frame, matched_fraction) if shown else None
        motion = self._check_motion(frame) if self._watch_motion else None
        self._before = frame
        self._frames += 1
        return _present(pair, motion)

    def _check_pair(self, frame: Frame, matched_fraction: float) -> Finding | None:
        periodic = self._stills or self._frames % PERIOD == 0
        lost = matched_fraction < SUDDEN_LOSS * self._checked_fraction
        if periodic or lost or self._pair is not None:
            self._pair = checks.check_pair(match_pair(frame.left, frame.right, FEATURES))
            self._checked_fraction = matched_fraction
        return self._pair

    def _check_motion(self, frame: Frame) -> Finding | None:
        if self._before is not None and self._frames % PERIOD == 1:
            motion_px = image_motion_px(self._before.left, frame.left)
            self._motion = checks.check_image_motion(motion_px)
        return self._motion


def findings_of_host(host: Health) -> tuple[Finding, ...]:
    """What libvista itself found wrong with a frame."""
    state = State(host.state)
    return tuple(
        Finding(Reason(reason), state, text) for reason, text in zip(host.reasons, host.texts, strict=True)
    )


def _present(*findings: Finding | None) -> tuple[Finding, ...]:
    return tuple(finding for finding in findings if finding is not None)
