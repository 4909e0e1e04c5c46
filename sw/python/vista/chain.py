"""The chain of one frame: it is read, rectified and matched, and goes through the host's pipeline."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, Self, cast

from vista import parameters
from vista.control_grid import GridPair
from vista.detector import Detector, MatchedPair, Novelty
from vista.engine import (
    LR_OFF,
    RECTIFYING_ENGINES,
    Engine,
    EngineParameters,
    OpenCvEngine,
    StereoEngine,
    create_engine,
)
from vista.engine.board import DEFAULT_TIMEOUT_S
from vista.errors import InputError
from vista.geometry import Pose
from vista.health.finding import Finding, FrameHealth
from vista.health.monitor import HealthMonitor
from vista.history import FrameRecord, StageClock
from vista.odometry import StereoOdometry
from vista.pipeline import Result
from vista.rectify import Rectifier
from vista.sequence import Frame, FrameFiles, Sequence

# What the total of a frame is made of.
TIMED = ("read", "rectify", "stereo", "alignment", "odometry", "watch", "host")


class RectifyingEngine(Protocol):
    """An engine that takes raw images, and the map to rectify them by."""

    def load_map(self, grids: GridPair) -> None: ...


@dataclass(frozen=True)
class Chain:
    """What the data of a run passes."""

    sequence: Sequence
    rectifier: Rectifier
    engine: Engine
    detector: Detector
    engine_rectifies: bool = False  # the engine takes raw images
    odometry: StereoOdometry | None = None  # where the poses come from, if not from the sequence
    monitor: HealthMonitor | None = None  # what is checked besides


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
    every_pair: bool = True,
) -> Chain:
    """every_pair: frames that repeat the one before are judged, too. Raises InputError."""
    rectifier = Rectifier(sequence.calibration, int(values["stereo"]["rectify_rows"]))
    try:
        grids = rectifier.grids if engine_name in RECTIFYING_ENGINES else None
        engine = create_engine(
            engine_name, engine_parameters(values), threads, rtl_width_px, grids, address, board_timeout_s
        )
        engine.check_size(rectifier.calibration.width, rectifier.calibration.height)
    except (TypeError, ValueError) as error:
        raise InputError(f"engine {engine_name}", str(error)) from None
    camera, monitor = rectifier.calibration, HealthMonitor(sequence)
    try:
        detector = Detector(
            rectifier, values, monitor.of_run, sequence.stills, every_pair, isinstance(engine, OpenCvEngine)
        )
    except ValueError as error:
        raise InputError(sequence.name, f"images of {camera.width}x{camera.height} px: {error}") from None
    odometry = StereoOdometry(camera) if sequence.odometry else None
    return Chain(sequence, rectifier, engine, detector, grids is not None, odometry, monitor)


@dataclass(frozen=True)
class Step:
    """One frame on its way through the chain. What is in memory of the detector is copied when first asked
    for, before the next frame is taken."""

    raw: Frame  # as read
    pair: MatchedPair
    world_from_camera: Pose | None  # rectified
    result: Result
    record: FrameRecord
    anew: bool  # the host forgot what came before: a still, or poses that began anew
    checks_ms: float  # no part of the total

    @cached_property
    def frame(self) -> Frame:
        """The rectified one."""
        left, right = self.pair.left, self.pair.right
        return replace(self.raw, left=left, right=right, world_from_camera=self.world_from_camera)

    def keep(self) -> Self:
        """Copies everything, so that it outlasts the frame."""
        _ = self.frame, self.pair.levels, self.result.keep()
        return self


def run_frame(chain: Chain, files: FrameFiles) -> Step:
    """Raises InputError for an image that cannot be read."""
    clock = StageClock()
    with clock.stage("read"):
        raw = chain.sequence.read(files)
    take(chain, raw)
    return finish(chain, raw, clock, files.anew)


def take(chain: Chain, raw: Frame, restarts: bool = False) -> Novelty:
    """Begins with a frame, or says that it repeats the one before: it is not to be finished then. restarts:
    it begins another flight, and all that came before is forgotten."""
    left, right = (raw.left, raw.right) if raw.words is None else (None, None)
    novelty = chain.detector.take(left, right, raw.t_ns, restarts)
    if novelty == Novelty.RESTARTED:
        for part in (chain.odometry, chain.monitor):
            if part is not None:
                part.reset()
        _load_map(chain)
    return novelty


def finish(chain: Chain, raw: Frame, clock: StageClock, anew: bool = False) -> Step:
    """What follows once a frame has been taken; clock: with the time of reading it, if that counts; anew: its
    pose does not continue those before."""
    detector, pair, pose = chain.detector, chain.detector.pair(), raw.world_from_camera
    with clock.stage("stereo"):
        if raw.words is not None:
            detector.match(raw.words)
        elif isinstance(chain.engine, StereoEngine) and chain.engine.threads == 1:
            detector.match()
        else:
            images = (raw.left, raw.right) if chain.engine_rectifies else (pair.left, pair.right)
            detector.match(list(chain.engine.levels(*images)))
    if chain.odometry is not None:
        restarts = chain.odometry.restarts
        with clock.stage("odometry"):
            pose = chain.odometry.update(pair.left, pair.levels[0])
        anew = anew or chain.odometry.restarts > restarts
    elif pose is not None:
        pose = detector.rectified_pose(pose)
    result = detector.judge(pose, chain.sequence.up_world, anew)
    alignment = detector.alignment
    if alignment is not None and alignment.changed:
        _load_map(chain)
    with clock.stage("checks"):
        besides: tuple[Finding, ...] = ()
        if chain.monitor is not None and raw.words is None:
            besides = chain.monitor.check(pair, result.health.matched_fraction, detector.rows, detector.shown)
    record = FrameRecord(
        result.outcome,
        result.items,
        result.directions,
        _stage_ms(chain, clock.stage_ms, result.stage_ms),
        index=raw.index,
        t_ns=raw.t_ns,
        health=FrameHealth(detector.findings(besides)),
        alignment=alignment,
    )
    anew = anew or chain.sequence.stills
    return Step(raw, pair, pose, result, record, anew, clock.stage_ms["checks"])


def _load_map(chain: Chain) -> None:
    """Has an engine that rectifies by itself do so as the detector does now."""
    grid, grids = chain.detector.right_grid(), chain.rectifier.grids
    if chain.engine_rectifies and grid is not None and grids is not None:
        cast(RectifyingEngine, chain.engine).load_map(replace(grids, right=grid))


def _stage_ms(chain: Chain, own: dict[str, float], host: dict[str, float]) -> dict[str, float]:
    """The time of each stage in their order, and of those together that give a frame its result."""
    rectify_ms, _, alignment_ms, watch_ms = chain.detector.times_ms
    times = {"read": own.get("read"), "rectify": rectify_ms, "stereo": own["stereo"]}
    times |= {
        "alignment": None if chain.sequence.stills else alignment_ms,
        "odometry": own.get("odometry"),
        "watch": None if chain.sequence.stills else watch_ms,
    }
    stage_ms = {name: ms for name, ms in times.items() if ms is not None} | host
    total_ms = sum(stage_ms.get(name, 0.0) for name in TIMED)
    return stage_ms | {"total": total_ms}
