"""The Verilated engine as a Python object: build a configuration once, then stream frames at C++ speed."""

from __future__ import annotations

import ctypes
import functools
import itertools
import json
import os
import re
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from tools import (
    BUILD,
    ROOT,
    VERILATOR_FLAGS,
    bench_sources,
    digest_of,
    made_once,
    sources,
    verilator_environment,
)

HARNESS = ROOT / "rtl" / "sim" / "vista_rtl.cpp"
HERE = Path(__file__).parent
# An upset breaks what the properties promise, and its bits are reached by Verilator's tables of names.
UPSET_FLAGS = [f for f in VERILATOR_FLAGS if f not in ("--assert", "-DVISTA_ASSERT")] + ["--vpi"]
USER, LAST = 1 << 16, 1 << 17  # of a beat
WORD_USER, WORD_LAST = 1, 2  # of the flags of a word


@dataclass(frozen=True)
class Stand:
    """What stands in for the sources, and can be made to fail: a netlist, or a core with mutants."""

    name: str
    made_of: tuple[Path, ...]  # besides the sources
    files: Callable[[Config], list[Path]]  # to be Verilated, with the build parameters
    has_parameters: bool = False  # so that they are still to be given
    flags: str = "-O1"  # of the compiler


@dataclass(frozen=True)
class Config:
    """Build parameters."""

    num_disparities: int
    block_size: int
    max_width: int = 1024
    rows: int = 0  # of the line buffer of rectification; 0: the core without front end
    points: int = 64  # control points of a camera, a power of two
    parity: bool = False
    confidence: bool = False
    coverage: bool = False
    upsets: bool = False  # bits of its registers and memories can be turned over; nothing is asserted
    stand: Stand | None = field(default=None, repr=False)
    waves: bool = "VISTA_WAVES" in os.environ  # written to build/rtl/top/NAME/waves.vcd

    @property
    def name(self) -> str:
        kind = (
            "_parity" * self.parity
            + "_confidence" * self.confidence
            + "_cov" * self.coverage
            + "_upsets" * self.upsets
            + "_waves" * self.waves
        )
        kind += f"_{self.stand.name}" if self.stand else ""
        front_end = f"_r{self.rows}_p{self.points}" * bool(self.rows)
        return f"d{self.num_disparities}_b{self.block_size}_w{self.max_width}{front_end}{kind}"


@dataclass(frozen=True)
class Pace:
    """A side that runs and pauses in bursts: chances per clock, in 1/1000, to stop and to go on."""

    stop: int = 0
    go: int = 1000


@dataclass(frozen=True)
class Cell:
    """A register, or a memory of several entries."""

    number: int
    name: str
    entries: int
    bits: int  # of an entry
    wired: tuple[int, ...] = ()  # bits that are no register

    @property
    def path(self) -> str:
        """Generated blocks and name within its module; a field of a structure belongs to that."""
        parts = re.sub(r".*\bu_\w+\.", "", self.name).split(".")
        blocks = list(itertools.takewhile(lambda part: part.startswith("gen_"), parts))
        return ".".join([*blocks, parts[len(blocks)]])


# What random tests draw from.
CONFIGS = [
    Config(16, 5), Config(16, 21, 256, confidence=True), Config(32, 9, 96), Config(32, 11),
    Config(48, 7, 256, confidence=True), Config(64, 11),
]  # fmt: skip
FRONT_END = Config(16, 5, 64, rows=16)
FRONT_ENDS = [FRONT_END, Config(32, 11, 128, rows=32, confidence=True)]
PACES = [Pace(), Pace(300, 300), Pace(50, 20), Pace(700, 100), Pace(5, 5)]


