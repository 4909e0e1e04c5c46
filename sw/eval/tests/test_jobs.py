"""Many jobs in this process and in others: the same results, each kept once, whatever is killed."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import job_examples
import pytest
from job_examples import SEEDS, attempts_in, contents, kept_jobs, wait_for_attempt
from threadpoolctl import threadpool_limits
from vista.errors import EXIT_INPUT, EXIT_JOBS, JobsError
from vista_eval.cache import to_json
from vista_eval.jobs import ATTEMPTS, HERE, Failure, Job, Place, jobs_of, outcomes, run
from vista_eval.jobs.progress import MOST_LINES, Progress

pytestmark = pytest.mark.slow

TWO = Place(2)


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("place", [HERE, TWO, Place(3)])
def test_results_and_what_is_kept_do_not_depend_on_the_processes(place: Place, tmp_path: Path) -> None:
    expected = [json.loads(json.dumps(to_json(job_examples.rows_of(seed)))) for seed in SEEDS]
    run(kept_jobs(job_examples.rows_of), HERE, kept=tmp_path / "reference")
    assert run(kept_jobs(job_examples.rows_of), place, kept=tmp_path / "kept") == expected
    assert contents(tmp_path / "kept") == contents(tmp_path / "reference")
    assert len(contents(tmp_path / "kept")) == len(SEEDS)


@pytest.mark.parametrize("place", [HERE, TWO])
def test_a_job_has_one_core(place: Place) -> None:
    with threadpool_limits(2, "blas"):
        outside = job_examples.blas_threads(0)
        assert outside and set(outside) == {2}
        for found in run(jobs_of(job_examples.blas_threads, SEEDS[:2]), place):
            assert found == [1] * len(found) and found
        assert job_examples.blas_threads(0) == outside


def test_only_what_is_not_kept_is_made(tmp_path: Path) -> None:
    kept, notes = tmp_path / "kept", tmp_path / "notes"
    notes.mkdir()
    jobs = kept_jobs(partial(job_examples.noted, notes))
    some = run(jobs[:5], HERE, kept=kept)
    damaged = next(kept.rglob("*.json"))
    damaged.write_bytes(damaged.read_bytes()[:-10])
    found = run(jobs, TWO, kept=kept)
    assert found[:5] == some
    assert sorted(attempts_in(notes)) == list(SEEDS)
    assert sorted(attempts_in(notes).values()) == [1] * (len(SEEDS) - 1) + [2]  # that of the damaged file
    before = contents(kept)
    assert run(jobs, TWO, kept=kept) == found
    assert contents(kept) == before
    assert attempts_in(notes).total() == len(SEEDS) + 1


def test_a_worker_that_is_killed_costs_its_job_only(tmp_path: Path) -> None:
    notes = tmp_path / "notes"
    notes.mkdir()
    victims = (SEEDS[0], SEEDS[7])

    def kill() -> None:
        for seed in victims:
            os.kill(wait_for_attempt(notes, seed), signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    work = partial(job_examples.held, notes, 60.0, victims)
    found = run(kept_jobs(work), TWO, kept=tmp_path / "kept")
    killer.join()
    assert found == run(kept_jobs(job_examples.rows_of), HERE, kept=tmp_path / "reference")
    assert contents(tmp_path / "kept") == contents(tmp_path / "reference")
    assert attempts_in(notes) == {seed: 2 if seed in victims else 1 for seed in SEEDS}


@pytest.mark.parametrize("work", [job_examples.kills_itself, job_examples.leaves])
def test_a_job_that_always_ends_its_worker_is_given_up(work, capsys: pytest.CaptureFixture) -> None:
    found = outcomes(jobs_of(work, range(5)), TWO)
    text = f"its worker died in each of {ATTEMPTS} attempts"
    assert [one for one in found if not isinstance(one, Failure)] == [0, 1, 3, 4]
    assert isinstance(found[2], Failure) and (found[2].job, found[2].text) == ("2", text)
    assert f"vista: {text} (2)" in capsys.readouterr().err.splitlines()


@pytest.mark.parametrize("place", [HERE, TWO])
def test_jobs_that_fail_are_named_and_the_others_go_on(place: Place, capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(JobsError) as raised:
        run(jobs_of(job_examples.fails, range(5), "seed {}".format), place, "example")
    assert str(raised.value) == "example: 2 of 5 failed"
    assert raised.value.status == EXIT_JOBS
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("vista: ")]
    assert "vista: image.png: truncated image (seed 1)" in lines
    assert any(
        re.fullmatch(r"vista: ValueError at job_examples.py:\d+: three is too many \(seed 3\)", one)
        for one in lines
    )
    assert len(lines) == 2
    with pytest.raises(JobsError) as raised:
        run(jobs_of(job_examples.fails, range(3)), place)
    assert (raised.value.failed, raised.value.status) == (1, EXIT_INPUT)


def test_what_cannot_be_sent_is_a_failure() -> None:
    jobs = jobs_of(job_examples.not_to_be_sent, range(3))
    found = outcomes([*jobs, Job("here only", lambda: 3)], TWO)
    assert [found[0], found[2]] == [0, 2]
    assert found[1].text.startswith("its result cannot be sent: ")
    assert found[3].text.startswith("it cannot be sent to another process: ")


PROGRAM = """
import sys
from functools import partial
from pathlib import Path
import job_examples
from vista_eval.jobs import Job, Place, run
from vista_eval.cache import digest_of
if __name__ == "__main__":
    notes, kept, *seeds = sys.argv[1:]
    work = partial(job_examples.held, Path(notes), 3.0, (8, 9, 10, 11))
    jobs = [Job(f"seed {seed}", partial(work, seed), digest_of(f"{seed}")) for seed in map(int, seeds)]
    run(jobs, Place(2), kept=Path(kept))
