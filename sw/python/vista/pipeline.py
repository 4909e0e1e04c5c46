"""The host library libvista: from image, disparities, time and pose to obstacles."""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.geometry import Array, Calibration, Pose

# Ids of obstacles without a track, as vista/obstacle.h has them: pictures and reports of a run that is over
# name them without the library.
ID_TOO_NEAR = 0
ID_GROUND = -1


@dataclass(frozen=True)
class Ellipse:
    """An ellipse in the rectified left image, in pixels."""

    center_u: float
    center_v: float
    axis_a: float  #: the longer semi-axis
    axis_b: float  #: the shorter semi-axis
    angle_deg: float  #: from +u to the longer axis, clockwise


@dataclass(frozen=True)
class Obstacle:
    """One obstacle, as the track that it belongs to estimates it in this frame."""

    id: int  #: number of the track, from 1; ID_TOO_NEAR or ID_GROUND without one
    confirmed: bool
    coasting: bool  #: not seen in this frame
    in_blind_zone: bool  #: nearer than the engine matches
    world: str  #: verdict of the static-world test: OPEN, STANDS, MOVES, REFUTED
    age_frames: int
    position_m: Array  #: (3,), in the world
    covariance_m2: Array  #: (3, 3), of the position
    distance_m: float  #: from the camera
    extent_m: tuple[float, float]  #: width, height
    ellipse: Ellipse
    disparity_px: float
    in_collision_volume: bool
    kind: str = "thing"  #: thing; too_near: to match; ground: where the flight path meets it

    @property
    def is_thing(self) -> bool:
        """Whether it counts as an obstacle where obstacles are counted: a thing with a confirmed track."""
        return self.confirmed and self.kind == "thing"


@dataclass(frozen=True)
class Nearest:
    """The nearest confirmed obstacle that meets the collision volume."""

    id: int
    position_m: Array  #: (3,), in the world
    distance_m: float
    time_to_collision_s: float | None  #: None: hardly closing, or not known
    covariance_m2: Array  #: (3, 3), of the position: of the obstacle, and of which point of it is met first


@dataclass(frozen=True)
class Motion:
    """The vehicle's own motion as the detector worked with it."""

    known: bool  #: otherwise positions in the world rest on a guess of the camera's pose
    source: str  #: where the camera's pose comes from: POSE, STANDS, CARRIED_ON, REFUSED, UNTOLD
    restarted: bool  #: the poses continued at another place, so all tracks were dropped
    velocity_m_s: Array | None  #: (3,), in the world; None: not known
    turn_rate_rad_s: Array  #: (3,), axis times rate, in the world
    pose: Pose  #: world_from_camera


@dataclass(frozen=True)
class Health:
    """Whether the view tells anything: without obstacles only a healthy frame is clear."""

    state: str  #: healthy, degraded, blind
    reasons: tuple[
        str, ...
    ]  #: few_disparities, no_disparities, no_contrast, motion_unknown, pose_jump, noise, ground_unseen
    texts: tuple[str, ...]  #: the same in words
    matched_fraction: float  #: of the pixels where the engine can find a disparity, those that have one
    contrast: float  #: standard deviation of the cells, grey levels


@dataclass(frozen=True)
class Directions:
    """Which level directions are free: columns of one degree, from where the camera looks to the right."""

    up_camera: Array | None  #: (3,), unit vector against gravity; None: not known, -y is taken for it
    free_m: NDArray[np.float32]  #: how far nothing stands there: (COLUMNS,), the first FIRST_DEG from ahead
    blocked_m: NDArray[np.float32]  #: where what ends it stands; 0: nothing is seen there

    FIRST_DEG, COLUMNS = -90, 180  # as vista/directions.h has them


@dataclass(frozen=True)
class Result:
    """The output of one frame."""

    obstacles: list[Obstacle]  #: nearest first
    nearest_collision: Nearest | None
    path_seen_m: float  #: how far the flight path is seen; beyond, no obstacle does not mean free space
    motion: Motion
    health: Health
    regions: int
    valid_fraction: float
    dropped_tracks: int  #: in this frame, for want of room
    stage_ms: dict[str, float]  #: of each stage in the order of the chain, and of the frame: "host"
    cell_of_pixel: NDArray[np.int32]  #: (height, width): the cell under each pixel
    cell_intensity: NDArray[np.float32]  #: (cells,)
    cell_disparity_px: NDArray[np.float32]  #: (cells,); negative: none
    region_of_cell: NDArray[np.int32]  #: (cells,); -1: none
    region_of_pixel: NDArray[np.int32]  #: (height, width); -1: none; boundaries follow the image
    verdict_of_region: list[str]
    words: NDArray[np.int16]  #: (height, width): the disparities of all levels together; negative: none
    directions: Directions | None = None  #: None: of a stand-in of a test


class PipelineError(ValueError):
    """A status of libvista that is not VISTA_OK; the text is the library's."""


def _destroy(lib: Any, pipeline: Any, memory: Any) -> None:
    lib.vista_pipeline_destroy(pipeline)
    del memory


