"""What a check finds, and the health of a frame that follows from all findings."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """HEALTHY: no check found anything. DEGRADED: something is doubtful, and the reasons say what.
    BLIND: the view tells nothing that can be relied on, so that a missing obstacle does not mean free space.
    """

    HEALTHY = "healthy"
    DEGRADED = "degraded"
    BLIND = "blind"


class Reason(StrEnum):
    """What can be wrong; obstacles.schema.json says what each means."""

    BASELINE_IMPLAUSIBLE = "baseline_implausible"
    CALIBRATION_MISFIT = "calibration_misfit"
    IMAGES_IDENTICAL = "images_identical"
    MOMENTS_DIFFER = "moments_differ"
    ROWS_MISALIGNED = "rows_misaligned"
    LEFT_RIGHT_SWAPPED = "left_right_swapped"
    MOTION_UNKNOWN = "motion_unknown"
    NO_CONTRAST = "no_contrast"
    FEW_DISPARITIES = "few_disparities"
    NO_DISPARITIES = "no_disparities"
    POSE_JUMP = "pose_jump"
    NOISE = "noise"
    GROUND_UNSEEN = "ground_unseen"
    ALIGNMENT_LOST = "alignment_lost"
    IMAGES_FROZEN = "images_frozen"
    VIEW_STUCK = "view_stuck"
    WORDS_DIFFER = "words_differ"
    MOTION_DOUBTFUL = "motion_doubtful"
    DISPARITIES_OFF = "disparities_off"
    TIME_JUMP = "time_jump"
    CROWDED = "crowded"
    IMAGE_MISSING = "image_missing"


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a frame."""

    reason: Reason
    state: State  # DEGRADED or BLIND
    text: str  # a sentence with the measured figures, for people


@dataclass(frozen=True)
class FrameHealth:
    """Everything that the checks say of one frame."""

    findings: tuple[Finding, ...] = ()

    @property
    def state(self) -> State:
        """The worst state of all findings."""
        return max((finding.state for finding in self.findings), key=list(State).index, default=State.HEALTHY)

    @property
    def reasons(self) -> list[Reason]:
        return [finding.reason for finding in self.findings]
