"""Marks tests that import an interface to C as `native`. Whoever runs a program or is slow says so itself."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parent

# Tests run in a process for each processor: the threads of numpy and OpenCV would wait for each other.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"):
    os.environ.setdefault(_threads, "1")

# Processes of tests keep the memory of images, which the system would clear anew for each image.
os.environ.setdefault("MALLOC_MMAP_THRESHOLD_", str(32 << 20))  # bytes; the most that glibc takes
os.environ.setdefault("MALLOC_TRIM_THRESHOLD_", str(1 << 30))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    known: dict[str, bool] = {}
    for item in items:
        module = item.getparent(pytest.Module)
        if module is not None and calls_c(module.obj, known):
            item.add_marker(pytest.mark.native)


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
