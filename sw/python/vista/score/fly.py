"""A flight through the whole chain; its records are kept until something that decides them changes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

import vista
from vista import native, parameters
from vista.chain import Step, make_chain, run_frame
from vista.geometry import Pose
from vista.history import FrameRecord
from vista.output import write_atomically
from vista.pipeline import Ellipse, Nearest, Obstacle
from vista.score.pose_noise import noisy_poses
from vista.sequence import Sequence, open_sequence

# What decides a record, beside parameters and images.
SOURCES = ("chain.py", "pipeline.py", "rectify.py", "engine.py", "score/pose_noise.py")
LIBRARIES = ("vista", "vista_engine")


def open_flight(folder: Path, noise_seed: int | None = None) -> Sequence:
    """noise_seed: of the navigation error; None: exact poses. Raises InputError."""
    sequence = open_sequence(folder)
    if noise_seed is None:
        return sequence
    frames = sequence.frames
    poses = noisy_poses([f.world_from_camera for f in frames], [f.t_ns for f in frames], noise_seed)
    return replace(
        sequence, frames=tuple(replace(f, world_from_camera=p) for f, p in zip(frames, poses, strict=True))
    )


def fly(sequence: Sequence, values: parameters.Values) -> Iterator[Step]:
    """Every frame of the flight, in order, through engine and host."""
    chain = make_chain(sequence, "golden", values, threads=1)
    for files in sequence.frames:
        yield run_frame(chain, files)


def fly_cached(
    folder: Path, values: parameters.Values, cache: Path, noise_seed: int | None = None
) -> tuple[list[FrameRecord], bool]:
    """Records from `cache`, if that is of this flight, chain and parameters; else flown and written there.
    The second value says which: True, they were flown now."""
    digest = flight_digest(folder, values, noise_seed)
    records = read_records(cache, digest)
    if records is not None:
        return records, False
    records = [step.record for step in fly(open_flight(folder, noise_seed), values)]
    content = {"digest": digest, "records": [to_json(asdict(record)) for record in records]}
    write_atomically(cache, json.dumps(content))
    return records, True


def flight_digest(folder: Path, values: parameters.Values, noise_seed: int | None) -> str:
    digest = hashlib.sha256(json.dumps([values, noise_seed], sort_keys=True).encode())
    root = Path(vista.__file__).parent
    for source in SOURCES:
        digest.update((root / source).read_bytes())
    for name in LIBRARIES:
        digest.update(native.library_path(name).read_bytes())
    for camera in ("cam0", "cam1"):
        for image in sorted((folder / "mav0" / camera / "data").iterdir()):
            digest.update(f"{image.name} {image.stat().st_size} {image.stat().st_mtime_ns}".encode())
    for text in sorted((folder / "mav0").rglob("*.[cy]*")):
        digest.update(text.read_bytes())
    return digest.hexdigest()


def to_json(value: Any) -> Any:
    match value:
        case dict():
            return {name: to_json(item) for name, item in value.items()}
        case list() | tuple():
            return [to_json(item) for item in value]
        case np.ndarray() | np.generic():
            return value.tolist()
    return value


def read_records(cache: Path, digest: str) -> list[FrameRecord] | None:
    try:
        content = json.loads(cache.read_text())
        return [_record(one) for one in content["records"]] if content["digest"] == digest else None
    except (OSError, ValueError, KeyError, TypeError):  # absent, or of an earlier layout
        return None


def _record(content: dict[str, Any]) -> FrameRecord:
    pose, nearest = content["world_from_camera"], content["nearest_collision"]
    return FrameRecord(
        **content
        | {
            "world_from_camera": Pose(np.array(pose["rotation"]), np.array(pose["translation_m"])),
            "obstacles": tuple(_obstacle(o) for o in content["obstacles"]),
            "nearest_collision": nearest
            and Nearest(**nearest | {"position_m": np.array(nearest["position_m"])}),
        }
    )


def _obstacle(content: dict[str, Any]) -> Obstacle:
    return Obstacle(
        **content
        | {
            "position_m": np.array(content["position_m"]),
            "covariance_m2": np.array(content["covariance_m2"]),
            "extent_m": tuple(content["extent_m"]),
            "ellipse": Ellipse(**content["ellipse"]),
        }
    )
