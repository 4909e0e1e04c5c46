"""The cocotb benches of the single modules: one build and one run for each set of parameters."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from cocotb_tools.runner import get_runner
from tools import BUILD, VERILATOR_FLAGS, bench_sources, sources, verilator_environment

pytestmark = pytest.mark.slow

# Registers and memories that reset leaves alone start at random, not at zero.
RANDOM_START = ["+verilator+rand+reset+2", f"+verilator+seed+{os.environ.get('VISTA_SEED', 1)}"]
# One size of each where the builds of the whole engine have the others.
UNITS: list[tuple[str, dict[str, int]]] = [
    ("vista_skid", {"Width": 8}),
    ("vista_result_fifo", {"Width": 16, "InFlight": 20}),
    ("vista_camera_fifo", {"Width": 18, "Depth": 8}),
    ("vista_camera_fifo", {"Width": 18, "Depth": 32}),
    ("vista_delay", {"Width": 8, "Latency": 1}),
    ("vista_delay_ring", {"Width": 8, "Latency": 21}),
    ("vista_memory", {"Width": 37, "Depth": 12, "Parity": 1}),
    ("vista_winner", {"NumDisparities": 48, "CostW": 13}),
    ("vista_uniqueness_bound", {"CostW": 17}),
    ("vista_uniqueness", {"NumDisparities": 16, "CostW": 13}),
    ("vista_neighbours", {"NumDisparities": 128, "CostW": 15}),
    ("vista_subpixel", {"CostW": 15, "IndexW": 5}),
    ("vista_confidence", {"NumDisparities": 16, "CostW": 17}),
    ("vista_candidate", {"NumDisparities": 48, "BlockSize": 11, "Confidence": 0}),
    ("vista_candidate", {"NumDisparities": 256, "BlockSize": 5, "Confidence": 1}),
    ("vista_right_winner", {"NumDisparities": 16, "CostW": 13, "RingW": 5}),
    ("vista_lr_check", {"NumDisparities": 16, "CostW": 17, "RingW": 5}),
    ("matching_framer", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_prefilter", {"MaxWidth": 32}),
    ("vista_line_store", {"Width": 9, "Depth": 40}),
    ("vista_line_store", {"Width": 9, "Depth": 40, "PieceDepth": 16}),
    ("vista_row_delay", {"Width": 22, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_cost_columns", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_window_sums", {"NumChannels": 3, "BlockSize": 7}),
    ("vista_frame_writer", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 64}),
    ("vista_word_packer", {}),
    ("vista_stereo", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 128}),
    ("vista_registers", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 128, "Confidence": 1}),
    ("vista_smooth", {"MaxWidth": 32, "SideWidth": 8}),
    ("vista_reduce", {"MaxWidth": 32}),
    ("vista_pyramid", {"MaxWidth": 40, "SideWidth": 8}),
    ("vista_rectify", {"MaxWidth": 40, "NumRows": 16, "MaxPoints": 16, "SideWidth": 8}),
    ("vista_rectify", {"MaxWidth": 64, "NumRows": 32, "MaxPoints": 64, "SideWidth": 8}),
    ("camera_engine", {"Depth": 64}),
    (
        "parity",
        {
            "NumDisparities": 16,
            "BlockSize": 5,
            "MaxWidth": 64,
            "FrontEnd": 1,
            "NumRows": 16,
            "MaxPoints": 64,
            "Parity": 1,
        },
    ),
    (
        "front_end",
        {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 64, "NumRows": 16, "MaxPoints": 64},
    ),
]
TOPS = {"parity": "vista_stereo"}  # of benches that do not have the name of their module
BENCHES = {"vista_delay_ring": "delay"}
OWN_MEMORY = ("vista_memory", "vista_line_store", "parity")  # the others have that of the benches
LISTS = {
    "vista_camera_fifo": "vista_camera.f",
    "camera_engine": "vista_stereo.f vista_camera.f",
    **dict.fromkeys(("vista_stereo", "vista_registers", "parity"), "vista_stereo.f"),
    **dict.fromkeys(
        ("vista_smooth", "vista_reduce", "vista_pyramid", "vista_rectify", "front_end"), "vista_frontend.f"
    ),
}


def files_of(module: str) -> list[Path]:
    """What a module is built from; one that is of the benches comes last."""
    harness = Path(__file__).parent / "common" / f"{module}.sv"
    files = LISTS.get(module, "vista_stereo_core.f")
    if module in OWN_MEMORY:
        return sources(files)
    listed = dict.fromkeys(file for name in files.split() for file in bench_sources(name))
    return [*listed, *([harness] if harness.is_file() else [])]


# Faults that an assertion of rtl/formal has to name: bench, module, what is replaced in it, and by what.
PLANTED = [
    (
        "vista_result_fifo",
        "vista_result_fifo",
        "32'(level_q) < Depth - InFlight",
        "32'(level_q) < Depth - 1",
    ),  # overflows
    (
        "vista_skid",
        "vista_skid",
        "if (~valid_q | ready_i) begin",
        "if (~valid_q | ready_i | valid_i) begin",
    ),  # a word is withdrawn
    (
        "matching_framer",
        "vista_framer",
        "if (frame_end) begin\n      active_q <= 1'b0;\n      fill_q   <= 1'b0;",
        "if (frame_end) begin\n      active_q <= 1'b0;",
    ),  # no such state
]


def run_unit(
    module: str, parameters: dict[str, int], files: list[Path], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> str:
    """The results of the bench of a module, once it is built; SystemExit when a test of it failed."""
    for name, value in verilator_environment().items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("COCOTB_LOG_LEVEL", os.environ.get("COCOTB_LOG_LEVEL", "WARNING"))
    waves = "VISTA_WAVES" in os.environ
    # Most benches are shorter than what a compiler takes to optimise their module.
    optimised = "-O1" if LISTS.get(module) == "vista_frontend.f" else "-O0"
    # Upset bits are what the properties exclude.
    flags = [flag for flag in VERILATOR_FLAGS if module != "parity" or flag != "-DVISTA_ASSERT"]
    runner = get_runner("verilator")
    runner.build(
        sources=files, hdl_toplevel=TOPS.get(module, module), parameters=parameters, build_dir=folder,
        waves=waves, build_args=[*flags, "-CFLAGS", optimised], log_file=folder.with_suffix(".log"),
    )  # fmt: skip
    results = runner.test(
        hdl_toplevel=TOPS.get(module, module), build_dir=folder,
        test_module=f"bench_{BENCHES.get(module, module.removeprefix('vista_'))}",
        test_dir=folder, waves=waves, plusargs=RANDOM_START,
        extra_env={f"VISTA_{k.upper()}": str(v) for k, v in parameters.items()}, log_file=folder / "run.log",
    )  # fmt: skip
    return Path(results).read_text()


@pytest.mark.parametrize(
    ("module", "parameters"), UNITS, ids=lambda v: v if isinstance(v, str) else "_".join(map(str, v.values()))
)
def test_unit(module: str, parameters: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    folder = BUILD / "units" / "_".join([module, *map(str, parameters.values())])
    text = run_unit(module, parameters, files_of(module), folder, monkeypatch)
    assert "<testcase" in text, f"no test ran, see {folder}/run.log"
    assert "<failure" not in text and "<error" not in text, f"see {folder}/run.log"


def planted(files: list[Path], module: str, right: str, wrong: str, folder: Path) -> list[Path]:
    """These files, of which that of a module is a copy with a fault."""
    (source,) = (file for file in files if file.stem == module)
    text = source.read_text()
    assert text.count(right) == 1
    copy = folder / source.name
    wrong_text = text.replace(right, wrong)
    if not copy.is_file() or copy.read_text() != wrong_text:  # what was built of it stays good
        folder.mkdir(parents=True, exist_ok=True)
        copy.write_text(wrong_text)
    return [copy if file == source else file for file in files]


@pytest.mark.parametrize(("bench", "module", "right", "wrong"), PLANTED, ids=[bench for bench, *_ in PLANTED])
def test_assertions_stop_the_simulation(
    bench: str, module: str, right: str, wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Assertions of overflow, handshake and states. Without a fault the benches above pass with the same
    assertions."""
    folder = BUILD / "units" / "planted" / module
    files = planted(files_of(bench), module, right, wrong, folder)
    parameters = next(values for name, values in UNITS if name == bench)
    with pytest.raises((RuntimeError, SystemExit)):
        run_unit(bench, parameters, files, folder / "build", monkeypatch)
    where = module if bench == module else f"{bench}.u_{module.removeprefix('vista_')}"
    assert f"Assertion failed in {where}: " in (folder / "build" / "run.log").read_text()


# Responses to writes that come a clock too early, and two.
EARLY = {
    "a_clock": ("Apply: state_q <= Settle;", "Apply: state_q <= Respond;"),
    "two_clocks": ("write_q ? Apply : Respond", "Respond"),
}


@pytest.mark.parametrize("early", EARLY)
def test_a_response_that_comes_before_its_write_has_taken_effect_is_noticed(
    early: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bench notices it without the properties of the bus, which would stop the simulation first."""
    folder = BUILD / "units" / "planted" / early
    files = planted(files_of("vista_registers"), "vista_axil", *EARLY[early], folder / "responds")
    files = planted(files, "vista_axil", '`include "vista_axil_properties.svh"', "", folder)
    parameters = next(values for name, values in UNITS if name == "vista_registers")
    with pytest.raises((RuntimeError, SystemExit)):
        run_unit("vista_registers", parameters, files, folder / "build", monkeypatch)
    assert "AssertionError: after" in (folder / "build" / "run.log").read_text()
