"""The command line on small sequences: files that come out, exit statuses, one line on stderr for bad input.

The host's pipeline is a stand-in here: what is tested is what lies around it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from functools import partial
from pathlib import Path

import cv2
import interrupted
import numpy as np
import pytest
import sequence_cases as cases
import vista
import vista.chain
import vista.parameters
from command_line import Vista, assert_refused, call
from fake_pipeline import DescendingDetector, FakeDetector
from shared_data import REPOSITORY
from vista.chain import engine_parameters
from vista.cli import main
from vista.recording import ANEW, FRAME, HAS_POSE, HEAD, PARAMETER, Content

pytestmark = pytest.mark.slow

MAKERS = [cases.make_asl, cases.make_kitti, cases.make_pairs]
RESULTS = {"obstacles.jsonl", "summary.json", "report.html", "frames"}
TESTS = Path(__file__).resolve().parent


@pytest.fixture
def run_vista(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Vista:
    monkeypatch.setattr(vista.chain, "Detector", FakeDetector)
    return partial(call, capsys)


def read_lines(folder: Path) -> list[dict]:
    return [json.loads(line) for line in (folder / "obstacles.jsonl").read_text().splitlines()]


# ---- vista run ----


@pytest.mark.parametrize("make", MAKERS)
def test_run_writes_what_interfaces_promise(tmp_path: Path, run_vista: Vista, make) -> None:
    out = tmp_path / "new" / "out"
    status, stdout, stderr = run_vista("run", make(tmp_path / "flight"), "--out", out)
    assert (status, stderr) == (0, "")
    assert str(out / "report.html") in stdout
    assert {path.name for path in out.iterdir()} == RESULTS

    lines = read_lines(out)
    assert [line["frame"] for line in lines] == list(range(cases.FRAMES))
    assert lines[0]["nearest_collision"] is None

    summary = json.loads((out / "summary.json").read_text())
    assert (summary["frames"], summary["engine"], summary["interrupted"]) == (cases.FRAMES, "golden", False)
    assert summary["parameters"] == vista.parameters.defaults()
    assert summary["tracks_dropped"] == 2 * cases.FRAMES  # as the stand-in says
    stages = summary["stages_ms"]
    assert set(stages) >= {"read", "rectify", "stereo", "foveation", "segmentation", "host", "total"}
    assert all(0 <= stage["median"] <= stage["p99"] for stage in stages.values())
    for index in range(cases.FRAMES):
        assert cv2.imread(str(out / "frames" / f"{index:06d}.jpg")).shape[1] > 2 * cases.WIDTH


def test_only_things_count_as_obstacles(
    tmp_path: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three confirmed tracks; what has no track is not one more."""
    monkeypatch.setattr(vista.chain, "Detector", DescendingDetector)
    status, stdout, _ = run_vista("run", cases.make_kitti(tmp_path / "flight"), "--out", tmp_path / "out")
    assert status == 0 and "3 obstacles tracked" in stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["obstacles_confirmed"] == 3


