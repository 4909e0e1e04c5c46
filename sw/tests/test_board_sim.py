"""The client against the board itself, Verilated: engine, memory, Ethernet, and a link that loses."""

from __future__ import annotations

import contextlib
import json
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from itertools import pairwise
from pathlib import Path
from random import Random

import board_clocks
import numpy as np
import pytest
import sequence_cases as cases
import wire
from board_client import SETTINGS, BoardError, Client, golden, lib, random_pair, random_settings
from board_words import WordsAlone, raw_bytes, shown_pairs, written
from command_line import Vista, call, lines_without_times, without_time
from hostile_packets import Known, hostile_packets
from random_seed import seeded
from shared_data import REPOSITORY
from vista.engine.rtl import VERILATOR

PROGRAM = Path("build/board/d16_b5_w320_r16/board-sim")
CLOCKS = PROGRAM.with_name("board-clocks")
TIMEOUT_MS = 20000
FAULTS = ["--drop", "0.01", "--double", "0.01", "--damage", "0.01"]

pytestmark = [pytest.mark.slow, pytest.mark.same_c, pytest.mark.skipif(
    not (REPOSITORY / VERILATOR).is_file() or not (REPOSITORY / ".venv" / "board.stamp").is_file()
    or shutil.which("make") is None,
    reason="LiteX and Verilator are not set up: make board-sim",
)]  # fmt: skip


def made(program: Path) -> Path:
    command = ["make", "--no-print-directory", str(program)]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return REPOSITORY / program


@pytest.fixture(scope="module")
def program() -> Path:
    return made(PROGRAM)


class Simulation:
    """A running simulation; it ends with its input."""

    def __init__(self, program: Path, *options: str) -> None:
        self.process = subprocess.Popen(
            [program, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self.process.stdout is not None
        self.port = int(self.process.stdout.readline())

    def end(self) -> int:
        self.process.communicate()
        return self.process.returncode


@contextmanager
def simulated(program: Path, *options: str) -> Iterator[Simulation]:
    board = Simulation(program, *options)
    try:
        yield board
    finally:
        status = board.end()
    assert status == 0


@contextmanager
def connected(board: Simulation, timeout_ms: int = TIMEOUT_MS) -> Iterator[Client]:
    client = Client(board.port, timeout_ms)
    try:
        yield client
    finally:
        lib.vista_board_disconnect(client.board)


def small_settings(rng: np.random.Generator) -> dict:
    """Settings of any kind, but not wider than the build, and with few pixels."""
    while True:
        settings = random_settings(rng)
        if settings["width_px"] * settings["height_px"] < 6000:
            return settings


@pytest.mark.parametrize("faults", [[], FAULTS])
def test_words_are_the_golden_ones(program: Path, faults: list[str]) -> None:
    """Settings, sizes and maps change from session to session; every frame is answered."""
    rng = seeded(2400)
    options = [*faults, "--seed", str(rng.integers(1 << 30))]
    with simulated(program, *options) as board, connected(board) as client:
        for _ in range(4):
            settings = small_settings(rng)
            client.configure(settings)
            pairs = [random_pair(rng, settings) for _ in range(4)]
            client.submit(*pairs[0])
            for pair, following in zip(pairs, [*pairs[1:], None], strict=True):
                if following is not None:
                    client.submit(*following)
                np.testing.assert_array_equal(client.collect(), golden(settings, *pair))
        assert (client.counts.frames, client.counts.lost, client.counts.chunks_wrong) == (16, 0, 0)


def test_the_build_is_what_the_registers_say(program: Path) -> None:
    with simulated(program) as board, connected(board) as client:
        build = client.build()
        assert (build.num_disparities, build.block_size, build.max_width_px) == (16, 5, 320)
        assert (build.rectify_rows, build.map_points) == (16, 512)


def test_service_resumes_after_the_cable_was_pulled(program: Path) -> None:
    """The board hears nothing in the middle of a frame, for longer than the client waits."""
    rng = seeded(2410)
    settings = SETTINGS | {"levels": 2}
    with simulated(program) as board, connected(board, timeout_ms=3000) as client:
        client.configure(settings)
        first, second = random_pair(rng, settings), random_pair(rng, settings)
        client.submit(*first)
        board.process.send_signal(signal.SIGSTOP)
        with pytest.raises(BoardError, match="NO_ANSWER"):
            client.collect()
        board.process.send_signal(signal.SIGCONT)
        client.submit(*second)
        np.testing.assert_array_equal(client.collect(), golden(settings, *second))


def test_a_board_that_was_switched_off_and_on_says_so(program: Path) -> None:
    rng = seeded(2411)
    pair = random_pair(rng, SETTINGS)
    with simulated(program) as board:
        client = Client(board.port, TIMEOUT_MS)
        client.configure(SETTINGS)
        client.submit(*pair)
    with simulated(program, "--port", str(board.port)):
        with pytest.raises(BoardError, match="SESSION"):
            client.collect()
        client.configure(SETTINGS)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))
    lib.vista_board_disconnect(client.board)