def build(config: Config) -> Path:
    """The shared library of a configuration, built anew when a source has changed."""
    folder = BUILD / "top" / config.name
    files = (sources if config.parity else bench_sources)("vista_stereo.f")  # the latter have no parity
    others = [*(ROOT / "rtl" / "formal").glob("*.svh"), *HARNESS.parent.glob("*.[ch]*"), Path(__file__)]
    others += [HERE / "object_cache.sh", HERE / "assertions_on.h"]
    others += config.stand.made_of if config.stand else []
    digest = digest_of([*files, *sorted(others)], repr(config), repr(VERILATOR_FLAGS))
    return made_once(folder / "engine.so", folder, digest, functools.partial(_build, config, files, folder))


def _build(config: Config, files: list[Path], folder: Path) -> None:
    for stale in folder.glob("*.[ao]"):  # make asks for the age of their sources, not for flags and headers
        stale.unlink()
    stand = config.stand
    if stand:
        files = stand.files(config)
    flags = "-fPIC " + (stand.flags if stand else "-O1")
    flags += " -DVISTA_COVERAGE" * config.coverage
    flags += " -DVISTA_MUTANTS" * (stand is not None)
    flags += " -DVISTA_UPSETS" * config.upsets
    environment = verilator_environment()
    command = [
        "verilator", "--cc", "--build", "-j", "1", "-O3", "--x-assign", "fast",
        *(UPSET_FLAGS if config.upsets else VERILATOR_FLAGS),
        "--top-module", "vista_stereo", "--prefix", "Vvista_stereo", "--Mdir", str(folder), "-CFLAGS", flags,
        *([] if stand and not stand.has_parameters else [
            f"-GNumDisparities={config.num_disparities}", f"-GBlockSize={config.block_size}",
            f"-GMaxWidth={config.max_width}", f"-GParity={int(config.parity)}",
            f"-GConfidence={int(config.confidence)}",
        ]),
        *([
            "-GFrontEnd=1", f"-GNumRows={config.rows}", f"-GMaxPoints={config.points}",
        ] if config.rows else []),
        *(["--trace-vcd"] if config.waves else []),
        *(["--coverage-line", "--coverage-toggle"] if config.coverage else []),
        *map(str, files),
    ]  # fmt: skip
    if config.upsets:
        command.append(str(_cells_made_public(command, environment, folder)))
    _run(command, environment, folder)
    root = _run(["verilator", "--getenv", "VERILATOR_ROOT"], environment, folder).strip()
    link = [
        "g++", "-std=c++17", "-shared", *flags.split(), f"-I{folder}", f"-I{root}/include",
        f"-I{root}/include/vltstd",
        str(HARNESS), str(folder / "libVvista_stereo.a"), str(folder / "libverilated.a"),
        "-lpthread", "-o", str(folder / "engine.so"),
        *([f'-DVISTA_WAVES="{folder}/waves.vcd"'] if config.waves else []),
    ]  # fmt: skip
    _run(link, environment, folder)


def _cells_made_public(command: list[str], environment: dict[str, str], folder: Path) -> Path:
    """Writes what lets the harness reach all registers and memories: what a clock assigns to."""
    tree = folder / "tree.json"
    only = [
        "--json-only",
        "--json-only-output",
        str(tree),
        "--json-only-meta-output",
        str(folder / "meta.json"),
    ]
    without = ("--cc", "--build", "-j", "1", "-O3")
    assert tuple(command[1:6]) == without
    _run([command[0], *only, *command[6:]], environment, folder)
    root = json.loads(tree.read_text())
    clocked = set(_clocked(root))
    found = {(module, path) for module, path, address in _variables(root, "", ()) if address in clocked}
    wired = dict(_wired(root))
    bits = {
        path: wired.get(address, []) for _, path, address in _variables(root, "", ()) if address in clocked
    }
    (folder / "cells.json").write_text(json.dumps(bits))
    lines = {f'public_flat_rw -module "{module}" -var "{path.split(".")[-1]}"' for module, path in found}
    made = folder / "cells.vlt"
    made.write_text("\n".join(["`verilator_config", *sorted(lines), ""]))
    return made


def _nodes(node: Any) -> Iterator[dict[str, Any]]:
    """The node of Verilator's tree, and those below it."""
    if isinstance(node, list):
        for item in node:
            yield from _nodes(item)
    elif isinstance(node, dict):
        yield node
        for value in node.values():
            if isinstance(value, list):
                yield from _nodes(value)


