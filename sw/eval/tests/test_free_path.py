"""How far the path is called free, against paths whose truth is known by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import truth_on_disk as disk
from fake_pipeline import fake_motion, fake_nearest, fake_obstacle, fake_record
from vista import parameters
from vista.geometry import Calibration, Pose
from vista_eval.metrics.flight_score import score_records
from vista_eval.metrics.frame_truth import flight_frames
from vista_eval.metrics.free_path import FrameOnPath, FreePath, free_path, table, together
from vista_eval.metrics.rules import STRICT

CAMERA = Calibration(disk.WIDTH, disk.HEIGHT, disk.FOCAL_PX, *disk.CENTER_PX, disk.BASELINE_M)
AHEAD, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
START_M = np.array([0.0, 0.0, 10.0])
OPEN = FrameOnPath(np.inf, 100.0, 12.0, 50.0, warned=False, healthy=True)
AT_30 = replace(OPEN, contact_m=30.0)


@pytest.mark.parametrize(
    ("frame", "counted"),
    [
        (OPEN, {"clear", "clear_seen"}),
        (replace(OPEN, seen_m=39.0), {"clear"}),
        (replace(OPEN, length_m=44.0), set()),  # nobody knows what comes then
        (replace(OPEN, contact_m=46.0, seen_m=45.0), {"clear", "clear_seen", "asked"}),
        (replace(OPEN, contact_m=61.0, seen_m=70.0), {"clear", "clear_seen"}),
        (AT_30, {"asked", "through", "through_healthy", "longest_through"}),
        (replace(AT_30, healthy=False), {"asked", "through", "longest_through"}),
        (replace(AT_30, warned=True), {"asked"}),
        (replace(AT_30, seen_m=31.9), {"asked"}),
        (replace(AT_30, contact_m=24.0, seen_m=24.0), {"asked", "too_late"}),  # 12^2 / 6
        (replace(AT_30, contact_m=24.1, seen_m=24.1), {"asked"}),
        (replace(AT_30, contact_m=20.0, seen_m=19.9), {"asked"}),  # unknown: it would have stopped
        (replace(AT_30, contact_m=20.0, seen_m=50.0, warned=True), {"asked"}),
    ],
)
def test_what_a_frame_counts_for(frame: FrameOnPath, counted: set[str]) -> None:
    assert {name for name, count in vars(free_path([frame])).items() if count} == counted


def test_the_longest_run_is_that_of_one_flight() -> None:
    """Three and two in a row; five of two flights are no run."""
    seen = replace(AT_30, warned=True)
    first = free_path([AT_30, AT_30, seen, AT_30, AT_30, AT_30])
    second = free_path([AT_30, AT_30, seen])
    assert (first.through, first.longest_through, second.longest_through) == (5, 3, 2)
    assert together([first, second]) == FreePath(asked=9, through=7, through_healthy=7, longest_through=3)
    assert table("flight", [("first", first)]).rows == [("first", "", "5/6", "5", "3", "0")]


def contacts(folder: Path, velocity_m_s: np.ndarray, *surfaces: disk.Surface) -> list[float]:
    disk.write_truth(folder, disk.straight(5, START_M, velocity_m_s), surfaces)
    return [frame.contact_m for frame in flight_frames(folder, STRICT)[1]]


def test_where_the_path_first_meets_something(tmp_path: Path) -> None:
    """A wall across the path, 30 m ahead; a meter nearer in each frame."""
    wall = disk.Surface("wall", disk.plane(START_M + 30.0 * AHEAD, AHEAD))
    assert contacts(tmp_path, 10.0 * AHEAD, wall) == pytest.approx([30.0, 29.0, 28.0, 27.0, 26.0], abs=0.1)


def test_ground_counts_where_it_is_met(tmp_path: Path) -> None:
    """Level flight 4 m above it meets none; descending by 0.15 m in every metre the middle of the
    volume meets it after 27 m, and its rim, 2 m lower, no earlier than after 13 m."""
    ground = disk.Surface("ground", disk.plane(6.0 * UP, UP), standing=False, target=False)
    assert contacts(tmp_path / "level", 10.0 * AHEAD, ground) == [np.inf] * 5
    down = contacts(tmp_path / "down", 10.0 * (AHEAD - 0.15 * UP), ground)
    assert 13.0 < down[0] < 27.0


@pytest.mark.slow
def test_of_a_whole_flight(tmp_path: Path) -> None:
    """A wall 30 m ahead, warned of in the last two of five frames; 50 m are called seen throughout."""
    wall = disk.Surface("wall", disk.plane(START_M + 30.0 * AHEAD, AHEAD))
    disk.write_truth(tmp_path, disk.straight(5, START_M, 10.0 * AHEAD), (wall,))
    records = []
    for k, frame in enumerate(flight_frames(tmp_path, STRICT)[1]):
        seen = fake_obstacle(1, 30.0, CAMERA, in_collision_volume=True)
        told = {"obstacles": [seen], "nearest": fake_nearest(seen)} if k >= 3 else {}
        motion = fake_motion(frame.world_from_camera or Pose())
        records.append(
            fake_record(k, frame.t_ns, motion=motion, stage_ms={"host": 1.0}, path_seen_m=50.0, **told)
        )
    score = score_records(tmp_path, records, parameters.defaults(), STRICT)
    assert score.free == FreePath(asked=5, through=3, through_healthy=3, longest_through=3)
