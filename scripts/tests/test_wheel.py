"""The wheel: built, installed into an empty environment, and run elsewhere without a file of the checkout."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
import zipfile
from email.parser import Parser
from pathlib import Path

import numpy as np
import pytest
import sequence_cases as cases
from shared_data import REPOSITORY
from vista import parameters

pytestmark = pytest.mark.slow

VERSION = (REPOSITORY / "VERSION").read_text().strip()
PYTHON = REPOSITORY / ".venv" / "bin" / "python"
LIBRARIES = ("vista", "vista_engine")

# Notes every file of the checkout that Python opens or that is mapped into the process; the packages that
# vista depends on are borrowed from the checkout's .venv.
WATCH = """
import atexit, os, sys
from pathlib import Path
CHECKOUT, BORROWED, LOG = {checkout!r}, {borrowed!r}, {log!r}
seen = set()
def note(path):
    path = os.path.abspath(os.fsdecode(path))
    if path.startswith(CHECKOUT + os.sep) and not path.startswith(BORROWED):
        seen.add(path)
def watch(event, arguments):
    if event in ("open", "os.listdir", "os.scandir") and isinstance(arguments[0], (str, bytes, os.PathLike)):
        note(arguments[0])
def leave():
    for line in Path("/proc/self/maps").read_text().splitlines():
        if "/" in line:
            note(line[line.index("/"):])
    with open(LOG, "a") as log:
        log.writelines(path + "\\n" for path in sorted(seen))
        log.write("watched\\n")
sys.addaudithook(watch)
atexit.register(leave)
"""


def pip(*arguments: object) -> None:
    command = [PYTHON, "-m", "pip", "--disable-pip-version-check", *arguments]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    # The build folder stays, so that the next wheel compiles what has changed only, and without optimising.
    pip(
        "wheel", "--no-deps", "--no-index", "--no-build-isolation",
        "--config-settings", "build-dir=build/wheel", "--config-settings", "cmake.build-type=Debug",
        "--wheel-dir", folder, REPOSITORY,
    )  # fmt: skip
    [path] = folder.glob("*.whl")
    return path


class Environment:
    """An environment that holds the wheel and nothing else, and sees what vista depends on."""

    def __init__(self, folder: Path, wheel: Path) -> None:
        self.folder, self.log = folder, folder / "read.log"
        subprocess.run([PYTHON, "-m", "venv", "--without-pip", folder / "env"], check=True, timeout=120)
        pip(f"--python={folder / 'env' / 'bin' / 'python'}", "install", "--no-deps", "--no-index", wheel)
        [self.packages] = (folder / "env" / "lib").glob("python*/site-packages")
        [borrowed] = (REPOSITORY / ".venv" / "lib").glob("python*/site-packages")
        (self.packages / "borrowed.pth").write_text(f"{borrowed}\n")
        watch = WATCH.format(checkout=str(REPOSITORY), borrowed=str(REPOSITORY / ".venv"), log=str(self.log))
        # Not sitecustomize.py: Debian has one of its own, which comes first.
        (self.packages / "watch_the_checkout.py").write_text(watch)
        (self.packages / "watch_the_checkout.pth").write_text("import watch_the_checkout\n")

    def vista(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        """Run in the folder; fails the test if it touched the checkout."""
        self.log.unlink(missing_ok=True)
        command = [self.folder / "env" / "bin" / "vista", *arguments]
        variables = {"PATH": os.environ["PATH"], "HOME": str(self.folder)}
        done = subprocess.run(
            [str(part) for part in command],
            cwd=self.folder, env=variables, capture_output=True, text=True, timeout=300,
        )  # fmt: skip
        assert self.log.read_text().splitlines() == ["watched"]
        return done


@pytest.fixture(scope="session")
def environment(tmp_path_factory: pytest.TempPathFactory, wheel: Path) -> Environment:
    return Environment(tmp_path_factory.mktemp("elsewhere"), wheel)


def test_what_the_wheel_holds(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        [metadata] = [name for name in names if name.endswith(".dist-info/METADATA")]
        fields = Parser().parsestr(archive.read(metadata).decode())
    assert wheel.name.startswith(f"vista_stereo-{VERSION}-py3-none-")
    tops = {name.partition("/")[0] for name in names}
    assert tops == {"vista", "vista_throughput", f"vista_stereo-{VERSION}.dist-info"}
    assert {"vista/parameters.toml", "vista/report/templates/page.css"} <= names
    for library in LIBRARIES:
        assert {f"vista/_lib/lib{library}.so", f"vista/_lib/{library}_abi.py"} <= names
    assert not any("vista_stages" in name for name in names), "the stages are for tests and the evaluation"
    assert fields["Version"] == VERSION
    needed, extras = fields.get_all("Requires-Dist", []), fields.get_all("Provides-Extra", [])
    assert all("==" not in text.partition(";")[0] for text in needed), "exact versions are for the lock file"
    assert {"bags", "throughput"} <= set(extras)


def test_config(environment: Environment) -> None:
    done = environment.vista("config")
    assert (done.returncode, done.stderr) == (0, "")
    assert tomllib.loads(done.stdout) == parameters.defaults()


def test_version(environment: Environment) -> None:
    done = environment.vista("--version")
    assert (done.returncode, done.stdout) == (0, f"vista {VERSION}\n")


def test_disparity(environment: Environment) -> None:
    folder = cases.make_pairs(environment.folder / "one", frames=1)
    out = environment.folder / "disparity.npy"
    pair = [folder / f"scene00_{side}.png" for side in ("left", "right")]
    done = environment.vista("disparity", *pair, "--out", out)
    assert done.returncode == 0, done.stderr
    words = np.load(out)
    assert words.shape == (cases.HEIGHT, cases.WIDTH)
    assert np.median(words[words >= 0]) == 16 * cases.DISPARITY_PX


def test_run(environment: Environment) -> None:
    folder = cases.make_board_scenes(environment.folder / "boards", frames=2, stills=True)
    done = environment.vista("run", folder, "--out", environment.folder / "out")
    assert done.returncode == 0, done.stderr
    lines = (environment.folder / "out" / "obstacles.jsonl").read_text().splitlines()
    frames = [json.loads(line) for line in lines]
    assert len(frames) == 2
    for frame in frames:
        nearest = min(obstacle["distance_m"] for obstacle in frame["obstacles"])
        assert nearest == pytest.approx(12.5, rel=0.02)
    assert (environment.folder / "out" / "report.html").stat().st_size > 10_000


def test_a_command_of_an_extra_is_known(environment: Environment) -> None:
    done = environment.vista("throughput", "--help")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: vista throughput")


def test_a_command_of_the_evaluation_is_named_with_its_extra(environment: Environment) -> None:
    done = environment.vista("flights", "DIR")
    line = "vista: flights needs vista-stereo[eval]: pip install 'vista-stereo[eval]'\n"
    assert (done.returncode, done.stderr) == (2, line)


def test_the_environment_is_one_of_its_own(environment: Environment) -> None:
    """Or the tests above would show nothing."""
    text = "import vista, vista_throughput, sys; print(vista.__file__, vista_throughput.__file__, sys.prefix)"
    python = environment.folder / "env" / "bin" / "python"
    done = subprocess.run(
        [python, "-c", text], cwd=environment.folder, capture_output=True, text=True, timeout=60
    )
    paths = done.stdout.split()
    assert len(paths) == 3 and all(Path(path).is_relative_to(environment.folder) for path in paths)
    assert Path(sys.prefix) == REPOSITORY / ".venv"
