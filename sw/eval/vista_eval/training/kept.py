"""Keeps what was collected of a flight for learning, as long as all that decides it is the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from vista import native, parameters

from vista_eval.cache import code_digest, digest_of, kept
from vista_eval.dataset.truth import TRUTH
from vista_eval.fly import flight_digest

T = TypeVar("T")


def kept_of_flight(
    path: Path, folder: Path, values: parameters.Values, collect: Callable[..., T], read: Callable[[Any], T]
) -> T:
    """What `path` holds of the flight, or else what `collect(folder, values)` finds."""
    digest = digest_of(
        flight_digest(folder, values),
        code_digest(collect.__module__),
        native.library_path("vista_stages"),
        folder / TRUTH,
    )
    return kept(path, digest, lambda: collect(folder, values), read)
