"""Render the demo's flight: python -m vista.flights.demo OUT_DIR"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from .flight import SIGN_AT_30_FT_S, is_complete, render_flight


def main() -> int:
    parser = argparse.ArgumentParser(prog="vista.flights.demo", description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT_DIR")
    out = parser.parse_args().out
    flight = SIGN_AT_30_FT_S
    try:
        if not is_complete(flight, out):
            frames = render_flight(flight, out)
            for _ in tqdm(frames, total=flight.approach.frames, desc="rendering the flight", unit="frame"):
                pass
    except OSError as error:
        print(f"vista.flights.demo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the next run goes on from here", file=sys.stderr)
        return 130
    print(f"flight of {flight.approach.frames} stereo frames in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
