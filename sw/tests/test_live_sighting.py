"""What a frame tells an autopilot and a page in flight: its own fields, not what a line has left of them."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fake_pipeline import fake_motion, fake_nearest, fake_obstacle, fake_record
from random_seed import seeded
from vista import native
from vista.geometry import Calibration, Pose, rotation_from_quaternion
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.history import FrameRecord
from vista.live.listeners import Autopilot, Lines
from vista.live.loop import Seen
from vista.mavlink.link import Link
from vista.mavlink.sighting import Sighting, sighting_of, sighting_of_line
from vista.obstacle_line import obstacle_line
from vista.parameters import defaults
from vista.pipeline import Directions

CAMERA = Calibration(320, 240, 300.0, 160.0, 120.0, 0.5)
HEALTH = FrameHealth((Finding(Reason.NOISE, State.DEGRADED, "noise"),))


def record(rng: np.random.Generator, **changes: Any) -> FrameRecord:
    quaternion = rng.normal(size=4)
    pose = Pose(rotation_from_quaternion(quaternion / np.linalg.norm(quaternion)), rng.normal(size=3))
    obstacles = [
        fake_obstacle(k, 10.0, CAMERA, position_m=rng.normal(0.0, 20.0, 3), confirmed=k != 2)
        for k in (1, 2, 3)
    ]
    time_s = float(rng.uniform(0.1, 9.0))
    nearest = fake_nearest(obstacles[2], time_s, position_m=rng.normal(0.0, 20.0, 3))
    shape = 2, Directions.COLUMNS
    free_m, blocked_m = np.where(rng.random(shape) < 0.5, 0.0, rng.uniform(0.0, 80.0, shape))
    told: dict[str, Any] = {
        "obstacles": obstacles,
        "nearest": nearest,
        "motion": fake_motion(pose, rng.normal(0.0, 5.0, 3)),
        "directions": Directions.made(
            up_known=True, up_camera=pose.rotation[0], free_m=free_m, blocked_m=blocked_m
        ),
        "health": HEALTH,
    }
    return fake_record(7, 70, **told | changes)


def assert_alike(one: Sighting, other: Sighting, atol: float) -> None:
    a, b = one.frame, other.frame
    ffi = native.load("vista")[0]
    assert (a.t_ns, a.health, ffi.string(a.reason)) == (b.t_ns, b.health, ffi.string(b.reason))
    assert a.obstacle_count == b.obstacle_count
    for k in range(a.obstacle_count):
        assert a.obstacles[k].id == b.obstacles[k].id
        assert_near(a.obstacles[k], b.obstacles[k], ("position_camera_m", "width_m", "height_m"), atol)
    assert a.directions.up_known == b.directions.up_known
    assert_near(a.directions, b.directions, ("free_m", "blocked_m"), atol)
    if a.directions.up_known:
        assert_near(a.directions, b.directions, ("up_camera",), atol)
    assert (a.collision.valid, a.collision.id) == (b.collision.valid, b.collision.id)
    if a.collision.valid:
        assert_near(a.collision, b.collision, ("velocity_camera_m_s", "position_camera_m"), atol)
        assert_near(a.collision, b.collision, ("time_s",), 10 * atol)


def assert_near(one: Any, other: Any, members: tuple[str, ...], atol: float) -> None:
    for member in members:
        values = [getattr(struct, member) for struct in (one, other)]
        values = [value if isinstance(value, float) else list(value) for value in values]
        np.testing.assert_allclose(*values, atol=atol)


NOTHING_KNOWN: dict[str, Any] = {"motion": None, "nearest": None, "health": FrameHealth()}
SLOWLY = {"motion": fake_motion(Pose())}


@pytest.mark.parametrize("changes", [{}, NOTHING_KNOWN, SLOWLY, {"obstacles": ()}])
def test_a_line_tells_the_same_to_its_last_digit(changes: dict[str, Any]) -> None:
    told = record(seeded(2401), **changes)
    assert_alike(sighting_of(told), sighting_of_line("line", obstacle_line(told)), 0.6e-3)


def test_a_place_that_is_not_finite_is_told_as_in_a_line() -> None:
    lost = fake_obstacle(1, 10.0, CAMERA, position_m=(1.0, np.nan, np.inf))
    told = record(seeded(2402), obstacles=(lost,))
    assert_alike(sighting_of(told), sighting_of_line("line", obstacle_line(told)), 0.6e-3)


def test_a_flight_needs_no_text(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither is a line written for an autopilot, nor is one parsed."""

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("JSON in flight")

    sent: list[bytes] = []
    autopilot = Autopilot(
        Link(defaults()),
        SimpleNamespace(send=sent.append, close=lambda: None, lost=0),  # type: ignore[arg-type]
    )
    monkeypatch.setattr(json, "loads", refuse)
    monkeypatch.setattr(json, "dumps", refuse)
    told = record(seeded(2403))
    try:
        autopilot.take(Seen(None, told, 10**9))  # type: ignore[arg-type]
    finally:
        autopilot.close()


def test_lines_are_those_of_a_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    told = record(seeded(2404))
    capsys.readouterr()  # the seed
    for path in ("-", tmp_path / "lines.jsonl"):
        lines = Lines(path)
        lines.take(Seen(None, told, 0))  # type: ignore[arg-type]
        lines.close()
    written = (tmp_path / "lines.jsonl").read_text()
    assert capsys.readouterr().out == written == obstacle_line(told) + "\n"
