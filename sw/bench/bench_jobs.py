"""What a job costs besides its work: in this process, in two others, and on a Dask cluster of two workers.

The jobs return a small row at once, so that all that is measured is overhead. Per job: the wall time and the
processor time of the process that asks and, on the cluster, of the scheduler and of a worker. Processor times
hold on a busy machine, too. Beside them: a worker's start, what it takes to keep a row and to find it kept,
and to look at a file of a recording.

    bench_jobs.py [--jobs-measured 1000] [--out build/bench/jobs.json]
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "eval/tests"))

import job_examples
from dask_cluster import Cluster
from vista_eval.cache import digest_of
from vista_eval.jobs import HERE, Job, Place, jobs_of, run
from vista_eval.recordings.storage import content_of
from vista_eval.report.table import Table, fixed, write_measurement

FILES = 2000
MANY = 20  # times as many jobs where they cost little
WORKERS = 1000  # of a cluster that the costs of a job are reckoned up for


def cpu_s(pid: int) -> float:
    """Processor time of a process and its threads up to now."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(work: Callable[[], Any], pids: dict[str, int]) -> dict[str, float]:
    """Wall time, and processor time of each process, s."""
    pids = {"asking": os.getpid(), **pids}
    before, start_s = {name: cpu_s(pid) for name, pid in pids.items()}, time.perf_counter()
    work()
    wall_s = time.perf_counter() - start_s
    return {"wall": wall_s} | {name: cpu_s(pid) - before[name] for name, pid in pids.items()}


def per_job_ms(place: Place, count: int, pids: dict[str, int]) -> dict[str, float]:
    """Times a job by the difference of many jobs and a few, so that the start does not count."""
    few = count // 10
    work = [partial(run, jobs_of(job_examples.small_row, range(n)), place) for n in (few, count)]
    work[0]()  # modules are loaded
    start, whole = (measured(one, pids) for one in work)
    return {name: round(1e3 * (whole[name] - start[name]) / (count - few), 3) for name in whole}


def start_ms() -> float:
    """Times two processes that come at the same time."""
    spent = measured(partial(run, jobs_of(job_examples.small_row, range(2)), Place(2)), {})
    return round(1e3 * spent["wall"], 0)


def kept_ms(count: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        jobs = [Job(f"{k}", partial(job_examples.small_row, k), digest_of(f"{k}")) for k in range(count)]
        keep, find = (measured(partial(run, jobs, HERE, kept=Path(folder)), {}) for _ in range(2))
    return {"keep": round(1e3 * keep["asking"] / count, 3), "find": round(1e3 * find["asking"] / count, 3)}


def look_ms() -> float:
    """Times the look at one file of a recording on a local disk."""
    with tempfile.TemporaryDirectory() as folder:
        for k in range(FILES):
            Path(folder, f"{k:06d}_left.png").write_bytes(b"x")
        spent = measured(partial(content_of, folder, "."), {})
    return round(1e3 * spent["asking"] / FILES, 4)


def on_cluster(count: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder, Cluster(Path(folder), workers=0) as cluster:
        place = Place(cluster=cluster.address)
        workers = [cluster.start_worker(), cluster.start_worker()]
        run(jobs_of(job_examples.small_row, range(100)), place)  # both are there
        found = per_job_ms(place, count, {"scheduler": cluster.scheduler.pid, "worker": workers[0].pid})
    return {"per_job_ms": found}


def table_of_places(found: dict[str, Any]) -> Table:
    """Wall times only where no start of a process is in them."""
    rows = []
    for place in ("in this process", "two processes", "Dask, two workers"):
        ms = found[place]["per_job_ms"]
        rows.append((place, *(fixed(ms.get(name), 2) for name in ("asking", "scheduler", "worker"))))
    heads = ("processor time per job, ms", "process that asks", "scheduler", "one of the workers")
    return Table("jobs", heads, rows)


def table_of_limits(found: dict[str, Any]) -> Table:
    """What follows for a cluster from the costs of one job."""
    cluster, rows_ms = found["Dask, two workers"]["per_job_ms"], found["rows_ms"]
    busiest_ms = max(cluster["scheduler"], cluster["asking"] + rows_ms["keep"])
    rows = [
        ("jobs per second that the scheduler or the process that asks can take", f"{1e3 / busiest_ms:.0f}"),
        (
            f"mean length of a job at which {WORKERS:,} workers take a quarter of that",
            f"{4 * WORKERS * busiest_ms / 1e3:.0f} s",
        ),
        ("to look at a file of a recording on a local disk", f"{rows_ms['look at a file']:.3f} ms"),
        ("to find the row of a recording kept", f"{rows_ms['find']:.3f} ms"),
    ]
    return Table("jobs-limits", ("what", "figure"), rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--jobs-measured", type=int, default=1000, metavar="N")
    parser.add_argument("--out", type=Path, default=Path("build/bench/jobs.json"))
    arguments = parser.parse_args()
    count = arguments.jobs_measured
    found = {
        "in this process": {"per_job_ms": per_job_ms(HERE, MANY * count, {})},
        "two processes": {"per_job_ms": per_job_ms(Place(2), MANY * count, {}), "start_ms": start_ms()},
        "Dask, two workers": on_cluster(count),
        "rows_ms": kept_ms(count) | {"look at a file": look_ms()},
    }
    write_measurement(arguments.out, [table_of_places(found), table_of_limits(found)], found)
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
