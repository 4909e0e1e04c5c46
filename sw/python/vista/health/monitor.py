"""The checks that need matched features, over the frames of a run: libvista makes all others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from vista.health import checks
from vista.health.features import Grey, image_motion_px, match_pair
from vista.health.finding import Finding, Reason, State
from vista.sequence import Sequence

if TYPE_CHECKING:
    from vista.alignment import Alignment
    from vista.pipeline import Health

FEATURES = 400
PERIOD = 20  # frames from one matching of features to the next, while nothing is wrong
SUDDEN_LOSS = 0.5  # of the matched share since the last matching: match features at once


class Pair(Protocol):
    """A rectified pair, whose images are asked for in the frames alone in which features are matched."""

    @property
    def left(self) -> Grey: ...

    @property
    def right(self) -> Grey: ...


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
        self._before: Grey | None = None  # the left image before, where the motion is looked at next
        self._pair: Finding | None = None
        self._motion: Finding | None = None
        self._frames = 0
        self._checked_fraction = 0.0

    def check(
        self, pair: Pair, matched_fraction: float, alignment: Alignment | None = None, shown: bool = True
    ) -> tuple[Finding, ...]:
        """Checks a rectified pair. matched_fraction: of its pixels; alignment: of the cameras, where that is
        looked at; shown: whether the images show anything."""
        if alignment is not None and alignment.row_error_px is not None:
            # What agrees on a turn of the camera has been matched, at one moment and in the right order.
            found = self._pair = None
            self._checked_fraction = matched_fraction
        else:
            found = self._check_pair(pair, matched_fraction) if shown else None
        motion = self._check_motion(pair) if self._watch_motion else None
        self._frames += 1
        return _present(found, motion)

    def _check_pair(self, pair: Pair, matched_fraction: float) -> Finding | None:
        periodic = self._stills or self._frames % PERIOD == 0
        lost = matched_fraction < SUDDEN_LOSS * self._checked_fraction
        if periodic or lost or self._pair is not None:
            self._pair = checks.check_pair(match_pair(pair.left, pair.right, FEATURES))
            self._checked_fraction = matched_fraction
        return self._pair

    def _check_motion(self, pair: Pair) -> Finding | None:
        if self._before is not None:
            self._motion = checks.check_image_motion(image_motion_px(self._before, pair.left))
        self._before = pair.left if self._frames % PERIOD == 0 else None
        return self._motion


def findings_of_host(host: Health) -> tuple[Finding, ...]:
    """What libvista itself found wrong with a frame."""
    state = State(host.state)
    return tuple(
        Finding(Reason(reason), state, text) for reason, text in zip(host.reasons, host.texts, strict=True)
    )


def _present(*findings: Finding | None) -> tuple[Finding, ...]:
    return tuple(finding for finding in findings if finding is not None)
