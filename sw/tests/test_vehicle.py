"""The vehicle's motion out of MAVLink: what pymavlink packs, interpolated, wherever the stream is cut."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mavlink_link import AXES, rotation
from pymavlink.dialects.v10 import ardupilotmega as dialect_1
from pymavlink.dialects.v20 import ardupilotmega as dialect_2
from random_seed import seeded
from stage_library import default_parameters, ffi, lib
from vista.geometry import quaternion_from_rotation

MS = 1_000_000
BOOT_NS = 7_000 * MS  # our clock when the autopilot's was 0
DELAY_NS = 4 * MS


class Motion:
    """An aircraft on a curve, of which everything is known: seconds on the autopilot's clock."""

    def __init__(self, seed: int) -> None:
        random = seeded(seed)
        self.angles_deg, self.rates_deg_s = random.uniform(-40, 40, 3), random.uniform(-30, 30, 3)
        self.acceleration_m_s2 = random.uniform(-2, 2, 3)
        self.velocity_m_s, self.position_m = random.uniform(-10, 10, 3), random.uniform(-50, 50, 3)

    def ned_from_body(self, t_s: float) -> np.ndarray:
        return rotation(*(self.angles_deg + self.rates_deg_s * t_s))

    def rates_rad_s(self, t_s: float) -> np.ndarray:
        step_s = 1e-5
        turn = self.ned_from_body(t_s).T @ self.ned_from_body(t_s + step_s)
        return np.array([turn[2, 1], turn[0, 2], turn[1, 0]]) / step_s

    def velocity(self, t_s: float) -> np.ndarray:
        return self.velocity_m_s + self.acceleration_m_s2 * t_s

    def position(self, t_s: float) -> np.ndarray:
        return self.position_m + self.velocity_m_s * t_s + 0.5 * self.acceleration_m_s2 * t_s**2


class Autopilot:
    """Packs what it knows of a motion."""

    def __init__(self, motion: Motion, dialect: Any = dialect_2, system: int = 1, component: int = 1) -> None:
        self.motion, self.dialect = motion, dialect
        self.link = dialect.MAVLink(None, srcSystem=system, srcComponent=component)

    def attitude(self, boot_ms: int) -> bytes:
        t_s = 1e-3 * boot_ms
        quaternion = quaternion_from_rotation(self.motion.ned_from_body(t_s))
        message = self.dialect.MAVLink_attitude_quaternion_message(
            boot_ms, *quaternion, *self.motion.rates_rad_s(t_s)
        )
        return bytes(message.pack(self.link))

    def position(self, boot_ms: int) -> bytes:
        t_s = 1e-3 * boot_ms
        numbers = [*self.motion.position(t_s), *self.motion.velocity(t_s)]
        return bytes(self.dialect.MAVLink_local_position_ned_message(boot_ms, *numbers).pack(self.link))

    def heartbeat(self) -> bytes:
        return bytes(self.dialect.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3).pack(self.link))


class Vehicle:
    def __init__(self, delay_ns: int = 0, **mount_deg: float) -> None:
        self.parameters = default_parameters()
        for name, value in mount_deg.items():
            setattr(self.parameters.mavlink, f"mount_{name}_deg", value)
        self.c = ffi.new("vista_vehicle *")
        params = ffi.addressof(self.parameters, "mavlink")
        self.status = lib.vista_vehicle_start(self.c, params, delay_ns)

    def receive(self, now_ns: int, data: bytes) -> None:
        assert lib.vista_vehicle_receive(self.c, now_ns, data, len(data)) == lib.VISTA_OK

    def at(self, t_ns: int) -> Any:
        motion = ffi.new("vista_vehicle_motion *")
        assert lib.vista_vehicle_at(self.c, t_ns, motion) == lib.VISTA_OK
        return motion


def now_at(boot_ms: int) -> int:
    return BOOT_NS + boot_ms * MS


def flown(autopilot: Autopilot, vehicle: Vehicle, end_ms: int = 1000, **every_ms: int) -> None:
    for boot_ms in range(0, end_ms + 1, 10):
        if boot_ms % every_ms.get("attitude", 20) == 0:
            vehicle.receive(now_at(boot_ms), autopilot.attitude(boot_ms))
        if boot_ms % every_ms.get("position", 40) == 0:
            vehicle.receive(now_at(boot_ms), autopilot.position(boot_ms))


