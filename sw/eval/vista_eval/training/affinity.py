"""Pairs of neighbouring cells, and how well their affinity says whether they show the same object.

The affinity of the paper's equation 3 is a weighted sum of one term a feature, and its weights "may be
determined using an offline boosting procedure". Here the pairs are taken from rendered flights, whose labels
are exact, and several ways to weigh the same two features are learned by logistic regression, one of them a
sum of steps, as boosting finds it. Each family is judged by weights that it had no part in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.geometry import Array

from vista_eval.cache import content_sha256
from vista_eval.dataset.scenes import read_scene
from vista_eval.dataset.truth import read_truth
from vista_eval.metrics.scenes import Partition, partition_scenes
from vista_eval.metrics.segmentation import Labels
from vista_eval.training.kept import kept_of_flight
from vista_eval.training.logistic import Held, cross_validate, fit, same_for_each

STRIDE = 8  # frames
PAIRS = 300  # of one object, and of two, that are drawn from a frame
PURE = 0.9  # share of a cell's pixels that one object has to have
HAND_SET = 0.5  # weight of the term of intensity in the sum


@dataclass(frozen=True)
class FlightPairs:
    """Arrays with an entry a pair of neighbouring cells with a disparity each; as many of one object as of
    two."""

    name: str
    family: str
    intensity: NDArray[np.float64]  # difference, grey levels
    disparity_px: NDArray[np.float64]  # difference
    nearest_px: NDArray[np.float64]  # the larger of the two disparities
    distance_px: NDArray[np.float64]  # between the centres
    same: NDArray[np.int64]  # 1: one object, 0: two


def object_of_cells(label: Labels, cell_of_pixel: Labels, cells: int) -> NDArray[np.int64]:
    """The label that PURE of each cell's pixels have; -1: none has, or there are no pixels."""
    labels = int(label.max(initial=0)) + 1
    keys = cell_of_pixel.astype(np.int64) * labels + label
    counts = np.bincount(keys.ravel(), minlength=cells * labels).reshape(cells, labels)
    most, pixels = counts.argmax(axis=1), counts.sum(axis=1)
    pure = (pixels > 0) & (counts.max(axis=1) >= PURE * pixels)
    return np.where(pure, most, -1)


def collect_cached(folder: Path, values: parameters.Values, cache: Path) -> FlightPairs:
    path = cache / f"{folder.parent.name}-{folder.name}-pairs.json"
    return kept_of_flight(path, folder, values, collect, from_json)


def from_json(content: dict[str, Any]) -> FlightPairs:
    arrays: dict[str, NDArray[Any]] = {
        name: np.array(value, np.int64 if name == "same" else np.float64)
        for name, value in content.items()
        if name not in ("name", "family")
    }
    return FlightPairs(content["name"], content["family"], **arrays)


def collect(folder: Path, values: parameters.Values) -> FlightPairs:
    """Raises InputError."""
    truth = read_truth(folder)
    scenes = [read_scene(folder, k) for k in range(0, len(truth.times_ns), STRIDE)]
    random = np.random.default_rng(0)
    parts = [
        pairs_of(partition, truth.labels(scene.t_ns).astype(np.int32), random)
        for scene, partition in partition_scenes(scenes, values)
    ]
    columns: dict[str, NDArray[Any]] = {
        name: np.concatenate([part[name] for part in parts]) for name in parts[0]
    }
    return FlightPairs(folder.name, truth.family, **columns)


def pairs_of(partition: Partition, label: Labels, random: np.random.Generator) -> dict[str, NDArray[Any]]:
    result, graph = partition.result, partition.graph
    disparity_px = result.cell_disparity_px.astype(np.float64)
    objects = object_of_cells(label, result.cell_of_pixel, len(disparity_px))
    a, b = graph.edges.T
    told = (objects[a] >= 0) & (objects[b] >= 0) & (disparity_px[a] >= 0.0) & (disparity_px[b] >= 0.0)
    same = objects[a] == objects[b]
    pairs = [np.flatnonzero(told & same), np.flatnonzero(told & ~same)]
    fewest = min(PAIRS, *map(len, pairs))
    drawn = np.concatenate([random.choice(some, fewest, replace=False) for some in pairs])
    a, b = a[drawn], b[drawn]
    return {
        "intensity": np.abs(result.cell_intensity[a].astype(np.float64) - result.cell_intensity[b]),
        "disparity_px": np.abs(disparity_px[a] - disparity_px[b]),
        "nearest_px": np.maximum(disparity_px[a], disparity_px[b]),
        "distance_px": graph.edge_distance_px[drawn].astype(np.float64),
        "same": same[drawn].astype(np.int64),
    }


