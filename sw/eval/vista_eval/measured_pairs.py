"""Real pairs with measured truth through every detector: what `vista scenes --lidar`, `--dense` compute."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from vista import parameters
from vista.chain import engine_parameters
from vista.errors import InputError
from vista.geometry import Calibration

from vista_eval.dataset.dense_stereo import find_scenes, read_scene
from vista_eval.dataset.kitti_stereo import PairFiles, find_pairs, read_pair
from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.detectors import Detectors
from vista_eval.metrics.segmentation import matched_area
from vista_eval.metrics.standing_points import (
    Counts,
    Judged,
    Points,
    count_points,
    dense_points,
    street_points,
)

LIDAR, DENSE = "lidar", "dense"


@dataclass(frozen=True)
class PairSource:
    """One pair on disk; picklable."""

    kind: str  # LIDAR or DENSE
    name: str
    split: str
    files: Any

    def read(self) -> TruthPair:
        return read_pair(self.files) if self.kind == LIDAR else read_scene(self.files, self.split)


@dataclass(frozen=True)
class MeasuredPair:
    name: str
    split: str
    counts: dict[str, Counts] | None  # by detector; None: no road was found


def find_sources(kind: str, folder: Path) -> list[PairSource]:
    """Raises InputError for a folder that holds no such pairs."""
    if kind == LIDAR:
        files: list[PairFiles] = find_pairs(folder)
        return [PairSource(kind, one.name, one.split, one) for one in files]
    return [PairSource(kind, path.name, split, path) for path, split in find_scenes(folder)]


def points_of(kind: str, pair: TruthPair) -> Points | None:
    """Those that the shipped engine can match, whatever is measured."""
    stereo = engine_parameters(parameters.defaults())
    height, width = pair.left.shape
    area = matched_area(height, width, stereo.num_disparities, stereo.block_size)
    largest_px = stereo.num_disparities - 1.0
    if kind == LIDAR:
        return street_points(pair.camera, pair.disparity_px, area, largest_px)
    return dense_points(pair.disparity_px, area, largest_px)


def measure(values: parameters.Values, source: PairSource) -> MeasuredPair:
    pair = source.read()
    points = points_of(source.kind, pair)
    if points is None:
        return MeasuredPair(source.name, source.split, None)
    judged = detectors_for(pair, values).judge(pair)
    counts = {name: count_points(points, one) for name, one in judged.items()}
    return MeasuredPair(source.name, source.split, counts)


def look(values: parameters.Values, source: PairSource, detector: str) -> tuple[TruthPair, Points, Judged]:
    """One pair once more, for its picture."""
    pair = source.read()
    points = points_of(source.kind, pair)
    assert points is not None
    return pair, points, detectors_for(pair, values).judge(pair)[detector]


def detectors_for(pair: TruthPair, values: parameters.Values) -> Detectors:
    try:
        return _of_camera(pair.camera, _Same(values))
    except ValueError as error:
        raise InputError(pair.name, str(error)) from None


class _Same:
    """Parameters as a key: equal if all values are."""

    def __init__(self, values: parameters.Values) -> None:
        self.values = values

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.values == other.values

    def __hash__(self) -> int:
        return 0


@lru_cache(maxsize=8)  # KITTI has images of five sizes
def _of_camera(camera: Calibration, same: _Same) -> Detectors:
    return Detectors(camera, same.values)
