"""Cameras that deliver pairs and know their own calibration, as OAK and RealSense do.

Each kind is a module with `open_device`; what they have in common is here: the name on the command line, the
frames of a live run, and opening the device again after it was lost.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from threading import Event
from typing import Protocol

from vista.calibration.formats.toml import written
from vista.calibration.rig import rig_of
from vista.errors import InputError
from vista.geometry import RawCalibration
from vista.live.camera import REOPEN_S, Image, tell
from vista.live.source import Shot
from vista.sequence import Frame

KINDS = {"oak": "depthai", "realsense": "pyrealsense2"}  # name on the command line: the package it needs
WAIT_S = 0.1  # for a pair, before somebody who stops the run is heard
SILENT_S = 2.0  # without a pair a device counts as lost


@dataclass(frozen=True)
class Pair:
    left: Image
    right: Image
    exposed_ns: int  #: on time.monotonic_ns()


class Device(Protocol):
    """An open camera that streams."""

    @property
    def calibration(self) -> RawCalibration:
        """Cameras of the images that it delivers."""
        ...

    def read(self, timeout_s: float) -> Pair | None:
        """Returns the next pair; None: there was none in this time. OSError: the device is gone."""
        ...

    def close(self) -> None: ...


Opener = Callable[[str, tuple[int, int] | None], Device]


def is_stereo_camera(name: str) -> bool:
    """Tells whether a device's name on the command line is KIND or KIND:SERIAL."""
    return name.split(":")[0] in KINDS


def opener(name: str) -> Opener:
    """The function that opens devices of this kind. InputError where its package is not installed."""
    kind = name.split(":")[0]
    try:
        module = importlib.import_module(f"vista.live.{kind}")
    except ModuleNotFoundError:
        advice = f"pip install 'vista-stereo[{kind}]'"
        raise InputError(name, f"needs the package {KINDS[kind]}: {advice}") from None
    except ImportError as error:  # such as a library of the system that the package needs
        raise InputError(name, f"the package {KINDS[kind]} does not load: {error}") from None
    made: Opener = module.open_device
    return made


class StereoCamera:
    """A source of a live run. Without poses: the host is told nothing of the aircraft's motion."""

    def __init__(
        self, name: str, size_px: tuple[int, int] | None = None, open_device: Opener | None = None
    ) -> None:
        """name: KIND or KIND:SERIAL; size_px: (width, height) of one image, None: what the device does by
        default. Raises InputError for a device that is not there or does not deliver this size."""
        self.skipped = 0  # the device pairs its pictures itself
        self._name, self._asked_px = name, size_px
        self._open = open_device or opener(name)
        self._device: Device | None = self._open(name, size_px)
        self.calibration = self._device.calibration

    @property
    def size_px(self) -> tuple[int, int]:
        """(width, height) of one image."""
        return self.calibration.left.width, self.calibration.left.height

    def close(self) -> None:
        if self._device is not None:
            self._device.close()
            self._device = None

    def shots(self, stopped: Event) -> Iterator[Shot]:
        index, heard_s = 0, time.monotonic()
        while not stopped.is_set():
            pair = self._read()
            if pair is not None:
                heard_s = time.monotonic()
                yield Shot(Frame(index, pair.exposed_ns, pair.left, pair.right, None), pair.exposed_ns)
                index += 1
            elif self._device is None or time.monotonic() - heard_s > SILENT_S:
                self._reopen(stopped)
                heard_s = time.monotonic()

    def _read(self) -> Pair | None:
        if self._device is None:
            return None
        try:
            return self._device.read(WAIT_S)
        except OSError:
            self._lose()
            return None

    def _lose(self) -> None:
        tell(self._name, "lost; trying to open it again")
        self.close()

    def _reopen(self, stopped: Event) -> None:
        if self._device is not None:
            self._lose()
        if stopped.wait(REOPEN_S):
            return
        try:
            device = self._open(self._name, self._asked_px)
        except InputError:
            return
        if written(rig_of(device.calibration)) != written(rig_of(self.calibration)):
            device.close()
            tell(self._name, "another device than before: it is not taken")
            return
        self._device = device
        tell(self._name, "back")


def serial_of(name: str) -> str | None:
    """SERIAL of KIND:SERIAL."""
    return name.partition(":")[2] or None


def monotonic_ns(age_s: float) -> int:
    """The moment so long ago on time.monotonic_ns(). An age that no picture has counts as none."""
    return time.monotonic_ns() - int(1e9 * age_s if 0.0 <= age_s <= 10.0 else 0)
