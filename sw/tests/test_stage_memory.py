"""The memory that stages lay out: aligned, and a byte too little is reported, whichever stage it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from stage_library import Arena, Foveation, camera, ffi, lib, status_name

OVER_CELLS = (
    "affinity",
    "cells",
    "refinement",
    "regions",
    "seeds",
    "segmentation",
    "surfaces",
    "terrain",
)
OVER_PIXELS = {
    "space_map": lambda out, arena: lib.vista_space_map_layout(out, arena, camera(64, 48)),
    "words": lambda out, arena: lib.vista_words_layout(out, arena, 64, 48),
}
OF_THEIR_OWN: dict[str, Callable[[Any, Any], int]] = {
    "obstacle_map": lambda out, arena: lib.vista_obstacle_map_layout(8, arena, out),
    "thin": lambda out, arena: lib.vista_thin_layout(out, arena, 64, 48),
    "tracker": lambda out, arena: lib.vista_tracker_layout(8, 8, arena, out),
    "region_tracker": lambda out, arena: lib.vista_region_tracker_layout(8, arena, out),
}


@pytest.mark.parametrize("name", OVER_CELLS)
def test_a_byte_too_little_for_a_stage_is_reported(name: str) -> None:
    foveation, out = Foveation(64, 48), ffi.new(f"vista_{name} *")
    layout = getattr(lib, f"vista_{name}_layout")
    for missing, status in ((0, "VISTA_OK"), (1, "VISTA_ERROR_MEMORY")):
        arena = Arena(lambda arena: layout(out, arena, foveation.handle), missing)
        assert status_name(arena.status) == status


@pytest.mark.parametrize("name", OVER_PIXELS)
def test_a_byte_too_little_for_a_stage_over_pixels_is_reported(name: str) -> None:
    out = ffi.new(f"vista_{name} *")
    for missing, status in ((0, "VISTA_OK"), (1, "VISTA_ERROR_MEMORY")):
        arena = Arena(lambda arena: OVER_PIXELS[name](out, arena), missing)
        assert status_name(arena.status) == status


@pytest.mark.parametrize("name", OF_THEIR_OWN)
def test_a_byte_too_little_for_a_stage_of_its_own_is_reported(name: str) -> None:
    out = ffi.new(f"vista_{name} **")
    for missing, status in ((0, "VISTA_OK"), (1, "VISTA_ERROR_MEMORY")):
        arena = Arena(lambda arena: OF_THEIR_OWN[name](out, arena), missing)
        assert status_name(arena.status) == status
        assert (out[0] == ffi.NULL) == (missing == 1)


@pytest.mark.parametrize("size", [(0, 5), (5, 0)])
def test_images_without_pixels_are_refused(size: tuple[int, int]) -> None:
    arena = ffi.new("vista_arena *")
    assert status_name(lib.vista_words_layout(ffi.new("vista_words *"), arena, *size)) == "VISTA_ERROR_SIZE"
    assert status_name(lib.vista_thin_layout(ffi.new("vista_thin **"), arena, *size)) == "VISTA_ERROR_SIZE"


@pytest.mark.parametrize("shift", [0, 1, 8, 33, 63])
def test_the_arena_aligns_whatever_memory_it_gets(shift: int) -> None:
    memory = np.zeros(4096, np.uint8)
    start = memory.ctypes.data + (-memory.ctypes.data) % 64 + shift
    arena: Any = ffi.new("vista_arena *", [ffi.cast("unsigned char *", start), 2048, 0])
    places = [int(ffi.cast("uintptr_t", lib.vista_arena_take(arena, count, 4))) for count in (1, 3, 40, 1)]
    assert all(place % 64 == 0 for place in places)
    assert places == sorted(set(places)) and places[0] - start < 64
    assert arena.used <= 6 * 64 + 63
