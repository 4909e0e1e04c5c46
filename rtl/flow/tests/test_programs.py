# SPDX-License-Identifier: Apache-2.0
"""Each program of the flow starts as make starts it: without the import path of the tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

FLOW = Path(__file__).parents[1]
PROGRAMS = [path for path in sorted(FLOW.glob("*.py")) if "ArgumentParser(" in path.read_text()]


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.name)
def test_a_program_says_what_it_does(program: Path) -> None:
    done = subprocess.run([sys.executable, program, "--help"], capture_output=True, text=True, cwd=FLOW)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"usage: {program.name}")
