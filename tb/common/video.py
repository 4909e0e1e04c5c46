"""Video for the blocks before the engine: frames good and bad, what has to come of them, and a driver."""

from __future__ import annotations

import os
import random
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from cocotb.handle import SimHandleBase
from cocotb.simtime import get_sim_time
from cocotb.triggers import Event, FallingEdge, First, ReadOnly, RisingEdge, Timer
from cocotb_helpers import PERIOD_NS, parameter, seeded, start
from faults import EARLY_EOL, EARLY_SOF, LATE_EOL, LATE_SOF, SIZE, Reaction, Received, react
from frames import beats
from rtl_package import package_constant
from verilated import LAST, USER

MIN_WIDTH, MIN_HEIGHT = package_constant("MinWidth"), package_constant("MinHeight")
FEWEST = 3  # pixels of a frame that was cut
DOZE = 300  # clocks without a beat after which a run without further video only waits for one to leave
SIDE_W = 8  # of what goes along with a frame
ERRORS = {
    "error_early_eol_o": EARLY_EOL,
    "error_late_eol_o": LATE_EOL,
    "error_early_sof_o": EARLY_SOF,
    "error_late_sof_o": LATE_SOF,
    "error_size_o": SIZE,
}
Beats = npt.NDArray[np.uint32]
Images = Callable[[np.random.Generator, int, int], tuple[npt.NDArray[np.uint8], ...]]  # of height and width


@dataclass
class Segment:
    """Video under one setting. Its last frame is good, so none reaches into the next."""

    width: int
    height: int
    stream: Beats
    enable: bool = True
    option: int = 0  # smoothing on, number of levels
    side: int = 0
    setting: str = ""  # what the coverage plan calls the option, if that is not its number

    def reaction(self, max_width: int, lost: bool) -> Reaction:
        legal = MIN_WIDTH <= self.width <= max_width and self.height >= MIN_HEIGHT
        if self.enable and legal:
            return react(self.stream, self.width, self.height, lost)
        return Reaction([], SIZE if self.enable else 0, True)


@dataclass
class Frame:
    """A frame as it leaves: its pixels, and whether it ends as it should."""

    width: int
    height: int
    pixels: list[int]  # {right, left}; -1 is not prescribed
    whole: bool
    level: int = 0
    side: int = 0


Expected = Callable[[list[Segment]], list[Frame]]  # what has to leave


def broken(stream: Beats, width: int, rng: np.random.Generator) -> Beats:
    """One of the faults there are, or none."""
    at = int(rng.integers(1, min(len(stream), 6 if rng.random() < 0.2 else len(stream))))
    kind = rng.integers(8)
    if kind in (0, 1):  # an end of line too early, or missing
        stream[at if kind else at - at % width + width - 1] ^= LAST
    elif kind == 2:
        stream[at] ^= USER
    elif kind == 3:
        stream[0] &= ~np.uint32(USER)
    elif kind == 4:  # lost pixels, or the rest of the frame
        end = at + int(rng.integers(1, 2 * width)) if rng.random() < 0.5 else None
        stream = np.delete(stream, slice(at, end))
    elif kind == 5:
        stream = np.insert(stream, at, rng.integers(0, 65536, int(rng.integers(1, 2 * width)), np.uint32))
    elif kind == 6:  # more rows than there should be
        stream = np.concatenate([stream, stream[width : 2 * width]])
    return stream


def random_images(rng: np.random.Generator, height: int, width: int) -> tuple[npt.NDArray[np.uint8], ...]:
    """Noise, or extremes only: sums at both ends of their range."""
    if rng.integers(3) == 0:
        return tuple((rng.integers(0, 2, (2, height, width)) * 255).astype(np.uint8))
    return tuple(rng.integers(0, 256, (2, height, width), np.uint8))


def illegal_size(rng: np.random.Generator, width: int, height: int, max_width: int) -> tuple[int, int]:
    """A size that no block takes, of one side or of both."""
    return [(3, height), (max_width + 1, height), (width, 1), (0, 0)][rng.integers(4)]


