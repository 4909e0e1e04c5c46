"""How far OBSTACLE_DISTANCE says that things are, against LiDAR, on real street pairs.

FOLDER is laid out as KITTI 2012. Each pair is judged alone, with the camera counted as level. In each sector
that holds an obstacle the distance is compared with the nearest measured points there, the lowest twentieth
of those from 1 m below to 2 m above the camera. Printed is how the distances compare, with obstacles as
boards that face the camera, and with what is seen of them in each sector (directions.blocked_m).

    sector_distances.py FOLDER [--half dev]
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pymavlink.dialects.v20 import ardupilotmega as dialect
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import create_engine
from vista.history import FrameRecord
from vista.mavlink.link import Link
from vista.mavlink.sighting import sighting_of
from vista.pipeline import Nearest, Pipeline
from vista_eval.dataset.kitti_stereo import find_pairs, read_pair
from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.report.table import aligned

WIDTH_DEG = 5.0
POINTS_MIN = 30  # of a sector
HEIGHTS_M = -2.0, 1.0  # below the camera
NEAREST = 5.0  # per cent
CHANGED = 0.05
KNOWN: dict[str, dict[str, float]] = {
    "tracker": {"confirm_hits": 1, "confirm_window": 1},
    "mavlink": {"max_distance_m": 60.0},
}

Distances = NDArray[np.float64]


def record_of_pair(pair: TruthPair, values: parameters.Values) -> FrameRecord:
    engine = create_engine("golden", engine_parameters(values), threads=1)
    levels = list(engine.levels(pair.left, pair.right))
    found = Pipeline(pair.camera, values).process(pair.left, levels, 0, None, None)
    outcome = found.outcome.but(nearest_collision=Nearest.made())
    return FrameRecord(outcome, found.items, found.directions, found.stage_ms, index=0, t_ns=0)


def sectors(record: FrameRecord, values: parameters.Values) -> Distances:
    """(72,): metres; NaN where no obstacle is."""
    link, decoder = Link(values), dialect.MAVLink(None)
    link.update(sighting_of(record), 0)
    messages = [message for data in link.due(0) for message in decoder.parse_buffer(data)]
    (told,) = [message for message in messages if message.get_type() == "OBSTACLE_DISTANCE"]
    distances_cm = np.array(told.distances, np.float64)
    return np.where(distances_cm <= told.max_distance, distances_cm / 100, np.nan)


def measured(pair: TruthPair) -> Distances:
    """(72,): metres; NaN where too few points were measured."""
    camera = pair.camera
    v, u = np.nonzero(pair.disparity_px > 0.0)
    depth_m = camera.focal_px * camera.baseline_m / pair.disparity_px[v, u]
    aside_m, below_m = (
        (u - camera.cx) / camera.focal_px * depth_m,
        (v - camera.cy) / camera.focal_px * depth_m,
    )
    beside = (below_m > HEIGHTS_M[0]) & (below_m < HEIGHTS_M[1])
    sector = np.round(np.degrees(np.arctan2(aside_m, depth_m)) / WIDTH_DEG).astype(int) % 72
    distance_m = np.hypot(aside_m, depth_m)
    inside = [distance_m[beside & (sector == k)] for k in range(72)]
    return np.array([np.percentile(m, NEAREST) if len(m) >= POINTS_MIN else np.nan for m in inside])


def row(name: str, told_m: Distances, truth_m: Distances) -> tuple[str, ...]:
    ratio = np.where(np.isnan(told_m), np.inf, told_m / truth_m)  # not told of: too far
    shares = (abs(ratio - 1.0) <= 0.1).mean(), (ratio > 1.25).mean(), (ratio < 0.8).mean()
    return name, str(len(ratio)), *(f"{100 * share:.0f} %" for share in shares)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--half", choices=("dev", "test"), default="dev")
    args = parser.parse_args()
    values = parameters.defaults()
    for section, changes in KNOWN.items():
        values[section] |= changes
    rows = []
    for source in find_pairs(args.folder):
        if source.split != args.half:
            continue
        pair = read_pair(source)
        seen = record_of_pair(pair, values)
        assert seen.directions is not None
        facing = replace(seen, directions=seen.directions.but(blocked_m=0.0))
        rows.append((sectors(facing, values), sectors(seen, values), measured(pair)))
    board_m, seen_m, truth_m = np.concatenate(rows, axis=1)
    judged = ~np.isnan(seen_m) & ~np.isnan(truth_m)
    changed = judged & ~(abs(board_m / seen_m - 1.0) <= CHANGED)
    table: list[tuple[str, ...]] = [
        ("sectors", "number", "within 10 %", "over 25 % too far", "over 20 % too near")
    ]
    for name, chosen in (("all", judged), (f"told otherwise by {CHANGED:.0%}", changed)):
        table.append(row(f"{name}: boards", board_m[chosen], truth_m[chosen]))
        table.append(row(f"{name}: as seen", seen_m[chosen], truth_m[chosen]))
    print(aligned(table))


if __name__ == "__main__":
    main()
