"""A stand-in for the host's pipeline: made-up regions and obstacles on a grid of square cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array, Calibration, Pose
from vista.pipeline import (
    ID_GROUND,
    ID_TOO_NEAR,
    Ellipse,
    Health,
    Motion,
    Nearest,
    Obstacle,
    Result,
)

CELL_PX = 10
STILL = Pose(np.eye(3), np.zeros(3))


def fake_obstacle(track_id: int, z_m: float, camera: Calibration, **changes: object) -> Obstacle:
    """Stands 0.8 m to the right for each id, z_m ahead."""
    x_m = 0.8 * (track_id - 2)
    size_px = camera.focal_px / z_m
    values = {
        "id": track_id,
        "confirmed": True,
        "age_frames": 5,
        "coasting": False,
        "position_m": np.array([x_m, 0.0, z_m]),
        "covariance_m2": np.diag([0.01, 0.01, 0.5]),
        "distance_m": float(np.hypot(x_m, z_m)),
        "in_blind_zone": False,
        "world": "STANDS",
        "extent_m": (1.0, 2.0),
        "ellipse": Ellipse(camera.cx + x_m * size_px, camera.cy, 0.9 * size_px, 0.4 * size_px, 80.0),
        "disparity_px": camera.baseline_m * size_px,
        "in_collision_volume": False,
    }
    return Obstacle(**(values | changes))


def fake_ground(camera: Calibration, z_m: float, **changes: object) -> Obstacle:
    values = {"kind": "ground", "in_collision_volume": True}
    return fake_obstacle(ID_GROUND, z_m, camera, **(values | changes))


def fake_too_near(camera: Calibration) -> Obstacle:
    return fake_obstacle(ID_TOO_NEAR, 1.0, camera, kind="too_near", in_blind_zone=True)


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
        nearest = Nearest(2, obstacles[1].position_m, z_m, z_m / 10.0, np.eye(3)) if self._frame > 1 else None
        source = "UNTOLD" if pose is None else "POSE"
        velocity_m_s = np.array([0.0, 0.0, 10.0])
        motion = Motion(pose is not None, source, False, velocity_m_s, np.zeros(3), pose or STILL)
        stage_ms = {
            "foveation": 1.0,
            "segmentation": 4.0 + 0.1 * self._frame,
            "host": 5.0 + 0.1 * self._frame,
        }
        verdicts = [("ACCEPTED", "TOO_SMALL", "HORIZONTAL")[region % 3] for region in range(regions)]
        return Result(
            obstacles=obstacles,
            nearest_collision=nearest,
            path_seen_m=z_m,
            motion=motion,
            health=Health("healthy", (), (), float(np.mean(words >= 0)), 50.0),
            regions=regions,
            valid_fraction=float(np.mean(words >= 0)),
            dropped_tracks=2,
            stage_ms=stage_ms,
            cell_of_pixel=cell_of_pixel,
            cell_intensity=intensity.astype(np.float32),
            cell_disparity_px=np.full(rows * columns, -1.0, np.float32),
            region_of_cell=region_of_cell,
            region_of_pixel=region_of_cell[cell_of_pixel],
            verdict_of_region=verdicts,
            words=words,
        )


class DescendingPipeline(FakePipeline):
    """The same with something too near to match, and with the ground: the flight path meets it from the third
    frame on."""

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
        return replace(result, obstacles=[*result.obstacles, ground, fake_too_near(self._camera)])
