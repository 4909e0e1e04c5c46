"""The command line: `vista COMMAND ...`. A module each, found by the entry points `vista.commands`.

Only the module of the command that was named is loaded; of the others the first line is read, for the help.
"""

from __future__ import annotations

import argparse
import ast
import io
import os
import sys
from importlib.machinery import PathFinder
from importlib.metadata import EntryPoint, distribution
from importlib.util import find_spec
from pathlib import Path

import cv2

from vista.errors import EXIT_INPUT, EXIT_INTERRUPTED, EXIT_OK, InputError, JobsError
from vista.interruption import stopping_at_once
from vista.version import DISTRIBUTION, version

GROUP = "vista.commands"
EPILOG = """\
exit status:
  0    done
  2    bad input or usage; one line on stderr names the culprit, nothing is half written
  3    of many jobs, some failed; a line on stderr names each, the others are done and kept
  130  interrupted (Ctrl-C or SIGTERM); what was written is valid
"""


class Parser(argparse.ArgumentParser):
    """Usage errors take one line, like every other bad input."""

    def error(self, message: str) -> None:  # type: ignore[override]
        self.exit(EXIT_INPUT, f"vista: {message} (see {self.prog} --help)\n")


def make_parser(named: str | None) -> argparse.ArgumentParser:
    """named: the command on the command line, the only one whose arguments are known."""
    parser = Parser(
        prog="vista",
        description="Stereo obstacle detection for aircraft.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"vista {version()}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for point in commands_known().values():
        summary = summary_of(point)
        if summary is None:
            if point.name == named:
                raise missing(point)
            commands.add_parser(point.name, help=str(missing(point)))
        elif point.name == named:
            add_command(commands, point, summary)
        else:
            commands.add_parser(point.name, help=summary)
    return parser


def commands_known() -> dict[str, EntryPoint]:
    """The commands by their names, in the order of pyproject.toml. Those of other distributions name the
    extra that installs them."""
    points = distribution(DISTRIBUTION).entry_points.select(group=GROUP)
    return {point.name: point for point in points}


def add_command(commands: argparse._SubParsersAction[Parser], point: EntryPoint, summary: str) -> None:
    module = point.load()
    parser = commands.add_parser(
        point.name,
        help=summary,
        description=module.__doc__,
        epilog=getattr(module, "EPILOG", EPILOG),  # where its statuses mean something else
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    module.add_arguments(parser)
    parser.set_defaults(execute=module.execute)


def summary_of(point: EntryPoint) -> str | None:
    """The first line of the module's docstring, without loading it; None if its package is not there."""
    package, _, below = point.module.partition(".")
    spec = find_spec(package)
    if spec is None or spec.submodule_search_locations is None:
        return None
    places = [str(Path(place, *below.split(".")[:-1])) for place in spec.submodule_search_locations]
    module = PathFinder.find_spec(point.module.rpartition(".")[2], places)
    if module is None or module.origin is None:
        return None
    text = ast.get_docstring(ast.parse(Path(module.origin).read_text(encoding="utf-8"))) or ""
    return text.partition("\n")[0].rstrip(".")


def missing(point: EntryPoint, reason: str = "") -> InputError:
    """Say with which extra a command is missing; reason: what Python says of what it imports."""
    if not point.extras:
        return InputError(f"{point.name} is not installed whole", reason or f"install {DISTRIBUTION} anew")
    source = f"{DISTRIBUTION}[{point.extras[0]}]"
    because = f" ({reason})" if reason else ""
    return InputError(f"{point.name} needs {source}", f"pip install '{source}'{because}")


def named_command(arguments: list[str]) -> str | None:
    """The first word that is not an option: no option before the command takes a value."""
    return next((word for word in arguments if not word.startswith("-")), None)


def main(arguments: list[str] | None = None) -> int:
    # OpenCV's own lines about unreadable images would come on top of ours.
    quiet = cv2.setLogLevel if hasattr(cv2, "setLogLevel") else cv2.utils.logging.setLogLevel  # OpenCV 4, 5
    quiet(0)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files that are not UTF-8
    arguments = sys.argv[1:] if arguments is None else arguments
    named = named_command(arguments)
    try:
        with stopping_at_once():
            parsed = make_parser(named).parse_args(arguments)
        return int(parsed.execute(parsed))
    except InputError as error:
        print(f"vista: {error}", file=sys.stderr)
        return EXIT_INPUT
    except JobsError as error:
        if error.failed > 1:
            print(f"vista: {error}", file=sys.stderr)
        return error.status
    except ModuleNotFoundError as error:
        point = commands_known().get(named or "")
        print(f"vista: {error if point is None else missing(point, str(error))}", file=sys.stderr)
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
        print("vista: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
