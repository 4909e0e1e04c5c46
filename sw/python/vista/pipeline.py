"""The host library libvista: from image, disparities, time and pose to obstacles."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.geometry import Array, Calibration, Pose
from vista.structs import Struct, c_camera, c_image, c_pose, c_vector, copied, names_of

# Ids of obstacles without a track, as vista/obstacle.h has them: pictures and reports of a run that is over
# name them without the library.
ID_TOO_NEAR = 0
ID_GROUND = -1
ID_PLACE = -2


class Ellipse(Struct):
    """An ellipse in the rectified left image (vista_ellipse)."""

    __slots__ = ()
    NAME = "vista_ellipse"
    center_u_px: float
    center_v_px: float
    axis_a_px: float  # the longer semi-axis
    axis_b_px: float
    angle_deg: float  # from +u to the longer axis, clockwise


class Obstacle(Struct):
    """One obstacle, as the track that it belongs to estimates it in a frame (vista/obstacle.h)."""

    __slots__ = ()
    NAME, NAMES = "vista_obstacle", {"world": "world_verdict", "kind": "obstacle_kind"}
    PARTS: ClassVar = {"ellipse": Ellipse}
    id: int  # number of the track, from 1; ID_TOO_NEAR, ID_GROUND or ID_PLACE without one
    confirmed: bool
    coasting: bool  # not seen in this frame
    in_blind_zone: bool  # nearer than the engine matches
    world: str  # verdict of the static-world test: OPEN, STANDS, MOVES, REFUTED
    age_frames: int
    position_m: Array  # (3,), in the world
    covariance_m2: Array  # (3, 3), of the position
    distance_m: float  # from the camera
    extent_m: Array  # (2,): width, height
    ellipse: Ellipse
    disparity_px: float
    in_collision_volume: bool
    kind: (
        str  # thing; too_near: to match; ground: where the path meets it; place: on the path, without a track
    )

    @property
    def is_thing(self) -> bool:
        """Whether it counts as an obstacle where obstacles are counted: a thing with a confirmed track."""
        return self.confirmed and self.kind == "thing"


class Nearest(Struct):
    """The nearest confirmed obstacle that meets the collision volume (vista_nearest_collision)."""

    __slots__ = ()
    NAME = "vista_nearest_collision"
    valid: bool
    id: int
    position_m: Array  # (3,), in the world
    distance_m: float
    covariance_m2: Array  # (3, 3), of the position: of the obstacle, and of which point of it is met first

    @property
    def time_to_collision_s(self) -> float | None:
        """None: hardly closing, or not known."""
        seconds = self.memory["time_to_collision_s"].item()
        return seconds if math.isfinite(seconds) else None


class Motion(Struct):
    """The vehicle's own motion as the detector worked with it (vista_motion)."""

    __slots__ = ()
    NAME, NAMES = "vista_motion", {"source": "motion_source"}
    known: bool  # otherwise positions in the world rest on a guess of the camera's pose
    source: str  # where the camera's pose comes from: POSE, STANDS, CARRIED_ON, REFUSED, UNTOLD
    restarted: bool  # the poses continued at another place, so all tracks were dropped
    turn_rate_rad_s: Array  # (3,), axis times rate, in the world

    @property
    def velocity_m_s(self) -> Array | None:
        """(3,), in the world; None: not known."""
        return self.memory["velocity_m_s"] if self.velocity_known else None

    @property
    def pose(self) -> Pose:
        """world_from_camera."""
        pose = self.memory["pose"]
        return Pose(pose["rotation"], pose["translation_m"])


class Health(Struct):
    """Whether the view tells anything: without obstacles only a healthy frame is clear (vista_health)."""

    __slots__ = ()
    NAME, NAMES = "vista_health", {"state": "health_state"}
    state: str  # healthy, degraded, blind
    matched_fraction: float  # of the pixels where the engine can find a disparity, those that have one
    contrast: float  # standard deviation of the cells, grey levels

    @property
    def reasons(self) -> tuple[str, ...]:
        """few_disparities, no_disparities, no_contrast, motion_unknown, pose_jump, noise, ground_unseen."""
        return tuple(names_of("health_reason")[k] for k in self._numbers())

    @property
    def texts(self) -> tuple[str, ...]:
        """The same in words."""
        ffi, lib = native.load("vista")
        return tuple(ffi.string(lib.vista_health_reason_text(k)).decode() for k in self._numbers())

    def _numbers(self) -> list[int]:
        bits = int(self.memory["reasons"])
        return [k for k in range(bits.bit_length()) if bits >> k & 1]


class Directions(Struct):
    """Which level directions are free: columns of one degree, to the right (vista_directions)."""

    __slots__ = ()
    NAME = "vista_directions"
    up_camera: NDArray[np.float64]  # against gravity
    free_m: NDArray[np.float32]  # how far nothing stands there: (COLUMNS,), the first FIRST_DEG from ahead
    blocked_m: NDArray[np.float32]  # where what ends it stands; 0: nothing is seen there

    FIRST_DEG, COLUMNS = -90, 180  # as vista/directions.h has them


