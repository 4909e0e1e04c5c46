"""Which version of VISTA this is."""

from __future__ import annotations

import subprocess
from importlib import metadata

from vista.native import CHECKOUT

DISTRIBUTION = "vista-stereo"  # in the package index, where `vista` is somebody else's


def installing(extra: str) -> str:
    """The command that installs VISTA with an extra."""
    return f"pip install '{DISTRIBUTION}[{extra}]'"


def version() -> str:
    """The file VERSION of a checkout, which may be newer than its installation, or the package's own."""
    if CHECKOUT:
        return (CHECKOUT / "VERSION").read_text(encoding="utf-8").strip()
    return metadata.version(DISTRIBUTION)


def commit() -> str | None:
    """What `git describe` says of the checkout that this runs from; None for an installed package."""
    if not CHECKOUT:
        return None
    command = ["git", "-C", str(CHECKOUT), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() or None if done.returncode == 0 else None
