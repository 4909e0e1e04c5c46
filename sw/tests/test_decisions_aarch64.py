"""The planner for AArch64, under qemu: the decisions of this machine. `make test-aarch64` builds it."""

from __future__ import annotations

import os
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import decision_scenes
import numpy as np
import pytest
import recording_cases as cases
from board_flight import board_flight
from numpy.typing import NDArray
from random_seed import seeded
from shared_data import REPOSITORY, SHARED_DATA
from vista.cli import main
from vista.structs import dtype_of, names_of

HERE = [str(REPOSITORY / "build/bin/decisions")]
THERE = [str(REPOSITORY / "build/tools/aarch64/run"), str(REPOSITORY / "build/aarch64/bin/decisions")]
SCENES = int(os.environ.get("VISTA_AARCH64_SCENES", "7"))  # of each kind one after the other
STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
TOLERANCE = 1e-9  # relative: the detector's numbers, which are given, may differ in the last digit

WITHOUT_FUSED = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-FMA_Usable,-FMA4_Usable,-AVX2_Usable"

pytestmark = [pytest.mark.slow, pytest.mark.same_c]  # of programs that no sanitizer is built into
built = pytest.mark.skipif(
    not (Path(HERE[0]).exists() and Path(THERE[1]).exists()),
    reason="not built for AArch64: make test-aarch64",
)


def decided(command: list[str], recording: Path, **environment: str) -> NDArray[np.void]:
    """What decisions.c says, a row a decision."""
    done = subprocess.run(
        [*command, str(recording)], capture_output=True, check=True, env=os.environ | environment
    )
    layout = np.dtype([("status", "<i4"), ("decision", dtype_of("vista_plan_decision"))])
    return np.frombuffer(done.stdout, layout)


def leaves(found: NDArray[np.void], name: str = "") -> Iterator[tuple[str, NDArray[np.generic]]]:
    if found.dtype.names is None:
        yield name, found
        return
    for member in found.dtype.names:
        yield from leaves(found[member], f"{name}.{member}")


class Comparison:
    """How many decisions of this machine and of another were compared, and how far they are apart."""

    def __init__(self, there: list[str], **environment: str) -> None:
        self.there, self.environment = there, environment
        self.actions: Counter[str] = Counter()
        self.recordings, self.other_bytes, self.point_apart = 0, 0, 0.0

    def add(self, recording: Path) -> None:
        here, there = decided(HERE, recording), decided(self.there, recording, **self.environment)
        assert len(here) == len(there) > 0
        assert not here["status"].any()
        for (name, a), (_, b) in zip(leaves(here), leaves(there), strict=True):
            where = f"{recording.name}{name}"
            if a.dtype.kind != "f":
                np.testing.assert_array_equal(b, a, where)
                continue
            assert np.isfinite(a).all(), where
            np.testing.assert_allclose(b, a, TOLERANCE, TOLERANCE, err_msg=where)
            if name.startswith(".decision.points"):
                self.point_apart = max(self.point_apart, float(np.abs(b - a).max()))
        self.recordings += 1
        self.other_bytes += sum(a.tobytes() != b.tobytes() for a, b in zip(here, there, strict=True))
        actions = names_of("plan_action")
        self.actions.update(actions[action] for action in here["decision"]["action"])

    def report(self) -> str:
        count = self.actions.total()
        return (
            f"{count} decisions over {self.recordings} recordings ({dict(self.actions)}): 0 choices differ, "
            f"{self.other_bytes} differ in any byte, a point by {self.point_apart:.1e} at most"
        )


def over_random_scenes(comparison: Comparison, folder: Path, rng: np.random.Generator, scenes: int) -> None:
    kinds = list(decision_scenes.KINDS)
    for number in range(scenes):
        kind = kinds[number % len(kinds)]
        recording = decision_scenes.record(folder / f"{number}_{kind}.rec", kind, rng)
        comparison.add(recording)
        recording.unlink()
    print(comparison.report())


@built
def test_random_scenes(tmp_path: Path) -> None:
    comparison = Comparison(THERE)
    over_random_scenes(comparison, tmp_path, seeded(44), SCENES)
    assert len(comparison.actions) >= 5


@pytest.mark.skipif(not Path(HERE[0]).exists(), reason="not built: make test-aarch64")
def test_functions_of_another_library(tmp_path: Path) -> None:
    """The C library takes others where an x86 fuses no products, and is told that this one does not. Of these
    scenes, always the same, the detector's numbers are equal all the same, and so is each byte decided."""
    comparison = Comparison(HERE, GLIBC_TUNABLES=WITHOUT_FUSED)
    over_random_scenes(comparison, tmp_path, np.random.default_rng(1), len(decision_scenes.KINDS))
    assert comparison.other_bytes == 0


@built
def test_a_flight(tmp_path: Path) -> None:
    comparison = Comparison(THERE)
    comparison.add(cases.record(tmp_path / "board.rec", board_flight()[:9]))
    print(comparison.report())


@built
@pytest.mark.skipif(not STREET.exists(), reason=f"{STREET} is absent")
def test_a_street(tmp_path: Path) -> None:
    recording, comparison = tmp_path / "street.rec", Comparison(THERE)
    arguments = ["run", STREET, "--out", tmp_path / "out", "--no-overlay", "--record", recording]
    assert main([str(argument) for argument in arguments]) == 0
    comparison.add(recording)
    print(comparison.report())
