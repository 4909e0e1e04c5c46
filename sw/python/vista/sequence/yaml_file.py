"""Reads YAML: tables and the lists of numbers in them; an error names the file and the key."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import yaml

from vista.errors import InputError
from vista.sequence.text import read_text

Table = dict[str, Any]


class _Loader(yaml.SafeLoader):
    """Knows OpenCV's matrices, too: tables with rows, cols, dt and data."""


def _construct_matrix(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _construct_matrix)


def read_table(path: Path) -> Table:
    text = read_text(path)
    if text.startswith("%YAML"):  # OpenCV's first line, %YAML:1.0, is none of YAML's own
        text = text.partition("\n")[2]
    try:
        table = yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, ValueError, RecursionError):
        raise InputError(path, "not readable as YAML") from None
    if not isinstance(table, dict):
        raise InputError(path, "not readable as YAML: expected keys with values")
    return {str(key): value for key, value in table.items()}


def numbers(path: Path, table: Table, key: str, counts: set[int] | None = None) -> list[float]:
    """The numbers of a list, of a list of lists, or of a matrix {rows, cols, data}, row by row."""
    value = table.get(key)
    if isinstance(value, dict):
        value = value.get("data")
    if not isinstance(value, list):
        raise InputError(path, f"{key} is missing or no list of numbers")
    if value and all(isinstance(row, list) for row in value):
        value = [item for row in value for item in row]
    values = [_number(path, key, item) for item in value]
    if counts is not None and len(values) not in counts:
        expected = " or ".join(map(str, sorted(counts)))
        raise InputError(path, f"{key} holds {len(values)} numbers, expected {expected}")
    return values


def number(path: Path, table: Table, key: str) -> float:
    if key not in table:
        raise InputError(path, f"{key} is missing")
    return _number(path, key, table[key])


def text_of(path: Path, table: Table, key: str) -> str:
    value = table.get(key)
    if not isinstance(value, str):
        raise InputError(path, f"{key} is missing or no text")
    return value


def table_of(path: Path, table: Table, key: str) -> Table:
    value = table.get(key)
    if not isinstance(value, dict):
        raise InputError(path, f"{key} is missing or no table")
    return value


def image_size(path: Path, values: list[float]) -> tuple[int, int]:
    width, height = values
    if not (width >= 1 and height >= 1 and width == int(width) and height == int(height)):
        raise InputError(path, f"an image of {width:g}x{height:g} px is none")
    return int(width), int(height)


def _number(path: Path, key: str, item: object) -> float:
    if isinstance(item, str):  # YAML 1.1 takes 1e-5 for text: it wants 1.0e-5
        try:
            item = float(item)
        except ValueError:
            item = None
    if isinstance(item, bool) or not isinstance(item, int | float):
        raise InputError(path, f"{key} holds a bad number")
    try:
        value = float(item)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(path, f"{key} holds a number that is not finite")
    return value
