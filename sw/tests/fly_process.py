"""vista-fly in a process of its own, and the files that `vista prepare` makes for it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from vista import native
from vista.cli import main

VISTA_FLY = native.build_folder() / "bin" / "vista-fly"
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")


def environment(**more: str) -> dict[str, str]:
    """A stand-alone program: what is preloaded for Python's sake is not for it."""
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"} | more


def fly(*arguments: object, timeout: float = 120.0, **more: str) -> subprocess.CompletedProcess[str]:
    command = [str(VISTA_FLY), *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, env=environment(**more), cwd="/"
    )


def start(*arguments: object, **more: str) -> subprocess.Popen[str]:
    command = [str(VISTA_FLY), *map(str, arguments)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment(**more), cwd="/")


def prepare(folder: Path, sequence: Path, *options: object) -> list[object]:
    """The options of vista-fly that play the recording."""
    assert main(["prepare", str(sequence), "--out", str(folder), *map(str, options)]) == 0
    return ["--rig", folder / "rig.vista", "--recording", folder / "frames.vista"]


def timeless(file: Path) -> list[str]:
    """Lines without the value of processing_ms."""
    lines = file.read_text().splitlines()
    replaced = [re.subn(r'"processing_ms": [0-9.e-]+, ', "", line) for line in lines]
    assert all(count == 1 for _, count in replaced)
    return [line for line, _ in replaced]
