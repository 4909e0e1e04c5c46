"""The foveation: its geometry against the closed mapping, its averages against numpy over the same pixels."""

from __future__ import annotations

import math
import os
import time

import networkx
import numpy as np
import pytest
from random_seed import seeded
from scipy.ndimage import map_coordinates
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from stage_library import (
    INVALID,
    Arena,
    Foveation,
    Stages,
    camera,
    ffi,
    lib,
    parameters,
    status_name,
    view,
)

GEOMETRIES = 60


def random_geometry(random: np.random.Generator) -> Foveation:
    """Fovea anywhere, at a pixel, between pixels, or on the image's edge."""
    width, height = (int(x) for x in random.integers(16, 200, 2))
    center = random.uniform((0, 0), (width - 1, height - 1))
    center = (center, np.round(center), np.round(2 * center) / 2, center * random.integers(0, 2, 2))[
        random.integers(4)
    ]
    changes = {
        "foveation.sector_count": int(random.choice([16, 17, 48, 100, 128, 256])),
        "foveation.rho_0_px": float(random.choice([1.0, 2.5, 4.0, 20.0, 64.0])),
    }
    foveation = Foveation(width, height, (float(center[0]), float(center[1])), changes)
    assert foveation.status == "VISTA_OK"
    return foveation


@pytest.mark.slow
def test_the_runs_of_the_cells_partition_the_image() -> None:
    random = seeded(1)
    for _ in range(GEOMETRIES):
        f = random_geometry(random)
        painted = np.full(f.cell_of_pixel.shape, -1)
        for node in range(f.node_count):
            for u, v, length in f.runs[f.first_run[node] : f.first_run[node + 1]]:
                assert length >= 1 and u >= 0 and u + length <= painted.shape[1]
                assert np.all(painted[v, u : u + length] == -1)
                painted[v, u : u + length] = node
        assert np.array_equal(painted, f.cell_of_pixel)
        assert np.array_equal(f.pixel_count, np.bincount(painted.ravel(), minlength=f.node_count))
        assert f.node_count <= f.handle.max_nodes
        assert f.pixel_count.max() <= f.handle.max_footprint_px


def test_cells_are_squares_around_their_centres() -> None:
    random = seeded(3)
    for _ in range(GEOMETRIES):
        f = random_geometry(random)
        ring, sector = np.nonzero(f.node_of_grid >= 0)
        step = 2 * np.pi / f.params.sector_count
        offset = f.params.rho_0_px * np.exp((ring + 0.5 + 1j * (sector + 0.5)) * step)
        assert np.allclose(f.center_u[1:], f.center[0] + offset.real, atol=1e-3)
        assert np.allclose(f.center_v[1:], f.center[1] + offset.imag, atol=1e-3)
        assert np.allclose(f.size_px[1:], np.abs(offset) * step, rtol=1e-5)
        assert (f.center_u[0], f.center_v[0]) == pytest.approx(f.center, rel=1e-6)

        height, width = f.cell_of_pixel.shape
        size = f.size_px[1:]
        whole = np.minimum(np.minimum(f.center_u, width - 1 - f.center_u)[1:], size) >= size
        whole &= np.minimum(f.center_v, height - 1 - f.center_v)[1:] >= size
        area = np.abs(offset) ** 2 * step * np.sinh(step)  # of the sector between the two circles
        excess = np.abs(f.pixel_count[1:] - area)[whole]
        assert np.all(excess <= 2 * size[whole] + 4)  # lattice points in a figure: half its perimeter


def test_nodes_are_numbered_hub_first_then_ring_by_ring() -> None:
    random = seeded(4)
    for _ in range(GEOMETRIES):
        f = random_geometry(random)
        existing = f.node_of_grid[f.node_of_grid >= 0]
        assert np.array_equal(existing, np.arange(1, f.node_count))
        assert f.pixel_count[0] >= 1
        height, width = f.cell_of_pixel.shape
        inside = (f.center_u >= 0) & (f.center_v >= 0)
        inside &= (f.center_u <= width - 1) & (f.center_v <= height - 1)
        assert np.all((f.pixel_count > 0) | inside)
        points = np.arange(1, f.node_count) <= f.handle.point_count
        assert np.array_equal(points, f.size_px[1:] < 1.5)
        assert np.all(f.pixel_count[1:][~points] > 0)


def expected_edges(f: Foveation) -> set[tuple[int, int]]:
    joined = [(0, node) for node in f.node_of_grid[0]]
    joined += zip(f.node_of_grid[:-1].ravel(), f.node_of_grid[1:].ravel(), strict=True)
    joined += zip(f.node_of_grid.ravel(), np.roll(f.node_of_grid, -1, axis=1).ravel(), strict=True)
    return {(min(a, b), max(a, b)) for a, b in joined if a >= 0 and b >= 0}


