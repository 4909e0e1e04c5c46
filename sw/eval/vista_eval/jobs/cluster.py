"""Jobs on a Dask cluster. What it loses when a scheduler or a worker dies is made again; results are kept by
the process that asks, so that no job counts twice and workers need not share a file system with it."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from functools import cache, partial
from threading import Lock
from time import monotonic, sleep
from typing import Any

from vista.errors import InputError

try:
    from distributed import Client, KilledWorker, as_completed, get_worker
except ModuleNotFoundError:
    raise InputError(
        "--cluster", "needs the extra [cluster]: pip install 'vista-stereo-eval[cluster]'"
    ) from None

from vista_eval.cache import PACKAGES, code_digest
from vista_eval.jobs.job import Failure, Job, Outcome, attempt

CONNECT_S = 10.0  # for the first answer of the scheduler
PATIENCE_S = 120.0  # for one that is started again
ONE_AT_A_TIME = Lock()  # native libraries and the renderer: one job in a process, whatever threads it has


def on_cluster(jobs: Sequence[Job], address: str) -> Iterator[tuple[int, Outcome]]:
    """Each job's place in the list and its outcome, as they come. Raises InputError when no scheduler
    answers, or not again."""
    for name in ("distributed", "distributed.client", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what is lost is our concern
    waiting = dict(enumerate(jobs))
    wait_s = CONNECT_S
    while waiting:
        with connect(address, wait_s) as client:
            for number, outcome in of_one_connection(client, waiting):
                del waiting[number]
                yield number, outcome
        wait_s = PATIENCE_S


def connect(address: str, wait_s: float) -> Client:
    until_s = monotonic() + wait_s
    while True:
        try:
            client = Client(address, timeout=min(wait_s, CONNECT_S), set_as_default=False)
            break
        except ValueError as error:  # the address is none
            raise InputError(f"--cluster {address}", str(error)) from None
        except OSError:
            if monotonic() >= until_s:
                reason = f"no scheduler answers within {wait_s:.0f} s"
                raise InputError(f"--cluster {address}", reason) from None
            sleep(0.2)
    return client


def of_one_connection(client: Client, waiting: dict[int, Job]) -> Iterator[tuple[int, Outcome]]:
    """Ends when all are done, or when the connection is lost."""
    numbers, jobs = list(waiting), list(waiting.values())
    keys = [(f"vista-{client.id}", number) for number in numbers]
    made = client.map(attempt_there, jobs, [code_of(job) for job in jobs], key=keys, pure=False)
    futures = dict(zip(made, numbers, strict=True))
    del made
    for batch in as_completed(
        list(futures), loop=client.loop, with_results=True, raise_errors=False
    ).batches():
        for future, result in batch:
            number = futures.pop(future)
            if future.status == "finished":
                yield number, result
            elif future.status == "error":
                yield number, failure_of(waiting[number], result[1])
            else:
                return
            future.release()


def failure_of(job: Job, error: BaseException) -> Failure:
    """The failure of a job that Dask gave up."""
    if isinstance(error, KilledWorker):
        return Failure(job.name, f"its worker died, {error.allowed_failures + 1} times in all")
    return Failure(job.name, " ".join(f"{type(error).__name__}: {error}".split()))


def attempt_there(job: Job, code: tuple[str, str] | None) -> Outcome:
    """Attempts a job on a worker. Results are kept under the digest of the code of the process that asks: a
    worker with other code must not add to them."""
    with ONE_AT_A_TIME:
        if code is not None and code_digest(code[0]) != code[1]:
            return Failure(job.name, f"worker {get_worker().address} has another version of {code[0]}")
        return attempt(job)


def code_of(job: Job) -> tuple[str, str] | None:
    """Name and digest of the module that does the work, if it is one of ours."""
    work: Any = job.work
    while isinstance(work, partial):
        work = work.func
    module = work.__module__
    return (module, digest_here(module)) if module.split(".")[0] in PACKAGES else None


@cache
def digest_here(module: str) -> str:
    return code_digest(module)
