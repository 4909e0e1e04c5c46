"""What vista-fly takes along instead of Python: a rig, and frames (little-endian, no padding).

rig     char[8] "VISTARIG", uint32 version = 2, width, height, kind (0: pairs come rectified, 1: a map,
        2: a control grid), rectify_rows, findings (bit 0: baseline_implausible, 1: calibration_misfit),
        double focal_px, cx, cy, baseline_m (rectified), left_from_rectified[9] (row-major rotation);
        of the raw right camera double fx, fy, cx, cy, distortion[8], rectified_from_right[9] (rotation),
        uint64 lens (0: pinhole, 1: fisheye), as vista/correction.h has them;
        then for the left and for the right camera, with a map: int16 (u, v)[height][width], whole pixels of
        the source, uint16 fraction[height][width], 32 * v + u in 1/32 px; with a grid: int16 (dx, dy)
        of each control point (doc/design/engine-contract.md)
frames  char[8] "VISTAFRM", uint32 version = 1, width, height, has_up, double up_world[3];
        then frames: int64 t_ns, uint32 index, has_pose, double rotation[9], translation_m[3]
        (world_from_camera of the raw left camera), uint8 left[height][width], right[height][width]
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from vista.health.finding import Reason
from vista.health.monitor import HealthMonitor
from vista.output import unwritable
from vista.rectify import Rectifier
from vista.sequence import FrameFiles, Sequence

RIG_VERSION, FRAMES_VERSION = 2, 1
RIG, FRAMES = "rig.vista", "frames.vista"  # names of the files
RIG_HEAD = struct.Struct("<8s6I4d9d4d8d9dQ")
FRAMES_HEAD = struct.Struct("<8s4I3d")
FRAME_HEAD = struct.Struct("<q2I9d3d")
PASSTHROUGH, MAP, GRID = range(3)
FINDINGS = (Reason.BASELINE_IMPLAUSIBLE, Reason.CALIBRATION_MISFIT)


def rig_bytes(recorded: Sequence, rectify_rows: int) -> bytes:
    """recorded: its calibration counts, and no frame of it. Raises InputError as Rectifier does."""
    rectifier = Rectifier(recorded.calibration, rectify_rows)
    found = {finding.reason for finding in HealthMonitor(recorded).of_run}
    camera, right = rectifier.calibration, rectifier.right
    if rectifier.is_passthrough:
        kind, tables = PASSTHROUGH, b""
    elif rectifier.grids is not None:
        kind = GRID
        tables = b"".join(
            grid.astype("<i2").tobytes() for grid in (rectifier.grids.left, rectifier.grids.right)
        )
    else:
        kind = MAP
        tables = b"".join(
            whole.astype("<i2").tobytes() + fraction.astype("<u2").tobytes()
            for whole, fraction in rectifier.maps
        )
    head = RIG_HEAD.pack(
        b"VISTARIG",
        RIG_VERSION,
        camera.width,
        camera.height,
        kind,
        rectify_rows,
        sum(1 << bit for bit, reason in enumerate(FINDINGS) if reason in found),
        camera.focal_px,
        camera.cx,
        camera.cy,
        camera.baseline_m,
        *rectifier.left_from_rectified.rotation.ravel(),
        *right.intrinsics_px,
        *right.distortion,
        *right.rectified_from_raw.ravel(),
        right.lens,
    )
    return head + tables


def frames_head(recorded: Sequence) -> bytes:
    camera, up = recorded.calibration.left, recorded.up_world
    numbers = np.zeros(3) if up is None else up
    return FRAMES_HEAD.pack(
        b"VISTAFRM", FRAMES_VERSION, camera.width, camera.height, up is not None, *numbers
    )


def frame_bytes(recorded: Sequence, files: FrameFiles) -> bytes:
    """Raises InputError for an image that cannot be read."""
    frame = recorded.read(files)
    pose, numbers = frame.world_from_camera, np.zeros(12)
    if pose is not None:
        numbers[:9], numbers[9:] = pose.rotation.ravel(), pose.translation_m
    head = FRAME_HEAD.pack(frame.t_ns, frame.index, pose is not None, *numbers)
    return head + frame.left.tobytes() + frame.right.tobytes()


def write_frames(path: Path, recorded: Sequence, frames: Iterable[FrameFiles]) -> None:
    """Whole or not at all. InputError names the image that cannot be read, or the file to write."""
    part = path.with_name(f".{path.name}.part")

    def parts() -> Iterator[bytes]:
        yield frames_head(recorded)
        for files in frames:
            yield frame_bytes(recorded, files)

    try:
        with part.open("wb") as stream:
            for data in parts():
                stream.write(data)
        part.replace(path)
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        part.unlink(missing_ok=True)
