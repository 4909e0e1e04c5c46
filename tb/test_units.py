"""The cocotb benches of the single modules: one build and one run for each set of parameters."""

from __future__ import annotations

import os

import pytest
from cocotb_tools.runner import get_runner
from tools import BUILD, VERILATOR_FLAGS, sources, verilator_environment

# Registers and memories that reset leaves alone start at random, not at zero.
RANDOM_START = ["+verilator+rand+reset+2", f"+verilator+seed+{os.environ.get('VISTA_SEED', 1)}"]
UNITS: list[tuple[str, dict[str, int]]] = [
    ("vista_skid", {"Width": 8}),
    ("vista_result_fifo", {"Width": 16, "InFlight": 20}),
    ("vista_delay", {"Width": 8, "Latency": 1}),
    ("vista_delay", {"Width": 8, "Latency": 21}),
    ("vista_winner", {"NumDisparities": 32, "CostW": 15}),
    ("vista_winner", {"NumDisparities": 48, "CostW": 13}),
    ("vista_uniqueness_bound", {"CostW": 17}),
    ("vista_uniqueness", {"NumDisparities": 16, "CostW": 13}),
    ("vista_neighbours", {"NumDisparities": 16, "CostW": 13}),
    ("vista_neighbours", {"NumDisparities": 48, "CostW": 13}),
    ("vista_neighbours", {"NumDisparities": 128, "CostW": 15}),
    ("vista_subpixel", {"CostW": 15, "IndexW": 5}),
    ("vista_candidate", {"NumDisparities": 16, "BlockSize": 5}),
    ("vista_candidate", {"NumDisparities": 48, "BlockSize": 11}),
    ("vista_right_winner", {"NumDisparities": 16, "CostW": 13, "RingW": 5}),
    ("vista_lr_check", {"NumDisparities": 16, "CostW": 17, "RingW": 5}),
    ("vista_lr_check", {"NumDisparities": 32, "CostW": 13, "RingW": 6}),
    ("vista_framer", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_prefilter", {"MaxWidth": 32}),
    ("vista_line_store", {"Width": 9, "Depth": 40}),
    ("vista_row_delay", {"Width": 22, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_cost_columns", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 32}),
    ("vista_window_sums", {"NumChannels": 3, "BlockSize": 7}),
    ("vista_frame_writer", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 64}),
    ("vista_stereo", {"NumDisparities": 16, "BlockSize": 5, "MaxWidth": 128}),
]


@pytest.mark.parametrize(
    ("module", "parameters"), UNITS, ids=lambda v: v if isinstance(v, str) else "_".join(map(str, v.values()))
)
def test_unit(module: str, parameters: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in verilator_environment().items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("COCOTB_LOG_LEVEL", os.environ.get("COCOTB_LOG_LEVEL", "WARNING"))
    folder = BUILD / "units" / "_".join([module, *map(str, parameters.values())])
    waves = "VISTA_WAVES" in os.environ
    runner = get_runner("verilator")
    runner.build(
        sources=sources("vista_stereo.f" if module == "vista_stereo" else "vista_stereo_core.f"),
        hdl_toplevel=module, parameters=parameters, build_dir=folder, waves=waves,
        build_args=[*VERILATOR_FLAGS, "-CFLAGS", "-O1"],
        log_file=folder.with_suffix(".log"),
    )  # fmt: skip
    results = runner.test(
        hdl_toplevel=module, test_module=f"bench_{module.removeprefix('vista_')}", build_dir=folder,
        test_dir=folder, waves=waves, plusargs=RANDOM_START,
        extra_env={f"VISTA_{k.upper()}": str(v) for k, v in parameters.items()}, log_file=folder / "run.log",
    )  # fmt: skip
    text = results.read_text()
    assert "<testcase" in text, f"no test ran, see {folder}/run.log"
    assert "<failure" not in text and "<error" not in text, f"see {folder}/run.log"
