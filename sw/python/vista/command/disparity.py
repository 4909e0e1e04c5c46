"""Match one rectified pair and write its disparity image.

The ending of FILE chooses the format:
  .png  KITTI: 16 bits, 256 per pixel of disparity; 0 is invalid
  .pfm  32-bit float, pixels of disparity; +infinity is invalid
  .npy  16-bit integer, 16 per pixel of disparity; negative is invalid
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_engine, positive
from vista.disparity_file import check_format, write_disparity
from vista.engine import EngineParameters, create_engine
from vista.errors import EXIT_OK, InputError
from vista.sequence import read_grey

DEFAULTS = EngineParameters()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("left", type=Path, metavar="LEFT", help="left image: PNG, JPEG, PGM or PPM")
    parser.add_argument("right", type=Path, metavar="RIGHT", help="right image of the same size")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="disparity file to write")
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
    check_format(arguments.out)
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
    write_disparity(arguments.out, words)
    return EXIT_OK
