"""A stereo rig before a calibration board, rendered with lenses that are exactly known.

Each sample of a pixel becomes a ray by inverting the lens model here, by Newton's method and without
OpenCV; the ray meets the plane of the board, and the board says how bright it is there. What the calibration
finds can so be compared with what the pictures were made with.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from random_seed import seeded
from scipy.spatial.transform import Rotation
from vista.calibration.board import Board
from vista.calibration.rig import Rig
from vista.geometry import CameraModel, Pose, RawCalibration, camera_matrix
from vista.lens import rectified_points
from vista.rectify import rectified_cameras

Array = NDArray[np.float64]
SAMPLES = 2  # of a pixel, each way
TEXTURE_PX_PER_SQUARE = 96
NEWTON_STEPS = 7
WALL = 95.0


@dataclass(frozen=True)
class Conditions:
    """What a camera adds to what the lens shows."""

    noise: float = 2.0  # standard deviation, grey levels
    blur_px: float = 0.6
    shade: float = 0.0  # how much of the light is missing on the dark side, 0 to 1
    contrast: float = 1.0


def pinhole_rig(size: tuple[int, int] = (640, 480)) -> RawCalibration:
    width, height = size
    scale = width / 640
    left = camera_matrix(520.0 * scale, 521.5 * scale, width / 2 + 6.3, height / 2 - 4.1)
    right = camera_matrix(523.0 * scale, 524.2 * scale, width / 2 - 3.7, height / 2 + 5.2)
    return RawCalibration(
        CameraModel(*size, left, (-0.28, 0.075, 0.0006, -0.0004)),
        CameraModel(*size, right, (-0.27, 0.070, -0.0005, 0.0007)),
        Pose(
            Rotation.from_euler("xyz", [0.5, -0.8, 0.35], True).as_matrix(),
            np.array([-0.12, 0.0013, -0.0008]),
        ),
        "the rendered rig",
    )


def fisheye_rig(size: tuple[int, int] = (640, 480)) -> RawCalibration:
    """Some 130 degrees across."""
    width, height = size
    scale = width / 640
    left = camera_matrix(281.0 * scale, 280.4 * scale, width / 2 - 5.2, height / 2 + 3.3)
    right = camera_matrix(279.5 * scale, 279.9 * scale, width / 2 + 4.4, height / 2 - 2.6)
    return RawCalibration(
        CameraModel(*size, left, (-0.012, 0.021, -0.011, 0.0021), "fisheye"),
        CameraModel(*size, right, (-0.010, 0.018, -0.009, 0.0017), "fisheye"),
        Pose(
            Rotation.from_euler("xyz", [-0.6, 0.7, -0.4], True).as_matrix(), np.array([-0.09, -0.001, 0.0012])
        ),
        "the rendered rig",
    )


def distort(camera: CameraModel, x: Array, y: Array) -> tuple[Array, Array]:
    """The places to which the lens brings the tangents of the angles of a ray, before the camera matrix."""
    r2 = x * x + y * y
    if camera.lens == "fisheye":
        r = np.sqrt(r2)
        theta = np.arctan(r)
        powers = sum(k * theta ** (2 * n + 2) for n, k in enumerate(camera.distortion))
        scale = np.where(r > 1e-12, theta * (1.0 + powers) / np.maximum(r, 1e-12), 1.0)
        return x * scale, y * scale
    k1, k2, p1, p2, *k3 = camera.distortion
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * (k3[0] if k3 else 0.0)))
    return (
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )


def rays(camera: CameraModel, u: Array, v: Array) -> Array:
    """(..., 3) directions, z = 1, of pixels: the lens model inverted by Newton's method."""
    K = camera.matrix
    xd, yd = (u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1]
    x, y = xd.copy(), yd.copy()
    if camera.lens == "fisheye":
        rd = np.hypot(xd, yd)
        grow = np.tan(np.minimum(rd, 1.45)) / np.maximum(rd, 1e-12)
        x, y = xd * grow, yd * grow
    for _ in range(NEWTON_STEPS):
        step = 1e-6
        fx, fy = distort(camera, x, y)
        ax, ay = distort(camera, x + step, y)
        bx, by = distort(camera, x, y + step)
        J = np.array([[(ax - fx), (bx - fx)], [(ay - fy), (by - fy)]]) / step
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        ex, ey = xd - fx, yd - fy
        x = x + (J[1, 1] * ex - J[0, 1] * ey) / det
        y = y + (J[0, 0] * ey - J[1, 0] * ex) / det
    fx, fy = distort(camera, x, y)
    assert max(np.abs(fx - xd).max(), np.abs(fy - yd).max()) * K[0, 0] < 1e-4  # px
    return np.stack([x, y, np.ones_like(x)], -1)


