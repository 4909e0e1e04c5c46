"""Which version of VISTA this is."""

from __future__ import annotations

import subprocess
from importlib import metadata
from pathlib import Path

_CHECKOUT = Path(__file__).resolve().parents[3]


def version() -> str:
    """The file VERSION of a checkout, which may be newer than its installation, or the package's own."""
    file = _CHECKOUT / "VERSION"
    if _is_checkout() and file.is_file():
        return file.read_text(encoding="utf-8").strip()
    return metadata.version("vista")


def commit() -> str | None:
    """What `git describe` says of the checkout that this runs from; None for an installed package."""
    if not _is_checkout():
        return None
    command = ["git", "-C", str(_CHECKOUT), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() or None if done.returncode == 0 else None


def _is_checkout() -> bool:
    return (_CHECKOUT / "pyproject.toml").is_file() and (_CHECKOUT / "sw" / "python" / "vista").is_dir()
