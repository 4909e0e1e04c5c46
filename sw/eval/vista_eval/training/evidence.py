"""The evidence of every place on the path in every frame of a flight, and whether it truly is occupied."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import create_engine
from vista.geometry import Array, Calibration
from vista.rectify import Rectifier

from vista_eval.cell_graph import OpenPipeline
from vista_eval.fly import open_flight
from vista_eval.training.kept import kept_of_flight
from vista_eval.training.path_truth import PathTruth, path_truth

OCCUPIED, EMPTY, UNTOLD = 1, 0, -1
PIECES = ("THING", "GROUND", "VOTES", "FEET", "NOT_BEYOND")  # as vista_place_piece numbers them
# How near a true point is for its place to be occupied, in depths of one disparity, and no less than that.
OCCUPIED_DZ, OCCUPIED_M = 0.6, 0.75
EMPTY_FACTOR = 1.5  # of what a distance may be wrong, without anything for a place to be empty


@dataclass(frozen=True)
class FlightEvidence:
    """Arrays with an entry a place."""

    name: str
    family: str
    frame: NDArray[np.int64]
    along_m: NDArray[np.float64]
    reach_m: NDArray[np.float64]
    pieces: NDArray[np.float64]  # (n, PIECES)
    known: NDArray[np.bool_]  # enough for a warning
    told: NDArray[np.float64]  # the probability that the detector gives it
    truth: NDArray[np.int64]  # OCCUPIED, EMPTY or UNTOLD


def truth_of_places(along_m: Array, truth: PathTruth, focal_baseline_px_m: float) -> NDArray[np.int64]:
    """OCCUPIED where a thing is; EMPTY where none is near, nor ground; UNTOLD between, and beyond the first
    thing, where little can be seen."""
    first_m = np.array([truth.things_m[0] if len(truth.things_m) else np.inf])
    there = distance_m(along_m, truth.things_m) <= np.maximum(
        OCCUPIED_DZ * along_m**2 / focal_baseline_px_m, OCCUPIED_M
    )
    doubt_m = doubt_of_m(along_m, focal_baseline_px_m)
    near = distance_m(along_m, truth.beside_m) <= EMPTY_FACTOR * doubt_m
    near |= distance_m(along_m, truth.ground_m) <= doubt_m
    hidden = along_m > first_m + doubt_of_m(first_m, focal_baseline_px_m)
    return np.where(hidden, UNTOLD, np.where(there, OCCUPIED, np.where(near, UNTOLD, EMPTY)))


def doubt_of_m(along_m: Array, focal_baseline_px_m: float) -> Array:
    """The error that a distance may have."""
    return np.maximum(2.0 * along_m**2 / focal_baseline_px_m, 1.0) + 0.5


def distance_m(along_m: Array, points_m: NDArray[np.floating]) -> Array:
    """The distance of each place from the nearest of the sorted points."""
    edged = np.concatenate([[-np.inf], points_m, [np.inf]])
    k = np.searchsorted(edged, along_m)
    return np.minimum(along_m - edged[k - 1], edged[k] - along_m)


def collect_cached(folder: Path, values: parameters.Values, cache: Path) -> FlightEvidence:
    path = cache / f"{folder.parent.name}-{folder.name}.json"
    return kept_of_flight(path, folder, values, collect, from_json)


def from_json(content: dict[str, Any]) -> FlightEvidence:
    kinds = {"frame": np.int64, "known": np.bool_, "truth": np.int64}
    arrays: dict[str, NDArray[Any]] = {
        name: np.array(value, kinds.get(name, np.float64))
        for name, value in content.items()
        if name not in ("name", "family")
    }
    arrays["pieces"] = arrays["pieces"].reshape(-1, len(PIECES))
    return FlightEvidence(content["name"], content["family"], **arrays)


def collect(folder: Path, values: parameters.Values) -> FlightEvidence:
    """Flies it. Raises InputError."""
    sequence = open_flight(folder)
    rectifier = Rectifier(sequence.calibration)
    camera: Calibration = rectifier.calibration
    along_path = path_truth(folder, camera)
    frames = {frame.t_ns: frame for frame in along_path.frames}
    engine = create_engine("golden", engine_parameters(values))
    pipeline = OpenPipeline(camera, values)
    columns: dict[str, list[Any]] = {
        name: [] for name in ("frame", "along_m", "reach_m", "pieces", "known", "told", "truth")
    }
    for number, files in enumerate(sequence.frames):
        pair = rectifier.rectify(sequence.read(files))
        levels = list(engine.levels(pair.left, pair.right))
        pipeline.process(pair.left, levels, files.t_ns, pair.world_from_camera, sequence.up_world)
        places = pipeline.path_places()
        along_m = np.array([place.along_m for place in places], np.float64)
        truth = truth_of_places(along_m, frames[files.t_ns], camera.focal_px * camera.baseline_m)
        columns["frame"] += [number] * len(places)
        columns["along_m"] += along_m.tolist()
        columns["reach_m"] += [place.reach_m for place in places]
        columns["pieces"] += [place.pieces for place in places]
        columns["known"] += [place.known for place in places]
        columns["told"] += [place.probability for place in places]
        columns["truth"] += truth.tolist()
    return from_json({"name": folder.name, "family": along_path.family, **columns})
