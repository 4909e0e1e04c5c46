"""Set-up: a checkout that was moved goes on working, and what a machine lacks is named in one line."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from shared_data import REPOSITORY

pytestmark = pytest.mark.slow

MAKE = shutil.which("make")


def make(folder: Path, *goals: str, path: str = os.environ["PATH"]) -> subprocess.CompletedProcess[str]:
    assert MAKE is not None
    variables = {"PATH": path, "HOME": str(folder)}
    return subprocess.run(
        [MAKE, *goals], cwd=folder, env=variables, capture_output=True, text=True, timeout=120
    )


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """What make reads to begin with, and a .venv with a script of its own as pip installs them."""
    folder = tmp_path / "before" / "vista"
    included = re.findall(r"^include (.*)$", (REPOSITORY / "Makefile").read_text(), re.MULTILINE)
    for name in ("Makefile", *included, "scripts/setup.sh"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(REPOSITORY / name, folder / name)
    environment = folder / ".venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True, timeout=120)
    script = environment / "bin" / "pip"
    script.write_text(f"#!{environment}/bin/python\nimport marker\nprint(marker.__file__)\n")
    script.chmod(0o755)
    [packages] = (environment / "lib").glob("python*/site-packages")
    (packages / "editable.pth").write_text(f"{folder}/sw/python\n")
    (folder / "sw" / "python").mkdir(parents=True)
    (folder / "sw" / "python" / "marker.py").touch()
    (environment / "place").write_text(f"{folder}\n")
    (environment / "run.stamp").touch()
    for name in ("CMakeCache.txt", "sanitized/CMakeCache.txt", "flights/result.json"):
        (folder / "build" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "build" / name).write_text(str(folder))
    return folder


def test_a_moved_checkout_is_put_right(checkout: Path, tmp_path: Path) -> None:
    moved = tmp_path / "after"
    shutil.move(checkout, moved)
    first = make(moved, "help")
    assert first.returncode == 0
    assert first.stderr == f"setup: this checkout was moved here from {checkout}; its paths are put right\n"
    script = subprocess.run([moved / ".venv" / "bin" / "pip"], capture_output=True, text=True, timeout=60)
    assert script.stdout == f"{moved}/sw/python/marker.py\n", script.stderr
    assert (moved / ".venv" / "run.stamp").exists()
    # Results are kept, what CMake would refuse is not.
    kept = sorted(path.name for path in (moved / "build").rglob("*") if path.is_file())
    assert kept == ["result.json", "setup.lock"]
    second = make(moved, "help")
    assert (second.returncode, second.stderr) == (0, "")


def test_a_path_that_no_script_can_name_begins_anew(checkout: Path, tmp_path: Path) -> None:
    moved = tmp_path / "with a blank"
    shutil.move(checkout, moved)
    assert make(moved, "help").returncode == 0
    assert (moved / ".venv" / "installing").exists()
    assert not (moved / ".venv" / "run.stamp").exists()


def without(folder: Path, *missing: str) -> str:
    """A PATH on which every program of the system lies except those whose names begin like these."""
    folder.mkdir()
    for place in ("/usr/bin", "/bin"):
        for program in Path(place).iterdir():
            link = folder / program.name
            if not program.name.startswith(missing) and not link.is_symlink():
                link.symlink_to(program)
    return str(folder)


def test_an_interrupted_setup_is_not_taken_for_a_whole_one(checkout: Path) -> None:
    """Killed while pip installs a set, it leaves no other stamp in place; the next begins anew."""
    environment, requirements = checkout / ".venv", checkout / "scripts" / "requirements"
    requirements.mkdir()
    (requirements / "test.txt").write_text("pytest==8.0.0\n")
    python = environment / "bin" / "python"
    python.unlink()
    python.write_text("#!/bin/sh\nkill -KILL $PPID\n")
    python.chmod(0o755)
    setup = checkout / "scripts" / "setup.sh"
    assert subprocess.run(["bash", setup, "test"], capture_output=True, timeout=60).returncode == -9
    assert not list(environment.glob("*.stamp"))
    # Anew, with a python that makes a .venv and takes what it is asked to install.
    stub = checkout / "stub" / "python3.11"
    stub.parent.mkdir()
    stub.write_text("#!/bin/sh\n[ $2 != venv ] || { mkdir -p .venv/bin; cp $0 .venv/bin/python; }\n")
    stub.chmod(0o755)
    path = f"{stub.parent}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", setup, "test"], env={"PATH": path}, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert "creating .venv" in done.stdout
    assert [stamp.name for stamp in environment.glob("*.stamp")] == ["test.stamp"]
    assert not (environment / "installing").exists()


@pytest.mark.parametrize(
    ("missing", "goals"),
    [
        ("gcc", ["native", "-o", ".venv/build.stamp", "-o", "build/tools/jpeg/stamp"]),
        ("g++", ["build/tools/systemc/ldflags"]),
    ],
)
def test_a_missing_compiler_is_named(checkout: Path, tmp_path: Path, missing: str, goals: list[str]) -> None:
    (checkout / ".venv" / "build.stamp").touch()
    for name in ("setup_systemc.sh", "requirements/systemc.txt"):
        (checkout / "scripts" / name).parent.mkdir(exist_ok=True)
        shutil.copy(REPOSITORY / "scripts" / name, checkout / "scripts" / name)
    done = make(checkout, *goals, path=without(tmp_path / "bin", missing))
    assert done.returncode == 2 and done.stdout == ""
    [line] = done.stderr.splitlines()
    assert line.endswith(f"*** {missing} is missing (Debian: apt install {missing}).  Stop.")


def test_a_missing_python_is_named(checkout: Path, tmp_path: Path) -> None:
    shutil.rmtree(checkout / ".venv")
    (checkout / "scripts" / "requirements").mkdir()
    (checkout / "scripts" / "requirements" / "build.txt").touch()
    done = make(checkout, ".venv/build.stamp", path=without(tmp_path / "bin", "python"))
    assert done.returncode == 2
    first, *_ = done.stderr.splitlines()
    assert first == "setup: no Python 3.11 or newer on PATH (Debian: apt install python3)"
