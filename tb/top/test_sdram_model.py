"""The memory of the board's system model against LiteDRAM itself: every clock in which a port is served."""

from __future__ import annotations

import os
import subprocess
from collections import deque
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tools import ROOT, digest_of

pytestmark = pytest.mark.slow

TRACE = ROOT / "build" / "bin" / "vista_sdram_trace"
CLOCK_HZ = 45e6
PORTS, ROW_WORDS, BANKS = 6, 256, 4
WORDS = 120  # of each port
SEED = int(os.environ.get("VISTA_SEED", 1))  # sees a change of each rule that 0 sees, and two more


@dataclass(frozen=True)
class Command:
    port: int
    writes: bool
    address: int  # of a word
    clock: int  # from which it is offered


def streams(rng: np.random.Generator, count: int) -> list[Command]:
    """What masters do: runs of words in order, some as fast as they can, others with pauses, in rows that
    may be another port's or of the same bank."""
    commands = []
    for port in range(PORTS):
        pause = rng.choice([0.0, 0.3, 2.0, 20.0])
        clock = int(rng.integers(10, 200))
        left = count
        while left > 0:
            run = min(left, int(rng.integers(1, 120)))
            address = int(rng.integers(4 * BANKS * ROW_WORDS))
            writes = bool(rng.integers(2)) if port == 0 else port % 2 == 1
            for word in range(run):
                commands.append(Command(port, writes, address + word, clock))
                clock += int(rng.poisson(pause))
            clock += int(rng.choice([0, 0, 5, 400]))
            left -= run
    return commands


def model(commands: list[Command]) -> list[tuple[int, int]]:
    lines = [f"{c.port} {c.writes:d} {c.address} {c.clock}" for c in commands]
    text = "\n".join([f"{CLOCK_HZ:g}", *lines])
    done = subprocess.run([TRACE], input=text, capture_output=True, text=True, check=True)
    return [(int(a), int(b)) for a, b in map(str.split, done.stdout.splitlines())]


def litedram(commands: list[Command]) -> list[tuple[int, int]]:
    """The same through LiteDRAM's controller and crossbar, as Migen simulates them."""
    from litedram.core.controller import LiteDRAMController
    from litedram.core.crossbar import LiteDRAMCrossbar
    from litedram.modules import M12L64322A
    from litedram.phy.model import get_sdram_phy_settings
    from migen import Module, run_simulation

    module = M12L64322A(CLOCK_HZ, "1:1")
    settings = get_sdram_phy_settings("SDR", 32, CLOCK_HZ)
    top = Module()
    top.submodules.controller = controller = LiteDRAMController(
        settings, module.geom_settings, module.timing_settings, CLOCK_HZ
    )
    top.submodules.crossbar = crossbar = LiteDRAMCrossbar(controller.interface)
    ports = [crossbar.get_port("both") for _ in range(PORTS)]
    taken, moved = [-1] * len(commands), [-1] * len(commands)

    def drive() -> Generator[Any, Any, None]:
        offered = [deque(i for i, c in enumerate(commands) if c.port == p) for p in range(PORTS)]
        inside: list[deque[int]] = [deque() for _ in range(PORTS)]
        valid, clock, left = [False] * PORTS, 0, len(commands)
        while left:
            for p, port in enumerate(ports):
                if (yield port.rdata.valid) or (yield port.wdata.ready):
                    moved[inside[p].popleft()] = clock
                    left -= 1
                if valid[p] and (yield port.cmd.ready):
                    taken[offered[p][0]] = clock
                    inside[p].append(offered[p].popleft())
                valid[p] = bool(offered[p]) and commands[offered[p][0]].clock <= clock + 1
                yield port.cmd.valid.eq(valid[p])
                if valid[p]:
                    command = commands[offered[p][0]]
                    yield port.cmd.we.eq(command.writes)
                    yield port.cmd.addr.eq(command.address)
            clock += 1
            yield

    run_simulation(top, drive())
    return list(zip(taken, moved, strict=True))


def test_every_port_is_served_in_the_clock_in_which_litedram_serves_it(cache: pytest.Cache) -> None:
    """Migen takes 20 s for what depends on nothing of ours: it is kept for as long as LiteDRAM and this file
    are the same."""
    print(f"rerun: VISTA_SEED={SEED} .venv/bin/python -m pytest tb/top/test_sdram_model.py")
    commands = streams(np.random.default_rng(SEED), WORDS)
    kept = "litedram/" + digest_of([Path(__file__), ROOT / "scripts/requirements/board.txt"], str(SEED))
    clocks = cache.get(kept, None) or litedram(commands)
    cache.set(kept, clocks)
    differing = [
        (command, mine, theirs)
        for command, mine, theirs in zip(commands, model(commands), map(tuple, clocks), strict=True)
        if mine != theirs
    ]
    assert not differing, f"{len(differing)} of {len(commands)} differ, first {differing[0]}"
