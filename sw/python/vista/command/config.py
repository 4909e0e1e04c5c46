"""Print the default parameters as a TOML file.

Change the file and use it for a run; a file may also hold only the parameters that it changes:

vista config > my.toml
vista run SEQUENCE --out DIR --config my.toml
"""

from __future__ import annotations

import argparse

from vista.errors import EXIT_OK
from vista.parameters import default_toml


def add_arguments(parser: argparse.ArgumentParser) -> None:
    del parser  # the command takes none


def execute(arguments: argparse.Namespace) -> int:
    del arguments
    print(default_toml(), end="", flush=True)
    return EXIT_OK
