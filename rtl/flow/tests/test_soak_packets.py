# SPDX-License-Identifier: Apache-2.0
"""The server of the board against packets that it must not obey; one that it obeys is noticed."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
import soak_packets
import wire
from hostile_packets import Known
from tools import ROOT

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not (ROOT / ".venv" / "board.stamp").is_file() or shutil.which("make") is None,
        reason="LiteX is not set up: make soak-packets",
    ),
]


def made(library: Path) -> Path:
    command = ["make", "--no-print-directory", str(library.relative_to(ROOT))]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return library


@pytest.fixture(scope="module")
def library() -> Path:
    return made(soak_packets.LIBRARY)


def test_no_packet_that_is_not_sound_has_an_effect(library: Path) -> None:
    found = soak_packets.run(library, packets=20_000, seed=2416)
    assert found.packets >= 20_000 and found.words > 20_000


# What a server that obeys too much does not look at.
PLANTED = {
    "magic": (r"(assign server_sound = )\(.* & (\(packetbuffer_\w+_words >= .*\))\);", r"\1\2;"),
    "chunks": (r"assign server_inside = .*;", "assign server_inside = 1'd1;"),
    "length": (r"\(packetbuffer_fifo_source_payload_words == 9'd261\)", "1'd1"),
}


@pytest.mark.parametrize("flaw", PLANTED)
def test_a_server_that_obeys_too_much_is_noticed(library: Path, flaw: str) -> None:
    text, count = re.subn(*PLANTED[flaw], library.with_name("server.v").read_text())
    assert count == 1
    design = library.parent.with_name(f"server_{flaw}") / "server.v"
    design.parent.mkdir(exist_ok=True)
    if not design.is_file() or design.read_text() != text:
        design.write_text(text)
    with pytest.raises(soak_packets.WrongAnswerError):
        soak_packets.run(made(design.with_name("libserver.so")), packets=50_000, seed=2418)


@pytest.mark.parametrize("kind", ["write", "pixels", "release", "close", "open"])
def test_a_sound_packet_of_a_stranger_is_noticed(
    library: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def sound(_: object, known: Known):
        body = {
            "write": wire.to_bytes([0]),
            "pixels": bytes(4 * wire.CHUNK_WORDS),
            "open": wire.to_bytes([known.session, 8 | 8 << 16, 1, 64]),
        }.get(kind, b"")
        header = {
            "kind": wire.REQUESTS[kind],
            "session": known.session ^ (kind == "open"),
            "frame": known.last_write + 1 if kind == "write" else known.frame,
            "count": 1,
        }
        while True:
            yield wire.packet(header, body)

    monkeypatch.setattr(soak_packets, "hostile_packets", sound)
    monkeypatch.setattr(soak_packets, "CLIENT_SHARE", 1.0)  # nobody else may open a session
    with pytest.raises(soak_packets.WrongAnswerError):
        soak_packets.run(library, packets=2_000, seed=2417)
