"""Reads numbers from text files; an error names the file and the line."""

from __future__ import annotations

import math
import os
import shlex
import string
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

from vista.errors import InputError

PLAIN = string.ascii_letters + string.digits + "/._-+@%,:= "


def printable(name: str) -> str:
    """The name of a file with a replacement character for every byte that is not UTF-8."""
    return os.fsencode(name).decode("utf-8", "replace")


def shell_quoted(path: str | Path) -> str:
    """The path as a shell takes it, whatever its bytes are; one without special characters stays as it is."""
    raw = os.fsencode(path)
    try:
        return shlex.quote(raw.decode())
    except UnicodeDecodeError:
        return "$'" + "".join(chr(byte) if chr(byte) in PLAIN else f"\\x{byte:02x}" for byte in raw) + "'"


def read_text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(path, "no such file") from None
    except UnicodeDecodeError:
        raise InputError(path, "not a text file") from None
    except OSError as error:
        raise InputError(path, (error.strerror or "cannot be read").lower()) from None


def data_lines(path: Path) -> Iterator[tuple[str, str]]:
    """(`file:line`, stripped text) of each line that is neither empty nor a # comment."""
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        text = line.strip()
        if text and not text.startswith("#"):
            yield f"{path}:{number}", text


def finite(culprit: str | Path, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(culprit, f"bad number {text.strip()!r}") from None
    if not math.isfinite(value):
        raise InputError(culprit, f"number is not finite: {text.strip()}")
    return value


def finite_row(culprit: str | Path, fields: list[str], count: int) -> list[float]:
    if len(fields) != count:
        raise InputError(culprit, f"{len(fields)} numbers, expected {count}")
    return [finite(culprit, field) for field in fields]


def timestamp_ns(culprit: str | Path, text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        raise InputError(culprit, f"bad timestamp {text.strip()!r}") from None
    if not 0 <= value < 2**63:
        raise InputError(culprit, f"timestamp out of range: {value}")
    return value


def seconds_ns(culprit: str | Path, text: str) -> int:
    """Decimal seconds; all their digits count, more than a float has."""
    seconds = finite(culprit, text)
    if not 0.0 <= seconds < 9.2e9:  # what 64 bits hold
        raise InputError(culprit, f"time out of range: {text} s")
    return round(Decimal(text) * 1_000_000_000) if seconds > 0.0 else 0


def check_increasing(culprit: str | Path, previous_ns: int | None, t_ns: int) -> None:
    if previous_ns is not None and t_ns <= previous_ns:
        raise InputError(culprit, f"time does not increase: {t_ns} ns after {previous_ns} ns")
