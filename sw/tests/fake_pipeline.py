"""A stand-in for the host's pipeline: made-up regions and obstacles on a grid of square cells."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vista.detector import Detector
from vista.geometry import Array, Calibration, Pose
from vista.health.finding import Finding, FrameHealth
from vista.history import FrameRecord
from vista.pipeline import (
    ID_GROUND,
    ID_PLACE,
    ID_TOO_NEAR,
    Directions,
    Ellipse,
    Health,
    Motion,
    Nearest,
    Obstacle,
    Outcome,
    Pictures,
    Result,
)
from vista.rectify import Rectifier
from vista.structs import dtype_of, names_of

CELL_PX = 10
VERDICTS = ("ACCEPTED", "TOO_SMALL", "HORIZONTAL")


def fake_obstacle(track_id: int, z_m: float, camera: Calibration, **changes: object) -> Obstacle:
    """Stands 0.8 m to the right for each id, z_m ahead."""
    x_m = 0.8 * (track_id - 2)
    size_px = camera.focal_px / z_m
    values = {
        "id": track_id,
        "confirmed": True,
        "age_frames": 5,
        "position_m": (x_m, 0.0, z_m),
        "covariance_m2": np.diag([0.01, 0.01, 0.5]),
        "distance_m": np.hypot(x_m, z_m),
        "world": "STANDS",
        "extent_m": (1.0, 2.0),
        "ellipse": fake_ellipse(camera.cx + x_m * size_px, camera.cy, 0.9 * size_px, 0.4 * size_px, 80.0),
        "disparity_px": camera.baseline_m * size_px,
    }
    return Obstacle.made(**(values | changes))


def fake_ellipse(*members: float) -> Ellipse:
    """The members in the order of vista_ellipse."""
    names = dtype_of(Ellipse.NAME).names or ()
    return Ellipse.made(**dict(zip(names, members, strict=True)))


def fake_ground(camera: Calibration, z_m: float, **changes: object) -> Obstacle:
    values = {"kind": "ground", "in_collision_volume": True}
    return fake_obstacle(ID_GROUND, z_m, camera, **(values | changes))


def fake_too_near(camera: Calibration) -> Obstacle:
    return fake_obstacle(ID_TOO_NEAR, 1.0, camera, kind="too_near", in_blind_zone=True)


def fake_place(camera: Calibration, z_m: float) -> Obstacle:
    return fake_obstacle(ID_PLACE, z_m, camera, kind="place", world="OPEN", in_collision_volume=True)


def fake_nearest(obstacle: Obstacle, time_s: float | None = None, **changes: object) -> Nearest:
    """The obstacle as the nearest collision."""
    values = {name: getattr(obstacle, name) for name in ("id", "position_m", "covariance_m2", "distance_m")}
    seconds = np.nan if time_s is None else time_s
    return Nearest.made(**{"valid": True, "time_to_collision_s": seconds} | values | changes)


def fake_motion(pose: Pose | None = None, velocity_m_s: Array | None = None, known: bool = False) -> Motion:
    """The own motion with the source POSE, or UNTOLD without one."""
    placed = Motion.made(known=known, source="UNTOLD" if pose is None else "POSE")
    at = pose or Pose()
    placed.memory["pose"]["rotation"], placed.memory["pose"]["translation_m"] = at.rotation, at.translation_m
    return placed if velocity_m_s is None else placed.but(velocity_known=True, velocity_m_s=velocity_m_s)


def items_of(obstacles: Sequence[Obstacle]) -> NDArray[np.void]:
    """The obstacles in one array, as a result has them."""
    items = np.zeros(len(obstacles), dtype_of(Obstacle.NAME))
    for k, obstacle in enumerate(obstacles):
        items[k] = obstacle.memory
    return items


def fake_outcome(
    obstacles: Sequence[Obstacle],
    nearest: Nearest | None = None,
    motion: Motion | None = None,
    **members: Any,
) -> Outcome:
    size = dtype_of(Obstacle.NAME).itemsize
    parts = {"nearest_collision": nearest or Nearest.made(), "motion": motion or fake_motion()}
    return Outcome.made(obstacle_count=len(obstacles), obstacle_bytes=size, **parts | members)


def fake_record(
    index: int,
    t_ns: int,
    obstacles: Sequence[Obstacle] = (),
    nearest: Nearest | None = None,
    motion: Motion | None = None,
    directions: Directions | None = None,
    stage_ms: dict[str, float] | None = None,
    health: FrameHealth | None = None,
    **members: Any,
) -> FrameRecord:
    outcome = fake_outcome(obstacles, nearest, motion, **members)
    times = {"host": 1.0} if stage_ms is None else stage_ms
    seen = FrameHealth() if health is None else health
    return FrameRecord(outcome, items_of(obstacles), directions, times, index=index, t_ns=t_ns, health=seen)


class FakePictures(Pictures):
    """Pictures that are arrays already."""

    def __init__(self, **arrays: NDArray[Any]) -> None:
        self._arrays = arrays

    def of_pixels(self, name: str, dtype: Any) -> NDArray[Any]:
        return self._arrays[name]

    of_cells = of_regions = of_pixels


class FakePipeline:
    """Four tracks: one coasts, one warns, one is confirmed, one is not. They come 1 m nearer each frame."""

    def __init__(self, camera: Calibration, parameters: object = None) -> None:
        self._camera = camera
        self._frame = 0

    def reset(self) -> None:
        pass

    def process(
        self,
        left: NDArray[np.uint8],
        disparity: NDArray[np.int16] | list[NDArray[np.int16]],
        t_ns: int,
        pose: Pose | None,
        up_world: Array | None,
    ) -> Result:
        camera, words = self._camera, disparity if isinstance(disparity, np.ndarray) else disparity[0]
        rows, columns = (side // CELL_PX for side in left.shape)
        v, u = np.mgrid[: left.shape[0], : left.shape[1]] // CELL_PX
        cell_of_pixel = (np.minimum(v, rows - 1) * columns + np.minimum(u, columns - 1)).astype(np.int32)
        pixels = np.bincount(cell_of_pixel.ravel())
        intensity = np.bincount(cell_of_pixel.ravel(), left.ravel()) / pixels
        region_of_cell = (np.arange(rows * columns) % columns // max(columns // 5, 1)).astype(np.int32)
        regions = int(region_of_cell.max()) + 1

        z_m = max(20.0 - self._frame, 1.0)
        self._frame += 1
        obstacles = [
            fake_obstacle(1, z_m + 12.0, camera, coasting=True),
            fake_obstacle(2, z_m, camera, in_collision_volume=True),
            fake_obstacle(3, z_m + 5.0, camera),
            fake_obstacle(4, z_m + 8.0, camera, confirmed=False),
        ]
        nearest = fake_nearest(obstacles[1], z_m / 10.0, distance_m=z_m, covariance_m2=np.eye(3))
        motion = fake_motion(pose, np.array([0.0, 0.0, 10.0]), known=pose is not None)
        stage_ms = {
            "foveation": 1.0,
            "segmentation": 4.0 + 0.1 * self._frame,
            "host": 5.0 + 0.1 * self._frame,
        }
        verdict_of_region = np.array(
            [names_of("region_verdict").index(VERDICTS[region % 3]) for region in range(regions)]
        )
        outcome = fake_outcome(
            obstacles,
            nearest if self._frame > 1 else None,
            motion,
            path_seen_m=z_m,
            region_count=regions,
            valid_fraction=float(np.mean(words >= 0)),
            health=Health.made(matched_fraction=float(np.mean(words >= 0)), contrast=50.0),
            dropped_tracks=2,
            host_ms=stage_ms["host"],
        )
        return Result(
            outcome,
            items_of(obstacles),
            None,
            stage_ms,
            FakePictures(
                cell_of_pixel=cell_of_pixel,
                cell_intensity=intensity.astype(np.float32),
                cell_disparity_px=np.full(rows * columns, -1.0, np.float32),
                region_of_cell=region_of_cell,
                region_of_pixel=region_of_cell[cell_of_pixel],
                verdict_of_region=verdict_of_region,
                words=words,
            ),
        )


class DescendingPipeline(FakePipeline):
    """The same with something too near to match, a place without a track, and the ground: the flight path
    meets it from the third frame on."""

    def process(
        self,
        left: NDArray[np.uint8],
        disparity: NDArray[np.int16] | list[NDArray[np.int16]],
        t_ns: int,
        pose: Pose | None,
        up_world: Array | None,
    ) -> Result:
        result = super().process(left, disparity, t_ns, pose, up_world)
        ground = fake_ground(self._camera, 9.0, in_collision_volume=self._frame > 2)
        obstacles = [*result.obstacles, ground, fake_too_near(self._camera), fake_place(self._camera, 30.0)]
        outcome = result.outcome.but(obstacle_count=len(obstacles))
        return replace(result, outcome=outcome, items=items_of(obstacles))


class FakeDetector(Detector):
    """The detector with results that are made up; what it says of the images is its own."""

    pipeline: type[FakePipeline] = FakePipeline

    def __init__(self, rectifier: Rectifier, *options: Any, **more: Any) -> None:
        super().__init__(rectifier, *options, **more)
        self._fake = self.pipeline(rectifier.calibration)

    def judge(self, pose: Pose | None, up_world: Array | None, anew: bool = False) -> Result:
        super().judge(pose, up_world, anew)
        return self._fake.process(self.pair().left, self.pair().levels, 0, pose, up_world)

    def findings(self, besides: Iterable[Finding] = ()) -> tuple[Finding, ...]:
        found = super().findings(besides)
        of_pipeline = Outcome.copied(self._ffi, self._ffi.addressof(self._found, "result")).health.texts
        return tuple(finding for finding in found if finding.text not in of_pipeline)


class DescendingDetector(FakeDetector):
    pipeline = DescendingPipeline
