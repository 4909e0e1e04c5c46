"""What autopilots do with distances, written anew from what their public sources and documentation say.

Px4: src/lib/collision_prevention of PX4-Autopilot, with a map of 72 bins, or of 36 in older versions; the
message is asked what of it overlaps a bin, or in older versions what it says at the angle of each bin.
ArduPilot: AP_Proximity_MAV.cpp of libraries/AP_Proximity, of 4.1 and later.
Only what a sender has to know is here. No autopilot was run: these are readings of text.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

UNKNOWN = 65535
PX4_TIMEOUT_MS = 500
BODY_FRD = 12


@dataclass
class Px4:
    """The map of collision prevention, in the body. overlapping: always with 72 bins."""

    bins: int = 72
    overlapping: bool = False
    distances: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.distances = [UNKNOWN] * self.bins
        self._seen_ms = [-math.inf] * self.bins
        self._ranges = [0] * self.bins
        self.warnings = 0

    def receive(self, message: Any, now_ms: float) -> None:
        """Times are those of the receipt: a message has none that PX4 believes."""
        if message.get_type() != "OBSTACLE_DISTANCE":
            return
        increment = message.increment_f if message.increment_f > 0.0 else float(message.increment)
        if increment <= 0.0:
            return
        if message.frame != BODY_FRD:
            self.warnings += 1
            return
        for index in range(self.bins):
            for number in self._numbers(index, increment, message.angle_offset):
                self._enter(index, message.distances[number], message.max_distance, now_ms)

    def _numbers(self, index: int, increment: float, offset_deg: float) -> list[int]:
        """Those of the message that concern a bin."""
        width = 360.0 / self.bins
        if self.bins == 36 and not self.overlapping:
            angle = np.float32((index * width - offset_deg) % 360.0)
            return [math.ceil(angle * np.float32(np.float32(1.0) / np.float32(increment)))]
        numbers = []
        for number in range(int(360.0 / increment)):
            apart = (number * increment + offset_deg - index * width + 180.0) % 360.0 - 180.0
            if abs(apart) < 0.5 * (increment + width):
                numbers.append(number)
        return numbers

    def _enter(self, index: int, distance: int, max_distance: int, now_ms: float) -> None:
        if distance == UNKNOWN:
            return
        before, before_range = self.distances[index], self._ranges[index]
        if distance < max_distance:
            taken = before >= before_range or max_distance <= before_range
        elif before >= before_range:
            taken = max_distance >= before_range
        else:
            taken = max_distance == before_range
        if taken:
            self.distances[index], self._ranges[index], self._seen_ms[index] = distance, max_distance, now_ms

    def look(self, now_ms: float) -> list[int]:
        """The map as it is used: bins that nothing came for have gone."""
        for index, seen_ms in enumerate(self._seen_ms):
            if now_ms - seen_ms > PX4_TIMEOUT_MS:
                self.distances[index] = UNKNOWN
        return self.distances

    def may_move(self, bearing_deg: float, now_ms: float) -> bool:
        """CP_GO_NO_DATA is 0: only where there are data."""
        width = 360.0 / self.bins
        return self.look(now_ms)[math.floor(bearing_deg % 360.0 / width)] != UNKNOWN


SECTORS = 8
ARDUPILOT_TIMEOUT_MS = 500
ARDUPILOT_GROUP_MS = 50


@dataclass
class ArduPilot:
    """The boundary of the proximity library: the nearest distance in each of 8 sectors and 5 layers."""

    faces: dict[tuple[int, int], float] = field(default_factory=dict)
    _update_ms: float = -math.inf
    _stamp: int | None = None
    _range_m: tuple[float, float] = (0.0, 0.0)

    def receive(self, message: Any, now_ms: float) -> None:
        if message.get_type() == "OBSTACLE_DISTANCE":
            self._sectors(message, now_ms)
        elif message.get_type() == "OBSTACLE_DISTANCE_3D":
            self._point(message, now_ms)

    def healthy(self, now_ms: float) -> bool:
        return now_ms - self._update_ms <= ARDUPILOT_TIMEOUT_MS

    @staticmethod
    def face(pitch_deg: float, yaw_deg: float) -> tuple[int, int]:
        sector = int((yaw_deg + 22.5) % 360.0 / 45.0)
        return int((min(max(pitch_deg, -75.0), 74.9) + 75.0) / 30.0), sector

    def _point(self, message: Any, now_ms: float) -> None:
        passed_ms, self._update_ms = now_ms - self._update_ms, now_ms
        before, self._stamp = self._stamp, message.time_boot_ms
        if message.frame != BODY_FRD:
            return
        if before != message.time_boot_ms or passed_ms > ARDUPILOT_GROUP_MS:
            self.faces.clear()
        forward, right, up = message.x, message.y, -message.z
        length = math.sqrt(forward**2 + right**2 + up**2)
        if not message.min_distance <= length <= message.max_distance or length == 0.0:
            return
        yaw_deg = math.degrees(math.atan2(right, forward))
        face = self.face(math.degrees(math.atan2(up, math.hypot(forward, right))), yaw_deg)
        self.faces[face] = min(length, self.faces.get(face, math.inf))

    def _sectors(self, message: Any, now_ms: float) -> None:
        """What is 0, unknown or out of range is passed over; a face that nothing is told of stays."""
        increment = message.increment_f or float(message.increment)
        if increment == 0.0:
            return
        self._update_ms = now_ms
        current, nearest = None, None
        for number in range(min(int(360.0 / abs(increment) + 0.5), 72)):
            distance = message.distances[number]
            if distance in (0, UNKNOWN) or not message.min_distance <= distance <= message.max_distance:
                continue
            face = self.face(0.0, number * increment + message.angle_offset)
            if face != current:
                self._close(current, nearest)
                current, nearest = face, None
            nearest = distance / 100.0 if nearest is None else min(nearest, distance / 100.0)
        self._close(current, nearest)

    def _close(self, face: tuple[int, int] | None, nearest: float | None) -> None:
        if face is not None and nearest is not None:
            self.faces[face] = nearest
