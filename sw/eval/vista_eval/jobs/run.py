"""Makes jobs, wherever they run: keeps their results, shows how far they are, and names those that fail."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vista.errors import EXIT_INPUT, InputError, JobsError

from vista_eval.cache import keep, read_kept
from vista_eval.jobs.job import Done, Failure, Job, Outcome, attempt
from vista_eval.jobs.place import HERE, Place
from vista_eval.jobs.progress import Progress


def run(
    jobs: Sequence[Job],
    place: Place = HERE,
    title: str = "jobs",
    unit: str = "job",
    kept: Path | None = None,
) -> list[Any]:
    """The results of all jobs, in their order. Raises JobsError when all are done and some have failed."""
    found = outcomes(jobs, place, title, unit, kept)
    failures = [outcome for outcome in found if isinstance(outcome, Failure)]
    if failures:
        raise JobsError(title, len(failures), len(jobs), max(failure.status for failure in failures))
    return found


def outcomes(
    jobs: Sequence[Job],
    place: Place = HERE,
    title: str = "jobs",
    unit: str = "job",
    kept: Path | None = None,
) -> list[Any | Failure]:
    """The result of each job or its Failure, in their order.

    kept: folder of the results of jobs with a digest. They are JSON, and what is returned is what JSON makes
    of them, so that it is the same whether the job was made now or earlier."""
    found: dict[int, Any | Failure] = {}
    for index, job in enumerate(jobs):
        if kept is not None and job.digest is not None:
            result = read_kept(kept_path(kept, job.digest), job.digest)
            if result is not None:
                found[index] = result
    waiting = [index for index in range(len(jobs)) if index not in found]
    with Progress(title, unit, len(jobs), len(found)) as progress:
        for number, outcome in made([jobs[index] for index in waiting], place):
            index = waiting[number]
            job, result = jobs[index], settle(jobs[index], outcome, place, kept)
            problem = result.text if isinstance(result, Failure) else None
            progress.count(problem and f"{problem} ({job.name})")
            found[index] = result
    return [found[index] for index in range(len(jobs))]


@contextmanager
def exit_on_failure() -> Iterator[None]:
    """Ends a program of its own when jobs fail: a line has named each job that failed, or names the scheduler
    that does not answer, and the exit status says it too."""
    try:
        yield
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(EXIT_INPUT)
    except JobsError as error:
        print(error, file=sys.stderr)
        sys.exit(error.status)


def made(jobs: Sequence[Job], place: Place) -> Iterator[tuple[int, Outcome]]:
    """Each job's place in the list and its outcome, as they come."""
    if not jobs:
        return iter(())
    if place.cluster is not None:
        from vista_eval.jobs.cluster import on_cluster  # Dask is optional

        return on_cluster(jobs, place.cluster)
    if place.processes == 1 or len(jobs) == 1:
        return ((number, attempt(job)) for number, job in enumerate(jobs))
    from vista_eval.jobs.processes import in_processes

    return in_processes(jobs, min(place.processes, len(jobs)))


def settle(job: Job, outcome: Outcome, place: Place, kept: Path | None) -> Any | Failure:
    if isinstance(outcome, Done):
        if kept is None or job.digest is None:
            return outcome.result
        return keep(kept_path(kept, job.digest), job.digest, outcome.result)
    if outcome.missing_module and place.cluster is None:  # no other job would do better
        raise ModuleNotFoundError(outcome.text)
    return outcome


def kept_path(folder: Path, digest: str) -> Path:
    """Folders of a few hundred files: some file systems are slow with many in one."""
    return folder / digest[:2] / f"{digest}.json"
