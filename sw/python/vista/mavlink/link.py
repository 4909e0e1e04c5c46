"""libvista's link to one autopilot: frames in, the bytes of messages out."""

from __future__ import annotations

from collections.abc import Iterator

from vista import native, parameters
from vista.errors import InputError
from vista.mavlink.sighting import Sighting
from vista.pipeline import c_parameters


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
        sighting.frame.t_ns = t_ns
        self._check(self._lib.vista_mavlink_update(self._link, sighting.frame))

    def due(self, now_ns: int) -> Iterator[bytes]:
        """Each message that is due now, as a frame of MAVLink 2."""
        size = len(self._bytes)
        while True:
            self._check(self._lib.vista_mavlink_next(self._link, now_ns, self._bytes, size, self._count))
            if self._count[0] == 0:
                return
            yield bytes(self._ffi.buffer(self._bytes, self._count[0]))

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)
