"""The fault campaign: disturbances at random times of a recording, and what the detector makes of each.

The recording is flown once as it is. At the onset of a disturbance the detector is as it was there: its
memory is copied and put back. Then it sees LENGTH disturbed frames, and each is compared with the same frame
of the flight as recorded.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from vista import native, parameters
from vista.chain import engine_parameters, fitted_to
from vista.detector import Detector, Novelty
from vista.engine import Engine, create_engine
from vista.health.finding import State
from vista.rectify import Rectifier
from vista.sequence import Sequence as Recording
from vista.sequence import open_sequence

from vista_eval.cache import code_digest, digest_of
from vista_eval.disturbances import KINDS, Now, Shot, Words
from vista_eval.fly import LIBRARIES
from vista_eval.jobs import Job
from vista_eval.metrics.intervals import clopper_pearson
from vista_eval.report.page import Page, Section
from vista_eval.report.table import Table
from vista_eval.score import Scoring

PART = 50  # injections into one recording, which are one job
LENGTH = 8  # frames from the onset on
ALARM = 3  # frames within which an alarm has to come
FARTHER = 1.15  # a warning at more than so many times the distance is another one
UNSEEN = "refused"
STOPPED = "stopped"
STOPPED_S = 20.0  # without an end, and a program counts as stopped
FORK = get_context("fork")  # with the detector as it is; what it runs is C without threads

OUTCOMES = ("masked", "safe", "detected", "within 3", "silent")


@dataclass(frozen=True)
class Injection:
    kind: str
    strength: float
    onset: int
    seed: int


@dataclass(frozen=True)
class Seen:
    """What is told of one frame; state "refused": nothing, and its tracks are forgotten; "stopped": nothing,
    since the program has crashed or hangs, which its supervisor sees."""

    state: str
    warned_m: float | None
    path_seen_m: float
    reasons: tuple[str, ...] = ()


def judged(clean: Seen, seen: Seen) -> str:
    """What the disturbance did to a frame. A warning that is gone or stands farther away is found out where
    the frame is not healthy, and hurts nobody where the path is not called free as far as that."""
    if clean.warned_m is None:
        if seen.state != State.HEALTHY and clean.state == State.HEALTHY:
            return "detected"
        return "masked" if seen.warned_m is None else "safe"
    warned = seen.warned_m
    if warned is not None and warned <= FARTHER * clean.warned_m:
        return "masked" if warned * FARTHER >= clean.warned_m else "safe"
    if seen.state != State.HEALTHY:
        return "detected"
    return "safe" if seen.path_seen_m < clean.warned_m else "silent"


def outcome_of(frames: Sequence[str]) -> str:
    """The outcome of an injection from those of its frames, the worst first."""
    silent = [k for k, frame in enumerate(frames) if frame == "silent"]
    if silent:
        found = [k for k, frame in enumerate(frames) if frame == "detected"]
        return "within 3" if max(silent) < ALARM and found and min(found) <= ALARM else "silent"
    return next((outcome for outcome in ("detected", "safe") if outcome in frames), "masked")


def apart(work: Callable[[], list[Seen]]) -> list[Seen] | None:
    """What the work comes to, in a process of its own; none: it crashed, or did not end."""
    ours, theirs = FORK.Pipe(duplex=False)

    def child() -> None:
        with suppress(Exception):  # of numbers that no caller expects
            theirs.send(work())

    process = FORK.Process(target=child)
    process.start()
    theirs.close()
    try:
        return ours.recv() if ours.poll(STOPPED_S) else None
    except EOFError:
        return None
    finally:
        process.kill()
        process.join()
        ours.close()


class Flown:
    """A recording in memory, with its words, and a detector that can be put back."""

    def __init__(self, recording: Recording, values: parameters.Values) -> None:
        values = fitted_to(recording, values)
        self.rectifier = Rectifier(recording.calibration, int(values["stereo"]["rectify_rows"]))
        self.up_world = recording.up_world
        self.detector = Detector(self.rectifier, values, (), recording.stills)
        self.engine: Engine = create_engine("golden", engine_parameters(values), 1, None, None, None, 1)
        frames = [recording.read(files) for files in recording.frames]
        self.shots = [Shot(f.left, f.right, f.t_ns, f.world_from_camera) for f in frames]
        self.words: list[Words] = []
        for shot in self.shots:
            self.detector.take(shot.left, shot.right, shot.t_ns)
            pair = self.detector.pair()
            self.words.append(list(self.engine.levels(pair.left, pair.right)))
        self.detector.reset()

    def frame(self, shot: Shot, words: Words | None) -> Seen:
        detector = self.detector
        try:
            if detector.take(shot.left, shot.right, shot.t_ns) == Novelty.REPEATED:
                return Seen(UNSEEN, None, 0.0)
            detector.match(words)
            pose = None if shot.pose is None else detector.rectified_pose(shot.pose)
            found = detector.judge(pose, self.up_world)
        except ValueError:
            detector.forget()
            return Seen(UNSEEN, None, 0.0)
        findings = detector.findings()
        state = max((f.state for f in findings), key=list(State).index, default=State.HEALTHY)
        warning = found.nearest_collision
        return Seen(
            str(state),
            None if warning is None else warning.distance_m,
            found.path_seen_m,
            tuple(str(f.reason) for f in findings),
        )

    def disturbed(self, injection: Injection) -> list[Seen]:
        if KINDS[injection.kind].of_state is None:
            return list(self._disturbed(injection))
        stopped = Seen(STOPPED, None, 0.0, (STOPPED,))
        seen = apart(lambda: list(self._disturbed(injection)))
        return [stopped] * LENGTH if seen is None else seen

    def _disturbed(self, injection: Injection) -> Iterator[Seen]:
        kind = KINDS[injection.kind]
        for index in range(injection.onset, min(injection.onset + LENGTH, len(self.shots))):
            now = Now(self.shots, index, injection.onset, injection.strength, injection.seed)
            if now.since == 0 and kind.of_state is not None:
                self.detector.resume(kind.of_state(now, self.detector.state()))
            shot = kind.of_shot(now) if kind.of_shot is not None else self.shots[index]
            words = kind.of_words(now, self.words) if kind.of_words is not None else None
            yield self.frame(shot, words)


def injections(
    rng: np.random.Generator, clean: Sequence[Seen], kinds: Sequence[str], count: int = PART
) -> list[Injection]:
    """Random kinds, strengths and onsets; where the recording warns, mostly shortly before or during that."""
    frames = len(clean)
    near = [
        k for k in range(2, frames) if any(seen.warned_m is not None for seen in clean[k : k + LENGTH])
    ] or list(range(2, frames))
    made = []
    for _ in range(count):
        kind = kinds[int(rng.integers(len(kinds)))]
        strengths = KINDS[kind].strengths
        strength = strengths[int(rng.integers(len(strengths)))]
        onset = near[int(rng.integers(len(near)))] if rng.random() < 0.9 else int(rng.integers(2, frames))
        made.append(Injection(kind, strength, onset, int(rng.integers(1 << 31))))
    return sorted(made, key=lambda i: i.onset)


@dataclass(frozen=True)
class Part:
    """What is drawn for one job."""

    seed: int
    number: int
    kinds: tuple[str, ...]


def job(values: parameters.Values, part: Part, folder: Path) -> Job:
    """PART injections into one recording, whose outcomes are kept."""
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".csv", ".txt", ".toml", ".yaml"))
    digest = digest_of(
        json.dumps([values, asdict(part), str(folder)], sort_keys=True),
        code_digest(__name__),
        *map(native.library_path, LIBRARIES),
        *files,
    )
    return Job(f"{folder.name}, part {part.number}", partial(campaign, values, part, folder), digest)


@dataclass(frozen=True)
class Faults:
    """Injections into recordings, in parts."""

    recordings: Sequence[Path]
    parts: Sequence[Part]
    name: str = "faults"

    @property
    def page_name(self) -> str:
        return f"{self.name}.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        return [job(values, part, recording) for part in self.parts for recording in self.recordings]

    def scoring(self, results: list[list[dict[str, Any]]], values: parameters.Values) -> Scoring:
        found = [result for of_part in results for result in of_part]
        shown, *others = (table(found, by) for by in ("kind", "strength", "recording"))
        facts = f"{len(found)} disturbances of {len(self.recordings)} recordings at random times."
        sections = [Section(one.title, [one]) for one in (shown, *others)]
        return Scoring(
            [shown],
            Page("Faults", facts, sections, __doc__ or "", values),
            {"results": found},
            [shown, *others],
            figures_of(found),
        )


def random_of(part: Part, recording: str) -> np.random.Generator:
    """Draws of their own for each recording and part."""
    return np.random.default_rng((part.seed, part.number, int.from_bytes(recording.encode(), "little")))


def campaign(values: parameters.Values, part: Part, folder: Path) -> list[dict[str, Any]]:
    """The outcomes of PART injections into one recording, as JSON takes them."""
    flown = Flown(open_sequence(folder), values)
    detector = flown.detector
    clean = [flown.frame(shot, None) for shot in flown.shots]
    detector.reset()
    healthy = sum(seen.state == State.HEALTHY for seen in clean)
    results, at = [], 0
    for injection in injections(random_of(part, folder.name), clean, part.kinds):
        while at < injection.onset:
            flown.frame(flown.shots[at], None)
            at += 1
        before = detector.state()
        seen = flown.disturbed(injection)
        detector.resume(before)
        reference = clean[injection.onset :]
        frames = [judged(c, s) for c, s in zip(reference, seen, strict=False)]
        alarms = [
            k
            for k, (c, s) in enumerate(zip(reference, seen, strict=False))
            if c.state == State.HEALTHY and s.state != State.HEALTHY
        ]
        results.append(
            asdict(injection)
            | {
                "recording": str(folder),
                "healthy": healthy,  # frames of the recording as it is
                "frames": len(clean),
                "outcome": outcome_of(frames),
                "alarm": alarms[0] if alarms else None,
                "reasons": seen[alarms[0]].reasons if alarms else (),
            }
        )
    return results


def table(results: Sequence[dict[str, Any]], by: str = "strength") -> Table:
    """Outcomes by kind and strength, by kind, or by recording."""
    groups: dict[str, list[dict[str, Any]]] = {}
    if by == "kind":
        groups = {name: [r for r in results if r["kind"] == name] for name in KINDS}
    elif by == "recording":
        for result in results:
            groups.setdefault(result["recording"], []).append(result)
    else:
        for name, kind in KINDS.items():
            for strength in kind.strengths:
                chosen = [r for r in results if (r["kind"], r["strength"]) == (name, strength)]
                groups[f"{name}, {strength:g} {kind.unit}"] = chosen
    rows = [row(name, chosen) for name, chosen in groups.items() if chosen]
    rows.append((*row("all", results)[:-1], ""))
    heads: tuple[str, ...] = ("injected", "times", *OUTCOMES, "silent, 95 %", "first named")
    if by == "recording":  # by its path: several may have one name
        heads = ("recording", "healthy as it is", *heads[1:])
        as_it_is = [(chosen[0]["healthy"], chosen[0]["frames"]) for chosen in groups.values()]
        as_it_is.append((sum(healthy for healthy, _ in as_it_is), sum(frames for _, frames in as_it_is)))
        rows = [
            (Path(one[0]).name, f"{healthy} of {frames}", *one[1:])
            for one, (healthy, frames) in zip(rows, as_it_is, strict=True)
        ]
    name = {"strength": "faults", "kind": "faults-kinds", "recording": "faults-recordings"}[by]
    title = "" if by == "kind" else f"By {by}"
    return Table(name, heads, rows, title=title)


def row(name: str, results: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    count = Counter(result["outcome"] for result in results)
    reasons = Counter(reason for result in results for reason in result["reasons"])
    named = ", ".join(reason for reason, _ in reasons.most_common(2))
    low, high = clopper_pearson(count["silent"], len(results))
    interval = f"{100.0 * low:.1f} to {100.0 * high:.1f} %"
    return (name, str(len(results)), *(str(count[outcome]) for outcome in OUTCOMES), interval, named)


def figures_of(results: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The number of all injections, and of each outcome."""
    return {"injections": len(results), **Counter(result["outcome"] for result in results)}
