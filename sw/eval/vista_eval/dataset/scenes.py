"""Reads frames of rendered flights with the exact label of every pixel."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.errors import InputError
from vista.geometry import Array, Calibration, Pose
from vista.rectify import Rectifier
from vista.sequence import open_sequence

from vista_eval.dataset.truth import read_truth
from vista_eval.metrics.segmentation import LabelledView, labelled_view, matched_area


@dataclass(frozen=True)
class LabelledScene:
    """One stereo pair with its exact truth."""

    name: str
    split: str  # of SPLITS
    camera: Calibration
    t_ns: int
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    world_from_camera: Pose | None
    up_world: Array | None
    view: LabelledView


def read_scene(folder: Path, index: int = 0) -> LabelledScene:
    """One frame of a labelled flight. Raises InputError for what is missing or not rectified."""
    truth, sequence = read_truth(folder), open_sequence(folder)
    rectifier = Rectifier(sequence.calibration)
    if not rectifier.is_passthrough:
        raise InputError(folder, "the labels belong to a pair that is not rectified")
    frame = sequence.read(sequence.frames[index])
    stereo = engine_parameters(parameters.defaults())  # of every variant the same area is scored
    height, width = frame.left.shape
    view = labelled_view(
        truth.labels(frame.t_ns).astype(np.int32),
        truth.disparity_px(frame.t_ns).astype(np.float64),
        {label: (o.name, o.kind) for label, o in truth.objects.items() if o.standing},
        truth.focal_baseline_px_m,
        matched_area(height, width, stereo.num_disparities, stereo.block_size),
    )
    return LabelledScene(
        folder.name,
        truth.split,
        rectifier.calibration,
        frame.t_ns,
        frame.left,
        frame.right,
        frame.world_from_camera,
        sequence.up_world,
        view,
    )
