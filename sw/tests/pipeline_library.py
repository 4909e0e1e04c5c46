"""libvista's whole chain through cffi, every pointer in the test's hand."""

from __future__ import annotations

import board_flight as scene
import numpy as np
from stage_library import default_parameters as fresh_parameters
from stage_library import ffi, lib, status_name
from vista.geometry import Calibration

CALIBRATION = Calibration(scene.WIDTH, scene.HEIGHT, scene.FOCAL_PX, scene.CX, scene.CY, scene.BASELINE_M)
GUARD_BYTES = 256
GUARD = 0xA5


def default_camera(**changes: float):
    values = {
        "width_px": scene.WIDTH,
        "height_px": scene.HEIGHT,
        "focal_px": scene.FOCAL_PX,
        "center_u_px": scene.CX,
        "center_v_px": scene.CY,
        "baseline_m": scene.BASELINE_M,
    }
    return ffi.new("vista_camera *", values | changes)


def default_parameters(**changes: float):
    """changes: section__name=number."""
    parameters = fresh_parameters()
    for name, value in changes.items():
        assert lib.vista_parameters_set(parameters, name.replace("__", ".").encode(), value) == lib.VISTA_OK
    return parameters


def bytes_needed(parameters, camera) -> tuple[str, int]:
    size = ffi.new("size_t *")
    return status_name(lib.vista_pipeline_bytes(parameters, camera, size)), size[0]


def process(handle, frame, result) -> int:
    """vista_pipeline_process, an inline function of the header."""
    sizes = ffi.sizeof("vista_frame"), ffi.sizeof("vista_result")
    return lib.vista_pipeline_process_sized(handle, frame, sizes[0], result, sizes[1])


class Frame:
    """A vista_frame with the memory behind it; strides in items, 0: the width."""

    def __init__(self, source: scene.BoardFrame, image_stride: int = 0, disparity_stride: int = 0) -> None:
        self.image, self.words = (
            padded(source.left, image_stride, 77),
            padded(source.words, disparity_stride, 333),
        )
        self.pose = ffi.new(
            "vista_pose *", [scene.WORLD_FROM_CAMERA.ravel().tolist(), source.position_m.tolist()]
        )
        self.up_world = ffi.new("double[3]", scene.UP_WORLD.tolist())
        self.c = ffi.new("vista_frame *")
        height, width = source.left.shape
        for target, array, c_type in (
            (self.c.image, self.image, "uint8_t *"),
            (self.c.disparity, self.words, "int16_t *"),
        ):
            target.data = ffi.cast(c_type, array.ctypes.data)
            target.width_px, target.height_px, target.stride = width, height, array.shape[1]
        self.c.pose, self.c.up_world, self.c.t_ns = self.pose, self.up_world, source.t_ns

    def poison(self) -> None:
        self.image[:], self.words[:] = 255, 1000
        for memory, size in (
            (self.pose, ffi.sizeof("vista_pose")),
            (self.up_world, ffi.sizeof("double[3]")),
            (self.c, ffi.sizeof("vista_frame")),
        ):
            ffi.buffer(memory, size)[:] = b"\x7f" * size


def padded(array: np.ndarray, stride: int, fill: int) -> np.ndarray:
    wide = np.full((array.shape[0], max(stride, array.shape[1])), fill, array.dtype)
    wide[:, : array.shape[1]] = array
    return wide


def plain(value):
    """A struct, array or number of C as Python values; without pointers, NaN as a text that equals itself."""
    if not isinstance(value, ffi.CData):
        return "nan" if value != value else value
    kind = ffi.typeof(value)
    if kind.kind == "struct":
        names = [name for name, field in kind.fields if field.type.kind != "pointer"]
        return {name: plain(getattr(value, name)) for name in names}
    return [plain(item) for item in value]


def snapshot(result) -> dict:
    """Everything in a result but the times, copied."""
    views = result.views
    nodes, regions = views.cell_count, views.region_count
    return {
        "nodes": nodes,
        "valid_fraction": result.valid_fraction,
        "intensity": bytes(ffi.buffer(views.cell_intensity, 4 * nodes)),
        "disparity_px": bytes(ffi.buffer(views.cell_disparity_px, 4 * nodes)),
        "label": bytes(ffi.buffer(views.region_of_cell, 4 * nodes)),
        "regions": [views.verdict_of_region[k] for k in range(regions)],
        "accepted_count": result.accepted_count,
        "obstacles": [plain(result.obstacles[k]) for k in range(result.obstacle_count)],
        "nearest_collision": plain(result.nearest_collision),
    }


class Pipeline:
    """A pipeline in exactly the bytes it asks for, `shift` bytes off alignment, between two guards."""

    def __init__(self, parameters=None, camera=None, shift: int = 0, missing_bytes: int = 0) -> None:
        parameters, camera = parameters or default_parameters(), camera or default_camera()
        status, size = bytes_needed(parameters, camera)
        assert status == "VISTA_OK", status
        size -= missing_bytes
        self._memory = np.full(size + 2 * GUARD_BYTES, GUARD, np.uint8)
        self._first = GUARD_BYTES + (shift - self._memory.ctypes.data - GUARD_BYTES) % 64
        self._end = self._first + size
        handle = ffi.new("vista_pipeline **")
        self.status = status_name(
            lib.vista_pipeline_create(
                ffi.cast("void *", self._memory.ctypes.data + self._first), size, parameters, camera, handle
            )
        )
        self.handle = handle[0]
        self.result = ffi.new("vista_result *")

    def process(self, frame: Frame) -> str:
        return status_name(process(self.handle, frame.c, self.result))

    def fly(self, sources) -> list[dict]:
        """Snapshots of all frames, each of which has to succeed."""
        snapshots = []
        for source in sources:
            frame = Frame(source)
            assert self.process(frame) == "VISTA_OK"
            snapshots.append(snapshot(self.result))
        return snapshots

    def reset(self) -> None:
        lib.vista_pipeline_reset(self.handle)

    @property
    def guards_hold(self) -> bool:
        outside = np.concatenate([self._memory[: self._first], self._memory[self._end :]])
        return bool((outside == GUARD).all())