@pytest.mark.slow
def test_the_graph_joins_neighbours_around_the_hub() -> None:
    random = seeded(5)
    for _ in range(GEOMETRIES):
        f = random_geometry(random)
        assert np.array_equal(f.tail[f.reverse], f.head)
        assert np.array_equal(f.reverse[f.reverse], np.arange(f.arc_count))
        edges = list(zip(f.tail[f.tail < f.head], f.head[f.tail < f.head], strict=True))
        assert len(edges) == len(set(edges))  # none twice
        assert set(edges) == expected_edges(f)
        degree = np.bincount(f.tail, minlength=f.node_count)
        assert degree[0] == np.count_nonzero(f.node_of_grid[0] >= 0)
        assert np.all(degree[1:] <= 4)
        distance = np.hypot(f.center_u[f.tail] - f.center_u[f.head], f.center_v[f.tail] - f.center_v[f.head])
        assert np.allclose(f.arc_distance_px, distance, atol=1e-3)


@pytest.mark.parametrize("size", [(16, 16), (33, 20), (64, 90), (640, 480)])
def test_seen_from_the_middle_the_graph_is_connected_and_planar(size: tuple[int, int]) -> None:
    for sectors in (16, 128):
        f = Foveation(*size, changes={"foveation.sector_count": sectors})
        arcs = coo_matrix((np.ones(f.arc_count), (f.tail, f.head)), shape=(f.node_count,) * 2)
        assert connected_components(arcs, directed=False)[0] == 1
        if f.node_count < 2000:
            graph = networkx.Graph(list(zip(f.tail.tolist(), f.head.tolist(), strict=True)))
            assert networkx.check_planarity(graph)[0]


