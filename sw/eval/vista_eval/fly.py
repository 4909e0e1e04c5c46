"""Runs the whole chain on a flight and keeps its records until something that decides them changes."""

from __future__ import annotations

import base64
import json
import pickle
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from vista import native, parameters
from vista.chain import Step, make_chain, run_frame
from vista.engine import Engine
from vista.errors import InputError
from vista.health.finding import FrameHealth
from vista.health.monitor import findings_of_host
from vista.history import FrameRecord
from vista.sequence import Sequence, open_sequence

from vista_eval.cache import code_digest, digest_of, flight_files, kept
from vista_eval.pose_noise import noisy_poses
from vista_eval.sensor_noise import with_noise

LIBRARIES = ("vista", "vista_engine")


@dataclass(frozen=True)
class Disturbance:
    """What is added to a flight before it is flown."""

    poses: bool = False  # errors like those of a navigation filter
    image_grey: float = 0.0  # standard deviation of sensor noise, grey levels
    seed: int = 1


UNDISTURBED = Disturbance()


def open_flight(folder: Path, disturbance: Disturbance = UNDISTURBED) -> Sequence:
    """Raises InputError."""
    sequence = with_noise(open_sequence(folder), disturbance.image_grey, disturbance.seed)
    if not disturbance.poses:
        return sequence
    frames = sequence.frames
    exact = [f.world_from_camera for f in frames if f.world_from_camera is not None]
    if len(exact) != len(frames):
        raise InputError(folder, "a frame has no pose")
    poses = noisy_poses(exact, [f.t_ns for f in frames], disturbance.seed)
    return replace(
        sequence, frames=tuple(replace(f, world_from_camera=p) for f, p in zip(frames, poses, strict=True))
    )


def fly(sequence: Sequence, values: parameters.Values, engine: Engine | None = None) -> Iterator[Step]:
    """Every frame of the flight, in order, through engine and host; engine: None for the project's."""
    chain = replace(make_chain(sequence, "golden", values, threads=1), monitor=None)
    if engine is not None:
        chain = replace(chain, engine=engine)
    for files in sequence.frames:
        yield run_frame(chain, files)


def judged(step: Step) -> FrameRecord:
    """The record with what the host says of the view; what a run checks besides is right by construction
    here."""
    return replace(step.record, health=FrameHealth(findings_of_host(step.result.health)))


def fly_cached(
    folder: Path,
    values: parameters.Values,
    cache: Path,
    disturbance: Disturbance = UNDISTURBED,
    anew: bool = False,
) -> list[FrameRecord]:
    """Records from `cache`, if of this flight, chain and parameters; else, or if asked for anew, flown."""
    return kept_records(
        cache,
        flight_digest(folder, values, disturbance),
        lambda: [judged(step) for step in fly(open_flight(folder, disturbance), values)],
        anew,
    )


def records_name(disturbance: Disturbance = UNDISTURBED) -> str:
    """The name of the file in the flight's folder that keeps them."""
    if disturbance.image_grey > 0.0:
        return f"records_noise_{disturbance.image_grey:g}.json"
    return "records_noisy.json" if disturbance.poses else "records.json"


def flight_digest(folder: Path, values: parameters.Values, disturbance: Disturbance = UNDISTURBED) -> str:
    return digest_of(
        json.dumps([values, asdict(disturbance)], sort_keys=True),
        code_digest(__name__),
        *map(native.library_path, LIBRARIES),
        *flight_files(folder),
    )


def packed(records: list[FrameRecord]) -> str:
    """The records as text, for files of our own alone."""
    return base64.b64encode(pickle.dumps(records)).decode()


def unpacked(text: str) -> list[FrameRecord]:
    records: list[FrameRecord] = pickle.loads(base64.b64decode(text))
    return records


def kept_records(
    cache: Path, digest: str, find: Callable[[], list[FrameRecord]], anew: bool = False
) -> list[FrameRecord]:
    """Records from `cache`, if of this digest; else, or if asked for anew, those that are found."""
    return unpacked(kept(cache, digest, lambda: packed(find()), str, anew))
