"""The second half of the host, from regions to obstacles, called stage by stage, with clusters for
regions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista import native, parameters
from vista.engine import SCALE, Disparity
from vista.geometry import Array, Calibration, Pose
from vista.pipeline import Nearest, Obstacle, PipelineError, c_parameters, read_nearest, read_obstacle

from vista_eval.metrics.flight_path import CYLINDER_LENGTH_M, CYLINDER_RADIUS_M, Curved

MAX_TRACKS, MAX_DETECTIONS = 64, 64
IN_THE_WAY = 1_000_000  # pixels of a cluster in the collision volume: all of it lies there, however small
PIXEL_PX2 = 1.0 / 12.0  # the variance of a pixel, which is no point
CORNERS = 33  # of a chain of chords for an arc


@dataclass(frozen=True)
class Moved:
    """What the host makes of one frame's pose."""

    pose: Pose
    path: Curved  # that it expects
    motion: Any  # vista_motion *
    c_path: Any  # vista_flight_path *


@dataclass(frozen=True)
class Told:
    obstacles: tuple[Obstacle, ...]
    nearest: Nearest | None


class Stages:
    """The library that exports the stages, with one camera and its parameters."""

    def __init__(self, camera: Calibration, values: parameters.Values) -> None:
        self.ffi, self.lib = native.load("vista_stages")
        self.parameters = c_parameters(self.ffi, self.lib, values)
        self.camera = self.ffi.new(
            "vista_camera *",
            (camera.width, camera.height, camera.focal_px, camera.cx, camera.cy, camera.baseline_m),
        )
        stereo = values["stereo"]
        radius = (stereo["block_size"] - 1) // 2
        largest = stereo["num_disparities"] - 1
        self.matched = self.ffi.new("vista_matched_area *", (largest, largest + radius, radius, 0))

    def section(self, name: str) -> Any:
        return self.ffi.addressof(self.parameters[0], name)

    def check(self, status: int) -> None:
        if status != self.lib.VISTA_OK:
            raise PipelineError(self.ffi.string(self.lib.vista_status_text(status)).decode())

    def lay_out(self, layout: Callable[[Any], int]) -> Any:
        """Memory for what `layout` takes from an arena; it has to be kept."""
        arena = self.ffi.new("vista_arena *")
        self.check(layout(arena))
        memory = self.ffi.new("unsigned char[]", arena.used + 64)
        base = int(self.ffi.cast("uintptr_t", memory))
        arena.base = self.ffi.cast("unsigned char *", base + -base % 64)
        arena.size, arena.used = arena.used, 0
        self.check(layout(arena))
        return memory


class HostMotion:
    """Pose after pose, as the host's first stage takes them."""

    def __init__(self, stages: Stages) -> None:
        self._stages = stages
        self._state = stages.ffi.new("vista_motion_state *")

    def update(self, t_ns: int, pose: Pose | None) -> Moved:
        ffi, lib = self._stages.ffi, self._stages.lib
        given = ffi.NULL
        if pose is not None:
            given = ffi.new("vista_pose *", (pose.rotation.ravel().tolist(), pose.translation_m.tolist()))
        taken = ffi.new("vista_motion_input *", {"pose": given, "t_ns": t_ns})
        motion = ffi.new("vista_motion *")
        section = self._stages.section("motion")
        self._stages.check(lib.vista_motion_update(section, taken, self._state, motion))
        size = (CYLINDER_LENGTH_M, CYLINDER_RADIUS_M)
        path = ffi.new("vista_flight_path *", lib.vista_motion_path(section, self._state, motion, *size))
        p = motion.pose
        believed = Pose(np.array(list(p.rotation)).reshape(3, 3), np.array(list(p.translation_m)))
        return Moved(believed, chords(path), motion, path)


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
        tracker, obstacle_map = ffi.new("vista_tracker **"), ffi.new("vista_obstacle_map **")
        self._kept = (
            stages.lay_out(lambda a: lib.vista_tracker_layout(MAX_TRACKS, MAX_DETECTIONS, a, tracker)),
            stages.lay_out(lambda a: lib.vista_obstacle_map_layout(MAX_TRACKS, a, obstacle_map)),
        )
        self._tracker, self._map = tracker[0], obstacle_map[0]
        self._detections = ffi.new("vista_detection[]", MAX_DETECTIONS)
        self._count = ffi.new("int32_t *")

    def update(self, moved: Moved, t_ns: int, words: Disparity, regions: Any, region_count: int) -> Told:
        """regions: the largest clusters of the frame (as_regions)."""
        s, ffi, lib = self._stages, self._stages.ffi, self._stages.lib
        s.check(
            lib.vista_reconstruct_regions(
                regions,
                min(region_count, MAX_DETECTIONS),
                s.camera,
                s.matched,
                s.section("reconstruction"),
                self._detections,
                MAX_DETECTIONS,
                self._count,
            )
        )
        if moved.motion.restarted:
            lib.vista_tracker_reset(self._tracker)
        image = ffi.new(
            "vista_disparity_image *",
            (ffi.cast("int16_t *", words.ctypes.data), words.shape[1], words.shape[0], words.shape[1]),
        )
        found = (self._detections, self._count[0])
        section = s.section("tracker")
        s.check(
            lib.vista_tracker_update(
                self._tracker, section, s.camera, s.matched, moved.motion, t_ns, image, *found
            )
        )
        tracks = lib.vista_tracker_tracks(self._tracker, self._count)
        s.check(
            lib.vista_obstacle_map_update(
                self._map,
                s.section("obstacle_map"),
                s.camera,
                moved.motion,
                moved.c_path,
                ffi.NULL,  # nothing of the blind zone
                ffi.NULL,  # nor of the ground
                tracks,
                self._count[0],
            )
        )
        items = lib.vista_obstacle_map_obstacles(self._map, self._count)
        nearest = lib.vista_obstacle_map_nearest(self._map)
        return Told(
            tuple(read_obstacle(ffi, lib, items[k]) for k in range(self._count[0])),
            read_nearest(nearest) if nearest.valid else None,
        )


def as_regions(
    stages: Stages, words: Disparity, label: NDArray[np.int32], corner_px: tuple[int, int] = (0, 0)
) -> tuple[Any, list[int]]:
    """The clusters, largest first, as accepted regions that face the camera, and their pixels; corner_px: u
    and v of the first pixel of both arrays in the image."""
    v, u = np.nonzero((label >= 0) & (label < MAX_DETECTIONS))
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