def pose_of(motion: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.array(list(motion.pose.rotation)).reshape(3, 3), np.array(list(motion.pose.translation_m))


def angle_deg(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(one.T @ other) - 1) / 2, -1, 1))))


@pytest.mark.parametrize("dialect", [dialect_1, dialect_2], ids=["MAVLink 1", "MAVLink 2"])
@pytest.mark.parametrize("past_ms, tolerance", [(-100, 1.0), (150, 12.0)], ids=["between", "beyond"])
def test_the_pose_at_the_exposure(dialect: Any, past_ms: int, tolerance: float) -> None:
    motion, vehicle = Motion(1), Vehicle(roll=5.0, pitch=-20.0, yaw=30.0)
    flown(Autopilot(motion, dialect), vehicle)
    t_ms = 1000 + past_ms + float(seeded(2).uniform(0, 20))
    found = vehicle.at(BOOT_NS + int(t_ms * MS))
    assert found.pose_known and found.velocity_known and found.up_known
    assert list(found.up_world) == [0.0, 0.0, -1.0]
    R, position_m = pose_of(found)
    wanted = motion.ned_from_body(1e-3 * t_ms) @ rotation(5.0, -20.0, 30.0) @ AXES
    assert angle_deg(R, wanted) < 0.05 * tolerance
    assert np.abs(position_m - motion.position(1e-3 * t_ms)).max() < 0.003 * tolerance + 1e-3
    assert np.abs(np.array(list(found.velocity_m_s)) - motion.velocity(1e-3 * t_ms)).max() < 0.04 * tolerance


def test_nothing_is_known_too_far_off() -> None:
    vehicle = Vehicle()
    assert not vehicle.at(BOOT_NS).pose_known  # no message yet
    flown(Autopilot(Motion(3)), vehicle, 500)
    assert vehicle.at(now_at(600)).pose_known
    for t_ms in (-1, 701, 10_000, -(10**6)):
        found = vehicle.at(now_at(t_ms))
        assert not (found.pose_known or found.velocity_known or found.up_known)


def test_attitudes_alone_are_no_pose() -> None:
    vehicle, autopilot = Vehicle(), Autopilot(Motion(4))
    for boot_ms in range(0, 200, 20):
        vehicle.receive(now_at(boot_ms), autopilot.attitude(boot_ms))
    assert not vehicle.at(now_at(180)).pose_known