"""


def heed_interruption() -> None:
    """A shell lets what it starts in the background ignore SIGINT, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_who_is_ended_leaves_whole_results_and_no_process(number: signal.Signals, tmp_path: Path) -> None:
    notes, kept, program = tmp_path / "notes", tmp_path / "kept", tmp_path / "program.py"
    notes.mkdir()
    program.write_text(PROGRAM)
    paths = os.pathsep.join([str(Path(job_examples.__file__).parent), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, str(program), str(notes), str(kept), *map(str, SEEDS)]
    process = subprocess.Popen(
        command,
        env=os.environ | {"PYTHONPATH": paths},
        stderr=subprocess.DEVNULL,
        preexec_fn=heed_interruption,
    )
    wait_for_attempt(notes, SEEDS[3])
    process.send_signal(number)
    assert process.wait(timeout=60) != 0
    pids = {int(path.name.split("_")[1]) for path in notes.iterdir()}
    until_s = time.monotonic() + 30.0
    while any(map(is_running, pids)) and time.monotonic() < until_s:
        time.sleep(0.05)
    assert not any(map(is_running, pids))
    early = {path: path.read_bytes() for path in kept.rglob("*.json")}
    assert 0 < len(early) < len(SEEDS)
    found = run(kept_jobs(partial(job_examples.noted, notes)), TWO, kept=kept)
    assert found == run(kept_jobs(job_examples.rows_of), HERE, kept=tmp_path / "reference")
    assert all(path.read_bytes() == content for path, content in early.items())
    assert len(list(kept.rglob("*.json"))) == len(SEEDS)


def test_failures_are_named_but_not_without_end(capsys: pytest.CaptureFixture) -> None:
    with Progress("example", "job", 100, 40) as progress:
        for _ in range(30):
            progress.count(None)
            progress.count("broken (one)")
        assert (progress.n, progress.failed) == (100, 30)
    assert capsys.readouterr().err.splitlines().count("vista: broken (one)") == MOST_LINES
