"""Measure what a change of the segmentation is worth, against what is shipped, on all development data.

usage: segmentation_roads.py [VARIANT ...] [--scenes DIR] [--frames DIR] [--flights DIR] [--lidar FOLDER]
                             [--out FILE.json]

VARIANT is one of ROADS, or any parameters of one's own, as "segmentation.solver=forest,segmentation.reach=8".
Whatever data are named are measured, and only their development half:

--scenes  labelled scenes of `vista scenes`, of the even seeds
--frames  every STRIDE-th frame of the flights of `vista worlds`, by itself
--flights the same flights as a whole, judged strictly, for hits and false alarms
--lidar   street pairs laid out as KITTI 2012, those in even places

vista_eval.metrics defines all figures. Beside each figure stands the 95 % interval of the difference to what
is shipped: bootstrap over scenes, over flights, over pairs. The time is the median processor time of the host
over the scenes. --out also writes the figures, for
`scripts/make_tables.py --save segmentation-roads=FILE.json`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from vista import parameters
from vista_eval.dataset.scenes import LabelledScene, read_scene, read_scenes
from vista_eval.dataset.truth import TRUTH, read_truth
from vista_eval.jobs import add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.metrics.flight_score import score_records
from vista_eval.metrics.flight_segmentation import pool
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.scenes import partition_scenes, score_cut
from vista_eval.metrics.segmentation import STATED, STATISTICS, PartitionScore, difference_interval
from vista_eval.metrics.standing_points import MEASURES, Counts, count_points
from vista_eval.report.table import Table, aligned, fixed, write_measurement
from vista_eval.rivals import DETECTOR
from vista_eval.suites.pairs import LIDAR, camera_of, find_sources, points_of

DEV, STRIDE = "dev", 4
SHIPPED = "as shipped"
Changes = dict[str, dict[str, object]]
ROADS: dict[str, Changes] = {
    SHIPPED: {},
    "spanning forest": {"segmentation": {"solver": "forest"}},
    "160 sectors": {"foveation": {"sector_count": 160}},
    "words of level 1 fill gaps": {"words": {"filling_levels": 1}},
    "block 7": {"stereo": {"block_size": 7}},
    "seed step 0.25 px": {"segmentation": {"seed_step_px": 0.25}},
}
OF_LIDAR = ("recall", "on surface", "wrong", "road", "cylinder")
RESAMPLES = 2000
PARTS = ("scenes", "frames", "flights", "lidar")
OF_PARTITIONS = dict.fromkeys(("iou_median", "iou_mean", "boundary_recall", "undersegmentation"), 3)
TABLES: dict[str, dict[str, dict[str, int]]] = {  # of the documentation: parts, their figures, and the digits
    "roads-partitions": {part: OF_PARTITIONS for part in ("scenes", "frames")},
    "roads-detection": {
        "flights": {"hits": 2, "false": 0},
        "lidar": dict.fromkeys(("recall", "wrong", "road", "cylinder"), 3),
    },
}


@dataclass(frozen=True)
class Measured:
    """One part of one variant: an entry a scene, a flight or a pair, the same ones for every variant."""

    entries: list[Any]
    host_ms: float | None = None


def changes_of(variant: str) -> Changes:
    """Raises KeyError or ValueError for what is no parameter or no value of one."""
    if variant in ROADS:
        return ROADS[variant]
    defaults, changes = parameters.defaults(), Changes()
    for change in variant.split(","):
        place, value = change.split("=")
        section, name = place.split(".")
        kind = type(defaults[section][name])
        changes.setdefault(section, {})[name] = value if kind is str else kind(float(value))
    return changes


def values_of(variant: str) -> parameters.Values:
    values = parameters.defaults()
    for section, content in changes_of(variant).items():
        values = values | {section: values[section] | content}
    return values


# ---- one variant ----


def measure(folders: dict[str, Path], variant_and_part: tuple[str, str]) -> Measured:
    """folders: by part."""
    variant, part = variant_and_part
    values, folder = values_of(variant), folders[part]
    if part == "scenes":
        return Measured(*score_scenes(read_scenes(folder, DEV), values))
    if part == "frames":
        return Measured([score_frames(flight, values) for flight in flights_of(folder)])
    if part == "flights":
        return Measured([fly_one(flight, values) for flight in flights_of(folder)])
    return Measured(count_pairs(folder, values))


def score_frames(folder: Path, values: parameters.Values) -> PartitionScore:
    frames = range(0, len(read_truth(folder).times_ns), STRIDE)
    return pool(score_scenes([read_scene(folder, k) for k in frames], values)[0])


def fly_one(folder: Path, values: parameters.Values) -> dict[str, int]:
    score = score_records(folder, DETECTOR.fly(folder, values), values, STRICT)
    return {"hits": score.hits, "asked": score.band_frames, "false": len(score.false_alarm_frames)}


def flights_of(folder: Path) -> list[Path]:
    folders = [path.parent for path in sorted(folder.glob(f"*/{TRUTH}"))]
    return [folder for folder in folders if read_truth(folder).split == DEV]


def score_scenes(
    scenes: list[LabelledScene], values: parameters.Values
) -> tuple[list[PartitionScore], float]:
    scores, host_ms = [], []
    for scene, partition in partition_scenes(scenes, values):
        scores.append(score_cut(scene, partition))
        host_ms.append(partition.host_ms)
    return scores, float(np.median(host_ms))


def count_pairs(folder: Path, values: parameters.Values) -> list[Counts]:
    found = []
    for source in find_sources(LIDAR, folder):
        if source.split != DEV:
            continue
        pair = source.read()
        points = points_of(LIDAR, pair)
        if points is None:
            continue
        found.append(count_points(points, DETECTOR.judge(camera_of(pair, values), pair)))
    return found


# ---- against what is shipped ----

Figure = dict[str, float]  # value; low, high: of the difference


def figure(value: float, interval: tuple[float, float] | None) -> Figure:
    found = {"value": round(value, 4)}
    return (
        found if interval is None else found | {"low": round(interval[0], 4), "high": round(interval[1], 4)}
    )


def of_partitions(scores: list[PartitionScore], shipped: list[PartitionScore]) -> dict[str, Figure]:
    return {
        key: figure(STATISTICS[key](scores), difference_interval(scores, shipped, STATISTICS[key]))
        for key in STATED
    }


def of_quotient(part: str, whole: str, rows: list[Counts], shipped: list[Counts]) -> Figure:
    """The quotient of the sums over flights or pairs."""
    counts = np.array([[[row[part], row[whole]] for row in both] for both in (rows, shipped)], np.float64)
    drawn = np.random.default_rng(0).multinomial(len(rows), np.full(len(rows), 1.0 / len(rows)), RESAMPLES)
    with np.errstate(invalid="ignore", divide="ignore"):
        total, sums = counts.sum(axis=1), drawn @ counts
        difference = sums[0, :, 0] / sums[0, :, 1] - sums[1, :, 0] / sums[1, :, 1]
    low, high = np.nanpercentile(difference, [2.5, 97.5])
    return figure(float(total[0, 0] / total[0, 1]), (float(low), float(high)))


def of_flights(flights: list[dict[str, int]], shipped: list[dict[str, int]]) -> dict[str, Figure]:
    false = [flight["false"] for flight in flights]
    return {
        "hits": of_quotient("hits", "asked", flights, shipped),
        "false": figure(sum(false), None),
        "flights with false": figure(sum(map(bool, false)), None),
    }


def of_pairs(pairs: list[Counts], shipped: list[Counts]) -> dict[str, Figure]:
    return {key: of_quotient(*MEASURES[key], pairs, shipped) for key in OF_LIDAR}


FIGURES: dict[str, Callable[[list[Any], list[Any]], dict[str, Figure]]] = {
    "scenes": of_partitions,
    "frames": of_partitions,
    "flights": of_flights,
    "lidar": of_pairs,
}


def row_of(variant: str, found: dict[str, Measured], shipped: dict[str, Measured]) -> dict[str, Any]:
    """found, shipped: by part."""
    host_ms = found["scenes"].host_ms if "scenes" in found else None
    row: dict[str, Any] = {"variant": variant, "host_ms": None if host_ms is None else round(host_ms, 2)}
    for part, one in found.items():
        row[part] = FIGURES[part](one.entries, shipped[part].entries)
    return row


def cell(found: Figure, digits: int = 3) -> str:
    """A figure, and the ends of the interval of its difference to what is shipped."""
    text = f"{found['value']:.{digits}f}"
    if "low" not in found or (found["low"], found["high"]) == (0.0, 0.0):
        return text
    return f"{text} ({found['low']:+.{digits}f} to {found['high']:+.{digits}f})"


def table_of(name: str, rows: list[dict[str, Any]]) -> Table:
    columns = [(part, key, digits) for part, keys in TABLES[name].items() for key, digits in keys.items()]
    cells = [
        (
            row["variant"],
            *(cell(row[part][key], digits) if part in row else "" for part, key, digits in columns),
            fixed(row["host_ms"], 1),
        )
        for row in rows
    ]
    names = (f"{part}: {STATED[key]}" if key in STATED else key for part, key, _ in columns)
    return Table(name, ("road", *names, "host ms"), cells)


def print_table(rows: list[dict[str, Any]], part: str) -> None:
    heads = list(rows[0][part])
    lines = [(row["variant"], *(cell(row[part][head]) for head in heads)) for row in rows]
    print(aligned([(part, *heads), *lines]))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help="measure these (default: all roads)")
    for name in PARTS:
        parser.add_argument(f"--{name}", type=Path, metavar="DIR")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="also write the figures")
    add_place(parser)
    arguments = parser.parse_args()
    names = list(dict.fromkeys([SHIPPED, *(arguments.variants or ROADS)]))
    for name in names:
        try:
            changes_of(name)
        except (KeyError, ValueError) as error:
            parser.error(f"{name}: no road, and no parameters: {error}")
    folders = {part: path for part in PARTS if (path := getattr(arguments, part)) is not None}
    keys = [(name, part) for part in folders for name in names]
    with exit_on_failure():
        jobs = jobs_of(partial(measure, folders), keys, ", ".join)
        measured = dict(zip(keys, run(jobs, chosen_place(arguments), "measure", "part"), strict=True))
    found = {name: {part: measured[name, part] for part in folders} for name in names}
    rows = [row_of(name, found[name], found[SHIPPED]) for name in names]
    for part in PARTS:
        if part in rows[0]:
            print_table(rows, part)
    print("host ms: " + ", ".join(f"{row['variant']} {row['host_ms']}" for row in rows))
    if arguments.out is not None:
        counts = {part: len(one.entries) for part, one in found[SHIPPED].items()}
        tables = [table_of(name, rows) for name in TABLES]
        write_measurement(arguments.out, tables, {"counts": counts, "variants": rows})


if __name__ == "__main__":
    main()
