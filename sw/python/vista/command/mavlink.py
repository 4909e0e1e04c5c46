"""Send the obstacles of a run to an autopilot as MAVLink, in real time.

RESULT is the folder that `vista run` wrote, or its obstacles.jsonl. Each frame is sent when its time has
come, as an aircraft with these cameras would send it; a second after the last one the command ends. [mavlink]
in FILE.toml says which autopilot it is, how the camera hangs, and how far distances go.

TARGET is one of:
  udp:HOST:PORT         where the autopilot, its simulator or a MAVLink router listens
  serial:DEVICE[:BAUD]  a serial line to it, such as serial:/dev/ttyUSB0:921600
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

from vista.command.arguments import add_config
from vista.errors import EXIT_INTERRUPTED, EXIT_OK
from vista.interruption import Interruption
from vista.mavlink.link import Link
from vista.mavlink.replay import Clock, Sent, replay
from vista.mavlink.sighting import read_sightings
from vista.mavlink.transport import Transport, open_transport
from vista.parameters import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("result", type=Path, metavar="RESULT", help="folder of a run, or its obstacles.jsonl")
    parser.add_argument("--to", required=True, metavar="TARGET", help="udp:HOST:PORT or serial:DEVICE[:BAUD]")
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    values = load(arguments.config)
    sightings = read_sightings(arguments.result)
    link = Link(values)
    transport = open_transport(arguments.to)
    interruption = Interruption()
    clock = Clock(time.monotonic_ns, lambda duration_ns: time.sleep(1e-9 * duration_ns))
    try:
        with interruption.watch():
            sent = replay(sightings, link, transport, clock, lambda: interruption.requested)
    finally:
        transport.close()
    line = summary(sent, transport, values["mavlink"]["autopilot"], arguments.to)
    if interruption.requested:
        print(f"vista: interrupted: {line}", file=sys.stderr)
        return EXIT_INTERRUPTED
    print(line)
    return EXIT_OK


def summary(sent: Sent, transport: Transport, autopilot: str, target: str) -> str:
    return f"{sent.frames} frames to {autopilot} at {target}: {sent_messages(sent.messages, transport)}"


def sent_messages(messages: Counter[str], transport: Transport) -> str:
    counts = ", ".join(f"{count} {name}" for name, count in sorted(messages.items()))
    return counts + (f", {transport.lost} of them lost" if transport.lost else "")
