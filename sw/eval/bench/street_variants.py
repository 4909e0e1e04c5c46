"""Measure what each choice of the host is worth on a street (sw/tests/street_drive.py: KITTI odometry 00).

usage: street_variants.py [VARIANT ...] [--out FILE.json]

For each variant, the table has the number of things (of 12 picked by eye) that keep one id while they are in
view, the frames with an obstacle where the car drove later, the obstacles that were confirmed, the median
number of frames in which one was seen, the frames with a warning, those with a warning of something that lay
beside the path driven next, the share of coasting ones among the confirmed obstacles of all frames, the ids
per thing, and the time of the host. vista_eval.metrics.street defines them. --out also writes the figures,
for `scripts/make_tables.py --save street=FILE.json`. Variants run one at a time, for the sake of the
times, unless --jobs says otherwise.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

import street_drive as street
from vista import parameters
from vista_eval.jobs import add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.metrics import street as measures
from vista_eval.report.table import Table, write_measurement

HEADS = ("things", "ghosts", "confirmed", "seen", "warned", "aside", "coasting", "ids", "host ms")
STATED = {  # in the documentation
    "kept_of_12": "things that keep one id, of 12",
    "ghost_frames": "frames with an obstacle where the car drove",
    "confirmed": "confirmed obstacles",
    "seen_frames_median": "frames that one is seen in, median",
    "host_ms": "host ms",
}
VARIANTS: dict[str, dict[str, dict[str, object]]] = {
    "as shipped": {},
    "equation 3 as printed: sum of terms": {"affinity": {"form": "sum"}},
    "companion's sigma 30, mu 2": {
        "affinity": {"form": "sum", "sigma_intensity": 30.0, "mu_intensity": 2.0, "sigma_disparity_px": 30.0}
    },
    "equation 5 as printed: linear flow": {"affinity": {"flow_encoding": "linear"}},
    "sum and linear": {"affinity": {"form": "sum", "flow_encoding": "linear"}},
    "96 sectors": {"foveation": {"sector_count": 96}},
    "160 sectors": {"foveation": {"sector_count": 160}},
    "32 disparities": {"stereo": {"num_disparities": 32}},
    "no relief in affinities": {"affinity": {"mu_depth_m": 0.0}},
    "no edge consistency": {"region": {"min_inlier_fraction": 0.0}},
    "no confirmation": {"tracker": {"confirm_hits": 1, "confirm_window": 1}},
}


def measure(variant: str) -> dict[str, Any]:
    values = parameters.defaults()
    for section, content in VARIANTS[variant].items():
        values[section] |= content
    results = street.run_street(values)
    path = street.driven_path_m()
    kept = sum(measures.common_ids(thing, results, path) != set() for thing in street.THINGS)
    ghosts = {frame for frame, *_ in measures.ghosts_on_the_road(results, path)}
    ids_of_things = [measures.ids_of(thing, results, path) for thing in street.THINGS]
    seen: dict[int, int] = {}
    for result in results:
        for obstacle in result.obstacles:
            if obstacle.confirmed and not obstacle.coasting:
                seen[obstacle.id] = seen.get(obstacle.id, 0) + 1
    return {
        "variant": variant,
        "kept_of_12": kept,
        "ghost_frames": len(ghosts),
        "confirmed": len(seen),
        "seen_frames_median": float(np.median(list(seen.values()))) if seen else 0.0,
        "warned_frames": measures.warned_frames(results),
        "aside_frames": len({aside.frame for aside in measures.warnings_beside_the_path(results, path)}),
        "coasting_share": round(measures.coasting_share(results), 3),
        "ids_per_thing": round(float(np.mean([len(ids) for ids in ids_of_things])), 2),
        "host_ms": round(float(np.median([result.stage_ms["host"] for result in results])), 1),
    }


def table_of(rows: list[dict[str, Any]]) -> Table:
    cells = [(row["variant"], *(f"{row[key]:g}" for key in STATED)) for row in rows]
    return Table("street", ("variant", *STATED.values()), cells)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help="measure these only (default: all)")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="also write the figures")
    add_place(parser)
    arguments = parser.parse_args()
    if unknown := set(arguments.variants) - set(VARIANTS):
        parser.error(f"no variant {', '.join(sorted(unknown))}; there are: {', '.join(VARIANTS)}")
    if not street.SEQUENCE.is_dir():
        sys.exit(f"street_variants: no {street.SEQUENCE}")
    names = arguments.variants or list(VARIANTS)
    with exit_on_failure():
        rows = run(jobs_of(measure, names), chosen_place(arguments, 1), "measure", "variant")
    print(f"{'variant':38s} " + " ".join(f"{head:>9s}" for head in HEADS))
    for variant, *numbers in (row.values() for row in rows):
        print(f"{variant:38s} " + " ".join(f"{number:9g}" for number in numbers))
    if arguments.out is not None:
        found = {"sequence": "KITTI odometry 00, 51 frames", "variants": rows}
        write_measurement(arguments.out, [table_of(rows)], found)


if __name__ == "__main__":
    main()
