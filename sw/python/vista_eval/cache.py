"""What takes long to find is kept in a file, with a digest of what decides it, until that changes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from vista.output import write_atomically

T = TypeVar("T")


def kept(path: Path, digest: str, find: Callable[[], T], read: Callable[[Any], T], anew: bool = False) -> T:
    """What `path` holds, if that is of this digest; else, or if asked for anew, what is found and kept there.

    read: from what JSON makes of it."""
    if not anew:
        try:
            content = json.loads(path.read_text())
            if content["digest"] == digest:
                return read(content["found"])
        except (OSError, ValueError, KeyError, TypeError):  # absent, or of an earlier layout
            pass
    found = find()
    write_atomically(path, json.dumps({"digest": digest, "found": to_json(found)}))
    return found


def to_json(value: Any) -> Any:
    match value:
        case dict():
            return {name: to_json(item) for name, item in value.items()}
        case list() | tuple():
            return [to_json(item) for item in value]
        case np.ndarray() | np.generic():
            return value.tolist()
    return to_json(asdict(value)) if is_dataclass(value) else value


def digest_of(*parts: str | Path) -> str:
    """Of texts, and of what files hold."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.read_bytes() if isinstance(part, Path) else part.encode())
    return digest.hexdigest()


def flight_files(folder: Path) -> Iterator[str | Path]:
    """For a digest: the images of a flight by name, size and time, its calibration and poses by content."""
    for camera in ("cam0", "cam1"):
        for image in sorted((folder / "mav0" / camera / "data").iterdir()):
            yield f"{image.name} {image.stat().st_size} {image.stat().st_mtime_ns}"
    yield from sorted((folder / "mav0").rglob("*.[cy]*"))
