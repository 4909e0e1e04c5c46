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


def health_sentence(health: dict[str, Any], unit: str = "frame") -> str:
    """One line on the health of a run: the frames of each state, and the causes of the worst."""
    said = states_sentence(health, unit)
    problems = worst_problems(health)
    if not problems:
        return said
    causes = [problem["text"] for problem in problems if problem["state"] == health["state"]]
    lesser = [str(problem["reason"]) for problem in problems if problem["state"] != health["state"]]
    parts = [*causes, *([f"also {', '.join(lesser)}"] if lesser else [])]
    if health["frames"][State.BLIND]:
        parts.append("nothing found there does not mean free space")
    return f"{said}: {'; '.join(parts)}"


def states_sentence(health: dict[str, Any], unit: str = "frame") -> str:
    """Says in how many frames the view was healthy, degraded or blind."""
    total = sum(health["frames"].values())
    state_counts = [(state, health["frames"][state]) for state in reversed(State)]
    named = [(state, count) for state, count in state_counts if count and state != State.HEALTHY]
    said = " and ".join(f"{state} in {_share(count, total, unit)}" for state, count in named)
    return f"the view was {said or f'healthy in {_share(total, total, unit)}'}"


def worst_problems(health: dict[str, Any]) -> list[dict[str, Any]]:
    """The problems of a run, those that blind first, then by the number of their frames."""
    return sorted(health["problems"], key=lambda p: (p["state"] != State.BLIND, -p["frames"]))


def _share(count: int, total: int, unit: str) -> str:
    if count < total:
        return f"{count} of {total} {unit}s"
    return f"all {total} {unit}s" if total > 1 else f"the only {unit}"
