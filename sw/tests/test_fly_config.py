"""The configuration of vista-fly: what `vista config` prints, read and refused as the command line does."""

from __future__ import annotations

from pathlib import Path

import pytest
from fly_process import fly
from random_seed import seeded
from vista import parameters
from vista.errors import InputError

pytestmark = pytest.mark.native


def problem_of(file: Path) -> str | None:
    """What vista-fly says of a configuration; None: it goes on to the rig, which is not there."""
    run = fly("--config", file, "--rig", "/nowhere", "--recording", "/nowhere")
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert run.stderr.startswith("vista-fly: ")
    said = run.stderr.strip().removeprefix("vista-fly: ")
    return None if said.startswith("/nowhere: ") else said


def compare(file: Path, text: str) -> bool:
    """Both accept it, or both refuse it; whether they accept it."""
    file.write_text(text)
    try:
        parameters.load(file)
    except InputError as error:
        said = problem_of(file)
        assert said is not None, (text, str(error))
        if "not readable as TOML" not in f"{error}{said}":
            assert said.split(" must be ")[0] == str(error).split(" must be ")[0]
        return False
    assert problem_of(file) is None, text
    return True


def test_all_defaults_are_accepted(tmp_path: Path) -> None:
    assert compare(tmp_path / "my.toml", parameters.default_toml())


@pytest.mark.parametrize(
    "text, accepted",
    [
        ("", True),
        ("# a comment\n\n  [stereo] # another\n\tblock_size=9#x\n", True),
        ("[stereo]\r\nblock_size = 9\r\n", True),
        ("[ stereo ]\nblock_size = +9", True),
        ("[mavlink]\nautopilot = 'ardupilot'\n", True),
        ("[motion]\ndrift_m_s = 1\n", True),
        ("[motion]\ndrift_m_s = 1e-1\n", True),
        ("[motion]\ndrift_m_s = 1.\n", False),
        ("[motion]\ndrift_m_s = .5\n", False),
        ("[motion]\ndrift_m_s = 01.5\n", False),
        ("[motion]\ndrift_m_s = nan\n", False),
        ("[motion]\ndrift_m_s = inf\n", False),
        ("[motion]\ndrift_m_s = '1'\n", False),
        ("[motion]\ndrift_m_s = true\n", False),
        ("[motion]\ndrift_m_s = -1\n", False),
        ("[stereo]\nblock_size = 9.0\n", False),
        ("[stereo]\nblock_size = 99\n", False),
        ("[stereo]\nblock_size = \n", False),
        ("[stereo]\nblock_size 9\n", False),
        ("[stereo]\nblock_size = 9 9\n", False),
        ("[stereo]\nblock_size = 9\nblock_size = 9\n", False),
        ("[stereo]\n[stereo]\n", False),
        ("[stereo\n", False),
        ("[stereo] x\n", False),
        ("[[stereo]]\n", False),
        ("[wrong]\n", False),
        ("[stereo]\nwrong = 1\n", False),
        ("wrong = 1\n", False),
        ('[mavlink]\nautopilot = "betaflight"\n', False),
        ('[mavlink]\nautopilot = "px4\n', False),
        ("[mavlink]\nautopilot = 4\n", False),
        ("[mavlink]\nmin_distance_m = 50\nmax_distance_m = 20\n", False),
        ("[stereo]\nblock_size = 9\x01\n", False),
    ],
)
def test_by_hand(tmp_path: Path, text: str, accepted: bool) -> None:
    assert compare(tmp_path / "my.toml", text) == accepted


@pytest.mark.parametrize(
    "text", ["[stereo]\nblock_size = 0x9\n", "stereo.block_size = 9\n", "[motion]\ndrift_m_s = 1_0.0\n"]
)
def test_the_rest_of_toml_is_refused(tmp_path: Path, text: str) -> None:
    """The command line reads these."""
    (tmp_path / "my.toml").write_text(text)
    parameters.load(tmp_path / "my.toml")
    assert problem_of(tmp_path / "my.toml") is not None


def test_changes_at_random(tmp_path: Path) -> None:
    """Values in and out of range in the file of all defaults, and characters that are changed."""
    random = seeded(1)
    lines = parameters.default_toml().splitlines()
    values = [k for k, line in enumerate(lines) if " = " in line and not line.startswith("#")]
    accepted = 0
    for _ in range(40):
        changed = list(lines)
        k = int(random.choice(values))
        name, _, value = changed[k].partition(" = ")
        if value[0] != '"':
            number = float(value) * random.choice([0.5, 1.0, 2.0, 1000.0, -1.0])
            changed[k] = f"{name} = {number if '.' in value else int(number)}"
        elif random.random() < 0.5:
            changed[k] = f'{name} = "other"'
        accepted += compare(tmp_path / "my.toml", "\n".join(changed) + "\n")
    assert 0 < accepted < 40


def test_files_that_are_none(tmp_path: Path) -> None:
    assert "no such file or directory" in (problem_of(tmp_path / "missing.toml") or "")
    assert "is a directory" in (problem_of(tmp_path) or "")
    (tmp_path / "long.toml").write_text("#" * 600)
    assert "line 1: longer" in (problem_of(tmp_path / "long.toml") or "")
    (tmp_path / "large.toml").write_text("\n" * 300_000)
    assert "larger than any configuration" in (problem_of(tmp_path / "large.toml") or "")