def test_a_gap_of_half_a_second_is_not_bridged() -> None:
    autopilot = Autopilot(Motion(5))
    for gap_ms, known in ((480, True), (520, False)):
        vehicle = Vehicle()
        flown(autopilot, vehicle, 400)
        later = now_at(400 + gap_ms)
        vehicle.receive(later, autopilot.attitude(400 + gap_ms) + autopilot.position(400 + gap_ms))
        assert vehicle.at(now_at(400 + gap_ms // 2)).pose_known == known


def test_messages_that_were_held_up_do_not_move_the_clock() -> None:
    """Jitter of up to 30 ms: the fastest messages tell how the clocks differ."""
    motion, vehicle, random = Motion(6), Vehicle(DELAY_NS), seeded(7)
    autopilot = Autopilot(motion)
    for boot_ms in range(0, 2000, 10):
        late_ns = DELAY_NS + int(random.choice([0, 0, 0, 10, 30]) * MS)
        data = autopilot.attitude(boot_ms) + autopilot.position(boot_ms)
        vehicle.receive(now_at(boot_ms) + late_ns, data)
    t_ns = now_at(1900)
    R, position_m = pose_of(vehicle.at(t_ns))
    assert angle_deg(R, motion.ned_from_body(1.9) @ AXES) < 0.05
    assert np.abs(position_m - motion.position(1.9)).max() < 0.02


def test_an_autopilot_that_is_started_again() -> None:
    """Its clock begins at 0: what it said before is forgotten, and its new poses count at once."""
    vehicle, before, after = Vehicle(), Autopilot(Motion(8)), Autopilot(Motion(9))
    for boot_ms in range(60_000, 61_000, 20):
        vehicle.receive(now_at(boot_ms), before.attitude(boot_ms) + before.position(boot_ms))
    start_ns = now_at(65_000)
    for boot_ms in range(0, 200, 20):
        vehicle.receive(start_ns + boot_ms * MS, after.attitude(boot_ms) + after.position(boot_ms))
    assert not vehicle.at(now_at(60_500)).pose_known
    assert np.abs(pose_of(vehicle.at(start_ns + 100 * MS))[1] - after.motion.position(0.1)).max() < 0.01


def stream(autopilot: Autopilot) -> list[bytes]:
    """The bytes of 400 ms, with messages of others between."""
    pieces = []
    other, camera = Autopilot(Motion(11), system=2), Autopilot(Motion(11), component=100)
    for boot_ms in range(0, 401, 20):
        pieces += [autopilot.heartbeat(), autopilot.attitude(boot_ms), other.attitude(boot_ms)]
        pieces += [camera.position(boot_ms), autopilot.position(boot_ms)]
    return pieces


def test_a_stream_is_cut_anywhere() -> None:
    autopilot, random = Autopilot(Motion(10)), seeded(12)
    whole, cut = Vehicle(), Vehicle()
    pieces = b"".join(stream(autopilot))
    whole.receive(now_at(400), pieces)
    while pieces:
        count = int(random.integers(0, 40))
        cut.receive(now_at(400), pieces[:count])
        pieces = pieces[count:]
    assert whole.c.attitude_count == whole.c.position_count == 21
    for name in ("attitudes", "positions"):
        assert bytes(ffi.buffer(getattr(whole.c, name))) == bytes(ffi.buffer(getattr(cut.c, name)))


def test_damaged_messages_are_passed_over() -> None:
    """A byte of each fifth message is changed: what is taken is what was sent, and most of it is taken."""
    autopilot, random = Autopilot(Motion(13)), seeded(14)
    vehicle = Vehicle()
    for k, piece in enumerate(stream(autopilot)):
        damaged = bytearray(piece)
        if k % 5 == 1:
            damaged[int(random.integers(len(piece)))] ^= int(random.integers(1, 256))
        vehicle.receive(now_at(400), bytes(damaged))
    vehicle.receive(now_at(400), bytes(300))  # what waits for the rest of a frame is scanned
    assert vehicle.c.attitude_count <= 21 and vehicle.c.position_count >= 10
    for k in range(vehicle.c.position_count):
        position = vehicle.c.positions[k]
        assert (
            np.abs(
                np.array(list(position.position_m)) - autopilot.motion.position(1e-9 * position.boot_ns)
            ).max()
            < 1e-4
        )


def test_anything_else_is_passed_over() -> None:
    vehicle, random = Vehicle(), seeded(15)
    for _ in range(50):
        data = random.integers(0, 256, int(random.integers(0, 3000)), dtype=np.uint8)
        data[random.random(len(data)) < 0.1] = 0xFD
        vehicle.receive(now_at(1), data.tobytes())
    assert vehicle.c.attitude_count == vehicle.c.position_count == 0
    vehicle.receive(now_at(2), bytes(300))
    flown(Autopilot(Motion(16)), vehicle, 200)
    assert vehicle.at(now_at(100)).pose_known


@pytest.mark.parametrize("quaternion", [(np.nan, 0, 0, 0), (0, 0, 0, 0), (2, 0, 0, 0), (np.inf, 0, 0, 0)])
def test_numbers_that_are_no_attitude(quaternion: tuple[float, ...]) -> None:
    vehicle, link = Vehicle(), dialect_2.MAVLink(None, srcSystem=1, srcComponent=1)
    message = dialect_2.MAVLink_attitude_quaternion_message(5, *quaternion, 0, 0, 0)
    vehicle.receive(now_at(5), bytes(message.pack(link)))
    assert vehicle.c.attitude_count == 0


def test_bad_arguments() -> None:
    assert Vehicle(-1).status == lib.VISTA_ERROR_RANGE
    assert Vehicle(10**9 + 1).status == lib.VISTA_ERROR_RANGE
    assert Vehicle(roll=500.0).status == lib.VISTA_ERROR_RANGE
    assert lib.vista_vehicle_receive(ffi.NULL, 0, b"", 0) == lib.VISTA_ERROR_ARGUMENT
    assert lib.vista_vehicle_at(Vehicle().c, 0, ffi.NULL) == lib.VISTA_ERROR_ARGUMENT
