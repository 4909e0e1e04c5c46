"""`vista throughput`: options, searches and figures on a stand-in of formulas; then the real one."""

from __future__ import annotations

import json
import math
import re
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused, call
from fake_system import LATENCY_CLOCKS, FakeSimulator
from shared_data import REPOSITORY
from vista.engine import EngineParameters, StereoEngine
from vista.errors import InputError
from vista_throughput import scene, simulate, synthesis
from vista_throughput.assess import assess
from vista_throughput.explore import clock_needed, engine_rate_hz, limit
from vista_throughput.figures import figures
from vista_throughput.host_times import HostTimes, sequence_host_times, synthetic_host_times
from vista_throughput.options import OPTIONS
from vista_throughput.presets import PRESETS, Clock
from vista_throughput.system import SystemConfig

pytestmark = pytest.mark.slow

PIXELS = 640 * 480
HOST = {"host_stage_ms": {"cut": (4.0,), "track": (2.0,)}}  # 167 frames/s
RESULTS = {"throughput.json", "report.html", "timeline.png", "sweep.png"}


# ---- one truth ----


def documented_keys() -> set[str]:
    text = (REPOSITORY / "doc" / "design" / "system-model.md").read_text()
    table = text.partition("## Configuration")[2].partition("## Output")[0]
    return {key for line in table.splitlines() if line.startswith("| `") for key in re.findall(
        r"`([a-z_]+)`", line.split("|")[1])}  # fmt: skip


def test_every_key_is_one_of_the_model() -> None:
    text = SystemConfig(rectify_ms=(1.0,), host_stage_ms={"cut": (1.5, 2.0)}).text()
    lines = dict(line.split(" = ") for line in text.splitlines())
    assert lines.pop("host_stage.cut_ms") == "1.5000, 2.0000"
    assert lines["compute_words"] == "off" and lines["engine_clock_hz"] == "100000000.0"
    assert len(lines) == len(fields(SystemConfig)) - 1
    assert set(lines) <= documented_keys()


def test_clocks_are_those_of_the_synthesis_results() -> None:
    recorded = json.loads((REPOSITORY / synthesis.RESULTS).read_text())["builds"]
    routed = [one for one in recorded if one["clock_mhz"] is not None]
    builds = synthesis.builds()
    assert [build.clock_mhz for build in builds] == [one["clock_mhz"] for one in routed]
    assert len(routed) < len(recorded)  # one was never routed: it must not lend its clock
    reference = synthesis.find(32, 11, 1024)
    assert reference is not None
    assert reference.speed_grade == min(b.speed_grade for b in builds if b.disparities == 32)
    assert synthesis.find(48, 11) is None and synthesis.find(128, 11) is None


@pytest.mark.parametrize(("old", "new"), [('"builds"', '"none"'), ('"lut4"', '"lut6"'), ("102.2", '"fast"')])
def test_damaged_synthesis_results(old: str, new: str) -> None:
    build = {
        "disparities": 32,
        "block_px": 11,
        "max_width_px": 1024,
        "device": "LFE5U-25F",
        "speed_grade": 6,
        "lut4": 8304,
        "clock_mhz": 102.2,
    }
    text = json.dumps({"builds": [build]})
    assert synthesis.parse(text)[0].clock_mhz == 102.2
    assert old in text
    with pytest.raises(InputError, match="make synth"):
        synthesis.parse(text.replace(old, new))


# ---- what limits it, and the clock it needs ----


@pytest.mark.parametrize(
    ("changes", "stage", "rate_hz"),
    [
        ({}, "host", 1000 / 6),
        ({"engine_clock_hz": 8e6}, "engine", 8e6 / PIXELS),
        ({"memory_bandwidth_bytes_s": 50e6}, "memory", 50e6 / 8 / PIXELS),
        ({"host_stage_ms": {"cut": (40.0, 60.0)}}, "host", 20.0),
        ({"host_stage_ms": {}}, "engine", 100e6 / PIXELS),
        ({"host_stage_ms": {}, "lanes": 2}, "engine", 200e6 / PIXELS),
    ],
)
def test_the_bottleneck_is_named(changes: dict, stage: str, rate_hz: float) -> None:
    found = limit(FakeSimulator(), SystemConfig(**(HOST | changes)))
    assert found.stage == stage
    assert found.rate_hz == pytest.approx(rate_hz, rel=0.01)
    others = {name: rate for name, rate in found.rate_if_twice_as_fast_hz.items() if name != stage}
    assert found.rate_if_twice_as_fast_hz[stage] > 1.9 * rate_hz
    assert all(rate == pytest.approx(rate_hz, rel=0.01) for rate in others.values())


