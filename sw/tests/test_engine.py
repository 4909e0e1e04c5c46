"""The engines as Python users meet them: words, bad input, threads, engines by name."""

from __future__ import annotations

from dataclasses import asdict

import cv2
import numpy as np
import pytest
import vista
from random_seed import seeded
from vista.engine import EngineParameters, OpenCvEngine, StereoEngine, create_engine
from vista_model import Parameters, compute_with_smin


@pytest.fixture
def pair():
    scene = seeded(1).integers(0, 256, (97, 260), dtype=np.uint8)
    scene = cv2.GaussianBlur(scene, (0, 0), 1.5)
    return scene[:, :251], scene[:, 9:]


@pytest.mark.parametrize("lr_max_diff", [None, 1])
@pytest.mark.parametrize("prefilter", ["xsobel", "none"])
def test_words_and_smin_are_the_references(pair, prefilter, lr_max_diff):
    engine = vista.StereoEngine(48, 9, prefilter, lr_max_diff=lr_max_diff)
    words, smin = engine.compute_with_smin(*pair)
    wanted_words, wanted_smin = compute_with_smin(*pair, Parameters(**asdict(engine.parameters)))
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
        ({"threads": 0}, ValueError, "threads must be from 1 to 256, not 0"),
        ({"isa": "mmx"}, ValueError, "isa must be one of auto, portable, avx2, avx512, not 'mmx'"),
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
        ("sgm", {}, "engine must be one of golden, rtl, opencv, not 'sgm'"),
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
