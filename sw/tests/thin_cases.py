"""Views with a wire, drawn with the coverage of each pixel, and the stage that finds it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from stage_library import Arena, camera, default_parameters, ffi, frame_view, image_struct, lib, status_name
from vista.engine import INVALID

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 640, 480, 1000.0, 0.4572
BLOCK_RADIUS_PX = 5
CAMERA = camera(WIDTH, HEIGHT, FOCAL_PX, BASELINE_M)
CENTER = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
SUB = 5  # samples a pixel and axis


@dataclass(frozen=True)
class Wire:
    """Straight, in camera coordinates (right, down, forward), across the whole view."""

    middle_m: np.ndarray
    direction: np.ndarray  # unit length
    diameter_m: float
    grey: float = 30.0

    @property
    def line_px(self) -> tuple[np.ndarray, np.ndarray]:
        """A point of its image and the unit vector along it."""
        near, far = self.middle_m, self.middle_m + 0.1 * self.direction
        ends = [CENTER + FOCAL_PX * p[:2] / p[2] for p in (near, far)]
        along = ends[1] - ends[0]
        return ends[0], along / np.linalg.norm(along)

    def disparity_px(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """The disparity of the wire's point that is seen nearest to each pixel."""
        point, along = self.line_px
        t = (np.asarray(u) - point[0]) * along[0] + (np.asarray(v) - point[1]) * along[1]
        ray = np.stack([*((point[:, None] + along[:, None] * np.ravel(t)) - CENTER[:, None]) / FOCAL_PX])
        # x / z = ray_x along the wire: (m + s d)_x = ray_x (m + s d)_z, solved along the axis it moves on.
        axis = int(np.argmax(np.abs(along)))
        m, d = self.middle_m, self.direction
        s = (ray[axis] * m[2] - m[axis]) / (d[axis] - ray[axis] * d[2])
        return (FOCAL_PX * BASELINE_M / (m[2] + s * d[2])).reshape(np.shape(u))

    def offset_px(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Distance of each pixel from the middle of its image, across it."""
        point, along = self.line_px
        return (u - point[0]) * along[1] - (v - point[1]) * along[0]


def wire_at(angle_deg: float, range_m: float, diameter_m: float, x_m: float = 0.0, y_m: float = 0.0, **more):
    """Square to the optical axis, at this angle from the horizontal."""
    angle = np.radians(angle_deg)
    direction = np.array([np.cos(angle), np.sin(angle), 0.0])
    return Wire(np.array([x_m, y_m, range_m]), direction, diameter_m, **more)


def grid() -> tuple[np.ndarray, np.ndarray]:
    v, u = np.mgrid[:HEIGHT, :WIDTH].astype(float)
    return u, v


def coverage(wire: Wire, shift_px: float = 0.0) -> np.ndarray:
    """Share of each pixel that the wire covers; shift_px: of every pixel by its disparity times this."""
    u, v = grid()
    disparity = wire.disparity_px(u, v)
    width_px = wire.diameter_m * disparity / BASELINE_M
    total = np.zeros((HEIGHT, WIDTH))
    steps = (np.arange(SUB) + 0.5) / SUB - 0.5
    for du in steps:
        for dv in steps:
            off = np.abs(wire.offset_px(u + du + shift_px * disparity, v + dv))
            total += np.clip((width_px / 2 - off) * SUB + 0.5, 0.0, np.minimum(1.0, width_px * SUB))
    return total / SUB**2


def with_wire(grey: np.ndarray, wire: Wire, random: np.random.Generator, noise=2.0, shift_px: float = 0.0):
    covered = coverage(wire, shift_px)
    image = grey * (1.0 - covered) + wire.grey * covered + random.normal(0.0, noise, grey.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def words_around(wire: Wire, behind_px: float, random: np.random.Generator, share: float = 1.0) -> np.ndarray:
    """The words of an engine with ideal blocks: those that the wire is in are its, as far as `share` of
    the rows of blocks go, all others of what is behind_px (negative: nothing)."""
    u, v = grid()
    _, along = wire.line_px
    flat = abs(along[0]) > abs(along[1])
    aside = np.abs(wire.offset_px(u, v)) / (abs(along[0]) if flat else abs(along[1]))
    near = aside <= (BLOCK_RADIUS_PX + 1) * (1.0 + abs(along[1] / along[0] if flat else along[0] / along[1]))
    taken = np.repeat(random.random(HEIGHT // 8 + 1) < share, 8)[:HEIGHT, None]
    disparity = np.where(near & taken, wire.disparity_px(u, v), behind_px)
    words = np.rint(16 * (disparity + random.normal(0.0, 0.1, disparity.shape)))
    return np.where(disparity < 0, INVALID, words).astype(np.int16)


class Thin:
    def __init__(self, **changes: float) -> None:
        self._parameters = default_parameters()
        self.params = self._parameters.thin
        for name, value in changes.items():
            setattr(self.params, name, value)
        self._handle = ffi.new("vista_thin **")
        self._arena = Arena(lambda arena: lib.vista_thin_layout(self._handle, arena, WIDTH, HEIGHT))
        assert status_name(self._arena.status) == "VISTA_OK"

    def find(
        self, image: np.ndarray, words: np.ndarray, ground=None, at_m=None, turn=None, restarted=False
    ) -> list:
        """ground: offset and slopes of its plane. at_m: where the camera is, if that is known. turn: world
        from camera, if it looks another way than at the beginning."""
        noise = ffi.new("vista_image_noise *")
        assert lib.vista_image_noise_measure(image_struct("image", image), noise) == lib.VISTA_OK
        area = ffi.new("vista_matched_area *", {"disparity_max_px": 127.0, "margin_px": BLOCK_RADIUS_PX})
        path = ffi.new("vista_flight_path *", {"direction": [0.0, 0.0, 1.0], "length_m": 60.0})
        frame = frame_view(
            self._parameters, CAMERA, matched=area, image=image, levels=[words], noise=noise.sigma, path=path
        )
        frame.motion.known, frame.motion.restarted = at_m is not None, restarted
        frame.motion.pose.translation_m = [0.0, 0.0, 0.0] if at_m is None else [float(x) for x in at_m]
        if turn is not None:
            frame.motion.pose.rotation = [float(x) for x in np.ravel(turn)]
        surfaces = ffi.new("vista_surfaces *")
        if ground is not None:
            surfaces.ground_found, surfaces.ground = True, list(ground)
        lib.vista_thin_search(frame, surfaces, self._handle[0])
        lines = lib.vista_thin_found(self._handle[0])
        return [ffi.new("vista_thin_line *", lines.items[k]) for k in range(lines.count)]
