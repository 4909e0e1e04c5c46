"""What a program sees of libvista: headers as C and C++, symbols, version, and callers of another age."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import board_flight as scene
import pytest
from board_flight import board_flight
from pipeline_library import Frame, Pipeline
from shared_data import REPOSITORY
from stage_library import ffi, lib, status_name

BUILD = REPOSITORY / os.environ.get("VISTA_BUILD", "build")
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")
INCLUDES = [REPOSITORY / "sw" / "include", REPOSITORY / "model" / "c" / "include"]
HEADERS = {
    "vista": sorted((REPOSITORY / "sw" / "include" / "vista").glob("*.h")),
    "vista_engine": [
        REPOSITORY / "model" / "c" / "include" / "vista" / f"{name}.h" for name in ("engine", "frontend")
    ],
}
COMPILERS = {"C": ["gcc", "-std=c11", "-x", "c"], "C++": ["g++", "-std=c++17", "-x", "c++"]}
USER = """
#include "vista/vista.h"
#include "vista/engine.h"
int main(void) {
  vista_parameters parameters = vista_parameters_default();
  vista_camera camera = {320, 240, 300.0, 159.5, 119.5, 0.3};
  size_t bytes = 0;
  return vista_pipeline_bytes(&parameters, &camera, &bytes) == VISTA_OK && bytes > 0 ? 0 : 1;
}
"""


@pytest.mark.same_c
@pytest.mark.parametrize("language", COMPILERS)
@pytest.mark.parametrize("header", [*HEADERS["vista"], *HEADERS["vista_engine"]], ids=lambda path: path.name)
def test_each_header_stands_alone(header: Path, language: str) -> None:
    command = [*COMPILERS[language], "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
    command += [f"-I{folder}" for folder in INCLUDES]
    text = f'#include "vista/{header.name}"\n#include "vista/{header.name}"\n'
    run = subprocess.run([*command, "-"], input=text, capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.skipif(SANITIZED, reason="a plain program cannot load sanitized libraries")
@pytest.mark.parametrize("language", COMPILERS)
def test_a_program_links_and_runs(language: str, tmp_path: Path) -> None:
    program = tmp_path / "user"
    command = [*COMPILERS[language], "-", *[f"-I{folder}" for folder in INCLUDES], "-o", str(program)]
    libraries = ["-x", "none", str(BUILD / "lib" / "libvista.so"), str(BUILD / "lib" / "libvista_engine.so")]
    run = subprocess.run(
        [*command, *libraries], input=USER, capture_output=True, text=True, timeout=60, cwd=REPOSITORY
    )
    assert (run.returncode, run.stderr) == (0, "")
    paths = {"LD_LIBRARY_PATH": str(BUILD / "lib")}
    assert subprocess.run([program], env=os.environ | paths, cwd=REPOSITORY, timeout=60).returncode == 0


@pytest.mark.skipif(SANITIZED, reason="sanitized, it exports its stages too")
@pytest.mark.parametrize("library", HEADERS)
def test_the_library_exports_what_the_headers_declare(library: str) -> None:
    declared = set()
    for header in HEADERS[library]:
        declared |= set(re.findall(r"^VISTA_API [^;{(]*?(\w+)\(", header.read_text(), re.MULTILINE))
    path = BUILD / "lib" / f"lib{library}.so"
    table = subprocess.run(["nm", "-D", "--defined-only", path], capture_output=True, text=True, check=True)
    exported = {line.split()[-1] for line in table.stdout.splitlines()}
    if any(name.startswith("__gcov") for name in exported):
        pytest.skip("built for coverage, it exports what counts lines too")
    assert exported == declared


def test_the_version_is_that_of_the_file() -> None:
    version = (REPOSITORY / "VERSION").read_text().strip()
    parts = (lib.VISTA_VERSION_MAJOR, lib.VISTA_VERSION_MINOR, lib.VISTA_VERSION_PATCH)
    assert ".".join(map(str, parts)) == version
    assert ffi.string(lib.vista_version()).decode() == version


# ---- callers with another header: shorter and longer structs ----


def process(pipeline: Pipeline, frame: Frame, frame_bytes: int, result_bytes: int) -> tuple[str, bytes]:
    """The status, and the result with 64 bytes behind it."""
    memory = ffi.new("unsigned char[]", result_bytes + 64)
    ffi.memmove(memory, b"\xa5" * len(memory), len(memory))
    result = ffi.cast("vista_result *", memory)
    wide = ffi.new("unsigned char[]", frame_bytes + 64)  # what lies behind the caller's struct is not read
    ffi.memmove(wide, b"\xff" * len(wide), len(wide))
    ffi.memmove(wide, frame.c, min(frame_bytes, ffi.sizeof("vista_frame")))
    c_frame = ffi.cast("vista_frame *", wide)
    status = lib.vista_pipeline_process_sized(pipeline.handle, c_frame, frame_bytes, result, result_bytes)
    return status_name(status), bytes(ffi.buffer(memory))


def test_an_older_caller_gets_what_it_knows_of() -> None:
    pipeline, undisturbed = Pipeline(), Pipeline().fly(board_flight()[:6])
    short = ffi.offsetof("vista_result", "valid_fraction")
    frame_bytes = ffi.offsetof("vista_frame", "t_ns") + 8
    for source, expected in zip(board_flight()[:6], undisturbed, strict=True):
        status, memory = process(pipeline, Frame(source), frame_bytes, short)
        assert status == "VISTA_OK"
        assert memory[short:] == b"\xa5" * 64
        result = ffi.new("vista_result *")
        ffi.memmove(result, memory, short)
        assert result.obstacle_count == len(expected["obstacles"]) == 1
        assert lib_obstacle(result, 0).distance_m == expected["obstacles"][0]["distance_m"]


def lib_obstacle(result, index: int):
    """vista_result_obstacle, an inline function of the header."""
    first = ffi.cast("char *", result.obstacles)
    return ffi.cast("vista_obstacle *", first + index * result.obstacle_bytes)


def test_a_newer_caller_gets_zeros_behind_what_is_known() -> None:
    size, frame_bytes = ffi.sizeof("vista_result"), ffi.sizeof("vista_frame")
    status, memory = process(Pipeline(), Frame(board_flight()[0]), frame_bytes + 32, size + 32)
    assert status == "VISTA_OK"
    assert memory[size : size + 32] == bytes(32)
    assert memory[size + 32 :] == b"\xa5" * 64


@pytest.mark.parametrize("sizes", [(8, 500), (500, 8)], ids=["frame", "result"])
def test_sizes_that_no_header_had(sizes: tuple[int, int]) -> None:
    result, frame = ffi.new("unsigned char[500]"), Frame(scene.render(0))
    status = lib.vista_pipeline_process_sized(
        Pipeline().handle, frame.c, sizes[0], ffi.cast("vista_result *", result), sizes[1]
    )
    assert status_name(status) == "VISTA_ERROR_SIZE"
    assert not any(bytes(ffi.buffer(result)))