class Pipeline:
    """The detector for one camera. It holds the tracks from frame to frame."""

    library = "vista"

    def __init__(self, camera: Calibration, values: parameters.Values | None = None) -> None:
        self._ffi, self._lib = native.load(self.library)
        self._camera = camera
        self._parameters = c_parameters(self._ffi, self._lib, values or parameters.defaults())
        self._c_camera = self._ffi.new(
            "vista_camera *",
            (camera.width, camera.height, camera.focal_px, camera.cx, camera.cy, camera.baseline_m),
        )
        size = self._ffi.new("size_t *")
        self._check(self._lib.vista_pipeline_bytes(self._parameters, self._c_camera, size))
        self._memory = self._ffi.new("unsigned char[]", size[0])
        handle = self._ffi.new("vista_pipeline **")
        self._check(
            self._lib.vista_pipeline_create(self._memory, size[0], self._parameters, self._c_camera, handle)
        )
        self._pipeline = handle[0]
        # A second thread works in this memory, so it ends before that is given back.
        weakref.finalize(self, _destroy, self._lib, self._pipeline, self._memory)
        self._result = self._ffi.new("vista_result *")
        self._cell_of_pixel: NDArray[np.int32] | None = None

    def reset(self) -> None:
        """Forgets tracks, velocity and time. Ids go on counting."""
        self._lib.vista_pipeline_reset(self._pipeline)

    def process(
        self,
        left: NDArray[np.uint8],
        disparity: NDArray[np.int16] | Sequence[NDArray[np.int16]],
        t_ns: int,
        pose: Pose | None = None,
        up_world: Array | None = None,
        velocity_m_s: Array | None = None,
        stationary: bool = False,
    ) -> Result:
        """One frame: rectified left image (height, width), engine words, pose: world_from_camera.

        disparity: the words of the same size, or those of the levels of a pyramid, level 0 first.

        velocity_m_s: of the camera in world, None: from the poses. stationary: without a pose, the camera has
        not moved since the last frame. Raises PipelineError on arrays of another type or size, times that do
        not increase, a pose that is not finite."""
        ffi = self._ffi
        levels = [disparity] if isinstance(disparity, np.ndarray) else list(disparity)
        most = 1 + self._lib.VISTA_COARSER_LEVELS
        if not 1 <= len(levels) <= most:
            raise PipelineError(f"a frame has 1 to {most} levels, not {len(levels)}")
        typed = [(left, "u1")] + [(words, "i2") for words in levels]
        if any((array.dtype, array.ndim) != (np.dtype(wanted), 2) for array, wanted in typed):
            raise PipelineError("the image has to be uint8 and int16 its disparities, both (height, width)")
        left, levels = np.ascontiguousarray(left), [np.ascontiguousarray(words) for words in levels]
        frame = ffi.new("vista_frame *")
        images = [frame.disparity, *(frame.coarser[k] for k in range(len(levels) - 1))]
        given: list[tuple[Any, NDArray[Any], str]] = [(frame.image, left, "uint8_t *")]
        given += [(image, words, "int16_t *") for image, words in zip(images, levels, strict=True)]
        for target, array, c_type in given:
            target.data = ffi.cast(c_type, array.ctypes.data)
            target.height_px, target.width_px = array.shape
            target.stride = array.shape[1]
        frame.t_ns = t_ns
        if pose is not None:
            c_pose = ffi.new("vista_pose *", (pose.rotation.ravel().tolist(), pose.translation_m.tolist()))
            frame.pose = c_pose
        if up_world is not None:
            c_up = ffi.new("double[3]", np.asarray(up_world, dtype=float).tolist())
            frame.up_world = c_up
        if velocity_m_s is not None:
            c_velocity = ffi.new("double[3]", np.asarray(velocity_m_s, dtype=float).tolist())
            frame.velocity_m_s = c_velocity
        frame.stationary = stationary
        self._check(
            self._lib.vista_pipeline_process_sized(
                self._pipeline, frame, ffi.sizeof(frame[0]), self._result, ffi.sizeof(self._result[0])
            )
        )
        return self._read_result()

    def _check(self, status: int) -> None:
        if status != self._lib.VISTA_OK:
            raise PipelineError(self._ffi.string(self._lib.vista_status_text(status)).decode())

    def _array(self, pointer: Any, count: int, dtype: Any) -> NDArray[Any]:
        size = count * np.dtype(dtype).itemsize
        return np.frombuffer(self._ffi.buffer(pointer, size), dtype=dtype).copy()

    def _read_result(self) -> Result:
        r, lib, ffi = self._result, self._lib, self._ffi
        views, shape = r.views, (self._camera.height, self._camera.width)
        cells, pixels = views.cell_count, shape[0] * shape[1]
        if self._cell_of_pixel is None:
            self._cell_of_pixel = self._array(views.cell_of_pixel, pixels, np.int32).reshape(shape)
        stage_ms = {
            ffi.string(lib.vista_stage_name(stage)).decode(): r.stage_ms[stage]
            for stage in range(r.stage_count)
        }
        nearest = r.nearest_collision
        verdicts = [
            ffi.string(lib.vista_region_verdict_name(views.verdict_of_region[k])).decode()
            for k in range(views.region_count)
        ]
        return Result(
            obstacles=[read_obstacle(ffi, lib, r.obstacles[k]) for k in range(r.obstacle_count)],
            nearest_collision=read_nearest(nearest) if nearest.valid else None,
            path_seen_m=r.path_seen_m,
            motion=_motion(ffi, lib, r.motion),
            health=_health(ffi, lib, r.health),
            regions=r.region_count,
            valid_fraction=r.valid_fraction,
            dropped_tracks=r.dropped_tracks,
            stage_ms=stage_ms | {"host": r.host_ms},
            cell_of_pixel=self._cell_of_pixel,
            cell_intensity=self._array(views.cell_intensity, cells, np.float32),
            cell_disparity_px=self._array(views.cell_disparity_px, cells, np.float32),
            region_of_cell=self._array(views.region_of_cell, cells, np.int32),
            region_of_pixel=self._array(views.region_of_pixel, pixels, np.int32).reshape(shape),
            verdict_of_region=verdicts,
            words=self._array(views.words, pixels, np.int16).reshape(shape),
            directions=self._directions(),
        )

    def _directions(self) -> Directions:
        c = self._ffi.new("vista_directions *")
        self._check(self._lib.vista_pipeline_directions(self._pipeline, c))
        up_camera = np.array(list(c.up_camera)) if c.up_known else None
        free_m, blocked_m = (
            self._array(columns, Directions.COLUMNS, np.float32) for columns in (c.free_m, c.blocked_m)
        )
        return Directions(up_camera, free_m, blocked_m)


