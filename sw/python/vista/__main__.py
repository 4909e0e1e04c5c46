"""The program `vista`, also `python -m vista`: loads the command line and calls it."""

from __future__ import annotations

import sys

from vista.errors import EXIT_INPUT
from vista.interruption import stopping_at_once


def main() -> int:
    try:
        with stopping_at_once():
            from vista import cli
    except ImportError as error:
        print(f"vista: not installed whole: {error}", file=sys.stderr)
        return EXIT_INPUT
    return cli.main()


if __name__ == "__main__":
    sys.exit(main())
