"""Lines of obstacles.jsonl, judged by the published schema."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator
from vista.obstacle_line import schema_text

SCHEMA: dict[str, Any] = json.loads(schema_text())
VALIDATOR = Draft202012Validator(SCHEMA)


def valid_lines(folder: Path) -> list[dict[str, Any]]:
    """The lines of a result folder; each obeys the schema and holds no key that is not described."""
    lines = [json.loads(line) for line in (folder / "obstacles.jsonl").read_text().splitlines()]
    assert lines
    for line in lines:
        VALIDATOR.validate(line)
        assert_described(line, SCHEMA)
    return lines


def assert_described(value: object, schema: dict[str, Any]) -> None:
    """Every key of the value stands in the schema: a key that is not described would have no meaning."""
    if isinstance(value, dict):
        assert value.keys() == schema["properties"].keys()
        for key, content in value.items():
            assert_described(content, schema["properties"][key])
    elif isinstance(value, list):
        for item in value:
            assert_described(item, schema["items"])
