"""Find obstacles in what a stereo camera publishes to ROS 2, and publish them: the node `vista`.

It subscribes to left/image_rect, left/camera_info, right/image_rect and right/camera_info, as the nodes of
stereo_image_proc do, and publishes disparity, ~/obstacles_json, ~/markers, ~/points and /diagnostics. Images
of topics without `rect` in their names are rectified first. Topics are remapped and parameters are set as
those of any node, by what follows --ros-args:

  vista ros --ros-args -r __ns:=/stereo -p config:=FILE.toml

  config             file of parameters; `vista config` prints one with all defaults
  engine, threads    as those of `vista live`
  poses              none (default), topic: those of the topic odometry, odometry: estimated from the images
  body_from_camera   [x, y, z, qx, qy, qz, qw]: the left camera on the body whose poses the topic holds
  image_transport    raw (default), compressed: images come on TOPIC/compressed, as PNG or JPEG
  pair_tolerance_ms  how far the times of a pair may lie apart (default: a tenth of the period, at most 5)

It needs ROS 2 with rclpy: source its setup.bash, or `make ros-env` in a checkout.
"""

from __future__ import annotations

import argparse

from vista.errors import InputError
from vista.interruption import stopping_at_once

# A node runs until it is told to end, which is no failure.
EPILOG = """\
exit status:
  0    ended by Ctrl-C or SIGTERM
  2    ROS 2 is missing, or an argument or a parameter is wrong; one line on stderr names the culprit
  130  Ctrl-C while ROS 2 is being loaded; a second Ctrl-C or SIGTERM ends the program at once, by the signal
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--ros-args", nargs=argparse.REMAINDER, default=[], metavar="ARGUMENT", help="arguments of ROS"
    )


def execute(arguments: argparse.Namespace) -> int:
    with stopping_at_once():
        try:
            import rclpy  # noqa: F401
        except ImportError as error:
            reason = f"ROS 2 with rclpy is not here ({error}): source its setup.bash, or `make ros-env`"
            raise InputError("vista ros", reason) from None
        from vista.ros.node import run

    return run(arguments.ros_args)
