"""Smoothing and pyramid: numpy against the definition, C on every instruction set and OpenCV against it."""

from __future__ import annotations

from itertools import product

import cv2
import numpy as np
import pytest
from vista_model import INVALID, Parameters, compute, compute_levels, pyramid, reduce, smooth
from vista_model.c_engine import CEngine, isas, library, prepare_reduce, prepare_smooth, reduced_shape

_SMALL = [(height, width) for height in range(1, 24) for width in range(1, 24)]
_VECTOR_EDGES = [(5, width) for width in (*range(24, 140), *range(1021, 1028), *range(2043, 2056), 4099)]
_LIMIT = 16384


def _c_smooth(image, isa):
    out = np.full(image.shape, 0xA5, np.uint8)
    prepare_smooth(image, out, isa)()
    return out


def _c_reduce(image, isa):
    out = np.full(reduced_shape(image.shape), 0xA5, np.uint8)
    prepare_reduce(image, out, isa)()
    return out


def _assert_all_agree(image):
    """Numpy, OpenCV and C on every instruction set; the number of pixels compared."""
    smoothed, reduced = smooth(image), reduce(image)
    np.testing.assert_array_equal(smoothed, cv2.GaussianBlur(image, (3, 3), 0), f"numpy smooth {image.shape}")
    np.testing.assert_array_equal(reduced, cv2.pyrDown(image), f"numpy reduce {image.shape}")
    for isa in isas():
        np.testing.assert_array_equal(_c_smooth(image, isa), smoothed, f"{isa} smooth {image.shape}")
        np.testing.assert_array_equal(_c_reduce(image, isa), reduced, f"{isa} reduce {image.shape}")
    return smoothed.size + reduced.size


def _random_image(rng, shape):
    """Noise, or extremes only: sums at both ends of their range."""
    if rng.integers(3) == 0:
        return (rng.integers(0, 2, shape) * 255).astype(np.uint8)
    return rng.integers(0, 256, shape, dtype=np.uint8)


def _mirror(i, size):
    """The contract's border, step by step: reflected at the edges until it is inside."""
    while size > 1 and not 0 <= i < size:
        i = -i if i < 0 else 2 * (size - 1) - i
    return i if size > 1 else 0


