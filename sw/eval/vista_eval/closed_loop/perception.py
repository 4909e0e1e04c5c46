"""What the detector makes of the pairs of a flight, with its own words or with those of a rival."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from vista import parameters
from vista.chain import engine_parameters
from vista.detector import Detector
from vista.engine import EngineParameters
from vista.geometry import Pose, rectified_rig
from vista.health.finding import FrameHealth
from vista.history import FrameRecord
from vista.rectify import Rectifier

from vista_eval.closed_loop.camera import calibration_of
from vista_eval.closed_loop.painted import cluster_maker, of_obstacles
from vista_eval.closed_loop.vehicles import Kind
from vista_eval.closed_loop.world import World
from vista_eval.render.rig import Rig
from vista_eval.rivals import at_one_level, make_sgbm, true_words, with_forest

Words = Literal["engine", "perfect", "SGBM", "obstacles", "clusters"]
UP_WORLD = np.array([0.0, 0.0, 1.0])
MakeWords = Callable[[np.ndarray, np.ndarray, np.ndarray | None], list[np.ndarray]]  # of images and truth


def fitted_to(world: World, kind: Kind, values: parameters.Values) -> parameters.Values:
    """The parameters with the room that the vehicle needs in this world, and with its limits."""
    room = values["obstacle_map"] | {"collision_radius_m": world.room_m}
    return values | {"obstacle_map": room, "plan": values["plan"] | kind.plan}


class Perception:
    """The detector of one flight."""

    def __init__(
        self, rig: Rig, values: parameters.Values, words: Words = "engine", forest: bool = False
    ) -> None:
        """forest: a spanning forest divides what the cut divides."""
        if words == "SGBM":
            values = at_one_level(values)
        self.values = with_forest(values) if forest else values
        self._words = maker_of(words, self.values)
        # Who knows obstacles, or clusters, alone: the words are those of what they tell.
        self._finds = Perception(rig, values, "engine", forest) if words == "obstacles" else None
        self._clusters = cluster_maker(rig, engine_parameters(values)) if words == "clusters" else None
        self._rig = rig
        self.detector = Detector(Rectifier(rectified_rig(calibration_of(rig), "flight")), self.values)
        self._index = 0

    def judge(
        self,
        pair: tuple[np.ndarray, np.ndarray],
        t_ns: int,
        pose: Pose,
        disparity_px: np.ndarray | None,
    ) -> FrameRecord:
        """disparity_px: the true ones, for words without error."""
        if self._finds is not None:
            found = self._finds.judge(pair, t_ns, pose, None)
            disparity_px = of_obstacles(self._rig, pose, found)
        if self._clusters is not None:
            disparity_px = self._clusters(*pair, pose)
        self.detector.take(*pair, t_ns)
        self.detector.match(None if self._words is None else self._words(*pair, disparity_px))
        result = self.detector.judge(self.detector.rectified_pose(pose), UP_WORLD)
        health = FrameHealth(self.detector.findings())
        self._index += 1
        return FrameRecord(
            result.outcome,
            result.items,
            result.directions,
            result.stage_ms,
            index=self._index - 1,
            t_ns=t_ns,
            health=health,
        )


def maker_of(words: Words, values: parameters.Values) -> MakeWords | None:
    """None: the engine in C, which the detector has by itself."""
    stereo = engine_parameters(values)
    match words:
        case "engine":
            return None
        case "perfect" | "obstacles" | "clusters":
            return lambda left, right, true: perfect_words(true, stereo)
        case "SGBM":
            matched = make_sgbm(stereo)
            return lambda left, right, true: [matched(left, right)]


def perfect_words(disparity_px: np.ndarray | None, stereo: EngineParameters) -> list[np.ndarray]:
    assert disparity_px is not None
    return [true_words(disparity_px, level, stereo.num_disparities) for level in range(stereo.levels)]
