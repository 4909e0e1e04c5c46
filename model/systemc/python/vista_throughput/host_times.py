"""Measures the times of the host's stages on this machine, as vista-fly has them: rectification and libvista.

Processor time, as on a core of its own: each frame is played PASSES times, counts with its fastest pass, and
without the time in which the system ran something else. The spread that is left is that of the scenes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from vista import parameters
from vista.engine import EngineParameters
from vista.errors import InputError
from vista.recording import Recorder, played, rectified_source
from vista.rectify import Rectifier
from vista.sequence import Frame, Sequence, open_sequence

from vista_throughput import scene
from vista_throughput.system import Samples

PASSES = 3
WARM_UP_FRAMES = 2  # caches, and tracks that do not exist yet
MAX_FRAMES = 60
BEFORE_THE_HOST = ("rectify", "stereo", "alignment")
SUMS = ("host", "cpu")


@dataclass(frozen=True)
class HostTimes:
    """One entry a frame in each series; entry k of all of them is the same frame."""

    origin: str
    rectify_ms: Samples  # empty: pairs come rectified
    stage_ms: dict[str, Samples]  # in the order of the chain


def synthetic_host_times(width_px: int, height_px: int, engine: EngineParameters, seed: int) -> HostTimes:
    """Measures the host on frames drawn for it, of any size."""
    frames = scene.synthetic_frames(width_px, height_px, MAX_FRAMES // 2 + WARM_UP_FRAMES, seed)
    camera = scene.calibration(width_px, height_px)
    source = rectified_source(camera, up_world=np.array([0.0, -1.0, 0.0]))
    return _measure(source, frames, engine, "synthetic frames")


def sequence_host_times(path: Path, width_px: int, height_px: int, engine: EngineParameters) -> HostTimes:
    """Measures the host on the first frames of a sequence. Raises InputError when its size is another one."""
    sequence = open_sequence(path)
    camera = Rectifier(sequence.calibration).calibration
    if (camera.width, camera.height) != (width_px, height_px):
        size = f"{camera.width}x{camera.height}"
        raise InputError("--sequence", f"its images are {size}, the system's {width_px}x{height_px}")
    frames = map(sequence.read, sequence.frames[: MAX_FRAMES + WARM_UP_FRAMES])
    return _measure(sequence, frames, engine, f"frames of {sequence.name}")


def _measure(source: Sequence, frames: Iterable[Frame], engine: EngineParameters, of_what: str) -> HostTimes:
    values = parameters.defaults()  # all levels, as the host is shipped
    values["stereo"] |= {"num_disparities": engine.num_disparities, "block_size": engine.block_size}
    rectifier = Rectifier(source.calibration)
    with TemporaryDirectory() as folder:
        path = Path(folder, "frames.vista")
        with Recorder(path, source, rectifier, values) as recorder:
            count = sum(1 for _ in map(recorder.write, frames))
        if count <= WARM_UP_FRAMES:
            raise InputError("--sequence", f"needs more than {WARM_UP_FRAMES} frames")
        times, _ = played(path, PASSES)
    fastest_ms = {name: ms.reshape(PASSES, -1)[:, WARM_UP_FRAMES:] for name, ms in times.items()}
    chosen = np.argmin(fastest_ms["host"], axis=0), np.arange(count - WARM_UP_FRAMES)
    one_ms = {name: ms[chosen] for name, ms in fastest_ms.items()}
    wall_ms = one_ms["host"] + sum(one_ms[name] for name in BEFORE_THE_HOST)
    running = np.minimum(1.0, one_ms["cpu"] / wall_ms)
    series = {name: tuple((running * ms).tolist()) for name, ms in one_ms.items() if name not in SUMS}
    rectify_ms, _, _ = (series.pop(name) for name in BEFORE_THE_HOST)
    origin = f"measured here on {count - WARM_UP_FRAMES} {of_what}"
    return HostTimes(origin, () if rectifier.is_passthrough else rectify_ms, series)