def _clocked(root: Any) -> Iterator[str]:
    """Addresses of the variables that are assigned to at a clock."""
    for node in _nodes(root):
        if node["type"] == "ASSIGNDLY":
            target = node["lhsp"][0]
            while target["type"] != "VARREF":
                target = target["fromp"][0]
            yield target["varp"]


def _wired(root: Any) -> Iterator[tuple[str, list[int]]]:
    """Addresses of variables of which bits are assigned to all the time, and these bits."""
    for node in _nodes(root):
        if node["type"] == "ASSIGNW" and node["lhsp"][0]["type"] == "SEL":
            part = node["lhsp"][0]
            low = int(part["lsbp"][0]["name"].split("h")[1], 16) if part["lsbp"][0]["type"] == "CONST" else 0
            yield part["fromp"][0].get("varp", ""), list(range(low, low + part["widthConst"]))


def _variables(node: Any, module: str, blocks: tuple[str, ...]) -> Iterator[tuple[str, str, str]]:
    """Module, path of generated blocks and name, and address of all variables."""
    if isinstance(node, list):
        for item in node:
            yield from _variables(item, module, blocks)
    elif isinstance(node, dict):
        if node["type"] == "VAR":
            yield module, ".".join([*blocks, node["origName"]]), node["addr"]
        if node["type"] == "MODULE":
            module = node["origName"]
        if node["type"] == "GENBLOCK":
            blocks = (*blocks, node["name"])
        for value in node.values():
            if isinstance(value, list):
                yield from _variables(value, module, blocks)


def _run(command: list[str], environment: dict[str, str], folder: Path) -> str:
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True)
    (folder / "build.log").write_text(" ".join(command) + "\n" + done.stdout + done.stderr)
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed, see {folder}/build.log:\n{done.stderr[-2000:]}")
    return done.stdout


@functools.cache
def _load(config: Config) -> ctypes.CDLL:
    library = ctypes.CDLL(str(build(config)))
    library.vista_rtl_create.restype = ctypes.c_void_p
    library.vista_rtl_read.restype = ctypes.c_uint32
    library.vista_rtl_stream.restype = ctypes.c_int64
    library.vista_rtl_clock.restype = ctypes.c_int64
    return library


@dataclass
class Streamed:
    """What came out of one call of Rtl.stream: words, their framing, and the clocks of all transfers."""

    words: npt.NDArray[np.uint32]
    flags: npt.NDArray[np.uint8]
    in_clock: npt.NDArray[np.int64]
    out_clock: npt.NDArray[np.int64]
    taken: int


