"""The planner's sines and angles against those of Python; and that it asks a C library for no others."""

from __future__ import annotations

import math
import re
from itertools import product

import numpy as np
from random_seed import seeded
from shared_data import REPOSITORY
from stage_library import ffi, lib

WITHIN = 1e-15
# What C libraries may answer differently in the last digit. IEEE 754 leaves one answer for the others.
OTHERS = r"a?(?:sin|cos|tan)h?|atan2|sincos|hypot|cbrt|expm?1?|exp2|log|log2|log10|log1p|pow|erfc?|[lt]gamma"


def sine_cosine(angle_rad: float) -> tuple[float, float]:
    found = ffi.new("double[2]")
    lib.vista_plan_sine_cosine(angle_rad, found, found + 1)
    return found[0], found[1]


def test_sines() -> None:
    rng = seeded(45)
    quarters = [k * math.pi / 4 + e for k, e in product(range(-12, 13), (-1e-9, -1e-16, 0.0, 1e-16, 1e-9))]
    for angle in [*rng.uniform(-10, 10, 5000), *rng.uniform(-1e5, 1e5, 5000), *quarters]:
        sine, cosine = sine_cosine(angle)
        assert abs(sine - math.sin(angle)) <= WITHIN and abs(cosine - math.cos(angle)) <= WITHIN, angle


def test_tangents() -> None:
    for angle in seeded(46).uniform(-1.5, 1.5, 5000):
        assert math.isclose(lib.vista_plan_tangent(angle), math.tan(angle), rel_tol=WITHIN), angle


def test_angles() -> None:
    rng = seeded(47)
    places = rng.standard_normal((10000, 2)) * np.exp(rng.uniform(-20, 20, (10000, 2)))
    corners = product((-2.0, -1.0, 0.0, 1.0, 2.0), repeat=2)
    for y, x in [*places, *corners]:
        # beyond a quarter of a turn, the last digit of pi is 4.4e-16
        assert abs(lib.vista_plan_angle(y, x) - math.atan2(y, x)) <= WITHIN, (y, x)


def test_no_function_of_the_library_that_may_differ() -> None:
    sources = sorted((REPOSITORY / "sw/src/plan").glob("*.[ch]"))
    assert len(sources) > 10
    calls = re.compile(rf"(?<![\w.])(?:{OTHERS})[fl]?\(")
    assert calls.search("x = hypot(a, b)") and calls.search("cosf(a)")
    for source in sources:
        found = calls.search(source.read_text())
        assert found is None, f"{source.name} calls {found.group()}"
