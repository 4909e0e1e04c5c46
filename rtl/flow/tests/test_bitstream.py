# SPDX-License-Identifier: Apache-2.0
"""Which seed of the placer makes the bitstream."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import make_bitstream
import pytest


def seeds(monkeypatch: pytest.MonkeyPatch, reached_mhz: dict[int, float | None]) -> None:
    """Replaces place and route: what each seed reaches of 45 MHz; None: it does not come to an end."""

    def place_and_route(folder: Path, seed: int, timeout_s: float) -> dict[str, Any]:
        reached = reached_mhz[seed]
        if reached is None:
            raise subprocess.TimeoutExpired("nextpnr", timeout_s)
        return {"seed": seed, "clocks": [{"needed_mhz": 45.0, "reached_mhz": reached}]}

    monkeypatch.setattr(make_bitstream, "place_and_route", place_and_route)


def test_the_first_seed_that_ends_and_meets_the_timing_is_taken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seeds(monkeypatch, {1: None, 2: 44.9, 3: 45.0, 4: 60.0})
    assert make_bitstream.first_that_is_met(Path(), [1, 2, 3, 4], 2400.0)["seed"] == 3
    assert capsys.readouterr().err == "bitstream: seed 1 was left after 40 minutes\n"


def test_without_such_a_seed_there_is_no_bitstream(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds(monkeypatch, {1: None, 2: 44.9})
    with pytest.raises(SystemExit, match="not met with any seed"):
        make_bitstream.first_that_is_met(Path(), [1, 2], 60.0)


@pytest.mark.slow
def test_no_pin_is_asked_for_twice(tmp_path: Path) -> None:
    make_bitstream.gateware(tmp_path, [16, 5, 64, 16, 64], 45.0, "192.168.1.50", cameras=True)
    sites = re.findall(r'LOCATE COMP "(.*)" SITE "(\w+)"', (tmp_path / "board.lpf").read_text())
    pins = [pin for _, pin in sites]
    assert sum(name.startswith("sensor") for name, _ in sites) == 2 * 11
    assert not {name for name, pin in sites if pins.count(pin) > 1}