class Outcome(Struct):
    """The output of one frame, whose pointers lead nowhere (vista_result)."""

    __slots__ = ()
    NAME = "vista_result"
    PARTS: ClassVar = {"nearest_collision": Nearest, "motion": Motion, "health": Health}
    obstacles: int  # address
    nearest_collision: Nearest
    motion: Motion
    health: Health
    valid_fraction: float
    region_count: int
    dropped_tracks: int
    path_seen_m: float
    collision_probability: float  # NaN: not known, or there is no nearest collision


@dataclass(frozen=True)
class Found:
    """What libvista found in one frame: copied as it is in memory, with the obstacles."""

    outcome: Outcome
    items: NDArray[np.void]  # vista_obstacle, nearest first
    directions: Directions | None  # None: not from a pipeline
    stage_ms: dict[str, float]  # of each stage in the order in which they ran

    @cached_property
    def obstacles(self) -> list[Obstacle]:
        """Nearest first."""
        return Obstacle.all_of(self.items)

    @property
    def nearest_collision(self) -> Nearest | None:
        nearest = self.outcome.nearest_collision
        return nearest if nearest.valid else None

    @property
    def motion(self) -> Motion:
        return self.outcome.motion

    @property
    def path_seen_m(self) -> float:
        """How far the flight path is free; beyond, no obstacle does not mean free space."""
        return self.outcome.path_seen_m

    @property
    def valid_fraction(self) -> float:
        return self.outcome.valid_fraction

    def in_c(self) -> tuple[Any, Any]:
        """vista_result and vista_directions, null where they are not known; valid as long as this is."""
        self.outcome.memory["obstacles"] = self.items.ctypes.data
        known = self.directions
        return self.outcome.in_c(), native.load("vista")[0].NULL if known is None else known.in_c()


class Pictures:
    """Pictures of the frame in work, in the memory of C (vista_views)."""

    def __init__(self, ffi: Any, views: Any, in_work: Callable[[], bool]) -> None:
        """in_work: whether the frame still is in work, and its pictures are there."""
        self._ffi, self._views, self._in_work = ffi, views, in_work

    def of_pixels(self, name: str, dtype: Any) -> NDArray[Any]:
        """(height, width)"""
        return self._copied(name, dtype, (self._views.height_px, self._views.width_px))

    def of_cells(self, name: str, dtype: Any) -> NDArray[Any]:
        """(cells,)"""
        return self._copied(name, dtype, (self._views.cell_count,))

    def of_regions(self, name: str, dtype: Any) -> NDArray[Any]:
        """(regions,)"""
        return self._copied(name, dtype, (self._views.region_count,))

    def _copied(self, name: str, dtype: Any, shape: tuple[int, ...]) -> NDArray[Any]:
        if not self._in_work():
            raise RuntimeError(f"{name} was not kept, and the next frame has begun")
        return copied_image(self._ffi, getattr(self._views, name), dtype, shape)


@dataclass(frozen=True)
class Result(Found):
    """The output of one frame, with its pictures. Each is copied when first asked for; once the next frame
    has begun that raises RuntimeError."""

    pictures: Pictures

    @cached_property
    def cell_of_pixel(self) -> NDArray[np.int32]:
        """(height, width): the cell under each pixel."""
        return self.pictures.of_pixels("cell_of_pixel", np.int32)

    @cached_property
    def cell_intensity(self) -> NDArray[np.float32]:
        """(cells,)"""
        return self.pictures.of_cells("cell_intensity", np.float32)

    @cached_property
    def cell_disparity_px(self) -> NDArray[np.float32]:
        """(cells,); negative: none."""
        return self.pictures.of_cells("cell_disparity_px", np.float32)

    @cached_property
    def region_of_cell(self) -> NDArray[np.int32]:
        """(cells,); -1: none."""
        return self.pictures.of_cells("region_of_cell", np.int32)

    @cached_property
    def region_of_pixel(self) -> NDArray[np.int32]:
        """(height, width); -1: none; boundaries follow the image."""
        return self.pictures.of_pixels("region_of_pixel", np.int32)

    @cached_property
    def verdict_of_region(self) -> list[str]:
        """Name of the verdict on each region."""
        verdicts = self.pictures.of_regions("verdict_of_region", np.uint32)
        return [names_of("region_verdict")[verdict] for verdict in verdicts]

    @cached_property
    def words(self) -> NDArray[np.int16]:
        """(height, width): the disparities of all levels together; negative: none."""
        return self.pictures.of_pixels("words", np.int16)

    @property
    def health(self) -> Health:
        """What libvista itself says of the view."""
        return self.outcome.health

    def keep(self) -> Self:
        """Copies all pictures, so that they outlast the frame."""
        for name in PICTURES:
            getattr(self, name)
        return self


PICTURES = tuple(name for name, member in vars(Result).items() if isinstance(member, cached_property))


def destroy(end: Any, made: Any, memory: Any) -> None:
    """Ends what was made in memory that is kept until then."""
    end(made)
    del memory


