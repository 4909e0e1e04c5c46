"""Times and poses that a folder of pairs may bring, as comma-separated values below a line of column names.

times.csv has the time of each pair NAME_left.EXT, NAME_right.EXT:

    name,t_s              # or t_ns: integer nanoseconds
    scene00,1700000000.00

poses.csv has poses of the left camera, as calibrated and not as rectified. The pose maps a point from the
camera (x right, y down, z forward) to the world: p_world = R(q) p_camera + (x_m, y_m, z_m). The columns are
those of a trajectory of the TUM RGB-D benchmark:

    t_s,x_m,y_m,z_m,qx,qy,qz,qw       # or t_ns
    1699999999.95,0.0,0.0,0.0,0.0,0.0,0.0,1.0
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vista.errors import InputError
from vista.sequence.text import check_increasing, data_lines, finite, seconds_ns, timestamp_ns
from vista.sequence.trajectory import Sample, Trajectory, make_sample


def read_times(path: Path, names: list[str]) -> list[int]:
    """Time of each pair, by its name; no two are equal."""
    times_ns: dict[str, int] = {}
    taken_ns: set[int] = set()
    for culprit, row in _rows(path, ({"name", "t_s"}, {"name", "t_ns"})):
        name, t_ns = row["name"], _time_ns(culprit, row)
        if name not in names or name in times_ns:
            raise InputError(
                culprit, f"{name} is {'given twice' if name in times_ns else 'no pair of the folder'}"
            )
        if t_ns in taken_ns:
            raise InputError(culprit, f"two pairs have the time {t_ns} ns")
        times_ns[name] = t_ns
        taken_ns.add(t_ns)
    missing = next((name for name in names if name not in times_ns), None)
    if missing is not None:
        raise InputError(path, f"has no time for {missing}")
    return [times_ns[name] for name in names]


def read_poses(path: Path) -> Trajectory:
    """Poses of the left camera."""
    numbers = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
    samples: list[Sample] = []
    for culprit, row in _rows(path, ({"t_s", *numbers}, {"t_ns", *numbers})):
        t_ns = _time_ns(culprit, row)
        check_increasing(culprit, samples[-1].t_ns if samples else None, t_ns)
        values = np.array([finite(culprit, row[name]) for name in numbers])
        samples.append(make_sample(culprit, t_ns, values[:3], values[3:]))
    if not samples:
        raise InputError(path, "holds no poses")
    return Trajectory(samples)


def _rows(path: Path, known: tuple[set[str], ...]) -> Iterator[tuple[str, dict[str, str]]]:
    """(`file:line`, value of each column) of a file whose first line names the columns, in any order."""
    names: list[str] = []
    for culprit, line in data_lines(path):
        fields = [field.strip() for field in line.split(",")]
        if not names:
            if len(fields) != len(set(fields)) or set(fields) not in known:
                raise InputError(
                    culprit, f"expected the columns {' or '.join(','.join(sorted(k)) for k in known)}"
                )
            names = fields
        elif len(fields) != len(names):
            raise InputError(culprit, f"{len(fields)} columns, expected {len(names)}")
        else:
            yield culprit, dict(zip(names, fields, strict=True))


def _time_ns(culprit: str, row: dict[str, str]) -> int:
    return timestamp_ns(culprit, row["t_ns"]) if "t_ns" in row else seconds_ns(culprit, row["t_s"])