def test_the_summary_says_how_far_the_path_was_seen_and_how_often_it_met_the_ground(
    tmp_path: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last two of the four frames have the ground in the collision volume, and all have it in view."""
    folder = cases.make_kitti(tmp_path / "flight")
    for detector, frames_met in ((FakeDetector, 0), (DescendingDetector, 2)):
        monkeypatch.setattr(vista.chain, "Detector", detector)
        assert run_vista("run", folder, "--out", tmp_path / "out")[0] == 0
        summary = json.loads((tmp_path / "out" / "summary.json").read_text())
        assert summary["frames_with_ground_ahead"] == frames_met
        assert summary["path_seen_m"] == {"median": 18.5, "least": 17.0}
        assert [line["path_seen_m"] for line in read_lines(tmp_path / "out")] == [20.0, 19.0, 18.0, 17.0]
    described = (REPOSITORY / "doc" / "output.md").read_text()
    assert all(f"`{key}`" in described for key in ("frames_with_ground_ahead", "path_seen_m", "least"))


def test_frames_keep_their_numbers(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    for wanted, expected in {"1:3": [1, 2], "2:": [2, 3], ":1": [0], ":": [0, 1, 2, 3]}.items():
        assert run_vista("run", folder, "--out", tmp_path / "out", "--frames", wanted)[0] == 0
        assert [line["frame"] for line in read_lines(tmp_path / "out")] == expected
        pictures = sorted(path.name for path in (tmp_path / "out" / "frames").iterdir())
        assert pictures == [f"{index:06d}.jpg" for index in expected]


def test_no_overlay_draws_nothing(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    assert run_vista("run", folder, "--out", tmp_path / "out", "--no-overlay")[0] == 0
    assert not list((tmp_path / "out" / "frames").iterdir())
    assert "<img" not in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize("engine", ["golden", "opencv"])
def test_engines_and_config(tmp_path: Path, run_vista: Vista, engine: str) -> None:
    (tmp_path / "c.toml").write_text(
        "[stereo]\nblock_size = 9\nlr_max_diff = -1\n[foveation]\nrho_0_px = 5\n"
    )
    folder = cases.make_pairs(tmp_path / "pairs")
    options = ("--engine", engine, "--config", tmp_path / "c.toml", "--threads", 2)
    assert run_vista("run", folder, "--out", tmp_path / "out", *options)[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["engine"] == engine
    assert summary["parameters"]["stereo"]["block_size"] == 9
    assert summary["parameters"]["stereo"]["lr_max_diff"] == -1
    assert summary["parameters"]["foveation"]["rho_0_px"] == 5.0


def test_opencv_runs_on_the_defaults(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    assert run_vista("run", folder, "--out", tmp_path / "out", "--engine", "opencv")[0] == 0


def make_engine() -> vista.StereoEngine:
    return vista.StereoEngine(**vars(engine_parameters(vista.parameters.defaults())))


def recorded_frame_bytes() -> int:
    levels = vista.parameters.defaults()["stereo"]["levels"]
    words = sum(-(-cases.WIDTH // 2**k) * -(-cases.HEIGHT // 2**k) for k in range(levels))
    return FRAME.size + 2 * cases.WIDTH * cases.HEIGHT + 2 * words


def test_record_holds_what_the_host_received(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_kitti(tmp_path / "kitti")
    record = tmp_path / "flight.rec"
    assert run_vista("run", folder, "--out", tmp_path / "out", "--record", record)[0] == 0
    data = record.read_bytes()
    magic, version, width, height, *kinds, parameter_count = HEAD.unpack_from(data)[:9]
    assert (magic, version, width, height) == (b"VISTAREC", 5, cases.WIDTH, cases.HEIGHT)
    assert kinds == [0, 0, Content.PAIR, False]
    assert HEAD.unpack_from(data)[9:13] == (cases.FOCAL_PX, cases.CX, cases.CY, cases.BASELINE_M)
    pixels = width * height
    recorded = [PARAMETER.unpack_from(data, HEAD.size + i * PARAMETER.size) for i in range(parameter_count)]
    texts = [[text.rstrip(b"\0").decode() for text in row[:2]] for row in recorded]
    found = {name: choice or number for (name, choice), (_, _, number) in zip(texts, recorded, strict=True)}
    assert found == vista.parameters.flat(vista.parameters.defaults())
    assert found["stereo.prefilter"] == "xsobel"  # by its name, wherever it stands in parameters.toml
    frame_bytes = recorded_frame_bytes()
    first_frame = HEAD.size + parameter_count * PARAMETER.size
    assert len(data) == first_frame + cases.FRAMES * frame_bytes
    at = first_frame + 2 * frame_bytes
    t_ns, index, flags, *numbers = FRAME.unpack_from(data, at)
    assert (t_ns, index, flags) == (200_000_000, 2, HAS_POSE)
    assert numbers == [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 2, 0, 0, 0]
    left, right = cases.texture_pair(2)
    seen = np.frombuffer(data, np.uint8, 2 * pixels, at + FRAME.size).reshape(2, height, width)
    np.testing.assert_array_equal(seen, (left, right))
    at += FRAME.size + 2 * pixels
    for level in make_engine().compute_levels(left, right):
        words = np.frombuffer(data, "<i2", level.size, at).reshape(level.shape)
        np.testing.assert_array_equal(words, level)
        at += 2 * level.size


def test_a_recording_needs_the_name_of_a_file(tmp_path: Path, run_vista: Vista) -> None:
    folder, taken = cases.make_pairs(tmp_path / "pairs"), tmp_path / "taken"
    taken.mkdir()
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (taken, pipe):  # as root, even /dev/null could be replaced by a file
        ran = run_vista("run", folder, "--out", tmp_path / "out", "--record", path)
        assert_refused(ran, f"{path}: cannot be written: it exists and is no file")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pairs", "pipe", "taken"]
    assert pipe.is_fifo()


@pytest.mark.parametrize("engine", ["golden", "opencv"])
@pytest.mark.parametrize("smooth", ["off", "binomial3"])
def test_smoothing_of_a_config(tmp_path: Path, run_vista: Vista, engine: str, smooth: str) -> None:
    (tmp_path / "c.toml").write_text(
        f'[stereo]\nnum_disparities = 32\nlr_max_diff = -1\nsmooth = "{smooth}"\nlevels = 1\n'
    )
    folder, record = cases.make_kitti(tmp_path / "kitti"), tmp_path / "flight.rec"
    options = ["--engine", engine, "--config", tmp_path / "c.toml", "--record", record]
    assert run_vista("run", folder, "--out", tmp_path / "out", *options)[0] == 0
    pair = cases.texture_pair(cases.FRAMES - 1)
    words = np.frombuffer(record.read_bytes()[-2 * cases.WIDTH * cases.HEIGHT :], "<i2").reshape(
        pair[0].shape
    )
    both = [vista.StereoEngine(32, lr_max_diff=None, smooth=s).compute(*pair) for s in (False, True)]
    np.testing.assert_array_equal(words, both[smooth == "binomial3"])
    assert (both[0] != both[1]).any()


@pytest.mark.parametrize("stills", [True, False])
def test_stills_are_judged_one_by_one(
    tmp_path: Path, stills: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """The real pipeline gives the ids of the board and whether it is confirmed, frame by frame. Stills are
    not presented as a flight."""
    folder = cases.make_board_scenes(tmp_path / "pairs", 4, stills)
    record = tmp_path / "stills.rec"
    options = ["--out", str(tmp_path / "out"), "--no-overlay", "--all-tracks", "--record", str(record)]
    assert main(["run", str(folder), *options]) == 0
    frames = [line["obstacles"] for line in read_lines(tmp_path / "out")]
    boards = [min(obstacles, key=lambda o: abs(o["distance_m"] - 12.5)) for obstacles in frames]
    assert all(board["distance_m"] == pytest.approx(12.5, abs=0.5) for board in boards)
    ids = [{obstacle["id"] for obstacle in obstacles} for obstacles in frames]
    if stills:
        assert all(o["confirmed"] and o["age_frames"] == 1 for obstacles in frames for o in obstacles)
        assert len(set.union(*ids)) == sum(map(len, ids))
        assert [line["nearest_collision"]["id"] for line in read_lines(tmp_path / "out")] == [
            board["id"] for board in boards
        ]
    else:
        assert [board["confirmed"] for board in boards] == [False, False, False, True]
        assert len({board["id"] for board in boards}) == 1
    data = record.read_bytes()
    assert HEAD.unpack_from(data)[7] == stills
    first = HEAD.size + PARAMETER.size * HEAD.unpack_from(data)[8]
    assert bool(FRAME.unpack_from(data, first)[2] & ANEW) == stills
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["parameters"]["tracker"]["confirm_hits"] == (1 if stills else 4)
    printed = capsys.readouterr().out
    assert ("4 stills, each judged alone: 4 with something in the collision volume" in printed) == stills
    assert ("tracked" in printed) != stills


def test_an_earlier_run_is_replaced(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    out = tmp_path / "out"
    assert run_vista("run", folder, "--out", out)[0] == 0
    status, stdout, _ = run_vista("run", folder, "--out", out, "--frames", "0:1")
    assert status == 0 and "pairs: 1 frame, " in stdout
    assert len(read_lines(out)) == 1
    assert [path.name for path in (out / "frames").iterdir()] == ["000000.jpg"]


def test_a_bad_frame_leaves_whole_lines_and_a_summary(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    image = folder / "scene02_right.png"
    image.write_bytes(image.read_bytes()[:500])
    out, record = tmp_path / "out", tmp_path / "flight.rec"
    status, _, stderr = run_vista("run", folder, "--out", out, "--record", record)
    assert (status, stderr) == (2, f"vista: {image}: truncated image\n")
    assert [line["frame"] for line in read_lines(out)] == [0, 1]
    summary = json.loads((out / "summary.json").read_text())
    assert summary["frames"] == 2
    assert summary["error"] == f"{image}: truncated image"
    assert {path.name for path in out.iterdir()} == RESULTS - {"report.html"}
    frame_bytes = recorded_frame_bytes()
    head_bytes = HEAD.size + PARAMETER.size * HEAD.unpack_from(record.read_bytes())[8]
    assert record.stat().st_size == head_bytes + 2 * frame_bytes


# ---- bad input: status 2, one line, nothing written ----


def cut_first_image(folder: Path) -> None:
    path = folder / "scene00_left.png"
    path.write_bytes(path.read_bytes()[:-30])


BAD_SEQUENCES: dict[str, tuple[cases.Damage, str]] = {
    "missing right image": (cases.remove("scene00_right.png"), "scene00_right.png: no such file"),
    "truncated image": (cut_first_image, "scene00_left.png: truncated image"),
}


@pytest.mark.parametrize("name", BAD_SEQUENCES)
def test_bad_sequences(tmp_path: Path, run_vista: Vista, name: str) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    damage, message = BAD_SEQUENCES[name]
    damage(folder)
    options = ["--out", tmp_path / "out", "--record", tmp_path / "flight.rec"]
    assert_refused(run_vista("run", folder, *options), message)
    assert [path.name for path in tmp_path.iterdir()] == ["pairs"]


BAD_CONFIGS = {
    "[foveation": "not readable as TOML",
    "[nonsense]\na = 1": "unknown section [nonsense]",
    "[foveation]\nrho = 1": "unknown parameter foveation.rho",
    "[foveation]\nrho_0_px = nan": "foveation.rho_0_px must be",
    "[foveation]\nsector_count = 'many'": "foveation.sector_count must be",
    "[stereo]\nblock_size = 4": "stereo.block_size must be from 5 to 21",
    "[stereo]\nblock_size = 8": "engine golden: ",
    "[tracker]\nconfirm_hits = 7": "tracker.confirm_hits must be at most tracker.confirm_window (6), not 7",
    "[tracker]\nconfirm_window = 2": "tracker.confirm_hits must be at most tracker.confirm_window (2), not 4",
    "stereo = 1": "unknown section [stereo]",
    "[stereo]\nsmooth = true": "stereo.smooth must be one of off, binomial3, not True",
    "[stereo]\nlevels = 5": "stereo.levels must be from 1 to 4",
}


@pytest.mark.parametrize("text", BAD_CONFIGS)
def test_bad_configs(tmp_path: Path, run_vista: Vista, text: str) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    (tmp_path / "c.toml").write_text(text)
    options = ["--out", tmp_path / "out", "--config", tmp_path / "c.toml"]
    assert_refused(run_vista("run", folder, *options), BAD_CONFIGS[text])
    assert not (tmp_path / "out").exists()


BAD_OPTIONS = [
    (["run"], "required"),
    ([], "required"),
    (["soar"], "invalid choice"),
    (
        ["run", "SEQUENCE", "--out", "OUT", "--frames", "3"],
        "--frames: '3' is not a range A:B of frame numbers",
    ),
    (["run", "SEQUENCE", "--out", "OUT", "--frames", "-1:2"], "--frames"),
    (
        ["run", "SEQUENCE", "--out", "OUT", "--frames", "9:12"],
        "--frames: selects none; the sequence has frames 0 to 3",
    ),
    (["run", "SEQUENCE", "--out", "OUT", "--frames", "2:2"], "--frames: selects none"),
    (["run", "SEQUENCE", "--out", "OUT", "--threads", "0"], "--threads"),
    (["run", "SEQUENCE", "--out", "OUT", "--engine", "none"], "--engine"),
    (["run", "SEQUENCE", "--out", "OUT", "--pair-tolerance-ms", "x"], "'x' is not a number from 0 on"),
    (["run", "SEQUENCE", "--out", "OUT", "--pair-tolerance-ms=-1"], "'-1' is not a number from 0 on"),
    (["run", "SEQUENCE", "--out", "OUT", "--config", "missing.toml"], "missing.toml: no such file"),
    (["run", "missing", "--out", "OUT"], "missing: no such file or folder"),
    (["run", "x" * 300, "--out", "OUT"], "file name too long"),
    (["run", "SEQUENCE", "--out", "SEQUENCE"], "holds other files"),
    (["run", "SEQUENCE", "--out", "SEQUENCE/calibration.toml"], "calibration.toml: not a folder"),
    (["run", "SEQUENCE", "--out", "SEQUENCE/calibration.toml/out"], "cannot be written"),
    (["run", "SEQUENCE", "--out", "OUT", "--record", "missing/file"], "missing/file: cannot be written"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_OPTIONS)
def test_bad_options(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_vista: Vista, arguments: list[str], message: str
) -> None:
    cases.make_pairs(tmp_path / "SEQUENCE")
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert_refused(run_vista(*arguments), message)
    assert sorted(tmp_path.rglob("*")) == before


# ---- interruption ----

SLOW_RUN = """
import sys, time
import vista.chain
import vista.parameters
from fake_pipeline import FakeDetector
from vista.cli import main

class SlowDetector(FakeDetector):
    def judge(self, *arguments):
        time.sleep(0.05)
        return super().judge(*arguments)

vista.chain.Detector = SlowDetector
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_leaves_whole_lines_and_a_valid_summary(tmp_path: Path, number: signal.Signals) -> None:
    folder, out = cases.make_pairs(tmp_path / "pairs", 60), tmp_path / "out"
    paths = [str(TESTS), str(TESTS.parent / "python"), os.environ.get("PYTHONPATH", "")]
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW_RUN, "run", str(folder), "--out", str(out)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    lines = out / "obstacles.jsonl"
    deadline_s = time.monotonic() + 60.0
    while (
        not (lines.exists() and lines.stat().st_size)
        and process.poll() is None
        and time.monotonic() < deadline_s
    ):
        time.sleep(0.01)
    process.send_signal(number)
    stdout, stderr = process.communicate(timeout=60)
    frames = read_lines(out)
    line = f"vista: interrupted after {len(frames)} frame{'s' * (len(frames) != 1)}\n".encode()
    assert (process.returncode, stdout, stderr) == (130, b"", line)
    assert 1 <= len(frames) < 60
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["frames"], summary["interrupted"]) == (len(frames), True)
    assert {path.name for path in out.iterdir()} == RESULTS - {"report.html"}


