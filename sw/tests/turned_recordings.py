"""Recordings on disk whose right camera turns against its calibration in mid-flight."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
import numpy as np
import turned_camera as turned
from random_seed import seeded
from sequence_cases import write_image
from shared_data import SHARED_DATA
from turned_camera import Grey
from vista.alignment import Turn
from vista.geometry import Array, Calibration, Pose, camera_matrix
from vista.lens import project, rectified_points
from vista.rectify import Rectifier
from vista.sequence import open_sequence
from vista.sequence.pairs import read_calibration_file

CAMERA = Calibration(320, 240, 300.0, 159.5, 119.5, 0.25)
RECTIFIED = "focal_px = 300.0\ncx = 159.5\ncy = 119.5\nbaseline_m = 0.25\n"


def raw_calibration(lens: str, distortion: list[float]) -> str:
    camera = (
        f'lens = "{lens}"\nfx_px = 300.0\nfy_px = 301.0\ncx = 158.5\ncy = 120.5\ndistortion = {distortion}\n'
    )
    return (
        f"stills = false\n[left]\n{camera}[right]\n{camera}[right_from_left]\n"
        "rotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\ntranslation_m = [-0.25, 0.0, 0.0]\n"
    )


RAW = {
    "radial": raw_calibration("pinhole", [-0.2, 0.05, 1e-3, -5e-4]),
    "rational": raw_calibration("pinhole", [0.3, 0.1, 1e-3, -5e-4, 0.02, 0.5, 0.1, 0.01]),
    "fisheye": raw_calibration("fisheye", [0.02, -0.01, 0.003, 0.0]),
}
# Place, and the median row error that is left in its images, px: the street's calibration is no better.
REAL = {
    "EuRoC V1_01": (SHARED_DATA / "euroc_v101", 0.2),
    "KITTI odometry 00": (SHARED_DATA / "kitti_odometry" / "sequences" / "00", 0.35),
}
PERIOD_NS = 40_000_000


def write_turned_pairs(folder: Path, turn: Turn, first: int, frames: int, lens: str | None = None) -> Path:
    """A flight at 25 frames/s, whose right camera turns with frame `first`. lens: of RAW; None: the pairs
    come rectified."""
    folder.mkdir()
    rectifier = None
    (folder / "calibration.toml").write_text(RECTIFIED if lens is None else RAW[lens])
    if lens is not None:
        described = read_calibration_file(folder / "calibration.toml", (CAMERA.width, CAMERA.height))
        rectifier = Rectifier(described.calibration)
    camera = CAMERA if rectifier is None else rectifier.calibration
    pairs, rows = turned.textured_flight(camera, seeded(5)), []
    for k in range(frames):
        left, right = pairs(k)
        now = turn if k >= first else Turn()
        if rectifier is None:
            right = turned.seen(right, camera, now)
        else:  # both lenses are alike, and neither camera is turned by the rectification
            left, right = (
                sampled(image, places(rectifier, of)) for image, of in ((left, Turn()), (right, now))
            )
        write_image(folder / f"{k:04d}_left.png", left)
        write_image(folder / f"{k:04d}_right.png", right)
        rows.append(f"{k:04d},{PERIOD_NS * k}\n")
    (folder / "times.csv").write_text("name,t_ns\n" + "".join(rows))
    stands = "".join(f"{t_s:.2f},0,0,0,0,0,0,1\n" for t_s in (0.0, 1e-9 * PERIOD_NS * frames))
    (folder / "poses.csv").write_text("t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" + stands)
    return folder


def places(rectifier: Rectifier, turn: Turn) -> Array:
    """(height, width, 2): what each pixel of the raw right camera shows, after it has turned, as a place in
    the image that is rectified as calibrated."""
    raw, camera = rectifier.right, rectifier.calibration
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    points = np.stack([u.ravel(), v.ravel()], -1)
    K = camera_matrix(camera.focal_px, camera.focal_px, camera.cx, camera.cy)
    points = rectified_points(raw.model, points, raw.rectified_from_raw, K)
    back = np.linalg.inv(turned.homography(camera, turn))
    seen = np.column_stack([points, np.ones(len(points))]) @ back.T
    return np.asarray((seen[:, :2] / seen[:, 2:]).reshape(camera.height, camera.width, 2), np.float64)


def turned_places(rectifier: Rectifier, turn: Turn) -> Array:
    """(height, width, 2): what each pixel of the raw right camera shows, after it has turned, as a place in
    the raw image as calibrated."""
    raw, camera = rectifier.right, rectifier.calibration
    there = places(rectifier, turn)
    rays = (there.reshape(-1, 2) - [camera.cx, camera.cy]) / camera.focal_px
    points = np.column_stack([rays, np.ones(len(rays))])
    return project(raw.model, Pose(raw.rectified_from_raw.T), points).reshape(there.shape)


def sampled(image: Grey, at: Array) -> Grey:
    u, v = (at[..., k].astype(np.float32) for k in range(2))
    return np.asarray(cv2.remap(image, u, v, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE), np.uint8)


def read(path: Path) -> Grey:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)


def write_turned_kitti(source: Path, root: Path, turn: Turn, first: int, frames: int) -> Path:
    """source: sequences/NN of KITTI odometry. Its first frames."""
    folder = root / "sequences" / source.name
    shutil.copytree(source.parents[1] / "poses", root / "poses")
    for name in ("image_0", "image_1"):
        (folder / name).mkdir(parents=True)
    shutil.copy(source / "calib.txt", folder)
    times = (source / "times.txt").read_text().splitlines(keepends=True)
    (folder / "times.txt").write_text("".join(times[:frames]))
    poses = root / "poses" / f"{source.name}.txt"
    poses.write_text("".join(poses.read_text().splitlines(keepends=True)[:frames]))
    camera = Rectifier(open_sequence(source).calibration).calibration
    for k, path in enumerate(sorted((source / "image_0").iterdir())[:frames]):
        shutil.copy(path, folder / "image_0")
        right = read(source / "image_1" / path.name)
        write_image(
            folder / "image_1" / path.name, turned.seen(right, camera, turn if k >= first else Turn())
        )
    return folder


def write_turned_asl(source: Path, root: Path, turn: Turn, first: int, frames: int) -> Path:
    """source: of the EuRoC layout, of a vehicle that stands still. Played there and back, 20 frames/s."""
    at = turned_places(Rectifier(open_sequence(source).calibration), turn)
    names = [sorted((source / "mav0" / f"cam{side}" / "data").iterdir()) for side in range(2)]
    last, period_ns = len(names[0]) - 1, 50_000_000
    start_ns = int(names[0][0].stem)
    times_ns = [start_ns + period_ns * k for k in range(frames)]
    for side in range(2):
        camera = root / "mav0" / f"cam{side}"
        camera.mkdir(parents=True)
        shutil.copy(source / "mav0" / f"cam{side}" / "sensor.yaml", camera)
        rows = "".join(f"{t_ns},{t_ns}.png\n" for t_ns in times_ns)
        (camera / "data.csv").write_text("#timestamp [ns],filename\n" + rows)
        for k, t_ns in enumerate(times_ns):
            image = read(names[side][last - abs(last - k % (2 * last))])
            if side == 1 and k >= first:
                image = sampled(image, at)
            write_image(camera / "data" / f"{t_ns}.png", image)
    truth = Path("mav0") / "state_groundtruth_estimate0"
    (root / truth).mkdir()
    head, pose = (source / truth / "data.csv").read_text().splitlines()[:2]
    stands = pose.split(",", 1)[1]
    rows = "".join(
        f"{t_ns},{stands}\n" for t_ns in range(start_ns - 10_000_000, times_ns[-1] + 10**8, 5_000_000)
    )
    (root / truth / "data.csv").write_text(f"{head}\n{rows}")
    return root
