"""What each choice of the host is worth on the street of sw/tests/test_street.py (KITTI odometry 00).

usage: street_variants.py [VARIANT ...]

Per variant: things (of 12 picked by eye) that keep one id while in view; frames with an obstacle where the
car drove later; obstacles confirmed in all; median number of frames in which one was seen; host time."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import test_street as street
from vista import parameters

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
    "no relief": {
        "affinity": {"mu_depth_m": 0.0},
        "segmentation": {"seed_step_m": 0.0},
        "region": {"tolerance_m": 0.0},
    },
    "no merging": {"segmentation": {"merge_share": 1.0, "merge_ratio": 0.0}},
    "no surfaces": {"surface": {"horizontal_deg": 90.0}, "region": {"min_standing_fraction": 0.0}},
    "no height above ground": {"region": {"min_standing_fraction": 0.0}},
    "no edge consistency": {"region": {"min_inlier_fraction": 0.0}},
    "no boundary support": {"region": {"min_valid_fraction": 0.0}},
    "no confirmation": {"tracker": {"confirm_hits": 1, "confirm_window": 1}},
}


def measure(changes: dict[str, dict[str, object]]) -> str:
    values = parameters.defaults()
    for section, content in changes.items():
        values[section] |= content
    results = street.run_street(values)
    path = street.driven_path_m()
    kept = sum(street.common_ids(thing, results, path) != set() for thing in street.THINGS)
    ghosts = {frame for frame, *_ in street.ghosts_on_the_road(results, path)}
    seen: dict[int, int] = {}
    for result in results:
        for obstacle in result.obstacles:
            if obstacle.confirmed and not obstacle.coasting:
                seen[obstacle.id] = seen.get(obstacle.id, 0) + 1
    host_ms = np.median([result.stage_ms["host"] for result in results])
    life = np.median(list(seen.values())) if seen else 0
    return f"{kept:6d} {len(ghosts):7d} {len(seen):9d} {life:6.0f} {host_ms:8.1f}"


def main() -> None:
    if not street.SEQUENCE.is_dir():
        sys.exit(f"street_variants: no {street.SEQUENCE}")
    print(f"{'variant':38s} {'things':>6s} {'ghosts':>7s} {'confirmed':>9s} {'seen':>6s} {'host ms':>8s}")
    for name in sys.argv[1:] or VARIANTS:
        print(f"{name:38s} {measure(VARIANTS[name])}", flush=True)


if __name__ == "__main__":
    main()
