"""A synthetic flight: a textured board that stands on textured ground, rendered with exact disparity words.

The world is x east (the way of flight), y north, z up; the camera looks along x and flies level and straight.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from vista.engine import INVALID

WIDTH, HEIGHT = 320, 240
FOCAL_PX, BASELINE_M = 300.0, 0.5
CX, CY = 161.3, 118.6
DISPARITY_MAX_PX, BLOCK_RADIUS_PX = 63, 5  # of the default engine
CAMERA_HEIGHT_M = 4.0
BOARD_X_M, BOARD_Y_M = 30.0, (-0.9, 1.5)  # range of y
BOARD_Z_M = (0.0, 5.0)
SPEED_M_S, PERIOD_NS, FRAMES = 10.0, 100_000_000, 16
START_X_M = 4.0
START_NS = 1_700_000_000_000_000_000
WORLD_FROM_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
UP_WORLD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class BoardFrame:
    left: NDArray[np.uint8]
    words: NDArray[np.int16]
    t_ns: int
    position_m: NDArray[np.float64]  # of the camera in world

    @property
    def board_distance_m(self) -> float:
        """The distance from the camera to the board's plane, along the flight."""
        return BOARD_X_M - float(self.position_m[0])


def board_center_m() -> NDArray[np.float64]:
    return np.array([BOARD_X_M, np.mean(BOARD_Y_M), np.mean(BOARD_Z_M)])


def _texture(a_m: NDArray[np.float64], b_m: NDArray[np.float64], mean: float) -> NDArray[np.float64]:
    """Waves that do not repeat over the scene, +-30 grey levels."""
    waves = [np.sin(k * (a_m * np.cos(k) + b_m * np.sin(k)) + k * k) for k in (1.7, 2.9, 4.3, 6.1, 8.9)]
    return mean + 30.0 * np.sum(waves, axis=0) / len(waves)


def render(index: int, with_board: bool = True, with_ground: bool = True) -> BoardFrame:
    position = np.array([START_X_M + SPEED_M_S * index * PERIOD_NS / 1e9, 0.3, CAMERA_HEIGHT_M])
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    rays = np.stack([(u - CX) / FOCAL_PX, (v - CY) / FOCAL_PX, np.ones(u.shape)], -1) @ WORLD_FROM_CAMERA.T

    depth_m = np.full(u.shape, np.inf)
    grey = np.full(u.shape, 200.0)  # sky: no texture, no disparity
    if with_ground:
        down = rays[..., 2] < -1e-3
        ground_m = np.where(down, CAMERA_HEIGHT_M / np.where(down, -rays[..., 2], 1.0), np.inf)
        down &= ground_m < 120.0
        depth_m[down] = ground_m[down]
        x, y = (position[k] + np.where(down, ground_m, 0.0) * rays[..., k] for k in range(2))
        grey = np.where(down, _texture(x, y, 90.0), grey)
    if with_board:
        board_m = BOARD_X_M - position[0]
        y, z = (position[k] + board_m * rays[..., k] for k in (1, 2))
        on_board = (y > BOARD_Y_M[0]) & (y < BOARD_Y_M[1]) & (z > BOARD_Z_M[0]) & (z < BOARD_Z_M[1])
        depth_m[on_board] = board_m
        grey = np.where(on_board, _texture(3 * y, 3 * z, 150.0), grey)

    words = np.rint(16.0 * FOCAL_PX * BASELINE_M / depth_m).astype(np.int16)
    margin = BLOCK_RADIUS_PX
    matched = (u >= DISPARITY_MAX_PX + margin) & (u < WIDTH - margin) & (v >= margin) & (v < HEIGHT - margin)
    words[~matched | ~np.isfinite(depth_m) | (words > 16 * DISPARITY_MAX_PX)] = INVALID
    return BoardFrame(grey.astype(np.uint8), words, START_NS + index * PERIOD_NS, position)


@functools.cache
def board_flight() -> tuple[BoardFrame, ...]:
    return tuple(render(index) for index in range(FRAMES))
