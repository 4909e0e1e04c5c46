"""Build parameters out of range stop the elaboration."""

from __future__ import annotations

import subprocess

import pytest
from tools import ROOT, VERILATOR_FLAGS, sources, verilator_environment

pytestmark = pytest.mark.slow

ILLEGAL = [
    (0, 11, 1024, "NumDisparities"), (8, 11, 1024, "NumDisparities"), (40, 11, 1024, "NumDisparities"),
    (272, 11, 1024, "NumDisparities"),
    (32, 3, 1024, "BlockSize"), (32, 10, 1024, "BlockSize"), (32, 23, 1024, "BlockSize"),
    (32, 11, 42, "MaxWidth"), (32, 11, 65536, "MaxWidth"),
]  # fmt: skip


def elaborate(disparities: int, block: int, width: int) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["verilator", "--lint-only", *VERILATOR_FLAGS, "--top-module", "vista_stereo",
         f"-GNumDisparities={disparities}", f"-GBlockSize={block}", f"-GMaxWidth={width}",
         *map(str, sources("vista_stereo.f"))],
        cwd=ROOT, env=verilator_environment(), capture_output=True, text=True,
    )  # fmt: skip


@pytest.mark.parametrize(("disparities", "block", "width", "name"), ILLEGAL)
def test_illegal_parameters_stop_verilator(disparities: int, block: int, width: int, name: str) -> None:
    done = elaborate(disparities, block, width)
    assert done.returncode != 0
    assert f"{name} must be" in done.stderr


@pytest.mark.parametrize(("disparities", "block", "width"), [(32, 11, 43), (256, 21, 65535), (16, 5, 21)])
def test_legal_parameters_do_not(disparities: int, block: int, width: int) -> None:
    done = elaborate(disparities, block, width)
    assert done.returncode == 0, done.stderr


def elaborate_block(top: str, parameters: str) -> subprocess.CompletedProcess[str]:
    files = sources("vista_stereo.f" if top == "vista_stereo" else "vista_frontend.f")
    return subprocess.run(
        ["verilator", "--lint-only", *VERILATOR_FLAGS, "--top-module", top,
         *(f"-G{parameter}" for parameter in parameters.split()), *map(str, files)],
        cwd=ROOT, env=verilator_environment(), capture_output=True, text=True,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("top", "parameters", "message"),
    [("vista_stereo", f"FrontEnd=1 MaxPoints={points}", "MaxPoints must be")
     for points in (0, 1, 3, (1 << 23) + 1, 1 << 24)]
    + [("vista_stereo", "FrontEnd=1 MaxPoints=4", ""), ("vista_rectify", "MaxPoints=0", "MaxPoints must be"),
       ("vista_stereo", "FrontEnd=1 NumRows=0", "NumRows must be"),
       ("vista_stereo", "FrontEnd=1 MaxWidth=4097", "MaxWidth must be"),
       ("vista_stereo", "FrontEnd=1 BlockSize=4", "BlockSize must be"),
       *((top, "SideWidth=0", "SideWidth must be") for top in ("vista_pyramid", "vista_rectify")),
       *(("vista_rectify", f"NumRows={rows}", "NumRows must be") for rows in (8, 48, 256)),
       *(("vista_rectify", f"MaxWidth={width}", "MaxWidth must be") for width in (3, 4097)),
       ("vista_rectify", "MaxWidth=4096", "")],
)  # fmt: skip
def test_every_build_parameter_is_checked(top: str, parameters: str, message: str) -> None:
    done = elaborate_block(top, parameters)
    assert (done.returncode != 0) == bool(message), done.stderr
    assert message in done.stderr
