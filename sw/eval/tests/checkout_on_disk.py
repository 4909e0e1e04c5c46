"""A checkout of a project with a log of scorings, none yet."""

from __future__ import annotations

import subprocess
from pathlib import Path

from vista_eval.metrics.scoring_log import LOG, git
from vista_eval.worlds.sampled.frozen import FROZEN


def make_checkout(root: Path) -> Path:
    for path in (LOG, *FROZEN.values()):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
    (root / "code.py").write_text("1\n")
    subprocess.run(["git", "init", "-q", root], check=True)
    commit(root, "first")
    return root


def commit(root: Path, subject: str) -> None:
    git(root, "add", "-A")
    git(root, "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-q", "--no-verify", "-m", subject)
