"""Rectified and plain frames of any size, good and bad, at any pace, against the numpy model; maps, too."""

from __future__ import annotations

from dataclasses import dataclass, field

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter
from faults import Reaction
from frames import beats
from maps import random_grids, words_of
from verilated import USER
from video import (
    FEWEST,
    Frame,
    Segment,
    assert_frames,
    begun,
    broken,
    errors_of,
    hit,
    illegal_size,
    random_images,
    reset,
    started,
)
from vista_model import rectify, row_beyond
from vista_model.rectify import reach

MAX_WIDTH, ROWS, MAX_POINTS = (parameter(name) for name in ("MaxWidth", "NumRows", "MaxPoints"))
REACH = reach(ROWS)
BELOW = REACH + 1  # rows that must have come below the one that leaves
ALONG = ("width_o", "height_o", "side_o")
IDLE = ("map_begin_i", "map_write_i", "map_commit_i", "keep_map_i")
LARGEST = 2 * ROWS + 14  # rows of the largest frame
LATENCY = 34  # from the last pixel of the rows that are needed to the first of the row
VERDICTS = ("map_accepted_o", "map_refused_rows_o", "map_refused_size_o")
# Offered and taken, of what a clock may; the larger build differs in its buffers, not in its handshakes.
RATES = [(1.0, 1.0), (1.0, 0.4), (0.4, 1.0), (0.4, 0.4)] if ROWS == 16 else [(1.0, 0.4)]
WATCHED = (*VERDICTS, "error_map_o")
ACCEPTED, ROWS_REFUSED, SIZE_REFUSED = range(3)
BINS = ("accepted", "rows", "size")  # of the coverage plan, by verdict


@dataclass
class Load:
    """A map as it is written, and what has to come of it. Committed once so many frames were offered."""

    width: int
    height: int
    words: list[int]
    verdict: int
    after_offers: int = 0
    hasty: bool = False  # begun whether the bank is free or not


@dataclass
class MapSegment(Segment):
    """Video, and the maps that are loaded before it; the last good one of all is in force."""

    grids: np.ndarray | None = None  # of both cameras, in force
    loads: list[Load] = field(default_factory=list)
    loads_before: int = 0  # of all segments up to this one
    fits: bool = True

    def reaction(self, max_width: int, lost: bool) -> Reaction:
        """Video that no map fits is dropped, as while the block is disabled."""
        return super().reaction(max_width, lost) if self.fits else Reaction([], 0, True)


def good_load(grids, height, width):
    points = grids[0, ..., 0].size
    assert all(row_beyond(grid, ROWS) is None for grid in grids)
    return Load(width, height, words_of(grids), ACCEPTED if points <= MAX_POINTS else SIZE_REFUSED)


