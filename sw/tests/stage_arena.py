"""libvista with its stages in reach: the library, its status names, and memory for one stage."""

from __future__ import annotations

import numpy as np
from vista import native
from vista_stages_abi import ffi

lib = ffi.dlopen(str(native.build_folder() / "lib" / "libvista_stages.so"))


def pointer(array: np.ndarray):
    """The array as an int32_t pointer; empty arrays are valid too."""
    assert array.dtype == np.int32 and array.flags.c_contiguous
    return ffi.cast("int32_t *", array.ctypes.data)


def status_name(status: int) -> str:
    return ffi.string(lib.vista_status_name(status)).decode()


def default_parameters():
    """A new vista_parameters; what it points to lives as long as it does."""
    values = ffi.new("vista_parameters *")
    assert lib.vista_parameters_init(values, ffi.sizeof("vista_parameters")) == lib.VISTA_OK
    return values


class Arena:
    """Memory for an arena: first counted with `layout`, then laid out on exactly that many bytes."""

    def __init__(self, layout, missing_bytes: int = 0) -> None:
        self.arena = ffi.new("vista_arena *")
        layout(self.arena)
        self.size = self.arena.used - missing_bytes
        self._memory = np.empty(self.size + 64, np.uint8)
        start = -self._memory.ctypes.data % 64
        self.arena.base = ffi.cast("unsigned char *", self._memory.ctypes.data + start)
        self.arena.size, self.arena.used = self.size, 0
        self.status = layout(self.arena)
