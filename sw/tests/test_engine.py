"""The engines as Python users meet them: words, bad input, threads, engines by name."""

from __future__ import annotations

from itertools import zip_longest

import cv2
import numpy as np
import pytest
import vista
from random_seed import seeded
from vista import native, parameters
from vista.engine import EngineParameters, OpenCvEngine, StereoEngine, create_engine
from vista_model import INVALID, Parameters, compute_levels, compute_with_smin, smooth

pytestmark = pytest.mark.native


@pytest.fixture
def pair():
    scene = seeded(1).integers(0, 256, (97, 260), dtype=np.uint8)
    scene = cv2.GaussianBlur(scene, (0, 0), 1.5)
    return scene[:, :251], scene[:, 9:]


def reference_parameters(parameters: EngineParameters) -> Parameters:
    """Those of the matching; levels and smoothing are arguments of the reference."""
    return Parameters(**{name: getattr(parameters, name) for name in Parameters.__dataclass_fields__})


@pytest.mark.parametrize("lr_max_diff", [None, 1])
@pytest.mark.parametrize("prefilter", ["xsobel", "none"])
def test_words_and_smin_are_the_references(pair, prefilter, lr_max_diff):
    engine = vista.StereoEngine(48, 9, prefilter, lr_max_diff=lr_max_diff)
    words, smin = engine.compute_with_smin(*pair)
    wanted_words, wanted_smin = compute_with_smin(*pair, reference_parameters(engine.parameters))
    np.testing.assert_array_equal(words, wanted_words)
    np.testing.assert_array_equal(smin, wanted_smin)
    np.testing.assert_array_equal(engine.compute(*pair), words)


@pytest.mark.parametrize("threads", [2, 3, 7, 256])
def test_threads_give_the_same_words(pair, threads):
    one, many = StereoEngine(), StereoEngine(threads=threads)
    for rows in (97, 20, 97):
        left, right = (image[:rows] for image in pair)
        np.testing.assert_array_equal(many.compute(left, right), one.compute(left, right))


def test_golden_and_opencv_agree(pair):
    parameters = EngineParameters(lr_max_diff=None)
    golden, opencv = (create_engine(name, parameters).compute(*pair) for name in ("golden", "opencv"))
    np.testing.assert_array_equal(golden, opencv)
    assert (golden >= 0).any()


@pytest.mark.parametrize("smoothed", [False, True])
@pytest.mark.parametrize("levels", [1, 3, 4])
def test_levels_are_the_references(pair, levels, smoothed):
    """Level 3 of the pair is 32x13 px: too narrow for 48 candidates, and so all invalid."""
    engine = StereoEngine(48, 9, levels=levels, smooth=smoothed)
    found = engine.compute_levels(*pair)
    wanted = compute_levels(*pair, reference_parameters(engine.parameters), levels, smoothed)
    for k, (words, reference) in enumerate(zip_longest(found, wanted)):
        np.testing.assert_array_equal(words, reference)
        assert words.dtype == np.int16 and (words != INVALID).any() == (k < 3)
    np.testing.assert_array_equal(engine.compute(*pair), wanted[0])


def test_levels_come_one_by_one_and_do_not_disturb_each_other(pair):
    engine = StereoEngine(16, 5, levels=3, smooth=True)
    wanted = engine.compute_levels(*pair)
    other = tuple(image[::-1] for image in pair)
    wanted_of_other = engine.compute_levels(*other)
    for words, of_other, *references in zip(
        engine.levels(*pair), engine.levels(*other), wanted, wanted_of_other, strict=True
    ):
        np.testing.assert_array_equal(words, references[0])
        np.testing.assert_array_equal(of_other, references[1])


def test_smin_is_that_of_the_smoothed_pair(pair):
    engine = StereoEngine(16, 5, smooth=True, levels=2)
    words, smin = engine.compute_with_smin(*pair)
    wanted = compute_with_smin(*map(smooth, pair), reference_parameters(engine.parameters))
    np.testing.assert_array_equal(words, wanted[0])
    np.testing.assert_array_equal(smin, wanted[1])


@pytest.mark.parametrize("threads", [2, 7])
def test_threads_give_the_same_levels(pair, threads):
    one, many = (StereoEngine(16, 5, threads=n, smooth=True, levels=4) for n in (1, threads))
    for words, wanted in zip(many.compute_levels(*pair), one.compute_levels(*pair), strict=True):
        np.testing.assert_array_equal(words, wanted)


@pytest.mark.parametrize("smoothed", [False, True])
def test_golden_and_opencv_agree_on_levels(pair, smoothed):
    parameters = EngineParameters(16, 9, lr_max_diff=None, smooth=smoothed, levels=4)
    golden, opencv = (list(create_engine(name, parameters).levels(*pair)) for name in ("golden", "opencv"))
    assert len(golden) == len(opencv) == 4
    for k in range(4):
        np.testing.assert_array_equal(golden[k], opencv[k])
        assert (golden[k] >= 0).any()