def bad_load(rng, height, width):
    """A map that must not be followed."""
    grids = random_grids(rng, ROWS, height, width)
    kind = rng.integers(3)
    if kind == 0 and grids[0, ..., 0].size <= MAX_POINTS:
        place = tuple(rng.integers(0, side) for side in grids.shape[:-1])
        grids[place][1] = rng.choice([-32 * REACH - 1, 32 * REACH + 32, -32768, 32767])
        return Load(width, height, words_of(grids), ROWS_REFUSED)
    words = words_of(grids)
    count = int(rng.choice([0, 1, len(words) - 1, len(words) // 2]))
    words = words[:count] if kind == 1 else [*words, words[0]]
    return Load(width, height, words, SIZE_REFUSED, hasty=bool(rng.integers(2)))


def sent(segment, frame):
    """What leaves of a frame of which so many pixels came."""
    width, height, came = segment.width, segment.height, len(frame.pixels)
    pair = np.zeros(width * height, np.int64)
    pair[:came] = frame.pixels
    planes = [(pair >> shift & 255).astype(np.uint8).reshape(height, width) for shift in (0, 8)]
    if segment.option:
        planes = [rectify(plane, grid) for plane, grid in zip(planes, segment.grids, strict=True)]
    pixels = (planes[0].astype(np.int64) | planes[1].astype(np.int64) << 8).ravel().tolist()
    whole = came == width * height
    if not whole:
        known = max(came // width - BELOW, 0) * width
        pixels = (pixels[:known] + [-1] * FEWEST)[: max(known, FEWEST)]
    return Frame(width, height, pixels, whole, side=segment.side)


def expected(segments):
    return [sent(segment, frame) for segment, frame in begun(segments, MAX_WIDTH)]


def offers_of(segment):
    """How many of its pixels begin a frame, whether it is taken or not."""
    return int((segment.stream & USER > 0).sum())


def random_segments(rng, kinds, images=random_images, widths=(4, 5, 15, 16, 17)):
    """Video with the maps that it needs, some bad ones between, frames that no map fits, illegal sizes."""
    segments: list[MapSegment] = []
    newest, offers = None, 0  # size and grids of the map in force
    for kind in kinds:
        width = int(rng.choice([*widths, MAX_WIDTH, rng.integers(4, MAX_WIDTH + 1)]))
        height = int(rng.choice([2, 3, BELOW, BELOW + 1, ROWS, rng.integers(2, LARGEST)]))
        on, loads = kind == "unfit" or (kind != "illegal" and bool(rng.random() < 0.8)), []
        if kind == "unfit":
            height = LARGEST  # which nothing else is
        elif kind != "illegal" and not on and rng.random() < 0.15:
            width, height = int(rng.integers(4, 7)), int(2 ** rng.uniform(7, 12))  # no map reaches so far
        elif newest and rng.random() < 0.3:
            height, width, _ = newest  # the map before it, again
        elif on:
            loads = [bad_load(rng, height, width) for _ in range(rng.integers(2))]
            grids = random_grids(rng, ROWS, height, width)
            loads.append(good_load(grids, height, width))
            if loads[-1].verdict == ACCEPTED:
                newest = height, width, grids
        fits = newest is not None and newest[:2] == (height, width)
        frames = [beats(*images(rng, height, width)) for _ in range(rng.integers(1, 4))]
        if kind == "faulty":
            frames = [broken(frame, width, rng) for frame in frames[:-1]] + frames[-1:]
        if kind == "illegal":
            width, height = illegal_size(rng, width, height, MAX_WIDTH)
        segment = MapSegment(
            width, height, np.concatenate(frames), kind != "disabled", int(on), int(rng.integers(256)),
            grids=newest[2] if fits else None, loads=loads, fits=fits or not on,
        )  # fmt: skip
        for load in loads:
            load.after_offers = offers
        segments.append(segment)
        segment.loads_before = sum(len(s.loads) for s in segments)
        offers += offers_of(segment)
    return segments


class Loader:
    """Writes maps at its own pace, while frames pass, and holds back the video that needs them."""

    def __init__(self, driver, loads, pace):
        self.driver, self.dice, self.ports, self.loads, self.pace = (
            driver, driver.dice, driver.ports, loads, pace
        )  # fmt: skip
        self.offers, self.done, self.unfit, self.verdicts = 0, 0, 0, []
        self.waiting = False

    async def clock(self):
        ports = self.ports
        if self.done < len(self.loads):
            await ReadOnly()
            offered = bool(ports["s_axis_tvalid"].value)
            self.offers += bool(offered and ports["s_axis_tuser"].value and not self.waiting)
            self.waiting = offered and not ports["s_axis_tready"].value
        await FallingEdge(ports["clk_i"])
        self.unfit += int(ports["error_map_o"].value)
        self.verdicts += [i for i, name in enumerate(VERDICTS) if ports[name].value]

    async def pause(self):
        while self.dice.random() > self.pace:
            await self.clock()

    async def run(self):
        ports = self.ports
        for load in self.loads:
            await self.pause()
            while not (load.hasty or ports["map_ready_o"].value):
                await self.clock()
            ports.drive(map_begin_i=1, map_width_i=load.width, map_height_i=load.height)
            await self.clock()
            ports.drive(map_begin_i=0)
            for word in load.words:
                ports.drive(map_write_i=1, map_data_i=word)
                await self.clock()
                ports.drive(map_write_i=0, map_data_i=self.dice.randrange(1 << 32))
                await self.pause()
            while self.offers < load.after_offers:
                await self.clock()
            await self.pause()
            video = ports["s_axis_tvalid"].value and ports["s_axis_tready"].value
            hit([f"map {BINS[load.verdict]} {'video' if video else 'quiet'}"])
            ports.drive(map_commit_i=1)
            await self.clock()
            ports.drive(map_commit_i=0)
            self.done += 1
        while True:
            await self.clock()
            await self.driver.awake.wait()


async def started_without_map(dut):
    driver, rng = await started(dut, "rectify_i", ALONG, IDLE)
    driver.wakes += WATCHED
    driver.patience = MAX_WIDTH * (LARGEST + 20)  # a frame that was cut at once is filled, and nothing leaves
    return driver, rng


async def run(driver, segments, offered, taken, pace=0.7):
    loader = Loader(driver, [load for s in segments for load in s.loads], pace)
    task = cocotb.start_soon(loader.run())
    driver.may_begin = lambda segment: loader.done >= segment.loads_before
    seen = await driver.run(segments, offered, taken)
    task.cancel()
    assert loader.verdicts == [load.verdict for load in loader.loads]
    return seen, loader


@cocotb.test()
@cocotb.parametrize((("offered", "taken"), RATES))
async def frames_and_maps_of_any_kind(dut, offered, taken):
    driver, rng = await started_without_map(dut)
    kinds = [*["good"] * 16, *["faulty"] * 14, "unfit", "unfit", "disabled", "illegal", "illegal"]
    rng.shuffle(kinds)
    segments = random_segments(rng, kinds)
    seen, loader = await run(driver, segments, offered, taken, float(rng.choice([1.0, 0.7])))
    frames = expected(segments)
    assert_frames(seen, frames)
    assert (seen.starts, seen.errors) == (len(frames), errors_of(segments, MAX_WIDTH))
    # A frame that no map fits is told of once for every start of frame.
    unfit = [s for s in segments if not s.fits and s.enable]
    assert loader.unfit == sum(int((s.stream >> 16 & 1).sum()) for s in unfit)
    hit(["map unfit"] * bool(loader.unfit))


@cocotb.test()
async def reset_inside_a_frame(dut):
    """What was on its way is gone, the map too."""
    driver, rng = await started_without_map(dut)
    for _ in range(8):
        segments = random_segments(rng, ["good"])
        stop = int(rng.integers(1, len(segments[0].stream)))
        loader = Loader(driver, segments[0].loads, 1.0)
        task = cocotb.start_soon(loader.run())
        driver.may_begin = lambda segment, loader=loader: loader.done >= segment.loads_before
        await driver.run(segments, 1.0, float(rng.choice([1.0, 0.3])), stop)
        task.cancel()
        await reset(dut, driver)
        assert not dut.m_axis_tvalid.value
        width, height = segments[0].width, segments[0].height
        before = MapSegment(width, height, segments[0].stream, option=1, fits=False)
        # Maps are loaded while that is dropped: one of its size would be for its last frames.
        after = random_segments(rng, ["good", "faulty", "good"])
        while any((load.width, load.height) == (width, height) for s in after for load in s.loads):
            after = random_segments(rng, ["good", "faulty", "good"])
        for segment in after:
            segment.loads_before = segment.loads_before if segment.loads else 0
            for load in segment.loads:
                load.after_offers += offers_of(before) * (load.after_offers > 0)
        seen, loader = await run(driver, [before, *after], 0.7, 0.7)
        assert_frames(seen, expected([before, *after]))
        assert loader.unfit >= 1


@cocotb.test()
async def one_pixel_per_clock(dut):
    """Frames of 21 columns and more follow each other without a gap, rectified or not."""
    driver, rng = await started_without_map(dut)
    for width, height in ((21, 2 * ROWS), (22, ROWS + 3), (33, BELOW), (MAX_WIDTH, 5), (MAX_WIDTH, 2 * ROWS)):
        frames = [beats(*random_images(rng, height, width)) for _ in range(6)]
        grids = random_grids(rng, ROWS, height, width)
        loads = [good_load(grids, height, width)]
        assert loads[0].verdict == ACCEPTED
        segments = [
            MapSegment(
                width,
                height,
                frame,
                option=int(i != 2),
                side=i,
                grids=grids,
                loads=loads * (i == 0),
                loads_before=1,
            )
            for i, frame in enumerate(frames)
        ]
        seen, _ = await run(driver, segments, 1.0, 1.0)
        assert_frames(seen, expected(segments))
        assert set(np.diff(seen.in_clock)) == {1}, "the input waited"
        assert set(np.diff(seen.out_clock)) == {1}, "the output had a gap"
        needed = min(BELOW + 1, height) * width - 1  # the last pixel that the first one waits for
        assert seen.out_clock[0] - seen.in_clock[needed] == LATENCY
