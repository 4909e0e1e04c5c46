"""Albedo maps with all their halvings, read with a footprint: what a pixel covers is averaged, not missed."""

from __future__ import annotations

import cv2
import numpy as np

TAPS = 4  # along the longer axis of a footprint
TAP_OFFSETS = (np.arange(TAPS) + 0.5) / TAPS - 0.5


def halvings(albedo: np.ndarray) -> list[np.ndarray]:
    """The map, then each time half as many rows and columns, down to one texel."""
    levels: list[np.ndarray] = [np.ascontiguousarray(albedo, np.float32)]
    while max(levels[-1].shape) > 1:
        rows, columns = levels[-1].shape
        size = max(columns // 2, 1), max(rows // 2, 1)
        levels.append(cv2.resize(levels[-1], size, interpolation=cv2.INTER_AREA))
    return levels


class AlbedoMaps:
    """The maps of all solids, one behind the other. Where a map is read: columns and rows as shares of its
    size."""

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

    def read(self, which: np.ndarray, place: np.ndarray, du: np.ndarray, dv: np.ndarray) -> np.ndarray:
        """(n,) albedo at `place` (n, 2), averaged over a pixel, whose sides are `du` and `dv` (n, 2)."""
        size = self.sizes[which, 0].astype(np.float32)
        along_u, along_v = np.hypot(*(du * size).T), np.hypot(*(dv * size).T)
        longer = np.where((along_u > along_v)[:, None], du, dv)
        texels = np.maximum(np.minimum(along_u, along_v), np.maximum(along_u, along_v) / TAPS)
        level = np.rint(np.log2(np.maximum(texels, 1.0))).astype(np.int32)
        level = np.minimum(level, self.sizes.shape[1] - 1)
        stretched = np.maximum(along_u, along_v) > 1.0
        found = np.empty(len(which), np.float32)
        once = ~stretched
        found[once] = self.interpolated(which[once], level[once], place[once])
        many = np.flatnonzero(stretched)
        if len(many):
            taps = [place[many] + np.float32(offset) * longer[many] for offset in TAP_OFFSETS]
            read = [self.interpolated(which[many], level[many], tap) for tap in taps]
            found[many] = np.sum(read, axis=0) / np.float32(TAPS)
        return found

    def interpolated(self, which: np.ndarray, level: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Linearly between the middles of texels; beyond the outermost ones it stays as there."""
        size, start = self.sizes[which, level], self.starts[which, level]
        texel = np.clip(place * size - np.float32(0.5), 0, size - 1).astype(np.float32)
        first = texel.astype(np.int32)
        share = texel - first
        step = np.minimum(first + 1, size - 1) - first
        here = start + first[:, 1].astype(np.int64) * size[:, 0] + first[:, 0]
        right, below = step[:, 0], step[:, 1] * size[:, 0]
        upper = self.texels[here] * (1 - share[:, 0]) + self.texels[here + right] * share[:, 0]
        here = here + below
        lower = self.texels[here] * (1 - share[:, 0]) + self.texels[here + right] * share[:, 0]
        return upper * (1 - share[:, 1]) + lower * share[:, 1]
