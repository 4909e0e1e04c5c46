"""Single bits of the engine's registers and memories that turn over while it runs, and what comes of each.

Five frames of one size, with one set of parameters, follow one another: without a pause, as video does, or
each after a soft reset and with its registers written anew, as a careful host does. A bit is turned over at a
random clock of the first three. What the engine sends is compared with what it has to send; if not even the
last frame is right, the host's remedies are tried, the mildest first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from frames import random_pair
from raw_frames import LEFT_BY_A_RESET, RawFrame, random_one, written
from registers import CONTROL, ENABLE, ERRORS, SOFT_RESET
from verilated import Cell, Config, Pace, Rtl

FRAMES = 5
HIT = 3  # frames that an upset can come in
TALLEST = 4096  # rows of a frame, and more words than that of one frame are not waited for

MASKED = "masked"
FRAME = "its frame"  # wrong are the frame that comes in, or the one that is leaving, or both
NEXT = "the next"  # and, or, the frame after
LATER = "later"  # gone by itself before the last frame
WRITTEN = "when written"  # stays until the host writes the registers and the map again
RESET = "after a reset"  # stays until the host resets the engine and writes them
NEVER = "never"
OUTCOMES = (MASKED, FRAME, NEXT, LATER, WRITTEN, RESET, NEVER)

PACES = [Pace(), Pace(300, 300), Pace(50, 20), Pace(700, 100)]

Words = npt.NDArray[np.uint64]  # with their flags above them


@dataclass(frozen=True)
class Scene:
    """Frames that follow one another, and all that has to come of them."""

    frames: list[RawFrame]
    words: list[Words]  # of each frame
    paces: tuple[Pace, Pace]
    restarts: bool  # the engine is reset, and its registers are written, before each frame


@dataclass(frozen=True)
class Flown:
    """What came of a scene."""

    right: list[bool]  # of each frame
    told: bool  # words are missing or too many, their framing is wrong, or ERRORS says so: the host knows
    begun: list[int]  # clocks from the start to the first pixel of each frame
    ended: int  # and to the last word


@dataclass(frozen=True)
class Upset:
    """What became of one upset."""

    cell: str
    memory: bool
    outcome: str
    wrong_frames: int
    told: bool
    late_frames: float  # the last word comes later by so many frames of undisturbed video


def framed(words: npt.NDArray[np.uint32], flags: npt.NDArray[np.uint8]) -> Words:
    return words.astype(np.uint64) | flags.astype(np.uint64) << np.uint64(32)


def random_scene(rng: np.random.Generator, config: Config, restarts: bool) -> Scene:
    first = random_one(rng, config)
    while first.left.shape[0] < 2 * config.block_size or first.left.shape[1] < config.max_width // 2:
        first = random_one(rng, config)
    parameters = replace(  # most pixels are matched, so that most errors show
        first.parameters,
        texture_threshold=int(rng.choice([0, 10])),
        uniqueness_ratio=int(rng.choice([0, 5, 15])),
    )
    pairs = [random_pair(rng, "shifted", *first.shape) for _ in range(FRAMES)]
    frames = [replace(first, left=left, right=right, parameters=parameters) for left, right in pairs]
    words = [framed(frame.words(), frame.flags()) for frame in frames]
    steady = rng.random() < 0.5
    paces = [Pace() if steady else PACES[rng.integers(len(PACES))] for _ in range(2)]
    return Scene(frames, words, (paces[0], paces[1]), restarts)


def quiet_clocks(config: Config) -> int:
    """Clocks without a transfer after which nothing more is waited for: what stood still was reset."""
    return 3 * (config.block_size + 8 + config.rows) * config.max_width


def prepare(rtl: Rtl, frame: RawFrame) -> None:
    """Makes the engine as it is at the start, its memories as well, which a reset leaves as they are."""
    rtl.renew()
    rtl.write(CONTROL, ENABLE)
    written(rtl, frame.writes())


def restart(rtl: Rtl, frame: RawFrame, load_map: bool) -> None:
    """Drops what is inside, takes the words that stay offered, and writes the registers."""
    rtl.write(CONTROL, ENABLE | SOFT_RESET)
    rtl.read(CONTROL)  # the response to a write comes before what it resets
    rtl.stream(np.zeros(0, np.uint32), LEFT_BY_A_RESET, quiet=10)
    written(rtl, frame.writes(load_map))


def fly(rtl: Rtl, scene: Scene, frames: slice = slice(None)) -> Flown:
    start = rtl.clock()
    if not scene.restarts:
        return fly_on(rtl, scene, frames, start)
    one_by_one = []
    for number in range(FRAMES)[frames]:
        restart(rtl, scene.frames[number], load_map=False)
        one_by_one.append(fly_on(rtl, scene, slice(number, number + 1), start))
    return Flown(
        [flown.right[0] for flown in one_by_one],
        any(flown.told for flown in one_by_one),
        [clock for flown in one_by_one for clock in flown.begun],
        one_by_one[-1].ended,
    )


def fly_on(rtl: Rtl, scene: Scene, frames: slice, start: int) -> Flown:
    """Streams without a pause. Of frames between wrong ones it cannot be told whether they are right."""
    pixels, words = scene.frames[frames], scene.words[frames]
    stream = np.concatenate([frame.stream for frame in pixels])
    expected = np.concatenate(words)
    most = len(expected) + TALLEST * rtl.config.max_width
    got = rtl.stream(stream, most, *scene.paces, quiet=quiet_clocks(rtl.config))
    all_words = framed(got.words, got.flags)
    first, last = right_ones(all_words, words)
    right = [n < first or n >= len(words) - last for n in range(len(words))]
    told = len(all_words) != len(expected) or bool(((all_words ^ expected) >> np.uint64(32)).any())
    told |= rtl.read(ERRORS) != 0
    begun = [int(clock) - start for clock in got.in_clock[:: pixels[0].left.size]]
    ended = int(got.out_clock[-1]) - start if len(got.out_clock) else 0
    return Flown(right, told, begun, ended)


def right_ones(got: Words, expected: list[Words]) -> tuple[int, int]:
    """How many frames are right from the first on, and how many up to the last."""
    counts = []
    for frames, back in ((expected, False), (expected[::-1], True)):
        right, taken = 0, 0
        for words in frames:
            end = len(got) - taken
            part = got[max(0, end - len(words)) : end] if back else got[taken : taken + len(words)]
            if not np.array_equal(part, words):
                break
            right, taken = right + 1, taken + len(words)
        counts.append(right)
    return counts[0], counts[1]


def remedy(rtl: Rtl, scene: Scene) -> str:
    """Tries what the host can do until a frame is right."""
    rtl.write(CONTROL, ENABLE)
    written(rtl, scene.frames[0].writes())
    if fly(rtl, scene, slice(0, 2)).right[1]:
        return WRITTEN
    restart(rtl, scene.frames[0], load_map=True)
    return RESET if fly(rtl, scene, slice(0, 2)).right[1] else NEVER


def random_cell(rtl: Rtl, rng: np.random.Generator, memory: bool) -> Cell:
    """A register or a memory, each by its number of bits."""
    cells = rtl.cells()
    bits = [c.entries * (c.bits - len(c.wired)) * ((c.entries > 1) == memory) for c in cells]
    weights = np.array(bits, float)
    return cells[int(rng.choice(len(cells), p=weights / weights.sum()))]


def upset(rtl: Rtl, scene: Scene, clean: Flown, rng: np.random.Generator, cell: Cell) -> Upset:
    """Turns over a random bit of a register or of a memory. clean: how the scene flies without."""
    prepare(rtl, scene.frames[0])
    clock = int(rng.integers(clean.begun[0], clean.begun[HIT]))
    rtl.upset(
        cell,
        int(rng.integers(cell.entries)),
        int(rng.choice(np.setdiff1d(np.arange(cell.bits), cell.wired))),
        clock - clean.begun[0] + 1,
    )
    flown = fly(rtl, scene)
    wrong = [number for number, right in enumerate(flown.right) if not right]
    if not wrong:
        outcome = MASKED
    elif wrong[-1] == FRAMES - 1:
        outcome = remedy(rtl, scene)
    else:
        frame = int(np.searchsorted(clean.begun, clock, "right")) - 1  # that came in
        outcome = FRAME if wrong[-1] <= frame else NEXT if wrong[-1] == frame + 1 else LATER
    late = (flown.ended - clean.ended) / (clean.begun[1] - clean.begun[0])
    return Upset(cell.name, cell.entries > 1, outcome, len(wrong), flown.told, round(late, 2))


def upsets(rtl: Rtl, seed: int, count: int, restarts: bool, of: Sequence[Cell] = ()) -> list[Upset]:
    """What becomes of so many upsets in a random scene: in these cells in turn, or in any, half
    of them in registers."""
    rng = np.random.default_rng(seed)
    scene = random_scene(rng, rtl.config, restarts)
    prepare(rtl, scene.frames[0])
    clean = fly(rtl, scene)
    assert all(clean.right) and not clean.told, f"seed {seed}"
    found = []
    for number in range(count):
        cell = of[number % len(of)] if of else random_cell(rtl, rng, bool(number % 2))
        found.append(upset(rtl, scene, clean, rng, cell))
    return found
