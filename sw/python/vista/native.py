"""Loads the native libraries and their bindings, from a checkout or an installed package."""

from __future__ import annotations

import functools
import importlib.util
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent
_INSTALLED = _PACKAGE / "_lib"
_ROOT = _PACKAGE.parents[2]
CHECKOUT = _ROOT if _PACKAGE == _ROOT / "sw" / "python" / "vista" else None  # that this package lies in


def build_folder() -> Path:
    """The build folder of the checkout. VISTA_BUILD names another for what is built otherwise, as for the
    sanitizers."""
    return _ROOT / os.environ.get("VISTA_BUILD", "build")


@functools.cache
def load(name: str) -> tuple[Any, Any]:
    """The cffi pair (ffi, lib) of lib<name>.so and <name>_abi.py; ImportError when it has not been built."""
    return _open(*_find(name, name, build_folder()))


@functools.cache
def load_as(name: str, binding: str, make: Callable[[Path, str], None]) -> tuple[Any, Any]:
    """The same for one of several libraries with one interface, <binding>_abi.py.

    make(root, name) brings the library of a checkout up to date first; ImportError if it cannot."""
    if CHECKOUT:
        make(CHECKOUT, name)
    # Simulated hardware is not a library to sanitize: VISTA_BUILD does not concern it.
    return _open(*_find(name, binding, _ROOT / "build"))


def check(ffi: Any, lib: Any, status: int, error: Callable[[str], Exception] = ValueError) -> None:
    """Raises what `error` makes of the text of a status, libvista's or its engine's, unless all is well."""
    if status:
        text_of = getattr(lib, "vista_status_text", None) or lib.vista_engine_status_text
        raise error(ffi.string(text_of(status)).decode())


def library_path(name: str) -> Path:
    """The path of lib<name>.so as load() finds it; ImportError when it has not been built."""
    return _find(name, name, build_folder())[0]


def program_path(name: str, goal: str) -> Path:
    """The path of a program of a checkout; ImportError when it has not been built with `make goal`."""
    path = build_folder() / "bin" / name
    if not (CHECKOUT and path.is_file()):
        raise ImportError(f"the program {name} is not built: it needs a checkout of VISTA and `make {goal}`")
    return path


def _find(name: str, binding: str, build: Path) -> tuple[Path, Path]:
    """Library and binding: in the build folder of a checkout, else in the package."""
    libraries, bindings = (build / "lib", build / "python") if CHECKOUT else (_INSTALLED, _INSTALLED)
    library, module = libraries / f"lib{name}.so", bindings / f"{binding}_abi.py"
    if not (library.is_file() and module.is_file()):
        raise ImportError(
            f"lib{name}.so is not built: run `make build`"
            if CHECKOUT
            else f"lib{name}.so is not part of this installation"
        )
    return library, module


def _open(library: Path, binding: Path) -> tuple[Any, Any]:
    spec = importlib.util.spec_from_file_location(binding.stem, binding)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.ffi, module.ffi.dlopen(str(library))
