"""The loop of a live run: frames that are late, doubled or of another flight, and cameras that fail."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
from live_source import ListedShots, frames_of
from vista import parameters
from vista.chain import Chain, finish, make_chain, take
from vista.detector import Novelty
from vista.errors import InputError
from vista.history import StageClock
from vista.live.loop import LiveLoop, Seen
from vista.live.source import Shot
from vista.pipeline import copied_image
from vista.sequence import Frame, open_sequence

pytestmark = pytest.mark.slow


class Notebook:
    def __init__(self, duration_s: float = 0.0) -> None:
        self.seen: list[Seen] = []
        self._duration_s = duration_s

    def take(self, seen: Seen) -> None:
        self.seen.append(seen)
        time.sleep(self._duration_s)


@pytest.fixture
def flight(tmp_path: Path) -> tuple[Chain, list[Frame]]:
    recorded = open_sequence(cases.make_flown_pairs(tmp_path / "flight", 8))
    return make_chain(recorded, "golden", parameters.defaults(), 1, every_pair=False), frames_of(recorded)


def run(chain: Chain, source: ListedShots, notebook: Notebook, waits: bool = True) -> LiveLoop:
    """waits: the camera does, for the loop."""
    loop = LiveLoop(chain, source)
    if waits:
        source.totals = loop.totals
    loop.run([notebook], lambda: False)
    return loop


def indices(notebook: Notebook) -> list[int]:
    return [seen.record.index for seen in notebook.seen]


def shots_of(frames: list[Frame]) -> list[Shot]:
    return [Shot(frame, 0) for frame in frames]


def test_every_frame_is_processed_when_there_is_time(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    notebook = Notebook()
    loop = run(chain, ListedShots(shots_of(frames)), notebook)
    assert indices(notebook) == list(range(8))
    assert (loop.totals.processed, loop.totals.dropped, loop.totals.duplicates) == (8, 0, 0)


def test_a_loop_that_falls_behind_takes_the_newest(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    notebook = Notebook(duration_s=0.3)
    loop = run(chain, ListedShots(shots_of(frames), 0.02), notebook, waits=False)
    assert indices(notebook)[-1] == 7  # the newest is never lost
    assert loop.totals.processed == len(notebook.seen) < 8
    assert loop.totals.processed + loop.totals.dropped == 8


def test_a_frame_that_comes_again_says_nothing_new(flight: tuple[Chain, list[Frame]]) -> None:
    """It has a new time as from a camera that hangs, and the old one as from a recorder that stutters."""
    chain, frames = flight
    later = replace(frames[0], t_ns=frames[0].t_ns + 10_000_000)
    doubled = [frames[0], later, frames[1], frames[1], frames[2]]
    notebook = Notebook()
    loop = run(chain, ListedShots(shots_of(doubled)), notebook)
    assert indices(notebook) == [0, 1, 2]
    assert loop.totals.duplicates == 2


def test_a_clock_that_goes_back_begins_another_flight(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    back = [replace(frame, t_ns=frame.t_ns - 5 * 10**9) for frame in frames[4:]]
    notebook = Notebook()
    loop = run(chain, ListedShots(shots_of(frames[:4] + back)), notebook)
    assert indices(notebook) == list(range(8))
    assert loop.totals.restarts == 1


def test_a_clock_that_leaps_forward_is_survived(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    ahead = [replace(frame, t_ns=frame.t_ns + 3600 * 10**9) for frame in frames[4:]]
    notebook = Notebook()
    run(chain, ListedShots(shots_of(frames[:4] + ahead)), notebook)
    assert indices(notebook) == list(range(8))


def test_another_flight_forgets_the_tracks_of_the_one_before(tmp_path: Path) -> None:
    recorded = open_sequence(cases.make_board_scenes(tmp_path / "board", 6, stills=False))
    # Noise, without which every frame would be a duplicate.
    frames = [replace(f, left=f.left + (f.index % 2)) for f in frames_of(recorded)]
    again = [replace(f, t_ns=f.t_ns + 10**10, index=f.index + 6) for f in frames]
    shots = shots_of(frames) + [replace(s, continues=k > 0) for k, s in enumerate(shots_of(again))]
    notebook = Notebook()
    loop = run(
        make_chain(recorded, "golden", parameters.defaults(), 1, every_pair=False),
        ListedShots(shots),
        notebook,
    )
    confirmed = [any(o.confirmed for o in seen.record.obstacles) for seen in notebook.seen]
    assert loop.totals.restarts == 1
    assert confirmed[5] and not confirmed[6] and confirmed[11]


def test_what_was_not_kept_is_gone_with_the_next_frame(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    steps = []
    for frame in frames[:3]:
        assert take(chain, frame) == Novelty.NEW
        steps.append(finish(chain, frame, StageClock()))
        if len(steps) == 1:
            steps[0].keep()
    kept, lost, current = steps
    for step, frame in ((kept, frames[0]), (current, frames[2])):
        rectified = chain.rectifier.rectify(frame)
        np.testing.assert_array_equal(step.frame.left, rectified.left)
        np.testing.assert_array_equal(step.frame.right, rectified.right)
        words = list(chain.engine.levels(rectified.left, rectified.right))
        for own, expected in zip(step.pair.levels, words, strict=True):
            np.testing.assert_array_equal(own, expected)
        assert step.result.region_of_pixel.max() + 1 <= len(step.result.verdict_of_region)
    for asked in (lambda: lost.frame, lambda: lost.pair.levels, lambda: lost.result.words):
        with pytest.raises(RuntimeError, match="next"):
            asked()


def test_nothing_is_copied_that_nobody_asks_for(
    flight: tuple[Chain, list[Frame]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """But the first pair, whose features are matched."""
    chain, frames = flight
    copies: list[tuple[int, ...]] = []

    def counted(ffi: Any, pointer: Any, dtype: Any, shape: tuple[int, ...]) -> Any:
        copies.append(shape)
        return copied_image(ffi, pointer, dtype, shape)

    for module in ("detector", "pipeline"):
        monkeypatch.setattr(f"vista.{module}.copied_image", counted)
    run(chain, ListedShots(shots_of(frames)), Notebook())
    assert copies == 2 * [frames[0].left.shape]


def test_images_may_be_columns_of_larger_ones(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    wide = np.stack([frames[0].left, frames[0].right], axis=2)
    for frame in (replace(frames[0], left=wide[..., 0], right=wide[..., 1]), frames[1]):
        assert take(chain, frame) == Novelty.NEW
        pair, rectified = chain.detector.pair(), chain.rectifier.rectify(frame)
        np.testing.assert_array_equal(pair.left, rectified.left)
        np.testing.assert_array_equal(pair.right, rectified.right)


def test_words_of_other_levels_are_refused(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    assert take(chain, frames[0]) == Novelty.NEW
    words = list(chain.engine.levels(frames[0].left, frames[0].right))
    for given in (words[:-1], [*words, words[-1]]):
        with pytest.raises(ValueError, match="levels"):
            chain.detector.match(given)
    with pytest.raises(ValueError, match="size"):
        chain.detector.match([words[0][1:], *words[1:]])
    chain.detector.match(words)


def test_a_camera_that_fails_ends_the_run_after_its_last_frame(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    notebook = Notebook()
    source = ListedShots(shots_of(frames[:2]), error=InputError("/dev/video0", "was unplugged"))
    with pytest.raises(InputError, match="was unplugged"):
        run(chain, source, notebook)
    assert indices(notebook) == [0, 1]


def test_an_interruption_ends_it_soon(flight: tuple[Chain, list[Frame]]) -> None:
    chain, frames = flight
    start = time.monotonic()
    loop = LiveLoop(chain, ListedShots(shots_of(frames), 60.0))
    loop.run([], lambda: time.monotonic() - start > 0.2)
    assert time.monotonic() - start < 20.0
