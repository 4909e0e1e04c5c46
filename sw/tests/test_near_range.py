"""Depth down to 2 m: a textured board before a textured wall, seen by the camera of the flights."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from vista import parameters
from vista.chain import engine_parameters
from vista.engine import SCALE, create_engine
from vista.geometry import Calibration
from vista.pipeline import Pipeline, Result
from vista_eval.render.rig import PAPER_RIG

RIG = PAPER_RIG
CAMERA = Calibration(RIG.width_px, RIG.height_px, RIG.focal_px, *RIG.center_px, RIG.baseline_m)
WALL_M = 30.0
BOARD_M = (1.6, 1.2)  # width, height


def texture(random: np.random.Generator, height: int, width: int) -> np.ndarray:
    """A texture of all scales, so that every level finds something."""
    layers = [
        cv2.resize(random.random((height >> k, width >> k)), (width, height), interpolation=cv2.INTER_CUBIC)
        for k in range(6)
    ]
    return sum(2.0**k * layer for k, layer in enumerate(layers)) / 63.0


def shifted(image: np.ndarray, disparity_px: float) -> np.ndarray:
    """What lies at u in `image` lies at u - disparity_px in the result."""
    height, width = image.shape
    u, v = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    return cv2.remap(
        image.astype(np.float32),
        u + np.float32(disparity_px),
        v,
        cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REFLECT,
    )


def pair(distance_m: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both images, and which pixels of the left one show the board."""
    camera, random = CAMERA, np.random.default_rng(seed)
    height, width, scale = camera.height, camera.width, camera.focal_px * camera.baseline_m
    layers = [texture(random, height, width) for _ in range(2)]
    half_px = [camera.focal_px * side / distance_m / 2 for side in BOARD_M]
    on_board = np.zeros((height, width), np.float32)
    rows = slice(max(round(camera.cy - half_px[1]), 0), round(camera.cy + half_px[1]))
    left_px = camera.cx - half_px[0] + scale / distance_m / 2  # so that both cameras see it
    on_board[rows, max(round(left_px), 0) : round(left_px + 2 * half_px[0])] = 1.0
    images = []
    for share in (0.0, 1.0):
        wall, board, mask = (
            shifted(layer, share * scale / z_m)
            for layer, z_m in ((layers[0], WALL_M), (layers[1], distance_m), (on_board, distance_m))
        )
        seen = np.where(mask > 0.5, board, wall)
        images.append(np.clip(20 + 215 * seen + random.normal(0, 1, seen.shape), 0, 255).astype(np.uint8))
    return images[0], images[1], on_board > 0.5


def run(distance_m: float, levels: int) -> tuple[Result, np.ndarray]:
    values = parameters.defaults()
    values["stereo"]["levels"] = levels
    values["tracker"] |= {"confirm_hits": 1, "confirm_window": 1}
    left, right, board = pair(distance_m, seed=int(10 * distance_m))
    engine = create_engine("golden", engine_parameters(values))
    return Pipeline(CAMERA, values).process(left, list(engine.levels(left, right)), 0), board


@pytest.mark.parametrize("distance_m", [2.0, 3.0, 4.0, 5.0, 8.0])
def test_a_board_is_measured_down_to_two_metres(distance_m: float) -> None:
    result, board = run(distance_m, 3)
    truth_px = CAMERA.focal_px * CAMERA.baseline_m / distance_m
    level = next(k for k in range(3) if truth_px <= 63 << k)
    margin_px, rim_px = 5 << level, 12 << level  # what the level cannot match, and what an edge disturbs
    inside = cv2.erode(board.astype(np.uint8), np.ones((2 * rim_px + 1,) * 2), borderValue=1) > 0
    inside[: margin_px + rim_px], inside[-margin_px - rim_px :], inside[:, -margin_px - rim_px :] = 0, 0, 0
    inside[:, : (63 << level) + margin_px + rim_px] = 0
    found = result.words[inside]
    right = np.abs(found / SCALE - truth_px) < 0.03 * truth_px
    print(f"{distance_m} m: {truth_px:.1f} px, {right.mean():.3f} right, {np.mean(found >= 0):.3f} found")
    assert right.mean() > 0.95 and right.sum() > 0.99 * np.sum(found >= 0)


@pytest.mark.parametrize("distance_m", [2.0, 4.0])
def test_one_level_does_not_see_that_near(distance_m: float) -> None:
    result, board = run(distance_m, 1)
    truth_px = CAMERA.focal_px * CAMERA.baseline_m / distance_m
    assert np.mean(np.abs(result.words[board] / SCALE - truth_px) < 0.03 * truth_px) == 0.0
