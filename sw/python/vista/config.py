"""Parameters of a run from one TOML file: the section [engine] for the stereo engine, all others for the host."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from vista import parameters
from vista.engine import EngineParameters
from vista.errors import InputError
from vista.sequence.text import read_text

ENGINE = "engine"
OFF = "off"  # lr_max_diff = "off": TOML has no word for None


@dataclass(frozen=True)
class RunParameters:
    engine: EngineParameters
    host: parameters.Values

    def as_sections(self) -> dict[str, dict[str, Any]]:
        return {ENGINE: asdict(self.engine), **self.host}


def load_config(path: Path | None, engine: str = "golden") -> RunParameters:
    """The defaults for the engine of that name, with what the file changes. InputError names file and parameter."""
    table: dict[str, Any] = {}
    if path is not None:
        try:
            table = tomllib.loads(read_text(path))
        except tomllib.TOMLDecodeError as error:
            raise InputError(path, f"not readable as TOML: {error}") from None
    engine_parameters = EngineParameters()
    if engine == "opencv":  # StereoBM's own check compares other things
        engine_parameters = replace(engine_parameters, lr_max_diff=None)
    changes = table.pop(ENGINE, {})
    if not isinstance(changes, dict):
        raise InputError(path, f"{ENGINE} is no section")
    known = asdict(engine_parameters)
    for name, value in changes.items():
        if name not in known:
            raise InputError(path, f"unknown parameter {ENGINE}.{name}; known: {', '.join(known)}")
        known[name] = None if name == "lr_max_diff" and value == OFF else value
    return RunParameters(
        EngineParameters(**known), parameters.override(parameters.defaults(), table, str(path))
    )


def default_toml() -> str:
    """Every default, commented, as a file that load_config reads."""
    lines = ['# The stereo engine; lr_max_diff may be "off".', f"[{ENGINE}]"]
    for name, value in asdict(EngineParameters()).items():
        lines.append(f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}")
    return "\n".join(lines) + "\n\n" + parameters.default_toml()
