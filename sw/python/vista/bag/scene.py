"""Obstacles as entities of a scene of Foxglove: a box, the ellipsoid of one sigma, a label, and figures."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from vista.bag.foxglove import PACKAGE, SCENE_UPDATE
from vista.bag.types import Messages
from vista.geometry import Array, Pose, turned
from vista.history import FrameRecord
from vista.pipeline import Nearest, Obstacle
from vista.report.labels import obstacle_name

RED, YELLOW, WHITE = (1.0, 0.2, 0.2), (1.0, 0.85, 0.1), (1.0, 1.0, 1.0)
BOX_DEPTH_M = 0.3  # an obstacle is a board that faces the camera
LEAST_M = 0.05  # what is thinner is not to be seen
NEAREST = "nearest collision"


@dataclass(frozen=True)
class Board:
    """How an obstacle is drawn, in the frame of reference of the camera."""

    obstacle: Obstacle
    position_m: Array  # of its centre
    size_m: tuple[float, float, float]
    colour: tuple[float, float, float]
    text: str
    text_position_m: Array  # above it


def boards(record: FrameRecord) -> list[Board]:
    """Makes a board for each confirmed obstacle."""
    camera_from_world = (record.world_from_camera or Pose()).inverse()
    return [
        _board(obstacle, camera_from_world)
        for obstacle in record.obstacles
        if obstacle.confirmed and np.all(np.isfinite(obstacle.position_m))
    ]


def _board(obstacle: Obstacle, camera_from_world: Pose) -> Board:
    position_m = camera_from_world.apply(obstacle.position_m)
    width_m, height_m = (max(extent_m, LEAST_M) for extent_m in obstacle.extent_m)
    return Board(
        obstacle,
        position_m,
        (width_m, height_m, BOX_DEPTH_M),
        RED if obstacle.in_collision_volume else YELLOW,
        f"{obstacle_name(obstacle.id)} {obstacle.distance_m:.1f} m",
        position_m - (0.0, 0.5 * height_m + 0.3, 0.0),
    )


class Scene:
    """Updates from frame to frame: what is no longer there is deleted."""

    def __init__(self, messages: Messages) -> None:
        self._messages = messages
        self._shown: set[str] = set()

    def update(self, record: FrameRecord) -> Any:
        """Confirmed obstacles in the frame of reference of the camera, and what is met first."""
        camera_from_world = (record.world_from_camera or Pose()).inverse()
        entities = [self._entity(record.t_ns, board, camera_from_world) for board in boards(record)]
        nearest = record.nearest_collision
        if nearest is not None and np.all(np.isfinite(nearest.position_m)):
            entities.append(self._nearest(record.t_ns, nearest, camera_from_world))
        shown = {entity.id for entity in entities}
        deletions = [
            self._messages.make(
                f"{PACKAGE}SceneEntityDeletion", timestamp=self._messages.time(record.t_ns), type=0, id=name
            )
            for name in sorted(self._shown - shown)
        ]
        self._shown = shown
        return self._messages.make(SCENE_UPDATE, deletions=deletions, entities=entities)

    def _entity(self, t_ns: int, board: Board, camera_from_world: Pose) -> Any:
        obstacle = board.obstacle
        covariance_m2 = turned(obstacle.covariance_m2, camera_from_world)
        figures = {
            "id": obstacle.id,
            "kind": obstacle.kind,
            "distance_m": round(obstacle.distance_m, 3),
            "in_collision_volume": obstacle.in_collision_volume,
            "coasting": obstacle.coasting,
            "age_frames": obstacle.age_frames,
            "covariance_m2": np.round(covariance_m2, 6).ravel().tolist(),
        }
        return self._make(
            t_ns,
            obstacle_name(obstacle.id),
            figures,
            cubes=[self._cube(board.position_m, board.size_m, board.colour)],
            spheres=self._ellipsoid(board.position_m, covariance_m2, board.colour),
            texts=[self._text(board.text_position_m, board.text)],
        )

    def _nearest(self, t_ns: int, nearest: Nearest, camera_from_world: Pose) -> Any:
        position_m = camera_from_world.apply(nearest.position_m)
        covariance_m2 = turned(nearest.covariance_m2, camera_from_world)
        time_s = nearest.time_to_collision_s
        figures = {
            "id": nearest.id,
            "distance_m": round(nearest.distance_m, 3),
            "time_to_collision_s": None if time_s is None else round(time_s, 2),
            "covariance_m2": np.round(covariance_m2, 6).ravel().tolist(),
        }
        when = "" if time_s is None else f", {time_s:.1f} s"
        return self._make(
            t_ns,
            NEAREST,
            figures,
            spheres=self._ellipsoid(position_m, covariance_m2, RED),
            texts=[self._text(position_m, f"{nearest.distance_m:.1f} m{when}")],
        )

    def _make(self, t_ns: int, name: str, figures: dict[str, Any], **primitives: list[Any]) -> Any:
        kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
        metadata = [
            self._messages.make(f"{PACKAGE}KeyValuePair", key=key, value=json.dumps(value))
            for key, value in figures.items()
        ]
        return self._messages.make(
            f"{PACKAGE}SceneEntity",
            timestamp=self._messages.time(t_ns),
            frame_id=self._messages.camera_frame,
            id=name,
            lifetime=self._messages.make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
            frame_locked=True,
            metadata=metadata,
            **{kind: primitives.get(kind, []) for kind in kinds},
        )

    def _cube(self, position_m: Array, size_m: tuple[float, ...], colour: tuple[float, float, float]) -> Any:
        pose, size = self._messages.pose(position_m), self._messages.vector(size_m)
        return self._messages.make(
            f"{PACKAGE}CubePrimitive", pose=pose, size=size, color=self._colour(colour, 0.6)
        )

    def _ellipsoid(
        self, position_m: Array, covariance_m2: Array, colour: tuple[float, float, float]
    ) -> list[Any]:
        """Makes the ellipsoid of one sigma; none where there is no covariance."""
        if not np.all(np.isfinite(covariance_m2)):
            return []
        variances_m2, axes = np.linalg.eigh(covariance_m2)
        if np.linalg.det(axes) < 0.0:
            axes = -axes
        size_m = 2.0 * np.sqrt(np.maximum(variances_m2, 0.0))
        return [
            self._messages.make(
                f"{PACKAGE}SpherePrimitive",
                pose=self._messages.pose(position_m, axes),
                size=self._messages.vector(np.maximum(size_m, LEAST_M)),
                color=self._colour(colour, 0.25),
            )
        ]

    def _text(self, position_m: Array, text: str) -> Any:
        return self._messages.make(
            f"{PACKAGE}TextPrimitive",
            pose=self._messages.pose(position_m),
            billboard=True,
            font_size=14.0,
            scale_invariant=True,
            color=self._colour(WHITE, 1.0),
            text=text,
        )

    def _colour(self, rgb: tuple[float, float, float], alpha: float) -> Any:
        r, g, b = rgb
        return self._messages.make(f"{PACKAGE}Color", r=r, g=g, b=b, a=alpha)
