"""Print the default parameters as a TOML file, or the format of obstacles.jsonl.

Change the file and use it for a run; a file may also hold only the parameters that it changes:

vista config > my.toml
vista run SEQUENCE --out DIR --config my.toml
"""

from __future__ import annotations

import argparse

from vista.errors import EXIT_OK
from vista.obstacle_line import schema_text
from vista.parameters import default_toml


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--schema", action="store_true", help="print the JSON Schema of a line of obstacles.jsonl instead"
    )


def execute(arguments: argparse.Namespace) -> int:
    print(schema_text() if arguments.schema else default_toml(), end="", flush=True)
    return EXIT_OK
