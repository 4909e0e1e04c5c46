"""Print the default parameters as a TOML file.

vista config > my.toml
vista run SEQUENCE --out DIR --config my.toml
"""

from __future__ import annotations

import argparse

from vista.config import default_toml


def add_arguments(parser: argparse.ArgumentParser) -> None:
    del parser  # the command takes none


def execute(arguments: argparse.Namespace) -> int:
    del arguments
    print(default_toml(), end="", flush=True)
    return 0
