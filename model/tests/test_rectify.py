"""Rectification by a control grid: numpy against the definition, C against numpy, and what is refused."""

from __future__ import annotations

from fractions import Fraction
from math import floor

import numpy as np
import pytest
from vista_model import grid_shape, rectify, row_beyond, sources
from vista_model.c_engine import c_grid, library, prepare_rectify
from vista_model.rectify import BUFFER_ROWS, reach


def _random_grid(rng, height, width):
    """Smooth, rough or extreme offsets, and those of sources far outside."""
    shape = (*grid_shape(height, width), 2)
    kind = rng.integers(4)
    if kind == 0:
        return rng.integers(-40, 41, shape).astype(np.int16)
    if kind == 1:
        return rng.integers(-2000, 2001, shape).astype(np.int16)
    if kind == 2:
        return rng.choice([-32768, 32767], shape).astype(np.int16)
    return (rng.integers(-500, 501, (1, 1, 2)) + rng.integers(-1, 2, shape)).astype(np.int16)


def _random_image(rng, shape):
    return (rng.integers(0, 2, shape) * 255 if rng.integers(3) == 0 else rng.integers(0, 256, shape)).astype(
        np.uint8
    )


def _c_rectify(image, grid):
    out = np.full(image.shape, 0xA5, np.uint8)
    prepare_rectify(image, grid, out)()
    return out


def _c_row_beyond(grid, height, width, buffer_rows):
    row = library()[1].vista_frontend_row_beyond(c_grid(grid), width, height, buffer_rows)
    return None if row < 0 else row


def _offset(grid, y, x, axis):
    """The contract's sentence in exact fractions: bilinear, half rounded up once."""
    (row, j), (column, i) = divmod(y, 16), divmod(x, 16)
    corners = grid[row : row + 2, column : column + 2, axis].astype(int)
    weights = [Fraction(16 - j, 16), Fraction(j, 16)], [Fraction(16 - i, 16), Fraction(i, 16)]
    value = sum(weights[0][a] * weights[1][b] * int(corners[a, b]) for a in range(2) for b in range(2))
    return floor(value + Fraction(1, 2))


@pytest.mark.parametrize("shape", [(1, 1), (1, 17), (16, 16), (17, 33), (18, 5)])
def test_definition_pixel_by_pixel(rng, shape):
    height, width = shape
    for _ in range(4):
        grid, image = _random_grid(rng, *shape), _random_image(rng, shape)
        out, (x_at, y_at) = rectify(image, grid), sources(grid, *shape)
        for y, x in np.ndindex(shape):
            X = min(max(32 * x + _offset(grid, y, x, 0), 0), 32 * (width - 1))
            Y = min(max(32 * y + _offset(grid, y, x, 1), 0), 32 * (height - 1))
            assert (x_at[y, x], y_at[y, x]) == (X, Y)
            (column, fx), (row, fy) = divmod(X, 32), divmod(Y, 32)
            value = Fraction(512, 1024)
            for b, weight_y in ((0, 32 - fy), (1, fy)):
                for a, weight_x in ((0, 32 - fx), (1, fx)):
                    if weight_x * weight_y:
                        value += Fraction(weight_x * weight_y, 1024) * int(image[row + b, column + a])
            assert out[y, x] == floor(value)


def test_c_gives_the_same_pixels(rng):
    pixels = 0
    while pixels < 1_500_000:
        shape = int(rng.integers(1, 200)), int(rng.integers(1, 300))
        image, grid = _random_image(rng, shape), _random_grid(rng, *shape)
        np.testing.assert_array_equal(_c_rectify(image, grid), rectify(image, grid), f"{shape}")
        pixels += image.size


@pytest.mark.parametrize("shape", [(1, 1), (1, 16384), (16384, 1), (16, 16), (31, 33)])
def test_c_at_the_limits(rng, shape):
    for _ in range(3):
        image, grid = _random_image(rng, shape), _random_grid(rng, *shape)
        np.testing.assert_array_equal(_c_rectify(image, grid), rectify(image, grid))


def test_no_offset_is_no_change_and_whole_pixels_are_a_shift(rng):
    image = _random_image(rng, (50, 70))
    grid = np.zeros((*grid_shape(50, 70), 2), np.int16)
    np.testing.assert_array_equal(rectify(image, grid), image)
    grid[:] = 3 * 32, -2 * 32
    np.testing.assert_array_equal(rectify(image, grid)[2:, :-3], image[:-2, 3:])
    np.testing.assert_array_equal(rectify(image, grid)[:3, -1], image[0, [-1, -1, -1]])


