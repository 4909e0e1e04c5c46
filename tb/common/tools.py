"""Places of the simulator and of the sources of the engine."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "rtl"
# Of every build that is run. Lint is a target of its own; illegal build parameters stop here. FORMAL switches
# on the properties that `make formal` proves: they, and what the proofs assume, are checked in each clock.
VERILATOR_FLAGS = [
    "-Wno-fatal", "-Wno-lint", "-Werror-USERFATAL", "--assert", "--x-initial", "unique",
    "-DFORMAL", f"-I{ROOT / 'rtl' / 'formal'}",
]  # fmt: skip


def verilator_environment() -> dict[str, str]:
    """The environment to run the pinned Verilator in: `make setup-rtl` puts it under build/tools. All builds
    share the objects that are not of the design."""
    folder = Path(
        os.environ.get("VISTA_VERILATOR", ROOT / "build" / "tools" / "verilator" / "verilator" / "bin")
    )
    if not (folder / "verilator").is_file():
        raise FileNotFoundError(f"{folder}/verilator is missing: run `make setup-rtl`")
    environment = {
        k: v for k, v in os.environ.items() if k not in ("VERILATOR_ROOT", "MAKEFLAGS", "MAKELEVEL")
    }
    return environment | {
        "PATH": f"{folder}:{os.environ['PATH']}",
        "OBJCACHE": str(Path(__file__).with_name("object_cache.sh")),
        "VISTA_OBJECTS": str(BUILD / "objects"),
    }


def sources(file_list: str) -> list[Path]:
    """The files of rtl/NAME.f, nested lists included, in order."""
    files: list[Path] = []
    for line in (ROOT / "rtl" / file_list).read_text().splitlines():
        if line.startswith("-f "):
            files += sources(Path(line[3:]).name)
        elif line and not line.startswith("//"):
            files.append(ROOT / line)
    return files
