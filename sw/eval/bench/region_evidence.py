"""What each piece of a region's evidence contributes to its verdict, on real street pairs with LiDAR.

FOLDER is laid out as KITTI 2012. Every row is the detector as shipped with one piece of evidence left out, on
the pairs of one half; parameters were chosen on the half named dev. --out is for
`scripts/make_tables.py --save evidence=FILE.json`.

    region_evidence.py FOLDER [--half dev] [--out build/bench/region_evidence.json]
"""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

from vista import parameters
from vista_eval.jobs import add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.metrics.standing_points import MEASURES, Counts, count_points, shares
from vista_eval.report.table import Table, fixed, write_measurement
from vista_eval.rivals import DETECTOR
from vista_eval.suites.pairs import LIDAR, PairSource, camera_of, find_sources, points_of

Changes = dict[str, dict[str, float]]

REGION = parameters.defaults()["region"]
AS_IF_ALL_STOOD = REGION["odds_prior"] + REGION["odds_standing"] + REGION["odds_top"]

LEFT_OUT: dict[str, Changes] = {
    "all evidence": {},
    "without height: as if all stood": {
        "region": {
            "odds_standing": 0.0,
            "odds_top": 0.0,
            "odds_prior": AS_IF_ALL_STOOD,
            "min_standing_fraction": 0.0,
        }
    },
    "without the greater height": {"region": {"odds_top": 0.0}},
    "without edge consistency": {"region": {"odds_boundary": 0.0}},
    "without support": {"region": {"odds_support": 0.0}},
    "without unknown: few words are judged, too": {"region": {"min_valid_fraction": 0.0}},
    "without size": {"region": {"odds_size": 0.0}},
    "without lean": {"region": {"odds_lean": 0.0}},
    "without origin": {"region": {"odds_unseeded": 0.0}},
    "no ground plane": {"surface": {"ground_share": 1.0}},
    "small clusters of words stay": {"words": {"cluster_px": 0, "cluster_px_noise": 0.0}},
    "one level of the pyramid": {"stereo": {"levels": 1}},
}


def changed(changes: Changes) -> parameters.Values:
    values = parameters.defaults()
    for section, entries in changes.items():
        values = values | {section: values[section] | entries}
    return values


def measure(source: PairSource) -> dict[str, Counts] | None:
    """Counts by what is left out; None: the pair shows no road."""
    pair = source.read()
    points = points_of(LIDAR, pair)
    if points is None:
        return None
    return {
        name: count_points(points, DETECTOR.judge(camera_of(pair, changed(changes)), pair))
        for name, changes in LEFT_OUT.items()
    }


def name_of(source: PairSource) -> str:
    return source.name


def table_of(variants: dict[str, dict[str, dict[str, float]]]) -> Table:
    rows = [(name, *(fixed(row[key]["value"], 3) for key in MEASURES)) for name, row in variants.items()]
    return Table("evidence", ("detector", *MEASURES), rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--half", choices=["dev", "test"], default="dev")
    parser.add_argument("--out", type=Path, default=Path("build/bench/region_evidence.json"))
    add_place(parser)
    args = parser.parse_args()
    sources = [source for source in find_sources(LIDAR, args.folder) if source.split == args.half]
    with exit_on_failure():
        measured = run(jobs_of(measure, sources, name_of), chosen_place(args), "measure", "pair")
    found = [counts for counts in measured if counts is not None]
    rows = {
        name: {
            key: asdict(share) for key, share in shares([counts[name] for counts in found], MEASURES).items()
        }
        for name in LEFT_OUT
    }
    table = table_of(rows)
    write_measurement(args.out, [table], {"half": args.half, "variants": rows})
    print(table.as_text())


if __name__ == "__main__":
    main()
