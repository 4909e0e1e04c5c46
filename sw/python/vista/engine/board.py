"""A stereo engine on a board, reached over UDP: it rectifies, reduces, smooths and matches raw pairs."""

from __future__ import annotations

import socket
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from vista import native
from vista.control_grid import Grid, GridPair
from vista.engine.contract import Disparity, EngineParameters, Image, check_images
from vista.engine.golden import StereoEngine
from vista.engine.hardware import level_shapes, settings_of, split_levels
from vista.errors import InputError

DEFAULT_TIMEOUT_S = 2


def parse_address(text: str, default_port: int) -> tuple[str, int]:
    """HOST or HOST:PORT; ValueError otherwise."""
    host, colon, port = text.partition(":")
    if not host or (colon and not (port.isdecimal() and 1 <= int(port) <= 65535)):
        raise ValueError(f"{text!r} is not HOST or HOST:PORT")
    return host, int(port) if colon else default_port


class BoardError(Exception):
    """A status of vista/board.h that is not VISTA_OK; the text is the library's."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class BoardClient:
    """The client of libvista (vista/board.h), call by call. BoardError for whatever fails."""

    def __init__(self, host: str, port: int, timeout_ms: int) -> None:
        self._ffi, self._lib = native.load("vista")
        memory = self._ffi.new("char[]", self._lib.vista_board_bytes())
        disconnect = self._lib.vista_board_disconnect
        handle = self._ffi.new("vista_board **")
        try:
            address = socket.gethostbyname(host)
        except OSError:
            address = host  # which the library refuses
        self._check(
            self._lib.vista_board_connect(memory, len(memory), address.encode(), port, timeout_ms, handle)
        )
        # The destructor holds the memory: what an object refers to is freed in any order.
        self._board = self._ffi.gc(handle[0], lambda board, memory=memory: disconnect(board))

    def close(self) -> None:
        """Lets go of the board; nothing else may be called afterwards."""
        self._ffi.release(self._board)

    def identify(self) -> Any:
        """vista_board_build."""
        build = self._ffi.new("vista_board_build *")
        self._check(self._lib.vista_board_identify(self._board, build))
        return build

    def configure(
        self,
        parameters: EngineParameters,
        width_px: int,
        height_px: int,
        grids: Iterable[Grid] = (),
        cameras: bool = False,
    ) -> None:
        """Begins a session. grids: of the left and the right camera, or none. cameras: the pairs are those of
        the board's own."""
        settings = settings_of(parameters) | {"width_px": width_px, "height_px": height_px}
        settings["cameras"] = int(cameras)
        maps = [self._ffi.from_buffer("int16_t[]", np.ascontiguousarray(grid)) for grid in grids]
        settings |= dict(zip(("left_map", "right_map"), maps, strict=False))
        self._check(
            self._lib.vista_board_configure(self._board, self._ffi.new("vista_board_settings *", settings))
        )

    def submit(self, left: Image, right: Image) -> None:
        pixels = [self._ffi.from_buffer("uint8_t[]", np.ascontiguousarray(image)) for image in (left, right)]
        self._check(self._lib.vista_board_submit(self._board, *pixels, left.shape[1]))

    def collect(self) -> Disparity:
        """The words of all levels, one after the other."""
        words = np.empty(self._lib.vista_board_words(self._board), np.int16)
        buffer = self._ffi.from_buffer("int16_t[]", words)
        self._check(self._lib.vista_board_collect(self._board, buffer, words.size))
        return words

    def start(self) -> None:
        """Lets the board take the pairs of its cameras."""
        self._check(self._lib.vista_board_start(self._board))

    def stop(self) -> None:
        self._check(self._lib.vista_board_stop(self._board))

    def receive(self) -> tuple[Any, Disparity]:
        """The next pair of the cameras (vista_board_pair), and the words of all its levels."""
        words = np.empty(self._lib.vista_board_words(self._board), np.int16)
        buffer = self._ffi.from_buffer("int16_t[]", words)
        pair = self._ffi.new("vista_board_pair *")
        self._check(self._lib.vista_board_receive(self._board, buffer, words.size, pair))
        return pair, words

    @property
    def counts(self) -> Any:
        """vista_board_counts."""
        return self._lib.vista_board_count(self._board)

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status, partial(BoardError, status))


