"""What a frame tells an autopilot and a page in flight: its own fields, not what a line has left of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from fake_pipeline import fake_obstacle
from random_seed import seeded
from vista.geometry import Calibration, Pose, rotation_from_quaternion
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.history import FrameRecord
from vista.live.listeners import Autopilot, Lines
from vista.live.loop import Seen
from vista.mavlink.link import Link
from vista.mavlink.sighting import Sighting, sighting_of, sighting_of_line
from vista.obstacle_line import obstacle_line
from vista.parameters import defaults
from vista.pipeline import Directions, Nearest

CAMERA = Calibration(320, 240, 300.0, 160.0, 120.0, 0.5)
HEALTH = FrameHealth((Finding(Reason.NOISE, State.DEGRADED, "noise"),))


def record(rng: np.random.Generator, **changes: object) -> FrameRecord:
    quaternion = rng.normal(size=4)
    pose = Pose(rotation_from_quaternion(quaternion / np.linalg.norm(quaternion)), rng.normal(size=3))
    obstacles = [
        fake_obstacle(k, 10.0, CAMERA, position_m=rng.normal(0.0, 20.0, 3), confirmed=k != 2)
        for k in (1, 2, 3)
    ]
    nearest = Nearest(3, rng.normal(0.0, 20.0, 3), 9.0, float(rng.uniform(0.1, 9.0)), np.eye(3))
    shape = 2, Directions.COLUMNS
    free_m, blocked_m = np.where(rng.random(shape) < 0.5, 0.0, rng.uniform(0.0, 80.0, shape)).astype(
        np.float32
    )
    made = FrameRecord(7, 70, pose, tuple(obstacles), nearest, 3, 0.5, {"host": 1.0}, health=HEALTH)
    made = replace(made, velocity_m_s=rng.normal(0.0, 5.0, 3))
    made = replace(made, directions=Directions(pose.rotation[0], free_m, blocked_m))
    return replace(made, **changes)


def assert_alike(one: Sighting, other: Sighting, atol: float) -> None:
    assert (one.t_ns, one.health, one.reason) == (other.t_ns, other.health, other.reason)
    assert [board.id for board in one.obstacles] == [board.id for board in other.obstacles]
    for a, b in zip(one.obstacles, other.obstacles, strict=True):
        np.testing.assert_allclose(a.position_camera_m, b.position_camera_m, atol=atol)
        assert (a.width_m, a.height_m) == pytest.approx((b.width_m, b.height_m), abs=atol)
    seen, other_seen = one.directions, other.directions
    np.testing.assert_allclose(seen.free_m, other_seen.free_m, atol=atol)
    np.testing.assert_allclose(seen.blocked_m, other_seen.blocked_m, atol=atol)
    assert (seen.up_camera is None) == (other_seen.up_camera is None)
    if seen.up_camera is not None and other_seen.up_camera is not None:
        np.testing.assert_allclose(seen.up_camera, other_seen.up_camera, atol=atol)
    assert (one.collision is None) == (other.collision is None)
    if one.collision is not None and other.collision is not None:
        assert one.collision.id == other.collision.id
        assert one.collision.time_s == pytest.approx(other.collision.time_s, abs=10 * atol)
        np.testing.assert_allclose(
            one.collision.velocity_camera_m_s, other.collision.velocity_camera_m_s, atol=atol
        )
        np.testing.assert_allclose(
            one.collision.position_camera_m, other.collision.position_camera_m, atol=atol
        )


NOTHING_KNOWN = {
    "world_from_camera": None,
    "nearest_collision": None,
    "velocity_m_s": None,
    "directions": None,
    "health": FrameHealth(),
}


@pytest.mark.parametrize("changes", [{}, NOTHING_KNOWN, {"velocity_m_s": None}, {"obstacles": ()}])
def test_a_line_tells_the_same_to_its_last_digit(changes: dict[str, object]) -> None:
    told = record(seeded(2401), **changes)
    assert_alike(sighting_of(told), sighting_of_line("line", obstacle_line(told)), 0.6e-3)


def test_what_is_not_finite_is_told_as_in_a_line() -> None:
    told = record(seeded(2402))
    lost = replace(told.obstacles[0], position_m=np.array([1.0, np.nan, np.inf]))
    free_m = np.full(Directions.COLUMNS, np.inf, np.float32)
    free_m[3] = np.nan
    told = replace(told, obstacles=(lost,), directions=Directions(None, free_m, np.roll(free_m, 9)))
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