def test_a_second_client_is_refused_while_the_first_holds_the_board(program: Path) -> None:
    """It costs the first one no frame. The board is free once its holder ends or has been silent, in the
    simulation for 2^20 clocks."""
    rng = seeded(2412)
    pair = random_pair(rng, SETTINGS)
    with simulated(program) as board, connected(board) as first:
        second, third = Client(board.port, TIMEOUT_MS), Client(board.port, TIMEOUT_MS)
        first.configure(SETTINGS)
        first.submit(*pair)
        with pytest.raises(BoardError, match="ERROR_HELD"):
            second.configure(SETTINGS | {"levels": 2})
        np.testing.assert_array_equal(first.collect(), golden(SETTINGS, *pair))
        for _ in range(2000):  # each question lets some clocks pass
            with contextlib.suppress(BoardError):
                second.configure(SETTINGS | {"levels": 2})
                break
        with pytest.raises(BoardError, match="SESSION"):
            first.submit(*pair)
            first.collect()
        second.submit(*pair)
        np.testing.assert_array_equal(second.collect(), golden(SETTINGS | {"levels": 2}, *pair))
        lib.vista_board_disconnect(second.board)
        third.configure(SETTINGS)
        lib.vista_board_disconnect(third.board)


def test_a_frame_that_the_engine_does_not_finish_is_lost(program: Path) -> None:
    """The engine is switched off behind the client's back: it drops the pixels, and gives no words. All
    frames are lost until the client begins a session: what is left in the engine could pass for theirs."""
    rng = seeded(2413)
    pair = random_pair(rng, SETTINGS)
    with simulated(program) as board, connected(board) as client:
        client.configure(SETTINGS)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))
        for value in (0, 1):
            write_register(board.port, CONTROL, value)
            client.submit(*pair)
            with pytest.raises(BoardError, match="ERROR_FRAME"):
                client.collect()
        client.configure(SETTINGS)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def known_of(port: int, settings: dict, words: int) -> Known:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.connect(("127.0.0.1", port))
        link.settimeout(TIMEOUT_MS / 1000)
        link.send(wire.packet({"kind": wire.REQUESTS["status"], "token": 1}))
        header, body = wire.parse(link.recv(2048))
    status = wire.parse_payload("status", body)
    pixels = settings["width_px"] * settings["height_px"]
    return Known(
        header["session"],
        min(status["slot_0_frame"], status["slot_1_frame"]),
        status["last_write"],
        -(-pixels // (2 * wire.CHUNK_WORDS)),
        -(-words // (2 * wire.CHUNK_WORDS)),
    )


def test_hostile_packets_change_no_word(program: Path) -> None:
    """They come before, between and after the packets of the client, and are whole Ethernet frames."""
    rng = seeded(2414)
    drawn = Random(int(rng.integers(1 << 30)))
    with simulated(program) as board, connected(board) as client:
        for _ in range(3):
            settings = small_settings(rng)
            client.configure(settings)
            for _ in range(3):
                pair = random_pair(rng, settings)
                wanted = golden(settings, *pair)
                packets = hostile_packets(drawn, known_of(board.port, settings, wanted.size))
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
                    link.connect(("127.0.0.1", board.port))
                    for _ in range(60):
                        link.send(next(packets))
                    client.submit(*pair)
                    for _ in range(60):
                        link.send(next(packets))
                    np.testing.assert_array_equal(client.collect(), wanted)
        assert (client.counts.frames, client.counts.lost) == (9, 0)


def fetch_of_a_finished_frame(port: int, **changed: int) -> bytes:
    known = known_of(port, SETTINGS, 0)
    header = {
        "kind": wire.REQUESTS["fetch"],
        "session": known.session,
        "token": 9,
        "frame": known.frame,
        "count": 1,
    }
    return wire.packet(header | changed)


@pytest.mark.parametrize("flaw", ["magic", "3 bytes", "17 bytes", "count"])
def test_a_fetch_that_is_not_sound_leaves_nothing_behind(program: Path, flaw: str) -> None:
    """Its frame has its words: those that were read for it would come before the next ones."""
    rng = seeded(2415)
    first, second = random_pair(rng, SETTINGS), random_pair(rng, SETTINGS)
    with simulated(program) as board, connected(board) as client:
        client.configure(SETTINGS)
        client.submit(*first)
        wait_until_done(board.port)
        changed = {"magic": 0x57} if flaw == "magic" else {"count": 65535} if flaw == "count" else {}
        packet = fetch_of_a_finished_frame(board.port, **changed)
        cut = int(flaw.split()[0]) if flaw.endswith("bytes") else len(packet)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            link.connect(("127.0.0.1", board.port))
            link.send(packet[:cut])
            link.settimeout(0.5)
            answers = []
            with contextlib.suppress(TimeoutError):
                while len(answers) < 100:
                    answers.append(wire.parse(link.recv(2048))[0]["kind"])
        assert answers == ([wire.REPLIES["status"]] if flaw == "count" else [])
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *first))
        client.configure(SETTINGS)
        client.submit(*second)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *second))