def texture(board: Board) -> tuple[NDArray[np.uint8], float]:
    """The printed board with a white margin of a square, and its pixels a metre; the origin of the board lies
    one square and for a chessboard, whose corners count, one more to the lower right of its corner."""
    n = TEXTURE_PX_PER_SQUARE
    if board.markers:
        image = board.charuco().generateImage((board.columns * n, board.rows * n), marginSize=0)
    else:
        squares = np.indices((board.rows + 1, board.columns + 1)).sum(0) % 2 * 255
        image = np.kron(squares, np.ones((n, n))).astype(np.uint8)
    return cv2.copyMakeBorder(image, n, n, n, n, cv2.BORDER_CONSTANT, value=255), n / board.square_m


@lru_cache(maxsize=8)
def rays_of_samples(
    width: int, height: int, matrix: tuple[float, ...], distortion: tuple[float, ...], lens: str
) -> Array:
    """The rays of all samples of an image; rigs are few, and tests are many."""
    model = CameraModel(width, height, np.reshape(matrix, (3, 3)), distortion, lens)
    offsets = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    u, v = ((np.arange(side)[:, None] + offsets).ravel() for side in (width, height))
    return rays(model, *np.meshgrid(u, v)).astype(np.float32)


class Camera:
    """Renders the board for one camera."""

    def __init__(self, model: CameraModel, board: Board) -> None:
        matrix = tuple(map(float, model.matrix.ravel()))
        self._rays = rays_of_samples(model.width, model.height, matrix, model.distortion, model.lens)
        self._model = model
        self._texture, self._px_per_m = texture(board)
        self._offset_px = (1.0 if board.markers else 2.0) * TEXTURE_PX_PER_SQUARE

    def render(self, camera_from_board: Pose) -> Array:
        """Grey levels without noise; the board hangs before an even wall."""
        image = np.full((self._model.height, self._model.width), WALL)
        u0, v0, u1, v1 = self._box(camera_from_board)
        if u0 >= u1 or v0 >= v1:
            return image
        board_from_camera = camera_from_board.inverse()
        shown_rays = self._rays[v0 * SAMPLES : v1 * SAMPLES, u0 * SAMPLES : u1 * SAMPLES]
        directions = shown_rays @ board_from_camera.rotation.T.astype(np.float32)
        origin_m = board_from_camera.translation_m.astype(np.float32)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = -origin_m[2] / directions[..., 2]
        offset_px = np.float32(self._offset_px - 0.5)
        px = [
            (directions[..., k] * scale + origin_m[k]) * np.float32(self._px_per_m) + offset_px
            for k in (0, 1)
        ]
        for values in px:
            values[(scale <= 0.0) | ~np.isfinite(values)] = -1e4
        border = {"borderMode": cv2.BORDER_CONSTANT, "borderValue": WALL}
        shown = cv2.remap(self._texture, px[0], px[1], cv2.INTER_LINEAR, **border)
        image[v0:v1, u0:u1] = shown.reshape(v1 - v0, SAMPLES, u1 - u0, SAMPLES).mean((1, 3))
        return image

    def _box(self, camera_from_board: Pose) -> tuple[int, int, int, int]:
        """Pixels that the printed sheet can lie on."""
        height, width = (side / self._px_per_m for side in self._texture.shape)
        t = np.linspace(0.0, 1.0, 21)
        x = np.concatenate([t, t, 0 * t, 0 * t + 1]) * width - self._offset_px / self._px_per_m
        y = np.concatenate([0 * t, 0 * t + 1, t, t]) * height - self._offset_px / self._px_per_m
        points_m = (
            np.stack([x, y, 0 * x], -1) @ camera_from_board.rotation.T + camera_from_board.translation_m
        )
        if points_m[:, 2].min() < 0.02:
            return 0, 0, self._model.width, self._model.height
        K = self._model.matrix
        u, v = distort(self._model, *(points_m[:, :2] / points_m[:, 2:]).T)
        u, v = K[0, 0] * u + K[0, 2], K[1, 1] * v + K[1, 2]
        limits = [self._model.width, self._model.height]
        low = np.clip(np.floor([u.min() - 4, v.min() - 4]), 0, limits).astype(int)
        high = np.clip(np.ceil([u.max() + 4, v.max() + 4]), 0, limits).astype(int)
        return int(low[0]), int(low[1]), int(high[0]), int(high[1])