# ---- vista disparity, vista config, help ----


def test_disparity(tmp_path: Path, run_vista: Vista) -> None:
    left, right = cases.texture_pair(0)
    cases.write_image(tmp_path / "l.png", left)
    cases.write_image(tmp_path / "r.png", right)
    out = tmp_path / "d.npy"
    assert run_vista("disparity", tmp_path / "l.png", tmp_path / "r.png", "--out", out) == (0, "", "")
    words = np.load(out)
    np.testing.assert_array_equal(words, vista.StereoEngine().compute(left, right))
    assert np.median(words[words >= 0]) == 16 * cases.DISPARITY_PX


def test_disparity_passes_every_option(tmp_path: Path, run_vista: Vista) -> None:
    left, right = cases.texture_pair(1)
    cases.write_image(tmp_path / "l.png", left)
    cases.write_image(tmp_path / "r.png", right)
    options = ["--disparities", 16, "--block", 7, "--prefilter", "none", "--cap", 20, "--texture", 50]
    options += ["--uniqueness", 5, "--lr", "off"]
    out = tmp_path / "d.npy"
    assert run_vista("disparity", tmp_path / "l.png", tmp_path / "r.png", "--out", out, *options)[0] == 0
    engine = vista.StereoEngine(16, 7, "none", 20, 50, 5, None)
    np.testing.assert_array_equal(np.load(out), engine.compute(left, right))


