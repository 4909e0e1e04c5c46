"""`make install`: what lies where, and programs that link to it in every way that it offers, after a move."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
import sequence_cases as cases
from shared_data import REPOSITORY
from vista.sequence.image import read_grey

pytestmark = pytest.mark.slow

VERSION = (REPOSITORY / "VERSION").read_text().strip()
EXAMPLES = REPOSITORY / "sw" / "examples"
TOOLS = REPOSITORY / ".venv" / "bin"
SONAMES = {f"lib{name}": f"lib{name}.so.{VERSION.partition('.')[0]}" for name in ("vista", "vista_engine")}


def run(*command: object, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs a command in an environment that names no library and no outer make."""
    environment = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")} | variables
    arguments = [str(part) for part in command]
    return subprocess.run(arguments, cwd=cwd, env=environment, capture_output=True, text=True, timeout=300)


def succeed(*command: object, cwd: Path, **variables: str) -> str:
    done = run(*command, cwd=cwd, **variables)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="session")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An installation that was staged with DESTDIR and then moved elsewhere."""
    folder = tmp_path_factory.mktemp("install")
    staged = folder / "stage"
    succeed("make", "install", "PREFIX=/opt/vista", f"DESTDIR={staged}", cwd=REPOSITORY)
    assert [path.name for path in staged.iterdir()] == ["opt"]
    return Path(shutil.move(staged / "opt" / "vista", folder / "moved"))


def test_what_is_installed(prefix: Path) -> None:
    found = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if not path.is_dir()}
    headers = [*REPOSITORY.glob("sw/include/vista/*.h"), *REPOSITORY.glob("model/c/include/vista/*.h")]
    expected = {f"include/vista/{header.name}" for header in headers} | {"bin/vista-fly"}
    for library, soname in SONAMES.items():
        expected |= {
            f"lib/{library}.a", f"lib/{library}.so", f"lib/{soname}", f"lib/{library}.so.{VERSION}"
        }  # fmt: skip
    expected |= {"lib/pkgconfig/vista.pc", "lib/pkgconfig/vista-engine.pc"}
    package = {path for path in found if path.startswith("lib/cmake/Vista/VistaConfig")}
    assert "lib/cmake/Vista/VistaConfig.cmake" in package
    assert found == expected | package
    assert {"include/vista/vista.h", "include/vista/engine.h"} <= found


@pytest.mark.parametrize("library", SONAMES)
def test_the_library_has_a_soname(prefix: Path, library: str) -> None:
    dynamic = succeed("readelf", "-d", prefix / "lib" / f"{library}.so", cwd=prefix)
    assert re.findall(r"\(SONAME\).*\[(.*)\]", dynamic) == [SONAMES[library]]
    assert "RUNPATH" not in dynamic or "$ORIGIN" in dynamic


@pytest.mark.parametrize("where", ["installed", "built"])
def test_the_program_starts_from_any_folder(prefix: Path, tmp_path: Path, where: str) -> None:
    program = (prefix if where == "installed" else REPOSITORY / "build") / "bin" / "vista-fly"
    done = run(program, "--recording", "no-such-recording", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "vista-fly: no-such-recording: no such file or directory\n"


def test_pkg_config_knows_version_and_place(prefix: Path) -> None:
    for module in ("vista", "vista-engine"):
        packages = {"PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig")}
        assert succeed(TOOLS / "pkgconf", "--modversion", module, cwd=prefix, **packages) == f"{VERSION}\n"
        text = succeed(TOOLS / "pkgconf", "--cflags", "--libs", module, cwd=prefix, **packages)
        folders = [Path(part[2:]).resolve() for part in text.split() if part[:2] in ("-I", "-L")]
        assert folders == [prefix / "include", prefix / "lib"]


# ---- the examples ----


@dataclass(frozen=True)
class Example:
    folder: str
    program: str


FLIGHT, PAIR = Example("c", "flight"), Example("cpp", "pair")


def build_by_cmake(example: Example, folder: Path, prefix: Path, static: bool) -> Path:
    options = [f"-DCMAKE_PREFIX_PATH={prefix}", f"-DSTATIC={'ON' if static else 'OFF'}", "-G", "Ninja"]
    ninja = f"-DCMAKE_MAKE_PROGRAM={TOOLS / 'ninja'}"
    cmake = TOOLS / "cmake"
    succeed(cmake, "-S", EXAMPLES / example.folder, "-B", folder, *options, ninja, cwd=folder)
    succeed(cmake, "--build", folder, cwd=folder)
    return folder / example.program


def build_by_pkg_config(example: Example, folder: Path, prefix: Path, static: bool) -> Path:
    shutil.copytree(EXAMPLES / example.folder, folder, dirs_exist_ok=True)
    packages = {"PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig"), "PKG_CONFIG": str(TOOLS / "pkgconf")}
    succeed("make", *(["STATIC=-static"] if static else []), cwd=folder, **packages)
    return folder / example.program


@pytest.mark.parametrize("build", [build_by_cmake, build_by_pkg_config])
@pytest.mark.parametrize("static", [False, True], ids=["shared", "static"])
@pytest.mark.parametrize("example", [FLIGHT, PAIR], ids=lambda example: example.program)
def test_an_example_builds_and_sees(build, static: bool, example: Example, prefix: Path, tmp_path: Path):
    (tmp_path / "made").mkdir()
    program = build(example, tmp_path / "made", prefix, static)
    libraries = set(re.findall(r"\(NEEDED\).*\[(.*)\]", succeed("readelf", "-d", program, cwd=tmp_path)))
    assert libraries.isdisjoint(SONAMES.values()) if static else SONAMES["libvista"] in libraries
    # CMake writes the place of the libraries into the program, pkg-config leaves that to the user.
    place = {} if build is build_by_cmake or static else {"LD_LIBRARY_PATH": str(prefix / "lib")}
    if example is FLIGHT:
        check_flight(succeed(program, cwd=tmp_path, **place))
    else:
        check_pair(succeed(program, *write_pair(tmp_path), 300, 0.5, cwd=tmp_path, **place))


def check_flight(text: str) -> None:
    """A board 30 m ahead of the world's origin, from frame 4 on; the camera has flown 4 m + 0.9 m a frame."""
    heading, *lines = text.splitlines()
    assert heading == f"libvista {VERSION}" and len(lines) == 20
    for frame, line in list(enumerate(lines))[8:]:
        distances = [float(text) for text in re.findall(r"obstacle \d+ at ([0-9.]+) m", line)]
        assert len(distances) == 1, line
        surface_m = 26.0 - 0.9 * frame  # the thing's middle is up to 0.25 m behind its surface
        assert 0.97 * surface_m <= distances[0] <= 1.03 * surface_m + 0.25, line
        assert "collision in" in line


