"""What all stages share: they check parameters, camera and images alike; ids and memory at their limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from stage_arena import Arena, ffi, lib, status_name
from stage_library import Stages, camera, image_struct
from track_library import Tracker, flight_path, matched, motion, seen_at

WIDTH, HEIGHT = 64, 48


class Bench:
    """A frame that has gone through all stages up to the regions, and one call of each stage on top."""

    def __init__(self) -> None:
        self.stages = s = Stages(camera(WIDTH, HEIGHT))
        self.image = np.full((HEIGHT, WIDTH), 90, np.uint8)
        self.words = np.full((HEIGHT, WIDTH), 160, np.int16)
        self.c_image = image_struct("image", self.image)
        self.c_words = image_struct("disparity_image", self.words)
        f, up = s.foveation.handle, ffi.new("double[3]", [0.0, -1.0, 0.0])
        self.volume = ffi.new("vista_collision_volume *", [[0.0, 0.0, 1.0], 2.0, 100.0])
        self.zone, arena = ffi.new("vista_blind_zone *"), ffi.new("vista_arena *")
        self.noise = ffi.new("vista_image_noise *")
        self.terrain, moved = ffi.new("vista_terrain *"), motion(None, (0.0, 0.0, 9.0))
        memory = Arena(lambda arena: lib.vista_terrain_layout(self.terrain, arena, f))
        path = flight_path(moved)
        self.keep = (up, arena, memory)
        section, horizontal_deg = s.section, 55.0
        regions = (s.matched, self.c_words, s.cells, s.surfaces, s.segmentation, s.refinement, s.regions)
        size_and_center = (WIDTH, HEIGHT, 31.5, 23.5)
        self.calls: dict[str, tuple[str, Callable[[], int]]] = {
            "geometry": (
                "foveation.sector_count",
                lambda: lib.vista_foveation_layout(
                    ffi.new("vista_foveation *"), arena, section("foveation"), *size_and_center
                ),
            ),
            "foveation": (
                "foveation.sector_count",
                lambda: lib.vista_foveate(f, section("foveation"), self.c_image, self.c_words, s.cells),
            ),
            "surface": (
                "surface.lever_px",
                lambda: lib.vista_surfaces_compute(f, section("surface"), s.camera, up, s.cells, s.surfaces),
            ),
            "affinity": (
                "affinity.flow_scale",
                lambda: lib.vista_affinity_compute(f, section("affinity"), s.camera, s.cells, s.affinity),
            ),
            "obstacle seeds": (
                "segmentation.reach",
                lambda: lib.vista_seeds_of_obstacles(
                    f, section("segmentation"), s.camera, s.cells, s.surfaces, s.seeds
                ),
            ),
            "segmentation": (
                "segmentation.reach",
                lambda: lib.vista_segment(
                    f, s.parameters, s.camera, s.cells, s.surfaces, s.affinity, s.segmentation
                ),
            ),
            "refinement": (
                "refinement.sigma_intensity",
                lambda: lib.vista_refine(
                    f, section("refinement"), s.cells, s.segmentation.label, s.refinement
                ),
            ),
            "regions": (
                "region.min_inliers",
                lambda: lib.vista_regions_compute(
                    f, section("region"), s.camera, up, horizontal_deg, *regions
                ),
            ),
            "row edges": (
                "region.min_inliers",
                lambda: lib.vista_row_edges_judge(
                    f, section("region"), self.c_image, self.noise, s.cells, s.regions
                ),
            ),
            "collision volume": (
                "region.tolerance_px",
                lambda: lib.vista_collision_volume_count(
                    f, section("region"), s.camera, self.volume, self.c_words, s.cells, s.regions
                ),
            ),
            "blind zone": (
                "blind_zone.confirm_window",
                lambda: lib.vista_blind_zone_update(
                    section("blind_zone"),
                    s.camera,
                    matched(),
                    2.0,
                    self.c_image,
                    self.noise,
                    self.c_words,
                    self.zone,
                ),
            ),
            "terrain": (
                "terrain.angle_min_deg",
                lambda: lib.vista_terrain_update(
                    self.terrain, f, s.parameters, s.camera, matched(), up, moved, path, 1, s.cells
                ),
            ),
        }


NAMES = list(Bench().calls)
TAKE_CAMERA = [name for name in NAMES if name not in ("geometry", "foveation", "refinement", "row edges")]
TAKE_WORDS = ["foveation", "regions", "collision volume", "blind zone"]


def test_the_stages_accept_a_frame() -> None:
    for name, (_, call) in Bench().calls.items():
        assert status_name(call()) == "VISTA_OK", name


@pytest.mark.parametrize("name", NAMES)
def test_parameters_out_of_range_are_refused(name: str) -> None:
    """Zero sectors, a window of no frames, a scale of zero: of each stage one, by the table of all."""
    bench = Bench()
    parameter, call = bench.calls[name]
    section, _, field = parameter.partition(".")
    setattr(getattr(bench.stages.parameters, section), field, 0)
    assert status_name(call()) == "VISTA_ERROR_RANGE"


@pytest.mark.parametrize("name", TAKE_CAMERA)
def test_cameras_that_cannot_be_are_refused(name: str) -> None:
    bench = Bench()
    bench.stages.camera.center_v_px = 1e12
    assert status_name(bench.calls[name][1]()) == "VISTA_ERROR_RANGE"


@pytest.mark.parametrize("name", TAKE_WORDS)
@pytest.mark.parametrize("stride", [0, 3, WIDTH - 1, 1 - WIDTH])
def test_strides_below_the_width_are_refused(name: str, stride: int) -> None:
    bench = Bench()
    bench.c_words.stride = stride
    assert status_name(bench.calls[name][1]()) == "VISTA_ERROR_SIZE"


# ---- ids ----

POINTS = [np.array([x, 0.0, 40.0]) for x in (-6.0, 0.0, 6.0)]


def set_next_id(tracker: Tracker, value: int) -> None:
    ffi.cast("int32_t *", tracker.handle)[3] = value  # max_tracks, max_detections, count, next_id


def test_used_up_ids_start_again_and_pass_those_that_live() -> None:
    tracker, last = Tracker(), 2**31 - 1
    assert tracker.update(0.0, [seen_at(POINTS[0])]) == "VISTA_OK"
    assert list(tracker.tracks) == [1]
    set_next_id(tracker, last)
    assert tracker.update(0.1, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [1, last, 2]  # oldest first; 1 lives
    for frame in range(2, 8):
        assert tracker.update(0.1 * frame, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [1, last, 2] and tracker.confirmed == [1, last, 2]


def test_a_reset_with_used_up_ids_is_not_fatal() -> None:
    tracker = Tracker()
    set_next_id(tracker, 2**31 - 1)
    lib.vista_tracker_reset(tracker.handle)
    assert tracker.update(0.0, [seen_at(point) for point in POINTS]) == "VISTA_OK"
    assert list(tracker.tracks) == [2**31 - 1, 1, 2]


# ---- memory ----


@pytest.mark.parametrize("shift", [0, 1, 8, 33, 63])
def test_the_arena_aligns_whatever_memory_it_gets(shift: int) -> None:
    memory = np.zeros(4096, np.uint8)
    start = memory.ctypes.data + (-memory.ctypes.data) % 64 + shift
    arena: Any = ffi.new("vista_arena *", [ffi.cast("unsigned char *", start), 2048, 0])
    places = [int(ffi.cast("uintptr_t", lib.vista_arena_take(arena, count, 4))) for count in (1, 3, 40, 1)]
    assert all(place % 64 == 0 for place in places)
    assert places == sorted(set(places)) and places[0] - start < 64
    assert arena.used <= 6 * 64 + 63
