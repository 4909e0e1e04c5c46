"""What truly lies along the path of each frame, in flights of both kinds: rendered here, or by others."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.geometry import Calibration, Pose
from vista.sequence import open_sequence

from vista_eval.dataset.truth import TRUTH, FlightTruth, read_truth, truth_path
from vista_eval.metrics.flight_path import CYLINDER_RADIUS_M, Curved, true_paths
from vista_eval.metrics.frame_truth import FrameTruth, View, flight_frames
from vista_eval.metrics.rules import STRICT

PAPER_FAMILY = "the paper's"
OTHERS_SCALE = 256.0  # of the disparities that others have written


@dataclass(frozen=True)
class PathTruth:
    """Distances along the true path of one frame, sorted: of points that are seen."""

    t_ns: int
    things_m: NDArray[np.floating]  # of what stands, moves or is flown at, within the collision radius
    beside_m: NDArray[np.floating]  # of the same, somewhat farther from the path, too
    ground_m: NDArray[np.floating]  # of other ground, within the collision radius


@dataclass(frozen=True)
class FlightOfPaths:
    family: str
    frames: tuple[PathTruth, ...]


def path_truth(folder: Path, camera: Calibration) -> FlightOfPaths:
    """Raises InputError, for a flight that nothing may be chosen on, too."""
    try:
        content = json.loads((folder / TRUTH).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(folder / TRUTH, f"cannot be read: {error}") from None
    return _of_others(folder, content, camera) if "obstacles" in content else _of_our_own(folder)


def _of_our_own(folder: Path) -> FlightOfPaths:
    if read_truth(folder).split == "test":
        raise InputError(folder, "is of the split test, on which nothing is chosen")
    truth, frames = flight_frames(folder, STRICT)
    return FlightOfPaths(truth.family or PAPER_FAMILY, tuple(_in_frame(truth, frame) for frame in frames))


def _in_frame(truth: FlightTruth, frame: FrameTruth) -> PathTruth:
    lying = [k for k, thing in truth.objects.items() if not (thing.standing or thing.target)]
    ground = np.isin(frame.around_path.label, lying)
    along_m = frame.around_path.along_m
    return PathTruth(
        frame.t_ns,
        np.sort(along_m[frame.in_cylinder & ~ground]),
        np.sort(along_m[~ground]),
        np.sort(along_m[frame.in_cylinder & ground]),
    )


def _of_others(folder: Path, content: dict[str, Any], camera: Calibration) -> FlightOfPaths:
    """Nothing says what is ground: all that the path meets counts as something that stands."""
    files = open_sequence(folder).frames
    poses = [f.world_from_camera for f in files if f.world_from_camera is not None]
    times_ns = tuple(f.t_ns for f in files)
    if len(poses) != len(times_ns):
        raise InputError(folder, "a frame has no pose")
    paths = true_paths(poses, times_ns)
    frames = [
        _seen_by_others(truth_path(folder, "disparity", t_ns), t_ns, pose, path, camera)
        for t_ns, pose, path in zip(times_ns, poses, paths, strict=True)
    ]
    return FlightOfPaths(f"{content['flight']}, by others", tuple(frames))


def _seen_by_others(image: Path, t_ns: int, pose: Pose, path: Curved, camera: Calibration) -> PathTruth:
    words = cv2.imread(str(image), cv2.IMREAD_UNCHANGED)
    if words is None:
        raise InputError(image, "missing, or not an image")
    disparity_px = words.astype(np.float32) / OTHERS_SCALE
    v, u = np.nonzero(disparity_px)
    x, y = View(pose, camera.focal_px, (camera.cx, camera.cy)).rays(u, v)
    depth_m = camera.focal_px * camera.baseline_m / disparity_px[v, u]
    aside_m, along_m = path.measure(pose, x, y, depth_m)
    ahead = (along_m > 0.0) & (along_m <= path.length_m)
    within, beside = (
        np.sort(along_m[ahead & (aside_m <= reach_m)])
        for reach_m in (CYLINDER_RADIUS_M, CYLINDER_RADIUS_M + STRICT.inflation_m)
    )
    return PathTruth(t_ns, within, beside, np.zeros(0))
