"""Albedo maps with all their halvings, of which rays read the one that is as coarse as their pixel."""

from __future__ import annotations

import cv2
import numpy as np


def halvings(albedo: np.ndarray) -> list[np.ndarray]:
    """The map, then each time half as many rows and columns, down to one texel."""
    levels: list[np.ndarray] = [np.ascontiguousarray(albedo, np.float32)]
    while max(levels[-1].shape) > 1:
        rows, columns = levels[-1].shape
        size = max(columns // 2, 1), max(rows // 2, 1)
        levels.append(cv2.resize(levels[-1], size, interpolation=cv2.INTER_AREA))
    return levels


class AlbedoMaps:
    """The maps of all solids, one behind the other."""

    def __init__(self, albedos: list[np.ndarray]) -> None:
        chains = [halvings(albedo) for albedo in albedos]
        depth = max((len(chain) for chain in chains), default=1)
        self.sizes = np.ones((len(chains), depth, 2), np.int32)  # columns, rows
        self.starts = np.zeros((len(chains), depth), np.int64)
        start, parts = 0, []
        for k, chain in enumerate(chains):
            for level in range(depth):
                if level < len(chain):
                    parts.append(chain[level].ravel())
                    self.sizes[k, level] = chain[level].shape[::-1]
                    self.starts[k, level] = start
                    start += chain[level].size
                else:
                    self.starts[k, level] = start - 1  # the one texel
        self.texels = np.concatenate(parts) if parts else np.zeros(1, np.float32)
