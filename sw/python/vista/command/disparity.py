"""Match one rectified pair and write its disparity image, or the points that it stands for.

The ending of FILE chooses the format:
  .png  KITTI: 16 bits, 256 per pixel of disparity; 0 is invalid
  .pfm  32-bit float, pixels of disparity; +infinity is invalid
  .npy  16-bit integer, 16 per pixel of disparity; negative is invalid
  .jpg  colours for people: near is red, far is blue, invalid is dark; with --calibration a scale in metres
  .ply  point cloud in metres, x to the right, y down, z forward; takes --calibration
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_engine, positive
from vista.disparity_file import Words, check_format, write_disparity
from vista.engine import EngineParameters, Image, create_engine
from vista.errors import EXIT_OK, InputError
from vista.geometry import Calibration
from vista.output import write_atomically
from vista.point_cloud import SUFFIX as PLY
from vista.point_cloud import points_of, write_ply
from vista.rectify import Rectifier
from vista.report.overlay import draw_disparity
from vista.result_folder import encoded
from vista.sequence import read_grey
from vista.sequence.pairs import read_calibration_file

PICTURE = ".jpg"
DEFAULTS = EngineParameters()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("left", type=Path, metavar="LEFT", help="left image: PNG, JPEG, PGM or PPM")
    parser.add_argument("right", type=Path, metavar="RIGHT", help="right image of the same size")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="disparity file to write")
    parser.add_argument(
        "--calibration", type=Path, metavar="FILE.toml", help="calibration of the pair, for .jpg and .ply"
    )
    add_engine(parser, "the same as for vista run; opencv needs --lr off")
    parser.add_argument("--rtl-width", type=positive, metavar="PX", help="the same as for vista run")
    add_number(
        parser,
        "--disparities",
        DEFAULTS.num_disparities,
        "disparities that are searched, a multiple of 16 up to 256",
    )
    add_number(parser, "--block", DEFAULTS.block_size, "side of the block that is matched, odd, 5 to 21")
    parser.add_argument(
        "--prefilter",
        choices=("xsobel", "none"),
        default=DEFAULTS.prefilter,
        help=f"filter before matching: the horizontal Sobel response, or none (default {DEFAULTS.prefilter})",
    )
    add_number(parser, "--cap", DEFAULTS.prefilter_cap, "limit of the prefilter's response, 1 to 63")
    add_number(
        parser, "--texture", DEFAULTS.texture_threshold, "texture that a block needs to be matched, from 0"
    )
    add_number(
        parser,
        "--uniqueness",
        DEFAULTS.uniqueness_ratio,
        "margin of the best match over the others, 0 to 100 percent",
    )
    parser.add_argument(
        "--lr",
        type=lr_max_diff,
        default=DEFAULTS.lr_max_diff,
        metavar="PX|off",
        help=f"largest difference that the left/right check accepts, or off (default {DEFAULTS.lr_max_diff})",
    )


def add_number(parser: argparse.ArgumentParser, option: str, default: int, meaning: str) -> None:
    parser.add_argument(option, type=int, default=default, metavar="N", help=f"{meaning} (default {default})")


def lr_max_diff(text: str) -> int | None:
    return None if text == "off" else int(text)


def execute(arguments: argparse.Namespace) -> int:
    check_out(arguments.out, arguments.calibration)
    parameters = EngineParameters(
        num_disparities=arguments.disparities,
        block_size=arguments.block,
        prefilter=arguments.prefilter,
        prefilter_cap=arguments.cap,
        texture_threshold=arguments.texture,
        uniqueness_ratio=arguments.uniqueness,
        lr_max_diff=arguments.lr,
    )
    try:
        engine = create_engine(arguments.engine, parameters, rtl_width_px=arguments.rtl_width)
    except ValueError as error:
        raise InputError("disparity", str(error)) from None
    left, right = read_grey(arguments.left), read_grey(arguments.right)
    if left.shape != right.shape:
        sizes = [f"{image.shape[1]}x{image.shape[0]}" for image in (right, left)]
        raise InputError(arguments.right, f"image is {sizes[0]}, the left one {sizes[1]}")
    try:
        words = engine.compute(left, right)
    except ValueError as error:
        raise InputError(arguments.left, str(error)) from None
    camera = None if arguments.calibration is None else read_camera(arguments.calibration, left)
    write(arguments.out, words, left, camera, arguments.disparities)
    return EXIT_OK


def check_out(path: Path, calibration: Path | None) -> None:
    """Raises InputError before any work is done."""
    suffix = path.suffix.lower()
    if suffix not in (PICTURE, PLY):
        check_format(path, also=(PICTURE, PLY))
        if calibration is not None:
            raise InputError("--calibration", f"goes with {PICTURE} and {PLY}")
    elif suffix == PLY and calibration is None:
        raise InputError(path, "a point cloud needs --calibration")


def read_camera(path: Path, left: Image) -> Calibration:
    """Raises InputError for cameras whose images would have to be rectified first."""
    height, width = left.shape
    rectifier = Rectifier(read_calibration_file(path, (width, height)).calibration)
    if not rectifier.is_passthrough:
        raise InputError(path, "is of cameras that are not rectified: use vista run")
    return rectifier.calibration


def write(path: Path, words: Words, left: Image, camera: Calibration | None, disparities: int) -> None:
    suffix = path.suffix.lower()
    if suffix == PICTURE:
        focal_baseline_px_m = None if camera is None else camera.focal_px * camera.baseline_m
        write_atomically(path, encoded(draw_disparity(words, disparities, focal_baseline_px_m)))
    elif suffix == PLY and camera is not None:
        write_ply(path, points_of(words, left, camera))
    else:
        write_disparity(path, words)
