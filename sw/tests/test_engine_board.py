"""`--engine board`: a board gives the C model's words, and so the same obstacles; what goes wrong is told."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import sequence_cases as cases
from board_engine import Build, EngineModel
from board_model import BoardModel, Link, running
from command_line import Vista, assert_refused, lines_without_times
from random_seed import seeded
from vista.engine import BoardEngine, EngineParameters, StereoEngine
from vista.errors import InputError

pytestmark = pytest.mark.slow

CONFIG = "[stereo]\nnum_disparities = 16\nblock_size = 5\n"
FRONT_END = 'smooth = "binomial3"\nlevels = 3\nrectify_rows = 16\n'


def make_board(build: Build | None = None, loss: float = 0.01) -> BoardModel:
    rng = seeded(2300) if loss else np.random.default_rng()  # which draws nothing then; seeded() prints
    return BoardModel(EngineModel(build or Build()), Link(rng, loss, loss), Link(rng, loss, loss))


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "c.toml"
    path.write_text(CONFIG)
    return path


@pytest.mark.parametrize("front_end", [False, True])
def test_run_gives_the_same_obstacles(
    tmp_path: Path, run_vista: Vista, config: Path, front_end: bool
) -> None:
    """The link loses and doubles packets; with the front end the board takes raw images."""
    folder = cases.make_board_scenes(tmp_path / "pairs", 4, stills=False)
    if front_end:
        folder = cases.make_raw(folder)
        config.write_text(CONFIG + FRONT_END)
    options = ["--config", config, "--no-overlay"]
    assert run_vista("run", folder, "--out", tmp_path / "golden", *options)[0] == 0
    with running(make_board()) as board:
        options += ["--engine", "board", "--address", f"127.0.0.1:{board.port}"]
        assert run_vista("run", folder, "--out", tmp_path / "board", *options)[0] == 0
    lines = lines_without_times(tmp_path / "board")
    assert lines == lines_without_times(tmp_path / "golden")
    assert any(obstacle["confirmed"] for obstacle in json.loads(lines[-1])["obstacles"])
    assert json.loads((tmp_path / "board" / "summary.json").read_text())["engine"] == "board"


@pytest.mark.parametrize(
    ("build", "parameters", "text"),
    [
        (Build(32, 5), "", "was built for 32 disparities and blocks of 5 px, stereo asks for 16 and 5"),
        (Build(16, 7), "", "was built for 16 disparities and blocks of 7 px, stereo asks for 16 and 5"),
        (Build(max_width=300), "", "images are 320x240 px, the board takes 300 px in a row"),
        (
            Build(),
            FRONT_END.replace("16", "64"),
            "was built with 16 rows to rectify, stereo.rectify_rows asks for 64",
        ),
        (Build(map_points=100), FRONT_END, "has no room for images or for a map of this size"),
    ],
)
def test_a_wrong_build(
    tmp_path: Path, run_vista: Vista, config: Path, build: Build, parameters: str, text: str
) -> None:
    folder = cases.make_raw(cases.make_board_scenes(tmp_path / "pairs", 1, stills=False))
    config.write_text(CONFIG + parameters)
    with running(make_board(build, loss=0.0)) as board:
        options = ["--config", config, "--engine", "board", "--address", f"127.0.0.1:{board.port}"]
        assert_refused(run_vista("run", folder, "--out", tmp_path / "out", *options), text)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--engine", "board"], "--address: goes with --engine board"),
        (["--address", "127.0.0.1"], "--address: goes with --engine board"),
        (["--engine", "board", "--address", "127.0.0.1:0"], "'127.0.0.1:0' is not HOST or HOST:PORT"),
        (["--engine", "board", "--address", ":1"], "':1' is not HOST or HOST:PORT"),
        (
            ["--engine", "board", "--address", "no such host"],
            "board no such host:22099: the name has no address",
        ),
    ],
)
def test_bad_addresses(tmp_path: Path, run_vista: Vista, options: list[str], text: str) -> None:
    folder = cases.make_board_scenes(tmp_path / "pairs", 1, stills=False)
    assert_refused(run_vista("run", folder, "--out", tmp_path / "out", *options), text)
    assert not (tmp_path / "out").exists()


def test_nobody_answers() -> None:
    board = make_board(loss=0.0)
    address = f"127.0.0.1:{board.port}"  # bound, and nobody reads it
    with pytest.raises(InputError, match=rf"board {address}: no answer within 0\.2 s"):
        BoardEngine(EngineParameters(16, 5), address, timeout_ms=200)
    board.socket.close()


def random_pair() -> tuple[np.ndarray, np.ndarray]:
    scene = seeded(2310).integers(0, 256, (50, 128), np.uint8)
    return scene[:, :120], scene[:, 8:]


def test_a_lost_frame_is_named_and_the_next_is_right() -> None:
    left, right = random_pair()
    with running(make_board(loss=0.0)) as board:
        engine = BoardEngine(EngineParameters(16, 5), f"127.0.0.1:{board.port}", timeout_ms=1500)
        wanted = StereoEngine(16, 5).compute(left, right)
        np.testing.assert_array_equal(engine.compute(left, right), wanted)
        board.to_host.pulled = True
        with pytest.raises(InputError, match=r"the frame is lost: no answer within 1\.5 s"):
            engine.compute(left, right)
        board.to_host.pulled = False
        np.testing.assert_array_equal(engine.compute(left, right), wanted)


def test_a_board_that_was_restarted_is_set_up_again() -> None:
    left, right = random_pair()
    with running(make_board()) as board:
        engine = BoardEngine(EngineParameters(16, 5, levels=2), f"127.0.0.1:{board.port}")
        golden = StereoEngine(16, 5, levels=2)
        for _ in range(2):
            for found, wanted in zip(engine.levels(left, right), golden.levels(left, right), strict=True):
                np.testing.assert_array_equal(found, wanted)
            board.restart()
