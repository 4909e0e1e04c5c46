"""Runs the SystemC program on one configuration and reads what it says of each frame."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vista import native
from vista.errors import InputError

from vista_throughput.system import SystemConfig

PROGRAM = "vista_system"


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
    """The simulator of the checkout; ImportError, in one line, when it has not been built."""
    return native.program_path(PROGRAM, "systemc")
