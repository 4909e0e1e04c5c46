"""Jobs in processes of this machine.

Each process is given one job at a time, so that its death costs that job alone.
"""

from __future__ import annotations

import os
import pickle
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from vista_eval.jobs.job import ATTEMPTS, Failure, Job, Outcome, attempt_pickled, described, died

# A new interpreter for each: a fork would inherit threads of OpenCV and of the renderer in an unknown state.
CONTEXT = get_context("spawn")
PATIENCE_S = 5.0  # for a worker that is to leave


@dataclass
class Worker:
    process: SpawnProcess
    connection: Connection
    number: int | None = None  # of the job that it is at


def in_processes(jobs: Sequence[Job], count: int) -> Iterator[tuple[int, Outcome]]:
    """Each job's place in the list and its outcome, as they come."""
    waiting, deaths = deque(range(len(jobs))), Counter[int]()
    workers = [start() for _ in range(count)]
    try:
        while waiting or any(worker.number is not None for worker in workers):
            for worker in workers:
                if worker.number is None and waiting:
                    number = waiting.popleft()
                    failure = give(worker, number, jobs[number])
                    if failure is not None:
                        yield number, failure
            for worker, number in answering(workers):
                worker.number = None
                outcome = read(worker)
                if outcome is None:
                    deaths[number] += 1
                    how = end_of(worker)
                    workers[workers.index(worker)] = start()
                    if deaths[number] < ATTEMPTS:
                        waiting.appendleft(number)
                        continue
                    outcome = died(jobs[number].name, how)
                yield number, outcome
    finally:
        for worker in workers:
            stop(worker)


def start() -> Worker:
    ours, theirs = CONTEXT.Pipe()
    process = CONTEXT.Process(target=work_off, args=(theirs,))
    process.start()
    theirs.close()
    return Worker(process, ours)


def work_off(connection: Connection) -> None:
    """What a worker does until there is nothing more to do, or no one who asks for it."""
    with suppress(OSError):
        os.setpgid(0, 0)  # a Ctrl-C is for the process that asks, which then ends this group
    with suppress(EOFError, ConnectionError):
        while True:
            connection.send_bytes(attempt_pickled(*connection.recv()))


def give(worker: Worker, number: int, job: Job) -> Failure | None:
    try:
        pickled = pickle.dumps(job.work)
    except Exception as error:
        return Failure(job.name, f"it cannot be sent to another process: {described(error)}")
    worker.number = number
    with suppress(ConnectionError):  # it died: so says the next read
        worker.connection.send((job.name, pickled))
    return None


def answering(workers: Sequence[Worker]) -> list[tuple[Worker, int]]:
    """Waits for those that are done with their job, or dead; each with its job."""
    busy = [(worker, worker.number) for worker in workers if worker.number is not None]
    ready = wait([worker.connection for worker, _ in busy]) if busy else []
    return [(worker, number) for worker, number in busy if worker.connection in ready]


def read(worker: Worker) -> Outcome | None:
    """None: it died."""
    try:
        outcome: Outcome = pickle.loads(worker.connection.recv_bytes())
    except (EOFError, ConnectionError):
        return None
    return outcome


def end_of(worker: Worker) -> str:
    """The end of a worker that died, in words."""
    worker.connection.close()
    worker.process.join()
    code = worker.process.exitcode or 0
    return f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with status {code}"


def stop(worker: Worker) -> None:
    """One that is at nothing leaves by itself; one at a job is ended with all that it has started."""
    worker.connection.close()
    if worker.number is not None and worker.process.pid is not None:
        try:
            os.killpg(worker.process.pid, signal.SIGTERM)
        except ProcessLookupError:  # not yet a group of its own
            worker.process.terminate()
    worker.process.join(PATIENCE_S)
    if worker.process.is_alive():
        worker.process.kill()
        worker.process.join()
