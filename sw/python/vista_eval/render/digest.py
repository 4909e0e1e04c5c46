"""What stands for every byte of a rendered flight: its scene's geometry and albedo, its parameters, the code
that renders, the libraries. A change elsewhere, in another flight's scene say, leaves the flight as it is."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from vista_eval.render.scene import Scene

FOLDER = Path(__file__).parents[1]
RENDERING = tuple(
    f"render/{name}"
    for name in ["frame", "motion", "renderer", "rig", "sensor", "shapes", "trajectory", "view"]
) + ("dataset/truth", "dataset/layout", "dataset/files")
LIBRARIES = ("mitsuba", "numpy", "opencv-python-headless")


def feed(digest: hashlib._Hash, value: object) -> None:
    """Adds everything a value is made of."""
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype} {value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for each in fields(value):
            feed(digest, getattr(value, each.name))
    elif isinstance(value, (tuple, list)):
        digest.update(f"{len(value)} of".encode())
        for each in value:
            feed(digest, each)
    elif callable(value):  # a scene's maker: its sources are in the digest
        digest.update(value.__qualname__.encode())
    else:
        digest.update(repr(value).encode())


def libraries() -> list[str]:
    return [version(library) for library in LIBRARIES]


def content_sha256(scene: Scene, parameters: tuple) -> str:
    digest = hashlib.sha256()
    feed(digest, [libraries(), [(FOLDER / f"{name}.py").read_text() for name in RENDERING]])
    feed(digest, [scene, parameters])
    return digest.hexdigest()


def sources_sha256(parameters: tuple) -> str:
    """Of all sources that a flight could depend on: if equal, so is the content; no scene is made."""
    digest = hashlib.sha256()
    feed(digest, [libraries(), [path.read_text() for path in sorted(FOLDER.rglob("*.py"))], parameters])
    return digest.hexdigest()
