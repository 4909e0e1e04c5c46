"""Calibrate a pair of cameras from pictures of a board, or convert calibration files.

With --board, SOURCE shows the board to both cameras at once, some 15 to 30 times in different places:
  folders     NAME_left.EXT and NAME_right.EXT, or equal names in the folders left and right
  one video   with both cameras side by side or one above the other
  two videos  of the left and of the right camera, which start at the same moment
  --camera    in place of SOURCE: cameras that run. Pairs in which the board is held still in a new place are
              kept in the folder pictures of FOLDER; lines say what to show next. It ends when nothing is
              missing, or with Ctrl-C
FOLDER then holds calibration.toml, which `vista run` reads, and report.html, which says how good it is and
what to photograph next.

Without --board, SOURCE is a calibration, which is recognised by its keys and written as --to says:
  toml    calibration.toml                  opencv  one file, or intrinsics.yml and extrinsics.yml
  ros     camera_info of both cameras       euroc   sensor.yaml of the left and of the right camera
  kalibr  camchain.yaml                     boofcv  stereo.yaml

BOARD is one of:
  chessboard:COLSxROWS:SQUARE_MM                        COLS and ROWS count inner corners
  charuco:COLSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY]    COLS and ROWS count squares; such as 4X4_250
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator
from contextlib import closing
from pathlib import Path

from tqdm import tqdm

from vista.calibration.advice import advice
from vista.calibration.board import Board, parse_board
from vista.calibration.calibrate import Calibrated, calibrate
from vista.calibration.collect import Collector
from vista.calibration.formats import FORMATS, read_rig, write_rig
from vista.calibration.formats.common import Options
from vista.calibration.pictures import Picture, read_pictures
from vista.calibration.print_board import board_svg
from vista.calibration.report import render_report
from vista.calibration.rig import rig_of
from vista.calibration.solve import LENSES
from vista.command.source_arguments import (
    ASKED_SIZE,
    add_camera,
    add_pair_tolerance,
    add_size_px,
    add_video,
    open_cameras,
)
from vista.errors import EXIT_OK, InputError
from vista.geometry import Lens
from vista.interruption import Interruption
from vista.live.latest import Latest
from vista.live.recorder import PairFolder
from vista.live.source import Shot, Source, newest_shots
from vista.output import make_folder, write_atomically
from vista.sequence import video
from vista.sequence.image import EXTENSIONS
from vista.sequence.options import Options as SourceOptions
from vista.sequence.text import printable, shell_quoted

UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001}
REPORT, PICTURES = "report.html", "pictures"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "sources", type=Path, nargs="*", metavar="SOURCE", help="pictures, or calibration files"
    )
    add_camera(parser, "left and right camera, or one that delivers both views side by side", required=False)
    add_pair_tolerance(parser)
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="folder to write into")
    parser.add_argument("--board", metavar="BOARD", help="what the pictures show, see above")
    parser.add_argument(
        "--print",
        type=Path,
        metavar="FILE.svg",
        help="draw the board for a printer, in its true size, and end",
    )
    parser.add_argument(
        "--lens",
        choices=LENSES,
        help="of both cameras: pinhole (the default) has the distortion k1, k2, p1, p2, pinhole5 k3 as well, "
        "fisheye is for lenses wider than about 100 degrees",
    )
    parser.add_argument(
        "--to", choices=tuple(FORMATS), help="format to write (with --board: besides calibration.toml)"
    )
    parser.add_argument(
        "--unit",
        choices=tuple(UNITS_M),
        help="of lengths in files of opencv and boofcv (default m)",
    )
    add_size_px(parser, f"for files that do not say it; or {ASKED_SIZE}")
    add_video(parser)


def execute(arguments: argparse.Namespace) -> int:
    if arguments.print is not None:
        if arguments.board is None:
            raise InputError("--print", "needs --board")
        write_atomically(arguments.print, board_svg(parse_board(arguments.board)))
        return EXIT_OK
    if arguments.out is None:
        raise InputError("--out", "is missing")
    if arguments.out.exists() and not arguments.out.is_dir():
        raise InputError(arguments.out, "not a folder")
    _check_source(arguments)
    lens: Lens | None = None
    if arguments.lens is not None:
        lens = "fisheye" if arguments.lens == "fisheye" else "pinhole"
    options = Options(UNITS_M[arguments.unit or "m"], arguments.size_px, lens)
    if arguments.board is None:
        return convert(arguments, options)
    if arguments.size_px is not None and arguments.camera is None:
        raise InputError("--size-px", "is for cameras, and calibration files that do not say it; pictures do")
    check_unit(arguments, "pictures")
    board = parse_board(arguments.board)
    pictures: Iterable[Picture]
    if arguments.camera is None:
        name = printable(str(arguments.sources[0]))
        given = read_pictures(arguments.sources, SourceOptions(split=arguments.split, rate=arguments.rate))
        pictures = _with_progress(given)
    else:
        name = printable(" and ".join(arguments.camera))
        with closing(open_cameras(arguments)) as cameras:
            pictures = collect(cameras, board, PairFolder(arguments.out / PICTURES, None))
    made = calibrate(pictures, board, arguments.lens or "pinhole")
    rig = rig_of(made.raw)
    files = write_rig(rig, "toml", options)
    if arguments.to is not None:
        files |= write_rig(rig, arguments.to, options)
    files[REPORT] = render_report(made, name)
    write_files(arguments.out, files)
    print_result(made, arguments.out)
    return EXIT_OK


def _check_source(arguments: argparse.Namespace) -> None:
    """Raises InputError for options that would be ignored."""
    if bool(arguments.sources) == (arguments.camera is not None):
        raise InputError("vista calibrate", "takes SOURCE or --camera")
    if arguments.camera is not None and arguments.board is None:
        raise InputError("--camera", "needs --board")
    of_cameras, of_files = ("pair_tolerance_ms",), ("split", "rate", "unit")
    for name in of_cameras if arguments.camera is None else of_files:
        if getattr(arguments, name) is not None:
            reason = f"{'goes' if arguments.camera is None else 'does not go'} with --camera"
            raise InputError(f"--{name.replace('_', '-')}", reason)


def collect(cameras: Source, board: Board, folder: PairFolder) -> list[Picture]:
    """The pictures that were kept; they are also in the folder. Until nothing is missing, or Ctrl-C."""
    collector, queue, interruption = Collector(board), Latest[Shot](), Interruption()
    asked = ""
    with closing(folder), interruption.watch():
        for shot in newest_shots(cameras, queue, lambda: interruption.requested or collector.full):
            if collector.look(Picture(str(shot.frame.index), shot.frame.left, shot.frame.right)):
                name = folder.write(shot)
                print(f"{len(collector.kept)} kept ({name})", file=sys.stderr)
            missing = next(collector.missing(), "Nothing is missing.")
            if missing != asked:
                print(missing, file=sys.stderr, flush=True)
                asked = missing
    return collector.kept


def convert(arguments: argparse.Namespace, options: Options) -> int:
    for option in ("split", "rate"):
        if getattr(arguments, option) is not None:
            raise InputError(f"--{option}", "is for pictures of a board, which --board describes")
    for source in arguments.sources:
        if source.is_dir() or source.suffix.lower() in EXTENSIONS or video.recognises(source):
            raise InputError(source, "pictures need --board, which says what they show")
    name, rig = read_rig(arguments.sources, options)
    check_unit(arguments, name)
    if arguments.lens is not None and name != "opencv":
        raise InputError("--lens", f"goes with --board and with files of opencv; those of {name} say it")
    target = arguments.to or "toml"
    files = write_rig(rig, target, options)
    write_files(arguments.out, files)
    print(f"{name} -> {target}: {', '.join(shell_quoted(arguments.out / file) for file in files)}")
    return EXIT_OK


def check_unit(arguments: argparse.Namespace, source: str) -> None:
    """Raises InputError for a unit of lengths that nothing is in."""
    target = arguments.to or "toml"
    with_unit = [name for name, module in FORMATS.items() if module.HAS_UNIT]
    if arguments.unit is not None and not {source, target} & set(with_unit):
        others = " and ".join(dict.fromkeys((source, target)))
        raise InputError("--unit", f"goes with {' and '.join(with_unit)}, not with {others}")


def write_files(folder: Path, files: dict[str, str]) -> None:
    """All texts are there before the first file is written."""
    for name, text in files.items():
        path = folder / name
        make_folder(path.parent)
        write_atomically(path, text)


def _with_progress(pictures: Iterable[Picture]) -> Iterator[Picture]:
    yield from tqdm(
        pictures, desc="looking for the board", unit=" pairs", leave=False, disable=not sys.stderr.isatty()
    )


def print_result(made: Calibrated, folder: Path) -> None:
    solution, found = made.solution, made.found
    print(
        f"{len(solution.views)} views of {found.pictures} pairs used; "
        f"reprojection error {solution.rms_px():.2f} px, row error "
        f"{made.before.rms_px:.2f} -> {made.after.rms_px:.2f} px"
    )
    if unused := made.unused():
        print(f"pairs that were not used: {'; '.join(unused)}")
    for sentence in advice(made):
        print(f"next: {sentence}")
    print(
        f"calibration: {shell_quoted(folder / 'calibration.toml')}, report: {shell_quoted(folder / REPORT)}"
    )