@pytest.mark.parametrize("rate_hz", [23.0, 60.0, 144.0])
@pytest.mark.parametrize("clock_hz", [1e6, 100e6, 1e9])
def test_clock_needed(rate_hz: float, clock_hz: float) -> None:
    simulator = FakeSimulator()
    config = SystemConfig(**HOST, camera_rate_hz=rate_hz, engine_clock_hz=clock_hz)
    config = replace(config, camera_pixel_clock_hz=200e6)
    needed = clock_needed(simulator, config)
    assert needed is not None
    assert needed.clock_hz == pytest.approx(PIXELS * rate_hz, rel=0.005)
    assert needed.clock_hz >= PIXELS * rate_hz
    assert (needed.confirmed_frames, needed.confirmed_dropped) == (100, 0)
    below = replace(config, engine_clock_hz=0.99 * needed.clock_hz)
    assert engine_rate_hz(simulator, below) < rate_hz


def test_no_clock_helps_a_slow_memory() -> None:
    slow = SystemConfig(memory_bandwidth_bytes_s=8 * PIXELS * 20.0, camera_rate_hz=23.0)
    assert clock_needed(FakeSimulator(), slow) is None


# ---- figures ----


def test_figures_of_a_system_that_keeps_up() -> None:
    config = SystemConfig(**HOST, camera_rate_hz=50.0, camera_pixel_clock_hz=42e6)
    found = figures(FakeSimulator().run(config))
    engine_ms = (PIXELS + LATENCY_CLOCKS) / 100e3
    assert found.rate_hz == pytest.approx(50.0)
    assert (found.delivered, found.dropped, found.drops) == (100, 0, {})
    assert found.engine_p50_ms == pytest.approx(engine_ms)
    assert found.latency_p50_ms == pytest.approx(10.0 + engine_ms + 6.0)
    assert found.latency_p99_ms == pytest.approx(found.latency_p50_ms)
    stages = {stage.name: stage for stage in found.stages}
    assert stages["camera"].p50_ms == pytest.approx(10.0)
    assert stages["camera"].utilisation == pytest.approx(0.5)
    assert stages["host"].utilisation == pytest.approx(0.3, abs=0.01)
    assert stages["wait for the host"].p99_ms == pytest.approx(0.0, abs=1e-6)
    measured = [s.p50_ms for s in found.stages if not math.isnan(s.p50_ms)]
    assert sum(measured) == pytest.approx(found.latency_p50_ms)  # the stages are all there is of the latency


def test_figures_of_a_system_that_does_not() -> None:
    found = figures(FakeSimulator().run(SystemConfig(host_stage_ms={"cut": (50.0,)})))
    assert found.rate_hz == pytest.approx(20.0, rel=0.01)
    assert found.dropped == 100 - found.delivered == found.drops["no_buffer"] > 50


def test_one_frame_gives_a_latency_and_no_rate() -> None:
    found = figures(FakeSimulator().run(SystemConfig(frames=1, host_stage_ms={"cut": (50.0,)})))
    assert found.rate_hz == 0.0
    assert found.latency_p50_ms > 50.0


# ---- the host, measured ----


def test_the_synthetic_scene_has_the_disparities_of_its_geometry() -> None:
    camera = scene.calibration(320, 240)
    (frame,) = scene.synthetic_frames(320, 240, 1, seed=2)
    words = StereoEngine(32, 11).compute(frame.left, frame.right)
    rows = np.arange(150, 225)
    ground_px = camera.baseline_m * (rows - camera.cy) / scene.CAMERA_HEIGHT_M
    error_px = words[rows] / 16 - ground_px[:, None]
    matched_px = error_px[:, 40:-10][words[rows, 40:-10] >= 0]
    assert np.mean(np.abs(matched_px) < 0.5) > 0.3  # the ground; boards cover the rest, nearer than it
    assert np.mean(matched_px < -0.5) < 0.02
    assert (words[5:80, 40:-10] >= 0).mean() < 0.5  # boards before a bare sky


