"""Commands are found by entry points: loaded when named, and named with their extra when missing."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint, metadata

import pytest
from command_line import Vista, assert_refused
from vista import cli
from vista.version import DISTRIBUTION
from vista_eval.command import flights

SLOW_TO_LOAD = ("matplotlib", "embreex", "vista_eval", "vista_throughput")


def test_help_names_all_commands_in_order_and_loads_none() -> None:
    program = f"""
import sys
from vista import cli
from vista.version import DISTRIBUTION
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
    assert named[0] == "record" and named[-1] == "config"
    assert named == list(cli.commands_known())
    assert "pip install" not in done.stdout


@pytest.mark.parametrize("command", cli.commands_known())
def test_each_command_has_its_help(run_vista: Vista, command: str) -> None:
    status, out, _ = run_vista(command, "--help")
    assert status == 0
    assert out.startswith(f"usage: vista {command}")


@pytest.mark.parametrize(
    ("command", "extra"),
    [("flights", "eval"), ("worlds", "eval"), ("dataset", "dataset"), ("throughput", "throughput")],
)
def test_a_command_that_is_not_installed_names_its_extra(
    run_vista: Vista, monkeypatch: pytest.MonkeyPatch, command: str, extra: str
) -> None:
    elsewhere = EntryPoint(command, f"vista_elsewhere.{command} [{extra}]", cli.GROUP)
    points = cli.commands_known() | {command: elsewhere}
    monkeypatch.setattr(cli, "commands_known", lambda: points)
    source = f"vista-stereo[{extra}]"
    assert_refused(run_vista(command, "DIR"), f"{command} needs {source}: pip install '{source}'")
    status, out, _ = run_vista("--help")
    assert status == 0 and f"'{source}'" in "".join(out.split())  # a line may end at a hyphen


def test_every_extra_of_a_command_can_be_installed() -> None:
    offered = metadata(DISTRIBUTION).get_all("Provides-Extra")
    extras = {extra for point in cli.commands_known().values() for extra in point.extras}
    assert extras and extras <= set(offered)


def test_a_dependency_that_is_missing_names_the_extra(
    run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    def execute(_: object) -> int:
        raise ModuleNotFoundError("No module named 'embreex'", name="embreex")

    monkeypatch.setattr(flights, "execute", execute)
    outcome = run_vista("flights", "DIR")
    assert_refused(outcome, "flights needs vista-stereo[eval]: pip install 'vista-stereo[eval]'")
    assert "embreex" in outcome[2]