class Rtl:
    """One engine out of reset. Close it, or use it as a context."""

    def __init__(self, config: Config, seed: int = 1) -> None:
        self.config = config
        self._lib = _load(config)
        self._seed = seed
        self._handle = self._created()

    def _created(self) -> ctypes.c_void_p:
        return ctypes.c_void_p(self._lib.vista_rtl_create(ctypes.c_uint32(self._seed)))

    def renew(self) -> None:
        """Puts another engine in its place, with memories and registers as they are at power-up."""
        self.close()
        self._handle = self._created()

    def __enter__(self) -> Rtl:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        assert not self._lib.vista_rtl_failed(self._handle), "an assertion of rtl/formal failed, see stderr"
        self._lib.vista_rtl_destroy(self._handle)

    def select_mutant(self, number: int) -> None:
        self._lib.vista_rtl_select_mutant(self._handle, ctypes.c_uint32(number))
        self.reset()

    def cells(self) -> list[Cell]:
        """All registers and memories."""
        clocked = dict(json.loads((BUILD / "top" / self.config.name / "cells.json").read_text()))
        found = []
        name, shape = ctypes.create_string_buffer(256), (ctypes.c_uint32 * 2)()
        for number in itertools.count():
            if not self._lib.vista_rtl_cell(self._handle, ctypes.c_uint32(number), name, len(name), shape):
                return found
            cell = Cell(number, name.value.decode().removeprefix("TOP.vista_stereo."), *shape)
            if cell.path in clocked:  # and not a wire of that name in another of the generated blocks
                found.append(replace(cell, wired=tuple(clocked[cell.path])))
        raise AssertionError

    def clock(self) -> int:
        """Clocks that have passed."""
        return int(self._lib.vista_rtl_clock(self._handle))

    def upset(self, cell: Cell, entry: int, bit: int, clocks: int) -> None:
        """Turns a bit over after so many clocks."""
        self._lib.vista_rtl_upset(
            self._handle, ctypes.c_uint32(cell.number), ctypes.c_uint32(entry), ctypes.c_uint32(bit),
            ctypes.c_int64(clocks),
        )  # fmt: skip

    def reset(self, clocks: int = 4) -> None:
        self._lib.vista_rtl_reset(self._handle, clocks)

    def write(self, address: int, data: int) -> None:
        self._lib.vista_rtl_write(self._handle, ctypes.c_uint32(address), ctypes.c_uint32(data))

    def read(self, address: int) -> int:
        return int(self._lib.vista_rtl_read(self._handle, ctypes.c_uint32(address)))

    def response(self) -> int:
        """What the bus has answered to the last access."""
        return int(self._lib.vista_rtl_response(self._handle))

    def interrupt(self) -> bool:
        return bool(self._lib.vista_rtl_interrupt(self._handle))

    def queue_write(self, after: int, before: int, address: int, data: int) -> None:
        """A write within the next `stream`: begun after so many beats were taken, done before beat `before`
        is offered."""
        self._lib.vista_rtl_queue_write(
            self._handle, ctypes.c_int64(after), ctypes.c_int64(before), ctypes.c_uint32(address),
            ctypes.c_uint32(data),
        )  # fmt: skip

    def record(self, path: Path | None) -> None:
        """Writes all that goes in and comes out to a file from now on; None ends it."""
        name = None if path is None else str(path).encode()
        if not self._lib.vista_rtl_record(self._handle, name):
            raise OSError(f"cannot write {path}")

    def write_coverage(self, path: Path) -> None:
        self._lib.vista_rtl_write_coverage(self._handle, str(path).encode())

    def stream(
        self,
        beats: npt.NDArray[np.uint32],
        max_words: int,
        pace_in: Pace = Pace(),
        pace_out: Pace = Pace(),
        seed: int = 1,
        quiet: int = 20000,
        max_clocks: int = 1 << 40,
    ) -> Streamed:
        """Offers all beats and takes at most max_words; gives up after `quiet` clocks without a transfer."""
        beats = np.ascontiguousarray(beats, np.uint32)
        words, flags = np.zeros(max_words, np.uint32), np.zeros(max_words, np.uint8)
        in_clock, out_clock = np.zeros(len(beats), np.int64), np.zeros(max_words, np.int64)
        taken = ctypes.c_int64()

        def pointer(array: npt.NDArray[np.generic]) -> ctypes.c_void_p:
            return ctypes.c_void_p(array.ctypes.data)

        def pace(side: Pace) -> ctypes.Array[ctypes.c_uint32]:
            return (ctypes.c_uint32 * 2)(side.stop, side.go)

        count = self._lib.vista_rtl_stream(
            self._handle, pointer(beats), ctypes.c_int64(len(beats)), pace(pace_in), pace(pace_out),
            ctypes.c_uint64(seed), ctypes.c_int64(max_words), ctypes.c_int64(quiet),
            ctypes.c_int64(max_clocks),
            pointer(words), pointer(flags), pointer(in_clock), pointer(out_clock), ctypes.byref(taken),
        )  # fmt: skip
        assert not self._lib.vista_rtl_failed(self._handle), "an assertion of rtl/formal failed, see stderr"
        return Streamed(words[:count], flags[:count], in_clock[: taken.value], out_clock[:count], taken.value)
