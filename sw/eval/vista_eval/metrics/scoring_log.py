"""The log of all scorings of the test sets: one line each, never edited.

Every line carries the digest of the line before it, so that nothing can be changed, left out or put in
between without every later line telling so. That the end was not cut off is what the history of the checkout
tells: each version of the file begins with the version before it."""

from __future__ import annotations

import hashlib
import json
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from vista.errors import InputError

LOG = Path("doc/results/scorings.jsonl")
FIRST = "0" * 64  # "the line before" the first


def digest(line: str) -> str:
    return hashlib.sha256(line.encode()).hexdigest()


def broken_at(text: str) -> int | None:
    """The first line, from 1, that does not follow from the line before it; None: all do."""
    previous = FIRST
    for number, line in enumerate(text.splitlines(), start=1):
        try:
            if json.loads(line)["previous"] != previous:
                return number
        except (ValueError, KeyError, TypeError):
            return number
        previous = digest(line)
    return None


def read_log(root: Path) -> str:
    """Raises InputError if it was edited."""
    path = root / LOG
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    number = broken_at(text)
    if number is not None:
        raise InputError(f"{path}:{number}", "does not follow from the line before it: the log was edited")
    return text


def scored_splits(root: Path) -> set[str]:
    """Raises InputError if the log was edited. Its first lines name no split: there was one test set."""
    return {json.loads(line).get("split", "test") for line in read_log(root).splitlines()}


def append(root: Path, entry: dict[str, Any]) -> None:
    """entry: what was scored and found. Raises InputError if the log was edited."""
    lines = read_log(root).splitlines()
    content = {"previous": digest(lines[-1]) if lines else FIRST, **entry}
    with (root / LOG).open("a", encoding="utf-8") as file:
        file.write(json.dumps(content, allow_nan=False) + "\n")


# ---- the checkout ----


def git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def checkout_of(module: Path) -> Path:
    """The checkout that a file of this package lies in. Raises InputError if it lies in none."""
    try:
        return Path(git(module.parent, "rev-parse", "--show-toplevel").strip())
    except (OSError, subprocess.CalledProcessError):
        raise InputError("--split test", "is scored only in a checkout of the project") from None


def clean_commit(root: Path) -> str:
    """The commit of the checkout, in which nothing but the log has changed. Raises InputError otherwise."""
    status = git(root, "status", "--porcelain", "--untracked-files=all").splitlines()
    changes = [line for line in status if line[3:] != LOG.as_posix()]
    if changes:
        raise InputError(root, f"{changes[0][3:]} is not committed; the test set is scored as committed only")
    return git(root, "rev-parse", "HEAD").strip()


def now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