def test_host_times_of_synthetic_frames_and_of_a_sequence(tmp_path: Path) -> None:
    engine = EngineParameters(16, 5)
    synthetic = synthetic_host_times(160, 120, engine, seed=1)
    folder = cases.make_pairs(tmp_path / "pairs", 6)
    recorded = sequence_host_times(folder, cases.WIDTH, cases.HEIGHT, engine)
    for times, count in ((synthetic, 30), (recorded, 4)):
        assert {"foveation", "segmentation", "tracking"} <= set(times.stage_ms)
        assert "host" not in times.stage_ms  # their sum
        assert all(len(series) == count and min(series) >= 0 for series in times.stage_ms.values())
        assert min(np.sum(list(times.stage_ms.values()), axis=0)) > 0
        assert times.rectify_ms == ()
    with pytest.raises(InputError, match="its images are 160x120, the system's 640x480"):
        sequence_host_times(folder, 640, 480, engine)


def test_rectification_is_part_of_the_host(tmp_path: Path) -> None:
    """A distorted sequence brings times to rectify, one for each frame that counts."""
    folder = cases.make_asl(tmp_path / "flight")
    sensor = folder / "mav0" / "cam0" / "sensor.yaml"
    text = sensor.read_text()
    bent = re.sub(r"(distortion_coefficients:) \[[^]]*\]", r"\1 [-0.1, 0.01, 0.0, 0.0]", text)
    assert bent != text
    sensor.write_text(bent)
    times = sequence_host_times(folder, cases.WIDTH, cases.HEIGHT, EngineParameters(16, 5))
    assert len(times.rectify_ms) == cases.FRAMES - 2 and min(times.rectify_ms) > 0


# ---- the command ----


