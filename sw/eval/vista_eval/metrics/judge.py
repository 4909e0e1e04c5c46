"""Judges the warnings of one frame against its truth (vista_eval.metrics defines how)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array, Pose

from vista_eval.dataset.truth import FlightTruth
from vista_eval.metrics.consistency import DIMENSIONS
from vista_eval.metrics.flight_path import Straight
from vista_eval.metrics.frame_truth import FrameTruth, Points, Target, true_points
from vista_eval.metrics.rules import HIT_RANGE_M, PAPER, Rules

if TYPE_CHECKING:
    from vista.pipeline import Nearest, Obstacle

BEARING_MARGIN_PX = 3.0
ANYWHERE = Straight(np.array([1.0, 0.0, 0.0]))  # where the path does not matter
TOO_NEAR_ID = 0  # no track: something is too near to match, somewhere up to the range that is given


@dataclass(frozen=True)
class Warned:
    """A report of a danger: a box in px of the left image, and its range from the camera."""

    id: int
    u_px: float
    v_px: float
    half_u_px: float
    half_v_px: float
    range_m: float
    up_to: bool = False  # the range is the largest that it may have


@dataclass(frozen=True)
class FalseAlarm:
    id: int
    range_m: float
    ghost: bool  # nothing real is there, beside the path either


@dataclass(frozen=True)
class FrameScore:
    t_ns: int
    target: str | None  # name; None: no target is a true danger in this frame
    range_m: float | None  # of the target
    warnings: int
    matched_id: int | None  # a warning that agrees with the target
    tracked: bool  # a confirmed obstacle agrees with the target, in or out of the collision volume
    error_m: float | None
    nees: float | None  # None without a match, or without a reference point
    false_alarms: tuple[FalseAlarm, ...]
    blind: bool  # the target is nearer than the engine matches
    asked_m: tuple[float, float] = HIT_RANGE_M  # from where to where a hit is asked for
    nees_dimensions: int = DIMENSIONS

    @property
    def in_band(self) -> bool:
        return self.range_m is not None and self.asked_m[0] <= self.range_m <= self.asked_m[1]

    @property
    def hit(self) -> bool:
        return self.in_band and self.matched_id is not None

    @property
    def missed(self) -> bool:
        return self.range_m is not None and self.range_m < self.asked_m[1] and self.matched_id is None


class Shown:
    """All points of the frame that was asked for last."""

    def __init__(self, truth: FlightTruth) -> None:
        self._truth = truth
        self._of: tuple[int, Points] | None = None

    def by(self, frame: FrameTruth) -> Points:
        if self._of is None or self._of[0] != frame.t_ns:
            self._of = frame.t_ns, true_points(self._truth, frame.t_ns, frame.world_from_camera, ANYWHERE)
        return self._of[1]


class Judge:
    """Judges one flight, frame after frame: what has left the image is judged by what was seen before."""

    def __init__(
        self,
        truth: FlightTruth,
        blind_depth_m: float,
        still_m: Array | None = None,
        rules: Rules = PAPER,
        shown: Shown | None = None,
    ) -> None:
        """blind_depth_m: nearer along the optical axis nothing is matched; still_m: (n, 3) surfaces around
        the path that any frame of the flight shows; shown: for several judges of one flight to share."""
        self._truth = truth
        self._rules = rules
        self._still_m = np.zeros((0, 3)) if still_m is None else still_m
        self._shown = Shown(truth) if shown is None else shown
        self._blind_depth_m = blind_depth_m
        self._earlier_m = np.zeros((0, 3))
        self._matched: int | None = None

    def frame(
        self,
        frame: FrameTruth,
        obstacles: Sequence[Obstacle],
        nearest: Nearest | None,
        world_from_estimate: Pose,
    ) -> FrameScore:
        """obstacles, nearest: of the chain, in the world of its poses; world_from_estimate leads into the
        true one."""
        truth, rules, target = self._truth, self._rules, frame.target
        confirmed = {o.id: o for o in obstacles if o.confirmed}
        told = None  # the one that is reported as the nearest collision, with a place of its own
        if rules.meeting and nearest is not None and nearest.id in confirmed:
            told = nearest.id
            place_m, doubt_m2 = nearest.position_m, nearest.covariance_m2
            confirmed[told] = confirmed[told].but(position_m=place_m, covariance_m2=doubt_m2)
        positions_m = {k: carried(world_from_estimate, o.position_m) for k, o in confirmed.items()}
        places = [place_of(truth, frame, o, positions_m[k]) for k, o in confirmed.items()]
        agreeing = [place.id for place in places if tells_of_target(truth, rules, place, frame)]
        warnings = {k: o for k, o in confirmed.items() if o.in_collision_volume}
        warned = [place for place in places if place.id in warnings]
        alarms = [
            alarm
            for alarm in false_alarms(truth, rules, frame, self._still_m, self._shown, warned)
            if not self._was_there(frame, warnings[alarm.id], positions_m[alarm.id], alarm.range_m)
        ]
        self._earlier_m = np.concatenate([self._earlier_m, frame.real.position_m[::16]])
        matched = self._match(frame, [k for k in agreeing if k in warnings], positions_m, told)
        error_m, nees = None, None
        if target is not None and matched is not None and matched != TOO_NEAR_ID:
            turn = world_from_estimate.rotation
            covariance_m2 = turn @ warnings[matched].covariance_m2 @ turn.T
            camera_m = frame.world_from_camera.translation_m
            error_m, nees = errors(target, positions_m[matched], covariance_m2, camera_m)
        return FrameScore(
            frame.t_ns,
            None if target is None else target.object.name,
            None if target is None else target.range_m,
            len(warnings),
            matched,
            bool(agreeing),
            error_m,
            nees,
            tuple(alarms),
            target is not None and target.nearest_depth_m < self._blind_depth_m,
            HIT_RANGE_M if target is None else target.asked_m,
            1 if target is not None and target.met else DIMENSIONS,
        )

    def _match(
        self, frame: FrameTruth, agreeing: list[int], positions_m: dict[int, Array], told: int | None
    ) -> int | None:
        """One of the warnings that agree with the target. Where the target is judged by the point at which it
        is met, the one that is reported as the nearest collision, `told`, goes first. Then comes that of the
        frame before, then the nearest to P, and one without a track only if there is no other."""
        tracks = [k for k in agreeing if k != TOO_NEAR_ID]
        if told in tracks and frame.target is not None and frame.target.met:
            self._matched = told
            return told
        if not agreeing or self._matched in tracks:
            return self._matched if agreeing else None
        if not tracks or frame.target is None:
            return TOO_NEAR_ID
        reference_m = frame.target.reference_m
        self._matched = min(tracks, key=lambda k: float(np.linalg.norm(positions_m[k] - reference_m)))
        return self._matched

    def _was_there(self, frame: FrameTruth, obstacle: Obstacle, position_m: Array, range_m: float) -> bool:
        """It lies outside the image, where the exact disparity map of an earlier frame had a surface."""
        x_px, y_px, _ = project(self._truth, frame.world_from_camera, position_m)
        cu, cv = self._truth.center_px
        if abs(x_px) <= cu + 0.5 and abs(y_px) <= cv + 0.5:
            return False
        reach_m = tolerance_m(self._truth, self._rules, range_m) + 0.5 * max(obstacle.extent_m)
        return bool(np.any(np.linalg.norm(self._earlier_m - position_m, axis=1) <= reach_m))


def tells_of_target(truth: FlightTruth, rules: Rules, place: Warned, frame: FrameTruth) -> bool:
    """Something that is judged by where the path meets it has to be told at that range."""
    target = frame.target
    if target is None or not agrees(truth, rules, place, frame.of_target):
        return False
    return not target.met or right_distance(truth, rules, place, target.range_m)


def right_distance(truth: FlightTruth, rules: Rules, place: Warned, range_m: float) -> bool:
    tolerated_m = tolerance_m(truth, rules, place.range_m)
    beyond_m = range_m - place.range_m
    return beyond_m <= tolerated_m and (beyond_m >= -tolerated_m or place.up_to)


def tells_of_ground(truth: FlightTruth, rules: Rules, frame: FrameTruth, place: Warned) -> bool:
    met = [label for label, range_m in frame.ground_m.items() if right_distance(truth, rules, place, range_m)]
    inside = frame.around_path.where(frame.in_cylinder & np.isin(frame.around_path.label, met))
    return agrees(truth, rules, place, inside)


def false_alarms(
    truth: FlightTruth, rules: Rules, frame: FrameTruth, still_m: Array, shown: Shown, places: list[Warned]
) -> list[FalseAlarm]:
    suspects = [place for place in places if not agrees(truth, rules, place, frame.real)]
    if suspects:
        still = seen_from(truth, frame.world_from_camera, still_m)
        suspects = [
            place
            for place in suspects
            if not agrees(truth, rules, place, still) and not tells_of_ground(truth, rules, frame, place)
        ]
    if not suspects:
        return []
    everything = shown.by(frame)
    return [FalseAlarm(s.id, s.range_m, ghost=not agrees(truth, rules, s, everything)) for s in suspects]


@dataclass(frozen=True)
class Seen:
    """World points as one camera sees them, one an entry."""

    u_px: Array
    v_px: Array
    range_m: Array


def seen_from(truth: FlightTruth, world_from_camera: Pose, position_m: Array) -> Seen:
    """Those of the points, (n, 3) world, that lie before the camera."""
    x_px, y_px, depth_m = project(truth, world_from_camera, position_m)
    range_m = np.linalg.norm(position_m - world_from_camera.translation_m, axis=-1)
    ahead = depth_m > 0.0
    cu, cv = truth.center_px
    return Seen(cu + x_px[ahead], cv + y_px[ahead], range_m[ahead])


def agrees(truth: FlightTruth, rules: Rules, place: Warned, points: Points | Seen) -> bool:
    """Whether one of the points lies at the place's bearing and range."""
    here = between(points.u_px, place.u_px, max(place.half_u_px, BEARING_MARGIN_PX))
    here = here[between(points.v_px[here], place.v_px, max(place.half_v_px, BEARING_MARGIN_PX))]
    beyond_m = points.range_m[here] - place.range_m
    tolerated_m = tolerance_m(truth, rules, place.range_m)
    found: NDArray[np.bool_] = (beyond_m <= tolerated_m) & ((beyond_m >= -tolerated_m) | place.up_to)
    return bool(found.any())


