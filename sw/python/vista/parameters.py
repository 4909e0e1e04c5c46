"""Parameters: their definition in parameters.toml, and the values of a --config file."""

from __future__ import annotations

import functools
import math
import tomllib
from pathlib import Path
from typing import Any

from vista.errors import InputError
from vista.sequence.text import read_text

Values = dict[str, dict[str, Any]]  # section -> name -> value
Schema = dict[str, dict[str, Any]]

_PACKAGE = Path(__file__).resolve().parent
_PLACES = (_PACKAGE / "parameters.toml", _PACKAGE.parents[1] / "parameters.toml")  # installed; in a checkout


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


def load(config: Path | None, base: Values | None = None) -> Values:
    """base (the defaults), overridden by the values of a file. InputError names file and parameter."""
    values = base or defaults()
    if config is None:
        return values
    try:
        given = tomllib.loads(read_text(config))
    except tomllib.TOMLDecodeError as error:
        raise InputError(config, f"not readable as TOML: {error}") from None
    for section, content in given.items():
        if section not in values or not isinstance(content, dict):
            raise InputError(config, f"unknown section [{section}]")
        for name, value in content.items():
            if name not in values[section]:
                raise InputError(config, f"unknown parameter {section}.{name}")
            entry = entries(section)[name]
            problem = _problem(entry, value)
            if problem:
                raise InputError(config, f"{section}.{name} {problem}")
            values[section][name] = float(value) if entry["type"] == "float" else value
    for section, name, limit in _limits():
        value, highest = values[section][name], values[section][limit]
        if value > highest:
            problem = f"must be at most {section}.{limit} ({highest}), not {value}"
            raise InputError(config, f"{section}.{name} {problem}")
    return values


def _limits() -> list[tuple[str, str, str]]:
    """Section, parameter, and the parameter of that section that it must not exceed."""
    return [
        (section, name, entry["at_most"])
        for section in schema()
        for name, entry in entries(section).items()
        if "at_most" in entry
    ]


def flat(values: Values) -> dict[str, Any]:
    """ "section.name" -> value, a choice by its name."""
    return {f"{section}.{name}": value for section in values for name, value in values[section].items()}


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
