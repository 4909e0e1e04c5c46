"""The two test sets as they were frozen: what every byte of their flights follows from, flight by flight.

A digest of a flight is that of its content (`vista_eval.render.flight.content_of`). A set may be
frozen anew only as long as nothing has been scored on it.

The last bits of products of matrices differ with the kernels that OpenBLAS chooses for a processor, and with
them digests and pictures: both sets were frozen with those of OPENBLAS_CORETYPE=SkylakeX, which a processor
with AVX-512 runs."""

from __future__ import annotations

import json
from pathlib import Path

from vista.errors import InputError
from vista.output import write_atomically

from vista_eval.cache import digest_of
from vista_eval.render.flight import Flight, content_of, read_marker
from vista_eval.worlds.sampled.catalog import COUNT, FAMILIES, SEED

FROZEN = {split: Path(f"doc/results/worlds-{split}-set.json") for split in ("test", "test2")}

Digests = dict[str, str]  # content by name of the flight


def flights_of_the_set(split: str) -> list[Flight]:
    families = [family for family in FAMILIES.values() if family.split == split]
    return [flight for family in families for flight in family.flights(COUNT, SEED)]


def content_digest(flight: Flight) -> tuple[str, str]:
    return flight.name, content_of(flight, "full")


def digest_of_set(digests: Digests) -> str:
    return digest_of(json.dumps(digests, sort_keys=True))


def write_frozen(root: Path, split: str, digests: Digests) -> None:
    content = {"digest": digest_of_set(digests), "flights": dict(sorted(digests.items()))}
    write_atomically(root / FROZEN[split], json.dumps(content, indent=1) + "\n")


def read_frozen(root: Path, split: str) -> Digests:
    """Raises InputError if the set is not frozen, or its file was edited."""
    path = root / FROZEN[split]
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        digests, digest = dict(content["flights"]), content["digest"]
    except OSError:
        raise InputError(
            path, f"missing: the set is not frozen (vista worlds DIR --split {split} --freeze)"
        ) from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(path, f"not a frozen test set: {error!r}") from None
    if digest_of_set(digests) != digest:
        raise InputError(path, "was edited: its digest is not that of its flights")
    return digests


def changed(frozen: Digests, found: Digests) -> list[str]:
    """Names of the flights that differ, are missing or are new."""
    return sorted(name for name in frozen.keys() | found.keys() if frozen.get(name) != found.get(name))


def check_rendered(frozen: Digests, folders: list[Path]) -> None:
    """Raises InputError unless the folders hold flights of the frozen set."""
    for folder in folders:
        if read_marker(folder).get("content") != frozen.get(folder.name):
            raise InputError(folder, "is not the flight of that name in the frozen test set")
