"""A trajectory in the format of the TUM RGB-D benchmark: `t x y z qx qy qz qw` a line, t in seconds.

The poses are those of the left camera, as calibrated and not as rectified:
p_world = R(q) p_camera + (x, y, z), where the camera has x to the right, y down and z forward.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.sequence.text import check_increasing, data_lines, finite_row, seconds_ns
from vista.sequence.trajectory import Sample, Trajectory, make_sample


def read_trajectory(path: Path) -> Trajectory:
    samples: list[Sample] = []
    for culprit, line in data_lines(path):
        time, *numbers = line.replace(",", " ").split() or [""]
        values = np.array(finite_row(culprit, numbers, 7))
        t_ns = seconds_ns(culprit, time)
        check_increasing(culprit, samples[-1].t_ns if samples else None, t_ns)
        samples.append(make_sample(culprit, t_ns, values[:3], values[[6, 3, 4, 5]]))
    if not samples:
        raise InputError(path, "holds no poses")
    return Trajectory(samples)
