"""Jobs in processes of this machine, by concurrent.futures.

Each worker is a pool of one process that is given one job at a time, so that its death costs that job alone.
"""

from __future__ import annotations

import os
import pickle
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import active_children, get_context, parent_process
from threading import Thread

from vista_eval.jobs.job import ATTEMPTS, Failure, Job, Outcome, attempt_pickled, described

# A new interpreter for each: a fork would inherit threads of OpenCV in an unknown state.
CONTEXT = get_context("spawn")


def in_processes(jobs: Sequence[Job], count: int) -> Iterator[tuple[int, Outcome]]:
    """Each job's place in the list and its outcome, as they come."""
    waiting, deaths = deque(range(len(jobs))), Counter[int]()
    idle = [pool() for _ in range(count)]
    busy: dict[Future[bytes], tuple[ProcessPoolExecutor, int]] = {}
    try:
        while waiting or busy:
            while waiting and idle:
                number = waiting.popleft()
                try:
                    work = pickle.dumps(jobs[number].work)
                except Exception as error:
                    text = f"it cannot be sent to another process: {described(error)}"
                    yield number, Failure(jobs[number].name, text)
                    continue
                worker = idle.pop()
                busy[worker.submit(attempt_pickled, jobs[number].name, work)] = worker, number
            for done in wait(busy, return_when=FIRST_COMPLETED).done:
                worker, number = busy.pop(done)
                try:
                    outcome: Outcome = pickle.loads(done.result())
                except BrokenProcessPool:
                    worker = pool()
                    deaths[number] += 1
                    outcome = Failure(jobs[number].name, f"its worker died in each of {ATTEMPTS} attempts")
                idle.append(worker)
                if deaths[number] in (0, ATTEMPTS) or not isinstance(outcome, Failure):
                    yield number, outcome
                else:
                    waiting.appendleft(number)
    finally:
        if busy:  # whoever asked was interrupted
            for process in active_children():
                with suppress(OSError):
                    os.killpg(process.pid or 0, signal.SIGTERM)
        for worker in [*idle, *(worker for worker, _ in busy.values())]:
            worker.shutdown(cancel_futures=True)


def pool() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, CONTEXT, initializer=begin)


def begin() -> None:
    """Make a worker a group of its own, which is ended with all that its job has started: by the process that
    asks, at a Ctrl-C too, or when that process is no more."""
    with suppress(OSError):
        os.setpgid(0, 0)
    Thread(target=end_with_parent, daemon=True).start()


def end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.killpg(0, signal.SIGKILL)
