"""Docstrings and the comments of public headers begin with a verb or a noun, and not with a preposition."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = (
    "sw/python",
    "sw/bench",
    "sw/eval/vista_eval",
    "model",
    "rtl",
    "scripts",
    "sw/tests",
    "sw/eval/tests",
    "tb",
)
HEADERS = ("sw/include", "model/c", "model/systemc", "rtl/src")
PREPOSITION = (
    "About|Above|After|Against|Along|Among|As|At|Because|Before|Behind|Below|Beside|Between|Beyond|By|Down|During|For|"
    "From|If|In|Into|Of|On|Over|Per|Through|To|Towards|Under|Until|Up|When|Where|While|With|Within|Without"
)
BEGINS_WITH_ONE = re.compile(rf"(?:{PREPOSITION})\b")
COMMENT = re.compile(r"^[ \t]*(?:/\*+|//)[ \t]*(.*)", re.MULTILINE)


def python_docstrings(text: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield ast.get_docstring(node) or ""


def header_comments(text: str) -> Iterator[str]:
    """The first line of each comment that has a line to itself; `//` lines that follow each other are one."""
    end = -2
    for found in COMMENT.finditer(text):
        follows = found[0].lstrip().startswith("//") and found.start() == end + 1
        end = found.end()
        if not follows:
            yield found[1]


def half_sentences(texts: Iterator[str]) -> list[str]:
    return [text.partition("\n")[0] for text in texts if BEGINS_WITH_ONE.match(text)]


@pytest.mark.parametrize("folder", PYTHON)
def test_docstrings_say_what_a_thing_does_or_is(folder: str) -> None:
    found = {
        str(path.relative_to(ROOT)): half
        for path in sorted((ROOT / folder).rglob("*.py"))
        if (half := half_sentences(python_docstrings(path.read_text())))
    }
    assert found == {}


@pytest.mark.parametrize("folder", HEADERS)
def test_comments_of_headers_say_what_a_thing_does_or_is(folder: str) -> None:
    found = {
        str(path.relative_to(ROOT)): half
        for path in sorted((ROOT / folder).rglob("*"))
        if path.suffix in (".h", ".sv") and (half := half_sentences(header_comments(path.read_text())))
    }
    assert found == {}


def test_a_half_sentence_is_noticed() -> None:
    assert half_sentences(python_docstrings('def f():\n    """Of the left camera."""\n')) == [
        "Of the left camera."
    ]
    assert half_sentences(header_comments("  // Of the frame.\n  // With more.\nwire x;\n/* For y */\n")) == [
        "Of the frame.",
        "For y */",
    ]
    assert half_sentences(python_docstrings('"""Forwards words. Of these, few."""')) == []
