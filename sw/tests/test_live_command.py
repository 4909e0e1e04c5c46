"""`vista live`: a recording as it was taken, to a file, an autopilot and a page."""

from __future__ import annotations

import http.client
import json
import socket
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from browser import Page, needs_browser
from command_line import Vista, assert_refused, lines_without_times
from live_process import READY_S, running, until
from obstacle_schema import VALIDATOR
from pymavlink.dialects.v20 import ardupilotmega as dialect

pytestmark = pytest.mark.slow


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    return cases.make_flown_pairs(tmp_path / "flight", 6)


def test_it_finds_what_a_run_finds(tmp_path: Path, flight: Path, run_vista: Vista) -> None:
    """Slowly enough that no frame is dropped, even by a machine that does other things."""
    assert run_vista("run", flight, "--out", tmp_path / "run")[0] == 0
    (tmp_path / "live").mkdir()
    file = tmp_path / "live" / "obstacles.jsonl"
    status, out, err = run_vista("live", flight, "--out", file, "--no-page", "--speed", "0.05")
    assert (status, out) == (0, "")
    assert lines_without_times(file.parent) == lines_without_times(tmp_path / "run")
    assert "6 frames processed, 0 dropped for newer ones, 0 duplicates" in err
    assert "from the exposure to the result" in err


def test_lines_go_to_stdout(flight: Path, run_vista: Vista) -> None:
    status, out, _ = run_vista("live", flight, "--out", "-", "--no-page", "--speed", "0.2")
    assert status == 0 and out
    for line in out.splitlines():
        VALIDATOR.validate(json.loads(line))


def test_an_autopilot_hears_of_it(flight: Path, run_vista: Vista) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(0.0)
        target = f"udp:127.0.0.1:{receiver.getsockname()[1]}"
        status, _, err = run_vista("live", flight, "--to", target, "--no-page", "--speed", "0.2")
        data = b""
        while (message := try_to_receive(receiver)) is not None:
            data += message
    kinds = [m.get_type() for m in dialect.MAVLink(None).parse_buffer(data) or []]
    assert status == 0
    assert "BAD_DATA" not in kinds
    assert kinds.count("OBSTACLE_DISTANCE") >= 6 and "HEARTBEAT" in kinds
    assert f"{target}: from the exposure to the message" in err and "OBSTACLE_DISTANCE" in err


def try_to_receive(receiver: socket.socket) -> bytes | None:
    try:
        return receiver.recv(4096)
    except BlockingIOError:
        return None


BAD = [
    (("--speed", "0"), "is not from 0.01 to 100"),
    (("--speed", "fast"), "--speed"),
    (("--page", "65536"), "is not a port"),
    (("--to", "tcp:somewhere"), "is neither udp:HOST:PORT nor serial:"),
    (("--out", "/no/such/folder/file.jsonl"), "cannot be written"),
    (("--frames", "100:"), "selects none"),
]


@pytest.mark.parametrize("arguments, text", BAD)
def test_bad_arguments_take_one_line(
    arguments: tuple[str, str], text: str, flight: Path, run_vista: Vista
) -> None:
    assert_refused(run_vista("live", flight, "--no-page", *arguments), text)


def test_a_port_in_use_is_named(tmp_path: Path, flight: Path, run_vista: Vista) -> None:
    """That comes before the lines of an earlier run are given up."""
    lines = tmp_path / "lines.jsonl"
    lines.write_text("of an earlier run")
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        ran = run_vista("live", flight, "--page", port, "--out", lines)
    assert_refused(ran, f"--page {port}: address already in use")
    assert lines.read_text() == "of an earlier run"