class Board:
    """A BoardClient whose board was built for these parameters. grids: the map that raw images are rectified
    by.

    InputError, in one line, when nobody answers, or the board was built with other parameters.
    """

    _cameras = False  # the pairs are those of the board's own cameras

    def __init__(
        self,
        parameters: EngineParameters,
        address: str,
        grids: GridPair | None = None,
        timeout_ms: int = 1000 * DEFAULT_TIMEOUT_S,
    ) -> None:
        self.parameters = StereoEngine(**asdict(parameters)).parameters  # one judge of the contract's ranges
        _, self._lib = native.load("vista")
        host, port = parse_address(address, self._lib.VISTA_BOARD_PORT)
        self._culprit = f"board {host}:{port}"
        self._grids, self._timeout_ms = grids, timeout_ms
        self._size: tuple[int, int] | None = None  # of the session's pairs; None: no session
        with self._reported():
            self._client = BoardClient(host, port, timeout_ms)
            self._build = self._client.identify()
        self._check_build()

    def check_size(self, width_px: int, height_px: int) -> None:
        """Begins a session for frames of this size."""
        if self._size == (width_px, height_px):
            return
        most = self._build
        if width_px > most.max_width_px or width_px * height_px > most.max_pixels:
            raise ValueError(
                f"images are {width_px}x{height_px} px, the board takes {most.max_width_px} px in a row and "
                f"{most.max_pixels} in all"
            )
        self._configure(width_px, height_px)

    def _check_build(self) -> None:
        wanted, found = self.parameters, self._build
        if (found.num_disparities, found.block_size) != (wanted.num_disparities, wanted.block_size):
            raise InputError(
                self._culprit,
                f"was built for {found.num_disparities} disparities and blocks of {found.block_size} px, "
                f"stereo asks for {wanted.num_disparities} and {wanted.block_size}",
            )
        if self._cameras and not found.cameras:
            raise InputError(self._culprit, "was built without sensors of its own (make bitstream CAMERAS=1)")
        rows = self._grids.buffer_rows if self._grids else 0
        if rows > found.rectify_rows:
            raise InputError(
                self._culprit,
                f"was built with {found.rectify_rows} rows to rectify, stereo.rectify_rows asks for {rows}",
            )

    def _configure(self, width_px: int, height_px: int) -> None:
        grids = (self._grids.left, self._grids.right) if self._grids is not None else ()
        self._size = None
        with self._reported():
            self._client.configure(self.parameters, width_px, height_px, grids, self._cameras)
        self._size = (width_px, height_px)

    def _split(self, words: Disparity, shape: tuple[int, int]) -> list[Disparity]:
        return split_levels(words, level_shapes(shape, self.parameters.levels))

    @contextmanager
    def _reported(self, consequence: str = "") -> Iterator[None]:
        """What fails becomes an InputError."""
        try:
            yield
        except BoardError as error:
            lib = self._lib
            texts = {
                lib.VISTA_ERROR_ADDRESS: "the name has no address",
                lib.VISTA_ERROR_NO_ANSWER: f"no answer within {self._timeout_ms / 1000:g} s",
                lib.VISTA_ERROR_CAPACITY: "the map needs more rows than its line buffer has",
                lib.VISTA_ERROR_SIZE: "has no room for images or for a map of this size",
            }
            raise InputError(self._culprit, consequence + texts.get(error.status, str(error))) from None


class BoardEngine(Board):
    """The engine of a board, which the host sends pairs to.

    InputError, in one line, also when a frame is lost. A board that was restarted in between is set up again,
    and the frame is sent once more.
    """

    def load_map(self, grids: GridPair) -> None:
        """Rectifies by another map of the same size from now on; the board begins another session for it."""
        self._grids = grids
        if self._size is not None:
            self._configure(*self._size)

    def compute(self, left: Image, right: Image) -> Disparity:
        """The words of level 0."""
        return next(self.levels(left, right))

    def levels(self, left: Image, right: Image) -> Iterator[Disparity]:
        """The words of one level after the other, level 0 first; each in 1/16 px of its own pixels."""
        check_images(left, right)
        height, width = left.shape
        self.check_size(width, height)
        with self._reported("the frame is lost: "):
            try:
                words = self._frame(left, right)
            except BoardError as error:
                if error.status != self._lib.VISTA_ERROR_SESSION:
                    raise
                self._configure(width, height)
                words = self._frame(left, right)
        return iter(self._split(words, (height, width)))

    def _frame(self, left: Image, right: Image) -> Disparity:
        self._client.submit(left, right)
        return self._client.collect()


@dataclass(frozen=True)
class CameraPair:
    """What a board made of a pair of its cameras."""

    number: int  # in the session, those that were lost included
    t_ns: int  # when it began, on the board's clock
    came_ns: int  # the same moment on this machine's time.monotonic_ns()
    levels: tuple[Disparity, ...]  # words


class BoardCameras(Board):
    """The cameras of a board, whose words alone come."""

    _cameras = True

    def begin(self, width_px: int, height_px: int) -> None:
        """Begins a session in which the board takes pairs of this size, from the next one on."""
        self._size = None
        self.check_size(width_px, height_px)
        with self._reported():
            self._client.start()

    def receive(self) -> CameraPair | None:
        """The next pair; None: none came in time, or none that was whole. InputError: the board is silent, or
        has another session, as after it was restarted."""
        assert self._size is not None
        width, height = self._size
        with self._reported():
            try:
                pair, words = self._client.receive()
            except BoardError as error:
                if error.status != self._lib.VISTA_ERROR_FRAME:
                    raise
                return None
        levels = tuple(self._split(words, (height, width)))
        return CameraPair(int(pair.number), int(pair.t_ns), int(pair.came_ns), levels)

    @property
    def lost(self) -> int:
        """Pairs that were not received, and frames that found no partner."""
        counts = self._client.counts
        return int(counts.lost + counts.refused_left + counts.refused_right)

    def close(self) -> None:
        """Lets go of the board."""
        self._client.close()
