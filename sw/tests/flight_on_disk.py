"""A small flight on disk in the layout of the rendered ones: boards above a textured ground, exact truth.

World x ahead, y left, z up; the camera looks along x and flies level and straight at the board "sign".
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

WIDTH, HEIGHT = 320, 240
FOCAL_PX, BASELINE_M = 500.0, 0.4572
CU, CV = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
ALTITUDE_M, SPEED_M_S, RATE_HZ = 6.0, 10.0, 10.0
START_NS = 1_600_000_000_000_000_000
WORLD_FROM_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
GROUND = 1


@dataclass(frozen=True)
class Board:
    """Faces the camera."""

    name: str
    kind: str
    center_m: tuple[float, float, float]
    extent_m: tuple[float, float]  # width (y), height (z)
    target: bool = False


SIGN = Board("sign", "sign", (0.0, 0.0, ALTITUDE_M), (1.6, 1.2), target=True)
WALL = Board("wall", "facade", (6.0, -5.5, 4.0), (3.0, 8.0))  # beside the path


def camera_m(frame: int, frames: int, last_range_m: float) -> np.ndarray:
    """The place of the left camera; the last frame is last_range_m before x = 0."""
    x = -last_range_m - SPEED_M_S / RATE_HZ * (frames - 1 - frame)
    return np.array([x, 0.0, ALTITUDE_M])


def view(position_m: np.ndarray, boards: tuple[Board, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grey image, depth (inf = sky), label (0 = sky, 1 = ground, 2... = boards)."""
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    rays = np.stack([(u - CU) / FOCAL_PX, (v - CV) / FOCAL_PX, np.ones(u.shape)], -1) @ WORLD_FROM_CAMERA.T
    down = rays[..., 2] < -1e-3
    ground_m = np.where(down, position_m[2] / np.where(down, -rays[..., 2], 1.0), np.inf)
    down &= ground_m < 150.0
    depth = np.where(down, ground_m, np.inf)
    label = np.where(down, GROUND, 0)
    reach = np.where(down, ground_m, 0.0)
    grey = np.where(down, texture(position_m[0] + reach, position_m[1] + reach * rays[..., 1]), 210.0)
    for number, board in enumerate(boards, start=GROUND + 1):
        ahead_m = board.center_m[0] - position_m[0]
        y, z = (position_m[k] + ahead_m * rays[..., k] - board.center_m[k] for k in (1, 2))
        on = (np.abs(y) < board.extent_m[0] / 2) & (np.abs(z) < board.extent_m[1] / 2) & (ahead_m < depth)
        depth[on], label[on] = ahead_m, number
        grey = np.where(on, texture(5.0 * y, 5.0 * z) + 40.0, grey)
    return np.clip(grey, 0, 255).astype(np.uint8), depth, label


def texture(a_m: np.ndarray, b_m: np.ndarray) -> np.ndarray:
    waves = [np.sin(k * (a_m * np.cos(k) + b_m * np.sin(k)) + k * k) for k in (1.7, 2.9, 4.3, 6.1, 8.9)]
    return 100.0 + 30.0 * np.sum(waves, axis=0) / len(waves)


def write_flight(
    folder: Path,
    boards: tuple[Board, ...] = (SIGN, WALL),
    frames: int = 30,
    last_range_m: float = 16.0,
    split: str = "test",
) -> Path:
    left_from_body = WORLD_FROM_CAMERA  # the body's axes are the world's, its origin the left camera
    seen, poses, lists = [], [], []
    for frame in range(frames):
        t_ns = START_NS + round(frame * 1e9 / RATE_HZ)
        position_m = camera_m(frame, frames, last_range_m)
        grey, depth, label = view(position_m, boards)
        right, _, _ = view(position_m - [0.0, BASELINE_M, 0.0], boards)
        disparity = np.rint(256.0 * FOCAL_PX * BASELINE_M / depth).astype(np.uint16)
        for place, image in {
            f"mav0/cam0/data/{t_ns}": grey,
            f"mav0/cam1/data/{t_ns}": right,
            f"truth/disparity/{t_ns}": disparity,
            f"truth/label/{t_ns}": label.astype(np.uint8),
        }.items():
            (folder / place).parent.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(folder / f"{place}.png"), image)
        seen.append({"t_ns": t_ns, "objects": seen_objects(position_m, depth, label)})
        poses.append(",".join(map(str, [t_ns, *position_m, 1.0, 0.0, 0.0, 0.0])))
        lists.append(f"{t_ns},{t_ns}.png")
    for camera, shift_m in (("cam0", 0.0), ("cam1", -BASELINE_M)):
        pose = np.eye(4)
        pose[:3, :3], pose[1, 3] = left_from_body, shift_m
        (folder / "mav0" / camera / "sensor.yaml").write_text(sensor_yaml(pose))
        (folder / "mav0" / camera / "data.csv").write_text("\n".join(["#t,name", *lists]) + "\n")
    trajectory = folder / "mav0" / "state_groundtruth_estimate0"
    trajectory.mkdir()
    (trajectory / "data.csv").write_text("\n".join(["#t", *poses]) + "\n")
    (folder / "truth.json").write_text(json.dumps(truth(folder.name, boards, seen, split)))
    return folder


def seen_objects(position_m: np.ndarray, depth: np.ndarray, label: np.ndarray) -> list[dict]:
    objects = []
    for number in np.unique(label[label > 0]):
        v, u = np.nonzero(label == number)
        z = depth[v, u]
        points = np.stack([(u - CU) / FOCAL_PX * z, (v - CV) / FOCAL_PX * z, z], -1) @ WORLD_FROM_CAMERA.T
        objects.append(
            {
                "label": int(number),
                "pixels": len(u),
                "position_m": (points.mean(axis=0) + position_m).tolist(),
                "bbox_px": [int(u.min()), int(v.min()), int(u.max()), int(v.max())],
            }
        )
    return objects


def truth(name: str, boards: tuple[Board, ...], seen: list[dict], split: str) -> dict:
    ground = {"label": GROUND, "name": "ground", "kind": "ground", "standing": False, "target": False}
    objects = [ground | {"position_m": [0.0, 0.0, 0.0], "extent_m": [300.0, 300.0]}]
    for number, board in enumerate(boards, start=GROUND + 1):
        objects.append(
            {
                "label": number,
                "name": board.name,
                "kind": board.kind,
                "standing": True,
                "target": board.target,
                "position_m": board.center_m,
                "extent_m": board.extent_m,
            }
        )
    return {
        "version": 2,
        "name": name,
        "title": f"{name}, a test",
        "split": split,
        "frame": "world: metres, z up, flight along +x",
        "rig": {"focal_px": FOCAL_PX, "baseline_m": BASELINE_M, "center_px": [CU, CV]},
        "speed_m_s": SPEED_M_S,
        "rate_hz": RATE_HZ,
        "objects": objects,
        "frames": seen,
    }


def sensor_yaml(body_from_camera: np.ndarray) -> str:
    return "\n".join(
        [
            "%YAML:1.0",
            "sensor_type: camera",
            "T_BS:",
            "  cols: 4",
            "  rows: 4",
            f"  data: {body_from_camera.ravel().tolist()}",
            f"rate_hz: {RATE_HZ}",
            f"resolution: [{WIDTH}, {HEIGHT}]",
            "camera_model: pinhole",
            f"intrinsics: [{FOCAL_PX}, {FOCAL_PX}, {CU}, {CV}]",
            "distortion_model: radial-tangential",
            "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]",
            "",
        ]
    )
