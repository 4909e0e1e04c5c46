"""A program that is interrupted, as by Ctrl-C, while one of its modules loads."""

from __future__ import annotations


def while_loading(module: str, *arguments: str) -> str:
    """The source of `vista ARGUMENTS`, for `python -c`."""
    return f"""
import os, signal, sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
from vista.__main__ import main
sys.argv = {["vista", *arguments]!r}
sys.exit(main())
"""
