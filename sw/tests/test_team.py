"""A second thread (host.threads): who does which part, the same results, no race, and an end."""

from __future__ import annotations

import gc
import os
import shutil
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import recording_cases
from board_flight import BoardFrame, board_flight
from pipeline_library import CALIBRATION, Frame, Pipeline, default_parameters
from random_seed import seeded
from stage_library import Arena, ffi, lib, status_name
from tools import digest_of, made_once
from vista import parameters
from vista import pipeline as product

REPOSITORY = Path(__file__).resolve().parents[2]


def threads_of_process() -> set[str]:
    return {path.name for path in Path("/proc/self/task").iterdir()}


def are_gone(threads: set[str]) -> bool:
    """The system may take a moment to forget a thread that has ended and been joined."""
    end_s = time.monotonic() + 30.0
    while threads & threads_of_process() and time.monotonic() < end_s:
        time.sleep(0.01)
    return not threads & threads_of_process()


# ---- parts ----


class Team:
    """A team in memory of its own."""

    def __init__(self, workers: int) -> None:
        self.c = ffi.new("vista_team *")
        self.arena = Arena(lambda arena: lib.vista_team_layout(workers, arena, self.c))
        assert status_name(lib.vista_team_start(self.c)) == "VISTA_OK"

    def __enter__(self) -> Team:
        return self

    def __exit__(self, *_: object) -> None:
        lib.vista_team_stop(self.c)

    def share(self, do_part, count: int) -> None:
        as_c = ffi.callback("void(void *, int32_t, int32_t)")
        callback = as_c(lambda _, part, worker: do_part(part, worker))
        lib.vista_team_share(self.c, callback, ffi.NULL, count)


@pytest.mark.parametrize("workers", [1, 2])
def test_every_part_is_done_once(workers: int) -> None:
    rng = seeded(1)
    with Team(workers) as team:
        for count in [0, 1, 2, *rng.integers(3, 60, 20).tolist()]:
            done: list[tuple[int, int]] = []
            team.share(lambda part, worker, done=done: done.append((part, worker)), count)
            assert sorted(part for part, _ in done) == list(range(count))
            assert all(0 <= worker < workers for _, worker in done)


def test_both_threads_work_at_once() -> None:
    both = threading.Barrier(2, timeout=60)
    seen: dict[int, int] = {}

    def meet(_: int, worker: int) -> None:
        both.wait()  # only two threads get past it
        seen[worker] = threading.get_ident()

    with Team(2) as team:
        for _ in range(20):
            team.share(meet, 2)
    assert set(seen) == {0, 1} and len(set(seen.values())) == 2 and seen[0] == threading.get_ident()


def test_a_part_that_shares_does_its_parts_alone() -> None:
    inner: list[tuple[int, int, int, int]] = []
    with Team(2) as team:

        def outer(part: int, _: int) -> None:
            here = threading.get_ident()
            team.share(lambda k, w: inner.append((part, k, w, int(threading.get_ident() == here))), 3)

        team.share(outer, 4)
    assert sorted(inner) == [(part, k, 0, 1) for part in range(4) for k in range(3)]


def test_the_helper_may_come_too_late() -> None:
    """A thread that is not there yet, or not woken, costs time and no result."""
    for _ in range(50):
        done: list[int] = []
        with Team(2) as team:
            team.share(lambda part, _, done=done: done.append(part), 2)
        assert sorted(done) == [0, 1]


def test_only_one_or_two_workers() -> None:
    arena, team = ffi.new("vista_arena *"), ffi.new("vista_team *")
    for workers in (-1, 0, 3):
        assert status_name(lib.vista_team_layout(workers, arena, team)) == "VISTA_ERROR_RANGE"


# ---- the pipeline ----


def shuffled(frame: BoardFrame, rng: np.random.Generator) -> BoardFrame:
    """The frame with noise in image and words: many more regions, and some of each verdict."""
    left = np.clip(frame.left + rng.normal(0, rng.uniform(0, 30), frame.left.shape), 0, 255).astype(np.uint8)
    words = frame.words.copy()
    top, at = int(rng.integers(0, 60)), int(rng.integers(0, 100))
    words[top : top + 120, at : at + 90] += np.int16(rng.integers(0, 400))
    words[rng.random(words.shape) < rng.uniform(0, 0.3)] = -16
    return BoardFrame(**{**vars(frame), "left": left, "words": words})


def test_the_same_results_with_two_threads() -> None:
    rng = seeded(2)
    frames = [shuffled(frame, rng) for frame in board_flight()[:8]] + list(board_flight()[8:12])
    results = []
    for threads in (1, 2):
        pipeline = Pipeline(default_parameters(host__threads=threads))
        assert pipeline.status == "VISTA_OK"
        seen = []
        for source, snapshot in zip(frames, pipeline.fly(frames), strict=True):
            views = pipeline.result.views
            pixels = bytes(ffi.buffer(views.region_of_pixel, 4 * source.left.size))
            seen.append((snapshot, pixels, pipeline.result.path_seen_m))
        lib.vista_pipeline_destroy(pipeline.handle)
        assert pipeline.guards_hold
        results.append(seen)
    assert results[0] == results[1]
    assert any(snapshot["accepted_count"] for snapshot, _, _ in results[0])


