"""Rows of the segmentation's table, from scores made up."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import flight_on_disk as disk
import pytest
from vista import parameters
from vista_eval.metrics import flight_segmentation
from vista_eval.metrics.flight_segmentation import (
    COMPARED,
    FlightSegmentation,
    pool,
    rows,
    segment_cached,
)
from vista_eval.metrics.scenes import CUT
from vista_eval.metrics.segmentation import PartitionScore, Thing, ThingScore


def partition(*ious: float) -> PartitionScore:
    thing = Thing(2, "sign", "sign", 30.0, 500)
    return PartitionScore(tuple(ThingScore(thing, iou, iou, iou) for iou in ious), 0.1, 7)


def flight(name: str, split: str, cut: tuple[float, ...], reference: tuple[float, ...]) -> FlightSegmentation:
    scores = {CUT: partition(*cut)} | {name: partition(*reference) for name in COMPARED}
    return FlightSegmentation(name, split, 1, scores)


def test_rows_by_hand() -> None:
    flights = [
        flight("a", "test", (0.6, 0.8, 1.0), (0.2, 0.4, 0.3)),
        flight("b", "dev", (0.5,), (0.5,)),
        flight("c", "test", (0.9,), (0.1,)),
        flight("d", "test", (), ()),
        flight("e", "test", (0.7,), (0.2,)),
    ]
    found = {row.name: row for row in rows(flights)}
    assert list(found) == ["b", "= dev", "a", "c", "d", "e", "= test"]
    assert [row.things for row in found.values()] == [1, 1, 3, 1, 0, 1, 5]
    assert found["a"].values[0][:2] == pytest.approx((0.8, 0.3))
    assert found["= test"].values[0][:2] == pytest.approx((0.8, 0.2))
    assert found["= dev"].intervals == ()  # of one flight there is none
    low, high = found["= test"].intervals[0][0]
    assert 0.4 <= low <= 0.6 <= high <= 0.8


def test_pooling_keeps_every_thing() -> None:
    pooled = pool([partition(0.1, 0.2), partition(), partition(0.3)])
    assert [score.iou for score in pooled.things] == [0.1, 0.2, 0.3]


@pytest.mark.slow
def test_what_was_scored_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, cache = disk.write_flight(tmp_path / "sign", frames=2, last_range_m=20.0), tmp_path / "kept.json"
    first = segment_cached(folder, parameters.defaults(), cache)
    assert {score.thing.name for score in first.scores[CUT].things} == {"sign", "wall"}
    monkeypatch.setattr(flight_segmentation, "segment_flight", lambda *_: pytest.fail("scored again"))
    again = segment_cached(folder, parameters.defaults(), cache)
    assert json.dumps(asdict(again)) == json.dumps(asdict(first))
