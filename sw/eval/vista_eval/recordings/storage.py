"""The storage of recordings: a folder or a prefix of an object store, through fsspec."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

from fsspec import AbstractFileSystem
from fsspec.core import url_to_fs
from fsspec.implementations.local import LocalFileSystem
from vista.errors import InputError
from vista.sequence.image import EXTENSIONS

from vista_eval.cache import digest_of

MOST_FOLDERS_DEEP = 16
# What tells that a file has changed, by file system; besides its size.
STAMPS = ("ETag", "etag", "md5Hash", "mtime", "LastModified", "last_modified", "updated", "created")

Info = dict[str, Any]


def open_prefix(prefix: str) -> tuple[AbstractFileSystem, str]:
    """The file system and the path in it, absolute. Raises InputError."""
    try:
        files, path = url_to_fs(prefix)
    except (ImportError, ValueError) as error:
        raise InputError(prefix, str(error)) from None
    return files, str(path).rstrip("/")


def absolute(prefix: str) -> str:
    """The prefix as workers with another working directory find it."""
    files, root = open_prefix(prefix)
    return root if isinstance(files, LocalFileSystem) else prefix


def find_recordings(prefix: str) -> list[str]:
    """Names of the recordings: their paths below the prefix, "." if it is one itself. Whatever has a trace of
    one counts: what is wrong with it is said where it is opened. Raises InputError."""
    files, root = open_prefix(prefix)
    files.invalidate_cache()
    if not files.isdir(root):
        raise InputError(prefix, "no such folder")
    found = sorted(_below(files, root, set()))
    if not found:
        raise InputError(prefix, "holds no recordings")
    return [str(PurePosixPath(path).relative_to(root)) for path in found]


def _below(files: AbstractFileSystem, folder: str, seen: set[str], depth: int = 0) -> Iterator[str]:
    if isinstance(files, LocalFileSystem):  # links may lead back to where they are
        real = os.path.realpath(folder)
        if real in seen:
            return
        seen.add(real)
    entries = [(entry["name"].rstrip("/"), entry["type"]) for entry in files.ls(folder, detail=True)]
    names = {PurePosixPath(path).name for path, _ in entries}
    if is_recording(names):
        yield folder
    elif depth < MOST_FOLDERS_DEEP:
        for path, kind in sorted(entries):
            if PurePosixPath(path).name.startswith(".") or kind == "file":
                continue
            if kind == "directory" or files.isdir(path):  # or a link to one
                yield from _below(files, path, seen, depth + 1)


def is_recording(names: set[str]) -> bool:
    """Tells a recording by the names in a folder; a trace of one of the layouts is enough."""
    if names & {"mav0", "image_0", "image_1", "calib.txt", "calibration.toml"}:
        return True
    return any(
        path.stem.endswith(("_left", "_right")) and path.suffix.lower() in EXTENSIONS
        for path in map(PurePosixPath, names)
    )


@dataclass(frozen=True)
class Content:
    """What a recording consists of, told without reading it."""

    digest: str
    bytes: int


def content_of(prefix: str, name: str) -> Content:
    files, root = open_prefix(prefix)
    files.invalidate_cache()
    infos = files_of(files, path_of(root, name))
    lines = [f"{path} {info['size']} {stamp_of(info)}" for path, info in sorted(infos.items())]
    return Content(digest_of("\n".join(lines)), sum(info["size"] for info in infos.values()))


def stamp_of(info: Info) -> str:
    return next((str(info[key]) for key in STAMPS if key in info), "")


def files_of(files: AbstractFileSystem, folder: str) -> dict[str, Info]:
    """Files by their paths relative to the folder. KITTI has the poses of a sequence beside that."""
    local = isinstance(files, LocalFileSystem)
    found = dict(_local_files(folder) if local else files.find(folder, detail=True))
    poses = posixpath.normpath(f"{folder}/../../poses/{posixpath.basename(folder)}.txt")
    if files.isfile(poses):
        found[poses] = files.info(poses)
    return {posixpath.relpath(path, folder): info for path, info in found.items()}


def _local_files(folder: str) -> Iterator[tuple[str, Info]]:
    """Lists files, also through links, which fsspec does not follow."""
    seen = set()
    for place, folders, names in os.walk(folder, followlinks=True):
        real = os.path.realpath(place)
        if real in seen:
            folders.clear()
            continue
        seen.add(real)
        for path in (Path(place, name) for name in names):
            status = path.stat() if path.exists() else path.lstat()
            yield str(path), {"size": status.st_size, "mtime": status.st_mtime_ns}


def path_of(root: str, name: str) -> str:
    return root if name == "." else f"{root}/{name}"


@contextmanager
def as_folder(prefix: str, name: str) -> Iterator[Path]:
    """The recording as a local folder: where it is, or a copy that is removed afterwards."""
    files, root = open_prefix(prefix)
    source = path_of(root, name)
    if isinstance(files, LocalFileSystem):
        yield Path(source)
        return
    with TemporaryDirectory(prefix="vista-recording-") as temporary:
        folder = Path(temporary, "folder", "of", posixpath.basename(source))
        targets = {path: Path(os.path.normpath(folder / path)) for path in files_of(files, source)}
        if not all(target.is_relative_to(temporary) for target in targets.values()):
            raise InputError(name, "has files outside of itself")
        sources = [posixpath.normpath(f"{source}/{path}") for path in targets]
        files.get(sources, [str(target) for target in targets.values()])
        yield folder
