"""The native libraries and their bindings, from the build folder of a checkout or an installed package."""

from __future__ import annotations

import functools
import importlib.util
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent
_INSTALLED = _PACKAGE / "_lib"


def _folders() -> list[tuple[Path, Path]]:
    """Where (libraries, bindings) may lie, the checkout's build folder first: it is being worked on."""
    checkouts = [parent for parent in _PACKAGE.parents if (parent / "model" / "c").is_dir()]
    return [(root / "build" / "lib", root / "build" / "python") for root in checkouts] + [
        (_INSTALLED, _INSTALLED)
    ]


@functools.cache
def load(name: str) -> tuple[Any, Any]:
    """The cffi pair (ffi, lib) of lib<name>.so and <name>_abi.py; ImportError when it has not been built."""
    for libraries, bindings in _folders():
        library, binding = libraries / f"lib{name}.so", bindings / f"{name}_abi.py"
        if library.is_file() and binding.is_file():
            spec = importlib.util.spec_from_file_location(f"{name}_abi", binding)
            assert spec is not None and spec.loader is not None
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            return module.ffi, module.ffi.dlopen(str(library))
    raise ImportError(f"lib{name}.so is not built: run `make build`")
