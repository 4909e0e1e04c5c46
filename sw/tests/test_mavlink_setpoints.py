"""What an autopilot is told to fly: the trajectory of a decision; and when it is told nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mavlink_link import AUTOPILOT
from pymavlink.dialects.v20 import ardupilotmega as dialect
from stage_library import default_parameters, ffi, lib, status_name

MS = 1_000_000
START_NS = 5_000 * MS
PX4_LOSS_MS = 500  # PX4 leaves OFFBOARD without a setpoint for COM_OF_LOSS_T, 1 s; half of that is asked for
IGNORE = 0b0000_1101_1111_1111  # every bit of type_mask that leaves a number out, without that of a force
FORCE = 1 << 9
PX4_OFFBOARD = 6 << 16


class Link:
    """A link in a test's hand, with time of its own."""

    def __init__(self, autopilot: str = "px4") -> None:
        parameters = default_parameters()
        parameters.mavlink.autopilot = AUTOPILOT[autopilot]
        self.handle = ffi.new("vista_mavlink *")
        started = lib.vista_mavlink_start(self.handle, ffi.addressof(parameters, "mavlink"))
        assert started == lib.VISTA_OK
        self.decoder, self.now_ns = dialect.MAVLink(None), START_NS

    def fly(self, decision: Any) -> str:
        pointer = ffi.NULL if decision is None else decision
        return status_name(lib.vista_mavlink_fly(self.handle, pointer, self.now_ns))

    def run(self, seconds: float) -> list[tuple[float, Any]]:
        """What is sent, and how many seconds after now."""
        sent, begin_ns = [], self.now_ns
        data, count = ffi.new("uint8_t[280]"), ffi.new("int32_t *")
        while self.now_ns < begin_ns + round(seconds * 1e9):
            while True:
                assert lib.vista_mavlink_next(self.handle, self.now_ns, data, 280, count) == lib.VISTA_OK
                if count[0] == 0:
                    break
                messages = self.decoder.parse_buffer(bytes(data[0 : count[0]])) or []
                sent += [(1e-9 * (self.now_ns - begin_ns), message) for message in messages]
            self.now_ns += 10 * MS
        return sent


def setpoints(sent: list[tuple[float, Any]]) -> list[tuple[float, Any]]:
    return [item for item in sent if item[1].get_type() == "SET_POSITION_TARGET_LOCAL_NED"]


def braking(action: str = "proceeds", speed_m_s: float = 4.0) -> Any:
    """A plan in NED that flies east, then stops after 2 s; it looks to the east and turns to the left."""
    decision = ffi.new("vista_plan_decision *")
    decision.action = getattr(lib, f"VISTA_PLAN_{action.upper()}")
    decision.step_s, decision.point_count, decision.circle_from = 0.5, 5, -1
    for k in range(5):
        point = decision.points[k]
        point.position_m = [7.0, speed_m_s * min(0.5 * k, 1.5), -20.0]
        point.velocity_m_s = [0.0, speed_m_s if k < 4 else 0.0, 0.0]
        point.acceleration_m_s2 = [0.25, 0.0, 0.0]
        point.heading = [0.0, 1.0, 0.0]
        point.yaw_rate_rad_s = 0.5
    return decision


@pytest.mark.parametrize("autopilot", AUTOPILOT)
def test_the_trajectory_is_sent_in_ned_with_all_of_its_numbers(autopilot: str) -> None:
    link = Link(autopilot)
    link.fly(braking())
    sent = setpoints(link.run(1.0))
    for t_s, message in sent:
        assert (message.target_system, message.target_component) == (1, 1)
        assert message.coordinate_frame == dialect.MAV_FRAME_LOCAL_NED
        assert message.type_mask & (IGNORE | FORCE) == 0
        np.testing.assert_allclose([message.x, message.y, message.z], [7.0, 4.0 * t_s, -20.0], atol=1e-4)
        np.testing.assert_allclose([message.vx, message.vy, message.vz], [0.0, 4.0, 0.0], atol=1e-6)
        np.testing.assert_allclose([message.afx, message.afy, message.afz], [0.25, 0.0, 0.0], atol=1e-6)
        assert message.yaw == pytest.approx(np.pi / 2) and message.yaw_rate == pytest.approx(-0.5)
    times_s = [t_s for t_s, _ in sent]
    assert len(sent) == 20 and max(np.diff(times_s)) < 1e-3 * PX4_LOSS_MS


