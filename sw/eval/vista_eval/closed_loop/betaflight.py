"""A multirotor that the flight controller Betaflight flies, as published, in the time of the simulation.

Betaflight 4.6 (GPLv3) is what quadrotors of research and racing carry. Here its simulator target takes the
inner loops of the multirotor: what is asked for goes to it as collective thrust and turn rates, on the
channels of its receiver, as companion computers fly it. Arming, filters, its PID loops at 8 kHz, mixing and
what happens where motors saturate are its own. Airframe, motors, air and wind are those of the multirotor, in
steps of 1 ms, and its gyroscopes are exact, but for their resolution.

The program listens on UDP for the state of the simulation and for the channels of the receiver, and sends
what the motors are to do. `sw/eval/src/preload/lockstep.c` is loaded before it and gives it time, so it waits
while images are rendered, and the same flight is the same to the byte. `make betaflight` builds both."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import select
import socket
import struct
import subprocess
import tempfile
import time
import weakref
from functools import cache
from pathlib import Path

import numpy as np
from vista.errors import InputError
from vista.native import CHECKOUT

from vista_eval.closed_loop.vehicle import (
    GRAVITY_M_S2,
    RATE_GAIN,
    STEP_S,
    TILT_GAIN,
    Multirotor,
    airframe,
)

FOLDER = "build/tools/betaflight"
INSTALL = "make betaflight"
HOST = "127.0.0.1"
CLI_PORT, MOTORS_PORT, STATE_PORT, CHANNELS_PORT = 5761, 9002, 9003, 9004
PORTS_APART, MOST_FLIGHTS = 16, 64  # of flights side by side
INNER_STEP_NS, BOOT_STEP_NS = 1_000_000, 10_000_000
INNER_STEPS = round(STEP_S * 1e9) // INNER_STEP_NS
READY_S = 3.0  # after power-up: the receiver of the simulation is there
GRACE_S, ARMING_S, HOVER_S = (
    6.0,
    0.5,
    0.5,
)  # before it can be armed, until it is, with the thrust that carries it
ANSWER_S = 20.0  # of the computer's time: it has stopped when it has not answered for so long
# One dialogue in a hundred is not answered: threads of Betaflight share the connection without a lock.
TYPED_S, DIALOGUES = 5.0, 4

# Rates that are linear in the stick, a switch that arms, and gains for this airframe. Motors that lag 50 ms
# leave less integral and ask for more differential gain than Betaflight has by default. The drag of its
# propellers turns it so weakly that yaw has the highest gain that can be set.
MOST_RATE_DEG_S = 360
AXES = "roll", "pitch", "yaw"
SETTINGS = (
    *(f"set {axis}_{name} = {MOST_RATE_DEG_S // 10}" for axis in AXES for name in ("rc_rate", "srate")),
    "aux 0 0 0 1700 2100 0 0",
    "set simplified_pids_mode = OFF",
    *(
        f"set {gain}_{axis} = {value}"
        for axis in AXES[:2]
        for gain, value in (("i", 5), ("d", 60), ("d_max", 0))
    ),
    *("set p_yaw = 250", "set i_yaw = 10"),
    *(f"set f_{axis} = 0" for axis in AXES),
)
MIDDLE, STICK, LOW, SWITCHED = 1500, 500, 1000, 1900  # of a channel, microseconds
CHANNELS = 16


def program() -> tuple[Path, Path]:
    """Betaflight's simulator target, and the library that gives it time."""
    airframe()
    paths = None if CHECKOUT is None else (CHECKOUT / FOLDER / "sitl", CHECKOUT / FOLDER / "lockstep.so")
    if paths is None or not all(path.is_file() for path in paths):
        raise InputError("--vehicle", f"Betaflight is not built: {INSTALL}")
    return paths


def ended(
    process: subprocess.Popen[bytes], descriptors: tuple[int, ...], sockets: tuple[socket.socket, ...]
) -> None:
    process.kill()
    process.wait()
    for descriptor in descriptors:
        os.close(descriptor)
    for one in sockets:
        one.close()


