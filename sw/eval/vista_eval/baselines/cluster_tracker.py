"""The second half of the host, from regions to obstacles, with clusters for regions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista import native, parameters
from vista.engine import SCALE, Disparity
from vista.geometry import Array, Calibration, Pose
from vista.pipeline import Nearest, Obstacle, c_parameters
from vista.structs import c_camera, c_pose, copied

from vista_eval.cell_graph import lay_out
from vista_eval.metrics.flight_path import Curved

MAX_REGIONS = 64
IN_THE_WAY = 1_000_000  # pixels of a cluster in the collision volume: all of it lies there, however small
PIXEL_PX2 = 1.0 / 12.0  # the variance of a pixel, which is no point
CORNERS = 33  # of a chain of chords for an arc


@dataclass(frozen=True)
class Moved:
    """What the host makes of one frame's pose."""

    pose: Pose
    path: Curved  # that it expects
    frame: Any  # vista_frame_view *, without words


@dataclass(frozen=True)
class Told:
    obstacles: list[Obstacle]
    nearest: Nearest | None


class Stages:
    """The library that exports the stages, with one camera and its parameters."""

    def __init__(self, camera: Calibration, values: parameters.Values) -> None:
        self.ffi, self.lib = native.load("vista_stages")
        self.parameters = c_parameters(self.ffi, self.lib, values)
        self.camera = c_camera(self.ffi, camera)

    def check(self, status: int) -> None:
        native.check(self.ffi, self.lib, status)


class HostMotion:
    """Pose after pose, as the host's first stage takes them."""

    def __init__(self, stages: Stages) -> None:
        self._stages = stages
        self._state = stages.ffi.new("vista_motion_state *")

    def update(self, t_ns: int, pose: Pose | None) -> Moved:
        ffi, lib = self._stages.ffi, self._stages.lib
        given = ffi.new("vista_frame *", {"t_ns": t_ns})
        if pose is not None:
            where = c_pose(ffi, pose)
            given.pose = where
        frame = ffi.new("vista_frame_view *")
        self._stages.check(
            lib.vista_pipeline_begin(self._stages.parameters, self._stages.camera, given, self._state, frame)
        )
        p = frame.motion.pose
        believed = Pose(np.array(list(p.rotation)).reshape(3, 3), np.array(list(p.translation_m)))
        return Moved(believed, chords(frame.path), frame)


def chords(path: Any) -> Curved:
    start, ahead, inward = (np.array(list(v)) for v in (path.start_m, path.direction, path.normal))
    c, length_m = path.curvature_1_m, path.length_m
    if c == 0.0:
        corners_m: Array = np.array([start, start + length_m * ahead])
    else:
        turn = np.linspace(0.0, c * length_m, CORNERS)[:, np.newaxis]
        corners_m = start + (np.sin(turn) * ahead + (1.0 - np.cos(turn)) * inward) / c
    return Curved(corners_m, np.zeros(len(corners_m)))


class ClusterTracker:
    """The host's reconstruction, tracker and obstacle map at one threshold."""

    def __init__(self, stages: Stages) -> None:
        self._stages = stages
        ffi, lib = stages.ffi, stages.lib
        tracker = ffi.new("vista_region_tracker **")
        self._memory = lay_out(
            ffi, lambda arena: stages.check(lib.vista_region_tracker_layout(MAX_REGIONS, arena, tracker))
        )
        self._tracker, self._count = tracker[0], ffi.new("int32_t *")

    def update(self, moved: Moved, words: Disparity, regions: Any, region_count: int) -> Told:
        """regions: the largest clusters of the frame (as_regions)."""
        s, ffi, lib = self._stages, self._stages.ffi, self._stages.lib
        height, width = words.shape
        frame = ffi.new("vista_frame_view *", moved.frame[0])
        frame.words = (ffi.cast("int16_t *", words.ctypes.data), width, height, width)
        s.check(
            lib.vista_pipeline_track_regions(self._tracker, frame, regions, min(region_count, MAX_REGIONS))
        )
        items = lib.vista_region_tracker_obstacles(self._tracker, self._count)
        obstacles = Obstacle.all_of(copied(ffi, items, Obstacle.NAME, self._count[0]))
        found = lib.vista_region_tracker_nearest(self._tracker)
        nearest = Nearest.copied(ffi, ffi.addressof(found))
        return Told(obstacles, nearest if nearest.valid else None)


def as_regions(
    stages: Stages, words: Disparity, label: NDArray[np.int32], corner_px: tuple[int, int] = (0, 0)
) -> tuple[Any, list[int]]:
    """The clusters, largest first, as accepted regions that face the camera, and their pixels; corner_px: u
    and v of the first pixel of both arrays in the image."""
    v, u = np.nonzero((label >= 0) & (label < MAX_REGIONS))
    number, word = label[v, u], words[v, u]
    order = np.lexsort((word, number))
    u, v, number, word = u[order] + corner_px[0], v[order] + corner_px[1], number[order], word[order]
    pixels = np.bincount(number)
    first = np.concatenate([[0], np.cumsum(pixels)[:-1]]).astype(int)
    regions = stages.ffi.new("vista_region[]", max(len(pixels), 1))
    if not len(pixels):
        return regions, []

    def mean(values: NDArray[Any]) -> Array:
        return np.bincount(number, values) / pixels

    mean_u, mean_v, mean_word = mean(u), mean(v), mean(word)
    off_u, off_v = u - mean_u[number], v - mean_v[number]
    columns: dict[str, NDArray[Any]] = {
        "pixel_count": pixels,
        "mean_u_px": mean_u,
        "mean_v_px": mean_v,
        "cov_uu_px2": mean(off_u * off_u) + PIXEL_PX2,
        "cov_uv_px2": mean(off_u * off_v),
        "cov_vv_px2": mean(off_v * off_v) + PIXEL_PX2,
        "min_u_px": np.minimum.reduceat(u, first),
        "min_v_px": np.minimum.reduceat(v, first),
        "max_u_px": np.maximum.reduceat(u, first),
        "max_v_px": np.maximum.reduceat(v, first),
        "disparity_px": 0.5 * (0.0 + word[first + (pixels - 1) // 2] + word[first + pixels // 2]) / SCALE,
        "disparity_sigma_px": np.sqrt(mean((word - mean_word[number]) ** 2)) / SCALE,
    }
    columns |= dict.fromkeys(("boundary_pixels", "boundary_valid", "boundary_inliers"), pixels)
    for k in range(len(pixels)):
        region = regions[k]
        region.label, region.verdict = k, stages.lib.VISTA_REGION_ACCEPTED
        region.volume_pixels = IN_THE_WAY
        region.inclination_deg = math.nan
        region.valid_fraction = region.standing_fraction = region.top_fraction = 1.0
        for name, column in columns.items():
            setattr(region, name, column[k].item())
    return regions, pixels.tolist()
