"""The client of a board against a board in software, over a link that drops and doubles packets."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import wire
from board_client import (
    SETTINGS,
    TIMEOUT_MS,
    BoardError,
    Client,
    Settings,
    ffi,
    golden,
    lib,
    random_pair,
    random_settings,
)
from board_engine import Build, EngineModel, narrow, sent
from board_model import BoardModel, Link, running
from random_seed import seeded

pytestmark = pytest.mark.slow


ROUND_S = 0.25  # until the counter of the board's time goes round


@contextmanager
def connected(board: BoardModel, timeout_ms: int = TIMEOUT_MS) -> Iterator[Client]:
    with running(board):
        client = Client(board.port, timeout_ms)
        try:
            yield client
        finally:
            lib.vista_board_disconnect(client.board)


def make_board(
    rng: np.random.Generator, loss: float = 0.0, build: Build | None = None, credits: int = 16
) -> BoardModel:
    links = (Link(rng, loss, loss), Link(rng, loss, loss))
    return BoardModel(EngineModel(build or Build()), *links, credits=credits)


@pytest.mark.parametrize("loss", [0.0, 0.1])
def test_pairs_of_the_cameras_are_right_or_reported(loss: float) -> None:
    """The link loses and doubles requests and replies; pairs without room are lost, some frames refused."""
    rng = seeded(2290)
    settings = SETTINGS | {"width_px": 60, "height_px": 20, "levels": 2, "cameras": 1}
    board = make_board(rng, loss)
    board.refused = 65534  # before the session; the counter goes round in it, and so does that of the time
    with connected(board) as client:
        client.configure(settings)
        client.start()
        pairs = [random_pair(rng, settings) for _ in range(20)]
        pixels = [np.stack(pair, -1).tobytes() for pair in pairs]
        board.reset_ns = time.monotonic_ns() - 1000 * (1 << 32) + int(1e9 * ROUND_S)
        board.shown = [one for i in range(20) for one in ([b""] * (i % 5 == 0) + [pixels[i]])]
        numbers, offsets = [], []
        while board.shown or any(slot.state >= wire.STATES["running"] for slot in board.slots):
            pair, words = client.receive()
            numbers.append(pair.number)
            np.testing.assert_array_equal(words, golden(settings, *pairs[pair.number]))
            began_ns = board.began_ns[pair.number]
            assert 0 <= pair.came_ns - began_ns < 1_000_000_000
            offsets.append(pair.t_ns - began_ns)
            if len(numbers) == 2:
                time.sleep(ROUND_S)
        client.stop()
        assert numbers == sorted(set(numbers)) and len(numbers) > 5
        assert (
            max(offsets) - min(offsets) <= 2000 and board.began_us[numbers[0]] > board.began_us[numbers[-1]]
        )
        assert (client.counts.frames, client.counts.lost) == (len(numbers), numbers[-1] + 1 - len(numbers))
        assert client.counts.refused_left == 4 and client.counts.refused_right == 0
        with pytest.raises(BoardError, match="ERROR_ORDER"):
            client.submit(*pairs[0])


def test_cameras_that_show_nothing_are_no_frame() -> None:
    board = make_board(seeded(2291))
    with connected(board, timeout_ms=300) as client:
        client.configure(SETTINGS)
        with pytest.raises(BoardError, match="ERROR_ORDER"):
            client.start()
        client.configure(SETTINGS | {"cameras": 1})
        client.start()
        with pytest.raises(BoardError, match="ERROR_FRAME"):
            client.receive()


@pytest.mark.parametrize("loss", [0.0, 0.01, 0.2])
@pytest.mark.parametrize("index", [0, *(pytest.param(k, marks=pytest.mark.same_c) for k in (1, 2)), 3])
def test_words_are_the_golden_ones(index: int, loss: float) -> None:
    """Every frame is answered, whatever the link loses, doubles and delays; settings and maps change."""
    rng = seeded(2200 + index)
    board = make_board(rng, loss, credits=int(rng.choice([1, 2, 5, 16])))
    frames = 2 if loss == 0.2 else 5  # of each setting; what is lost is waited for
    with connected(board) as client:
        for _ in range(3):
            settings = random_settings(rng)
            client.configure(settings)
            waiting: list[np.ndarray] = []
            for _ in range(frames):
                pair = random_pair(rng, settings, int(rng.integers(0, 300)))
                client.submit(*pair)
                waiting.append(golden(settings, *pair))
                if len(waiting) == lib.VISTA_BOARD_FRAMES or rng.random() < 0.5:
                    np.testing.assert_array_equal(client.collect(), waiting.pop(0))
            for words in waiting:
                np.testing.assert_array_equal(client.collect(), words)
        assert (client.counts.frames, client.counts.lost) == (3 * frames, 0)
        if loss == 0.2:
            assert client.counts.retries > 0
    assert board.overruns == 0


def test_a_large_frame_over_a_link_that_loses() -> None:
    """VGA with three levels: lost chunks, and no others, are sent again."""
    rng = seeded(2210)
    settings = SETTINGS | {"width_px": 640, "height_px": 480, "levels": 3, "smooth": 1}
    board = make_board(rng, 0.01)
    with connected(board) as client:
        client.configure(settings)
        for _ in range(3):
            pair = random_pair(rng, settings)
            client.submit(*pair)
            np.testing.assert_array_equal(client.collect(), golden(settings, *pair))
        counts = client.counts
        assert 3 * 600 < counts.chunks_sent < 3 * 600 * 1.1
        assert counts.chunks_received < 3 * 788 * 1.1
    assert board.overruns == 0


def test_no_write_is_made_twice() -> None:
    """Each control point is a write to one register: one too many would shift those after it."""
    rng = seeded(2220)
    board = make_board(rng, 0.2)
    settings = SETTINGS | {"width_px": 300, "height_px": 200}
    for side in ("left_map", "right_map"):
        settings[side] = rng.integers(-60, 61, (14, 20, 2)).astype(np.int16)
    with connected(board) as client:
        client.configure(settings)
        pair = random_pair(rng, settings)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(settings, *pair))
    assert board.engine.points_written == 2 * 14 * 20


def test_service_resumes_after_the_cable_was_pulled() -> None:
    """It is out in the middle of a frame, longer than the client waits: then the next frame is answered."""
    rng = seeded(2230)
    board = make_board(rng)
    with connected(board, timeout_ms=700) as client:
        client.configure(SETTINGS)
        first, second, third = (random_pair(rng, SETTINGS) for _ in range(3))
        client.submit(*first)
        board.to_board.pulled = board.to_host.pulled = True
        with pytest.raises(BoardError, match="NO_ANSWER"):
            client.submit(*second)
        with pytest.raises(BoardError, match="NO_ANSWER"):
            client.collect()
        board.to_board.pulled = board.to_host.pulled = False
        client.submit(*third)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *third))
        assert (client.counts.frames, client.counts.lost) == (1, 2)


def test_a_short_break_costs_no_frame() -> None:
    rng = seeded(2231)
    board = make_board(rng)
    with connected(board) as client:
        client.configure(SETTINGS)
        pair = random_pair(rng, SETTINGS)
        board.to_board.pulled = board.to_host.pulled = True
        plug = threading.Timer(
            0.3, lambda: [setattr(link, "pulled", False) for link in (board.to_board, board.to_host)]
        )
        plug.start()
        client.submit(*pair)
        plug.join()
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))
        assert client.counts.lost == 0


def test_half_a_frame_is_never_matched_with_half_of_the_next() -> None:
    """The pixels of a frame that was given up are dropped, even if the rest of them comes later."""
    rng = seeded(2232)
    board = make_board(rng)
    settings = SETTINGS | {"width_px": 300, "height_px": 60}
    with connected(board, timeout_ms=700) as client:
        client.configure(settings)
        first, second = random_pair(rng, settings), random_pair(rng, settings)
        board.to_board.pulled_after = board.to_board.packets + 10
        with pytest.raises(BoardError, match="NO_ANSWER"):
            client.submit(*first)
        assert 0 < len(board.slots[0].chunks) < board.opened["chunks_in"]
        board.to_board.pulled = False
        client.submit(*second)
        np.testing.assert_array_equal(client.collect(), golden(settings, *second))


def test_a_restarted_board_says_so() -> None:
    rng = seeded(2240)
    board = make_board(rng)
    with connected(board) as client:
        client.configure(SETTINGS)
        pair = random_pair(rng, SETTINGS)
        client.submit(*pair)
        board.restart()
        with pytest.raises(BoardError, match="SESSION"):
            client.collect()
        with pytest.raises(BoardError, match="SESSION"):
            client.submit(*pair)
        client.configure(SETTINGS)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def test_a_second_client_is_refused_while_the_first_holds_the_board() -> None:
    """It costs the first one no frame. The board is free once its holder ends or has been silent."""
    rng = seeded(2241)
    board = make_board(rng)
    pair = random_pair(rng, SETTINGS)
    with connected(board) as first:
        second, third = Client(board.port), Client(board.port)
        first.configure(SETTINGS)
        first.submit(*pair)
        with pytest.raises(BoardError, match="ERROR_HELD"):
            second.configure(SETTINGS | {"levels": 2})
        np.testing.assert_array_equal(first.collect(), golden(SETTINGS, *pair))
        first.configure(SETTINGS)  # its own session may be another at any time
        first.submit(*pair)
        board.hold_s = 0.0
        second.configure(SETTINGS | {"levels": 2})
        board.hold_s = 1000.0
        with pytest.raises(BoardError, match="SESSION"):
            first.collect()
        with pytest.raises(BoardError, match="ERROR_HELD"):
            first.configure(SETTINGS)
        second.submit(*pair)
        np.testing.assert_array_equal(second.collect(), golden(SETTINGS | {"levels": 2}, *pair))
        lib.vista_board_disconnect(second.board)
        third.configure(SETTINGS)
        lib.vista_board_disconnect(third.board)


def test_a_chunk_with_the_words_of_another_is_fetched_again() -> None:
    rng = seeded(2244)
    board = make_board(rng)
    pair = random_pair(rng, SETTINGS)
    with connected(board, timeout_ms=300) as client:
        client.configure(SETTINGS)
        client.submit(*pair)
        board.mixed_up = 3
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))
        assert client.counts.chunks_wrong == 3
        client.submit(*pair)
        board.mixed_up = 1 << 30
        with pytest.raises(BoardError, match="ERROR_FRAME"):
            client.collect()
        board.mixed_up = 0
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def test_a_frame_that_the_engine_does_not_finish_is_lost() -> None:
    rng = seeded(2242)
    board = make_board(rng)
    with connected(board) as client:
        client.configure(SETTINGS)
        board.fails = True
        pair = random_pair(rng, SETTINGS)
        client.submit(*pair)
        with pytest.raises(BoardError, match="ERROR_FRAME"):
            client.collect()
        board.fails = False
        for _ in range(3):
            client.submit(*pair)
            np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def test_the_client_waits_for_a_slow_engine() -> None:
    rng = seeded(2243)
    board = make_board(rng)
    board.matching_s = 0.2
    with connected(board, timeout_ms=2000) as client:
        client.configure(SETTINGS)
        pairs = [random_pair(rng, SETTINGS) for _ in range(2)]
        for pair in pairs:
            client.submit(*pair)
        with pytest.raises(BoardError, match="CAPACITY"):
            client.submit(*pairs[0])
        for pair in pairs:
            np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))
        with pytest.raises(BoardError, match="ORDER"):
            client.collect()
        board.matching_s = 60.0
        client.submit(*pairs[0])
        with pytest.raises(BoardError, match="ERROR_FRAME"):
            client.collect()


def test_the_build_is_what_the_registers_say() -> None:
    board = make_board(seeded(2250), build=Build(48, 9, 320, 200, 32, 500))
    with connected(board) as client:
        build = client.build()
        found = (build.num_disparities, build.block_size, build.max_width_px, build.max_height_px)
        assert found == (48, 9, 320, 200)
        assert (build.version_major, build.version_minor) == (2, 1)
        assert (build.rectify_rows, build.map_points, build.max_pixels) == (32, 500, 1024 * 512)


def grid(width_px: int, height_px: int, dy: int = 0) -> np.ndarray:
    offsets = np.zeros((-(-height_px // 16) + 1, -(-width_px // 16) + 1, 2), np.int16)
    offsets[..., 1] = dy
    return offsets


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"width_px": 641}, "SIZE"), ({"width_px": 3}, "SIZE"), ({"height_px": 1}, "SIZE"),
        ({"width_px": 640, "height_px": 820}, "SIZE"), ({"levels": 0}, "RANGE"), ({"levels": 5}, "RANGE"),
        ({"prefilter_cap": 0}, "RANGE"), ({"prefilter_cap": 64}, "RANGE"),
        ({"uniqueness_ratio": 101}, "RANGE"),
        ({"texture_threshold": -1}, "RANGE"), ({"lr_max_diff": -2}, "RANGE"), ({"smooth": 2}, "RANGE"),
        ({"xsobel": -1}, "RANGE"),
        ({"left_map": grid(90, 41)}, "ARGUMENT"),
        ({"left_map": grid(90, 41), "right_map": grid(90, 41, 32 * 7)}, "CAPACITY"),
        ({"width_px": 640, "height_px": 800,
          "left_map": grid(640, 800), "right_map": grid(640, 800)}, "SIZE"),
    ],
)  # fmt: skip
def test_settings_that_do_not_fit_are_refused(changes: Settings, status: str) -> None:
    """They have a status of their own, and open no session."""
    board = make_board(seeded(2251))
    with connected(board) as client:
        with pytest.raises(BoardError, match=status):
            client.configure(SETTINGS | changes)
        assert lib.vista_board_words(client.board) == 0
        pair = random_pair(seeded(2252), SETTINGS)
        with pytest.raises(BoardError, match="SESSION"):
            client.submit(*pair)


def test_what_is_no_board_is_told() -> None:
    board = make_board(seeded(2253))
    with connected(board) as client:
        board.engine.magic = 0
        with pytest.raises(BoardError, match="ERROR_BOARD"):
            client.configure(SETTINGS)
    silent = make_board(seeded(2254))
    with pytest.raises(BoardError, match="NO_ANSWER"):
        Client(silent.port, timeout_ms=100)
    silent.socket.close()
    with pytest.raises(BoardError, match="NO_ANSWER"):
        Client(silent.port, timeout_ms=100)
    newer = make_board(seeded(2255))
    newer.version = wire.CONSTANTS["VERSION"] + 1
    with running(newer), pytest.raises(BoardError, match="ERROR_BOARD"):
        Client(newer.port)


def test_arguments_are_checked() -> None:
    memory, board = ffi.new("char[]", lib.vista_board_bytes()), ffi.new("vista_board **")
    size = len(memory)
    connect = lib.vista_board_connect
    assert connect(memory, 100, b"127.0.0.1", 1, 10, board) == lib.VISTA_ERROR_MEMORY
    assert connect(memory, size, b"127.0.0.1", 0, 10, board) == lib.VISTA_ERROR_RANGE
    assert connect(memory, size, b"127.0.0.1", 65536, 10, board) == lib.VISTA_ERROR_RANGE
    assert connect(memory, size, b"127.0.0.1", 1, 0, board) == lib.VISTA_ERROR_RANGE
    assert connect(memory, size, b"not a host", 1, 10, board) == lib.VISTA_ERROR_ADDRESS
    assert connect(memory, size, ffi.NULL, 1, 10, board) == lib.VISTA_ERROR_ARGUMENT
    assert lib.vista_board_identify(ffi.NULL, ffi.NULL) == lib.VISTA_ERROR_ARGUMENT
    assert lib.vista_board_words(ffi.NULL) == 0
    lib.vista_board_disconnect(ffi.NULL)
    with connected(make_board(seeded(2256))) as client:
        client.configure(SETTINGS)
        pair = random_pair(seeded(2257), SETTINGS)
        pixels = ffi.cast("uint8_t *", pair[0].ctypes.data)
        assert lib.vista_board_submit(client.board, pixels, pixels, 89) == lib.VISTA_ERROR_SIZE
        client.submit(*pair)
        words = ffi.new("int16_t[]", 90 * 41)
        assert lib.vista_board_collect(client.board, words, 90 * 41 - 1) == lib.VISTA_ERROR_MEMORY
        assert lib.vista_board_collect(client.board, words, 90 * 41) == lib.VISTA_OK


def test_what_is_no_answer_is_passed_over() -> None:
    """Random bytes, cut packets and answers to nobody, among the answers: the words stay right."""
    rng = seeded(2260)
    board = make_board(rng)
    board.to_host = Noise(rng)
    with connected(board) as client:
        client.configure(SETTINGS)
        for _ in range(3):
            pair = random_pair(rng, SETTINGS)
            client.submit(*pair)
            np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def test_a_stream_of_what_is_no_answer_holds_nobody_up() -> None:
    stopped = threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as flood:
        flood.bind(("127.0.0.1", 0))
        flood.settimeout(10.0)

        def send() -> None:
            _, client = flood.recvfrom(2000)
            while not stopped.is_set():
                flood.sendto(b"this is no packet of a board", client)

        thread = threading.Thread(target=send)
        thread.start()
        threading.Timer(10.0, stopped.set).start()
        began_s = time.monotonic()
        with pytest.raises(BoardError, match="NO_ANSWER"):
            Client(flood.getsockname()[1], timeout_ms=100)
        took_s = time.monotonic() - began_s
        stopped.set()
        thread.join()
    assert took_s < 5.0


class Noise(Link):
    def carry(self, packet: bytes) -> list[bytes]:
        header, body = wire.parse(packet)
        junk = [
            self.rng.bytes(int(self.rng.integers(0, 1200))),
            packet[: int(self.rng.integers(0, len(packet)))],
            wire.packet(header | {"token": header["token"] + 1000 & 0xFFFFFFFF}, body[::-1]),
            wire.packet(header | {"kind": int(self.rng.integers(0x87, 256))}, body[::-1]),
        ]
        self.rng.shuffle(junk)
        return [*junk[:2], packet, *junk[2:]]


def test_the_stream_is_narrow_and_without_small_levels() -> None:
    """The model says it: what the engine sends for 7x5 px with four levels is levels 0 and 1."""
    levels = [np.full(shape, k, np.int16) for k, shape in enumerate([(5, 7), (3, 4), (2, 2), (1, 1)])]
    assert [words.shape for words in sent(levels)] == [(5, 7), (3, 4)]
    assert len(narrow(levels[0])) == 4 * 4 * 5
