"""Places of the simulator and of the sources of the engine."""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "rtl"
# Of every build that is run. Lint is a target of its own; illegal build parameters stop here. VISTA_ASSERT
# switches on the properties that `make formal` proves: they, and what the proofs assume, are checked in each
# clock.
VERILATOR_FLAGS = [
    "-Wno-fatal", "-Wno-lint", "-Werror-USERFATAL", "--assert", "--x-initial", "unique",
    "-DVISTA_ASSERT", f"-I{ROOT / 'rtl' / 'formal'}",
]  # fmt: skip


def verilator_environment() -> dict[str, str]:
    """The environment to run the pinned Verilator in: `make setup-rtl` puts it under build/tools. All builds
    share the objects that are not of the design, which is compiled as one: it takes half as long."""
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
        "MAKEFLAGS": "VM_PARALLEL_BUILDS=0",
        "OBJCACHE": str(Path(__file__).with_name("object_cache.sh")),
        "VISTA_OBJECTS": str(BUILD / "objects"),
    }


def digest_of(files: Iterable[Path], *texts: str) -> str:
    """Names what is made of these files with these texts, such as a command."""
    parts = [file.read_bytes() for file in files] + [text.encode() for text in texts]
    return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()


def made_once(product: Path, folder: Path, digest: str, make: Callable[[], None]) -> Path:
    """The product, which `make` makes if it was not made of the same: the digest is kept in the folder.

    One process makes it while the others wait."""
    folder.mkdir(parents=True, exist_ok=True)
    stamp = folder / "digest"
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (product.is_file() and stamp.is_file() and stamp.read_text() == digest):
            stamp.unlink(missing_ok=True)
            make()
            stamp.write_text(digest)
    return product


def sources(file_list: str) -> list[Path]:
    """The files of rtl/NAME.f, nested lists included, in order."""
    files: list[Path] = []
    for line in (ROOT / "rtl" / file_list).read_text().splitlines():
        if line.startswith("-f "):
            files += sources(Path(line[3:]).name)
        elif line and not line.startswith("//"):
            files.append(ROOT / line)
    return files


def bench_sources(file_list: str) -> list[Path]:
    """The same, with the memory of which a use of what is undefined shows."""
    memory = Path(__file__).with_name("vista_memory.sv")
    return [memory if file.name == memory.name else file for file in sources(file_list)]
