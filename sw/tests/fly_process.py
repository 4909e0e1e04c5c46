"""vista-fly in a process of its own, and the files that `vista prepare` makes for it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from vista import native
from vista.cli import main

VISTA_FLY = native.build_folder() / "bin" / "vista-fly"
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")


def environment(**more: str) -> dict[str, str]:
    """A stand-alone program: what is preloaded for Python's sake is not for it."""
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"} | more


def fly(*arguments: object, timeout: float = 120.0, **more: str) -> subprocess.CompletedProcess[str]:
    command = [str(VISTA_FLY), *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, env=environment(**more), cwd="/"
    )


def start(*arguments: object, **more: str) -> subprocess.Popen[str]:
    command = [str(VISTA_FLY), *map(str, arguments)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment(**more), cwd="/")


def prepare(folder: Path, sequence: Path, *options: object) -> list[object]:
    """The options of vista-fly that play the recording; its rig lies beside it."""
    assert main(["prepare", str(sequence), "--out", str(folder), *map(str, options)]) == 0
    return ["--recording", folder / "frames.vista"]


def frames_at(recording: Path) -> int:
    """The place where the frames of a recording begin: behind what the rig beside it holds as well."""
    return (recording.parent / "rig.vista").stat().st_size


def compare(
    folder: Path, sequence: Path, config: str = "", frames: int = 12
) -> tuple[list[str], subprocess.CompletedProcess[str]]:
    """Lines of `vista run` and of vista-fly, which have to be equal, from raw pairs and from the words that
    `vista run` recorded, and what vista-fly said of the pairs."""
    (folder / "my.toml").write_text(config)
    options = ["--config", str(folder / "my.toml"), "--frames", f"0:{frames}"]
    record = ["--record", str(folder / "words.vista")]
    assert main(["run", str(sequence), "--out", str(folder / "run"), "--no-overlay", *record, *options]) == 0
    played = prepare(folder / "fly", sequence, *options)
    run = fly(*played, "--all-frames", "--out", folder / "lines.jsonl")
    assert run.returncode == 0, run.stderr
    lines = timeless(folder / "lines.jsonl")
    others = timeless(folder / "run" / "obstacles.jsonl")
    assert len(lines) == len(others)
    for line, other in zip(lines, others, strict=True):
        assert line == other
    assert f"{len(lines)} frames processed, 0 dropped" in run.stderr
    words = fly("--recording", folder / "words.vista", "--all-frames", "--out", folder / "words.jsonl")
    assert words.returncode == 0, words.stderr
    assert timeless(folder / "words.jsonl") == lines
    return lines, run


def timeless(file: Path) -> list[str]:
    """Lines without the value of processing_ms."""
    lines = file.read_text().splitlines()
    replaced = [re.subn(r'"processing_ms": [0-9.e-]+, ', "", line) for line in lines]
    assert all(count == 1 for _, count in replaced)
    return [line for line, _ in replaced]


def allocations_of_one_pass_and_ten(
    folder: Path, played: list[object], *options: object
) -> tuple[list[int], subprocess.CompletedProcess[str]]:
    """Counts allocations over the frames of a recording, and gives the run of the ten. Each pass is a flight
    of its own: its times begin anew, and what was known is forgotten."""
    counter, target, long = (folder / name for name in ("count_allocations.so", "count", "long.vista"))
    source = Path(__file__).with_name("count_allocations.c")
    command = ["gcc", "-std=c17", "-O1", "-fPIC", "-fno-builtin", "-shared", str(source), "-o", str(counter)]
    subprocess.run([*command, "-ldl"], check=True, timeout=60)
    played_file = Path(str(played[1]))
    content = played_file.read_bytes()
    long.write_bytes(content + 9 * content[frames_at(played_file) :])
    counts = []
    for recording in (played_file, long):
        arguments = ["--recording", recording, "--all-frames", *options]
        run = fly(*arguments, LD_PRELOAD=str(counter), COUNT_ALLOCATIONS=str(target))
        assert run.returncode == 0, run.stderr
        counts.append(int(target.read_text()))
    return counts, run
