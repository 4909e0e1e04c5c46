"""Transports of MAVLink: UDP, or a serial line. A receiver that is lost is waited for; nothing queues up."""

from __future__ import annotations

import contextlib
import os
import socket
from time import monotonic
from typing import Protocol

import serial

from vista.errors import InputError

DEFAULT_BAUD = 921600
REOPEN_S = 1.0  # between two attempts at a serial line that has gone
WRITE_S = 0.02  # what a serial line has not taken by then is dropped


class Transport(Protocol):
    """Takes messages; those that find no receiver are lost, and counted."""

    lost: int

    def send(self, message: bytes) -> None: ...

    def close(self) -> None: ...


def open_transport(target: str) -> Transport:
    """udp:HOST:PORT or serial:DEVICE[:BAUD]. Raises InputError."""
    kind, _, rest = target.partition(":")
    if kind == "udp":
        host, _, port = rest.rpartition(":")
        if host and port.isdecimal() and 0 < int(port) < 65536:
            return Udp(target, host.strip("[]"), int(port))
    elif kind == "serial" and rest:
        device, _, baud = rest.rpartition(":")  # devices in /dev/serial/by-path have colons of their own
        if device and baud.isdecimal() and int(baud) > 0:
            return SerialLine(target, device, int(baud))
        return SerialLine(target, rest, DEFAULT_BAUD)
    raise InputError(target, "is neither udp:HOST:PORT nor serial:DEVICE[:BAUD]")


class Udp:
    """A datagram for each message, so that the loss of one is the loss of one."""

    def __init__(self, target: str, host: str, port: int) -> None:
        self.lost = 0
        try:
            family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, socket.SOCK_DGRAM)
            self._socket.setblocking(False)
            self._address = address
        except (OSError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or "no such host"
            raise InputError(target, str(reason).lower()) from None

    def send(self, message: bytes) -> None:
        try:
            self._socket.sendto(message, self._address)
        except OSError:  # no route, no room, nobody there: the next may arrive
            self.lost += 1

    def close(self) -> None:
        self._socket.close()


class SerialLine:
    """An adapter that is unplugged and plugged in again is opened again."""

    def __init__(self, target: str, device: str, baud: int) -> None:
        self.lost = 0
        self._device, self._baud = device, baud
        self._tried_s = monotonic()
        try:
            self._line: serial.Serial | None = self._open()
        except (OSError, ValueError) as error:
            raise InputError(target, _reason(error)) from None

    def send(self, message: bytes) -> None:
        if self._line is None and monotonic() - self._tried_s >= REOPEN_S:
            self._tried_s = monotonic()
            with contextlib.suppress(OSError, ValueError):
                self._line = self._open()
        if self._line is None:
            self.lost += 1
            return
        try:
            self._line.write(message)
        except serial.SerialTimeoutException:  # too slow a line: the rest of the message is dropped
            self.lost += 1
            with contextlib.suppress(OSError):
                self._line.reset_output_buffer()
        except OSError:
            self.lost += 1
            self.close()

    def close(self) -> None:
        if self._line is not None:
            with contextlib.suppress(OSError):
                self._line.close()
            self._line = None

    def _open(self) -> serial.Serial:
        return serial.Serial(self._device, self._baud, write_timeout=WRITE_S)


def _reason(error: OSError | ValueError) -> str:
    """The system's own words: pyserial's name the device once more."""
    number = error.errno if isinstance(error, OSError) else None
    return "cannot be set up as a serial line" if number is None else os.strerror(number).lower()
