"""What a job is, and what becomes of one."""

from __future__ import annotations

import pickle
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits
from vista.errors import EXIT_INPUT, EXIT_JOBS, InputError

ATTEMPTS = 3  # of a job whose worker dies each time

Item = TypeVar("Item")


@dataclass(frozen=True)
class Job:
    """name: for people. work: a function of a module, or a partial of one, so that it can be sent to another
    process; so can what it returns. digest: of everything that decides the result, which is then kept."""

    name: str
    work: Callable[[], Any]
    digest: str | None = None


@dataclass(frozen=True)
class Done:
    result: Any


@dataclass(frozen=True)
class Failure:
    """text: one line that says what is wrong. status: the exit status that follows from it."""

    job: str
    text: str
    status: int = EXIT_JOBS
    missing_module: bool = False


Outcome = Done | Failure


def jobs_of(
    work: Callable[[Item], Any], items: Iterable[Item], name: Callable[[Item], str] = str
) -> list[Job]:
    """The job `work(item)` of each item."""
    return [Job(name(item), partial(work, item)) for item in items]


def attempt(job: Job) -> Outcome:
    """Makes the job on one core; whatever it raises is its failure. Threads of numpy's BLAS wait for each
    other in a loop, and would take the cores of the jobs beside it."""
    try:
        with threadpool_limits(1, "blas"):
            return Done(job.work())
    except InputError as error:
        return Failure(job.name, str(error), EXIT_INPUT)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # of sys.exit and of a failing check too
        return Failure(job.name, described(error), missing_module=isinstance(error, ModuleNotFoundError))


def attempt_pickled(name: str, pickled: bytes) -> bytes:
    """The outcome of a job that came from another process, to be sent back there."""
    try:
        outcome = attempt(Job(name, pickle.loads(pickled)))
    except Exception as error:  # made of what this process does not have
        outcome = Failure(name, described(error))
    try:
        return pickle.dumps(outcome)
    except Exception as error:
        return pickle.dumps(Failure(name, f"its result cannot be sent: {described(error)}"))


def described(error: BaseException) -> str:
    """The error in one line, with the place in the code."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    where = f"{Path(place.filename).name}:{place.lineno}"
    return " ".join(f"{type(error).__name__} at {where}: {error}".split())
