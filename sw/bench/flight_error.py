"""Position error of a flight's obstacle against its truth: |P - P^| beside dz(r) = r^2 / (B f), by frames.

usage: flight_error.py FLIGHT RESULT    FLIGHT holds truth.json, RESULT the obstacles.jsonl of `vista run`"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

FOOT_M = 0.3048


def main() -> None:
    flight, result = map(Path, sys.argv[1:])
    truth = json.loads((flight / "truth.json").read_text())
    target = np.array(next(o["position_m"] for o in truth["objects"] if o["target"]))
    fb = truth["rig"]["focal_px"] * truth["rig"]["baseline_m"]
    lines = [json.loads(line) for line in (result / "obstacles.jsonl").read_text().splitlines()]
    warnings = [line["nearest_collision"] for line in lines if line["nearest_collision"]]
    error_m = np.array([np.linalg.norm(w["position_m"] - target) for w in warnings])
    range_m = np.array([w["distance_m"] for w in warnings])
    dz_m = range_m**2 / fb
    for r, e, dz in zip(range_m, error_m, dz_m, strict=True):
        print(f"{r:6.1f} m   |P - P^| {e:5.2f} m   2 dz {2 * dz:5.2f} m")
    rms_m = np.sqrt(np.mean(error_m**2))
    print(
        f"{len(warnings)} of {len(lines)} frames warned, first at {range_m[0]:.1f} m, "
        f"ids {sorted({w['id'] for w in warnings})}; "
        f"RMS {rms_m:.2f} m ({rms_m / FOOT_M:.2f} ft), largest {error_m.max():.2f} m, "
        f"{100 * np.mean(error_m <= 2 * dz_m):.0f} % within 2 dz, median {np.median(error_m / dz_m):.2f} dz"
    )


if __name__ == "__main__":
    main()