def test_stills_are_refused(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_board_scenes(tmp_path / "stills", 2, stills=True)
    assert_refused(run_vista("live", folder, "--no-page"), "use vista run")


def test_an_image_that_cannot_be_read_ends_it(tmp_path: Path, flight: Path, run_vista: Vista) -> None:
    sorted(flight.glob("*_right.png"))[2].write_bytes(b"no image")
    status, _, err = run_vista("live", flight, "--no-page", "--out", tmp_path / "o.jsonl", "--speed", "0.1")
    assert status == 2 and "scene02_right.png" in err.splitlines()[-1]
    assert len((tmp_path / "o.jsonl").read_text().splitlines()) == 2


def test_the_page_is_served_to_this_machine(flight: Path) -> None:
    with running(flight, "--repeat", "--speed", 0.5) as live:
        assert live.get("/")[:2] == (200, "text/html; charset=utf-8")
        state = json.loads(live.get("/state")[2])
        VALIDATOR.validate(state["line"])
        assert state["autopilot"] is None and state["processed"] > 0 and state["age_ms"] > 0.0
        for query, height in (("", cases.HEIGHT), ("?whole", 2 * cases.HEIGHT)):
            status, kind, jpeg = live.get(f"/picture.jpg{query}")
            picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
            assert (status, kind) == (200, "image/jpeg") and picture.shape[0] >= height
        assert live.get("/etc/passwd")[0] == live.get("/../secret")[0] == 404
        # Another site whose name leads here is refused: a page of it could else read what the camera sees.
        assert live.get("/", host="evil.example")[0] == 403
        assert live.get("/", host=f"localhost:{live.port}")[0] == 200
        with pytest.raises(OSError), socket.create_connection((other_address(), live.port), 0.5):
            pass
        status, err = live.stop()
    assert status == 130
    assert err.splitlines()[-1] == "vista: interrupted" and " processed, " in err


def other_address() -> str:
    """Another address of this machine, or of the loopback interface where it has no other."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
            return str(probe.getsockname()[0])
        except OSError:
            return "127.0.0.2"


def test_states_are_streamed(flight: Path) -> None:
    with running(flight, "--repeat", "--speed", 0.5) as live:
        connection = http.client.HTTPConnection("127.0.0.1", live.port, timeout=READY_S)
        connection.request("GET", "/states")
        answer = connection.getresponse()
        assert answer.getheader("Content-Type") == "text/event-stream"
        states: list[dict[str, Any]] = []
        while len({state["processed"] for state in states}) < 3:
            line = answer.readline()
            if line.startswith(b"data: "):
                states.append(json.loads(line[6:]))
        connection.close()
        counts = [state["processed"] for state in states]
        assert counts == sorted(counts)
        assert live.stop()[0] == 130


@needs_browser
def test_the_page_in_a_browser(tmp_path: Path) -> None:
    folder = cases.make_flown_pairs(tmp_path / "a <b> & 'c'", 6)
    page = Page(tmp_path / "profile")
    try:
        with running(folder, "--repeat", "--speed", 0.5) as live:
            page.call("Page.navigate", url=live.url)
            until(lambda: page.run("document.getElementById('picture')?.naturalWidth") == cases.WIDTH)
            assert page.run("document.querySelector('h1').textContent") == "a <b> & 'c'"
            assert page.run("document.getElementById('rate').textContent").endswith(" Hz")
            shown = "document.getElementById('frame').textContent"
            before = page.run(shown)
            until(lambda: page.run(shown) != before)
            page.run("document.getElementById('whole').click()")
            until(lambda: page.run("document.getElementById('picture').naturalWidth") > 2 * cases.WIDTH)
            for width_px in (375, 1300):
                page.call(
                    "Emulation.setDeviceMetricsOverride",
                    width=width_px,
                    height=900,
                    deviceScaleFactor=1,
                    mobile=False,
                )
                page.settle()
                assert page.run("document.documentElement.scrollWidth <= innerWidth")
            blind = (
                "state.line.health.state = 'blind'; state.reasons = ['the left image is nearly constant'];"
                "state.line.nearest_collision = {distance_m: 12, time_to_collision_s: 3};"
                "banner(); figures();"
                "[$('banner').className, $('banner').textContent, $('nearest').textContent].join('|')"
            )
            why = "Blind: the left image is nearly constant"
            ahead = "collision ahead: 12.0 m, in 3.0 s"
            assert page.run(blind) == f"note blind|{why}. Carried on from before: {ahead}|\u2013"
            assert page.problems == []
            live.process.kill()
            banner = "document.getElementById('banner').textContent"
            until(lambda: "does not answer" in page.run(banner))
    finally:
        page.close()
