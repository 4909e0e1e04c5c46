"""The host's parameters: schema and defaults from parameters.toml, a user's values from --config FILE.toml."""

from __future__ import annotations

import functools
import math
import tomllib
from pathlib import Path
from typing import Any

from vista.errors import InputError

Values = dict[str, dict[str, Any]]  # section -> name -> value
Schema = dict[str, dict[str, Any]]

_PLACES = (Path(__file__).resolve().parents[2] / "parameters.toml", Path(__file__).parent / "parameters.toml")


@functools.cache
def schema() -> Schema:
    """section -> {"doc": text, name: {"type", "default", "doc", ...}}, in the order of the file."""
    path = next(place for place in _PLACES if place.is_file())
    return tomllib.loads(path.read_text(encoding="utf-8"))


def entries(section: str) -> dict[str, dict[str, Any]]:
    return {name: entry for name, entry in schema()[section].items() if isinstance(entry, dict)}


def defaults() -> Values:
    return {s: {name: entry["default"] for name, entry in entries(s).items()} for s in schema()}


def _problem(entry: dict[str, Any], value: Any) -> str | None:
    """Why a value does not do, or None."""
    if entry["type"] == "choice":
        return (
            None
            if value in entry["choices"]
            else f"must be one of {', '.join(entry['choices'])}, not {value!r}"
        )
    numeric = isinstance(value, int | float) and not isinstance(value, bool)
    if not numeric or (entry["type"] == "int" and not isinstance(value, int)):
        return f"must be {'an integer' if entry['type'] == 'int' else 'a number'}, not {value!r}"
    if not math.isfinite(value) or not entry["min"] <= value <= entry["max"]:
        return f"must be from {entry['min']} to {entry['max']}{_unit(entry)}, not {value!r}"
    return None


def _unit(entry: dict[str, Any]) -> str:
    return f" {entry['unit']}" if entry.get("unit") else ""


def load(config: Path | None) -> Values:
    """Defaults, overridden by the values of a file. InputError names the file and the parameter."""
    if config is None:
        return defaults()
    try:
        given = tomllib.loads(config.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(str(config), str(error)) from error
    return override(defaults(), given, str(config))


def override(values: Values, given: Values, culprit: str) -> Values:
    """values with those of given in their place, checked; culprit: where they come from, for InputError."""
    for section, content in given.items():
        if section not in values or not isinstance(content, dict):
            raise InputError(culprit, f"unknown section [{section}]")
        for name, value in content.items():
            if name not in values[section]:
                raise InputError(culprit, f"unknown parameter {section}.{name}")
            entry = entries(section)[name]
            problem = _problem(entry, value)
            if problem:
                raise InputError(culprit, f"{section}.{name} {problem}")
            values[section][name] = float(value) if entry["type"] == "float" else value
    return values


def default_toml() -> str:
    """A commented configuration file that holds every default."""
    lines: list[str] = []
    for section, content in schema().items():
        lines += [f"# {content['doc']}", f"[{section}]"]
        for name, entry in entries(section).items():
            lines.append(f"# {entry['doc']}")
            if entry["type"] == "choice":
                lines.append(f"# one of: {', '.join(entry['choices'])}")
            else:
                lines.append(f"# {entry['min']} .. {entry['max']}{_unit(entry)}")
            value = entry["default"]
            lines.append(f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value}")
        lines.append("")
    return "\n".join(lines)
