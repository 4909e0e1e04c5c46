"""How long vista-fly takes over a mix of recordings, for an hour, while other programs want the processors.

The recordings take turns in an order that is drawn, each for some seconds in a vista-fly of its own, as fast
as they were taken; where a frame takes too long, the next one gives way to a newer one, as in flight.
Meanwhile so many programs as --load says compute without a pause. Prints two tables, and with --save writes
them: times of the engine, the host and the processor and the latency from the exposure to the result, over
all frames; and the latency by recording.

    soak_times.py SEQUENCE ... [--duration 3600] [--slice 30] [--load 1] [--seed 1] [--save FILE.json]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from vista.errors import InputError
from vista.recording import played
from vista_eval.report.table import Table, write_measurement

Samples = dict[str, NDArray[np.float64]]  # milliseconds of each frame
SHOWN = {"stereo": "engine", "host": "host", "cpu": "processor, all threads", "latency": "exposure to result"}
BUSY = "while True: pass"


@contextmanager
def loaded(programs: int) -> Iterator[None]:
    busy = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(programs)]
    try:
        yield
    finally:
        for one in busy:
            one.kill()
            one.wait()


def prepare(sequence: Path, folder: Path) -> Path:
    command = [sys.executable, "-m", "vista", "prepare", str(sequence), "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise InputError("vista prepare", done.stderr.strip().removeprefix("vista: "))
    return folder / "frames.vista"


def passes_of(recording: Path, slice_s: float) -> int:
    """How often a recording is played to fill a slice of time."""
    start_s = time.monotonic()
    played(recording, 1, paced=True)
    return max(1, round(slice_s / (time.monotonic() - start_s)))


def turns(names: list[str], random: np.random.Generator) -> Iterator[str]:
    """The recordings in an order that is drawn anew each time that all have had their turn, without end."""
    while True:
        yield from map(str, random.permutation(names))


def row(name: str, ms: NDArray[np.float64]) -> tuple[str, ...]:
    median, p99, p999 = np.percentile(ms, [50.0, 99.0, 99.9])
    most = float(ms.max())
    times = (f"{value:.1f}" for value in (median, p99, p999, most))
    return (name, str(len(ms)), *times, f"{most / median:.1f}")


HEADS = ("frames", "ms: median", "p99", "p99.9", "most", "most / median")


def tables(flown: dict[str, list[Samples]], given: int) -> list[Table]:
    of_all = [samples for found in flown.values() for samples in found]
    whole = [row(SHOWN[key], np.concatenate([samples[key] for samples in of_all])) for key in SHOWN]
    taken = sum(len(samples["host"]) for samples in of_all)
    whole.append(("frames that gave way to newer ones", str(given - taken), *[""] * 5))
    single = [
        row(name, np.concatenate([samples["latency"] for samples in found]))
        for name, found in sorted(flown.items())
        if found
    ]
    return [Table("mixed", ("of", *HEADS), whole), Table("mixed-recordings", ("recording", *HEADS), single)]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sequence", nargs="+", type=Path, help="recordings, as `vista run` takes them")
    parser.add_argument(
        "--duration", type=float, default=3600.0, metavar="S", help="of it all (default 3600)"
    )
    parser.add_argument("--slice", type=float, default=30.0, metavar="S", help="of a turn (default 30)")
    parser.add_argument(
        "--load", type=int, default=1, metavar="N", help="programs that compute meanwhile (default 1)"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the order of the recordings (default 1)")
    parser.add_argument("--save", type=Path, metavar="FILE.json", help="where to write the tables")
    arguments = parser.parse_args()
    names = [path.name for path in arguments.sequence]
    if len(set(names)) < len(names):
        parser.error("two recordings have the same name")
    random = np.random.default_rng(arguments.seed)
    flown: dict[str, list[Samples]] = {name: [] for name in names}
    given = 0
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        recordings = {path.name: prepare(path, scratch / path.name) for path in arguments.sequence}
        passes = {name: passes_of(path, arguments.slice) for name, path in recordings.items()}
        frames = {name: len(played(path, 1)[1]) for name, path in recordings.items()}
        stack.enter_context(loaded(arguments.load))
        end_s = time.monotonic() + arguments.duration
        for name in turns(names, random):
            samples, _ = played(recordings[name], passes[name], paced=True)
            flown[name].append(samples)
            given += passes[name] * frames[name]
            if time.monotonic() >= end_s:
                break
    found = tables(flown, given)
    print("\n\n".join(table.as_text() for table in found))
    if arguments.save is not None:
        write_measurement(arguments.save, found)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(f"soak_times: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
