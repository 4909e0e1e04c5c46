"""Runs the whole chain on a flight and keeps its records until something that decides them changes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from vista import native, parameters
from vista.chain import Step, make_chain, run_frame
from vista.errors import InputError
from vista.geometry import Pose
from vista.health.finding import FrameHealth
from vista.history import FrameRecord
from vista.pipeline import Ellipse, Nearest, Obstacle
from vista.sequence import Sequence, open_sequence

from vista_eval.cache import code_digest, digest_of, flight_files, kept
from vista_eval.pose_noise import noisy_poses

LIBRARIES = ("vista", "vista_engine")


def open_flight(folder: Path, noise_seed: int | None = None) -> Sequence:
    """noise_seed: of the navigation error; None: exact poses. Raises InputError."""
    sequence = open_sequence(folder)
    if noise_seed is None:
        return sequence
    frames = sequence.frames
    exact = [f.world_from_camera for f in frames if f.world_from_camera is not None]
    if len(exact) != len(frames):
        raise InputError(folder, "a frame has no pose")
    poses = noisy_poses(exact, [f.t_ns for f in frames], noise_seed)
    return replace(
        sequence, frames=tuple(replace(f, world_from_camera=p) for f, p in zip(frames, poses, strict=True))
    )


def fly(sequence: Sequence, values: parameters.Values) -> Iterator[Step]:
    """Every frame of the flight, in order, through engine and host."""
    chain = make_chain(sequence, "golden", values, threads=1)
    for files in sequence.frames:
        yield run_frame(chain, files)


def fly_cached(
    folder: Path, values: parameters.Values, cache: Path, noise_seed: int | None = None, anew: bool = False
) -> list[FrameRecord]:
    """Records from `cache`, if of this flight, chain and parameters; else, or if asked for anew, flown."""
    return kept(
        cache,
        flight_digest(folder, values, noise_seed),
        lambda: [step.record for step in fly(open_flight(folder, noise_seed), values)],
        lambda records: [_record(record) for record in records],
        anew,
    )


def flight_digest(folder: Path, values: parameters.Values, noise_seed: int | None) -> str:
    return digest_of(
        json.dumps([values, noise_seed], sort_keys=True),
        code_digest(__name__),
        *map(native.library_path, LIBRARIES),
        *flight_files(folder),
    )


def _record(content: dict[str, Any]) -> FrameRecord:
    pose, nearest = content["world_from_camera"], content["nearest_collision"]
    return FrameRecord(
        **content
        | {
            "health": FrameHealth(),  # no checks are made of what was rendered
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