def random_segment(
    rng: np.random.Generator, kind: str, max_width: int, options: int, images: Images = random_images
) -> Segment:
    """kind: good, faulty, illegal or disabled; options: settings there are."""
    width = int(rng.choice([MIN_WIDTH, 5, 6, 7, max_width, rng.integers(MIN_WIDTH, max_width + 1)]))
    height = int(rng.choice([MIN_HEIGHT, 3, 4, 5, rng.integers(MIN_HEIGHT, 20)]))
    frames = [beats(*images(rng, height, width)) for _ in range(rng.integers(1, 5))]
    if kind == "faulty":
        frames = [broken(frame, width, rng) for frame in frames[:-1]] + frames[-1:]
    if kind == "illegal":
        width, height = illegal_size(rng, width, height, max_width)
    return Segment(
        width, height, np.concatenate(frames), kind != "disabled", int(rng.integers(options)),
        int(rng.integers(1 << SIDE_W)),
    )  # fmt: skip


def begun(segments: list[Segment], max_width: int) -> Iterator[tuple[Segment, Received]]:
    lost = True
    for segment in segments:
        outcome = segment.reaction(max_width, lost)
        lost = outcome.lost
        yield from ((segment, frame) for frame in outcome.frames)


def errors_of(segments: list[Segment], max_width: int) -> int:
    lost, errors = True, 0
    for segment in segments:
        outcome = segment.reaction(max_width, lost)
        lost, errors = outcome.lost, errors | outcome.errors
    return errors


def bins_of(segments: list[Segment], max_width: int, offered: float, taken: float) -> set[str]:
    """What of the coverage plan (doc/design/verification.md) a run has hit."""
    bins = set()
    paces = ["always" if pace == 1.0 else "pauses" for pace in (offered, taken)]
    for segment, frame in begun(segments, max_width):
        width = {MIN_WIDTH: "smallest", max_width: "widest"}.get(segment.width) or ("even", "odd")[
            segment.width % 2
        ]
        height = "smallest" if segment.height == MIN_HEIGHT else ("even", "odd")[segment.height % 2]
        count = len(frame.pixels)
        end = (
            "whole"
            if frame.whole
            else "first"
            if count < FEWEST
            else "top"
            if count <= segment.width
            else "cut"
        )
        bins |= {
            f"size {width} {height}",
            f"end {end} {segment.setting or segment.option}",
            f"pace {' '.join(paces)} {end}",
        }
    return bins


def hit(bins: Iterable[str]) -> None:
    """Tells rtl/flow/coverage_front_end.py, if it asks, of bins that a run has hit."""
    if file := os.environ.get("VISTA_BINS"):
        with Path(file).open("a") as out:
            out.writelines(f"{name}\n" for name in bins)


def filtered(
    frame: Frame,
    function: Callable[[npt.NDArray[np.uint8]], npt.NDArray[np.uint8]],
    step: int,
    level: int = 0,
) -> Frame:
    """What a filter makes of a frame: pixel (x, y) of the result needs (step x + step, step y + step).

    A frame that was cut is filled up to a few pixels, with which one of no more is whole."""
    width, height, count = frame.width, frame.height, len(frame.pixels)
    pair = np.zeros(width * height, np.int64)
    pair[:count] = np.maximum(frame.pixels, 0)
    pair = pair.reshape(height, width)
    left, right = (function(plane.astype(np.uint8)).astype(np.int64) for plane in (pair & 255, pair >> 8))
    out_height, out_width = left.shape
    y, x = np.indices(left.shape)
    needed = (step * y + step) * width + np.minimum(step * x + step, width - 1)
    came = (needed < count) & (step * y + step < height) | frame.whole
    pixels = np.where(came, left | right << 8, -1).ravel()
    sent = len(pixels) if frame.whole else min(max(int(came.sum()), FEWEST), len(pixels))
    return Frame(out_width, out_height, pixels[:sent].tolist(), sent == len(pixels), level, frame.side)


def guarded(segment: Segment, received: Received) -> Frame:
    """A frame as vista_frame_guard lets it pass."""
    pixels = received.pixels + [-1] * (FEWEST - len(received.pixels))
    return Frame(segment.width, segment.height, pixels, received.whole, side=segment.side)


