# SPDX-License-Identifier: Apache-2.0
"""Icarus Verilog, and the replay of a recorded run on the plain Verilog of `make release-rtl`."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from registers import ADDRESS_BITS
from release_rtl import Build, release
from tools import BUILD, ROOT, digest_of, made_once, sources
from verilated import Config

UNPACKED = ROOT / "build" / "tools" / "icarus" / "root" / "usr"  # by scripts/setup_rtl.sh
REPLAY = ROOT / "tb" / "icarus" / "replay.v"


def commands() -> tuple[list[str], list[str]]:
    """How to compile and how to run."""
    if (UNPACKED / "bin" / "iverilog").is_file():
        library = str(UNPACKED / "lib" / "x86_64-linux-gnu" / "ivl")
        return [str(UNPACKED / "bin" / "iverilog"), "-B", library], [
            str(UNPACKED / "bin" / "vvp"),
            "-M",
            library,
        ]
    if shutil.which("iverilog") is None:
        raise FileNotFoundError("iverilog is missing: run `make setup-rtl`")
    return ["iverilog"], ["vvp"]


@dataclass(frozen=True)
class Replayed:
    clocks: int
    words: int
    with_x: int  # clocks in which valid data held an x
    differ: int  # clocks in which an output differed
    text: str


def build_of(config: Config) -> Build:
    points = config.points if config.rows else 0
    return Build(config.num_disparities, config.block_size, config.max_width, config.rows, points)


def released(config: Config) -> Path:
    """The file of `make release-rtl`, written anew when a source has changed."""
    build = build_of(config)
    makers = [ROOT / name for name in ("rtl/flow/release_rtl.py", "VERSION", "scripts/requirements/rtl.txt")]
    digest = digest_of([*sources("vista_stereo.f"), *makers], str(build))
    folder = build.path.with_suffix(".parts")
    return made_once(build.path, folder, digest, functools.partial(release, build, build.path))


def replay(design: Path, trace: Path) -> Replayed:
    """Runs the design through what was recorded. It takes half a minute, so what Icarus says is kept
    until the design, the trace or the pinned Icarus is another."""
    said = BUILD / "release" / f"{design.stem}.{trace.name}.said"
    digest = digest_of([design, trace, REPLAY, Path(__file__), ROOT / "scripts/requirements/icarus.txt"])
    made_once(said, said.with_suffix(".parts"), digest, functools.partial(_replay, design, trace, said))
    found = re.search(r"(\d+) clocks, (\d+) words, (\d+) with x, (\d+) differ", said.read_text())
    assert found, said.read_text()
    clocks, words, with_x, differ = map(int, found.groups())
    return Replayed(clocks, words, with_x, differ, said.read_text())


def _replay(design: Path, trace: Path, said: Path) -> None:
    compiler, runner = commands()
    program = BUILD / "release" / f"{design.stem}.vvp"
    subprocess.run(
        [*compiler, "-g2005", f"-DADDRESS_BITS={ADDRESS_BITS}", "-s", "replay", "-o", program,
         REPLAY, design],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    done = subprocess.run([*runner, program, f"+trace={trace}"], check=True, capture_output=True, text=True)
    said.write_text(done.stdout)
