"""A synthetic flight of any size on which the host is timed: textured ground and boards under a bare sky.

Boards stand at random up to 90 m ahead; the camera flies level along z (x right, y down, z forward). It is
drawn by resampling noise: no picture of anything, but with ground, depth steps and gaps in the disparity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.geometry import Calibration, Pose
from vista.sequence import Frame

BASELINE_M, CAMERA_HEIGHT_M = 0.5, 4.0
SPEED_M_S, PERIOD_NS = 9.0, 100_000_000
BOARDS, FARTHEST_M = 40, 90.0
TEXELS = 512
TEXEL_M = (0.03, 0.4)  # of the ground near by and far away
FAR_M = 25.0  # where both count the same
SKY, NOISE_GREY = 205.0, 1.5

Image = NDArray[np.float32]


@dataclass(frozen=True)
class Board:
    """Faces the camera; edges in metres of the world."""

    left_m: float
    right_m: float
    top_m: float
    bottom_m: float
    z_m: float
    texture: Image
    texel_m: float


def calibration(width_px: int, height_px: int) -> Calibration:
    """A field of view of 53 degrees, whatever the size."""
    return Calibration(
        width_px, height_px, float(width_px), (width_px - 1) / 2, (height_px - 1) / 2, BASELINE_M
    )


def synthetic_frames(width_px: int, height_px: int, frames: int, seed: int) -> Iterator[Frame]:
    rng = np.random.default_rng(seed)
    camera = calibration(width_px, height_px)
    ground = [_noise(rng, 105.0, 60.0) for _ in TEXEL_M]
    boards = sorted((_board(rng) for _ in range(BOARDS)), key=lambda board: -board.z_m)
    for index in range(frames):
        z_m = SPEED_M_S * index * PERIOD_NS / 1e9
        views = []
        for x_m in (0.0, BASELINE_M):
            image = _draw(camera, ground, boards, x_m, z_m) + rng.normal(0, NOISE_GREY, (height_px, width_px))
            views.append(np.clip(image, 0, 255).astype(np.uint8))
        pose = Pose(np.eye(3), np.array([0.0, 0.0, z_m]))
        yield Frame(index, (index + 1) * PERIOD_NS, views[0], views[1], pose)


def _noise(rng: np.random.Generator, mean: float, spread: float) -> Image:
    """Grain of several sizes; repeats without a seam."""
    total = np.zeros((TEXELS, TEXELS))
    for sigma in (1, 3, 9):
        grain = np.pad(rng.normal(size=(TEXELS, TEXELS)), 3 * sigma, mode="wrap")
        inner = slice(3 * sigma, 3 * sigma + TEXELS)
        smooth = cv2.GaussianBlur(grain, (0, 0), sigma)[inner, inner]
        total += smooth / smooth.std()
    return (mean + spread * total / (3 * total.std())).astype(np.float32)


def _board(rng: np.random.Generator) -> Board:
    """Posts, signs, bushes, house fronts: narrow to wide, standing on the ground or above it."""
    z_m = float(rng.uniform(12.0, FARTHEST_M))
    x_m = float(rng.uniform(-0.5, 0.5) * z_m * 1.1)
    width_m, height_m = float(rng.choice([0.3, 1.0, 3.0, 8.0])), float(rng.uniform(0.8, 9.0))
    foot_m = CAMERA_HEIGHT_M - float(rng.choice([0.0, 0.0, 0.0, 1.5]))
    texture = _noise(rng, float(rng.uniform(50, 170)), float(rng.choice([6.0, 45.0])))
    return Board(
        x_m - width_m / 2, x_m + width_m / 2, foot_m - height_m, foot_m, z_m, texture, rng.uniform(0.01, 0.05)
    )


def _draw(camera: Calibration, ground: list[Image], boards: list[Board], x_m: float, z_m: float) -> Image:
    """What a camera at (x, 0, z) sees, far things first."""
    image = np.full((camera.height, camera.width), SKY, np.float32)
    u = np.arange(camera.width, dtype=np.float32)
    first = int(np.floor(camera.cy)) + 2
    v = np.arange(first, camera.height, dtype=np.float32)
    ahead_m = camera.focal_px * CAMERA_HEIGHT_M / (v - camera.cy)
    across_m = x_m + (u[None, :] - camera.cx) / camera.focal_px * ahead_m[:, None]
    along_m = np.broadcast_to((ahead_m + z_m)[:, None], across_m.shape)
    near, far = (
        _sample(texture, across_m / texel_m, along_m / texel_m)
        for texture, texel_m in zip(ground, TEXEL_M, strict=True)
    )
    weight = (1.0 / (1.0 + (ahead_m / FAR_M) ** 2))[:, None]
    image[first:] = weight * near + (1 - weight) * far
    for board in boards:
        _draw_board(image, camera, board, x_m, board.z_m - z_m)
    return image


def _draw_board(image: Image, camera: Calibration, board: Board, x_m: float, ahead_m: float) -> None:
    if ahead_m < 1.0:
        return
    scale = camera.focal_px / ahead_m
    sides = (
        camera.cx + scale * (board.left_m - x_m),
        camera.cx + scale * (board.right_m - x_m),
        camera.cy + scale * board.top_m,
        camera.cy + scale * board.bottom_m,
    )
    u0, u1 = (int(np.clip(np.ceil(side), 0, camera.width)) for side in sides[:2])
    v0, v1 = (int(np.clip(np.ceil(side), 0, camera.height)) for side in sides[2:])
    if u0 >= u1 or v0 >= v1:
        return
    u, v = np.meshgrid(np.arange(u0, u1), np.arange(v0, v1))
    texels_px = 1.0 / (scale * board.texel_m)
    image[v0:v1, u0:u1] = _sample(board.texture, (u - sides[0]) * texels_px, (v - sides[2]) * texels_px)


def _sample(texture: Image, x: NDArray, y: NDArray) -> Image:
    """Bilinear, periodic."""
    x, y = (np.mod(a, TEXELS).astype(np.float32) for a in (x, y))
    return np.asarray(cv2.remap(texture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP), np.float32)