def test_without_a_further_decision_it_is_flown_to_its_end_held_and_given_back() -> None:
    link = Link()
    link.fly(braking())
    sent = setpoints(link.run(10.0))
    assert sent[-1][0] == pytest.approx(2.0 + 2.0, abs=0.1)
    held = [message for t_s, message in sent if t_s > 2.0]
    assert {(message.y, message.vy) for message in held} == {(6.0, 0.0)}


def test_nothing_is_sent_before_the_first_decision_and_after_the_last() -> None:
    link = Link()
    assert not setpoints(link.run(1.0))
    link.fly(braking())
    assert setpoints(link.run(0.2))
    link.fly(None)
    assert not setpoints(link.run(1.0))


def test_the_pilot_is_told_when_no_way_is_safe() -> None:
    link = Link()
    said = []
    for action in ("proceeds", "evades", "holds", "helpless", "evades"):
        link.fly(braking(action))
        texts = [message for _, message in link.run(1.5) if message.get_type() == "STATUSTEXT"]
        said += [
            (message.severity, message.text)
            for message in texts
            if "way" in message.text or "flies" in message.text
        ]
    assert said == [
        (dialect.MAV_SEVERITY_INFO, "VISTA flies"),
        (dialect.MAV_SEVERITY_WARNING, "VISTA holds: no way is free"),
        (dialect.MAV_SEVERITY_CRITICAL, "VISTA has no safe way"),
        (dialect.MAV_SEVERITY_INFO, "VISTA flies"),
    ]


def test_setpoints_do_not_push_distances_and_heartbeats_aside() -> None:
    link = Link()
    link.fly(braking())
    kinds = [message.get_type() for _, message in link.run(3.0)]
    assert kinds.count("OBSTACLE_DISTANCE") >= 29 and kinds.count("HEARTBEAT") == 3


def test_what_is_no_decision_is_refused() -> None:
    link = Link()
    decision = braking()
    decision.action = 77
    assert link.fly(decision) == "VISTA_ERROR_RANGE"
    link.now_ns = -1
    assert link.fly(braking()) == "VISTA_ERROR_RANGE"
    assert lib.vista_mavlink_fly(ffi.NULL, ffi.NULL, 0) == lib.VISTA_ERROR_ARGUMENT


# ---- whether the autopilot flies them ----


class Vehicle:
    def __init__(self) -> None:
        self.handle = ffi.new("vista_vehicle *")
        parameters = default_parameters()
        started = lib.vista_vehicle_start(self.handle, ffi.addressof(parameters, "mavlink"), 0)
        assert started == lib.VISTA_OK

    def hear(self, now_ns: int, system: int = 1, component: int = 1, **members: int) -> None:
        given = {
            "type": 2,
            "autopilot": 12,
            "base_mode": 128,
            "custom_mode": PX4_OFFBOARD,
            "system_status": 4,
        }
        sender = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        data = dialect.MAVLink_heartbeat_message(mavlink_version=3, **(given | members)).pack(sender)
        assert lib.vista_vehicle_receive(self.handle, now_ns, bytes(data), len(data)) == lib.VISTA_OK

    def follows(self, now_ns: int) -> bool:
        return bool(lib.vista_vehicle_follows(self.handle, now_ns))


@pytest.mark.parametrize(
    "members, follows",
    [
        ({}, True),
        ({"custom_mode": 4 << 16}, False),  # AUTO of PX4
        ({"base_mode": 0}, False),  # not armed
        ({"autopilot": 3, "custom_mode": 4}, True),  # GUIDED of ArduCopter,
        ({"autopilot": 3, "custom_mode": 5}, False),  # LOITER,
        ({"autopilot": 3, "type": 1, "custom_mode": 15}, True),  # GUIDED of ArduPlane,
        ({"autopilot": 3, "type": 1, "custom_mode": 4}, False),  # and its ACRO
        ({"autopilot": 8}, False),
    ],
)
def test_the_mode_takes_over_and_gives_back(members: dict[str, int], follows: bool) -> None:
    vehicle = Vehicle()
    assert not vehicle.follows(START_NS)
    vehicle.hear(START_NS, **members)
    assert vehicle.follows(START_NS) == follows
    vehicle.hear(START_NS + MS, custom_mode=3 << 16)
    assert not vehicle.follows(START_NS + MS)


def test_a_mode_is_forgotten_when_heartbeats_cease_and_others_do_not_count() -> None:
    vehicle = Vehicle()
    vehicle.hear(START_NS, component=191)
    vehicle.hear(START_NS, system=2)
    assert not vehicle.follows(START_NS)
    vehicle.hear(START_NS)
    assert vehicle.follows(START_NS + 3_000 * MS) and not vehicle.follows(START_NS + 3_001 * MS)
