"""Render the demo's flight: python -m vista_eval.worlds.demo OUT_DIR"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from vista_eval.render.flight import Flight, is_complete, render_flight
from vista_eval.render.trajectory import FOOT_M, Approach
from vista_eval.worlds.meadow_flights import sign_site

# 30 ft/s at 21 ft straight at the sign, from 58 m to 22 m.
SIGN_AT_30_FT_S = Flight(
    "demo",
    "sign at 30 ft/s",
    "dev",
    Approach(21 * FOOT_M, 30 * FOOT_M, last_range_m=22.0, frames=40, rate_hz=10.0),
    sign_site,
)


def main() -> int:
    parser = argparse.ArgumentParser(prog="vista_eval.worlds.demo", description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT_DIR")
    out = parser.parse_args().out
    flight = SIGN_AT_30_FT_S
    try:
        if not is_complete(flight, out):
            frames = render_flight(flight, out)
            for _ in tqdm(frames, total=flight.approach.frames, desc="rendering the flight", unit="frame"):
                pass
    except OSError as error:
        print(f"vista_eval.worlds.demo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the next run goes on from here", file=sys.stderr)
        return 130
    print(f"flight of {flight.approach.frames} stereo frames in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
