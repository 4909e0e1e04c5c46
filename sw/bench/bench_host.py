"""The host on real images: vista-fly over recorded words, foveation to map, with one thread and with two.

What is measured:
  street          KITTI odometry 00, 51 frames of 1226x370 as they are
  street 640x480  the middle 493x370 of the same, both images enlarged to 640x480: the size of the targets
  oak-d           11 indoor pairs of 640x480 (make demo-pairs fetches them), each judged by itself
What is not there is left out; without any of them a synthetic flight stands in, and the table says so.

The stages are those of one thread; of two, wall time of the whole and processor time of both threads together
stand beside it. Blocks with one thread and with two take turns.

The recording is played in blocks; a block is the whole sequence REPEATS times over. Processor time counts
only this program's work; wall time, in which the stages are clocked, also counts what else the machine does.
Medians and 99th percentiles over all frames; the spread is that of the blocks' own figures, smallest to
largest. The share of a stage is that of the host's time for the same frame.

    bench_host.py [--blocks 5] [--repeats 4] [--out build/bench/host.json]
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "sw" / "tests"), str(REPOSITORY / "build" / "python")]

import recording_cases  # noqa: E402
from board_flight import board_flight  # noqa: E402
from shared_data import SHARED_DATA  # noqa: E402
from vista import parameters  # noqa: E402
from vista.chain import engine_parameters  # noqa: E402
from vista.engine import create_engine  # noqa: E402
from vista.geometry import Calibration  # noqa: E402
from vista.pipeline import Pipeline  # noqa: E402
from vista.recording import HEAD, Content, Recorder, played, rectified_source  # noqa: E402
from vista.rectify import Rectifier  # noqa: E402
from vista.sequence import Frame, Sequence, open_sequence  # noqa: E402
from vista_eval.report.table import Table, span, write_measurement  # noqa: E402

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
PAIRS = REPOSITORY / "build" / "demo" / "oak-d"
TITLES = {
    "street": "KITTI odometry 00, 1226x370",
    "street 640x480": "the middle of the same images, enlarged to 640x480",
    "oak-d": "OAK-D pairs, 640x480",
}
MEDIAN_MAX_MS = {"street": 10.0, "street 640x480": 7.0}  # targets
NODES_MIN, P99_RATIO_MAX = 5000, 2.0

Image = NDArray[np.uint8]
Samples = dict[str, NDArray[np.float64]]  # by stage: one a frame


# ---- recordings ----


def middle(camera: Calibration, width: int, height: int) -> tuple[Calibration, slice, float]:
    """The camera of the widest middle cut of that shape, scaled to it; the columns; the scale."""
    columns = round(camera.height * width / height)
    first = (camera.width - columns) // 2
    scale = height / camera.height
    # Pixel centres: the left edge of pixel 0 lies at -0.5.
    center = ((camera.cx - first + 0.5) * scale - 0.5, (camera.cy + 0.5) * scale - 0.5)
    cut = Calibration(width, height, camera.focal_px * scale, *center, camera.baseline_m)
    return cut, slice(first, first + columns), scale


def frames_of(sequence: Sequence, rectifier: Rectifier) -> Iterator[Frame]:
    return (rectifier.rectify(sequence.read(files)) for files in sequence.frames)


def enlarged(frame: Frame, columns: slice, size: tuple[int, int]) -> Frame:
    def one(image: Image) -> Image:
        cut = np.ascontiguousarray(image[:, columns])
        return cv2.resize(cut, size, interpolation=cv2.INTER_LINEAR).astype(np.uint8, copy=False)

    return replace(frame, left=one(frame.left), right=one(frame.right))


def record(path: Path, folder: Path, size: tuple[int, int] | None = None) -> Path:
    """size: (width, height) to which the middle of the images is brought; None: as they are."""
    sequence = open_sequence(folder)
    rectifier, values = Rectifier(sequence.calibration), parameters.defaults()
    if sequence.stills:
        values["tracker"] |= {"confirm_hits": 1, "confirm_window": 1}
    engine = create_engine("golden", engine_parameters(values))
    camera, columns = rectifier.calibration, slice(None)
    if size is not None:
        camera, columns, _ = middle(camera, *size)
    source = rectified_source(camera, sequence.stills, sequence.up_world)
    with Recorder(path, source, Rectifier(source.calibration), values, Content.PAIR) as recorder:
        for frame in frames_of(sequence, rectifier):
            seen = frame if size is None else enlarged(frame, columns, size)
            recorder.write(seen, list(engine.levels(seen.left, seen.right)), sequence.stills)
    return path


def recordings(folder: Path) -> Iterator[tuple[str, Path]]:
    found = False
    if STREET.is_dir():
        found = True
        yield "street", record(folder / "street.rec", STREET)
        yield "street 640x480", record(folder / "street_vga.rec", STREET, (640, 480))
    if (PAIRS / "calibration.toml").is_file():
        found = True
        yield "oak-d", record(folder / "oak-d.rec", PAIRS)
    if not found:
        yield "synthetic 320x240", recording_cases.record(folder / "board.rec", board_flight())


# ---- measurement ----


def play(path: Path, repeats: int, threads: int) -> tuple[Samples, list[dict]]:
    """Milliseconds of every frame by stage, and the frames of one run."""
    samples, lines = played(path, repeats, threads)
    beside = ("rectify", "stereo", "alignment", "watch", "latency")
    host = {name: ms for name, ms in samples.items() if name not in beside}
    frames = [json.loads(line) for line in lines[: len(lines) // repeats]]
    return host, [frame | {"processing_ms": 0.0} for frame in frames]


def nodes_of(path: Path) -> int:
    """The number of cells that the images of a recording have."""
    head = HEAD.unpack(path.read_bytes()[: HEAD.size])
    camera = Calibration(*head[2:4], *head[9:13])
    blank = np.zeros((camera.height, camera.width), np.uint8)
    return Pipeline(camera).process(blank, blank.astype(np.int16) - 1, 0).cell_intensity.size


def figures(samples_ms: NDArray[np.float64]) -> dict[str, float]:
    median, p99 = np.percentile(samples_ms, [50, 99])
    return {
        "median_ms": float(median),
        "p99_ms": float(p99),
        "p99_over_median": float(p99 / median) if median > 0.0 else 0.0,
        "median_hz": float(1e3 / median) if median > 0.0 else 0.0,
    }


def stage_figures(samples: list[Samples], stage: str) -> dict:
    of_blocks = [figures(block[stage]) for block in samples]
    spread = {
        key: [min(block[key] for block in of_blocks), max(block[key] for block in of_blocks)]
        for key in of_blocks[0]
    }
    return figures(np.concatenate([block[stage] for block in samples])) | {"spread": spread}


def share_of_host(samples: list[Samples], stage: str) -> dict[str, float]:
    shares = np.concatenate([block[stage] / block["host"] for block in samples])
    share, share_p99 = np.percentile(shares, [50, 99])
    return {"share": float(share), "share_p99": float(share_p99)}


def measure(path: Path, blocks: int, repeats: int) -> dict:
    runs = [[play(path, repeats, threads) for threads in (1, 2)] for _ in range(blocks)]
    alone, helped = ([block[k][0] for block in runs] for k in (0, 1))
    frames = runs[0][0][1]
    if any(run != frames for block in runs for _, run in block):
        raise SystemExit(f"bench_host: {path.name}: two threads give other results than one")
    return {
        "frames": len(frames),
        "blocks": blocks,
        "repeats": repeats,
        "nodes": nodes_of(path),
        "regions_median": float(np.median([frame["regions"] for frame in frames])),
        "stages": {stage: stage_figures(alone, stage) | share_of_host(alone, stage) for stage in alone[0]},
        "two_threads": {stage: stage_figures(helped, stage) for stage in ("host", "cpu")},
    }


# ---- the table ----


def with_spread(stage: dict, key: str) -> str:
    low, high = stage["spread"][key]
    return f"{stage[key]:8.3f} ({low:.3f} .. {high:.3f})"


def row(name: str, stage: dict) -> str:
    medians, p99s = with_spread(stage, "median_ms"), with_spread(stage, "p99_ms")
    shares = f"{stage['share']:6.1%} ({stage['share_p99']:.1%})"
    return f"  {name:16s}{medians:28s}{p99s:30s}{stage['p99_over_median']:6.2f}     {shares}"


def summary(name: str, sequence: str, stage: dict) -> str:
    limit_ms = MEDIAN_MAX_MS.get(sequence)
    target = f", target <= {limit_ms:.0f} ms" if limit_ms is not None else ""
    return (
        f"  {name:16s}{stage['median_ms']:6.2f} ms{target}, {stage['median_hz']:.1f} Hz; "
        f"p99/median {stage['p99_over_median']:.2f}, target < {P99_RATIO_MAX:.0f}"
    )


def table(name: str, result: dict) -> str:
    stages = result["stages"]
    lines = [
        f"{name}: {result['frames']} frames, {result['regions_median']:.0f} regions, "
        f"{result['blocks']} blocks of {result['repeats']} runs",
        f"  {'stage, wall':18s}{'median ms (of blocks)':28s}{'p99 ms (of blocks)':28s}p99/median share (p99)",
        *(row(stage, stages[stage]) for stage in stages if stage != "cpu"),
        row("processor time", stages["cpu"]),
        summary("host, wall", name, stages["host"]),
        summary("host, processor", name, stages["cpu"]),
        summary("two threads", name, result["two_threads"]["host"]),
        f"  {'both, processor':16s}{result['two_threads']['cpu']['median_ms']:6.2f} ms",
        f"  {'nodes':16s}{result['nodes']:6d}, target >= {NODES_MIN}",
    ]
    return "\n".join(lines) + "\n"


def table_of_sequences(results: dict[str, dict]) -> Table:
    rows = []
    for name, sequence in results.items():
        for threads, host in (("1", sequence["stages"]["host"]), ("2", sequence["two_threads"]["host"])):
            of_blocks = span([round(t, 1) for t in host["spread"]["median_ms"]])
            rows.append(
                (
                    TITLES.get(name, name),
                    str(sequence["frames"]),
                    f"{sequence['nodes']:,}",
                    threads,
                    f"{host['median_ms']:.1f} ({of_blocks})",
                    f"{host['p99_over_median']:.1f}",
                    f"{host['median_hz']:.0f}",
                )
            )
    heads = ("images", "frames", "graph nodes", "threads", "ms: median (of the blocks)")
    return Table("host", (*heads, "99th percentile / median", "frames/s"), rows)


def table_of_stages(results: dict[str, dict]) -> Table:
    stages = {name: found["stages"] for name, found in results.items()}
    rows = []
    for stage in next(iter(stages.values())):
        cells = [stage]
        for times in stages.values():
            median_ms, host_ms = times[stage]["median_ms"], times["host"]["median_ms"]
            cells += [f"{median_ms:.1f} ({times[stage]['p99_ms']:.1f})", f"{100 * median_ms / host_ms:.0f} %"]
        if stage not in ("host", "cpu"):
            rows.append(tuple(cells))
    heads = [f"{TITLES.get(name, name)}: ms, median (p99) | share".split(" | ") for name in stages]
    return Table("stages", ("stage", *(head for both in heads for head in both)), rows)


def front_page(results: dict[str, dict]) -> tuple[str, str]:
    alone, helped = (
        [results[name][of]["host"]["median_ms"] for name in ("street", "street 640x480")]
        for of in ("stages", "two_threads")
    )
    return "host on a street", (
        f"{alone[0]:.0f} ms a frame of 1226x370, {alone[1]:.0f} ms of 640x480, on one core; {helped[0]:.0f} "
        f"and {helped[1]:.0f} ms with a second thread on another (the paper: 100 to 200 ms)"
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=4)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    results = {}
    print(f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors\n")
    with tempfile.TemporaryDirectory() as scratch:
        for name, path in recordings(Path(scratch)):
            results[name] = measure(path, arguments.blocks, arguments.repeats)
            print(table(name, results[name]), flush=True)
            path.unlink()
    targets = {
        "median_max_ms": MEDIAN_MAX_MS,
        "nodes_min": NODES_MIN,
        "p99_over_median_max": P99_RATIO_MAX,
    }
    if arguments.out is not None:
        tables = [table_of_sequences(results), table_of_stages(results)]
        headline = front_page(results) if STREET.is_dir() else None
        write_measurement(arguments.out, tables, {"sequences": results}, headline, targets=targets)
    return 0


if __name__ == "__main__":
    sys.exit(main())
