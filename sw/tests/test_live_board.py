"""The sensors of a board as a source of `vista live`, against a board in software."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from threading import Event, Timer

import numpy as np
import pytest
from board_engine import Build, EngineModel
from board_model import BoardModel, Link, running
from board_words import WordsAlone, chain_of, shown_pairs, written
from command_line import Vista, assert_refused, call, without_time
from fly_process import fly, start
from live_process import until
from random_seed import seeded
from vista.chain import finish, take
from vista.cli import main
from vista.health.finding import Reason
from vista.history import StageClock
from vista.live import board as live_board
from vista.live.board import BoardSource
from vista.live.source import Shot
from vista.obstacle_line import obstacle_line

pytestmark = pytest.mark.slow


@pytest.fixture
def board(monkeypatch: pytest.MonkeyPatch) -> Iterator[BoardModel]:
    monkeypatch.setattr(live_board, "REOPEN_S", 0.02)
    rng = seeded(2500)
    with running(BoardModel(EngineModel(), Link(rng), Link(rng))) as model:
        yield model


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    return written(tmp_path)


def name_of(board: BoardModel) -> str:
    return f"board:127.0.0.1:{board.port}"


def pixels_of(pair: tuple[np.ndarray, np.ndarray]) -> bytes:
    return np.stack(pair, -1).tobytes()


def test_words_become_the_lines_of_the_c_model(board: BoardModel, files: tuple[Path, Path]) -> None:
    """The lines are those of the words of the C model at the times of the board. Pair 2 has no room there,
    and is a gap in the numbers."""
    pairs, expected, chain = shown_pairs(5), WordsAlone(*files), chain_of(*files)
    source, stopped, numbers = BoardSource(name_of(board), chain), Event(), []
    board.shown = [pixels_of(pairs[0])]
    for shot in source.shots(stopped):
        number = shot.frame.index
        assert shot.frame.t_ns == 1000 * board.began_us[number] and shot.continues
        assert 0 <= shot.exposed_ns - board.began_ns[number] < 1_000_000_000
        take(chain, shot.frame)
        step = finish(chain, shot.frame, StageClock()).keep()
        record = step.record
        assert not step.frame.left.any() and not step.frame.right.any()
        line = without_time(obstacle_line(record))
        assert line == expected.line(pairs[number], number, shot.frame.t_ns)
        assert {Reason.IMAGE_MISSING, Reason.MOTION_UNKNOWN} <= set(record.health.reasons)
        numbers.append(number)
        board.next_pair += number == 1
        if number == 4:
            stopped.set()
        else:
            board.shown = [pixels_of(pairs[board.next_pair])]
    source.close()
    assert numbers == [0, 1, 3, 4] and source.skipped == 1
    assert record.obstacles and record.valid_fraction > 0.5


def taken(source: BoardSource, board: BoardModel, count: int) -> list[Shot]:
    stopped, shots = Event(), []
    for shot in source.shots(stopped):
        shots.append(shot)
        if len(shots) == count:
            stopped.set()
    return shots


def test_a_board_that_was_restarted_is_set_up_again(
    board: BoardModel, files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    """What came before was another flight, since the numbers and the clock begin anew."""
    source = BoardSource(name_of(board), chain_of(*files))
    pixels = pixels_of(shown_pairs(1)[0])
    board.shown = [pixels]
    (before,) = taken(source, board, 1)
    board.restart()
    board.shown = [pixels, pixels]
    first, second = taken(source, board, 2)
    source.close()
    assert [shot.continues for shot in (before, first, second)] == [True, False, True]
    assert [shot.frame.index for shot in (before, first, second)] == [0, 0, 1]
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2 and "set it up again" in said[0] and said[1].endswith(": back")


def test_sensors_that_show_nothing_are_told_of(
    board: BoardModel, files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    source = BoardSource(name_of(board), chain_of(*files), timeout_s=0.2)
    later = Timer(0.5, lambda: board.shown.append(pixels_of(shown_pairs(1)[0])))
    later.start()
    (shot,) = taken(source, board, 1)
    source.close()
    assert shot.frame.index == 0 and shot.continues
    assert capsys.readouterr().err.splitlines() == [
        f"vista: {name_of(board)}: answers, but no pair of its sensors comes"
    ]


def test_what_cannot_be_received_takes_one_line(
    board: BoardModel, files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    calibration, config = files
    vista: Vista = partial(call, capsys)
    name, size = name_of(board), ("--size-px", "160x120")
    silent = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    silent.bind(("127.0.0.1", 0))

    def refused(text: str, *options: object, device: str = name, config: Path = config) -> None:
        camera = ("--camera", device, "--calibration", calibration, "--config", config, "--no-page")
        assert_refused(vista("live", *camera, *options), text)

    refused(
        "no answer within 1 s",
        *size,
        "--board-timeout",
        1,
        device=f"board:127.0.0.1:{silent.getsockname()[1]}",
    )
    refused("is not HOST or HOST:PORT", *size, device="board:")
    refused("--size-px: is needed")
    refused("has both sensors by itself", *size, "--camera", name, "1")
    for option in (("--threads", 2), ("--engine", "opencv"), ("--pair-tolerance-ms", 3)):
        refused(f"{option[0]}: {name} pairs and matches by itself", *size, *option)
    other = config.with_name("other.toml")
    other.write_text(config.read_text().replace("rectify_rows = 16", "rectify_rows = 0"))
    refused("stereo.rectify_rows: is 0", *size, config=other)
    other.write_text(config.read_text().replace("num_disparities = 16", "num_disparities = 32"))
    refused("was built for 16 disparities", *size, config=other)
    board.engine.build = Build(max_width=120)
    refused("the board takes 120 px in a row", *size)
    board.cameras = 0
    refused("was built without sensors", *size)
    recorded = ("record", "--camera", name, "--calibration", calibration, "--out", config.with_name("out"))
    assert_refused(vista(*recorded), "gives words and no images")
    silent.close()


# ---- vista-fly ----


def prepared(calibration: Path, config: Path, name: str) -> Path:
    """The rig for vista-fly."""
    folder = calibration.with_name(name)
    described = ["--calibration", calibration, "--size-px", "160x120", "--config", config, "--out", folder]
    assert main(["prepare", *map(str, described)]) == 0
    return folder / "rig.vista"


def test_vista_fly_writes_the_same_lines(board: BoardModel, files: tuple[Path, Path]) -> None:
    """Pair 1 has no room, and before the last one the board is restarted."""
    pairs, expected, rig = shown_pairs(3), WordsAlone(*files), prepared(*files, "rig")
    file, lines = rig.with_name("lines.jsonl"), []
    program = start("--rig", rig, "--board", f"127.0.0.1:{board.port}", "--out", file)
    until(lambda: board.streams)
    for k, pair in enumerate(pairs):
        if k == 2:
            board.restart()
        board.next_pair += k == 1
        number = board.next_pair
        board.shown = [pixels_of(pair)]
        until(lambda: file.exists() and file.read_text().count("\n") > len(lines))
        lines.append(expected.line(pair, number, 1000 * board.began_us[number], restarts=k == 2))
    program.send_signal(signal.SIGTERM)
    said = program.communicate(timeout=30)[1]
    assert program.returncode == 130
    assert [without_time(line) for line in file.read_text().splitlines()] == lines
    assert "3 frames processed, 1 dropped" in said
    assert "trying to set it up again" in said and ": back" in said


def test_vista_fly_refuses_in_one_line(board: BoardModel, files: tuple[Path, Path]) -> None:
    calibration, config = files
    exact = config.with_name("exact.toml")
    exact.write_text(config.read_text().replace("rectify_rows = 16", "rectify_rows = 0"))
    rigs = prepared(calibration, config, "rig"), prepared(calibration, exact, "exact")

    def refused(text: str, address: str = f"127.0.0.1:{board.port}", rig: Path = rigs[0]) -> None:
        run = fly("--rig", rig, "--board", address, "--watchdog", 0.6)
        assert (run.returncode, run.stdout) == (2, "")
        assert run.stderr.splitlines()[-1].startswith("vista-fly: ") and text in run.stderr.splitlines()[-1]

    for address in ("127.0.0.1:x", ":1", "127.0.0.1:65536"):
        refused("is not ADDRESS or ADDRESS:PORT", address)
    refused("the host is not an IPv4 address", "board.example:1")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as silent:
        silent.bind(("127.0.0.1", 0))
        refused("the board does not answer", f"127.0.0.1:{silent.getsockname()[1]}")
    refused("stereo.rectify_rows of the rig is 0", rig=rigs[1])
    board.engine.build = Build(num_disparities=32)
    refused("was built for 32 disparities and blocks of 5 px, the rig for 16 and 5")
    board.cameras = 0
    refused("was built without sensors of its own")
