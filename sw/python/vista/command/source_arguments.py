"""Arguments about the source of the images: what its files do not say themselves."""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import image_size, not_negative
from vista.errors import InputError
from vista.live.board import is_board
from vista.live.camera import PAIR_TOLERANCE_MS, Cameras, Capture
from vista.live.stereo_camera import StereoCamera, is_stereo_camera
from vista.sequence.options import BY_ODOMETRY, FRAME_OF_LEFT_CAMERA, NO_POSES, SPLITS, Options

ASKED_SIZE = "which is asked of the devices (default: what they come up with)"


def add_source(parser: argparse.ArgumentParser, needed: bool = True) -> None:
    """SEQUENCE, and the options of single layouts; `source_options` has what the user said.

    needed: otherwise SEQUENCE may be left out, and is None then."""
    parser.add_argument(
        "sequence",
        type=Path,
        nargs=None if needed else "?",
        metavar="SEQUENCE",
        help="folder or file of the sequence",
    )
    group = parser.add_argument_group("what the source does not say itself")
    group.add_argument(
        "--calibration",
        type=Path,
        metavar="FILE.toml",
        help="calibration of pairs, stills, a video or a bag (default: calibration.toml beside the images, "
        "or what the data set or the bag says)",
    )
    group.add_argument(
        "--poses",
        type=Path,
        metavar=f"FILE|{BY_ODOMETRY}",
        help="poses of the left camera, `t x y z qx qy qz qw` a line as in the TUM RGB-D benchmark, in place "
        f"of those that the source may have; {BY_ODOMETRY}: estimated from the images, which drifts",
    )
    group.add_argument(
        "--pair-tolerance-ms",
        type=milliseconds,
        metavar="MS",
        help="how far the times of left and right image may lie apart where each has its own: EuRoC layout, "
        "two videos, bags (default: a tenth of the frame period, at most 5)",
    )
    group.add_argument("--right", type=Path, metavar="VIDEO", help="the right camera's video, of two")
    add_video(group)
    group.add_argument(
        "--start", metavar="S", help="time of a video's first frame, in seconds on the clock of the poses"
    )
    group.add_argument("--left-topic", metavar="TOPIC", help="left images of a bag")
    group.add_argument("--right-topic", metavar="TOPIC", help="right images of a bag")
    group.add_argument(
        "--pose-topic",
        metavar="TOPIC",
        help=f"poses of a bag: odometry, poses, transforms or tf; {NO_POSES}: do without",
    )
    group.add_argument(
        "--pose-frame",
        metavar="NAME",
        help="frame of reference whose poses the topic holds, where it does not say so; "
        f"{FRAME_OF_LEFT_CAMERA}: that of the left camera",
    )


def add_video(group: argparse._ArgumentGroup | argparse.ArgumentParser) -> None:
    group.add_argument(
        "--split",
        choices=SPLITS,
        help="how one video holds both images, left or upper half the left one (default: as its shape tells)",
    )
    group.add_argument(
        "--rate", type=frames_per_second, metavar="HZ", help="frames a second, in place of a video's times"
    )


def add_camera(parser: argparse.ArgumentParser | argparse._ArgumentGroup, what: str, required: bool) -> None:
    """`open_cameras` opens them, and takes --size-px and --pair-tolerance-ms as well. what: the help."""
    parser.add_argument("--camera", nargs="+", metavar="DEVICE", required=required, help=what)


def add_size_px(parser: argparse.ArgumentParser, why: str = ASKED_SIZE) -> None:
    """What calibration.toml calls size_px."""
    parser.add_argument(
        "--size-px", type=image_size, metavar="WxH", help=f"of the images of one camera, {why}"
    )


def add_pair_tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--pair-tolerance-ms",
        type=milliseconds,
        metavar="MS",
        help=f"how far the pictures of two cameras may lie apart (default {PAIR_TOLERANCE_MS:g})",
    )


def open_cameras(
    arguments: argparse.Namespace, size_px: tuple[int, int] | None = None
) -> Cameras | StereoCamera:
    """size_px: of the images of one camera, where --size-px does not say it. Raises InputError for devices
    that do not open or deliver."""
    if len(arguments.camera) > 2:
        raise InputError("--camera", f"takes one device or two, not {len(arguments.camera)}")
    if is_board(arguments.camera[0]):
        raise InputError(arguments.camera[0], "gives words and no images, which vista live takes alone")
    if is_stereo_camera(arguments.camera[0]):
        if len(arguments.camera) > 1:
            raise InputError(arguments.camera[1], f"{arguments.camera[0]} delivers both views by itself")
        if arguments.pair_tolerance_ms is not None:
            raise InputError("--pair-tolerance-ms", f"{arguments.camera[0]} pairs its pictures by itself")
        return StereoCamera(arguments.camera[0], arguments.size_px or size_px)
    tolerance_ms, device_px = arguments.pair_tolerance_ms, arguments.size_px or size_px
    if device_px is not None and len(arguments.camera) == 1:
        device_px = 2 * device_px[0], device_px[1]  # both views side by side
    cameras = Cameras(
        arguments.camera,
        PAIR_TOLERANCE_MS if tolerance_ms is None else tolerance_ms,
        lambda name: Capture(name, device_px),
    )
    if arguments.size_px not in (None, cameras.size_px):
        cameras.close()
        sizes = "delivers images of {}x{} px, not {}x{}".format(*cameras.size_px, *arguments.size_px)
        raise InputError(arguments.camera[0], sizes)
    return cameras


def milliseconds(text: str) -> float:
    number = not_negative(text)
    if number > 1e6:
        raise argparse.ArgumentTypeError(f"{text} is not from 0 to 1000000 ms")
    return number


def frames_per_second(text: str) -> float:
    number = not_negative(text)
    if not 1e-3 <= number <= 1e5:
        raise argparse.ArgumentTypeError(f"{text} is not from 0.001 to 100000 frames per second")
    return number


def source_options(arguments: argparse.Namespace) -> Options:
    by_odometry = arguments.poses == Path(BY_ODOMETRY)
    return Options(
        calibration=arguments.calibration,
        first_frame=(arguments.frames or (0, None))[0],
        poses=None if by_odometry else arguments.poses,
        odometry=by_odometry,
        pair_tolerance_ms=arguments.pair_tolerance_ms,
        left_topic=arguments.left_topic,
        right_topic=arguments.right_topic,
        pose_topic=arguments.pose_topic,
        pose_frame=arguments.pose_frame,
        right=arguments.right,
        split=arguments.split,
        rate=arguments.rate,
        start=arguments.start,
    )
