"""The pipeline with its stages in reach: what the cuts of a frame saw, for figures and reference methods."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from vista.pipeline import Pipeline


@dataclass(frozen=True)
class CellGraph:
    """What the cuts of the last frame saw."""

    edges: NDArray[np.int32]  # (edges, 2) cells
    affinity: NDArray[np.float32]  # (edges,) w_ij, 0 .. 1
    edge_distance_px: NDArray[np.float32]  # (edges,) between the centres of its cells
    horizontal: NDArray[np.bool_]  # (cells,) on a surface to fly along
    cell_size_px: NDArray[np.float32]  # (cells,) width
    cell_center_px: NDArray[np.float32]  # (cells, 2) u, v


class PathPlace(NamedTuple):
    """A place on the flight path (path_places.h)."""

    along_m: float
    reach_m: float  # What is told at a range that differs by less is at this place.
    pieces: list[float]  # of evidence that something is there, in the order of PIECES
    known: bool  # enough for a warning
    probability: float  # that something is there


class OpenPipeline(Pipeline):
    """The same chain in the library that exports its stages."""

    library = "vista_stages"

    def cell_graph(self) -> CellGraph:
        """The graph of the last frame that was processed."""
        stages = self._lib.vista_pipeline_look(self._pipeline)
        f = stages.frame.foveation
        arcs, cells = f.graph.arc_count, f.node_count
        first_arc = self._array(f.graph.first_arc, cells + 1, np.int32)
        tail = np.repeat(np.arange(cells, dtype=np.int32), np.diff(first_arc))
        head = self._array(f.graph.head, arcs, np.int32)
        once = tail < head  # of the two arcs of an edge
        return CellGraph(
            np.stack([tail[once], head[once]], axis=1),
            self._array(stages.affinity.weight, arcs, np.float32)[once],
            self._array(f.arc_distance_px, arcs, np.float32)[once],
            self._array(stages.surfaces.horizontal, cells, np.uint8) != 0,
            self._array(f.size_px, cells, np.float32),
            np.stack([self._array(center, cells, np.float32) for center in (f.center_u, f.center_v)], axis=1),
        )

    def path_places(self) -> list[PathPlace]:
        """Those of the last frame, by distance."""
        lib, places = self._lib, self._lib.vista_pipeline_look(self._pipeline).places
        pieces = self._ffi.new("double[]", lib.VISTA_PIECE_COUNT)
        found = []
        for k in range(places.count):
            place = self._ffi.addressof(places.items, k)
            lib.vista_path_place_pieces(place, pieces)
            known = bool(lib.vista_path_place_is_known(place))
            found.append(PathPlace(place.along_m, place.reach_m, list(pieces), known, place.probability))
        return found

    def refine_boundaries(self, region_of_cell: NDArray[np.int32]) -> NDArray[np.int32]:
        """Region of each pixel (height, width) of any partition of the last frame's cells, drawn as the chain
        draws its own."""
        label = np.ascontiguousarray(region_of_cell, np.int32)
        c_label = self._ffi.cast("int32_t *", label.ctypes.data)
        drawn = self._ffi.new("vista_judged_partition *")
        memory = lay_out(
            self._ffi,
            lambda arena: self._check(
                self._lib.vista_pipeline_draw_partition(self._pipeline, c_label, arena, drawn)
            ),
        )
        return self._region_of_pixel(drawn, memory)

    def judge_partition(self, region_of_cell: NDArray[np.int32]) -> tuple[NDArray[np.int32], list[str]]:
        """The region of each pixel (height, width) for any partition of the last frame's cells, and the
        host's verdicts on the regions, which are all taken for grown from disparities of their own. Pixels of
        the ground at the foot of obstacles have no region, as with the host's own regions."""
        ffi, lib = self._ffi, self._lib
        label = np.ascontiguousarray(region_of_cell, np.int32)
        c_label, count = ffi.cast("int32_t *", label.ctypes.data), int(label.max()) + 1
        judged = ffi.new("vista_judged_partition *")
        memory = lay_out(
            ffi,
            lambda arena: self._check(
                lib.vista_pipeline_judge_partition(self._pipeline, c_label, count, arena, judged)
            ),
        )
        verdicts = [judged.regions.items[k].verdict for k in range(count)]
        names = [ffi.string(lib.vista_region_verdict_name(verdict)).decode() for verdict in verdicts]
        return self._region_of_pixel(judged, memory), names

    def _region_of_pixel(self, judged: Any, memory: Any) -> NDArray[np.int32]:
        """A copy of what lies in the memory."""
        f = self._lib.vista_pipeline_look(self._pipeline).frame.foveation
        pixels = self._array(judged.region_of_pixel, f.height_px * f.width_px, np.int32)
        found = np.array(pixels.reshape(f.height_px, f.width_px))
        del memory
        return found


def lay_out(ffi: Any, layout: Callable[[Any], None]) -> Any:
    """Memory for what `layout` takes from an arena; it has to be kept."""
    arena = ffi.new("vista_arena *")
    layout(arena)
    memory = ffi.new("unsigned char[]", arena.used + 64)
    base = int(ffi.cast("uintptr_t", memory))
    arena.base = ffi.cast("unsigned char *", base + -base % 64)
    arena.size, arena.used = arena.used, 0
    layout(arena)
    return memory
