"""The parts of a live run: the queue of one, the histogram of latencies, and a recording that is played."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest
import sequence_cases as cases
from random_seed import seeded
from vista.errors import InputError
from vista.live.latency import Latencies
from vista.live.latest import Latest
from vista.live.source import Replay, Shot
from vista.sequence import open_sequence

pytestmark = pytest.mark.slow


def test_the_newest_item_is_taken_and_older_ones_are_counted() -> None:
    queue: Latest[int] = Latest()
    for item in range(5):
        queue.put(item)
    assert (queue.take(0.0), queue.dropped) == (4, 4)
    assert queue.take(0.01) is None and not queue.ended
    queue.put(7)
    queue.close()
    assert not queue.ended  # the last one is still to be had
    assert queue.take(10.0) == 7 and queue.ended
    assert queue.take(10.0) is None  # and nobody waits for more


def test_an_error_comes_after_the_last_item() -> None:
    queue: Latest[int] = Latest()
    queue.put(1)
    queue.close(InputError("camera", "has gone"))
    assert not queue.ended and queue.take(0.0) == 1
    with pytest.raises(InputError, match="has gone"):
        _ = queue.ended


def test_a_waiting_taker_is_woken() -> None:
    queue: Latest[str] = Latest()
    thread = Thread(target=lambda: (time.sleep(0.05), queue.put("frame")))
    thread.start()
    assert queue.take(60.0) == "frame"
    thread.join()


def test_percentiles_are_those_of_numpy() -> None:
    rng = seeded(80)
    values_ms = np.exp(rng.normal(3.0, 1.0, 5000))
    latencies = Latencies()
    assert latencies.percentile_ms(50.0) == 0.0
    for value_ms in values_ms:
        latencies.add(float(value_ms))
    for percent in (1.0, 50.0, 99.0):
        exact_ms = np.percentile(values_ms, percent, method="inverted_cdf")
        assert abs(latencies.percentile_ms(percent) / exact_ms - 1.0) < 0.011
    assert latencies.percentile_ms(100.0) <= latencies.most_ms == values_ms.max()


@pytest.mark.parametrize("latency_ms", [0.0, -5.0, 1e9])
def test_latencies_beyond_the_bins_count(latency_ms: float) -> None:
    latencies = Latencies()
    latencies.add(latency_ms)
    assert "ms" in latencies.summary() and latencies.last_ms == latency_ms


def play(folder: Path, stopped: Event | None = None, **options: float) -> list[tuple[Shot, int]]:
    recorded = open_sequence(folder)
    shots = Replay(recorded, recorded.frames, **options).shots(stopped or Event())
    return [(shot, time.monotonic_ns()) for shot in shots]


def test_each_frame_is_played_at_its_moment(tmp_path: Path) -> None:
    played = play(cases.make_flown_pairs(tmp_path / "flight"), speed=2.0)
    assert [shot.frame.index for shot, _ in played] == [0, 1, 2, 3]
    assert [shot.continues for shot, _ in played] == [True] * 4
    start_ns = played[0][0].exposed_ns
    assert [shot.exposed_ns - start_ns for shot, _ in played] == [0, 50_000_000, 100_000_000, 150_000_000]
    assert all(now_ns >= shot.exposed_ns for shot, now_ns in played)  # never before its time


def test_frames_that_cannot_be_read_in_time_are_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorded = open_sequence(cases.make_flown_pairs(tmp_path / "flight", 12))
    read = type(recorded).read

    def slow(self, files):
        time.sleep(0.05)
        return read(self, files)

    monkeypatch.setattr(type(recorded), "read", slow)
    source = Replay(recorded, recorded.frames, speed=10.0)  # a period of 10 ms
    shots = list(source.shots(Event()))
    assert source.skipped > 0 and len(shots) + source.skipped == 12
    assert shots[-1].frame.index == 11


def test_a_recording_that_repeats_goes_on_in_time(tmp_path: Path) -> None:
    recorded = open_sequence(cases.make_flown_pairs(tmp_path / "flight"))
    stopped, shots = Event(), []
    for shot in Replay(recorded, recorded.frames, speed=100.0, repeat=True).shots(stopped):
        shots.append(shot)
        if len(shots) >= 9:
            stopped.set()
    times_ns = [shot.frame.t_ns for shot in shots]
    assert times_ns == sorted(set(times_ns))
    exposed_ns = [shot.exposed_ns for shot in shots]
    assert exposed_ns == sorted(set(exposed_ns))
    anew = [k for k, shot in enumerate(shots) if not shot.continues]
    assert anew and all(shots[k].frame.index <= shots[k - 1].frame.index for k in anew)


def test_poses_that_begin_anew_do_not_continue_though_their_frame_is_skipped(tmp_path: Path) -> None:
    recorded = open_sequence(cases.make_flown_pairs(tmp_path / "flight", 8))
    frames = [replace(files, anew=files.index == 4) for files in recorded.frames]
    frames[4:7] = [replace(files, t_ns=frames[3].t_ns + k) for k, files in enumerate(frames[4:7], start=1)]
    shots = list(Replay(recorded, frames).shots(Event()))
    shown = [shot.frame.index for shot in shots]
    assert 4 not in shown  # it gave way to those of the same moment
    first = next(index for index in shown if index > 4)
    assert [shot.frame.index for shot in shots if not shot.continues] == [first]


def test_a_stop_ends_the_wait_for_a_frame(tmp_path: Path) -> None:
    stopped = Event()
    Thread(target=lambda: (time.sleep(0.1), stopped.set())).start()
    start = time.monotonic()
    assert len(play(cases.make_flown_pairs(tmp_path / "flight"), stopped, speed=0.01)) == 1
    assert time.monotonic() - start < 5.0  # the next would come after 10 s