# ---- the ways to weigh two features ----


@dataclass(frozen=True)
class Terms:
    """Exponents of the paper's equation 4, as affinity.h defines them."""

    intensity: Array
    disparity: Array


MOST = 8.0  # of an exponent: beyond it a term is as good as nothing
INTENSITY_STEPS = (1.0, 2.0, 4.0, 6.0, 9.0, 13.0, 18.0, 25.0, 35.0, 50.0)
DISPARITY_STEPS = (0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)


def terms(pairs: FlightPairs, values: parameters.Values) -> Terms:
    of = values["affinity"]
    mu_px = of["mu_disparity_px"] + SLOPE * pairs.distance_px
    return Terms(
        exponent(pairs.intensity, MU_INTENSITY, of["sigma_intensity"]),
        exponent(pairs.disparity_px, mu_px, of["sigma_disparity_px"]),
    )


MU_INTENSITY, SLOPE = 2.0, 0.1  # MU_INTENSITY and MU_DISPARITY_SLOPE of affinity.c


def exponent(difference: Array, mu: Any, sigma: float) -> Array:
    return np.minimum(np.maximum(difference - mu, 0.0) ** 2 / (2.0 * sigma**2), MOST)


def steps(pairs: FlightPairs) -> Array:
    """A column a step: whether a difference is beyond it."""
    of_intensity = pairs.intensity[:, np.newaxis] > np.array(INTENSITY_STEPS)
    of_disparity = pairs.disparity_px[:, np.newaxis] > np.array(DISPARITY_STEPS)
    return np.concatenate([of_intensity, of_disparity], axis=1).astype(np.float64)


WAYS: dict[str, Callable[[FlightPairs, Terms], Array]] = {
    "product, as the detector has it": lambda _, t: np.exp(-t.intensity - t.disparity)[:, np.newaxis],
    "sum with equal weights": lambda _, t: (HAND_SET * (np.exp(-t.intensity) + np.exp(-t.disparity)))[
        :, np.newaxis
    ],
    "sum, weights learned": lambda _, t: np.column_stack([np.exp(-t.intensity), np.exp(-t.disparity)]),
    "product, exponents learned": lambda _, t: np.column_stack([t.intensity, t.disparity]),
    "steps of both features": lambda pairs, _: steps(pairs),
    "intensity alone": lambda _, t: np.exp(-t.intensity)[:, np.newaxis],
    "disparity alone": lambda _, t: np.exp(-t.disparity)[:, np.newaxis],
}


# ---- learning ----


@dataclass(frozen=True)
class WayHeld:
    """One way, on families held back."""

    name: str
    log_loss: float  # mean of the families
    wrong: float  # share of pairs on the wrong side of one half, mean of the families
    weights: list[float]  # the prior, then those of the terms, of all families


@dataclass(frozen=True)
class Affinities:
    ways: list[WayHeld]
    weight_of_intensity: float  # in the sum, of 1
    weight_by_family: dict[str, float]  # the same, learned from the others
    pairs: int
    flights: int
    digest: str  # of what is learned from


def learn(flights: list[FlightPairs], values: parameters.Values) -> Affinities:
    y = np.concatenate([one.same for one in flights])
    group = np.concatenate([np.full(len(one.same), one.family) for one in flights])
    of_flights = [terms(one, values) for one in flights]
    columns = {
        name: np.concatenate([way(one, t) for one, t in zip(flights, of_flights, strict=True)])
        for name, way in WAYS.items()
    }
    ways = []
    for name, x in columns.items():
        held = cross_validate(x, y, group)
        whole = fit(x, y, same_for_each(group))
        ways.append(
            WayHeld(name, float(np.mean([*held.loss.values()])), wrong(held, y, group), whole.tolist())
        )
    sums = columns["sum, weights learned"]
    by_family = {
        one: weight_of_intensity(fit(sums[group != one], y[group != one], same_for_each(group[group != one])))
        for one in np.unique(group).tolist()
    }
    return Affinities(
        ways,
        weight_of_intensity(fit(sums, y, same_for_each(group))),
        by_family,
        len(y),
        len(flights),
        content_sha256(columns["steps of both features"], sums, y, group.tolist()),
    )


def wrong(held: Held, y: NDArray[np.int64], group: NDArray[np.str_]) -> float:
    off = (held.probability >= 0.5) != (y == 1)
    return float(same_for_each(group) @ off / len(np.unique(group)))


def weight_of_intensity(weights: Array) -> float:
    """alpha of the paper, of the fitted prior, intensity and disparity: both weights add up to 1."""
    return float(weights[1] / (weights[1] + weights[2]))
