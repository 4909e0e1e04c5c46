"""Measures the times of the host's stages on this machine: rectification, the C model and libvista.

Processor time, as on a core of its own: each frame goes through PASSES pipelines, one after the other, counts
with its fastest pass, and without the time in which the system ran something else. The spread that is left is
that of the scenes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from time import thread_time
from typing import TYPE_CHECKING

import cv2
import numpy as np
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import Disparity, EngineParameters, create_engine
from vista.errors import InputError
from vista.geometry import Array, Calibration
from vista.rectify import Rectifier
from vista.sequence import Frame, Sequence, open_sequence

from vista_throughput import scene
from vista_throughput.system import Samples

if TYPE_CHECKING:
    from vista.pipeline import Pipeline

PASSES = 3
WARM_UP_FRAMES = 2  # caches, and tracks that do not exist yet
MAX_FRAMES = 60


@dataclass(frozen=True)
class HostTimes:
    """One entry a frame in each series; entry k of all of them is the same frame."""

    origin: str
    rectify_ms: Samples  # empty: pairs come rectified
    stage_ms: dict[str, Samples]  # in the order of the chain


def synthetic_host_times(width_px: int, height_px: int, engine: EngineParameters, seed: int) -> HostTimes:
    """Measures the host on frames drawn for it, of any size."""
    frames = scene.synthetic_frames(width_px, height_px, MAX_FRAMES // 2 + WARM_UP_FRAMES, seed)
    stage_ms = _measure(frames, scene.calibration(width_px, height_px), engine, np.array([0.0, -1.0, 0.0]))
    count = len(next(iter(stage_ms.values())))
    return HostTimes(f"measured here on {count} synthetic frames", (), stage_ms)


def sequence_host_times(path: Path, width_px: int, height_px: int, engine: EngineParameters) -> HostTimes:
    """Measures the host on the first frames of a sequence. Raises InputError when its size is another one."""
    sequence = open_sequence(path)
    rectifier = Rectifier(sequence.calibration)
    size = rectifier.calibration.width, rectifier.calibration.height
    if size != (width_px, height_px):
        raise InputError(
            "--sequence", f"its images are {size[0]}x{size[1]}, the system's {width_px}x{height_px}"
        )
    rectify_ms: list[float] = []
    frames = _rectified(sequence, rectifier, rectify_ms)
    stage_ms = _measure(frames, rectifier.calibration, engine, sequence.up_world)
    count = len(next(iter(stage_ms.values()), ()))
    if not count:
        raise InputError("--sequence", f"needs more than {WARM_UP_FRAMES} frames")
    kept = () if rectifier.is_passthrough else tuple(rectify_ms[WARM_UP_FRAMES:])
    return HostTimes(f"measured here on {count} frames of {sequence.name}", kept, stage_ms)


def _rectified(sequence: Sequence, rectifier: Rectifier, rectify_ms: list[float]) -> Iterable[Frame]:
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)  # what is simulated is one core
    try:
        for files in sequence.frames[: MAX_FRAMES + WARM_UP_FRAMES]:
            raw = sequence.read(files)
            times = []
            for _ in range(PASSES):
                start_s = thread_time()
                frame = rectifier.rectify(raw)
                times.append(1e3 * (thread_time() - start_s))
            rectify_ms.append(min(times))
            yield frame
    finally:
        cv2.setNumThreads(threads)


def _measure(
    frames: Iterable[Frame], camera: Calibration, engine: EngineParameters, up_world: Array | None
) -> dict[str, Samples]:
    from vista.pipeline import Pipeline  # loads libvista, which `--help` need not

    values = parameters.defaults()
    values["stereo"]["num_disparities"] = engine.num_disparities
    values["stereo"]["block_size"] = engine.block_size
    matcher = create_engine("golden", engine_parameters(values))  # all levels, as the host is shipped
    try:
        pipelines = [Pipeline(camera, values) for _ in range(PASSES)]
    except ValueError as error:
        raise InputError("throughput", f"host at {camera.width}x{camera.height} px: {error}") from None
    series: dict[str, list[float]] = {}
    for number, frame in enumerate(frames):
        levels = list(matcher.levels(frame.left, frame.right))
        passes = [_processor_ms(pipeline, frame, levels, up_world) for pipeline in pipelines]
        fastest = min(passes, key=lambda stage_ms: stage_ms["host"])
        for name, milliseconds in fastest.items():
            if name != "host" and number >= WARM_UP_FRAMES:
                series.setdefault(name, []).append(milliseconds)
    return {name: tuple(times) for name, times in series.items()}


def _processor_ms(
    pipeline: Pipeline, frame: Frame, levels: list[Disparity], up_world: Array | None
) -> dict[str, float]:
    """The library's wall times, scaled to the call's processor time where that is less."""
    start_s = thread_time()
    result = pipeline.process(frame.left, levels, frame.t_ns, frame.world_from_camera, up_world)
    processor_ms = 1e3 * (thread_time() - start_s)
    running = min(1.0, processor_ms / result.stage_ms["host"])
    return {name: running * milliseconds for name, milliseconds in result.stage_ms.items()}