def test_opencv_on_images_too_small_to_be_matched(pair):
    engine = OpenCvEngine(EngineParameters(48, 9, lr_max_diff=None, levels=4))
    for shape in ((97, 55), (8, 200)):
        left, right = (image[: shape[0], : shape[1]] for image in pair)
        for k, words in enumerate(engine.levels(left, right)):
            assert words.shape == tuple(-(-side // 2**k) for side in shape) and (words == INVALID).all()
    with pytest.raises(ValueError, match="100x9 px is no higher than a block, StereoBM refuses it"):
        engine.compute(*(image[:9, :100] for image in pair))


@pytest.mark.parametrize(
    ("values", "error", "text"),
    [
        ({"num_disparities": 20}, ValueError, "num_disparities must be a multiple of 16"),
        ({"num_disparities": 32.0}, TypeError, "num_disparities must be an integer, not 32.0"),
        ({"block_size": 4}, ValueError, "block_size must be odd"),
        ({"prefilter": "sobel"}, ValueError, "prefilter must be none or xsobel, not 'sobel'"),
        ({"prefilter": 1}, TypeError, "prefilter must be a string, not 1"),
        ({"prefilter_cap": 64}, ValueError, "prefilter_cap must be from 1 to 63"),
        ({"texture_threshold": -1}, ValueError, "texture_threshold must be from 0"),
        ({"texture_threshold": 2**40}, ValueError, "texture_threshold must be from 0"),
        ({"uniqueness_ratio": 101}, ValueError, "uniqueness_ratio must be from 0 to 100"),
        ({"lr_max_diff": -1}, ValueError, "lr_max_diff must be from 0"),
        ({"lr_max_diff": True}, TypeError, "lr_max_diff must be an integer, not True"),
        ({"smooth": 1}, TypeError, "smooth must be True or False, not 1"),
        ({"levels": 0}, ValueError, "levels must be from 1 to 4, not 0"),
        ({"levels": 5}, ValueError, "levels must be from 1 to 4, not 5"),
        ({"levels": True}, TypeError, "levels must be an integer, not True"),
        ({"threads": 0}, ValueError, "threads must be from 1 to 256, not 0"),
        ({"isa": "mmx"}, ValueError, "isa must be one of auto, portable, avx2, avx512, neon, not 'mmx'"),
    ],
)
def test_bad_parameter(values, error, text):
    with pytest.raises(error, match=text) as raised:
        StereoEngine(**values)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("left", "right", "error", "text"),
    [
        (
            np.zeros((9, 9), np.uint8),
            np.zeros((9, 8), np.uint8),
            ValueError,
            "left image is 9x9 but right image is 8x9",
        ),
        (np.zeros((9, 9)), np.zeros((9, 9)), TypeError, "left image must be uint8, not float64"),
        (np.zeros((9, 9), np.uint8), [[1]], TypeError, "right image must be a numpy array, not list"),
        (
            np.zeros((9, 9, 3), np.uint8),
            np.zeros((9, 9), np.uint8),
            ValueError,
            "left image must have 2 dimensions",
        ),
        (np.zeros((0, 9), np.uint8), np.zeros((0, 9), np.uint8), ValueError, "left image is empty"),
        (
            np.zeros((1, 16385), np.uint8),
            np.zeros((1, 16385), np.uint8),
            ValueError,
            "at most 16384 px a side",
        ),
    ],
)
def test_bad_images(left, right, error, text):
    for engine in (StereoEngine(), OpenCvEngine(EngineParameters(lr_max_diff=None)))[
        : 1 if "side" in text else 2
    ]:
        with pytest.raises(error, match=text):
            engine.compute(left, right)


@pytest.mark.parametrize(
    ("name", "values", "text"),
    [
        ("sgm", {}, "engine must be one of golden, rtl, opencv, board, not 'sgm'"),
        ("opencv", {}, "engine opencv: lr_max_diff must be off"),
        ("opencv", {"prefilter": "none", "lr_max_diff": None}, "engine opencv: prefilter must be xsobel"),
    ],
)
def test_engine_that_cannot(name, values, text):
    with pytest.raises(ValueError, match=text):
        create_engine(name, EngineParameters(**values))


def test_slices_of_larger_images_are_read_as_they_are(pair):
    left, right = pair
    assert not left.flags.c_contiguous
    np.testing.assert_array_equal(
        StereoEngine().compute(left, right), StereoEngine().compute(left.copy(), right.copy())
    )


def test_constants_are_those_of_the_headers() -> None:
    """Python's own definitions, once for all engines, against the binding's."""
    _, lib = native.load("vista_engine")
    assert vista.engine.INVALID == lib.VISTA_DISPARITY_INVALID
    assert vista.engine.LR_OFF == lib.VISTA_ENGINE_LR_OFF
    _, host = native.load("vista")
    assert vista.engine.INVALID == host.VISTA_DISPARITY_INVALID == INVALID
    assert vista.engine.SCALE == host.VISTA_DISPARITY_SCALE == lib.VISTA_DISPARITY_SCALE
    assert parameters.schema()["stereo"]["lr_max_diff"]["min"] == vista.engine.LR_OFF
