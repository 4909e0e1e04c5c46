"""The words of several levels put together, against a plain reference, and what is refused."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from stage_library import Arena, camera, ffi, frame_view, image_struct, lib, parameters, status_name, view
from vista.engine import INVALID, SCALE

Words = np.ndarray

SIZES = [(1, 1), (1, 7), (2, 2), (3, 5), (7, 1), (8, 9), (17, 16), (23, 64), (30, 41), (64, 37)]
COARSER = 3
BASELINE_M = 0.4572


class Stage:
    def __init__(self, height: int, width: int, changes: dict[str, float] | None = None) -> None:
        self.shape, self._parameters = (height, width), parameters(changes)
        self.handle = w = ffi.new("vista_words *")
        self.arena = Arena(lambda arena: lib.vista_words_layout(w, arena, width, height))
        assert self.arena.status == lib.VISTA_OK

    def combine(self, levels: list[Words], num_disparities: int = 64) -> None:
        assert self.count(levels) == ("VISTA_OK", len(levels))
        self._parameters.stereo.num_disparities = num_disparities
        lens = camera(self.shape[1], self.shape[0], baseline=BASELINE_M)
        lib.vista_words_combine(frame_view(self._parameters, lens, levels=levels), self.handle)

    def count(self, levels: list[Words], missing: int | None = None) -> tuple[str, int]:
        """What the pipeline first asks of the levels of a frame, and their number; one may be missing."""
        images = [image_struct("disparity_image", words) for words in levels]
        coarser = ffi.new("vista_disparity_image[]", COARSER)
        for k, image in enumerate(images[1:]):
            coarser[k] = image[0]
        if missing is not None:
            (images[0][0] if missing == 0 else coarser[missing - 1]).data = ffi.NULL
        count = ffi.new("int32_t *")
        status = lib.vista_words_count_levels(self.handle, images[0], coarser, count)
        return status_name(status), count[0]

    @property
    def words(self) -> Words:
        return view(self.handle.levels[0], self.shape[0] * self.shape[1], np.int16).reshape(self.shape)


# ---- the reference ----


def spread(row: Words) -> Words:
    """Spreads words by a pixel into their gaps, from the left before from the right."""
    left, right = np.append(INVALID, row[:-1]), np.append(row[1:], INVALID)
    return np.where(row >= 0, row, np.where(left >= 0, left, right))


GAP_PX, SUPPORT, APART_PX = 3, 0.92, 2.0  # of words.c


class Smallest(NamedTuple):
    """What a cluster has to cover: pixels anywhere; square metres, and pixels of what covers these, from a
    disparity on."""

    px: int
    area_m2: float
    far_px: int
    far_disparity_px: float

    def at(self, word: int) -> float:
        """Pixels, of a cluster with this word."""
        if word < self.far_disparity_px * SCALE:
            return self.px
        px = self.area_m2 * (word / SCALE / BASELINE_M) ** 2
        return min(self.px, max(px, self.far_px))


def nearest_in_first_run(words: Words, v: int, u: int) -> int:
    """The largest of the words that hang together in the row, from (v, u) on."""
    row = words[v, u:].astype(int)
    ends = np.nonzero((row < 0) | (np.abs(np.diff(row, prepend=row[0])) > SCALE))[0]
    return int(row[: ends[0] if len(ends) else len(row)].max())


def without_small_clusters(words: Words, smallest: Smallest) -> Words:
    kept = words.copy()
    for _ in range(GAP_PX):
        words = np.array([spread(row) for row in words])
    seen = words < 0
    for start in zip(*np.nonzero(~seen), strict=True):
        if seen[start]:
            continue
        cluster, seen[start] = [start], True
        for v, u in cluster:  # grows while it is walked
            for y, x in ((v - 1, u), (v + 1, u), (v, u - 1), (v, u + 1)):
                inside = 0 <= y < words.shape[0] and 0 <= x < words.shape[1]
                if inside and not seen[y, x] and abs(int(words[y, x]) - int(words[v, u])) <= SCALE:
                    seen[y, x] = True
                    cluster.append((y, x))
        if len(cluster) < smallest.at(nearest_in_first_run(words, *start)):
            kept[tuple(np.transpose(cluster))] = INVALID
    return kept


def with_support(words: Words, share: float) -> Words:
    wide = np.pad(words.astype(int), 2, constant_values=INVALID)
    windows = np.lib.stride_tricks.sliding_window_view(wide, (5, 5))
    return np.where((windows >= 0).sum(axis=(2, 3)) >= share * 25 - 1e-6, words, INVALID)


def combined(levels: list[Words], candidates: int, cluster: Smallest, filling: int) -> Words:
    result: Words | None = None
    for k in reversed(range(len(levels))):
        words = levels[k].astype(int)
        words[(words < 0) | (words > 32767 >> k)] = INVALID
        words = without_small_clusters(words, cluster)
        if k > 0:
            words = with_support(words, SUPPORT)
        if result is not None:
            if k >= filling:
                result = np.where(result * 2 ** (k + 1) > (candidates - 1) * SCALE, result, INVALID)
            rows, columns = (
                np.minimum((np.arange(fine) + 1) // 2, coarse - 1)
                for fine, coarse in zip(words.shape, result.shape, strict=True)
            )
            other = result[np.ix_(rows, columns)]
            other = np.where(other >= 0, 2 * other, INVALID)
            contradicted = (other >= 0) & (np.abs(words - other) > 2 * APART_PX * SCALE)
            words = np.where((words < 0) | contradicted, other, words)
        result = words
    assert result is not None
    return np.where(result < 0, INVALID, result).astype(np.int16)


def shapes_of(height: int, width: int, levels: int) -> list[tuple[int, int]]:
    shapes = [(height, width)]
    for _ in range(levels - 1):
        shapes.append(((shapes[-1][0] + 1) // 2, (shapes[-1][1] + 1) // 2))
    return shapes


def patchy(random: np.random.Generator, shape: tuple[int, int], level: int) -> Words:
    """Surfaces with holes and chance matches, of which some no engine writes."""
    height, width = shape
    words = np.full(shape, random.integers(0, 1000) >> level)
    for _ in range(random.integers(0, 6)):
        v, u = random.integers(0, height), random.integers(0, width)
        size = random.integers(1, max(2, max(shape) // 2), 2)
        words[v : v + size[0], u : u + size[1]] = random.integers(0, 63 * SCALE)
    words = words + random.integers(-12, 13, shape)
    words[random.random(shape) < random.choice([0.0, 0.1, 0.5, 0.9])] = INVALID
    noise = random.random(shape) < random.choice([0.0, 0.05, 0.3])
    words[noise] = random.integers(-32768, 32768, int(noise.sum()))
    return words.astype(np.int16)


@pytest.mark.parametrize("levels", [1, 2, 3, 4])
@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[1]}x{size[0]}")
def test_the_stage_is_the_reference(size: tuple[int, int], levels: int) -> None:
    seed = int(np.random.SeedSequence().generate_state(1)[0])
    print("seed", seed)
    random = np.random.default_rng(seed)
    for _ in range(6):
        cluster = Smallest(
            px=int(random.choice([0, 1, 5, 30, 150, 500])), area_m2=0.2, far_px=40, far_disparity_px=3.0
        )
        candidates, filling = int(random.choice([16, 64, 256])), int(random.integers(0, 4))
        stage = Stage(*size, {"words.cluster_px": cluster.px, "words.filling_levels": filling})
        for _ in range(3):  # nothing of a frame is left in the next
            words = [patchy(random, shape, k) for k, shape in enumerate(shapes_of(*size, levels))]
            before = [level.copy() for level in words]
            stage.combine(words, candidates)
            wanted = combined(words, candidates, cluster, filling)
            np.testing.assert_array_equal(stage.words, wanted)
            for level, untouched in zip(words, before, strict=True):
                np.testing.assert_array_equal(level, untouched)


def test_one_level_stays_as_it_is_without_the_cluster_filter() -> None:
    words = np.random.default_rng(3).integers(0, 5000, (21, 34)).astype(np.int16)
    words[::3, ::2] = INVALID
    stage = Stage(21, 34, {"words.cluster_px": 0})
    stage.combine([words])
    np.testing.assert_array_equal(stage.words, words)


@pytest.mark.parametrize("stride", [40, -40])
def test_rows_may_lie_apart_and_run_upwards(stride: int) -> None:
    random = np.random.default_rng(4)
    wide = np.full((20, 40), 999, np.int16)
    words = wide[:, :33] if stride > 0 else wide[::-1, :33]
    words[:] = patchy(random, (20, 33), 0)
    stage = Stage(20, 33)
    stage.combine([words])
    apart = stage.words.copy()
    stage.combine([np.ascontiguousarray(words)])
    np.testing.assert_array_equal(stage.words, apart)


def test_a_near_thing_comes_from_a_coarser_level_and_its_chance_matches_go() -> None:
    """A wall of 10 px all over; in front of it, too near for level 0, a thing of 100 px, which level 0
    matches to something else and level 1 to itself. Where level 1 fills surfaces, it contradicts the rim,
    too."""
    level_0 = np.full((96, 160), 10 * SCALE, np.int16)
    level_0[30:70, 60:120] = 40 * SCALE
    level_1 = np.full((48, 80), 5 * SCALE, np.int16)
    level_1[15:35, 30:60] = 50 * SCALE
    stage = Stage(96, 160, {"words.filling_levels": 1})
    stage.combine([level_0, level_1])
    assert (stage.words[36:64, 66:114] == 100 * SCALE).all()
    assert (stage.words[:25] == 10 * SCALE).all()
    assert set(np.unique(stage.words)) == {10 * SCALE, 100 * SCALE}


@pytest.mark.parametrize(("range_m", "kept"), [(30.0, False), (60.0, True), (120.0, True), (200.0, False)])
def test_what_is_far_may_be_small(range_m: float, kept: bool) -> None:
    """A focal length of 1000 px makes 64 px 0.06 m2 at 30 m, and more than 0.2 m2 at 60 m. The disparity at
    200 m is so small that chance matches have it."""
    word = round(1000.0 * BASELINE_M / range_m * SCALE)
    words = np.full((96, 160), INVALID, np.int16)
    words[40:48, 60:68] = word  # 64 px
    stage = Stage(96, 160)
    stage.combine([words])
    assert (stage.words[40:48, 60:68] == (word if kept else INVALID)).all()


def test_levels_that_fill_nothing_add_only_what_is_too_near_for_level_0() -> None:
    nothing = [np.full(shape, INVALID, np.int16) for shape in shapes_of(96, 160, 3)]
    for disparity_px, expected_px in ((15, None), (16, 64), (60, 240)):
        words = [level.copy() for level in nothing]
        words[2][:] = disparity_px * SCALE
        stage = Stage(96, 160)
        stage.combine(words)
        wanted = INVALID if expected_px is None else expected_px * SCALE
        assert (stage.words[16:80, 16:144] == wanted).all()


# ---- what is refused ----


def levels_of(height: int, width: int, count: int) -> list[Words]:
    return [np.full(shape, SCALE, np.int16) for shape in shapes_of(height, width, count)]


@pytest.mark.parametrize("level", [0, 1, 2, 3])
@pytest.mark.parametrize("change", [(1, 0), (0, 1), (-1, 0), (0, -1)])
def test_a_level_of_another_size_is_refused(level: int, change: tuple[int, int]) -> None:
    words = levels_of(33, 50, 4)
    height, width = words[level].shape
    words[level] = np.full((height + change[0], width + change[1]), SCALE, np.int16)
    assert Stage(33, 50).count(words)[0] == "VISTA_ERROR_SIZE"


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_a_level_that_is_missing_before_another_is_refused(missing: int) -> None:
    words = levels_of(33, 50, 4)
    assert Stage(33, 50).count(words, missing)[0] == "VISTA_ERROR_ARGUMENT"
    if missing > 0:  # with all that follow it is no longer missing
        assert Stage(33, 50).count(words[:missing]) == ("VISTA_OK", missing)
