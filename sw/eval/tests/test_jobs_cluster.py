"""Many jobs on a Dask cluster of real processes: what comes of them is what one process makes of them."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import job_examples
import pytest
from command_line import assert_refused
from command_line import call as call_vista
from dask_cluster import Cluster
from job_examples import SEEDS, attempts_in, contents, kept_jobs, wait_for_attempt
from vista.errors import EXIT_INPUT
from vista_eval.jobs import HERE, Failure, Job, Place, exit_on_failure, jobs_of, outcomes, run

pytestmark = pytest.mark.slow

if find_spec("distributed") is None:  # it takes a second to load, in each process that collects tests
    pytest.skip("no Dask: make setup-jobs", allow_module_level=True)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with Cluster(tmp_path_factory.mktemp("cluster")) as cluster:
        yield cluster


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What one process keeps."""
    folder = tmp_path_factory.mktemp("reference")
    run(kept_jobs(job_examples.rows_of), HERE, kept=folder)
    return folder


def test_results_and_what_is_kept_are_those_of_one_process(
    cluster: Cluster, reference: Path, tmp_path: Path
) -> None:
    place = Place(cluster=cluster.address)
    found = run(kept_jobs(job_examples.rows_of), place, kept=tmp_path)
    assert found == run(kept_jobs(job_examples.rows_of), HERE, kept=reference)
    assert contents(tmp_path) == contents(reference)


def test_jobs_that_fail_are_named_and_the_others_go_on(
    cluster: Cluster, capsys: pytest.CaptureFixture
) -> None:
    found = outcomes(jobs_of(job_examples.fails, range(5)), Place(cluster=cluster.address))
    assert [found[index] for index in (0, 2, 4)] == [0, 2, 4]
    assert found[3].text.startswith("ValueError at job_examples.py:")
    assert "vista: image.png: truncated image (1)" in capsys.readouterr().err.splitlines()


def test_a_worker_with_other_code_adds_nothing(cluster: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    from vista_eval.jobs import cluster as module

    monkeypatch.setattr(module, "code_of", lambda job: ("vista.geometry", "0" * 64))
    [found] = outcomes(jobs_of(job_examples.rows_of, [1]), Place(cluster=cluster.address))
    assert isinstance(found, Failure)
    assert found.text.startswith("worker tcp://127.0.0.1:")
    assert found.text.endswith("has another version of vista.geometry")


def test_a_job_that_dask_gives_up_is_named() -> None:
    from distributed import KilledWorker
    from vista_eval.jobs.cluster import failure_of

    failure = failure_of(Job("one", print), KilledWorker("key", None, 3))
    assert (failure.job, failure.text) == ("one", "its worker died, 4 times in all")


def test_every_job_is_kept_once_whatever_happens(cluster: Cluster, reference: Path, tmp_path: Path) -> None:
    """One worker is halted for a while, one is killed at a job, and the scheduler is started again."""
    notes, kept = tmp_path / "notes", tmp_path / "kept"
    notes.mkdir()
    victims = (SEEDS[3], SEEDS[8])

    def disturb() -> None:
        cluster.workers[0].send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        cluster.workers[0].send_signal(signal.SIGCONT)
        os.kill(wait_for_attempt(notes, victims[0]), signal.SIGKILL)
        cluster.start_worker()
        wait_for_attempt(notes, victims[1])
        cluster.scheduler.kill()
        cluster.scheduler.wait()
        cluster.start()

    disturber = threading.Thread(target=disturb)
    disturber.start()
    work = partial(job_examples.held, notes, 5.0, victims)
    found = run(kept_jobs(work), Place(cluster=cluster.address), kept=kept)
    disturber.join()
    assert found == run(kept_jobs(job_examples.rows_of), HERE, kept=reference)
    assert contents(kept) == contents(reference)
    made = attempts_in(notes)
    assert sorted(made) == list(SEEDS)
    assert made[victims[0]] >= 2


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("tcp://127.0.0.1:1", "no scheduler answers within 1 s"),
        ("nonsense://here", "unknown address scheme 'nonsense'"),
    ],
)
def test_a_cluster_that_is_not_there_is_named(
    address: str, reason: str, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from vista_eval.jobs import cluster as module

    monkeypatch.setattr(module, "CONNECT_S", 1.0)
    arguments = ("flights", str(tmp_path), "--only", "close", "--cluster", address)
    assert_refused(call_vista(capsys, *arguments), f"--cluster {address}: {reason}")
    assert list(tmp_path.iterdir()) == []


def test_a_program_of_its_own_names_it_in_one_line(
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And ends as the command does, without a traceback."""
    from vista_eval.jobs import cluster as module

    monkeypatch.setattr(module, "CONNECT_S", 1.0)
    place = Place(cluster="tcp://127.0.0.1:1")
    with pytest.raises(SystemExit) as ended, exit_on_failure():
        run(jobs_of(job_examples.small_row, range(2)), place)
    assert ended.value.code == EXIT_INPUT
    lines = [line for line in capsys.readouterr().err.splitlines() if line.strip()]
    assert lines[-1] == "--cluster tcp://127.0.0.1:1: no scheduler answers within 1 s"
    assert not any("Traceback" in line for line in lines)


def test_a_cluster_without_dask_names_the_extra(
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "vista_eval.jobs.cluster", raising=False)
    arguments = ("flights", str(tmp_path), "--only", "close", "--cluster", "tcp://127.0.0.1:1")
    line = "--cluster: needs the extra [cluster]: pip install 'vista-stereo-eval[cluster]'"
    assert_refused(call_vista(capsys, *arguments), line)