def wait_until_done(port: int) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.connect(("127.0.0.1", port))
        link.settimeout(TIMEOUT_MS / 1000)
        for token in range(1, 10000):
            link.send(wire.packet({"kind": wire.REQUESTS["status"], "token": token}))
            status = wire.parse_payload("status", wire.parse(link.recv(2048))[1])
            if wire.STATES["done"] in (status["slot_0_state"], status["slot_1_state"]):
                return
    raise AssertionError("the frame is never done")


def test_a_chunk_that_is_cut_is_not_taken(program: Path) -> None:
    """A byte is missing: the frame waits for it."""
    rng = seeded(2416)
    settings = SETTINGS | {"width_px": 40, "height_px": 20}
    pair = random_pair(rng, settings)
    with simulated(program) as board, connected(board) as client:
        client.configure(settings)
        known = known_of(board.port, settings, 800)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            link.connect(("127.0.0.1", board.port))
            header = {"kind": wire.REQUESTS["pixels"], "session": known.session, "frame": known.frame}
            for index in range(known.chunks_in):
                link.send(wire.packet(header | {"index": index}, bytes(wire.CONSTANTS["CHUNK_BYTES"] - 1)))
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(settings, *pair))


def test_clocks_are_counted_in_one_time() -> None:
    """Whatever else the machine does, frames take the same clocks; a slower host makes them come later."""

    def clocks(*more: int) -> list[list[int]]:
        command = [made(CLOCKS), *map(str, (64, 48, 2, 3, *more))]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        return [[int(number) for number in line.split()] for line in lines]

    found = clocks()
    assert found == clocks()
    assert len(found) == 3
    assert all(end - begin > 64 * 48 for begin, end in found)
    assert found == sorted(found) and all(end < begin for (_, end), (begin, _) in pairwise(found))
    assert clocks(200_000)[-1][0] > found[-1][0] + 10 * 45 * 200  # of more questions than ten


CONTROL = 0x10  # rtl/csr/registers.md


