"""The C engine, on every instruction set, against the numpy reference and against OpenCV's StereoBM."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import pytest
from vista_model import INVALID, NO_COST, Parameters, compute_all
from vista_model.c_engine import CEngine, aligned_bytes, c_params, isas, library

pytestmark = pytest.mark.native

_VECTOR_EDGES = [1, 15, 16, 17, 31, 32, 33, 47, 63, 64, 65]


def _assert_as_reference(left, right, parameters):
    wanted = compute_all(left, right, parameters)
    for isa in isas():
        found = CEngine(parameters, isa).compute_all(left, right)
        for name, of_reference, of_c in zip(wanted._fields, wanted, found, strict=True):
            np.testing.assert_array_equal(of_c, of_reference, f"{name} {isa} {parameters} {left.shape}")
        for with_confidence, without in zip(
            found, CEngine(parameters, isa).compute(left, right), strict=False
        ):
            np.testing.assert_array_equal(without, with_confidence, f"{isa} without confidence")


def _opencv(left, right, parameters):
    matcher = cv2.StereoBM.create(parameters.num_disparities, parameters.block_size)
    matcher.setMinDisparity(0)
    matcher.setPreFilterType(cv2.STEREO_BM_PREFILTER_XSOBEL)
    matcher.setPreFilterCap(parameters.prefilter_cap)
    matcher.setTextureThreshold(parameters.texture_threshold)
    matcher.setUniquenessRatio(parameters.uniqueness_ratio)
    matcher.setDisp12MaxDiff(-1)
    matcher.setSpeckleWindowSize(0)
    return matcher.compute(left, right)


def _assert_as_opencv(left, right, parameters):
    """Compares every word of every instruction set; the number of words compared."""
    wanted = _opencv(left, right, parameters)
    for isa in isas():
        words, _ = CEngine(parameters, isa).compute(left, right)
        np.testing.assert_array_equal(words, wanted, f"{isa} {parameters} {left.shape}")
    return wanted.size


@pytest.mark.parametrize("case", range(40))
def test_random_as_reference(rng, random_pair, random_parameters, case):
    parameters = random_parameters()
    height = int(rng.integers(1, 60))
    width = parameters.num_disparities + int(rng.integers(0, 130))
    _assert_as_reference(*random_pair(height, width), parameters)


@pytest.mark.parametrize("columns", _VECTOR_EDGES)
@pytest.mark.parametrize("prefilter", ["xsobel", "none"])
def test_every_remainder_of_a_vector(rng, random_pair, random_parameters, columns, prefilter):
    parameters = random_parameters(num_disparities=16 * int(rng.integers(1, 5)), prefilter=prefilter)
    width = parameters.num_disparities - 1 + parameters.block_size - 1 + columns
    _assert_as_reference(*random_pair(parameters.block_size + 2, width), parameters)


@pytest.mark.parametrize("block_size", [15, 17, 21])
@pytest.mark.parametrize("lr_max_diff", [None, 0])
def test_largest_costs(block_size, lr_max_diff):
    """Black against white: costs of 255 * block_size^2 pass 16 bits from block 17 on."""
    left, right = np.zeros((30, 90), np.uint8), np.full((30, 90), 255, np.uint8)
    right[:, 40:45] = 254
    parameters = Parameters(32, block_size, "none", 31, 0, 100, lr_max_diff)
    _assert_as_reference(left, right, parameters)


def test_largest_filtered_costs():
    stripes = np.tile(np.array([0, 0, 255, 255], np.uint8), 40)
    left, right = np.tile(stripes, (30, 1)), np.tile(np.roll(stripes, 2), (30, 1))
    _assert_as_reference(left, right, Parameters(16, 21, prefilter_cap=63, lr_max_diff=0))


@pytest.mark.parametrize("isa", isas())
@pytest.mark.parametrize("shape", [(1, 1), (1, 500), (500, 1), (10, 100), (100, 41), (11, 42), (2, 2)])
def test_smaller_than_the_block_is_all_invalid_but_for_whole_blocks(rng, isa, shape):
    left, right = rng.integers(0, 256, (2, *shape), dtype=np.uint8)
    words, smin = CEngine(Parameters(32, 11, lr_max_diff=None), isa).compute(left, right)
    matched = shape == (11, 42)
    assert np.count_nonzero(smin != NO_COST) == matched
    assert np.count_nonzero(words != INVALID) <= matched


@pytest.mark.slow
@pytest.mark.same_c
def test_random_as_opencv(rng, random_pair, random_parameters):
    pixels = 0
    while pixels < 10_000_000:
        parameters = random_parameters(prefilter="xsobel", lr_max_diff=None)
        # one matched pixel at least (else OpenCV's words mean nothing), and one row above OpenCV's least
        height = parameters.block_size + 1 + int(rng.integers(0, 500))
        width = parameters.num_disparities + parameters.block_size - 1 + int(rng.integers(0, 700))
        pixels += _assert_as_opencv(*random_pair(height, width), parameters)


@pytest.mark.slow
@pytest.mark.same_c
def test_real_as_opencv(rng, real_pairs, random_parameters):
    pixels = 0
    for left, right in real_pairs:
        pixels += _assert_as_opencv(left, right, Parameters(64, 11, lr_max_diff=None))
        parameters = random_parameters(prefilter="xsobel", lr_max_diff=None)
        height, width = left.shape[0] - int(rng.integers(3)), left.shape[1] - int(rng.integers(40))
        pixels += _assert_as_opencv(left[:height, :width].copy(), right[:height, :width].copy(), parameters)
    assert pixels > 10_000_000


def test_real_as_reference(rng, real_pairs, random_parameters):
    for i in rng.choice(len(real_pairs), 4, replace=False):
        left, right = (image[100:180, 50:420] for image in real_pairs[i])
        _assert_as_reference(left, right, random_parameters(num_disparities=16 * int(rng.integers(1, 9))))


@pytest.mark.parametrize("isa", isas())
def test_bands_give_the_words_of_the_whole(rng, random_pair, random_parameters, isa):
    for _ in range(10):
        parameters = random_parameters(num_disparities=48)
        height = int(rng.integers(1, 70))
        left, right = random_pair(height, 130)
        whole = CEngine(parameters, isa).compute_all(left, right)
        cuts = [0, *sorted(rng.integers(0, height + 1, 3).tolist()), height]
        bands = [CEngine(parameters, isa).compute_all(left, right, rows) for rows in pairwise(cuts)]
        for of_whole, of_bands in zip(whole, zip(*bands, strict=True), strict=True):
            np.testing.assert_array_equal(of_whole, sum(of_bands))  # rows outside a band stay 0


@pytest.mark.parametrize("isa", isas())
def test_same_words_on_used_scratch_and_strided_images(rng, random_pair, random_parameters, isa):
    parameters = random_parameters(num_disparities=32)
    engine = CEngine(parameters, isa)
    left, right = random_pair(60, 200)
    first = engine.compute_all(left, right)
    engine.compute_all(*random_pair(60, 200))
    wide = np.zeros((2, 60, 260), np.uint8)
    wide[:, :, 30:230] = left, right
    for again in (
        engine.compute_all(left, right),
        engine.compute_all(wide[0, :, 30:230], wide[1, :, 30:230]),
    ):
        for a, b in zip(first, again, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("field", "values", "status"),
    [
        ("num_disparities", [-16, 0, 8, 24, 272], "DISPARITIES"),
        ("block_size", [-5, 0, 3, 4, 10, 23], "BLOCK"),
        ("prefilter", [-1, 2], "PREFILTER"),
        ("prefilter_cap", [-1, 0, 64], "CAP"),
        ("texture_threshold", [-1], "TEXTURE"),
        ("uniqueness_ratio", [-1, 101], "UNIQUENESS"),
        ("lr_max_diff", [-2], "LR"),
        ("isa", [-1, 4], "ISA"),
    ],
)
def test_bad_parameter(field, values, status):
    ffi, lib = library()
    for value in values:
        params = c_params(Parameters())
        setattr(params, field, value)
        found = lib.vista_engine_validate(params)
        assert ffi.string(lib.vista_engine_status_name(found)).decode() == f"VISTA_ENGINE_ERROR_{status}"
        assert lib.vista_engine_scratch_bytes(params, 640, 480, 1) == 0


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"left": None}, "ARGUMENT"),
        ({"disparity": None}, "ARGUMENT"),
        ({"scratch": None}, "ARGUMENT"),
        ({"width": 0}, "SIZE"),
        ({"height": 16385}, "SIZE"),
        ({"left_stride": 59}, "STRIDE"),
        ({"disparity_stride": 59}, "STRIDE"),
        ({"rows": (-1, 5)}, "ROWS"),
        ({"rows": (6, 5)}, "ROWS"),
        ({"rows": (0, 41)}, "ROWS"),
        ({"size": -1}, "SCRATCH"),
        ({"misalign": 1}, "SCRATCH"),
    ],
)
def test_bad_call_writes_nothing(change, status):
    ffi, lib = library()
    params = c_params(Parameters())
    width, height = change.get("width", 60), change.get("height", 40)
    size = lib.vista_engine_scratch_bytes(params, 60, 40, 1)
    pixels, words, scratch = (
        np.zeros((40, 60), np.uint8),
        np.full((40, 60), 77, np.int16),
        aligned_bytes(size + 1),
    )

    def pointer(name, kind, array):
        return ffi.NULL if name in change else ffi.cast(f"{kind} *", array.ctypes.data)

    sides = (pointer("left", "uint8_t", pixels), pointer("right", "uint8_t", pixels))
    images = ffi.new("vista_engine_images *", (*sides, width, height, change.get("left_stride", 60), 60))
    results = (pointer("disparity", "int16_t", words), ffi.NULL, change.get("disparity_stride", 60), 0)
    output = ffi.new("vista_engine_output *", results)
    memory = pointer("scratch", "uint8_t", scratch)
    memory = memory + change.get("misalign", 0) if memory else memory
    rows = change.get("rows", (0, 40))
    found = lib.vista_engine_compute_rows(params, images, output, *rows, memory, size + change.get("size", 0))
    assert ffi.string(lib.vista_engine_status_name(found)).decode() == f"VISTA_ENGINE_ERROR_{status}"
    assert (words == 77).all()


def test_every_status_has_its_text():
    ffi, lib = library()
    count = lib.VISTA_ENGINE_ERROR_OVERLAP + 1
    texts = {ffi.string(lib.vista_engine_status_text(status)) for status in range(count)}
    assert len(texts) == count
    assert ffi.string(lib.vista_engine_status_text(count)) == b"unknown status"


def test_defaults_are_the_references():
    params = library()[1].vista_engine_defaults()
    wanted = c_params(Parameters())
    assert all(getattr(params, name) == getattr(wanted, name) for name in dir(wanted))
