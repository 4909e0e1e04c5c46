"""The chain on a real street (KITTI odometry 00, 51 frames): what stands there is tracked under one id.

The road needs no labels: where the car drove in the frames that follow, nothing stood."""

from __future__ import annotations

import numpy as np
import pytest
from street_drive import (
    SEQUENCE,
    THINGS,
    Thing,
    coasting_share,
    common_ids,
    driven_path_m,
    ghosts_on_the_road,
    run_street,
    warned_frames,
    warnings_beside_the_path,
)
from vista import parameters
from vista.pipeline import Result
from vista.rectify import Rectifier
from vista.sequence import open_sequence

pytestmark = [
    pytest.mark.same_c,
    pytest.mark.slow,
    pytest.mark.skipif(not SEQUENCE.is_dir(), reason=f"no {SEQUENCE}"),
]


@pytest.fixture(scope="module")
def results() -> list[Result]:
    return run_street(parameters.defaults())


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
def test_a_thing_is_in_the_image_in_its_frames(thing: Thing) -> None:
    sequence = open_sequence(SEQUENCE)
    camera = Rectifier(sequence.calibration).calibration
    for frame in thing.frames:
        pose = sequence.frames[frame].world_from_camera
        x, _, z = pose.rotation.T @ (np.array([thing.x_m, 0.0, thing.z_m]) - pose.translation_m)
        assert 0.0 <= camera.cx + camera.focal_px * x / z < camera.width, frame


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
def test_a_thing_keeps_one_id_while_it_is_in_view(thing: Thing, results: list[Result]) -> None:
    assert common_ids(thing, results, driven_path_m())


def test_the_road_and_the_air_above_it_hold_no_obstacle(results: list[Result]) -> None:
    assert ghosts_on_the_road(results, driven_path_m()) == []


def test_the_sky_holds_no_obstacle(results: list[Result]) -> None:
    """The gap between the lamps on the left and the scaffolding, above every roof line of the sequence."""
    for frame, result in enumerate(results):
        for o in result.obstacles:
            e = o.ellipse
            in_gap = 575.0 < e.center_u_px < 635.0 and e.center_v_px < 95.0
            assert not (o.confirmed and not o.coasting and in_gap), (frame, o.id)


def test_warnings_are_of_the_path_and_few_tracks_coast(results: list[Result]) -> None:
    """The path driven next is not known where the recording ends: two frames differ there, by 12 cm."""
    beside = warnings_beside_the_path(results, driven_path_m())
    assert [aside for aside in beside if not aside.beyond] == []
    assert len({aside.frame for aside in beside}) <= 2 and all(aside.aside_m < 2.2 for aside in beside)
    assert warned_frames(results) <= 23
    assert coasting_share(results) <= 0.25