def sent_beats(frame: Frame) -> list[tuple[int, bool, bool]]:
    """(pixel, start of frame, end of line); the last beat of a cut frame has its end of line wrong."""
    last = len(frame.pixels) - 1
    return [
        (pixel, i == 0, (i % frame.width == frame.width - 1) ^ (i == last and not frame.whole))
        for i, pixel in enumerate(frame.pixels)
    ]


@dataclass
class Memory:
    """The buffer beside the pyramid, of so many beats; it takes and gives at random."""

    size: int
    beats: deque[int] = field(default_factory=deque)
    stored: list[int] = field(default_factory=list)  # all that came, in order
    left: list[int] = field(default_factory=list)  # of the smaller levels, at the output


def memory_for(segments: list[Segment]) -> Memory:
    """Makes a memory as large as the largest level 1 and no larger."""
    return Memory(max((s.width + 1) // 2 * ((s.height + 1) // 2) for s in segments))


@dataclass
class Seen:
    """What came out, and when."""

    beats: list[tuple[int, bool, bool]] = field(default_factory=list)
    frames: list[dict[str, int]] = field(default_factory=list)  # what goes along with each
    starts: int = 0
    errors: int = 0
    follows: int = 0  # clocks in which a level began that a smaller one follows
    in_clock: list[int] = field(default_factory=list)
    out_clock: list[int] = field(default_factory=list)


class Ports(dict[str, SimHandleBase]):
    """The ports of a module by name. Each is looked up once, and written when it changes: both take long."""

    def __init__(self, dut: SimHandleBase) -> None:
        self.dut, self.driven = dut, dict[str, int]()

    def __missing__(self, name: str) -> SimHandleBase:
        self[name] = getattr(self.dut, name)
        return self[name]

    def drive(self, **values: int) -> None:
        for name, value in values.items():
            if self.driven.get(name) != value:
                self[name].value = self.driven[name] = value


class Driver:
    """Offers segments at s_axis and takes at m_axis, at any pace; watches the rules of the bus."""

    def __init__(self, dut: SimHandleBase, dice: random.Random, option: str, along: tuple[str, ...]) -> None:
        self.dut, self.dice, self.option, self.along = dut, dice, option, along
        self.ports = Ports(dut)
        names = ("width_i", "height_i", "enable_i", "side_i", option)
        self.settings = {name: len(getattr(dut, name)) for name in names if name and hasattr(dut, name)}
        self.max_width = parameter("MaxWidth")
        self.memory: Memory | None = None  # of the run, if there are ports for it
        self.tells_levels = hasattr(dut, "level_follows_o")
        self.patience = 400  # clocks without a beat before it is over, at full pace
        self.may_begin: Callable[[Segment], bool] = lambda segment: True
        self.clock = 0
        self.waiting: tuple[int, ...] | None = None
        self.fetching = False
        self.awake = Event()
        self.awake.set()
        self.wakes: tuple[str, ...] = ("m_axis_tvalid",)  # ports that end a doze when they rise
        if hasattr(dut, "store_axis_tready"):
            self.wakes += ("store_axis_tvalid",)

    def set_up(self, segment: Segment) -> None:
        settings = {
            "width_i": segment.width, "height_i": segment.height, "enable_i": int(segment.enable),
            "side_i": segment.side, self.option: segment.option,
        }  # fmt: skip
        self.ports.drive(**{name: settings[name] for name in self.settings})

    def distract(self) -> None:
        """Sets anything: no frame has what is set in another clock than that of its first pixel's offer."""
        self.ports.drive(**{name: self.dice.getrandbits(bits) for name, bits in self.settings.items()})

    async def run(
        self, segments: list[Segment], offered: float, taken: float, stop_after: int | None = None
    ) -> Seen:
        """Runs until nothing has moved for long, or so many beats were taken."""
        ports, dice, seen = self.ports, self.dice, Seen()
        if "store_axis_tvalid" in self.wakes:
            self.memory = memory_for(segments)
        stream = np.concatenate([s.stream for s in segments]).tolist()
        places = np.cumsum([0, *(len(s.stream) for s in segments[:-1])]).tolist()
        firsts = dict(zip(places, segments, strict=True))
        position, offering, idle, current = 0, False, 0, segments[0]
        # Nothing moves while the rest of a frame that was cut is filled in.
        filling = max(min(s.width, self.max_width) * s.height for s in segments)
        quiet = self.patience / min(offered, taken) + filling
        latest = self.clock + (40 * len(stream) + 2000) / min(offered, taken) + quiet
        while idle < quiet and (stop_after is None or position < stop_after):
            if not offering and position < len(stream):
                first = firsts.get(position)
                offering = dice.random() < offered and (first is None or self.may_begin(first))
                current = first if offering and first is not None else current
                if offering:
                    self.set_up(current)
                else:
                    self.distract()
            else:
                self.distract()
            beat = stream[position] if offering else dice.randrange(1 << 16) | USER | LAST
            ready = dice.random() < taken
            ports.drive(
                s_axis_tvalid=offering, s_axis_tdata=beat & 0xFFFF, s_axis_tuser=bool(beat & USER),
                s_axis_tlast=bool(beat & LAST), m_axis_tready=ready,
            )  # fmt: skip
            self._offer_memory(taken)
            await ReadOnly()
            if offering and ports["s_axis_tready"].value:
                position, offering, idle = position + 1, False, 0
                seen.in_clock.append(self.clock)
            idle += 1
            if self._take(ready, seen):
                idle = 0
            self._move_memory()
            seen.starts += int(ports["frame_start_o"].value)
            for name, bit in ERRORS.items():
                seen.errors |= bit if ports[name].value else 0
            if self.tells_levels:
                seen.follows += int(ports["level_follows_o"].value)
            await FallingEdge(ports["clk_i"])
            self.clock += 1
            assert self.clock < latest, "it does not end"
            if idle >= DOZE and position == len(stream) and self.waiting is None:
                idle += await self._doze(round(quiet - idle))
        ports.drive(s_axis_tvalid=0)
        if stop_after is None:
            hit(bins_of(segments, self.max_width, offered, taken))
            assert position == len(stream), "the input hung"
            assert not (self.memory and self.memory.beats), "a frame left something behind"
        if self.memory is not None:  # also marks that the pyramid does not look at when they come back
            stored = self.memory.stored[: len(self.memory.left)]
            assert self.memory.left == stored, "a level left other than it was stored"
        return seen

    async def _doze(self, most: int) -> int:
        """Waits until something comes, or so many clocks, with nothing to drive; the clocks that it took."""
        ports = [self.ports[name] for name in self.wakes]
        if most < 1 or (self.memory and self.memory.beats) or any(port.value for port in ports):
            return 0
        self.ports.drive(s_axis_tvalid=0, m_axis_tready=1)
        before = get_sim_time("ns")
        self.awake.clear()
        await First(Timer(most * PERIOD_NS, "ns"), *(RisingEdge(port) for port in ports))
        self.awake.set()
        await FallingEdge(self.ports["clk_i"])
        clocks = round((get_sim_time("ns") - before) / PERIOD_NS)
        self.clock += clocks
        return clocks

    def _take(self, ready: bool, seen: Seen) -> bool:
        ports = self.ports
        if not ports["m_axis_tvalid"].value:
            assert self.waiting is None, "a waiting beat vanished"
            return False
        beat = tuple(int(ports[f"m_axis_{name}"].value) for name in ("tdata", "tuser", "tlast"))
        along = {name: int(ports[name].value) for name in self.along}
        assert self.waiting in (None, (*beat, *along.values())), "a waiting beat changed"
        self.waiting = None if ready else (*beat, *along.values())
        if ready:
            seen.beats.append((beat[0], bool(beat[1]), bool(beat[2])))
            seen.out_clock.append(self.clock)
            if beat[1]:
                seen.frames.append(along)
            assert along == seen.frames[-1], "what goes along changed inside a frame"
            if self.memory is not None and along.get("level_o"):
                self.memory.left.append(beat[0] | USER * beat[1] | LAST * beat[2])
        return ready

    def _offer_memory(self, pace: float) -> None:
        if (memory := self.memory) is None:
            return
        dice = self.dice
        room = len(memory.beats) < memory.size
        taking = room and dice.random() < pace
        self.fetching = bool(memory.beats) and (self.fetching or dice.random() < pace)
        beat = memory.beats[0] if self.fetching else dice.randrange(1 << 18)
        self.ports.drive(
            store_axis_tready=taking, fetch_axis_tvalid=self.fetching, fetch_axis_tdata=beat & 0xFFFF,
            fetch_axis_tuser=bool(beat & USER), fetch_axis_tlast=bool(beat & LAST),
        )  # fmt: skip

    def _move_memory(self) -> None:
        if (memory := self.memory) is None:
            return
        ports = self.ports
        if self.fetching and ports["fetch_axis_tready"].value:
            memory.beats.popleft()
            self.fetching = False
        if ports.driven["store_axis_tready"] and ports["store_axis_tvalid"].value:
            beat = int(ports["store_axis_tdata"].value)
            beat |= USER * int(ports["store_axis_tuser"].value) | LAST * int(ports["store_axis_tlast"].value)
            memory.beats.append(beat)
            memory.stored.append(beat)


async def started(
    dut: SimHandleBase, option: str = "", along: tuple[str, ...] = (), idle: tuple[str, ...] = ()
) -> tuple[Driver, np.random.Generator]:
    """A driver, once the module is out of reset with nothing offered.

    option: the port that takes the option of a segment; idle: further inputs that start with 0."""
    dice = seeded(dut)
    names = ["s_axis_tvalid", "m_axis_tready", "enable_i", "width_i", "height_i", *idle]
    there = ["side_i", "store_axis_tready", "fetch_axis_tvalid"]
    names += [name for name in [option, *there] if name and hasattr(dut, name)]
    await start(dut, **dict.fromkeys(names, 0))
    return Driver(dut, dice, option, along), np.random.default_rng(dice.randrange(1 << 30))


async def reset(dut: SimHandleBase, driver: Driver) -> None:
    dut.rst_ni.value = 0
    for _ in range(3):
        await FallingEdge(dut.clk_i)
    dut.rst_ni.value = 1
    driver.waiting, driver.fetching = None, False


def assert_frames(seen: Seen, frames: list[Frame]) -> None:
    """What goes along with a frame at NAME_o is its attribute NAME."""
    expected = [beat for frame in frames for beat in sent_beats(frame)]
    assert [beat[1:] for beat in seen.beats] == [beat[1:] for beat in expected], "framing"
    for i, (got, wanted) in enumerate(zip(seen.beats, expected, strict=True)):
        assert wanted[0] in (-1, got[0]), f"beat {i}: {got[0]:04x} instead of {wanted[0]:04x}"
    for along, frame in zip(seen.frames, frames, strict=True):
        assert along == {name: getattr(frame, name.removesuffix("_o")) for name in along}


async def check_frames_of_any_kind(
    driver: Driver, rng: np.random.Generator, options: int, expected: Expected, offered: float, taken: float
) -> None:
    """Sound and faulty video, of illegal size and disabled, in any order."""
    kinds = [*["good"] * 6, *["faulty"] * 10, "illegal", "disabled"]
    rng.shuffle(kinds)
    segments = [random_segment(rng, kind, driver.max_width, options) for kind in kinds]
    seen = await driver.run(segments, offered, taken)
    frames = expected(segments)
    assert_frames(seen, frames)
    starts = sum(frame.level == 0 for frame in frames)
    assert (seen.starts, seen.errors) == (starts, errors_of(segments, driver.max_width))
    assert not driver.tells_levels or seen.follows == len(frames) - starts


async def check_reset_inside_a_frame(
    driver: Driver, rng: np.random.Generator, options: int, expected: Expected
) -> None:
    """Nothing is left of it. What comes of it after the reset is dropped, and the next frame is right."""
    for _ in range(12):
        before, after = (random_segment(rng, "good", driver.max_width, options) for _ in range(2))
        stop = int(rng.integers(1, len(before.stream)))
        await driver.run([before], 1.0, float(rng.choice([1.0, 0.3])), stop)
        await reset(driver.dut, driver)
        assert not driver.dut.m_axis_tvalid.value
        rest = before.stream[stop : stop + stop % before.width]
        rest = rest[: int(np.argmax(rest >> 16 & 1))] if (rest >> 16 & 1).any() else rest
        after.stream = np.concatenate([rest, after.stream])
        seen = await driver.run([after], 0.7, 0.7)
        assert not seen.errors
        assert_frames(seen, expected([after]))
