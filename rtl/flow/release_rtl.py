# SPDX-License-Identifier: Apache-2.0
"""Writes one build of the engine as a single file of plain Verilog: make release-rtl.

The sources are SystemVerilog that only the slang front end parses. The file has one top module, vista_stereo,
with the build parameters worked in, and is read by Yosys' own front end, Icarus Verilog and what else knows
Verilog-2005. Nothing is optimised: memories are inferred from it as from the sources.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tb" / "common"))
from tools import BUILD, sources  # noqa: E402

HEADER = """\
// SPDX-License-Identifier: Apache-2.0
// Stereo engine of VISTA {version}: {build}.
// Written by `make release-rtl` from the SystemVerilog of rtl/; see doc/rtl.md.

"""
# `enables` turns a write enable that was spread over the bits of a word back into the one signal that it is.
SCRIPT = """\
from pyosys import libyosys as ys
design = ys.Design()
for command in '''
read_slang --top vista_stereo {parameters} {files}
hierarchy -check -top vista_stereo
proc
opt_clean
select -set enables t:$memwr_v2 %ci1:+[EN] %ci1 t:$mux %i
simplemap @enables
opt_expr -mux_bool
memory_collect
opt_clean
bwmuxmap
opt_clean
check -assert
attrmap -remove src -remove hdlname -remove keep_hierarchy
write_verilog body.v
'''.strip().splitlines():
    ys.run_pass(command, design)
"""


@dataclass(frozen=True)
class Build:
    """What is worked into the file."""

    disparities: int
    block: int  # px
    width: int  # px
    rows: int = 0  # of the line buffer of rectification; 0: the core without front end
    points: int = 0  # control points of a camera

    @property
    def parameters(self) -> dict[str, int]:
        core = {"NumDisparities": self.disparities, "BlockSize": self.block, "MaxWidth": self.width}
        return core | ({"FrontEnd": 1, "NumRows": self.rows, "MaxPoints": self.points} if self.rows else {})

    @property
    def path(self) -> Path:
        """The place of the file unless it is told."""
        front_end = f"_r{self.rows}_p{self.points}" * bool(self.rows)
        name = f"vista_stereo_d{self.disparities}_b{self.block}_w{self.width}{front_end}.v"
        return BUILD / "release" / name

    def __str__(self) -> str:
        core = f"{self.disparities} disparities, block {self.block}, frames up to {self.width} px wide"
        front_end = f", with front end: {self.rows} rows, {self.points} control points of a camera"
        return core + front_end * bool(self.rows)


def release(build: Build, out: Path) -> None:
    folder = out.parent / f"{out.stem}.parts"
    folder.mkdir(parents=True, exist_ok=True)
    parameters = " ".join(f"-G {name}={value}" for name, value in build.parameters.items())
    files = " ".join(map(str, sources("vista_stereo.f")))
    (folder / "write.py").write_text(SCRIPT.format(parameters=parameters, files=files))
    with (folder / "yosys.log").open("w") as log:
        command = [str(ROOT / ".venv" / "bin" / "python"), "write.py"]
        code = subprocess.run(command, cwd=folder, stdout=log, stderr=log).returncode
    if code:
        raise RuntimeError(f"Yosys failed, see {folder}/yosys.log")
    version = (ROOT / "VERSION").read_text().strip()
    out.write_text(HEADER.format(version=version, build=build) + (folder / "body.v").read_text())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("disparities", type=int)
    parser.add_argument("block", type=int, help="px")
    parser.add_argument("width", type=int, help="px")
    parser.add_argument("--rows", type=int, default=0, help="of the rectification; 0: no front end")
    parser.add_argument("--points", type=int, default=2048, help="control points of a camera, with --rows")
    parser.add_argument("--out", type=Path, help="default: its own name in build/rtl/release")
    args = parser.parse_args()
    build = Build(args.disparities, args.block, args.width, args.rows, args.points if args.rows else 0)
    out = args.out or build.path
    try:
        release(build, out)
    except RuntimeError as error:
        sys.exit(f"release-rtl: {error}")
    print(out)


if __name__ == "__main__":
    main()