BAD_DISPARITY = {
    "missing.png r.png --out d.png": "missing.png: no such file",
    "l.png small.png --out d.png": "small.png: image is 8x8, the left one 160x120",
    "l.png r.png --out d.tif": "d.tif: disparity files end in",
    "l.png r.png --out nowhere/d.png": "nowhere/d.png: cannot be written",
    "l.png r.png --out d.png --block 4": "disparity: ",
    "l.png r.png --out d.png --disparities 20": "disparity: ",
    "l.png r.png --out d.png --lr maybe": "--lr",
    "l.png r.png --out d.png --cap x": "--cap",
    "l.png r.png": "--out",
}


@pytest.mark.parametrize("arguments", BAD_DISPARITY)
def test_bad_disparity(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_vista: Vista, arguments: str
) -> None:
    monkeypatch.chdir(tmp_path)
    left, right = cases.texture_pair(0)
    for name, image in {"l.png": left, "r.png": right, "small.png": left[:8, :8]}.items():
        cases.write_image(Path(name), image)
    assert_refused(run_vista("disparity", *arguments.split()), BAD_DISPARITY[arguments])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["l.png", "r.png", "small.png"]


def test_config_prints_what_run_reads(tmp_path: Path, run_vista: Vista) -> None:
    status, stdout, _ = run_vista("config")
    assert status == 0
    printed = tomllib.loads(stdout)
    assert printed["stereo"]["block_size"] == 11
    (tmp_path / "c.toml").write_text(stdout)
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    assert run_vista("run", folder, "--out", tmp_path / "a", "--config", tmp_path / "c.toml")[0] == 0
    assert run_vista("run", folder, "--out", tmp_path / "b")[0] == 0
    with_config, without = (json.loads((tmp_path / name / "summary.json").read_text()) for name in "ab")
    assert with_config["parameters"] == without["parameters"]


