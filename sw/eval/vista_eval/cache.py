"""Keeps results that take long in files, each with a digest of everything that decides it.

A digest is made of explicit inputs, of the native libraries and of code: of an entry module and of whatever
it imports of our packages, directly or not. Of each module the syntax tree counts, without docstrings,
comments and imports of our own: rewording or moving a module keeps what is kept. Imports for types alone do
not count.
"""

from __future__ import annotations

import ast
import hashlib
import json
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict, fields, is_dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from vista.output import make_folder, write_atomically

T = TypeVar("T")


def kept(path: Path, digest: str, find: Callable[[], T], read: Callable[[Any], T], anew: bool = False) -> T:
    """What `path` holds, if that is of this digest; else, or if asked for anew, what is found and kept there.

    read: from what JSON makes of it."""
    if not anew:
        content = read_kept(path, digest)
        with suppress(ValueError, KeyError, TypeError):  # of an earlier layout
            if content is not None:
                return read(content)
    found = find()
    keep(path, digest, found)
    return found


def read_kept(path: Path, digest: str) -> Any | None:
    """What `path` holds, as JSON makes it, if that is of this digest."""
    try:
        content = json.loads(path.read_text())
        return content["found"] if content["digest"] == digest else None
    except (OSError, ValueError, KeyError, TypeError):  # absent, or of an earlier layout
        return None


def keep(path: Path, digest: str, found: Any) -> Any:
    """Keeps it for `read_kept`, and returns what that will."""
    text = json.dumps({"digest": digest, "found": to_json(found)})
    make_folder(path.parent)
    write_atomically(path, text)
    return json.loads(text)["found"]


def to_json(value: Any) -> Any:
    match value:
        case dict():
            return {name: to_json(item) for name, item in value.items()}
        case list() | tuple():
            return [to_json(item) for item in value]
        case np.ndarray() | np.generic():
            return value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        return to_json(asdict(value))
    return value


def digest_of(*parts: str | Path) -> str:
    """The digest of texts, and of what files hold."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.read_bytes() if isinstance(part, Path) else part.encode())
    return digest.hexdigest()


def content_sha256(*values: object) -> str:
    """The digest of everything that the values are made of: arrays, dataclasses, sequences, names of
    functions."""
    digest = hashlib.sha256()
    _feed(digest, values)
    return digest.hexdigest()


def _feed(digest: hashlib._Hash, value: object) -> None:
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype} {value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for each in fields(value):
            _feed(digest, getattr(value, each.name))
    elif isinstance(value, (tuple, list)):
        digest.update(f"{len(value)} of".encode())
        for each in value:
            _feed(digest, each)
    elif callable(value):
        digest.update(getattr(value, "__qualname__", repr(value)).encode())
    else:
        digest.update(repr(value).encode())


def flight_files(folder: Path) -> Iterator[str | Path]:
    """Parts of a flight's digest: the images by name, size and time, its calibration and poses by content."""
    for camera in ("cam0", "cam1"):
        for image in sorted((folder / "mav0" / camera / "data").iterdir()):
            yield f"{image.name} {image.stat().st_size} {image.stat().st_mtime_ns}"
    yield from sorted((folder / "mav0").rglob("*.[cy]*"))


# ---- code ----

PACKAGES = ("vista", "vista_eval", "vista_throughput")
Roots = tuple[tuple[str, Path], ...]  # of packages: name, folder


def code_digest(entry: str, roots: Roots | None = None) -> str:
    """The digest of the code that a module runs: its own and what it imports of our packages, wherever that
    lies."""
    return digest_of(*sorted(code_of(entry, roots).values()))


def code_of(entry: str, roots: Roots | None = None) -> dict[str, str]:
    """The digest of each module that counts, by its name."""
    roots = our_packages() if roots is None else roots
    folders = dict(roots)
    found: dict[str, str] = {}
    waiting = [entry]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        path = _module_file(name, folders) or Path(sys.modules[name].__file__ or "")  # a test's own module
        found[name], imported = module_code(name, path, roots)
        waiting += imported
    return found


@cache
def module_code(name: str, path: Path, roots: Roots) -> tuple[str, list[str]]:
    """The digest of a module by itself, and what it imports of ours. Entries share most of their modules."""
    folders = dict(roots)
    tree = ast.parse(path.read_text(encoding="utf-8"))
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    imported = _imported(tree, package, folders)
    return digest_of(_bare(tree, folders)), imported


@cache
def our_packages() -> Roots:
    specs = {name: find_spec(name) for name in PACKAGES}
    places = {name: spec.submodule_search_locations for name, spec in specs.items() if spec is not None}
    return tuple((name, Path(place[0])) for name, place in places.items() if place)


def _module_file(name: str, folders: dict[str, Path]) -> Path | None:
    """None for what is none of our modules."""
    top, *below = name.split(".")
    if top not in folders:
        return None
    path = folders[top].joinpath(*below)
    return next((file for file in (path / "__init__.py", path.with_suffix(".py")) if file.is_file()), None)


def _imported(tree: ast.Module, package: str, folders: dict[str, Path]) -> list[str]:
    """Our modules that the statements of a module import, in functions too, but not for types alone.

    A package counts where something is taken from it that is not a module of its own."""
    names: list[str] = []
    for node in _outside_type_checking(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            source = _source(node, package)
            below = [f"{source}.{alias.name}" for alias in node.names]
            names += [name if _module_file(name, folders) else source for name in below]
    return [name for name in names if _module_file(name, folders)]


def _source(node: ast.ImportFrom, package: str) -> str:
    """The module that names come from; `package`: of the module that imports."""
    if not node.level:
        return node.module or ""
    parts = package.split(".")
    return ".".join(parts[: len(parts) - node.level + 1] + ([node.module] if node.module else []))


def _outside_type_checking(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        children: Iterable[ast.AST] = node.orelse
    else:
        yield node
        children = ast.iter_child_nodes(node)
    for child in children:
        yield from _outside_type_checking(child)


class _Bare(ast.NodeTransformer):
    """Leaves out what does not decide what code does."""

    def __init__(self, folders: dict[str, Path]) -> None:
        self.folders = folders

    def visit_Import(self, node: ast.Import) -> ast.Import | None:
        node.names = [alias for alias in node.names if alias.name.split(".")[0] not in self.folders]
        return node if node.names else None

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.ImportFrom | None:
        ours = node.level or (node.module or "").split(".")[0] in self.folders
        return None if ours else node

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        """Docstrings, of fields too: a text that stands by itself does nothing."""
        text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if text else node


def _bare(tree: ast.Module, folders: dict[str, Path]) -> str:
    return ast.dump(_Bare(folders).visit(tree), annotate_fields=False)