@pytest.fixture
def run_vista(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Vista:
    monkeypatch.setattr(simulate, "Simulator", FakeSimulator)
    monkeypatch.setattr(simulate, "find_program", lambda: None)
    return partial(call, capsys, "throughput")


@pytest.mark.parametrize("preset", PRESETS)
def test_presets(run_vista: Vista, preset: str) -> None:
    status, stdout, stderr = run_vista("--preset", preset, "--host-ms", "5,6,7")
    assert (status, stderr) == (0, "")
    rate = PRESETS[preset].values["camera_rate_hz"]
    assert stdout.startswith(f"{preset}: ")
    assert f"rate: {rate:.1f} of {rate:g} frames/s, 0 of 100 frames dropped" in stdout
    assert "bottleneck: the camera; all that follows keeps up" in stdout


def test_results(tmp_path: Path, run_vista: Vista) -> None:
    out = tmp_path / "new" / "out"
    options = ["--host-ms", "50", "--camera-rate", 40, "--lanes", 2, "--frames", 40]
    for _ in range(2):  # an earlier run is replaced
        status, stdout, _ = run_vista("--out", out, *options)
        assert status == 0
    assert f"report: {out / 'report.html'}" in stdout
    assert {path.name for path in out.iterdir()} == RESULTS
    content = json.loads((out / "throughput.json").read_text())
    assert content["bottleneck"] == content["limit"]["stage"] == "host"
    assert content["figures"]["dropped"] > 0 and content["figures"]["rate_hz"] == pytest.approx(20, rel=0.02)
    assert content["clock"]["build"]["clock_mhz"] * 1e6 == content["system"]["engine_clock_hz"]
    assert len(content["simulation"]["frames"]) == 40
    assert [point["disparities"] for point in content["sweeps"]["disparities"]] == [16, 32, 64, 128, 256]
    for name in ("timeline.png", "sweep.png"):
        picture = cv2.imread(str(out / name))
        assert picture.shape[1] > 1000 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 50
    page = (out / "report.html").read_text()
    assert page.count("<svg") == 2 and not re.search(r'(src|href)="http', page)


def test_options_change_a_preset(run_vista: Vista) -> None:
    options = ["--preset", "acadia", "--camera-rate", 30, "--clock", "50e6", "--host-ms", 1]
    _, stdout, _ = run_vista(*options)
    assert "camera 30 Hz" in stdout and "1 engine at 50 MHz (as given)" in stdout


def test_a_width_that_was_not_routed_is_said(run_vista: Vista) -> None:
    _, stdout, _ = run_vista("--build-width", 2048, "--host-ms", 1)
    assert "not routed for 2048 px; the clock is that of 32 disparities, block 11, up to 1024 px" in stdout


BAD_OPTIONS = {
    "--clock 0": "argument --clock: '0' is not a number above 0",
    "--clock nan": "argument --clock: 'nan' is not",
    "--clock inf": "argument --clock: 'inf' is not",
    "--clock=-1e6": "argument --clock: '-1e6' is not",
    "--camera-rate fast": "argument --camera-rate: 'fast' is not",
    "--memory-bandwidth 0": "argument --memory-bandwidth: '0' is not",
    "--width 0": "argument --width: '0' is not a positive whole number",
    "--width 640.5": "argument --width: '640.5' is not",
    "--width 1025": "--width: 1025 px, the engine is built for 1024: name --build-width",
    "--preset paper": "argument --preset: invalid choice: 'paper'",
    "--disparities 48": "--clock: name one: of 48 disparities, block 11, none was routed; 32 (block 11)",
    "--preset board --memory-bandwidth 1e9": "--memory-bandwidth: the memory of a board is an SDRAM",
    "--preset acadia --memory-clock 1e8": "--memory-clock: is that of a board: name its --link",
    "--camera-rate 61 --pixel-clock 25.2e6": "--camera-rate: 61 Hz; --pixel-clock and blanking allow 60",
    "--host-ms 5,0": "argument --host-ms: '0' is not a number above 0",
    "--host-ms 5,nan": "argument --host-ms: 'nan' is not",
    "--host-ms 5 --sequence x": "not allowed with argument --host-ms",
    "--sequence missing": "missing: no such file or folder",
    "--out taken --host-ms 5": "taken: holds other files (a.txt)",
    "--out taken/a.txt --host-ms 5": "taken/a.txt: not a folder",
}


@pytest.mark.parametrize("arguments", BAD_OPTIONS)
def test_bad_options(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_vista: Vista, arguments: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "a.txt").touch()
    assert_refused(run_vista(*arguments.split()), BAD_OPTIONS[arguments])
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a.txt", "taken"]


# ---- the real simulation ----

try:
    PROGRAM: Path | None = simulate.find_program()
except ImportError:
    PROGRAM = None
built = pytest.mark.skipif(PROGRAM is None, reason="build/bin/vista_system is not built")
SMALL = SystemConfig(width_px=96, height_px=40, disparities=16, block_px=5, frames=40)


def real_simulator() -> simulate.Simulator:
    assert PROGRAM is not None
    return simulate.Simulator(PROGRAM, {option.key: option.name for option in OPTIONS})


@built
def test_a_small_system_keeps_up() -> None:
    """A pixel a clock, and every part of the latency is accounted for."""
    config = replace(SMALL, camera_rate_hz=500.0, engine_clock_hz=20e6)
    host = HostTimes("as given", (), {"cut": (0.3, 0.35), "track": (0.05, 0.05)})
    answer = assess(real_simulator(), None, config, Clock(20e6, "as given", None), host)
    assert answer.run.output["engine"]["clocks_per_frame"] == 96 * 40
    assert (answer.figures.dropped, answer.bottleneck) == (0, "camera")
    assert answer.figures.rate_hz == pytest.approx(500.0, rel=0.001)
    assert answer.limit.stage == "host"
    assert answer.limit.rate_hz == pytest.approx(1000 / 0.375, rel=0.05)  # reading the words comes on top
    measured = [s.p50_ms for s in answer.figures.stages if not math.isnan(s.p50_ms)]
    assert sum(measured) == pytest.approx(answer.figures.latency_p50_ms, rel=0.02)
    assert answer.needed is not None and answer.needed.confirmed_dropped == 0
    assert 96 * 40 * 500 <= answer.needed.clock_hz < 1.1 * 96 * 40 * 500


@built
def test_an_overloaded_host_is_named() -> None:
    config = replace(SMALL, camera_rate_hz=1000.0, host_stage_ms={"cut": (4.0,)})
    run = real_simulator().run(config)
    assert figures(run).rate_hz == pytest.approx(250.0, rel=0.01)
    assert run.dropped > 0
    assert limit(real_simulator(), config).stage == "host"


@built
@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"engine_clock_hz": 1.0}, "throughput: --clock: 1.0 is outside 1000 .. 1e+10"),
        (
            {"width_px": 20, "max_width_px": 20},
            "throughput: --build-width: below --disparities + --block, 21",
        ),
    ],
)
def test_what_the_simulation_refuses_is_said_in_the_options_names(changes: dict, text: str) -> None:
    with pytest.raises(InputError) as raised:
        real_simulator().run(replace(SMALL, **changes))
    assert str(raised.value) == text
