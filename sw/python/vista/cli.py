"""The command line: `vista COMMAND ...`. One module of vista.command for each command."""

from __future__ import annotations

import argparse
import os
import sys

import cv2

from vista.command import config, disparity, figures, flights, run, scenes, throughput
from vista.errors import EXIT_INPUT, EXIT_INTERRUPTED, EXIT_OK, InputError

EPILOG = """\
exit status:
  0    done
  2    bad input or usage; one line on stderr names the culprit, nothing is half written
  130  interrupted (Ctrl-C or SIGTERM); what was written is valid
"""


class Parser(argparse.ArgumentParser):
    """Usage errors take one line, like every other bad input."""

    def error(self, message: str) -> None:  # type: ignore[override]
        self.exit(EXIT_INPUT, f"vista: {message} (see {self.prog} --help)\n")


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="vista",
        description="Stereo obstacle detection for aircraft.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for module in (run, disparity, flights, figures, scenes, throughput, config):
        name = module.__name__.rpartition(".")[2]
        summary, _, _ = module.__doc__.partition("\n")
        subparser = commands.add_parser(
            name,
            help=summary.rstrip("."),
            description=module.__doc__,
            epilog=EPILOG,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        module.add_arguments(subparser)
        subparser.set_defaults(execute=module.execute)
    return parser


def main(arguments: list[str] | None = None) -> int:
    # OpenCV's own lines about unreadable images would come on top of ours.
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        parsed = make_parser().parse_args(arguments)
        return parsed.execute(parsed)
    except InputError as error:
        print(f"vista: {error}", file=sys.stderr)
        return EXIT_INPUT
    except ImportError as error:  # the native libraries are not built
        print(f"vista: {error}", file=sys.stderr)
        return EXIT_INPUT
    except BrokenPipeError:  # `vista config | head`: the reader has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OK
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        print(f"vista: {error.filename or 'system'}: {reason}", file=sys.stderr)
        return EXIT_INPUT
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
