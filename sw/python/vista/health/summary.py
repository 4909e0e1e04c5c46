"""The health of a whole run: how many frames are in which state, and what was found where."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vista.health.finding import State

if TYPE_CHECKING:
    from vista.history import FrameRecord


def summarize_health(records: list[FrameRecord]) -> dict[str, Any]:
    """`health` of summary.json. state: the worst of any frame; problems: one entry a reason, in the order in
    which they appeared, with the text of the first frame and the worst state."""
    problems: dict[str, dict[str, Any]] = {}
    frames = dict.fromkeys(map(str, State), 0)
    for record in records:
        frames[record.health.state] += 1
        for finding in record.health.findings:
            problem = problems.setdefault(
                finding.reason,
                {"reason": finding.reason, "state": finding.state, "text": finding.text, "frames": 0}
                | {"first_frame": record.index},
            )
            problem["frames"] += 1
            problem["last_frame"] = record.index
            problem["state"] = max(problem["state"], finding.state, key=list(State).index)
    return {
        "state": next((state for state in reversed(State) if frames[state]), State.HEALTHY),
        "frames": frames,
        "frames_with_known_motion": sum(record.motion_known for record in records),
        "problems": list(problems.values()),
    }


def problem_lines(health: dict[str, Any], frames: int) -> list[str]:
    """A line for each problem of a run of so many frames."""
    return [
        f"{problem['state']} in {problem['frames']} of {frames} frames, "
        f"from frame {problem['first_frame']}: {problem['text']}"
        for problem in health["problems"]
    ]