def write_pair(folder: Path) -> list[Path]:
    scenes = cases.make_board_scenes(folder / "pair", 1, stills=True)
    paths = []
    for side in ("left", "right"):
        image = read_grey(scenes / f"scene00_{side}.png")
        paths.append(folder / f"{side}.pgm")
        cases.write_image(paths[-1], image)
    return paths


def check_pair(text: str) -> None:
    """A board 2.5 m wide, 5 m high and 12.5 m away before a wall at 25 m."""
    heading, nearest, *_ = text.splitlines()
    assert re.fullmatch(rf"libvista {VERSION}: [0-9.]+ % of the pixels matched", heading)
    distance_m, width_m, height_m = (float(number) for number in re.findall(r"([0-9.]+) m\b", nearest))
    assert distance_m == pytest.approx(12.5, rel=0.02)
    assert width_m == pytest.approx(2.5, abs=0.5) and height_m == pytest.approx(5.0, abs=0.5)


def test_an_example_refuses_a_bad_image(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "made").mkdir()
    program = build_by_pkg_config(PAIR, tmp_path / "made", prefix, static=True)
    (tmp_path / "empty.pgm").touch()
    done = run(program, "empty.pgm", "empty.pgm", 300, 0.5, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr == "pair: empty.pgm: not a binary PGM file with 8 bits a pixel\n"