def test_strided_images_and_nothing_written_beside_the_output(rng):
    around, canvas = _random_image(rng, (50, 130)), np.full((60, 140), 0x5A, np.uint8)
    image, out = around[5:38, 7:100], canvas[3:36, 9:102]
    grid = _random_grid(rng, *image.shape)
    prepare_rectify(image, grid, out)()
    np.testing.assert_array_equal(out, rectify(image, grid))
    out[:] = 0x5A
    assert (canvas == 0x5A).all()


@pytest.mark.parametrize("rows", BUFFER_ROWS)
def test_every_pixel_of_a_grid_within_reach_lies_in_the_buffer(rng, rows):
    """The rows that a row of the output is taken from: reach above it, reach + 1 below, and no more."""
    height, width = 90, 40
    limit = reach(rows)
    assert 2 * limit + 2 == rows - 2
    grid = rng.integers(-32 * limit, 32 * limit + 32, (*grid_shape(height, width), 2)).astype(np.int16)
    assert row_beyond(grid, rows) is None and _c_row_beyond(grid, height, width, rows) is None
    row, fraction = divmod(sources(grid, height, width)[1], 32)
    own = np.arange(height)[:, None]
    assert (row >= own - limit).all() and (row + (fraction > 0) <= own + limit + 1).all()


@pytest.mark.parametrize("rows", BUFFER_ROWS)
def test_a_control_point_beyond_the_buffer_is_named(rng, rows):
    height, width = 90, 40
    limit = 32 * reach(rows)
    for _ in range(20):
        grid = rng.integers(-limit, limit + 32, (*grid_shape(height, width), 2)).astype(np.int16)
        row, column = int(rng.integers(grid.shape[0])), int(rng.integers(grid.shape[1]))
        grid[row, column, 1] = rng.choice([-limit - 1, limit + 32, -32768, 32767])
        assert row_beyond(grid, rows) == 16 * row == _c_row_beyond(grid, height, width, rows)
        deeper = [depth for depth in BUFFER_ROWS if depth > rows]
        for depth in deeper:
            assert row_beyond(grid, depth) == _c_row_beyond(grid, height, width, depth)


@pytest.mark.parametrize("rows", [*BUFFER_ROWS, 4, 5, 20])
def test_c_and_numpy_refuse_the_same_grids(rng, rows):
    found = set()
    for _ in range(40):
        height, width = int(rng.integers(1, 300)), int(rng.integers(1, 300))
        span = 32 * reach(rows) + int(rng.integers(-64, 96))
        grid = np.zeros((*grid_shape(height, width), 2), np.int16)
        points = rng.integers(0, grid[..., 1].size, 3)
        grid[..., 1].flat[points] = rng.choice([-1, 1], 3) * np.clip(span, 0, 32767)
        row = row_beyond(grid, rows)
        assert row == _c_row_beyond(grid, height, width, rows)
        found.add(row is None)
    assert found == {True, False}


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"image": None}, "ARGUMENT"),
        ({"pixels": None}, "ARGUMENT"),
        ({"grid": None}, "ARGUMENT"),
        ({"out": None}, "ARGUMENT"),
        ({"width": 0}, "SIZE"),
        ({"height": 16385}, "SIZE"),
        ({"stride": 19}, "STRIDE"),
        ({"out_stride": 19}, "STRIDE"),
        ({"shift": 199}, "OVERLAP"),
        ({"shift": -180}, "OVERLAP"),
    ],
)
def test_bad_call_writes_nothing(change, status):
    ffi, lib = library()
    change = {key: ffi.NULL if value is None else value for key, value in change.items()}
    pixels, out = np.zeros((10, 20), np.uint8), np.full((10, 20), 77, np.uint8)
    grid = np.zeros((*grid_shape(10, 20), 2), np.int16)
    data = change.get("pixels", ffi.cast("uint8_t *", pixels.ctypes.data))
    size = change.get("width", 20), change.get("height", 10)
    image = ffi.new("vista_frontend_image *", (data, *size, change.get("stride", 20)))
    target = change.get("out", ffi.cast("uint8_t *", out.ctypes.data))
    if "shift" in change:
        target = data + change["shift"]
    found = lib.vista_frontend_rectify(
        change.get("image", image), change.get("grid", c_grid(grid)), target, change.get("out_stride", 20)
    )
    assert ffi.string(lib.vista_engine_status_name(found)).decode() == f"VISTA_ENGINE_ERROR_{status}"
    assert (out == 77).all() and (pixels == 0).all()