def between(values: NDArray[Any], middle: float, half: float) -> NDArray[np.intp]:
    """Which of the values are at most `half` from the middle. Whole numbers are compared as such, which takes
    an eighth of the time."""
    low, high = middle - half, middle + half
    if not low <= high:  # not a number
        return np.zeros(0, np.intp)
    if values.dtype.kind == "i":
        least, most = np.iinfo(values.dtype).min, np.iinfo(values.dtype).max
        bounds = np.clip([np.ceil(low), np.floor(high)], least, most).astype(values.dtype)
        return np.flatnonzero((values >= bounds[0]) & (values <= bounds[1]))
    return np.flatnonzero((values >= low) & (values <= high))


def tolerance_m(truth: FlightTruth, rules: Rules, range_m: float) -> float:
    return rules.tolerance_m(float(truth.depth_of_one_disparity_m(range_m)))


def carried(world_from_estimate: Pose, position_m: Array) -> Array:
    return world_from_estimate.rotation @ position_m + world_from_estimate.translation_m


def project(truth: FlightTruth, world_from_camera: Pose, position_m: Array) -> tuple[Any, Any, Any]:
    """Pixels right of and below the principal point, and depth, of one position or of (n, 3)."""
    x, y, z = np.moveaxis((position_m - world_from_camera.translation_m) @ world_from_camera.rotation, -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return truth.focal_px * x / z, truth.focal_px * y / z, z


def place_of(truth: FlightTruth, frame: FrameTruth, obstacle: Obstacle, position_m: Array) -> Warned:
    x_px, y_px, depth_m = project(truth, frame.world_from_camera, position_m)
    half_u_px, half_v_px = 0.5 * truth.focal_px / depth_m * np.array(obstacle.extent_m)
    range_m = float(np.linalg.norm(position_m - frame.world_from_camera.translation_m))
    cu, cv = truth.center_px
    box = (cu + x_px, cv + y_px, float(half_u_px), float(half_v_px))
    return Warned(obstacle.id, *box, range_m, up_to=obstacle.id == TOO_NEAR_ID)


def errors(
    target: Target, position_m: Array, covariance_m2: Array, camera_m: Array
) -> tuple[float, float | None]:
    """|P - P^| in metres, and the NEES e^T P^-1 e; all in the true world. Where a thing is met is a point of
    its surface, and the covariance is that of its middle: they have the line of sight in common."""
    if target.surface_m is not None:
        return float(np.linalg.norm(target.surface_m - position_m, axis=1).min()), None
    error_m = position_m - target.reference_m
    size_m = float(np.linalg.norm(error_m))
    if target.met:
        sight = (target.reference_m - camera_m) / target.range_m
        return size_m, float((sight @ error_m) ** 2 / (sight @ covariance_m2 @ sight))
    return size_m, float(error_m @ np.linalg.solve(covariance_m2, error_m))