def photograph(ideal: Array, conditions: Conditions, random: np.random.Generator) -> NDArray[np.uint8]:
    height, width = ideal.shape
    light = (
        1.0
        - conditions.shade * np.linspace(0.0, 1.0, width)[None, :] * np.linspace(1.0, 0.6, height)[:, None]
    )
    image = (30.0 + 0.72 * conditions.contrast * ideal) * light
    image = cv2.GaussianBlur(image, (0, 0), conditions.blur_px)
    return np.clip(np.rint(image + random.normal(0.0, conditions.noise, ideal.shape)), 0, 255).astype(
        np.uint8
    )


def board_poses(
    rig: RawCalibration,
    board: Board,
    count: int,
    random: np.random.Generator,
    tilt_deg: float = 38.0,
    fill: float = 0.32,
) -> list[Pose]:
    """Poses that bring the board to places all over the images, tilted all ways, at several distances.

    fill: what part of the image's width a board in the middle has, on average."""
    width_m, height_m = board.extent_m
    K = rig.left.matrix
    poses = []
    for index in range(count):
        depth_m = K[0, 0] * width_m / (fill * rig.left.width) * random.uniform(0.75, 1.35)
        u = rig.left.width * (0.22 + 0.56 * ((index * 0.618) % 1.0))
        v = rig.left.height * (0.25 + 0.5 * ((index * 0.414 + 0.3) % 1.0))
        direction = rays(rig.left, np.array([u]), np.array([v]))[0]
        centre_m = direction / np.linalg.norm(direction) * depth_m
        centre_m[0] += 0.5 * np.linalg.norm(rig.right_from_left.translation_m)  # before both cameras
        turn = random.uniform(0.0, 2.0 * np.pi)
        tilt = np.radians(tilt_deg) * random.uniform(0.5, 1.0)
        axis = np.array([np.cos(turn), np.sin(turn), 0.0]) * tilt
        facing = Rotation.align_vectors([direction / np.linalg.norm(direction)], [[0.0, 0.0, 1.0]])[0]
        roll = Rotation.from_euler("z", random.uniform(-25.0, 25.0), True)
        rotation = (facing * Rotation.from_rotvec(axis) * roll).as_matrix()
        poses.append(Pose(rotation, centre_m - rotation @ np.array([width_m / 2, height_m / 2, 0.0])))
    return poses


Picture = tuple[NDArray[np.uint8], NDArray[np.uint8]]


def render_pairs(
    rig: RawCalibration,
    board: Board,
    poses: list[Pose],
    random: np.random.Generator,
    conditions: Callable[[int], Conditions] = lambda index: Conditions(),
) -> list[Picture]:
    left, right = Camera(rig.left, board), Camera(rig.right, board)
    return [
        (
            photograph(left.render(pose), conditions(index), random),
            photograph(right.render(rig.right_from_left @ pose), conditions(index), random),
        )
        for index, pose in enumerate(poses)
    ]


