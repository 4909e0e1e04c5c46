"""The client of a board in C, what it is set to, and the words that it should fetch."""

from __future__ import annotations

from typing import Any

import numpy as np
from vista import native
from vista.engine import StereoEngine
from vista.rectify import by_table

ffi, lib = native.load("vista")

Settings = dict[str, Any]
SETTINGS: Settings = {
    "width_px": 90, "height_px": 41, "xsobel": 1, "prefilter_cap": 31, "texture_threshold": 10,
    "uniqueness_ratio": 15, "lr_max_diff": 1, "smooth": 0, "levels": 1,
}  # fmt: skip
TIMEOUT_MS = 10000


class Client:
    """The C client; every function raises the name of a status other than VISTA_OK."""

    def __init__(self, port: int, timeout_ms: int = TIMEOUT_MS) -> None:
        self._memory = ffi.new("char[]", lib.vista_board_bytes() + 1)
        board = ffi.new("vista_board **")
        call(
            lib.vista_board_connect(
                self._memory + 1, len(self._memory) - 1, b"127.0.0.1", port, timeout_ms, board
            )
        )
        self.board = board[0]

    def configure(self, settings: Settings) -> None:
        maps = {side: settings.get(side) for side in ("left_map", "right_map")}
        kept = {side: ffi.from_buffer("int16_t[]", grid) for side, grid in maps.items() if grid is not None}
        self.size = settings["width_px"], settings["height_px"]
        call(lib.vista_board_configure(self.board, ffi.new("vista_board_settings *", settings | kept)))

    def submit(self, left: np.ndarray, right: np.ndarray) -> None:
        assert left.strides == right.strides
        pixels = [ffi.cast("uint8_t *", image.ctypes.data) for image in (left, right)]
        call(lib.vista_board_submit(self.board, *pixels, left.strides[0]))

    def collect(self) -> np.ndarray:
        words = np.zeros(lib.vista_board_words(self.board), np.int16)
        call(lib.vista_board_collect(self.board, ffi.from_buffer("int16_t[]", words), words.size))
        return words

    def start(self) -> None:
        call(lib.vista_board_start(self.board))

    def stop(self) -> None:
        call(lib.vista_board_stop(self.board))

    def receive(self) -> tuple[Any, np.ndarray]:
        """vista_board_pair, and the words."""
        words = np.zeros(lib.vista_board_words(self.board), np.int16)
        pair = ffi.new("vista_board_pair *")
        call(lib.vista_board_receive(self.board, ffi.from_buffer("int16_t[]", words), words.size, pair))
        return pair, words

    def build(self) -> Any:
        build = ffi.new("vista_board_build *")
        call(lib.vista_board_identify(self.board, build))
        return build

    @property
    def counts(self) -> Any:
        return lib.vista_board_count(self.board)


class BoardError(Exception):
    pass


def call(status: int) -> None:
    if status != lib.VISTA_OK:
        raise BoardError(ffi.string(lib.vista_status_name(status)).decode())


def random_pair(
    rng: np.random.Generator, settings: Settings, stride: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """A texture and itself moved, each a part of a wider array if there is a stride."""
    width, height = settings["width_px"], settings["height_px"]
    scene = rng.integers(0, 256, (height, max(stride, width) + 8), np.uint8)
    return np.ascontiguousarray(scene[:, :-8])[:, :width], np.ascontiguousarray(scene[:, 8:])[:, :width]


def random_settings(rng: np.random.Generator) -> Settings:
    width, height = int(rng.integers(4, 260)), int(rng.integers(2, 90))
    settings = SETTINGS | {
        "width_px": width, "height_px": height, "xsobel": int(rng.integers(2)),
        "prefilter_cap": int(rng.integers(1, 64)), "texture_threshold": int(rng.choice([0, 10, 65536 + 10])),
        "uniqueness_ratio": int(rng.integers(0, 30)), "lr_max_diff": int(rng.choice([-1, 0, 1, 256])),
        "smooth": int(rng.integers(2)), "levels": int(rng.integers(1, 5)),
    }  # fmt: skip
    if rng.random() < 0.5:
        shape = (-(-height // 16) + 1, -(-width // 16) + 1, 2)
        for side in ("left_map", "right_map"):
            settings[side] = rng.integers(-60, 61, shape).astype(np.int16)
    return settings


def golden(settings: Settings, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The words of the C model, all levels one after the other; levels that are not sent have none anyway."""
    if "left_map" in settings:
        left, right = by_table(settings["left_map"])(left), by_table(settings["right_map"])(right)
    off = settings["lr_max_diff"] < 0
    engine = StereoEngine(
        16, 5, "xsobel" if settings["xsobel"] else "none", settings["prefilter_cap"],
        min(settings["texture_threshold"], 65535), settings["uniqueness_ratio"],
        None if off else settings["lr_max_diff"], smooth=bool(settings["smooth"]), levels=settings["levels"],
    )  # fmt: skip
    return np.concatenate([words.ravel() for words in engine.compute_levels(left, right)])
