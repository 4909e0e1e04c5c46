"""The engine of the board model: its registers, and the words that the C model gives for them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from shared_data import REPOSITORY
from vista.engine import StereoEngine
from vista.rectify import by_table

_PAGE = (REPOSITORY / "rtl" / "csr" / "registers.md").read_text()
ADDRESS = {name: int(at, 16) for at, name in re.findall(r"^\| (0x\w\w) \|\s*(\w+)\s*\|", _PAGE, re.MULTILINE)}
MAGIC, VERSION = 0x56535445, 2 << 16 | 1
MAP_ROWS, MAP_SIZE = 1 << 6, 1 << 7


@dataclass(frozen=True)
class Build:
    num_disparities: int = 16
    block_size: int = 5
    max_width: int = 640
    max_height: int = 4095
    rectify_rows: int = 16
    map_points: int = 2048


@dataclass
class EngineModel:
    build: Build = field(default_factory=Build)
    magic: int = MAGIC
    values: dict[int, int] = field(default_factory=dict)
    points: list[int] = field(default_factory=list)
    committed: dict[int, int] = field(default_factory=dict)
    grids: tuple[np.ndarray, np.ndarray] | None = None
    points_written: int = 0

    def read(self, address: int) -> int:
        build = self.build
        fixed = {
            "ID": self.magic,
            "VERSION": VERSION,
            "BUILD": build.num_disparities | build.block_size << 16,
            "BUILD_SIZE": build.max_width | build.max_height << 16,
            "BUILD_FRONT_END": build.rectify_rows | build.map_points << 8,
            "MAP": 2,
        }
        by_address = {ADDRESS[name]: value for name, value in fixed.items()}
        return by_address.get(address, self.values.get(address, 0))

    def write(self, address: int, value: int) -> None:
        if address == ADDRESS["ERRORS"]:
            self.values[address] = self.values.get(address, 0) & ~value
        elif address == ADDRESS["MAP"]:
            self.points = []
        elif address == ADDRESS["MAP_POINT"]:
            self.points.append(value)
            self.points_written += 1
        elif address == ADDRESS["COMMIT"]:
            if value & 2:
                self._take_map()
            if value & 1:
                self.committed = dict(self.values)
        else:
            self.values[address] = value

    def _take_map(self) -> None:
        width, height = self._size(self.values)
        shape = (2, -(-height // 16) + 1, -(-width // 16) + 1, 2)
        numbers = np.array(self.points, np.uint32)
        error = 0
        if len(numbers) != np.prod(shape[:3]) or shape[1] * shape[2] > self.build.map_points:
            error = MAP_SIZE
        else:
            offsets = np.stack([numbers & 0xFFFF, numbers >> 16], -1).astype(np.uint16).view(np.int16)
            left, right = offsets.reshape(shape)
            if np.abs(offsets[:, 1]).max() > 32 * (self.build.rectify_rows // 2 - 2):
                error = MAP_ROWS
            else:
                self.grids = np.ascontiguousarray(left), np.ascontiguousarray(right)
        self.values[ADDRESS["ERRORS"]] = self.values.get(ADDRESS["ERRORS"], 0) | error

    def _size(self, values: dict[int, int]) -> tuple[int, int]:
        size = values[ADDRESS["SIZE"]]
        return size & 0xFFFF, size >> 16

    def stream(self, pixels: bytes) -> bytes:
        """The stream of disparities of a pair, {right, left} in raster order."""
        values = self.committed
        width, height = self._size(values)
        pairs = np.frombuffer(pixels[: 2 * width * height], np.uint8).reshape(height, width, 2)
        left, right = (np.ascontiguousarray(pairs[..., side]) for side in (0, 1))
        front_end, prefilter = values[ADDRESS["FRONT_END"]], values[ADDRESS["PREFILTER"]]
        lr_check = values[ADDRESS["LR_CHECK"]]
        if front_end & 2:
            assert self.grids is not None
            left, right = (
                by_table(grid)(image) for grid, image in zip(self.grids, (left, right), strict=True)
            )
        engine = StereoEngine(
            self.build.num_disparities,
            self.build.block_size,
            "xsobel" if prefilter & 1 else "none",
            prefilter >> 8,
            values[ADDRESS["TEXTURE"]],
            values[ADDRESS["UNIQUENESS"]],
            lr_check >> 8 if lr_check & 1 else None,
            smooth=bool(front_end & 1),
            levels=front_end >> 8,
        )
        return b"".join(narrow(words) for words in sent(engine.compute_levels(left, right)))


def sent(levels: list[np.ndarray]) -> list[np.ndarray]:
    """Those that the engine sends: none from the first one on that is smaller than 4x2."""
    small = [words.shape[1] < 4 or words.shape[0] < 2 for words in levels]
    return levels[: small.index(True) if True in small else len(levels)]


def narrow(words: np.ndarray) -> bytes:
    """Two disparities to a word; rows of odd width end with -16."""
    padded = np.pad(words, ((0, 0), (0, words.shape[1] % 2)), constant_values=-16)
    return padded.astype("<i2").tobytes()