class FlightController:
    """A process of Betaflight that has the settings in `memory`, the content of its EEPROM."""

    def __init__(self, memory: bytes = b"") -> None:
        sitl, lockstep = program()
        self.folder = tempfile.TemporaryDirectory(prefix="betaflight")
        if memory:
            self.memory.write_bytes(memory)
        self._motors, self.offset = free_ports()
        self._told = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        given, self._give = os.pipe()
        self._done, done = os.pipe()
        # By a path without spaces, of which LD_PRELOAD makes several libraries.
        (Path(self.folder.name) / lockstep.name).symlink_to(lockstep)
        told = {"LD_PRELOAD": f"./{lockstep.name}", "VISTA_LOCKSTEP": f"{given} {done} {self.offset}"}
        with (Path(self.folder.name) / "log.txt").open("wb") as log:
            self.process = subprocess.Popen(
                [sitl],
                cwd=self.folder.name,
                env={**os.environ, **told},
                pass_fds=(given, done),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
            )
        for theirs in (given, done):
            os.close(theirs)
        weakref.finalize(self, ended, self.process, (self._give, self._done), (self._motors, self._told))
        self._now_ns = 1_000_000_000
        self._expect(b"w")

    @property
    def memory(self) -> Path:
        return Path(self.folder.name) / "eeprom.bin"

    def run(self, ns: int) -> None:
        """Lets it go on for so long. InputError: it has ended."""
        self._now_ns += ns
        with contextlib.suppress(BrokenPipeError):
            os.write(self._give, struct.pack("=q", self._now_ns))
        self._expect(b"w")

    def tell_channels(self, channels: list[int]) -> None:
        values = channels + [MIDDLE] * (CHANNELS - len(channels))
        self._tell(CHANNELS_PORT, struct.pack(f"=d{CHANNELS}H", self._now_ns * 1e-9, *values))

    def tell_state(self, rates_rad_s: np.ndarray, force_m_s2: np.ndarray, quaternion: np.ndarray) -> None:
        """rates and specific force in the body (forward, left, up); world_from_body as x, y, z, w."""
        roll, pitch, yaw = rates_rad_s
        x, y, z, w = quaternion
        packet = (roll, -pitch, -yaw, *-force_m_s2, w, x, y, z, *np.zeros(6), 101325.0)
        self._tell(STATE_PORT, struct.pack("=18d", self._now_ns * 1e-9, *packet))

    def motors(self) -> np.ndarray | None:
        """What it last told the motors, 0 to 1: front right, rear left, front left, rear right."""
        newest = None
        while True:
            try:
                newest = self._motors.recv(64)
            except BlockingIOError:
                return None if newest is None else np.array(struct.unpack("=4f", newest), float)

    def _tell(self, port: int, packet: bytes) -> None:
        self._told.sendto(packet, (HOST, port + self.offset))
        self._expect(b"p")

    def _expect(self, what: bytes) -> None:
        if not select.select([self._done], [], [], ANSWER_S)[0]:
            raise InputError("Betaflight", f"has not answered for {ANSWER_S:g} s")
        if os.read(self._done, 1) != what:
            raise InputError("Betaflight", f"ended with status {self.process.wait()}")


def free_ports() -> tuple[socket.socket, int]:
    """A socket that takes what the motors are told, and how far all ports are moved for it."""
    for offset in range(0, MOST_FLIGHTS * PORTS_APART, PORTS_APART):
        motors = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        motors.setblocking(False)
        try:
            motors.bind((HOST, MOTORS_PORT + offset))
        except OSError as error:
            motors.close()
            if error.errno != errno.EADDRINUSE:
                raise
        else:
            return motors, offset
    raise InputError("Betaflight", f"no port from {MOTORS_PORT} on is free")


class UnansweredError(InputError):
    """The command line of Betaflight is not there, or has said nothing for TYPED_S."""


@cache
def settled() -> bytes:
    """The memory of a controller that was told SETTINGS, as its users tell it: typed, and saved."""
    for _ in range(DIALOGUES - 1):
        with contextlib.suppress(UnansweredError):
            return told_settings(FlightController())
    return told_settings(FlightController())


def told_settings(controller: FlightController) -> bytes:
    controller.run(round(READY_S * 1e9))
    with connection(CLI_PORT + controller.offset) as typed:
        typed.sendall(b"#")
        answer(controller, typed)
        for line in SETTINGS:
            typed.sendall(f"{line}\n".encode())
            said = answer(controller, typed)
            if "ERROR" in said:
                raise InputError("Betaflight", f'does not take "{line}": {said}')
        typed.sendall(b"save\n")
        while controller.process.poll() is None:
            try:
                controller.run(BOOT_STEP_NS)
            except InputError:
                break
    return controller.memory.read_bytes()


