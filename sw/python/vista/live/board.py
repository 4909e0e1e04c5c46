"""The sensors of a board as a source of a live run: the words of their pairs come, and no images."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event, Lock

import numpy as np

from vista.chain import Chain
from vista.engine.board import DEFAULT_TIMEOUT_S, BoardCameras, CameraPair
from vista.errors import InputError
from vista.live.camera import REOPEN_S, tell
from vista.live.source import Shot
from vista.sequence import Frame

PREFIX = "board:"  # of the name on the command line
CLOSE_S = 2.0  # that a reading may go on when the run is over


def is_board(name: str) -> bool:
    """Tells whether a device's name on the command line is board:HOST[:PORT]."""
    return name.startswith(PREFIX)


class BoardSource:
    """A source of a live run. A board that is lost, or was restarted, is set up again until it answers."""

    def __init__(self, name: str, chain: Chain, timeout_s: float = DEFAULT_TIMEOUT_S) -> None:
        """name: board:HOST[:PORT]; timeout_s: how long the board may be silent. InputError when it does not
        answer, has no sensors or was built for other parameters, and where its pairs would not be
        rectified."""
        self.skipped = 0
        self._name, self._rectifier = name, chain.rectifier
        if self._rectifier.grids is None and not self._rectifier.is_passthrough:
            raise InputError(
                "stereo.rectify_rows",
                f"is 0, and the calibration is not of rectified images: {name} has to rectify those of its "
                "sensors",
            )
        camera = self._rectifier.calibration
        self._size = camera.width, camera.height
        self._dark = np.zeros(self._size[::-1], np.uint8)
        self._using = Lock()  # of the board: one thread at a time
        address, parameters = name.removeprefix(PREFIX), chain.engine.parameters
        try:
            self._board = BoardCameras(parameters, address, self._rectifier.grids, int(1000 * timeout_s))
            self._board.begin(*self._size)
        except ValueError as error:
            raise InputError(name, str(error)) from None

    def shots(self, stopped: Event) -> Iterator[Shot]:
        """A pair is missing where its number is; the numbers begin anew with a session."""
        continues, quiet = True, False
        while not stopped.is_set():
            try:
                with self._using:
                    pair = self._board.receive()
                    self.skipped = self._board.lost
            except InputError as error:
                tell(str(error), "trying to set it up again")
                if not self._set_up_again(stopped):
                    return
                continues = False
                continue
            if pair is None and not quiet and not stopped.is_set():
                tell(self._name, "answers, but no pair of its sensors comes")
            quiet = pair is None
            if pair is not None:
                yield Shot(self._frame(pair), pair.came_ns, continues)
                continues = True

    def close(self) -> None:
        if self._using.acquire(timeout=CLOSE_S):  # else it goes with the process
            self._board.close()

    def _frame(self, pair: CameraPair) -> Frame:
        return Frame(pair.number, pair.t_ns, self._dark, self._dark, None, pair.levels)

    def _set_up_again(self, stopped: Event) -> bool:
        """False: the run is over."""
        while not stopped.wait(REOPEN_S):
            try:
                with self._using:
                    self._board.begin(*self._size)
            except InputError:
                continue
            tell(self._name, "back")
            return True
        return False