def write_register(port: int, address: int, value: int) -> None:
    """Writes a register like somebody who has overheard the session."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.connect(("127.0.0.1", port))
        link.settimeout(TIMEOUT_MS / 1000)
        link.send(wire.packet({"kind": wire.REQUESTS["status"], "token": 1}))
        header, body = wire.parse(link.recv(2048))
        number = wire.parse_payload("status", body)["last_write"] + 1
        place = {"session": header["session"], "frame": number, "index": address, "count": 1}
        link.send(wire.packet({"kind": wire.REQUESTS["write"], "token": 2} | place, wire.to_bytes([value])))
        assert wire.parse_payload("status", wire.parse(link.recv(2048))[1])["last_write"] == number


CAMERA_SETTINGS = SETTINGS | {"width_px": 200, "height_px": 120, "smooth": 1, "levels": 2}
PAIRS = 12  # that the sensors show, one after the other
RATE_HZ = 600
SENSORS = ["--pixel-mhz", "30", "--line-blanking", "60", "--rate", str(RATE_HZ)]


def moment_of(t_ns: int) -> int:
    """The moment in which a pair began at this time of the board: moment 0 is that after a period."""
    moment, part = divmod(1e-9 * t_ns * RATE_HZ, 1.0)
    assert part < 0.05  # sensors begin some pixel clocks after they were triggered
    return int(moment) - 1


def shown_to(folder: Path, settings: dict) -> tuple[Path, list[np.ndarray]]:
    """A file of pairs for the sensors, and the words of each."""
    rng = seeded(2420)
    pairs = [random_pair(rng, settings) for _ in range(PAIRS)]
    file = folder / "pairs.raw"
    file.write_bytes(b"".join(np.ascontiguousarray(image).tobytes() for pair in pairs for image in pair))
    words = [golden(settings, *pair) for pair in pairs]
    assert len({one.tobytes() for one in words}) == PAIRS
    return file, words


def test_cameras_of_the_board_start_stop_and_are_received(program: Path, tmp_path: Path) -> None:
    """The client comes when it will: pairs that had no room are gaps in the numbers, and count as lost."""
    settings = CAMERA_SETTINGS | {"cameras": 1}
    file, words = shown_to(tmp_path, settings)
    size = ["--width", str(settings["width_px"]), "--height", str(settings["height_px"])]
    with simulated(program, "--pairs", str(file), *size, *SENSORS) as board, connected(board) as client:
        assert client.build().cameras == 1
        client.configure(settings)
        with pytest.raises(BoardError, match="ERROR_ORDER"):
            client.submit(*random_pair(seeded(2421), settings))
        numbers, moments = [], []
        for _ in range(2):
            client.start()
            for _ in range(3):
                pair, found = client.receive()
                numbers.append(pair.number)
                moments.append(moment_of(pair.t_ns))
                np.testing.assert_array_equal(found, words[moments[-1] % PAIRS])
            client.stop()
        assert numbers == sorted(set(numbers)) and moments == sorted(set(moments))
        counts = client.counts
        assert (counts.frames, counts.lost) == (6, numbers[-1] - 5)
        assert (counts.refused_left, counts.refused_right) == (0, 0)
        client.configure(SETTINGS)
        with pytest.raises(BoardError, match="ERROR_ORDER"):
            client.start()
        pair = random_pair(seeded(2422), SETTINGS)
        client.submit(*pair)
        np.testing.assert_array_equal(client.collect(), golden(SETTINGS, *pair))


def streamed(folder: Path, settings: dict, frames: int, *options: str) -> tuple[dict, np.ndarray]:
    """What board-clocks says, line by line under their first words, and the words that were received."""
    words = folder / "words.raw"
    numbers = (settings["width_px"], settings["height_px"], settings["levels"], frames, 0)
    command = [made(CLOCKS), *map(str, numbers), "--words", str(words), *options]
    said: dict = {"frame": [], "fault": [], "counts": []}
    for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
        name, *values = line.split()
        if name in said:
            said[name].append(values)
    return said, np.fromfile(words, np.int16).reshape(frames, -1)


def test_sensors_that_fail_give_right_frames_or_none(tmp_path: Path) -> None:
    """A third of the moments lack a frame or a part of it on one side. Every other one arrives; none of
    these does, and each is reported: as lost if a pair had begun, else as refused. Which
    fault a moment has is drawn: in one run of a hundred none is of a kind that is refused."""
    settings = CAMERA_SETTINGS
    file, words = shown_to(tmp_path, settings)
    seed = str(seeded(2423).integers(1 << 30))
    faults = ["--pairs", str(file), *SENSORS, "--faults", "0.33", "--sensor-seed", seed]
    said, found = streamed(tmp_path, settings, 30, *faults)
    ill = {int(moment): what for moment, _, what in said["fault"]}
    (frames, lost, left, right, moments) = map(int, said["counts"][0])
    first = next(i for i, one in enumerate(words) if np.array_equal(found[0], one))
    well = [m for m in range(first, moments) if m not in ill][:frames]
    for moment, one, (_, clock, t_ns, came_ns) in zip(well, found, said["frame"], strict=True):
        np.testing.assert_array_equal(one, words[moment % PAIRS], err_msg=str(moment))
        assert moment_of(int(t_ns)) == moment
        # Both clocks are the board's there; an answer takes some microseconds.
        assert 0 <= int(came_ns) - int(t_ns) < 20_000 and int(came_ns) < 1000 * int(clock) / 45
    seen = [what for moment, what in ill.items() if first <= moment < well[-1]]
    begun = sum(what not in ("missing", "late") for what in seen)
    assert len(seen) > 5 and begun <= lost <= begun + 3  # those behind the last one, and before the first
    assert left + right >= seen.count("missing") + 2 * seen.count("late")


@pytest.mark.parametrize(("levels", "rate_hz"), [(1, 340), (3, 230)])
def test_the_model_takes_the_clocks_of_a_board_with_cameras(
    tmp_path: Path, levels: int, rate_hz: int
) -> None:
    """Both receive every frame of the sensors, and work at one for as long, within 1 %."""
    row = board_clocks.camera_row((320, 240), levels, rate_hz, 6, tmp_path)
    for side in ("board", "model"):
        assert row[side]["received"] == row[side]["of"], side
    assert row["model"]["engine_clocks"] == pytest.approx(row["board"]["engine_clocks"], rel=0.01)
    assert row["model"]["period_clocks"] == pytest.approx(row["board"]["period_clocks"], rel=0.01)


def test_run_gives_the_same_obstacles(
    program: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Raw images over a link with faults; the board rectifies, smooths and reduces them."""
    run_vista: Vista = partial(call, capsys)
    folder = cases.make_raw(cases.make_board_scenes(tmp_path / "pairs", 4, stills=False))
    config = tmp_path / "c.toml"
    config.write_text(
        "[stereo]\nnum_disparities = 16\nblock_size = 5\n"
        'smooth = "binomial3"\nlevels = 3\nrectify_rows = 16\n'
    )
    options = ["--config", config, "--no-overlay"]
    assert run_vista("run", folder, "--out", tmp_path / "golden", *options)[0] == 0
    with simulated(program, *FAULTS) as board:
        options += ["--engine", "board", "--address", f"127.0.0.1:{board.port}"]
        options += ["--board-timeout", 60]
        assert run_vista("run", folder, "--out", tmp_path / "board", *options)[0] == 0
    lines = lines_without_times(tmp_path / "board")
    assert lines == lines_without_times(tmp_path / "golden")
    assert any(obstacle["confirmed"] for obstacle in json.loads(lines[-1])["obstacles"])


