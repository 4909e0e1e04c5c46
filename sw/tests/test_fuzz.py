"""The fuzz targets: every committed input passes under all sanitizers, and so do hundreds of new ones."""

from __future__ import annotations

from pathlib import Path

import pytest
import run_fuzz

RUNS = {"engine": 20000, "pipeline": 140, "mavlink": 2000, "fly": 400}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not all((run_fuzz.FUZZ / target).is_file() for target in RUNS),
        reason="the fuzz targets are not built: make fuzz-targets",
    ),
]


@pytest.mark.parametrize("target", RUNS)
def test_committed_inputs(target: str) -> None:
    done = run_fuzz.run_corpus(target)
    assert done.returncode == 0, done.stderr[-4000:]


@pytest.mark.parametrize("target", RUNS)
def test_new_inputs(target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same ones each time: seed and number of runs are fixed, and the corpus is the committed one."""
    if not run_fuzz.has_fuzzer():
        pytest.skip("there is no clang with libFuzzer")
    (tmp_path / "fuzz").mkdir()
    (tmp_path / "fuzz" / target).symlink_to(run_fuzz.FUZZ / target)
    monkeypatch.setattr(run_fuzz, "FUZZ", tmp_path / "fuzz")
    outcome, text = run_fuzz.fuzz(target, "-seed=1", f"-runs={RUNS[target]}")
    assert not outcome.failed, text[-4000:]
    assert outcome.executions >= RUNS[target]
    assert outcome.edges > 0.1 * outcome.all_edges, outcome


def test_the_corpus_is_small() -> None:
    assert sum(path.stat().st_size for path in run_fuzz.CORPUS.rglob("*")) < 200_000
