"""Render the demo's flight: python -m vista_eval.worlds.demo OUT_DIR"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from vista_eval.jobs import add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.render.flight import frames_of, is_complete, prepare, render_flight, render_frame
from vista_eval.worlds.farm import SIGN_AT_30_FT_S


def main() -> int:
    parser = argparse.ArgumentParser(prog="vista_eval.worlds.demo", description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT_DIR")
    add_place(parser)
    arguments = parser.parse_args()
    flight, out = SIGN_AT_30_FT_S, arguments.out
    frames = range(frames_of(flight))
    try:
        with exit_on_failure():
            if not is_complete(flight, out):
                prepare(flight, out)
                jobs = jobs_of(partial(render_frame, flight, out, "full"), frames, "frame {}".format)
                run(jobs, chosen_place(arguments), "render the flight", "frame")
                list(render_flight(flight, out))
    except OSError as error:
        print(f"vista_eval.worlds.demo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the next run goes on from here", file=sys.stderr)
        return 130
    print(f"flight of {len(frames)} stereo frames in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
