"""The baseline without segmentation and tracking: disparities are thresholded and clustered.

A frame warns if at least `pixels` adjoining pixels, whose disparities step by at most one px from neighbour
to neighbour, lie in the collision cylinder. Matches are thresholded as stereo engines do it (the paper's
figure 2): by texture, by uniqueness, and by the mean absolute difference of the block (SAD). Its warnings are
judged as ours are.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import native, parameters
from vista.chain import engine_parameters
from vista.engine import SCALE, EngineParameters, StereoEngine
from vista.geometry import Array, Pose
from vista.sequence import open_sequence

from vista_eval.cache import code_digest, digest_of, flight_files, kept
from vista_eval.dataset.truth import TRUTH, FlightTruth
from vista_eval.metrics.flight_path import CYLINDER_LENGTH_M, CYLINDER_RADIUS_M, flight_direction
from vista_eval.metrics.frame_truth import FrameTruth, flight_frames, still_surfaces
from vista_eval.metrics.judge import Seen, Warned, agrees, seen_from
from vista_eval.metrics.rules import HIT_RANGE_M, PAPER

TEXTURES = (0, 10, 100, 300, 1000, 2000)
UNIQUENESSES = (0, 5, 15, 30, 50)  # percent
SADS = (62.0, 6.0, 3.0)  # mean grey levels a pixel of the block; 62 is the most there can be
PIXELS = (10, 20, 40, 80, 160, 320)
STEP_PX = 1.0  # of disparity within a cluster


@dataclass(frozen=True)
class Threshold:
    texture: int
    uniqueness: int
    sad: float
    pixels: int


@dataclass(frozen=True)
class Cluster:
    pixels: int
    place: Warned


@dataclass(frozen=True)
class Outcome:
    """The outcome of one flight at one texture, uniqueness and SAD; clusters of any size decide about every
    `pixels`."""

    texture: int
    uniqueness: int
    sad: float
    # Size of the largest cluster that agrees with the target, of each frame with that nearer than 45 m.
    seen_px: tuple[int, ...]
    false_px: tuple[int, ...]  # of each frame: size of the largest cluster that is a false alarm


def misses_and_alarms(outcomes: list[Outcome], pixels: int) -> tuple[int, int]:
    """Frames of one or more flights at one threshold: missed, and with a false alarm."""
    missed = sum(size < pixels for outcome in outcomes for size in outcome.seen_px)
    alarmed = sum(size >= pixels for outcome in outcomes for size in outcome.false_px)
    return missed, alarmed


def sweep(flights: list[list[Outcome]]) -> dict[Threshold, tuple[int, int]]:
    """(missed frames, frames with a false alarm) over all flights, at each threshold."""
    return {
        Threshold(group[0].texture, group[0].uniqueness, group[0].sad, pixels): misses_and_alarms(
            list(group), pixels
        )
        for group in zip(*flights, strict=True)
        for pixels in PIXELS
    }


def outcomes_cached(folder: Path, values: parameters.Values, cache: Path) -> list[Outcome]:
    """One for each texture, uniqueness and SAD, in the same order for every flight."""
    digest = digest_of(
        json.dumps(values["stereo"], sort_keys=True),
        code_digest(__name__),
        native.library_path("vista_engine"),
        *flight_files(folder),
        folder / TRUTH,
    )
    return kept(
        cache,
        digest,
        lambda: flight_outcomes(folder, values),
        lambda outcomes: [_outcome(one) for one in outcomes],
    )


def _outcome(content: dict[str, Any]) -> Outcome:
    sizes = {name: tuple(content[name]) for name in ("seen_px", "false_px")}
    return Outcome(**content | sizes)


def flight_outcomes(folder: Path, values: parameters.Values) -> list[Outcome]:
    truth, frames = flight_frames(folder)
    direction = flight_direction([frame.world_from_camera for frame in frames])
    sequence = open_sequence(folder)
    files = {f.t_ns: f for f in sequence.frames}
    engines = [
        StereoEngine(**asdict(thresholded(engine_parameters(values), texture, uniqueness)))
        for texture, uniqueness in product(TEXTURES, UNIQUENESSES)
    ]
    area = values["stereo"]["block_size"] ** 2
    seen: list[list[int]] = [[] for _ in product(engines, SADS)]
    false: list[list[int]] = [[] for _ in product(engines, SADS)]
    still_m = still_surfaces(truth, frames)
    for frame in frames:
        still = seen_from(truth, frame.world_from_camera, still_m)
        pair = sequence.read(files[frame.t_ns])
        least = least_word(truth, frame.world_from_camera, direction, pair.left.shape)
        near = frame.target is not None and frame.target.range_m < HIT_RANGE_M[1]
        for k, engine in enumerate(engines):
            words, smin = engine.compute_with_smin(pair.left, pair.right)
            for j, sad in enumerate(SADS):
                inside = (words >= least) & (smin <= sad * area)
                found = clusters(truth, np.where(inside, words, np.int16(-1)), min(PIXELS))
                agreeing, alarming = judge_clusters(truth, frame, still, found)
                if near:
                    seen[k * len(SADS) + j].append(agreeing)
                false[k * len(SADS) + j].append(alarming)
    settings = product(TEXTURES, UNIQUENESSES, SADS)
    return [
        Outcome(*setting, tuple(a), tuple(b)) for setting, a, b in zip(settings, seen, false, strict=True)
    ]


def thresholded(engine: EngineParameters, texture: int, uniqueness: int) -> EngineParameters:
    return replace(engine, texture_threshold=texture, uniqueness_ratio=uniqueness)


def least_word(
    truth: FlightTruth, world_from_camera: Pose, direction: Array, shape: tuple[int, int]
) -> NDArray[np.int16]:
    """The smallest disparity word of each pixel whose point lies in the cylinder: with a ray r of depth 1 and
    the direction e, Z |r - (r.e) e| <= radius and Z (r.e) <= length; the disparity is f B / Z."""
    v, u = np.mgrid[: shape[0], : shape[1]]
    cu, cv = truth.center_px
    rays = np.stack([(u - cu) / truth.focal_px, (v - cv) / truth.focal_px, np.ones(shape)], axis=-1)
    along = rays @ (world_from_camera.rotation.T @ direction)
    aside = np.sqrt(np.maximum(np.einsum("ijk,ijk->ij", rays, rays) - along**2, 0.0))
    per_px = np.maximum(aside / CYLINDER_RADIUS_M, along / CYLINDER_LENGTH_M)  # 1 / largest depth
    words = np.ceil(SCALE * truth.focal_baseline_px_m * per_px)
    return np.where(along > 0.0, np.clip(words, 1, 32767), 32767).astype(np.int16)


def clusters(truth: FlightTruth, words: NDArray[np.int16], least_pixels: int) -> list[Cluster]:
    """Largest first; words: of the pixels in the cylinder, negative elsewhere."""
    label = label_clusters(words, least_pixels)
    v, u = np.nonzero(label >= 0)
    label = label[v, u]
    grouped = np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label))[:-1])
    return [_cluster(truth, words, v[members], u[members]) for members in grouped if len(members)]


def label_clusters(words: NDArray[np.int16], least_pixels: int) -> NDArray[np.int32]:
    """Cluster of each pixel, the largest 0, and -1: in none of least_pixels, or without a word.

    Pixels and the links between them are the pixels of an image of twice the size: its connected components
    are the clusters."""
    label = np.full(words.shape, -1, np.int32)
    inside = words >= 0
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if not len(rows):
        return label
    window = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    words = words[window].astype(np.int32)
    linked = np.zeros((2 * words.shape[0] - 1, 2 * words.shape[1] - 1), np.uint8)
    linked[::2, ::2] = words >= 0
    for ours, a, b in (
        (linked[::2, 1::2], words[:, 1:], words[:, :-1]),
        (linked[1::2, ::2], words[1:], words[:-1]),
    ):
        ours[:] = (a >= 0) & (b >= 0) & (np.abs(a - b) <= STEP_PX * SCALE)
    count, component = cv2.connectedComponents(linked, connectivity=4)
    component = component[::2, ::2]  # 0: no word
    sizes = np.bincount(component.ravel(), minlength=count)
    sizes[0] = 0
    order = np.argsort(-sizes, kind="stable")[: int(np.sum(sizes >= max(least_pixels, 1)))]
    number = np.full(count, -1, np.int32)
    number[order] = np.arange(len(order))
    label[window] = number[component]
    return label


def _cluster(
    truth: FlightTruth,
    words: NDArray[np.int16],
    v: NDArray[np.int64],
    u: NDArray[np.int64],
) -> Cluster:
    depth_m = truth.focal_baseline_px_m * SCALE / float(np.median(words[v, u]))
    (u0, u1), (v0, v1) = ((int(x.min()), int(x.max())) for x in (u, v))
    center_u, center_v = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    x, y = ((c - c0) / truth.focal_px for c, c0 in zip((center_u, center_v), truth.center_px, strict=True))
    range_m = depth_m * float(np.sqrt(1.0 + x * x + y * y))
    return Cluster(len(u), Warned(0, center_u, center_v, 0.5 * (u1 - u0), 0.5 * (v1 - v0), range_m))


def judge_clusters(
    truth: FlightTruth, frame: FrameTruth, still: Seen, found: list[Cluster]
) -> tuple[int, int]:
    """Sizes of the largest cluster that agrees with the target, and of the largest that is a false alarm.
    still: what stands still around the path, whatever frame shows it."""
    agreeing = next((c.pixels for c in found if agrees(truth, PAPER, c.place, frame.of_target)), 0)
    real = (frame.around_path, still)
    suspects = (c for c in found if not any(agrees(truth, PAPER, c.place, points) for points in real))
    return agreeing, next((c.pixels for c in suspects), 0)
