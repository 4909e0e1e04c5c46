"""The checks over the frames of a run: cheap ones for every frame, feature matching for some."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vista.engine import EngineParameters
from vista.health import checks
from vista.health.features import image_motion_px, match_pair
from vista.health.finding import Finding, FrameHealth
from vista.sequence import Frame, Sequence

FEATURES = 400
PERIOD = 20  # frames from one matching of features to the next, while nothing is wrong
SUDDEN_LOSS = 0.5  # of the share of valid pixels since the last matching: match features at once


class HealthMonitor:
    """Judges the frames of one run in their order."""

    def __init__(self, sequence: Sequence, engine: EngineParameters) -> None:
        calibration = sequence.calibration
        self._of_run = _present(checks.check_baseline(calibration), checks.check_calibration(calibration))
        self._engine = engine
        self._stills = sequence.stills
        self._has_poses = any(files.world_from_camera is not None for files in sequence.frames)
        self._before: Frame | None = None
        self._velocity_m_s: NDArray[np.float64] | None = None
        self._pair: Finding | None = None
        self._motion: Finding | None = None
        self._frames = 0
        self._checked_share = 0.0

    def check(self, raw: Frame, frame: Frame, words: NDArray[np.int16]) -> FrameHealth:
        """raw: as read; frame: rectified; words: the disparity image of the latter."""
        shown = checks.check_contrast(raw.left, raw.right) or checks.check_identical(raw.left, raw.right)
        of_view = _present(shown) if shown else self._check_view(frame, words)
        of_motion = () if self._stills else self._check_motion(frame)
        self._before = frame
        self._frames += 1
        return FrameHealth(self._of_run + of_view + of_motion)

    def _check_view(self, frame: Frame, words: NDArray[np.int16]) -> tuple[Finding, ...]:
        share = matched_share(words, self._engine)
        periodic = self._stills or self._frames % PERIOD == 0
        if periodic or self._pair is not None or share < SUDDEN_LOSS * self._checked_share:
            self._pair = checks.check_pair(match_pair(frame.left, frame.right, FEATURES))
            self._checked_share = share
        return _present(self._pair, checks.check_valid(share))

    def _check_motion(self, frame: Frame) -> tuple[Finding, ...]:
        before, pose = self._before, frame.world_from_camera
        if pose is None:
            self._velocity_m_s = None
            if before is not None and not self._has_poses and self._frames % PERIOD == 1:
                self._motion = checks.check_image_motion(image_motion_px(before.left, frame.left))
            return _present(self._motion, checks.check_pose_given(pose, self._has_poses))
        if before is None or before.world_from_camera is None:
            return ()
        dt_s = 1e-9 * (frame.t_ns - before.t_ns)
        step_m = pose.translation_m - before.world_from_camera.translation_m
        jump = checks.check_pose_step(step_m, self._velocity_m_s, dt_s)
        self._velocity_m_s = None if jump else step_m / dt_s
        return _present(jump)


def matched_share(words: NDArray[np.int16], engine: EngineParameters) -> float:
    """Of the pixels that the engine can match, those that have a disparity."""
    margin = engine.block_size // 2
    height, width = words.shape
    area = (height - 2 * margin) * (width - 2 * margin - engine.num_disparities + 1)
    return float(np.count_nonzero(words >= 0)) / area if area > 0 else 0.0


def _present(*findings: Finding | None) -> tuple[Finding, ...]:
    return tuple(finding for finding in findings if finding is not None)