def test_a_refused_frame_is_refused_and_the_next_one_works() -> None:
    first, second = board_flight()[:2]
    pipeline = Pipeline(default_parameters(host__threads=2))
    assert pipeline.process(Frame(second)) == "VISTA_OK"
    assert pipeline.process(Frame(first)) == "VISTA_ERROR_ORDER"
    third = board_flight()[2]
    assert pipeline.process(Frame(third)) == "VISTA_OK"
    lib.vista_pipeline_destroy(pipeline.handle)


def test_the_thread_ends_with_its_pipeline() -> None:
    before = threads_of_process()
    pipelines = [Pipeline(default_parameters(host__threads=2)) for _ in range(3)]
    started = threads_of_process() - before
    assert len(started) == 3
    for pipeline in pipelines:
        lib.vista_pipeline_destroy(pipeline.handle)
    assert are_gone(started)
    before = threads_of_process()
    alone = Pipeline(default_parameters(host__threads=1))
    assert threads_of_process() <= before
    lib.vista_pipeline_destroy(alone.handle)  # nothing to end
    lib.vista_pipeline_destroy(ffi.NULL)


def test_python_ends_the_thread_with_the_object() -> None:
    before = threads_of_process()
    values = parameters.defaults()
    values = values | {"host": values["host"] | {"threads": 2}}
    pipeline = product.Pipeline(CALIBRATION, values)
    started = threads_of_process() - before
    assert len(started) == 1
    del pipeline
    gc.collect()
    assert are_gone(started)


def processor_s(threads: set[str]) -> float:
    """Time that these threads of the process have had a processor for."""
    stats = [Path(f"/proc/self/task/{thread}/stat").read_text() for thread in threads]
    ticks = sum(int(field) for stat in stats for field in stat.rpartition(")")[2].split()[11:13])
    return ticks / os.sysconf("SC_CLK_TCK")


def test_the_thread_sleeps_between_frames() -> None:
    before = threads_of_process()
    pipeline = Pipeline(default_parameters(host__threads=2))
    started = threads_of_process() - before
    assert pipeline.process(Frame(board_flight()[0])) == "VISTA_OK"
    start_s = processor_s(started)
    time.sleep(0.5)
    assert len(started) == 1
    assert processor_s(started) - start_s < 0.1  # a thread that waits busily takes all of it
    lib.vista_pipeline_destroy(pipeline.handle)


def built_for_races() -> Path:
    """vista-fly with ThreadSanitizer, compiled anew where a source has changed."""
    of_sources = [REPOSITORY / folder for folder in ("sw/apps/fly", "sw/src", "model/c/src")]
    of_headers = [REPOSITORY / folder for folder in ("sw/include", "model/c/include", "rtl/csr", "rtl/board")]
    sources = [str(path) for folder in of_sources for path in sorted(folder.rglob("*.c"))]
    headers = [path for folder in (*of_sources, *of_headers) for path in sorted(folder.rglob("*.h"))]
    folder = REPOSITORY / "build" / "races"
    program = folder / "vista-fly"
    command = ["gcc", "-std=c17", "-O0", "-g", "-fsanitize=thread", "-ffp-contract=off"]
    command += [f"-I{place}" for place in (*of_headers, REPOSITORY / "sw/src")]
    command += ["-D_GNU_SOURCE=", "-Wno-tsan", *sources, "-o", str(program), "-lm", "-lpthread"]

    def make() -> None:
        built = subprocess.run(command, capture_output=True, text=True, check=False)
        if "tsan" in built.stderr:
            pytest.skip(f"no ThreadSanitizer here: {built.stderr.strip().splitlines()[-1]}")
        assert built.returncode == 0, built.stderr

    return made_once(program, folder, digest_of([*map(Path, sources), *headers], *command), make)


@pytest.mark.slow
@pytest.mark.skipif("asan" in os.environ.get("LD_PRELOAD", ""), reason="built for another sanitizer")
def test_no_data_race(tmp_path: Path) -> None:
    """vista-fly under ThreadSanitizer."""
    program = built_for_races()
    rng = seeded(3)
    flown = recording_cases.record(
        tmp_path / "board.rec", [shuffled(frame, rng) for frame in board_flight()[:4]], levels=3
    )
    # Its shadow memory asks for addresses that are not drawn at random.
    fixed = ["setarch", "-R"] if shutil.which("setarch") else []
    run = subprocess.run(
        [
            *fixed,
            str(program),
            "--recording",
            str(flown),
            "--all-frames",
            "--threads",
            "2",
            "--watchdog",
            "60",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "ThreadSanitizer" not in run.stderr, run.stderr
