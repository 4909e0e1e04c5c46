"""What all tests share: the markers `native`, of those that reach compiled code, and `slow`."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parent
# These reach compiled code by running a program, or through the Python package.
NATIVE_PATHS = (
    "model/systemc/tests",
    "model/tests/test_c_engine.py",
    "sw/tests/test_fly_",
    *(f"sw/tests/test_{name}.py" for name in ("engine", "real_sequence", "replay", "street")),
)
# What `make check` leaves out: simulations of the RTL, renderings, installations, and long runs.
SLOW = """
    replay_aarch64 board board_sim cache calibrate cli dataset_command demo engine_board engine_rtl figures
    flight flights_command fly_camera fly_cross fly_mavlink fly_program fly_shared fuzz
    health_real jobs jobs_cluster live_camera live_command
    live_loop live_parts mavlink_command measured_pairs obstacle_schema
    real_sequence report ros_faults ros_process ros_run run_health scenes score_flight static_world street
    throughput
"""
SLOW_PATHS = (
    "tb",
    *(f"scripts/tests/test_{name}.py" for name in ("documentation", "install", "setup", "wheel")),
    *(f"sw/tests/test_{name}.py" for name in SLOW.split()),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    known: dict[str, bool] = {}
    for item in items:
        module = item.getparent(pytest.Module)
        path = item.path.relative_to(ROOT).as_posix()
        if path.startswith(NATIVE_PATHS) or (module is not None and calls_c(module.obj, known)):
            item.add_marker(pytest.mark.native)
        if path.startswith(SLOW_PATHS):
            item.add_marker(pytest.mark.slow)


def calls_c(module: ModuleType, known: dict[str, bool]) -> bool:
    """The module, or a helper of the tests that it imports from, holds an interface to a C library."""
    name = module.__name__
    if name not in known:
        known[name] = False  # while it is looked at: helpers may import each other
        values = list(vars(module).values())
        helpers = {getattr(value, "__module__", None) for value in values} | {
            value.__name__ for value in values if isinstance(value, ModuleType)
        }
        known[name] = any(type(value).__name__ == "FFI" for value in values) or any(
            calls_c(sys.modules[helper], known) for helper in helpers if is_helper(helper)
        )
    return known[name]


def is_helper(name: str | None) -> bool:
    file = getattr(sys.modules.get(name or ""), "__file__", None)
    return file is not None and Path(file).parent.name == "tests" and Path(file).is_relative_to(ROOT)
