"""The engine of the SystemC model against the Verilated RTL, on random frames and stalls: clock by clock."""

from __future__ import annotations

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from frames import Frame, beats, random_frame, random_pair, set_up
from registers import CONTROL, STALLS_IN, STALLS_OUT
from tools import ROOT
from verilated import PACES, Config, Pace, Rtl
from vista_model.engine import Parameters

TRACE = ROOT / "build" / "bin" / "vista_engine_trace"


@dataclass(frozen=True)
class Traced:
    """Clocks of all transfers, that of the first pixel 0; words; registers STALLS_IN and STALLS_OUT."""

    in_clock: npt.NDArray[np.int64]
    out_clock: npt.NDArray[np.int64]
    words: npt.NDArray[np.uint32]
    stalls: tuple[int, int]


@dataclass(frozen=True)
class Case:
    """Frames of one size back to back, and how the two sides stall."""

    config: Config
    frames: list[Frame]
    pace_in: Pace
    pace_out: Pace
    seed: int


def random_case(config: Config, seed: int) -> Case:
    rng = np.random.default_rng(seed)
    first = random_frame(rng, config.num_disparities, config.block_size, config.max_width)
    height, width = first.shape
    more = rng.integers(4)
    others = [Frame(*random_pair(rng, "noise", height, width), first.parameters) for _ in range(more)]
    paces = [PACES[i] for i in rng.integers(len(PACES), size=2)]
    return Case(config, [first, *others], *paces, seed)


def trace_rtl(rtl: Rtl, case: Case) -> Traced:
    rtl.reset()
    rtl.write(CONTROL, 1)
    set_up(rtl, case.frames[0])
    video = np.concatenate([beats(f.left, f.right) for f in case.frames])
    got = rtl.stream(video, len(video), case.pace_in, case.pace_out, case.seed)
    start = got.in_clock[0]
    stalls = rtl.read(STALLS_IN), rtl.read(STALLS_OUT)
    return Traced(got.in_clock - start, got.out_clock - start, got.words, stalls)


def configuration(case: Case, folder: Path) -> str:
    """The case for the model, its images written into the folder."""
    height, width = case.frames[0].shape
    p: Parameters = case.frames[0].parameters
    for side in ("left", "right"):
        (folder / side).write_bytes(b"".join(getattr(f, side).tobytes() for f in case.frames))
    return "\n".join(
        f"{key} = {value}"
        for key, value in {
            "width_px": width, "height_px": height, "disparities": p.num_disparities,
            "block_px": p.block_size, "max_width_px": case.config.max_width,
            "lr_max_diff_px": "off" if p.lr_max_diff is None else p.lr_max_diff,
            "prefilter": p.prefilter, "prefilter_cap": p.prefilter_cap,
            "texture_threshold": p.texture_threshold, "uniqueness_percent": p.uniqueness_ratio,
            "frames": len(case.frames), "seed": case.seed,
            "left_images": folder / "left", "right_images": folder / "right",
        }.items()
    )  # fmt: skip


def trace_model(case: Case) -> Traced:
    if not TRACE.is_file():
        raise FileNotFoundError(f"{TRACE} is missing: run `make systemc-tests`")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "config").write_text(configuration(case, folder))
        sides = (case.pace_in, case.pace_out)
        paces = [str(chance) for pace in sides for chance in (pace.stop, pace.go)]
        subprocess.run([TRACE, folder / "config", *paces, folder / "out"], check=True)
        raw = (folder / "out").read_bytes()
    count = sum(f.left.size for f in case.frames)
    clocks = np.frombuffer(raw, np.int64, 2 * count)
    words = np.frombuffer(raw, np.uint32, count, offset=16 * count)
    stalls = np.frombuffer(raw, np.int64, 2, offset=20 * count)
    start = clocks[0]
    return Traced(clocks[:count] - start, clocks[count:] - start, words, (int(stalls[0]), int(stalls[1])))


def check_case(rtl: Rtl, case: Case) -> None:
    """Raises AssertionError with the command that reruns the case."""
    height, width = case.frames[0].shape
    real, model = trace_rtl(rtl, case), trace_model(case)
    rerun = (
        f"{len(case.frames)} frames of {width}x{height}, in {case.pace_in}, out {case.pace_out}; "
        f"VISTA_SEED={case.seed} pytest tb/top/test_system_model.py -k {case.config.name}"
    )
    for what in ("in_clock", "out_clock", "words"):
        a, b = getattr(real, what), getattr(model, what)
        assert len(a) == len(b), f"{what}: RTL {len(a)}, model {len(b)}; {rerun}"
        wrong = np.flatnonzero(a != b)
        assert not len(wrong), (
            f"{what}: {len(wrong)} differ, the first at {wrong[0]}: RTL {a[wrong[0]]}, model {b[wrong[0]]}; "
            f"{rerun}"
        )
    assert real.stalls == model.stalls, f"stalls: RTL {real.stalls}, model {model.stalls}; {rerun}"
