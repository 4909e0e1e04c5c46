"""Stereo alone with the host's tracker behind it: no segmentation, but M of N and the static-world test.

The clusters of `stereo_alone` at each threshold, of the words in the collision volume along the path that
the host itself expects, go through the host's own reconstruction, tracker and obstacle map as if they were
regions. What these warn of is judged as the detector's warnings are.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista import native, parameters
from vista.chain import engine_parameters
from vista.engine import INVALID, SCALE, Disparity, StereoEngine
from vista.rectify import Rectifier
from vista.sequence import Frame

from vista_eval.baselines.cluster_tracker import ClusterTracker, HostMotion, Moved, Stages, as_regions
from vista_eval.baselines.stereo_alone import (
    PIXELS,
    Threshold,
    label_clusters,
    thresholded,
)
from vista_eval.cache import code_digest, digest_of, kept
from vista_eval.dataset.truth import TRUTH
from vista_eval.fly import flight_digest, open_flight
from vista_eval.metrics.flight_path import CYLINDER_RADIUS_M
from vista_eval.metrics.flight_score import blind_depth_m
from vista_eval.metrics.frame_truth import flight_frames, still_surfaces
from vista_eval.metrics.judge import FrameScore, Judge, Shown
from vista_eval.metrics.rules import STRICT


@dataclass(frozen=True)
class TrackedOutcome:
    """The outcome of one flight at one threshold; all in frames."""

    threshold: Threshold
    asked: int
    hits: int
    missed: int
    alarmed: int


@dataclass(frozen=True)
class Sweep:
    """The thresholds of `stereo_alone` that are tried, with the uniqueness of its best one, without what
    never decides."""

    textures: tuple[int, ...] = (0, 100, 300, 1000, 2000)
    uniquenesses: tuple[int, ...] = (5, 15, 20, 30)
    sads: tuple[float, ...] = (62.0, 6.0)
    pixels: tuple[int, ...] = PIXELS


FULL = Sweep()


def tracked_cached(
    folder: Path, values: parameters.Values, cache: Path, sweep: Sweep = FULL
) -> list[TrackedOutcome]:
    """One for each threshold, in the same order for every flight."""
    digest = digest_of(
        json.dumps([asdict(sweep), asdict(STRICT)], sort_keys=True),
        flight_digest(folder, values),
        code_digest(__name__),
        native.library_path("vista_stages"),
        folder / TRUTH,
    )
    return kept(
        cache,
        digest,
        lambda: tracked_outcomes(folder, values, sweep),
        lambda outcomes: [
            TrackedOutcome(**one | {"threshold": Threshold(**one["threshold"])}) for one in outcomes
        ],
    )


def tracked_outcomes(folder: Path, values: parameters.Values, sweep: Sweep = FULL) -> list[TrackedOutcome]:
    values = one_level(values)
    truth, frames = flight_frames(folder, STRICT)
    still_m = still_surfaces(truth, frames, STRICT)
    sequence = open_flight(folder)
    stages = Stages(Rectifier(sequence.calibration).calibration, values)
    motion = HostMotion(stages)
    words_of = ThresholdedWords(values, sweep)
    settings = list(product(range(len(words_of.settings)), sweep.pixels))
    trackers = [ClusterTracker(stages) for _ in settings]
    blind_m, shown = blind_depth_m(truth, values), Shown(truth)
    judges = [Judge(truth, blind_m, still_m, STRICT, shown) for _ in settings]
    scores: list[list[FrameScore]] = [[] for _ in settings]
    by_time = {frame.t_ns: frame for frame in frames}
    for files in sequence.frames:
        frame, pair = by_time[files.t_ns], sequence.read(files)
        moved = motion.update(files.t_ns, files.world_from_camera)
        world_from_estimate = frame.world_from_camera @ moved.pose.inverse()
        found = list(words_of.clusters(stages, moved, pair))
        for k, (setting, least) in enumerate(settings):
            words, regions, pixels = found[setting]
            told = trackers[k].update(moved, words, regions, sum(size >= least for size in pixels))
            scores[k].append(judges[k].frame(frame, told.obstacles, told.nearest, world_from_estimate))
    return [
        outcome(Threshold(*words_of.settings[setting], least), score)
        for (setting, least), score in zip(settings, scores, strict=True)
    ]


def one_level(values: parameters.Values) -> parameters.Values:
    return values | {"stereo": values["stereo"] | {"levels": 1}}


def outcome(threshold: Threshold, frames: list[FrameScore]) -> TrackedOutcome:
    return TrackedOutcome(
        threshold,
        asked=sum(frame.in_band for frame in frames),
        hits=sum(frame.hit for frame in frames),
        missed=sum(frame.missed for frame in frames),
        alarmed=sum(bool(frame.false_alarms) for frame in frames),
    )


class ThresholdedWords:
    """The words of a pair at each texture, uniqueness and SAD, and their clusters in the collision volume."""

    def __init__(self, values: parameters.Values, sweep: Sweep) -> None:
        stereo = engine_parameters(values)
        self._sweep = sweep
        self._area = stereo.block_size**2
        self._engines = [
            StereoEngine(**asdict(thresholded(stereo, texture, uniqueness)))
            for texture, uniqueness in product(sweep.textures, sweep.uniquenesses)
        ]
        self.settings = list(product(sweep.textures, sweep.uniquenesses, sweep.sads))

    def clusters(
        self, stages: Stages, moved: Moved, pair: Frame
    ) -> Iterator[tuple[Disparity, Any, list[int]]]:
        """Yields for each setting its words, their clusters as regions, and the pixels of each cluster."""
        inside = InVolume(stages, moved)
        for engine in self._engines:
            words, smin = engine.compute_with_smin(pair.left, pair.right)
            here = inside.mask(words)
            rows, columns = (np.flatnonzero(here.any(axis=axis)) for axis in (1, 0))
            window = np.s_[0:1, 0:1]
            if len(rows):
                window = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
            corner_px = (window[1].start, window[0].start)
            for sad in self._sweep.sads:
                good = smin <= sad * self._area
                shown = np.where(here[window] & good[window], words[window], np.int16(INVALID))
                label = label_clusters(shown, min(self._sweep.pixels))
                kept = np.where(good, words, np.int16(INVALID))
                yield kept, *as_regions(stages, shown, label, corner_px)


class InVolume:
    """Which words of a frame lie in the collision volume. Thresholds drop words but change none, so what was
    found for one set of words holds for the next."""

    def __init__(self, stages: Stages, moved: Moved) -> None:
        self._camera, self._moved = stages.camera, moved
        self._known = np.zeros((stages.camera.height_px, stages.camera.width_px), np.int16)
        self._inside = np.zeros(self._known.shape, bool)

    def mask(self, words: Disparity) -> NDArray[np.bool_]:
        v, u = np.nonzero((words > 0) & (words != self._known))
        camera, path = self._camera, self._moved.path
        depth_m = (camera.focal_px * camera.baseline_m * SCALE / words[v, u]).astype(np.float32)
        x = ((u - camera.center_u_px) / camera.focal_px).astype(np.float32)
        y = ((v - camera.center_v_px) / camera.focal_px).astype(np.float32)
        aside_m, along_m = path.measure(self._moved.pose, x, y, depth_m)
        self._inside[v, u] = (aside_m <= CYLINDER_RADIUS_M) & (along_m > 0.0) & (along_m <= path.length_m)
        self._known[v, u] = words[v, u]
        return self._inside & (words > 0)