def frame(random: np.random.Generator, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Noise; the share of valid pixels changes across the image."""
    image = random.integers(0, 256, (height, width), np.uint8)
    words = random.integers(0, random.choice([16, 1024, 4096]), (height, width)).astype(np.int16)
    words[random.random((height, width)) < np.linspace(0, 1, width)] = INVALID
    return image, words


def footprint(f: Foveation, node: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns that the words of a node come from."""
    if 1 <= node <= f.handle.point_count:
        height, width = f.cell_of_pixel.shape
        v = int(np.clip(np.floor(f.center_v[node]), 0, height - 2))
        u = int(np.clip(np.floor(f.center_u[node]), 0, width - 2))
        return np.array([v, v, v + 1, v + 1]), np.array([u, u + 1, u, u + 1])
    return np.nonzero(f.cell_of_pixel == node)


@pytest.mark.parametrize("sectors", [16, 60, pytest.param(256, marks=pytest.mark.slow)])
def test_cells_average_their_pixels(sectors: int) -> None:
    random = seeded(6 + sectors)
    for _ in range(3):
        width, height = (int(x) for x in random.integers(16, 120, 2))
        stages = Stages(camera(width, height), {"foveation.sector_count": sectors})
        f = stages.foveation
        image, words = frame(random, width, height)
        stages.foveate(image, words)

        averaged = np.r_[0, f.handle.point_count + 1 : f.node_count]
        sums = np.bincount(f.cell_of_pixel.ravel(), image.ravel(), f.node_count)
        assert np.allclose(stages.intensity[averaged], sums[averaged] / f.pixel_count[averaged], rtol=1e-6)
        for node in range(f.node_count):
            under = words[footprint(f, node)]
            valid = np.sort(under[under >= 0])
            assert stages.valid_fraction[node] == pytest.approx(valid.size / under.size)
            if valid.size > 0 and 10 * valid.size >= 3 * under.size:
                assert stages.disparity_px[node] == valid[(valid.size - 1) // 2] / 16
            else:
                assert stages.disparity_px[node] < 0


@pytest.mark.parametrize(("width", "height"), [(16, 16), (17, 40), (200, 150)])
def test_cells_of_a_pixel_are_interpolated(width: int, height: int) -> None:
    """Small images have such cells at their edge, with centres beyond the last pixel."""
    random = seeded(7)
    stages = Stages(camera(width, height), {"foveation.sector_count": 256, "foveation.rho_0_px": 2.0})
    f = stages.foveation
    assert f.handle.point_count > 100
    image, words = frame(random, width, height)
    stages.foveate(image, words)
    points = slice(1, f.handle.point_count + 1)
    where = np.stack([f.center_v[points], f.center_u[points]])
    expected = map_coordinates(image.astype(float), where, order=1, mode="nearest")
    assert np.allclose(stages.intensity[points], expected, atol=2e-2)


def test_rows_may_be_wider_than_the_image_and_frames_leave_nothing_behind() -> None:
    random = seeded(8)
    stages = Stages(camera(90, 60))
    image, words = frame(random, 90, 60)
    wide_image, wide_words = frame(random, 131, 60)
    wide_image[:, :90], wide_words[:, :90] = image, words

    def cells() -> bytes:
        return stages.intensity.tobytes() + stages.disparity_px.tobytes() + stages.valid_fraction.tobytes()

    stages.foveate(image, words)
    first = cells()
    stages.foveate(*frame(random, 90, 60))
    assert cells() != first
    stages.foveate(wide_image[:, :90], wide_words[:, :90])
    assert cells() == first


@pytest.mark.parametrize(
    ("width", "height", "center", "status"),
    [
        (15, 16, (7, 7), "VISTA_ERROR_SIZE"),
        (16, 15, (7, 7), "VISTA_ERROR_SIZE"),
        (8193, 16, (7, 7), "VISTA_ERROR_SIZE"),
        (-64, 64, (7, 7), "VISTA_ERROR_SIZE"),
        (64, 48, (-0.01, 7), "VISTA_ERROR_RANGE"),
        (64, 48, (63.01, 7), "VISTA_ERROR_RANGE"),
        (64, 48, (7, 47.01), "VISTA_ERROR_RANGE"),
        (64, 48, (float("nan"), 7), "VISTA_ERROR_RANGE"),
        (64, 48, (7, float("inf")), "VISTA_ERROR_RANGE"),
        (64, 48, (63, 47), "VISTA_OK"),
        (8192, 16, (7, 7), "VISTA_OK"),
    ],
)
def test_sizes_and_centres_out_of_range_are_refused(width, height, center, status) -> None:
    assert Foveation(width, height, tuple(float(x) for x in center)).status == status


def test_a_byte_too_little_is_reported() -> None:
    whole = Foveation(64, 48)
    unused = whole.arena.size - whole.arena.arena.used
    assert Foveation(64, 48, missing_bytes=unused).status == "VISTA_OK"
    assert Foveation(64, 48, missing_bytes=unused + 1).status == "VISTA_ERROR_MEMORY"
    for missing in np.linspace(unused + 1, whole.arena.size, 50).astype(int):
        assert Foveation(64, 48, missing_bytes=int(missing)).status == "VISTA_ERROR_MEMORY"
    cells = ffi.new("vista_cells *")
    short = Arena(lambda arena: lib.vista_cells_layout(cells, arena, whole.handle), missing_bytes=1)
    assert status_name(short.status) == "VISTA_ERROR_MEMORY"


def test_a_counting_arena_only_counts() -> None:
    arena, foveation = ffi.new("vista_arena *"), ffi.new("vista_foveation *")
    params = parameters()
    section, fovea = ffi.addressof(params, "foveation"), ffi.new("vista_fovea *", [64, 48, 31.5, 23.5])
    assert lib.vista_foveation_layout(foveation, arena, section, fovea) == lib.VISTA_OK
    assert arena.used > 64 * 48 * 4
    assert foveation.cell_of_pixel == ffi.NULL and foveation.graph.head == ffi.NULL
    assert view(ffi.addressof(arena, "base"), 1, np.uintp)[0] == 0


@pytest.mark.parametrize(
    ("size", "center", "sectors", "rho_0_px"),
    [
        ((1226, 370), None, 128, 4.0),
        ((640, 480), (319.5, 239.5), 256, 1.0),
        ((333, 217), (0.0, 0.0), 16, 64.0),
        ((200, 200), (100.0, 100.0), 64, 3.0),  # pixels on the rays themselves
        ((97, 301), (96.0, 17.25), 96, 1.5),
    ],
)
def test_every_pixel_lies_in_the_cell_of_the_formula_itself(
    size, center, sectors: int, rho_0_px: float
) -> None:
    """Also next to borders, where products alone would not tell: in the arithmetic of the library."""
    width, height = size
    f = Foveation(width, height, center, {"foveation.sector_count": sectors, "foveation.rho_0_px": rho_0_px})
    assert f.status == "VISTA_OK"
    step = 6.283185307179586 / sectors
    wrong = 0
    for v in range(height):
        for u in range(0, width, 1 if height < 250 else 3):
            du, dv = u - f.center[0], v - f.center[1]
            rho, theta = math.hypot(du, dv), math.atan2(dv, du)
            if rho < rho_0_px:
                wrong += f.cell_of_pixel[v, u] != 0
                continue
            ring = min(math.floor(math.log(rho / rho_0_px) / step), f.handle.ring_count - 1)
            sector = math.floor((theta + 6.283185307179586 if theta < 0 else theta) / step) % sectors
            wrong += f.cell_of_pixel[v, u] != f.node_of_grid[ring, sector]
    assert wrong == 0


@pytest.mark.skipif("asan" in os.environ.get("LD_PRELOAD", ""), reason="sanitizers cost time of their own")
def test_the_size_is_known_at_once_and_the_geometry_soon() -> None:
    """They take 0.02 and 20 ms at 1226x370; 18 to 88 and 44 to 212 ms when a pixel took three logarithms."""
    values = parameters()
    kitti = ffi.new("vista_camera *", [1226, 370, 707.0, 607.0, 183.0, 0.54])
    size, handle, bytes_ms, create_ms = ffi.new("size_t *"), ffi.new("vista_pipeline **"), [], []
    for _ in range(7):
        start = time.perf_counter()
        assert lib.vista_pipeline_bytes(values, kitti, size) == lib.VISTA_OK
        bytes_ms.append(1e3 * (time.perf_counter() - start))
        memory = np.ones(size[0], np.uint8)
        place = ffi.cast("void *", memory.ctypes.data)
        start = time.perf_counter()
        assert lib.vista_pipeline_create(place, size[0], values, kitti, handle) == lib.VISTA_OK
        create_ms.append(1e3 * (time.perf_counter() - start))
    assert min(bytes_ms) < 1.0
    assert min(create_ms) < 35.0