class Pipeline:
    """The detector for one camera. It holds the tracks from frame to frame."""

    library = "vista"

    def __init__(self, camera: Calibration, values: parameters.Values | None = None) -> None:
        self._ffi, self._lib = self.opened()
        self._camera = camera
        self._parameters = c_parameters(self._ffi, self._lib, values or parameters.defaults())
        self._c_camera = c_camera(self._ffi, camera)
        size = self._ffi.new("size_t *")
        self._check(self._lib.vista_pipeline_bytes(self._parameters, self._c_camera, size))
        self._memory = self._ffi.new("unsigned char[]", size[0])
        handle = self._ffi.new("vista_pipeline **")
        self._check(
            self._lib.vista_pipeline_create(self._memory, size[0], self._parameters, self._c_camera, handle)
        )
        self._pipeline = handle[0]
        # A second thread works in this memory, so it ends before that is given back.
        weakref.finalize(self, destroy, self._lib.vista_pipeline_destroy, self._pipeline, self._memory)
        self._result = self._ffi.new("vista_result *")
        self._directions = self._ffi.new("vista_directions *")

    @classmethod
    def opened(cls) -> tuple[Any, Any]:
        """The cffi pair of the library that this pipeline runs in."""
        return native.load(cls.library)

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
        not moved since the last frame. Raises ValueError on arrays of another type or size, times that do
        not increase, a pose that is not finite."""
        ffi = self._ffi
        levels = [disparity] if isinstance(disparity, np.ndarray) else list(disparity)
        most = 1 + self._lib.VISTA_COARSER_LEVELS
        if not 1 <= len(levels) <= most:
            raise ValueError(f"a frame has 1 to {most} levels, not {len(levels)}")
        typed = [(left, "u1")] + [(words, "i2") for words in levels]
        if any((array.dtype, array.ndim) != (np.dtype(wanted), 2) for array, wanted in typed):
            raise ValueError("the image has to be uint8 and int16 its disparities, both (height, width)")
        left, levels = np.ascontiguousarray(left), [np.ascontiguousarray(words) for words in levels]
        frame = ffi.new("vista_frame *")
        frame.image = c_image(ffi, left)[0]
        frame.disparity, *coarser = (c_image(ffi, words)[0] for words in levels)
        for k, words in enumerate(coarser):
            frame.coarser[k] = words
        frame.t_ns = t_ns
        if pose is not None:
            where = c_pose(ffi, pose)
            frame.pose = where
        if up_world is not None:
            up = c_vector(ffi, up_world)
            frame.up_world = up
        if velocity_m_s is not None:
            velocity = c_vector(ffi, velocity_m_s)
            frame.velocity_m_s = velocity
        frame.stationary = stationary
        self._check(
            self._lib.vista_pipeline_process_sized(
                self._pipeline, frame, ffi.sizeof(frame[0]), self._result, ffi.sizeof(self._result[0])
            )
        )
        self._check(self._lib.vista_pipeline_directions(self._pipeline, self._directions))
        return read_result(self._ffi, self._lib, self._result, self._directions, lambda: True).keep()

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)

    def _array(self, pointer: Any, count: int, dtype: Any) -> NDArray[Any]:
        return copied_image(self._ffi, pointer, dtype, (count,))


def copied_image(ffi: Any, pointer: Any, dtype: Any, shape: tuple[int, ...]) -> NDArray[Any]:
    """An array of that shape, from the memory of C."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    return np.frombuffer(ffi.buffer(pointer, size), dtype).reshape(shape).copy()


def read_result(ffi: Any, lib: Any, r: Any, directions: Any, in_work: Callable[[], bool]) -> Result:
    """Copies a vista_result and its directions, but for the pictures; in_work: whether these are there."""
    stages, views = range(r.stage_count), r.views
    stage_ms = {ffi.string(lib.vista_stage_name(k)).decode(): r.stage_ms[k] for k in stages}
    obstacles = copied(ffi, r.obstacles, Obstacle.NAME, r.obstacle_count)
    r.obstacles = r.views = r.stage_ms = ffi.NULL  # what is kept leads nowhere that the next frame changes
    return Result(
        Outcome.copied(ffi, r),
        obstacles,
        Directions.copied(ffi, directions),
        stage_ms | {"host": r.host_ms},
        Pictures(ffi, views, in_work),
    )


def c_parameters(ffi: Any, lib: Any, values: parameters.Values) -> Any:
    c = ffi.new("vista_parameters *")
    lib.vista_parameters_init(c, ffi.sizeof(c[0]))
    for name, value in parameters.flat(values).items():
        setter = lib.vista_parameters_set_choice if isinstance(value, str) else lib.vista_parameters_set
        if setter(c, name.encode(), value.encode() if isinstance(value, str) else value) != lib.VISTA_OK:
            raise ValueError(f"{name} is unknown or out of range")
    culprit = ffi.new("char const **")
    if lib.vista_parameters_check(c, culprit) != lib.VISTA_OK:
        raise ValueError(f"{ffi.string(culprit[0]).decode()} is out of range")
    return c
