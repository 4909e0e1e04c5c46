"""Structs of libvista in memory of numpy's own: copied whole, read in place, handed back as they are."""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from vista import native
from vista.geometry import Array, Calibration, Pose

SCALARS = {"double": "f8", "float": "f4", "_Bool": "?", "size_t": "u8"}  # and intN_t, uintN_t by their names
MATRIX = 9  # numbers of a row-major matrix, which is read as (3, 3)


@cache
def dtype_of(name: str) -> np.dtype[np.void]:
    """The layout of a struct, such as vista_obstacle."""
    ffi, _ = native.load("vista")
    layout: np.dtype[np.void] = np.dtype(_format(ffi, ffi.typeof(name)))
    return layout


def _format(ffi: Any, c: Any) -> Any:
    if c.kind == "struct":
        members = dict(c.fields)
        return {
            "names": list(members),
            "formats": [_format(ffi, member.type) for member in members.values()],
            "offsets": [member.offset for member in members.values()],
            "itemsize": ffi.sizeof(c),
        }
    if c.kind == "array":
        return np.dtype(_format(ffi, c.item)), (3, 3) if c.length == MATRIX else (c.length,)
    if c.kind == "primitive":
        return SCALARS.get(c.cname) or c.cname.removesuffix("_t")
    return f"u{ffi.sizeof(c)}"  # an enumeration or a pointer


@cache
def names_of(enumeration: str) -> tuple[str, ...]:
    """The names of the values of an enumeration, such as world_verdict."""
    ffi, lib = native.load("vista")
    name, count = (
        getattr(lib, form) for form in (f"vista_{enumeration}_name", f"VISTA_{enumeration.upper()}_COUNT")
    )
    return tuple(ffi.string(name(value)).decode() for value in range(count))


def copied(ffi: Any, pointer: Any, name: str, count: int) -> NDArray[np.void]:
    """So many structs of that name from the memory of C."""
    dtype = dtype_of(name)
    return np.frombuffer(ffi.buffer(pointer, count * dtype.itemsize), dtype).copy()


class Struct:
    """One struct of C. Its members are attributes; a member that is an enumeration is its name.

    A subclass names the struct, annotates the members that Python reads, and may read some in another way."""

    __slots__ = ("memory",)
    NAME: ClassVar[str]
    NAMES: ClassVar[dict[str, str]] = {}  # the enumeration of each member that is one
    PARTS: ClassVar[dict[str, type[Struct]]] = {}  # members that are structs

    def __init__(self, memory: NDArray[np.void]) -> None:
        """memory: an array without dimensions, of the struct's layout."""
        self.memory = memory

    @classmethod
    def copied(cls, ffi: Any, pointer: Any) -> Self:
        """The one that a pointer of C leads to."""
        return cls(copied(ffi, pointer, cls.NAME, 1).reshape(()))

    @classmethod
    def made(cls, **members: Any) -> Self:
        """One with these members as C has them, names for enumerations; the others are zero."""
        return cls(np.zeros((), dtype_of(cls.NAME)))._set(members)

    def but(self, **members: Any) -> Self:
        """A copy with other members."""
        return type(self)(self.memory.copy())._set(members)

    def in_c(self) -> Any:
        """A pointer of C to it, valid as long as this is."""
        return native.load("vista")[0].cast(f"{self.NAME} *", self.memory.ctypes.data)

    def _set(self, members: dict[str, Any]) -> Self:
        for name, value in members.items():
            if name in self.NAMES:
                value = names_of(self.NAMES[name]).index(value)
            self.memory[name] = value.memory if isinstance(value, Struct) else value
        return self

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "memory" or name not in (self.memory.dtype.names or ()):
            raise AttributeError(f"{type(self).__name__} has no {name}")
        value = self.memory[name]
        if name in self.NAMES:
            return names_of(self.NAMES[name])[int(value)]
        if name in self.PARTS:
            return self.PARTS[name](value)
        return value if value.ndim else value.item()

    def __repr__(self) -> str:
        return f"{type(self).__name__}{self.memory}"

    @classmethod
    def all_of(cls, memory: NDArray[np.void]) -> list[Self]:
        """The structs of an array."""
        return [cls(memory[k, ...]) for k in range(len(memory))]


def c_camera(ffi: Any, camera: Calibration) -> Any:
    """vista_camera."""
    values = (camera.width, camera.height, camera.focal_px, camera.cx, camera.cy, camera.baseline_m)
    return ffi.new("vista_camera *", values)


def c_pose(ffi: Any, pose: Pose) -> Any:
    """vista_pose."""
    return ffi.new("vista_pose *", (pose.rotation.ravel().tolist(), pose.translation_m.tolist()))


def c_vector(ffi: Any, vector: Array) -> Any:
    """Three numbers."""
    return ffi.new("double[3]", np.asarray(vector, float).tolist())


def c_image(ffi: Any, image: NDArray[np.uint8] | NDArray[np.int16]) -> Any:
    """vista_image of grey levels, vista_disparity_image of words. It leads to the array, which has to be
    contiguous and to last as long."""
    assert image.flags.c_contiguous
    grey = image.dtype == np.uint8
    name, item = ("vista_image", "uint8_t") if grey else ("vista_disparity_image", "int16_t")
    height, width = image.shape
    return ffi.new(f"{name} *", (ffi.cast(f"{item} *", image.ctypes.data), width, height, width))