def connection(port: int) -> socket.socket:
    try:
        typed = socket.create_connection((HOST, port))
    except ConnectionRefusedError as error:
        raise UnansweredError("Betaflight", f"its command line is not there: {error}") from None
    typed.setblocking(False)
    return typed


def answer(controller: FlightController, typed: socket.socket) -> str:
    """What is said until the next prompt."""
    said, until_s = "", time.monotonic() + TYPED_S
    while not said.endswith("\n# "):
        controller.run(BOOT_STEP_NS)
        try:
            said += typed.recv(4096).decode(errors="replace")
        except BlockingIOError:
            time.sleep(0.001)
        if time.monotonic() > until_s:
            raise UnansweredError("Betaflight", f"its command line does not answer: {said[-80:]!r}")
    return said


class Betaflight(Multirotor):
    """Hovers at the place, armed, until it is first told to go elsewhere."""

    def __init__(self, position_m: np.ndarray, heading_rad: float) -> None:
        super().__init__(position_m, heading_rad, control="cmd_motor_speeds", step_s=INNER_STEP_NS * 1e-9)
        self._controller = FlightController(settled())
        self._controller.run(round(READY_S * 1e9))
        self._force_m_s2 = np.array([0.0, 0.0, GRAVITY_M_S2])  # specific, in the body
        self._speeds_rad_s = np.zeros(4)
        hover = self._throttle(self._model.mass * GRAVITY_M_S2)
        for seconds, channels in (
            (GRACE_S, [MIDDLE, MIDDLE, LOW, MIDDLE, LOW]),
            (ARMING_S, [MIDDLE, MIDDLE, LOW, MIDDLE, SWITCHED]),
            (HOVER_S, [MIDDLE, MIDDLE, hover, MIDDLE, SWITCHED]),
        ):
            for _ in range(round(seconds * 1e9) // BOOT_STEP_NS):
                self._controller.tell_channels(channels)
                self._speeds_rad_s = self._exchange(BOOT_STEP_NS)
        if not np.any(self._speeds_rad_s > 0.0):
            raise InputError("Betaflight", "cannot be armed")

    def _fly(self, force_n: np.ndarray) -> None:
        up = self.up(force_n)
        tilt = TILT_GAIN / RATE_GAIN  # the turn rates that the multirotor's own controller is after
        self._controller.tell_channels(
            [
                stick(-tilt * up[1]),
                stick(tilt * up[0]),
                self._throttle(self.collective_n(force_n)),
                stick(-self._turn_rad_s),
                SWITCHED,
            ]
        )
        for _ in range(INNER_STEPS):
            before = self._state["v"]
            told = {"cmd_motor_speeds": self._speeds_rad_s}
            self._state = self._model.step(self._state, told, INNER_STEP_NS * 1e-9)
            free_fall = np.array([0.0, 0.0, -GRAVITY_M_S2])
            moved_m_s2 = (self._state["v"] - before) / (INNER_STEP_NS * 1e-9)
            self._force_m_s2 = self.state.rotation.T @ (moved_m_s2 - free_fall)
            self._speeds_rad_s = self._exchange(INNER_STEP_NS)

    def _exchange(self, ns: int) -> np.ndarray:
        """The speeds that the motors are told after so long, in rotorpy's order, which is Betaflight's."""
        self._controller.tell_state(self._state["w"], self._force_m_s2, self._state["q"])
        self._controller.run(ns)
        motors = self._controller.motors()
        return self._speeds_rad_s if motors is None else motors * self._model.rotor_speed_max

    def _throttle(self, thrust_n: float) -> int:
        """The channel for a thrust of all rotors: they turn at the share of their most that it stands for."""
        most_n = 4 * self._model.k_eta * self._model.rotor_speed_max**2
        return LOW + round(2 * STICK * math.sqrt(thrust_n / most_n))


def stick(rate_rad_s: float) -> int:
    share = math.degrees(rate_rad_s) / MOST_RATE_DEG_S
    return MIDDLE + round(STICK * min(1.0, max(-1.0, share)))
