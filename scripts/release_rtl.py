"""Writes one build of the engine as a single file of plain Verilog: make release-rtl.

The sources are SystemVerilog that only the slang front end parses. The file has one module, vista_stereo,
with the build parameters worked in, and is read by Yosys' own front end, Icarus Verilog and what else knows
Verilog-2005. Nothing is optimised: memories are inferred from it as from the sources.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tb" / "common"))
from tools import BUILD, sources  # noqa: E402

HEADER = """\
// SPDX-License-Identifier: Apache-2.0
// Stereo engine of VISTA {version}: {disparities} disparities, block {block}, frames up to {width} px wide.
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


def default_path(disparities: int, block: int, width: int) -> Path:
    return BUILD / "release" / f"vista_stereo_d{disparities}_b{block}_w{width}.v"


def release(disparities: int, block: int, width: int, out: Path) -> None:
    folder = out.parent / f"{out.stem}.parts"
    folder.mkdir(parents=True, exist_ok=True)
    parameters = f"-G NumDisparities={disparities} -G BlockSize={block} -G MaxWidth={width}"
    files = " ".join(map(str, sources("vista_stereo.f")))
    (folder / "write.py").write_text(SCRIPT.format(parameters=parameters, files=files))
    with (folder / "yosys.log").open("w") as log:
        command = [str(ROOT / ".venv" / "bin" / "python"), "write.py"]
        code = subprocess.run(command, cwd=folder, stdout=log, stderr=log).returncode
    if code:
        raise RuntimeError(f"Yosys failed, see {folder}/yosys.log")
    version = (ROOT / "VERSION").read_text().strip()
    header = HEADER.format(version=version, disparities=disparities, block=block, width=width)
    out.write_text(header + (folder / "body.v").read_text())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("disparities", type=int)
    parser.add_argument("block", type=int, help="px")
    parser.add_argument("width", type=int, help="px")
    parser.add_argument("--out", type=Path, help="default: build/rtl/release/vista_stereo_dD_bB_wW.v")
    args = parser.parse_args()
    build = (args.disparities, args.block, args.width)
    out = args.out or default_path(*build)
    try:
        release(*build, out)
    except RuntimeError as error:
        sys.exit(f"release-rtl: {error}")
    print(out)


if __name__ == "__main__":
    main()
