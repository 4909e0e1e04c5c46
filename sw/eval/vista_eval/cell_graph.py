"""The pipeline with its stages in reach: what the cuts of a frame saw, for figures and reference methods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from vista.pipeline import Pipeline

PADDING = 16  # pixels behind the last one that whole vectors reach


@dataclass(frozen=True)
class CellGraph:
    """What the cuts of the last frame saw."""

    edges: NDArray[np.int32]  # (edges, 2) cells
    affinity: NDArray[np.float32]  # (edges,) w_ij, 0 .. 1
    horizontal: NDArray[np.bool_]  # (cells,) on a surface to fly along
    cell_size_px: NDArray[np.float32]  # (cells,) width
    cell_center_px: NDArray[np.float32]  # (cells, 2) u, v


class OpenPipeline(Pipeline):
    """The same chain in the library that exports its stages."""

    library = "vista_stages"

    def cell_graph(self) -> CellGraph:
        """The graph of the last frame that was processed."""
        stages = self._lib.vista_pipeline_look(self._pipeline)
        f = stages.foveation
        arcs, cells = f.graph.arc_count, f.node_count
        first_arc = self._array(f.graph.first_arc, cells + 1, np.int32)
        tail = np.repeat(np.arange(cells, dtype=np.int32), np.diff(first_arc))
        head = self._array(f.graph.head, arcs, np.int32)
        once = tail < head  # of the two arcs of an edge
        return CellGraph(
            np.stack([tail[once], head[once]], axis=1),
            self._array(stages.affinity.weight, arcs, np.float32)[once],
            self._array(stages.surfaces.horizontal, cells, np.uint8) != 0,
            self._array(f.size_px, cells, np.float32),
            np.stack([self._array(center, cells, np.float32) for center in (f.center_u, f.center_v)], axis=1),
        )

    def refine_boundaries(self, region_of_cell: NDArray[np.int32]) -> NDArray[np.int32]:
        """Region of each pixel (height, width) of any partition of the last frame's cells, drawn as the chain
        draws its own."""
        ffi, stages = self._ffi, self._lib.vista_pipeline_look(self._pipeline)
        f, params = stages.foveation, stages.refinement_params
        label = np.ascontiguousarray(region_of_cell)
        shape = f.height_px, f.width_px
        drawn, border = np.empty(shape, np.int32), np.empty(f.node_count, np.uint8)
        listed = np.empty(drawn.size + PADDING, np.int32)
        out = ffi.new(
            "vista_refinement *",
            {
                "label": ffi.cast("int32_t *", drawn.ctypes.data),
                "border": ffi.cast("uint8_t *", border.ctypes.data),
                "listed": ffi.cast("int32_t *", listed.ctypes.data),
            },
        )
        c_label = ffi.cast("int32_t *", label.ctypes.data)
        self._check(self._lib.vista_refine(f, params, stages.cells, c_label, out))
        return drawn
