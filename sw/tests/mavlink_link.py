"""A MAVLink link of libvista in a test's hand: frames in, what pymavlink decodes out; and an aircraft."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as dialect
from stage_library import default_parameters, ffi, lib, status_name

MS = 1_000_000
UNKNOWN = 65535
FIRST_DEG = lib.VISTA_DIRECTIONS_FIRST_DEG
COLUMNS = lib.VISTA_DIRECTIONS
HEALTH = {"healthy": 0, "degraded": 1, "blind": 2}
AUTOPILOT = {
    "px4": lib.VISTA_MAVLINK_AUTOPILOT_PX4,
    "ardupilot": lib.VISTA_MAVLINK_AUTOPILOT_ARDUPILOT,
}
START_NS = 1000 * MS
LEVEL_M = 12.0  # of what most tests look at
CLEAR = 4001  # the default of mavlink.max_distance_m


def rotation(roll_deg: float, pitch_deg: float, yaw_deg: float) -> np.ndarray:
    """Turns from a body with these angles, z down, into the frame that they are measured in."""
    r, p, y = np.radians([roll_deg, pitch_deg, yaw_deg])
    about_x = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    about_y = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    about_z = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


AXES = np.array(
    [[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]
)  # of a camera that looks forward: x right, y down, z ahead


@dataclass(frozen=True)
class Aircraft:
    """Attitude in NED, and how the camera hangs in it: roll, pitch, yaw."""

    attitude_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mount_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def body_from_camera(self) -> np.ndarray:
        return rotation(*self.mount_deg) @ AXES

    @property
    def ned_from_camera(self) -> np.ndarray:
        return rotation(*self.attitude_deg) @ self.body_from_camera

    @property
    def up_camera(self) -> np.ndarray:
        return self.ned_from_camera.T @ [0.0, 0.0, -1.0]

    def at_bearing(self, bearing_deg: float, level_m: float, height_m: float = 0.0) -> np.ndarray:
        """A point in the camera, at a level bearing from the heading."""
        angle = np.radians(self.attitude_deg[2] + bearing_deg)
        return self.ned_from_camera.T @ [level_m * np.cos(angle), level_m * np.sin(angle), -height_m]

    @property
    def camera_bearing_deg(self) -> float:
        """The level angle from the heading to where the camera looks."""
        axis = self.ned_from_camera[:, 2]
        return float(np.degrees(np.arctan2(axis[1], axis[0])) - self.attitude_deg[2])


@dataclass
class Thing:
    position_camera_m: np.ndarray
    width_m: float = 0.2
    height_m: float = 1.0
    id: int = 1


@dataclass
class Link:
    """Calls libvista with a clock that the test moves."""

    autopilot: str = "px4"
    aircraft: Aircraft = field(default_factory=Aircraft)
    changes: dict[str, Any] = field(default_factory=dict)
    now_ns: int = START_NS

    def __post_init__(self) -> None:
        self.parameters = default_parameters()
        params = self.parameters.mavlink
        params.autopilot = AUTOPILOT[self.autopilot]
        for name, angle_deg in zip(("roll", "pitch", "yaw"), self.aircraft.mount_deg, strict=True):
            setattr(params, f"mount_{name}_deg", (angle_deg + 180.0) % 360.0 - 180.0)
        for name, value in self.changes.items():
            setattr(params, name, value)
        self.c = ffi.new("vista_mavlink *")
        self.status = status_name(lib.vista_mavlink_start(self.c, ffi.addressof(params)))
        self.decoder = dialect.MAVLink(None)
        self.raw: list[bytes] = []

    def update(
        self,
        things: list[Thing] | None = None,
        free_m: float | np.ndarray = 0.0,
        health: str = "healthy",
        t_ns: int | None = None,
        up_known: bool = True,
        blocked_m: float | np.ndarray = 0.0,
        **more: Any,
    ) -> str:
        """free_m, blocked_m: of every column, or 180 of them. t_ns: now, unless given."""
        things = things or []
        frame = ffi.new("vista_mavlink_frame *")
        items = ffi.new("vista_mavlink_obstacle[]", max(len(things), 1))
        for item, thing in zip(items, things, strict=False):
            item.id, item.width_m, item.height_m = thing.id, thing.width_m, thing.height_m
            item.position_camera_m = [float(x) for x in thing.position_camera_m]
        frame.t_ns = self.now_ns if t_ns is None else t_ns
        frame.health, frame.obstacles, frame.obstacle_count = HEALTH[health], items, len(things)
        frame.directions.up_known = up_known
        frame.directions.up_camera = self.aircraft.up_camera.tolist() if up_known else [0.0, -1.0, 0.0]
        frame.directions.free_m = np.broadcast_to(np.float32(free_m), COLUMNS).tolist()
        frame.directions.blocked_m = np.broadcast_to(np.float32(blocked_m), COLUMNS).tolist()
        reason = ffi.new("char[]", more.pop("reason", "").encode())
        frame.reason = reason
        for name, value in more.pop("collision", {}).items():
            setattr(frame.collision, name, value)
        assert not more
        return status_name(lib.vista_mavlink_update(self.c, frame))

    def next(self) -> Any:
        """One message, decoded; None when nothing is due."""
        count, room = ffi.new("int32_t *"), ffi.new("uint8_t[]", lib.VISTA_MAVLINK_BYTES)
        assert status_name(lib.vista_mavlink_next(self.c, self.now_ns, room, len(room), count)) == "VISTA_OK"
        if count[0] == 0:
            return None
        data = bytes(ffi.buffer(room, count[0]))
        self.raw.append(data)
        (decoded,) = self.decoder.parse_buffer(data)
        return decoded

    def poll(self) -> list[Any]:
        """Everything that is due now."""
        messages = []
        while (message := self.next()) is not None:
            messages.append(message)
            assert len(messages) < 100
        return messages

    def step(self, milliseconds: float) -> list[Any]:
        self.now_ns += round(milliseconds * MS)
        return self.poll()

    def one(self, kind: str) -> Any:
        """The only message of a kind that is due now."""
        found = of_kind(self.poll(), kind)
        assert len(found) == 1, found
        return found[0]


def of_kind(messages: list[Any], kind: str) -> list[Any]:
    return [message for message in messages if message.get_type() == kind]


def obstacle_sectors(message: Any) -> dict[int, int]:
    """Sector -> centimetres, of those that hold an obstacle."""
    return {k: d for k, d in enumerate(message.distances) if d <= message.max_distance}


def clear_sectors(message: Any) -> set[int]:
    return {k for k, d in enumerate(message.distances) if d == message.max_distance + 1}


def columns(first_deg: float, last_deg: float, free_m: float = 100.0) -> np.ndarray:
    """Free between two azimuths from where the camera looks."""
    left = FIRST_DEG + np.arange(COLUMNS)
    return np.where((left >= first_deg) & (left + 1 <= last_deg), free_m, 0.0)


def view(link: Link, *things: Thing, health: str = "healthy") -> None:
    """A frame of a camera that sees 30 degrees to each side."""
    assert link.update(list(things), columns(-30, 30), health) == "VISTA_OK"


def deliver(link: Link, receiver: Any, milliseconds_later: float = 0.0) -> None:
    for message in link.step(milliseconds_later):
        receiver.receive(message, milliseconds(link))


def milliseconds(link: Link) -> float:
    return (link.now_ns - START_NS) / MS