def test_live_makes_obstacles_of_the_words_of_the_sensors(program: Path, tmp_path: Path) -> None:
    """Each line is that of the words of the C model for the pair of its moment. A pair that a sensor spoilt
    has none, and is a gap in the numbers."""
    calibration, config = written(tmp_path)
    pairs, expected = shown_pairs(4), WordsAlone(calibration, config)
    file = tmp_path / "pairs.raw"
    file.write_bytes(raw_bytes(pairs))
    sensors = ["--width", "160", "--height", "120", "--pixel-mhz", "40", "--line-blanking", "80"]
    seed = str(seeded(2430).integers(1 << 30))
    sensors += ["--faults", "0.5", "--rate", str(RATE_HZ), "--sensor-seed", seed]
    with simulated(program, "--pairs", str(file), *sensors) as board:
        command = [sys.executable, "-m", "vista", "live", "--camera", f"board:127.0.0.1:{board.port}"]
        command += ["--calibration", str(calibration), "--size-px", "160x120", "--config", str(config)]
        command += ["--board-timeout", "60", "--no-page", "--out", "-"]
        live = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert live.stdout is not None
        numbers: list[int] = []
        while len(numbers) < 3 or numbers[-1] - numbers[0] < len(numbers):
            line = live.stdout.readline()
            about = json.loads(line)
            moment = moment_of(about["t_ns"])
            pair = pairs[moment % len(pairs)]
            assert without_time(line.rstrip()) == expected.line(pair, about["frame"], about["t_ns"])
            numbers.append(about["frame"])
        live.send_signal(signal.SIGINT)
        _, said = live.communicate(timeout=60)
    assert (live.returncode, numbers) == (130, sorted(set(numbers)))
    assert "image_missing" in line and "from the exposure to the result" in said