def c_parameters(ffi: Any, lib: Any, values: parameters.Values) -> Any:
    c = ffi.new("vista_parameters *")
    lib.vista_parameters_init(c, ffi.sizeof(c[0]))
    for name, value in parameters.flat(values).items():
        setter = lib.vista_parameters_set_choice if isinstance(value, str) else lib.vista_parameters_set
        if setter(c, name.encode(), value.encode() if isinstance(value, str) else value) != lib.VISTA_OK:
            raise PipelineError(f"{name} is unknown or out of range")
    culprit = ffi.new("char const **")
    if lib.vista_parameters_check(c, culprit) != lib.VISTA_OK:
        raise PipelineError(f"{ffi.string(culprit[0]).decode()} is out of range")
    return c


def read_obstacle(ffi: Any, lib: Any, o: Any) -> Obstacle:
    e = o.ellipse
    return Obstacle(
        id=o.id,
        confirmed=bool(o.confirmed),
        coasting=bool(o.coasting),
        in_blind_zone=bool(o.in_blind_zone),
        world=ffi.string(lib.vista_world_verdict_name(o.world)).decode(),
        age_frames=o.age_frames,
        position_m=np.array(list(o.position_m)),
        covariance_m2=np.array(list(o.covariance_m2)).reshape(3, 3),
        distance_m=o.distance_m,
        extent_m=(o.extent_m[0], o.extent_m[1]),
        ellipse=Ellipse(e.center_u_px, e.center_v_px, e.axis_a_px, e.axis_b_px, e.angle_deg),
        disparity_px=o.disparity_px,
        in_collision_volume=bool(o.in_collision_volume),
        kind=ffi.string(lib.vista_obstacle_kind_name(o.kind)).decode(),
    )


def _motion(ffi: Any, lib: Any, m: Any) -> Motion:
    return Motion(
        known=m.known,
        source=ffi.string(lib.vista_motion_source_name(m.source)).decode(),
        restarted=m.restarted,
        velocity_m_s=np.array(list(m.velocity_m_s)) if m.velocity_known else None,
        turn_rate_rad_s=np.array(list(m.turn_rate_rad_s)),
        pose=Pose(np.array(list(m.pose.rotation)).reshape(3, 3), np.array(list(m.pose.translation_m))),
    )


def _health(ffi: Any, lib: Any, h: Any) -> Health:
    reasons = [k for k in range(lib.VISTA_HEALTH_REASON_COUNT) if h.reasons >> k & 1]
    return Health(
        state=ffi.string(lib.vista_health_state_name(h.state)).decode(),
        reasons=tuple(ffi.string(lib.vista_health_reason_name(k)).decode() for k in reasons),
        texts=tuple(ffi.string(lib.vista_health_reason_text(k)).decode() for k in reasons),
        matched_fraction=h.matched_fraction,
        contrast=h.contrast,
    )


def read_nearest(n: Any) -> Nearest:
    seconds = n.time_to_collision_s
    return Nearest(
        id=n.id,
        position_m=np.array(list(n.position_m)),
        distance_m=n.distance_m,
        time_to_collision_s=seconds if math.isfinite(seconds) else None,
        covariance_m2=np.array(list(n.covariance_m2)).reshape(3, 3),
    )
