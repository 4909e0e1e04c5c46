"""libvista's link to one autopilot: frames in, the bytes of messages out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from vista import native, parameters
from vista.errors import InputError
from vista.health.finding import State
from vista.mavlink.sighting import Sighting
from vista.pipeline import c_parameters

HEALTH = {
    State.HEALTHY: "VISTA_HEALTH_HEALTHY",
    State.DEGRADED: "VISTA_HEALTH_DEGRADED",
    State.BLIND: "VISTA_HEALTH_BLIND",
}

LEVEL = (0.0, -1.0, 0.0)  # up, in a camera of which nothing is known


class Link:
    """Every time is in nanoseconds of one clock, which starts at 0 or later and never goes back."""

    def __init__(self, values: parameters.Values) -> None:
        """Raises InputError when the section [mavlink] contradicts itself."""
        self._ffi, self._lib = native.load("vista")
        self._parameters = c_parameters(self._ffi, self._lib, values)
        self._link = self._ffi.new("vista_mavlink *")
        self._count = self._ffi.new("int32_t *")
        self._bytes = self._ffi.new("uint8_t[]", self._lib.VISTA_MAVLINK_BYTES)
        params = self._ffi.addressof(self._parameters, "mavlink")
        if self._lib.vista_mavlink_start(self._link, params) != self._lib.VISTA_OK:
            raise InputError("mavlink.angle_offset_deg", "must be a multiple of a sector")

    def update(self, sighting: Sighting, t_ns: int) -> None:
        """t_ns: of the exposure, on the link's clock; later than that of the frame before."""
        frame = self._ffi.new("vista_mavlink_frame *")
        reason = self._ffi.new("char[]", sighting.reason.encode(errors="replace"))
        boards = self._ffi.new("vista_mavlink_obstacle[]", len(sighting.obstacles))
        for to, board in zip(boards, sighting.obstacles, strict=True):
            to.id, to.position_camera_m = board.id, board.position_camera_m
            to.width_m, to.height_m = board.width_m, board.height_m
        frame.t_ns, frame.reason = t_ns, reason
        frame.health = getattr(self._lib, HEALTH[sighting.health])
        frame.obstacles, frame.obstacle_count = boards, len(sighting.obstacles)
        seen = sighting.directions
        frame.directions.free_m, frame.directions.blocked_m = seen.free_m.tolist(), seen.blocked_m.tolist()
        frame.directions.up_known = seen.up_camera is not None
        frame.directions.up_camera = LEVEL if seen.up_camera is None else seen.up_camera.tolist()
        if sighting.collision is not None:
            to = frame.collision
            to.valid, to.id, to.time_s = True, sighting.collision.id, sighting.collision.time_s
            to.position_camera_m = sighting.collision.position_camera_m
            to.velocity_camera_m_s = sighting.collision.velocity_camera_m_s
        self._check(self._lib.vista_mavlink_update(self._link, frame))

    def due(self, now_ns: int) -> Iterator[bytes]:
        """Each message that is due now, as a frame of MAVLink 2."""
        size = len(self._bytes)
        while True:
            self._check(self._lib.vista_mavlink_next(self._link, now_ns, self._bytes, size, self._count))
            if self._count[0] == 0:
                return
            yield bytes(self._ffi.buffer(self._bytes, self._count[0]))

    def _check(self, status: Any) -> None:
        if status != self._lib.VISTA_OK:
            raise ValueError(self._ffi.string(self._lib.vista_status_text(status)).decode())
