"""Commands are found by entry points: loaded when named, and named with their distribution when missing."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest
from command_line import Vista, assert_refused
from command_line import call as call_vista
from vista import cli
from vista_eval.command import flights

SLOW_TO_LOAD = ("matplotlib", "embreex", "vista_eval", "vista_throughput")


@pytest.fixture
def run_vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    return lambda *arguments: call_vista(capsys, *arguments)


def test_help_names_all_commands_in_order_and_loads_none() -> None:
    program = f"""
import sys
from vista import cli
try:
    cli.main(["--help"])
except SystemExit:
    pass
print(*[name for name in {SLOW_TO_LOAD} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[-1] == ""
    named = [line.split()[0] for line in lines if line.startswith("    ") and not line.startswith("     ")]
    assert named == list(cli.COMMANDS)
    assert "pip install" not in done.stdout


@pytest.mark.parametrize("command", cli.COMMANDS)
def test_each_command_has_its_help(run_vista: Vista, command: str) -> None:
    status, out, _ = run_vista(command, "--help")
    assert status == 0
    assert out.startswith(f"usage: vista {command}")


def without(name: str) -> list[EntryPoint]:
    return [point for point in cli.entry_points(group=cli.GROUP) if point.name != name]


@pytest.mark.parametrize("command", cli.DISTRIBUTION_OF)
def test_a_command_that_is_not_installed_names_its_distribution(
    run_vista: Vista, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    points = without(command)
    monkeypatch.setattr(cli, "entry_points", lambda group: points)
    source = cli.DISTRIBUTION_OF[command]
    assert_refused(run_vista(command, "DIR"), f"{command} needs {source}: pip install '{source}'")
    status, out, _ = run_vista("--help")
    assert status == 0 and f"'{source}'" in "".join(out.split())  # a line may end at a hyphen


def test_a_command_whose_package_is_not_there_names_its_distribution(
    run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = [*without("flights"), EntryPoint("flights", "vista_elsewhere.command.flights", cli.GROUP)]
    monkeypatch.setattr(cli, "entry_points", lambda group: points)
    assert_refused(run_vista("flights", "DIR"), "flights needs vista-stereo-eval")


def test_a_dependency_that_is_missing_names_the_distribution(
    run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    def execute(_: object) -> int:
        raise ModuleNotFoundError("No module named 'embreex'", name="embreex")

    monkeypatch.setattr(flights, "execute", execute)
    outcome = run_vista("flights", "DIR")
    assert_refused(outcome, "flights needs vista-stereo-eval: pip install 'vista-stereo-eval'")
    assert "embreex" in outcome[2]
