"""The native libraries and their bindings, from the build folder of a checkout or an installed package."""

from __future__ import annotations

import functools
import importlib.util
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent
_INSTALLED = _PACKAGE / "_lib"


def _checkouts() -> list[Path]:
    return [parent for parent in _PACKAGE.parents if (parent / "model" / "c").is_dir()]


def _folders() -> list[tuple[Path, Path]]:
    """Where (libraries, bindings) may lie, the checkout's build folder first: it is being worked on."""
    build = os.environ.get("VISTA_BUILD", "build")  # of libraries built otherwise, as for the sanitizers
    return [_of_build(root, build) for root in _checkouts()] + [(_INSTALLED, _INSTALLED)]


def _of_build(root: Path, build: str) -> tuple[Path, Path]:
    return root / build / "lib", root / "build" / "python"


@functools.cache
def load(name: str) -> tuple[Any, Any]:
    """The cffi pair (ffi, lib) of lib<name>.so and <name>_abi.py; ImportError when it has not been built."""
    return _open(*_find(name, name, _folders()))


@functools.cache
def load_as(name: str, binding: str, make: Callable[[Path, str], None]) -> tuple[Any, Any]:
    """The same for one of several libraries with one interface, <binding>_abi.py.

    make(root, name) brings the library of a checkout up to date first; ImportError if it cannot."""
    for root in _checkouts():
        make(root, name)
    # Simulated hardware is not a library to sanitize: VISTA_BUILD does not concern it.
    return _open(*_find(name, binding, [_of_build(root, "build") for root in _checkouts()]))


def library_path(name: str) -> Path:
    """Of lib<name>.so as load() finds it; ImportError when it has not been built."""
    return _find(name, name, _folders())[0]


def _find(name: str, binding: str, folders: list[tuple[Path, Path]]) -> tuple[Path, Path]:
    """Library and binding, of the first folder that has both."""
    for libraries, bindings in folders:
        library, module = libraries / f"lib{name}.so", bindings / f"{binding}_abi.py"
        if library.is_file() and module.is_file():
            return library, module
    raise ImportError(f"lib{name}.so is not built: run `make build`")


def _open(library: Path, binding: Path) -> tuple[Any, Any]:
    spec = importlib.util.spec_from_file_location(binding.stem, binding)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.ffi, module.ffi.dlopen(str(library))
