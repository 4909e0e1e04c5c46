"""Runs the SystemC program on one configuration and reads what it says of each frame."""

from __future__ import annotations

import json
import os
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vista.errors import InputError

from vista_throughput.system import SystemConfig

PROGRAM = Path("bin/vista_system")


@dataclass(frozen=True)
class Run:
    """A configuration and the JSON that came of it (doc/design/system-model.md, Output)."""

    config: SystemConfig
    output: dict[str, Any]

    @property
    def frames(self) -> list[dict[str, Any]]:
        return self.output["frames"]

    @property
    def delivered(self) -> list[dict[str, Any]]:
        return [frame for frame in self.frames if frame["host_end_ns"] is not None]

    @property
    def dropped(self) -> int:
        return self.output["totals"]["dropped"]


@dataclass
class Simulator:
    """Simulates each configuration once and remembers it."""

    program: Path
    option_of_key: dict[str, str] = field(default_factory=dict)  # to name what the user wrote
    runs: dict[str, Run] = field(default_factory=dict)

    def run(self, config: SystemConfig) -> Run:
        """Raises InputError with the program's one line for a configuration that it does not take."""
        text = config.text()
        if text not in self.runs:
            done = subprocess.run([self.program, "-", "-"], input=text, capture_output=True, text=True)
            if done.returncode:
                raise InputError("throughput", self._in_options(_last_line(done.stderr)))
            self.runs[text] = Run(config, json.loads(done.stdout))
        return self.runs[text]

    def _in_options(self, line: str) -> str:
        return re.sub(r"\w+", lambda word: self.option_of_key.get(word[0], word[0]), line)


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1].removeprefix("vista_system: ") if lines else "the simulation failed without a word"


def find_program() -> Path:
    """build/bin/vista_system of the checkout; ImportError, in one line, when it has not been built."""
    build = os.environ.get("VISTA_BUILD", "build")
    for parent in Path(__file__).resolve().parents:
        if (parent / build / PROGRAM).is_file():
            return parent / build / PROGRAM
    raise ImportError(f"throughput: {build}/{PROGRAM} is not built: run `make systemc`")
