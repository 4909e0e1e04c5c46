"""All recordings, as jobs."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from vista_eval.cache import code_digest, digest_of
from vista_eval.jobs import HERE, Failure, Job, Place, jobs_of, outcomes
from vista_eval.recordings.examine import Detector, Row, examine, row_of
from vista_eval.recordings.storage import Content, content_of, find_recordings


def examine_all(detector: Detector, prefix: str, place: Place, kept: Path) -> list[Row]:
    """A row of each recording, by name; `kept` receives those that are made. Raises InputError."""
    names = find_recordings(prefix)
    looking = place if place.cluster else HERE  # it takes less than to start a process
    contents = outcomes(jobs_of(partial(content_of, prefix), names), looking, "look", "recording")
    by_name = dict(zip(names, contents, strict=True))
    code, of_detector = code_digest(examine.__module__), detector.digest()
    jobs = [
        Job(
            name,
            partial(examine, detector, prefix, name),
            of_detector and digest_of(code, of_detector, content.digest),
        )
        for name, content in by_name.items()
        if isinstance(content, Content)
    ]
    rows = outcomes(jobs, place, "examine", "recording", kept, lambda row: row["error"])
    row_of_name = {job.name: row for job, row in zip(jobs, rows, strict=True)}
    return [complete(name, by_name[name], row_of_name.get(name)) for name in names]


def complete(name: str, content: Content | Failure, row: Row | Failure | None) -> Row:
    if isinstance(content, Failure):
        return {"recording": name, "bytes": None} | failed(content)
    assert row is not None
    return {"recording": name, "bytes": content.bytes} | (failed(row) if isinstance(row, Failure) else row)


def failed(failure: Failure) -> Row:
    """The row of a recording at which a worker failed."""
    return row_of(None, [], set()) | {"error": failure.text}
