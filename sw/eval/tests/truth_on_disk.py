"""The truth of a flight on disk without any pictures: simple surfaces, seen from poses of any kind.

World x ahead, y left, z up. A surface tells how far along rays from a point it is met; its label is its
number."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from vista.geometry import Pose

WIDTH, HEIGHT = 320, 240
FOCAL_PX, BASELINE_M = 500.0, 0.4572
CENTER_PX = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
RATE_HZ = 10.0
LEVEL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # looks along x

Distance = Callable[
    [np.ndarray, np.ndarray, float], np.ndarray
]  # of origin, unit rays (n, 3), time: inf: not met


@dataclass(frozen=True)
class Surface:
    name: str
    distance: Distance
    standing: bool = True
    target: bool = True
    center_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    extent_m: tuple[float, float] = (100.0, 100.0)
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)


def plane(point_m: np.ndarray, normal: np.ndarray) -> Distance:
    def distance(origin_m: np.ndarray, rays: np.ndarray, _: float) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            along_m = ((point_m - origin_m) @ normal) / (rays @ normal)
        return np.where(along_m > 0.0, along_m, np.inf)

    return distance


def wire(point_m: np.ndarray, direction: np.ndarray, radius_m: float) -> Distance:
    """A round bar without end."""

    def distance(origin_m: np.ndarray, rays: np.ndarray, _: float) -> np.ndarray:
        across = rays - np.outer(rays @ direction, direction)
        offset_m = origin_m - point_m - ((origin_m - point_m) @ direction) * direction
        a, b = np.einsum("ij,ij->i", across, across), across @ offset_m
        square = b**2 - a * (offset_m @ offset_m - radius_m**2)
        return np.where((square >= 0.0) & (b < 0.0), (-b - np.sqrt(np.maximum(square, 0.0))) / a, np.inf)

    return distance


def ball(center_m: np.ndarray, velocity_m_s: np.ndarray, radius_m: float) -> Distance:
    def distance(origin_m: np.ndarray, rays: np.ndarray, time_s: float) -> np.ndarray:
        offset_m = origin_m - center_m - time_s * velocity_m_s
        b = rays @ offset_m
        square = b**2 - offset_m @ offset_m + radius_m**2
        return np.where((square >= 0.0) & (b < 0.0), -b - np.sqrt(np.maximum(square, 0.0)), np.inf)

    return distance


def straight(frames: int, start_m: np.ndarray, velocity_m_s: np.ndarray) -> list[Pose]:
    return [Pose(LEVEL, start_m + k / RATE_HZ * velocity_m_s) for k in range(frames)]


def turning(frames: int, radius_m: float, speed_m_s: float) -> list[Pose]:
    """A turn to the left on a level circle around (0, radius_m, 0), from the origin on; the camera looks
    ahead."""
    poses = []
    for k in range(frames):
        angle = k / RATE_HZ * speed_m_s / radius_m
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        poses.append(Pose(turn @ LEVEL, radius_m * np.array([s, 1.0 - c, 0.0])))
    return poses


def write_truth(
    folder: Path, poses: list[Pose], surfaces: tuple[Surface, ...], speed_m_s: float = 10.0
) -> Path:
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    cu, cv = CENTER_PX
    rays = np.stack([(u - cu) / FOCAL_PX, (v - cv) / FOCAL_PX, np.ones(u.shape)], axis=-1).reshape(-1, 3)
    length = np.linalg.norm(rays, axis=1)
    frames = []
    for k, pose in enumerate(poses):
        world = (rays / length[:, np.newaxis]) @ pose.rotation.T
        met_m = np.array([s.distance(pose.translation_m, world, k / RATE_HZ) for s in surfaces])
        label = np.where(np.isfinite(met_m.min(axis=0)), met_m.argmin(axis=0) + 1, 0)
        with np.errstate(divide="ignore"):
            disparity_px = FOCAL_PX * BASELINE_M * length / met_m.min(axis=0)
        t_ns = round(k * 1e9 / RATE_HZ)
        for kind, image in (
            ("disparity", np.clip(np.rint(256.0 * disparity_px), 0, 65535).astype(np.uint16)),
            ("label", label.astype(np.uint8)),
        ):
            path = folder / "truth" / kind / f"{t_ns}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(path), image.reshape(HEIGHT, WIDTH))
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = pose.rotation, pose.translation_m
        frames.append({"t_ns": t_ns, "objects": [], "world_from_camera": matrix.tolist()})
    objects = [
        {
            "label": number,
            "name": surface.name,
            "kind": surface.name,
            "standing": surface.standing,
            "target": surface.target,
            "position_m": surface.center_m,
            "velocity_m_s": surface.velocity_m_s,
            "extent_m": surface.extent_m,
        }
        for number, surface in enumerate(surfaces, start=1)
    ]
    content = {
        "version": 2,
        "name": folder.name,
        "title": f"{folder.name}, a test",
        "split": "dev",
        "family": "test",
        "rig": {"focal_px": FOCAL_PX, "baseline_m": BASELINE_M, "center_px": CENTER_PX},
        "speed_m_s": speed_m_s,
        "rate_hz": RATE_HZ,
        "objects": objects,
        "frames": frames,
    }
    (folder / "truth.json").write_text(json.dumps(content))
    return folder
