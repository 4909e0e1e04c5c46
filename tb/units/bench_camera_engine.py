"""Two sensors with clocks of their own before the engine: pairs of one moment and place, and their words."""

import logging

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer
from cocotb_helpers import parameter, seeded
from cocotbext.axi import AxiLiteBus, AxiLiteMaster
from dvp_sensor import DROP_OUTS, Sensor, frame_clocks
from frames import random_pair, random_parameters
from raw_frames import RawFrame
from registers import CONTROL, ENABLE, ERRORS
from video import Ports

DEPTH = parameter("Depth")
SIDES = ("left", "right")
PIXEL_PS, CLOCK_PS = (10_000, 10_020), 6_400  # sensors that differ by 2 in 1,000
HEIGHT, WIDTH = 10, 32
MAX_SKEW = 32  # clocks of the engine
LATE_CLOCKS = 60  # of a sensor: more than that, and less than a line
INVALID = 0xFFFFFFF0
NOTHING = ("none", "none")


class Bench:
    """The sensors, what leaves as pairs, and the words; frame by frame."""

    def __init__(self, dut, random):
        self.dut, self.ports, self.random = dut, Ports(dut), random
        self.sensors = [Sensor(dut, side, random) for side in SIDES]
        self.pairs, self.words = [], []
        self.broken, self.refused = 0, [0, 0]
        self.taken, self.pause = 1.0, 1  # chance to take words, and how long a pause is

    async def start(self, frame):
        dut = self.dut
        logging.getLogger("cocotb.camera_engine").setLevel(logging.ERROR)
        registers = AxiLiteMaster(
            AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_ni, reset_active_level=False
        )
        for side in SIDES:
            for port in ("clk_i", "vsync_i", "href_i", "data_i", "rst_ni"):
                getattr(dut, f"{side}_{port}").value = 0
        dut.rst_ni.value, dut.m_axis_tready.value, dut.max_skew_i.value = 0, 0, MAX_SKEW
        await Timer(1, "ns")
        cocotb.start_soon(Clock(dut.clk_i, CLOCK_PS, "ps").start())
        for side, period in zip(SIDES, PIXEL_PS, strict=True):
            cocotb.start_soon(Clock(getattr(dut, f"{side}_clk_i"), period, "ps").start())
            await Timer(self.random.randrange(1, 9000), "ps")
        await ClockCycles(dut.clk_i, 16)
        await FallingEdge(dut.clk_i)
        dut.rst_ni.value = 1
        for side in SIDES:
            await FallingEdge(getattr(dut, f"{side}_clk_i"))
            getattr(dut, f"{side}_rst_ni").value = 1
        await registers.write_dword(CONTROL, ENABLE)
        for address, data in frame.writes():
            await registers.write_dword(address, data)
        cocotb.start_soon(self.watch())
        return registers

    async def watch(self):
        """Notes what leaves, and takes words or pauses."""
        ports = self.ports
        ready, paused = 0, 0
        while True:
            await FallingEdge(ports["clk_i"])
            self.broken += bool(ports["broken_o"].value)
            self.refused[0] += bool(ports["left_refused_o"].value)
            self.refused[1] += bool(ports["right_refused_o"].value)
            if ports["pair_valid_o"].value and ports["pair_ready_o"].value:
                if ports["pair_sof_o"].value:
                    self.pairs.append([])
                self.pairs[-1].append((int(ports["pair_data_o"].value), int(ports["pair_eol_o"].value)))
            if ready and ports["m_axis_tvalid"].value:
                # It is taken at the edge that follows; the ports do not change before.
                if ports["m_axis_tuser"].value:
                    self.words.append([])
                self.words[-1].append(int(ports["m_axis_tdata"].value))
            if ready and self.taken == 1.0:
                continue
            await Timer(CLOCK_PS * 3 // 4, "ps")  # behind the edge
            paused -= 1
            if paused < 0 and self.random.random() >= self.taken:
                paused = self.pause
            ready = int(paused <= 0)
            ports.drive(m_axis_tready=ready)

    async def moment(self, frame, what):
        """What leaves of a frame of each camera, and how often pairs broke off and frames were refused."""
        pairs, broken, refused = len(self.pairs), self.broken, list(self.refused)
        for sensor, image, one in zip(self.sensors, (frame.left, frame.right), what, strict=True):
            cocotb.start_soon(sensor.send(image, one, LATE_CLOCKS))
        await ClockCycles(self.dut.left_clk_i, frame_clocks(HEIGHT, WIDTH) + LATE_CLOCKS + 4 * MAX_SKEW)
        refused = [now - then for now, then in zip(self.refused, refused, strict=True)]
        return self.pairs[pairs:], self.broken - broken, refused


def drawn(random):
    rng = np.random.default_rng(random.randrange(1 << 30))
    parameters = random_parameters(rng, 16, 5)

    def frame():
        return RawFrame(*random_pair(rng, "shifted", HEIGHT, WIDTH), parameters, smooth=True)

    return frame


def beats(frame):
    data = frame.left.astype(int) | frame.right.astype(int) << 8
    return [(beat, int((i + 1) % WIDTH == 0)) for i, beat in enumerate(data.ravel().tolist())]


def joined(part, whole):
    """How many pixels were joined of a pair that broke off: all but the last one, whose end of line is wrong,
    or all up to the last column; None if others were."""
    came = len(part) - 1
    if part[:came] == whole[:came] and part[came][1] != whole[came][1]:
        return came
    return len(part) if part == whole[: len(part)] and len(part) % WIDTH == WIDTH - 1 else None


def check_words(bench, sent):
    """The words of whole pairs are those of the model; other pairs have those or none."""
    assert len(bench.words) in (len(sent), len(sent) - 1)
    for words, (frame, whole) in zip(bench.words, sent, strict=False):
        expected = frame.words().tolist()
        if whole:
            assert words == expected
        else:
            assert all(word in (one, INVALID) for word, one in zip(words, expected, strict=False))


@cocotb.test()
async def pairs_of_one_moment_leave(dut):
    random = seeded(dut)
    draw, bench = drawn(random), Bench(dut, random)
    registers = await bench.start(draw())
    failing = [(what, "none") for what in DROP_OUTS] + [("none", what) for what in DROP_OUTS]
    sent = []
    for what in [one for bad in random.sample(failing, len(failing)) for one in (bad, NOTHING)]:
        frame = draw()
        got, broken, refused = await bench.moment(frame, what)
        bad = {one for one in what if one != "none"}
        whole = beats(frame)
        if not bad:
            assert got == [whole] and refused == [0, 0], what
        elif bad & {"frame", "late"}:
            assert not got, what
            assert refused == ([1, 1] if "late" in bad else [int(one == "none") for one in what])
        else:
            (part,) = got
            came = joined(part, whole)
            assert came is not None and 0 < came < len(whole), what
            assert came % WIDTH == 0 or bad & {"short", "long"}
            assert refused == [0, 0]
        assert broken == bool(bad & {"line", "short", "long", "end"}), what
        sent += [(frame, not bad)] * len(got)
    await ClockCycles(dut.clk_i, 3000)
    assert await registers.read_dword(ERRORS), "a pair that broke off is a frame that was cut"
    check_words(bench, sent)


@cocotb.test()
async def pixels_that_are_lost_break_the_pair_off(dut):
    """Words that nobody takes for longer than the FIFOs hold: no pixel passes for another."""
    random = seeded(dut)
    draw, bench = drawn(random), Bench(dut, random)
    await bench.start(draw())
    frames = []
    for taken, pause in ((0.995, 120 * DEPTH), (1.0, 1)):
        bench.taken, bench.pause = taken, pause
        for _ in range(12):
            frames.append(draw())
            got, _, _ = await bench.moment(frames[-1], NOTHING)
        if taken == 1.0:
            assert got == [beats(frames[-1])], "the cameras recover"
    await ClockCycles(dut.clk_i, 3000)
    whole = [beats(frame) for frame in frames]
    sent = []
    for pair in bench.pairs:
        (at,) = [i for i, one in enumerate(whole) if pair == one or joined(pair, one) is not None]
        sent.append((frames[at], pair == whole[at]))
    assert any(not whole for _, whole in sent)
    check_words(bench, sent)