def write_pairs(folder: Path, pairs: list[Picture]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for index, pair in enumerate(pairs):
        for side, image in zip(("left", "right"), pair, strict=True):
            assert cv2.imwrite(str(folder / f"{index:03d}_{side}.png"), image)
    return folder


# ---- what a calibration is compared with ----


def seen_px(camera: CameraModel, camera_from_points: Pose, points_m: Array) -> Array:
    """(points, 2) where the lens, as it truly is, shows the points."""
    in_camera_m = points_m @ camera_from_points.rotation.T + camera_from_points.translation_m
    u, v = distort(camera, *(in_camera_m[:, :2] / in_camera_m[:, 2:]).T)
    K = camera.matrix
    return np.stack([K[0, 0] * u + K[0, 2], K[1, 1] * v + K[1, 2]], -1)


def exact_row_errors_px(found: RawCalibration, rig: RawCalibration) -> Array:
    """v_right - v_left of points 2 m to 100 m away, all over the image."""
    return np.concatenate(
        [rectified_differences_px(found, rig, depth_m)[:, 1] for depth_m in (2.0, 5.0, 100.0)]
    )


def far_disparities_px(found: RawCalibration, rig: RawCalibration) -> Array:
    """Disparities of what is so far away that they should be 0: what is missing there is missing
    everywhere."""
    return -rectified_differences_px(found, rig, 1e7)[:, 0]


def rectified_differences_px(found: RawCalibration, rig: RawCalibration, depth_m: float) -> Array:
    """(points, 2) of the right image minus those of the left one: seen by the true rig, rectified with what
    was found; of those points that both rectified images show."""
    left, right = rectified_cameras(found)
    width, height = rig.left.width, rig.left.height
    grid = np.meshgrid(np.linspace(2, width - 3, 25), np.linspace(2, height - 3, 19))
    points_m = rays(rig.left, grid[0].ravel(), grid[1].ravel()) * depth_m
    left_px = rectified_points(found.left, seen_px(rig.left, Pose(), points_m), *left)
    right_px = rectified_points(found.right, seen_px(rig.right, rig.right_from_left, points_m), *right)
    both = np.concatenate([left_px, right_px], axis=1)
    inside = (both >= 0).all(axis=1) & (both < [width, height, width, height]).all(axis=1)
    return np.asarray((right_px - left_px)[inside])


def turn_deg(found: RawCalibration, rig: RawCalibration) -> float:
    """The angle between the motion that was found and the true one."""
    apart = found.right_from_left.rotation @ rig.right_from_left.rotation.T
    return float(np.degrees(np.linalg.norm(cv2.Rodrigues(apart)[0])))


def random_rig(lens: str = "pinhole", coefficients: int = 4, body: bool = False) -> Rig:
    random = seeded(14)

    def camera() -> CameraModel:
        K = camera_matrix(*random.uniform([400.0, 400.0, 300.0, 220.0], [600.0, 600.0, 340.0, 260.0]))
        distortion = random.normal(0.0, 0.02, coefficients)
        return CameraModel(640, 480, K, tuple(float(value) for value in distortion), lens)

    def pose(spread: float, shift_m: np.ndarray) -> Pose:
        turn = Rotation.from_rotvec(random.normal(0.0, spread, 3)).as_matrix()
        return Pose(turn, shift_m + random.normal(0.0, 1e-3, 3))

    right_from_left = pose(0.01, np.array([-0.12, 0.0, 0.0]))
    if not body:
        return Rig(camera(), camera(), right_from_left, Pose())
    body_from_left = pose(1.0, np.array([0.02, -0.06, 0.01]))
    return Rig(camera(), camera(), body_from_left, body_from_left @ right_from_left.inverse(), is_body=True)
