"""A real street (KITTI odometry 00, 51 frames): what stands there, where the car drove, and the chain on it.

The things were picked by eye in the images; their places are those of the images' own stereo at close range,
in the world of the poses (the first camera: x right, y down, z forward).
"""

from __future__ import annotations

import numpy as np
from shared_data import SHARED_DATA
from vista import StereoEngine, parameters
from vista.chain import engine_parameters
from vista.pipeline import Pipeline, Result
from vista.rectify import Rectifier
from vista.sequence import open_sequence
from vista_eval.metrics.street import Thing

SEQUENCE = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
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
