"""The chain of one frame: it is read, rectified and matched, and goes through the host's pipeline."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from vista import parameters
from vista.correction import Correction, RectifyingEngine
from vista.engine import LR_OFF, RECTIFYING_ENGINES, Engine, EngineParameters, create_engine
from vista.engine.board import DEFAULT_TIMEOUT_S
from vista.errors import InputError
from vista.history import FrameRecord, StageClock
from vista.odometry import StereoOdometry
from vista.rectify import Rectifier
from vista.sequence import Frame, FrameFiles, Sequence

if TYPE_CHECKING:
    from vista.geometry import Array, Pose
    from vista.pipeline import Result

TIMED = ("read", "rectify", "stereo", "alignment", "odometry", "host")  # what the total of a frame is made of


class HostPipeline(Protocol):
    """What the chain knows of the host: vista.pipeline.Pipeline, or a stand-in of a test."""

    def reset(self) -> None: ...

    def process(
        self,
        left: NDArray[np.uint8],
        disparity: list[NDArray[np.int16]],
        t_ns: int,
        pose: Pose | None,
        up_world: Array | None,
    ) -> Result: ...


@dataclass(frozen=True)
class Chain:
    """The stages of a run, in the order in which the data passes them."""

    sequence: Sequence
    rectifier: Rectifier
    engine: Engine
    pipeline: HostPipeline
    engine_rectifies: bool = False  # the engine takes raw images
    odometry: StereoOdometry | None = None  # where the poses come from, if not from the sequence
    correction: Correction | None = None  # of the calibration, in flight

    def reset(self) -> None:
        """What comes next does not continue what came before."""
        self.pipeline.reset()
        if self.odometry is not None:
            self.odometry.reset()
        if self.correction is not None:
            self.correction.reset()


def engine_parameters(values: parameters.Values) -> EngineParameters:
    stereo = {name: value for name, value in values["stereo"].items() if name != "rectify_rows"}
    spelled = {  # what TOML has no word for, and C no type
        "lr_max_diff": None if stereo["lr_max_diff"] == LR_OFF else stereo["lr_max_diff"],
        "smooth": stereo["smooth"] == "binomial3",
    }
    return EngineParameters(**stereo | spelled)


def fitted_to(sequence: Sequence, values: parameters.Values) -> parameters.Values:
    """The parameters for this sequence: stills have nothing to confirm a scene with."""
    if not sequence.stills:
        return values
    return values | {"tracker": values["tracker"] | {"confirm_hits": 1, "confirm_window": 1}}


def make_chain(
    sequence: Sequence,
    engine_name: str,
    values: parameters.Values,
    threads: int,
    rtl_width_px: int | None = None,
    address: str | None = None,
    board_timeout_s: int = DEFAULT_TIMEOUT_S,
) -> Chain:
    from vista.pipeline import Pipeline  # loads libvista, which `--help` need not

    rectifier = Rectifier(sequence.calibration, int(values["stereo"]["rectify_rows"]))
    try:
        grids = rectifier.grids if engine_name in RECTIFYING_ENGINES else None
        engine = create_engine(
            engine_name, engine_parameters(values), threads, rtl_width_px, grids, address, board_timeout_s
        )
        engine.check_size(rectifier.calibration.width, rectifier.calibration.height)
    except (TypeError, ValueError) as error:
        raise InputError(f"engine {engine_name}", str(error)) from None
    camera = rectifier.calibration
    try:
        pipeline = Pipeline(camera, values)
    except ValueError as error:
        raise InputError(sequence.name, f"images of {camera.width}x{camera.height} px: {error}") from None
    odometry = StereoOdometry(camera) if sequence.odometry else None
    correction = None
    if values["alignment"]["correct"] == "on" and not sequence.stills:  # stills have no time to agree in
        rectifying = cast(RectifyingEngine, engine) if grids is not None else None
        correction = Correction(rectifier, values, rectifying)
    return Chain(sequence, rectifier, engine, pipeline, grids is not None, odometry, correction)


@dataclass(frozen=True)
class Step:
    """One frame on its way through the chain."""

    raw: Frame  # as read
    frame: Frame  # rectified
    levels: list[NDArray[np.int16]]  # the words of each
    result: Result
    record: FrameRecord
    anew: bool  # the host forgot what came before: a still, or poses that began anew


def run_frame(chain: Chain, files: FrameFiles) -> Step:
    """Raises InputError for an image that cannot be read."""
    clock = StageClock()
    with clock.stage("read"):
        raw = chain.sequence.read(files)
    return process_frame(chain, raw, clock, files.anew)


def process_frame(chain: Chain, raw: Frame, clock: StageClock, anew: bool = False) -> Step:
    """What follows once a frame has been read; clock: with the time that this took, if that counts; anew: its
    pose does not continue those before."""
    with clock.stage("rectify"):
        frame = chain.rectifier.rectify(raw)
    with clock.stage("stereo"):
        matched = raw if chain.engine_rectifies else frame
        levels = list(chain.engine.levels(matched.left, matched.right))
    anew = anew or chain.sequence.stills
    alignment = None
    if chain.correction is not None:
        with clock.stage("alignment"):
            alignment = chain.correction.update(frame)
    if chain.odometry is not None:
        restarts = chain.odometry.restarts
        with clock.stage("odometry"):
            frame = replace(frame, world_from_camera=chain.odometry.update(frame.left, levels[0]))
        anew = anew or chain.odometry.restarts > restarts
    if anew:
        chain.pipeline.reset()
    result = chain.pipeline.process(
        frame.left, levels, frame.t_ns, frame.world_from_camera, chain.sequence.up_world
    )

    stage_ms = clock.stage_ms | result.stage_ms
    stage_ms["total"] = sum(stage_ms.get(name, 0.0) for name in TIMED)
    record = FrameRecord(
        result.outcome,
        result.items,
        result.directions,
        stage_ms,
        index=frame.index,
        t_ns=frame.t_ns,
        alignment=alignment,
    )
    return Step(raw, frame, levels, result, record, anew)
