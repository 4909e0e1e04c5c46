"""`vista mavlink` and bad input: one line that names the culprit, and nothing is sent."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Vista, assert_refused
from mavlink_lines import line, obstacle, write_lines
from pymavlink.dialects.v20 import ardupilotmega as dialect
from random_seed import seeded
from vista import parameters
from vista.errors import InputError
from vista.mavlink.link import Link
from vista.mavlink.sighting import sighting_of_line

TARGETS = [
    "", "udp", "udp:", "udp:127.0.0.1", "udp:127.0.0.1:0", "udp:127.0.0.1:65536", "udp::14550", "tcp:a:1",
    "udp:127.0.0.1:x", f"udp:{64 * 'h'}:14550", "serial:", "serial:/no/such/device",
    "serial:/no/such/device:57600", "serial:/dev/null",
]  # fmt: skip


@pytest.mark.parametrize("target", TARGETS)
def test_a_bad_target_takes_one_line(target: str, tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", [line(0)])
    assert_refused(run_vista("mavlink", file, "--to", target), target)


@pytest.mark.parametrize(
    "device, reason",
    [
        ("/no/such/Device", "no such file or directory"),
        ("/no/such/Device:57600", "no such file or directory"),
        ("/dev/null", "cannot be set up as a serial line"),
    ],
)
def test_a_bad_device_is_named_once(device: str, reason: str, tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", [line(0)])
    _, _, err = run_vista("mavlink", file, "--to", f"serial:{device}")
    assert err == f"vista: serial:{device}: {reason}\n"


BAD_LINES: dict[str, tuple[Any, str]] = {
    "no JSON": ("{", "not a whole line of JSON"),
    "a list": ("[]", "version 2"),
    "a number": ("7", "version 2"),
    "version 1": (line(1, version=1), "version 2"),
    "without directions": ({k: v for k, v in line(1).items() if k != "directions"}, "run vista run again"),
    "without health": ({k: v for k, v in line(1).items() if k != "health"}, "says: no 'health'"),
    "unknown health": (line(1, health={"state": "fine", "reasons": []}), "says: 'fine' is not"),
    "time of old": (line(1, t_ns=5), "time does not increase"),
    "time below 0": (line(1, t_ns=-5), "out of range"),
    "time of text": (line(1, t_ns="5"), "is no integer"),
    "position of two": (line(1, obstacles=[obstacle(1, [0.0, 1.0])]), "(expected 3, got 2)"),
    "position of text": (line(1, obstacles=[obstacle(1, ["a", 1.0, 2.0])]), "is no number"),
    "huge id": (line(1, obstacles=[obstacle(2**40, [0.0, 1.0, 2.0])]), "out of range"),
    "too many columns": (
        line(1, directions={"up_camera": None, "first_deg": 60, "free_m": [1.0] * 40}),
        "more free_m than columns",
    ),
    "without blocked distances": (
        line(1, directions={"up_camera": None, "first_deg": 0, "free_m": [1.0]}),
        "says: no 'blocked_m'",
    ),
    "obstacles of text": (line(1, obstacles="none"), "schema"),
    "deep": ("[" * 100_000, "JSON"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_LINES)
def test_a_bad_line_is_named_and_nothing_is_sent(name: str, tmp_path: Path, run_vista: Vista) -> None:
    content, text = BAD_LINES[name]
    bad = content if isinstance(content, str) else json.dumps(content)
    file = tmp_path / "obstacles.jsonl"
    file.write_text(json.dumps(line(0)) + "\n" + bad + "\n" + json.dumps(line(2)) + "\n")
    outcome = run_vista("mavlink", file, "--to", "udp:127.0.0.1:14550")
    assert_refused(outcome, text)
    assert f"{file}:2: " in outcome[2]


def test_a_missing_an_empty_and_a_binary_file(tmp_path: Path, run_vista: Vista) -> None:
    (tmp_path / "empty.jsonl").touch()
    (tmp_path / "binary.jsonl").write_bytes(b"\xff\xfe\x00")
    for name, text in (("none", "no such file"), ("empty.jsonl", "no frame"), ("binary.jsonl", "not a text")):
        assert_refused(run_vista("mavlink", tmp_path / name, "--to", "udp:127.0.0.1:14550"), text)
    assert_refused(run_vista("mavlink", tmp_path, "--to", "udp:127.0.0.1:14550"), "obstacles.jsonl")


def test_a_bad_section_of_the_configuration(tmp_path: Path, run_vista: Vista) -> None:
    file = write_lines(tmp_path / "obstacles.jsonl", [line(0)])
    config = tmp_path / "my.toml"
    for text, culprit in (
        ('autopilot = "betaflight"', "autopilot"),
        ("angle_offset_deg = 2.5", "multiple of a sector"),
        ("min_distance_m = 50.0", "min_distance_m"),
    ):
        config.write_text(f"[mavlink]\n{text}\n")
        outcome = run_vista("mavlink", file, "--to", "udp:127.0.0.1:14550", "--config", config)
        assert_refused(outcome, culprit)


def test_any_damage_of_a_line_is_refused_or_sent_as_valid_messages() -> None:
    """Values swapped, keys dropped, bytes changed: an error in one line, or messages that decode."""
    random = seeded(9)
    odd = [
        None,
        True,
        -1,
        0,
        2**31,
        10**30,
        1e308,
        -1e308,
        "",
        "x",
        [],
        [[]],
        {},
        [None, None, None],
        [1e300] * 3,
    ]
    links = 0
    for _ in range(400):
        content = line(0)
        for _ in range(random.integers(1, 3)):
            damage(content, odd, random)
        text = json.dumps(content)
        if random.random() < 0.2:
            at = random.integers(len(text))
            text = text[:at] + chr(random.integers(32, 127)) + text[at + 1 :]
        try:
            sighting = sighting_of_line("here", text)
        except InputError as error:
            assert "\n" not in str(error)
            continue
        links += 1
        link, decoder = Link(parameters.defaults()), dialect.MAVLink(None)
        link.update(sighting, 10**9)
        for message in link.due(10**9):
            (decoded,) = decoder.parse_buffer(message)
            assert decoded.get_type() != "BAD_DATA"
            if decoded.get_type() == "OBSTACLE_DISTANCE":
                assert all(30 <= d <= 4001 or d == 65535 for d in decoded.distances)
    assert links > 40


def damage(value: Any, odd: list[Any], random: np.random.Generator) -> None:
    """One place, at any depth."""
    keys = list(value) if isinstance(value, dict) else list(range(len(value)))
    key = keys[random.integers(len(keys))]
    inner = value[key]
    if isinstance(inner, dict | list) and inner and random.random() < 0.7:
        damage(inner, odd, random)
    elif isinstance(value, dict) and random.random() < 0.2:
        del value[key]
    else:
        value[key] = copy.deepcopy(odd[random.integers(len(odd))])