def _weighted(image, y, x, weights):
    height, width = image.shape
    reach = range(-(len(weights) // 2), len(weights) // 2 + 1)
    return sum(
        weights[j] * weights[i] * int(image[_mirror(y + j, height), _mirror(x + i, width)])
        for j, i in product(reach, reach)
    )


@pytest.mark.parametrize(
    "shape", [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (1, 4), (3, 3), (4, 3), (7, 8), (9, 6)]
)
def test_definition_pixel_by_pixel(rng, shape):
    image = _random_image(rng, shape)
    smoothed, reduced = smooth(image), reduce(image)
    assert reduced.shape == ((shape[0] + 1) // 2, (shape[1] + 1) // 2)
    for y, x in np.ndindex(smoothed.shape):
        assert smoothed[y, x] == (_weighted(image, y, x, {-1: 1, 0: 2, 1: 1}) + 8) // 16
    for y, x in np.ndindex(reduced.shape):
        wanted = (_weighted(image, 2 * y, 2 * x, {-2: 1, -1: 4, 0: 6, 1: 4, 2: 1}) + 128) // 256
        assert reduced[y, x] == wanted


def test_every_small_size(rng):
    for shape in _SMALL:
        _assert_all_agree(_random_image(rng, shape))


def test_every_remainder_of_a_vector_and_of_a_chunk(rng):
    for shape in _VECTOR_EDGES:
        _assert_all_agree(_random_image(rng, shape))


@pytest.mark.parametrize("shape", [(1, _LIMIT), (_LIMIT, 1), (2, _LIMIT - 1)])
def test_largest_sides(rng, shape):
    _assert_all_agree(_random_image(rng, shape))


def test_random_sizes(rng):
    pixels = 0
    while pixels < 3_000_000:
        pixels += _assert_all_agree(
            _random_image(rng, (int(rng.integers(1, 400)), int(rng.integers(1, 700))))
        )


def test_real_images(real_pairs):
    for pair in real_pairs[::3]:
        for image in pair:
            for level in pyramid(image, 4):
                _assert_all_agree(level)


@pytest.mark.parametrize("value", [0, 1, 127, 254, 255])
def test_flat_stays_flat(value):
    for shape in ((1, 1), (2, 3), (40, 77)):
        image = np.full(shape, value, np.uint8)
        assert (smooth(image) == value).all() and (reduce(image) == value).all()
        _assert_all_agree(image)


@pytest.mark.parametrize("isa", isas())
def test_strided_images_and_nothing_written_beside_the_output(rng, isa):
    inside = np.s_[5:38, 7:100]
    around = rng.integers(0, 256, (50, 130), dtype=np.uint8)
    image = around[inside]
    for prepare, wanted in ((prepare_smooth, smooth(image)), (prepare_reduce, reduce(image))):
        canvas = np.full((60, 140), 0x5A, np.uint8)
        height, width = wanted.shape
        out = canvas[3 : 3 + height, 9 : 9 + width]
        prepare(image, out, isa)()
        np.testing.assert_array_equal(out, wanted)
        out[:] = 0x5A
        assert (canvas == 0x5A).all()


def _call(name, **change):
    """The status of a call on a 20x10 image with one thing changed; the output must stay as it was."""
    ffi, lib = library()
    pixels = np.zeros((10, 20), np.uint8)
    out = np.full((10, 20), 77, np.uint8)
    data = change.get("pixels", ffi.cast("uint8_t *", pixels.ctypes.data))
    size = change.get("width", 20), change.get("height", 10)
    image = ffi.new("vista_frontend_image *", (data, *size, change.get("stride", 20)))
    target = change.get("out", ffi.cast("uint8_t *", out.ctypes.data))
    if "shift" in change:
        target = data + change["shift"]
    status = getattr(lib, name)(
        change.get("image", image), target, change.get("out_stride", 20), change.get("isa", 0)
    )
    assert (out == 77).all() and (pixels == 0).all()
    return ffi.string(lib.vista_engine_status_name(status)).decode()


@pytest.mark.parametrize("name", ["vista_frontend_smooth", "vista_frontend_reduce"])
@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"image": None}, "ARGUMENT"),
        ({"pixels": None}, "ARGUMENT"),
        ({"out": None}, "ARGUMENT"),
        ({"width": 0}, "SIZE"),
        ({"width": -(2**31)}, "SIZE"),
        ({"height": _LIMIT + 1}, "SIZE"),
        ({"stride": 19}, "STRIDE"),
        ({"stride": -20}, "STRIDE"),
        ({"out_stride": 9}, "STRIDE"),
        ({"isa": 4}, "ISA"),
        ({"isa": 2**32 - 1}, "ISA"),
        ({"shift": 0}, "OVERLAP"),
        ({"shift": 199}, "OVERLAP"),
        ({"shift": -80}, "OVERLAP"),
    ],
)
def test_bad_call_writes_nothing(name, change, status):
    null = {key: library()[0].NULL for key, value in change.items() if value is None}
    assert _call(name, **change | null) == f"VISTA_ENGINE_ERROR_{status}"


def test_levels_are_those_of_the_images_one_by_one(rng, random_pair):
    """The words of a level are what the engine gives for its images; texture is of the smoothed image."""
    left, right = random_pair(90, 150)
    parameters = Parameters(16, 5, texture_threshold=300)
    for smoothed in (False, True):
        words = compute_levels(left, right, parameters, 4, smoothed)
        assert [level.shape for level in words] == [(90, 150), (45, 75), (23, 38), (12, 19)]
        for k, level in enumerate(words):
            images = [pyramid(image, 4)[k] for image in (left, right)]
            images = [cv2.GaussianBlur(image, (3, 3), 0) if smoothed else image for image in images]
            np.testing.assert_array_equal(level, compute(*images, parameters))
            np.testing.assert_array_equal(level, CEngine(parameters).compute(*images)[0])


def test_one_level_without_smoothing_is_version_one(random_pair):
    left, right = random_pair(40, 90)
    (words,) = compute_levels(left, right, Parameters(32, 7))
    np.testing.assert_array_equal(words, compute(left, right, Parameters(32, 7)))


def test_a_level_too_small_to_be_matched_is_all_invalid(rng):
    """W < D + B - 1 or H < B: 20 px or 5 rows are the least here."""
    parameters = Parameters(16, 5, texture_threshold=0, uniqueness_ratio=0, lr_max_diff=None)
    for height, width, matched in ((9, 39, True), (8, 39, False), (9, 38, False), (1, 1, False)):
        pair = rng.integers(0, 256, (2, height, width), dtype=np.uint8)
        words = compute_levels(*pair, parameters, levels=2)[1]
        assert words.shape == ((height + 1) // 2, (width + 1) // 2)
        assert (words != INVALID).sum() == matched