def test_help_says_the_exit_statuses(run_vista: Vista) -> None:
    for arguments in (["--help"], *([name, "--help"] for name in ("run", "disparity", "config", "ros"))):
        status, stdout, _ = run_vista(*arguments)
        assert status == 0
        assert "exit status" in stdout and "130" in stdout
        assert ("0    ended by Ctrl-C or SIGTERM" in stdout) == (arguments[0] == "ros")


# ---- version, names of files, start ----


def test_the_version_is_that_of_the_checkout(tmp_path: Path, run_vista: Vista) -> None:
    version = (REPOSITORY / "VERSION").read_text().strip()
    assert run_vista("--version") == (0, f"vista {version}\n", "")
    assert vista.__version__ == version
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    assert run_vista("run", folder, "--out", tmp_path / "out", "--no-overlay")[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    described = subprocess.run(
        ["git", "-C", str(REPOSITORY), "rev-parse", "HEAD"], capture_output=True, text=True
    ).stdout.strip()
    assert summary["version"] == version
    assert list(summary)[:3] == ["version", "commit", "command"]
    assert summary["commit"] is None if not described else described[:12] in summary["commit"]


def run_program(*arguments: str | bytes, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "vista", *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=120, env=os.environ | environment, errors="replace"
    )


def test_the_summary_holds_the_command(tmp_path: Path) -> None:
    folder = cases.make_pairs(tmp_path / "two words", 1)
    run = run_program("run", str(folder), "--out", str(tmp_path / "out"), "--no-overlay")
    assert run.returncode == 0, run.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["command"] == f"vista run '{folder}' --out {tmp_path / 'out'} --no-overlay"


@pytest.mark.parametrize("options", [[], ["--no-overlay"]])
def test_folders_whose_names_are_not_utf8(tmp_path: Path, options: list[str]) -> None:
    """A program of its own runs it: OpenCV did not raise an exception, it crashed."""
    folder, out = (os.fsencode(tmp_path) + name for name in (b"/fl\xffght", b"/o\xfet"))
    cases.make_pairs(tmp_path / "pairs", 2).rename(os.fsdecode(folder))
    run = run_program(b"run", folder, b"--out", out, *options)
    assert run.returncode == 0, run.stderr
    assert run.stdout.startswith("fl\N{REPLACEMENT CHARACTER}ght: 2 frames")
    assert {path.name for path in Path(os.fsdecode(out)).iterdir()} == RESULTS
    report = run.stdout.splitlines()[-1].removeprefix("report: ")  # as it is, into a shell
    assert subprocess.run(["bash", "-c", f"test -s {report}"], timeout=60).returncode == 0
    refused = run_program(b"run", out, b"--out", out)
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1


def test_an_image_that_is_too_large_is_called_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "pairs"
    for side in ("left", "right"):
        cases.write_image(folder / f"a_{side}.png", np.zeros((16, 8208), np.uint8))
    (folder / "calibration.toml").write_text(cases.PAIR_CALIBRATION)
    outcome = call(capsys, "run", folder, "--out", tmp_path / "out")
    assert_refused(outcome, "images of 8208x16 px: a size is not handled (images: 16 to 8192 px a side)")


@pytest.mark.parametrize("module", ["cv2", "numpy", "vista.report.overlay", "tqdm"])
def test_an_interruption_while_modules_load_ends_with_one_line(module: str) -> None:
    program = interrupted.while_loading(module, "run", "missing", "--out", "missing")
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "vista: interrupted\n")


def test_a_missing_dependency_takes_one_line() -> None:
    program = """
import sys
sys.modules["cv2"] = None
from vista.__main__ import main
sys.exit(main())
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert run.returncode == 2
    assert run.stderr.startswith("vista: not installed whole: ") and run.stderr.count("\n") == 1


def test_missing_libraries_take_one_line(tmp_path: Path) -> None:
    folder = cases.make_pairs(tmp_path / "pairs", 1)
    run = run_program("run", str(folder), "--out", str(tmp_path / "out"), VISTA_BUILD=str(tmp_path / "empty"))
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.startswith("vista: libvista") and "make build" in run.stderr
    assert run.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
