"""The chain on a real street (KITTI odometry 00, 51 frames): what stands there is tracked under one id.

The things were picked by eye in the images; their places are those of the images' own stereo at close range,
in the world of the poses (the first camera: x right, y down, z forward). The road needs no labels: where the
car drove in the frames that follow, nothing stood."""

from __future__ import annotations

import numpy as np
import pytest
from shared_data import SHARED_DATA
from vista import StereoEngine, parameters
from vista.chain import engine_parameters
from vista.pipeline import Pipeline, Result
from vista.rectify import Rectifier
from vista.sequence import open_sequence
from vista_eval.metrics.street import (
    Thing,
    coasting_share,
    common_ids,
    ghosts_on_the_road,
    warned_frames,
    warnings_beside_the_path,
)

SEQUENCE = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
pytestmark = [
    pytest.mark.native,
    pytest.mark.slow,
    pytest.mark.skipif(not SEQUENCE.is_dir(), reason=f"no {SEQUENCE}"),
]

THINGS = (
    Thing("parked car, left behind", 3.3, 12.9, 3, 6),
    Thing("parked car ahead", 2.8, 36.2, 4, 24),
    Thing("billboard", -8.2, 15.4, 3, 4),
    Thing("first tree", -3.2, 13.2, 3, 8),
    Thing("second tree", -3.8, 26.8, 4, 17),
    Thing("third tree", -4.6, 40.8, 6, 28),
    Thing("fourth tree", -3.9, 54.7, 17, 42),
    Thing("tree at the scaffolding", 8.2, 45.6, 5, 29),
    Thing("conifer", -13.2, 41.1, 8, 22),
    Thing("near lamp post", -3.0, 20.3, 4, 14),
    Thing("far lamp post", -3.5, 47.7, 7, 34),
    Thing("warning sign", 3.2, 42.7, 17, 32),
)


def driven_path_m() -> np.ndarray:
    """(frames, 3): where the camera was."""
    return np.array([frame.world_from_camera.translation_m for frame in open_sequence(SEQUENCE).frames])


def run_street(values: parameters.Values) -> list[Result]:
    sequence = open_sequence(SEQUENCE)
    rectifier = Rectifier(sequence.calibration)
    engine = StereoEngine(**vars(engine_parameters(values)))
    pipeline = Pipeline(rectifier.calibration, values)
    results = []
    for files in sequence.frames:
        frame = rectifier.rectify(sequence.read(files))
        levels = engine.compute_levels(frame.left, frame.right)
        results.append(pipeline.process(frame.left, levels, frame.t_ns, frame.world_from_camera))
    return results


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
            in_gap = 575.0 < e.center_u < 635.0 and e.center_v < 95.0
            assert not (o.confirmed and not o.coasting and in_gap), (frame, o.id)


def test_warnings_are_of_the_path_and_few_tracks_coast(results: list[Result]) -> None:
    """Where the recording ends, the path driven next is not known: two frames differ there, by 12 cm."""
    beside = warnings_beside_the_path(results, driven_path_m())
    assert [aside for aside in beside if not aside.beyond] == []
    assert len({aside.frame for aside in beside}) <= 2 and all(aside.aside_m < 2.2 for aside in beside)
    assert warned_frames(results) <= 23
    assert coasting_share(results) <= 0.25
