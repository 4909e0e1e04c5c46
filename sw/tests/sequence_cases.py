"""Small synthetic sequences in three layouts, for tests to use or to damage."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.geometry import Calibration, rectified_rig

WIDTH, HEIGHT = 160, 120
FRAMES = 4
FOCAL_PX, CX, CY, BASELINE_M = 120.0, 80.0, 60.0, 0.25
DISPARITY_PX = 6

RIG = rectified_rig(Calibration(WIDTH, HEIGHT, FOCAL_PX, CX, CY, BASELINE_M), "rig")
PAIR_CALIBRATION = f"focal_px = {FOCAL_PX}\ncx = {CX}\ncy = {CY}\nbaseline_m = {BASELINE_M}\n"


def texture_pair(
    seed: int, width: int = WIDTH, height: int = HEIGHT
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """A smooth random texture at one disparity, DISPARITY_PX."""
    noise = np.random.default_rng(seed).integers(0, 256, (height, width + DISPARITY_PX), np.uint8)
    wide = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 1.5), None, 0, 255, cv2.NORM_MINMAX)
    return np.ascontiguousarray(wide[:, :width]), np.ascontiguousarray(wide[:, DISPARITY_PX:])


def write_image(path: Path, image: NDArray[np.uint8]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), image)


def make_pairs(folder: Path, frames: int = FRAMES) -> Path:
    folder.mkdir(parents=True)
    for index in range(frames):
        left, right = texture_pair(index)
        write_image(folder / f"scene{index:02d}_left.png", left)
        write_image(folder / f"scene{index:02d}_right.png", right)
    (folder / "calibration.toml").write_text(PAIR_CALIBRATION)
    return folder


def make_flown_pairs(folder: Path, frames: int = FRAMES) -> Path:
    """Pairs with times, 10 Hz, and poses: 1 m a frame along the axis, sampled between them."""
    make_pairs(folder, frames)
    times = "".join(f"scene{index:02d},{0.1 * index + 1.0:.1f}\n" for index in range(frames))
    (folder / "times.csv").write_text("name,t_s\n" + times)
    poses = "".join(f"{0.1 * index + 0.95:.2f},0,0,{index - 0.5},0,0,0,1\n" for index in range(frames + 1))
    (folder / "poses.csv").write_text("t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" + poses)
    return folder


BOARD_DISPARITY_PX = 12


def make_board_scenes(folder: Path, frames: int, stills: bool) -> Path:
    """The same board, 2.5 m wide and 12.5 m away before a wall at 25 m, in every pair."""
    left, right = texture_pair(0, 320, 240)  # the wall
    near, _ = texture_pair(1, 60, 120)
    for image, shift in ((left, 0), (right, BOARD_DISPARITY_PX)):
        image[60:180, 150 - shift : 210 - shift] = near
    for index in range(frames):
        write_image(folder / f"scene{index:02d}_left.png", left)
        write_image(folder / f"scene{index:02d}_right.png", right)
    calibration = (
        f"focal_px = 300.0\ncx = 160.0\ncy = 120.0\nbaseline_m = 0.5\nstills = {str(stills).lower()}\n"
    )
    (folder / "calibration.toml").write_text(calibration)
    return folder


def make_kitti(root: Path, frames: int = FRAMES) -> Path:
    """Returns sequences/00; the camera flies 1 m a frame along its axis."""
    folder = root / "sequences" / "00"
    for index in range(frames):
        left, right = texture_pair(index)
        write_image(folder / "image_0" / f"{index:06d}.png", left)
        write_image(folder / "image_1" / f"{index:06d}.png", right)
    rows = {"P0": 0.0, "P1": -FOCAL_PX * BASELINE_M}
    lines = (
        f"{key}: {FOCAL_PX} 0 {CX} {offset} 0 {FOCAL_PX} {CY} 0 0 0 1 0\n" for key, offset in rows.items()
    )
    (folder / "calib.txt").write_text("".join(lines))
    (folder / "times.txt").write_text("".join(f"{0.1 * index:e}\n" for index in range(frames)))
    (root / "poses").mkdir()
    poses = "".join(f"1 0 0 0 0 1 0 0 0 0 1 {index}\n" for index in range(frames))
    (root / "poses" / "00.txt").write_text(poses)
    return folder


ASL_SENSOR = """%YAML:1.0
# comment
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [1.0, 0.0, 0.0, {x},
         0.0, 1.0, 0.0, 0.0,
         0.0, 0.0, 1.0, 0.0,
         0.0, 0.0, 0.0, 1.0]
resolution: [{width}, {height}]
camera_model: pinhole
intrinsics: [{focal}, {focal}, {cx}, {cy}] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [0.0, 0.0, 0.0, 0.0]
"""
ASL_START_NS = 1_403_715_274_000_000_000
ASL_PERIOD_NS = 50_000_000


def make_asl(root: Path, frames: int = FRAMES) -> Path:
    """The body flies 1 m/s along z, poses sampled at 200 Hz from 10 ms before the first frame."""
    times_ns = [ASL_START_NS + index * ASL_PERIOD_NS for index in range(frames)]
    for side, x in enumerate((0.0, BASELINE_M)):
        camera = root / "mav0" / f"cam{side}"
        for index, t_ns in enumerate(times_ns):
            write_image(camera / "data" / f"{t_ns}.png", texture_pair(index)[side])
        rows = "".join(f"{t_ns},{t_ns}.png\r\n" for t_ns in times_ns)
        (camera / "data.csv").write_text("#timestamp [ns],filename\r\n" + rows)
        sensor = ASL_SENSOR.format(x=x, width=WIDTH, height=HEIGHT, focal=FOCAL_PX, cx=CX, cy=CY)
        (camera / "sensor.yaml").write_text(sensor)
    truth = root / "mav0" / "state_groundtruth_estimate0"
    truth.mkdir()
    samples_ns = range(-10_000_000, frames * ASL_PERIOD_NS, 4_000_000)
    rows = "".join(f"{ASL_START_NS + t},0,0,{t / 1e9:.6f},1,0,0,0\n" for t in samples_ns)
    (truth / "data.csv").write_text("#timestamp, p_RS_R_x [m], ...\n" + rows)
    return root


def make_raw(folder: Path) -> Path:
    """The cameras get a lens, so that the images are raw ones."""
    matrix = "fx_px = 300.0\nfy_px = 300.0\ncx = 160.0\ncy = 120.0\n"
    lens = "distortion = [{}, 0.0, 0.0, 0.0]\n"
    (folder / "calibration.toml").write_text(
        "stills = false\n"
        f"[left]\n{matrix}{lens.format(-0.02)}[right]\n{matrix}{lens.format(-0.015)}"
        "[right_from_left]\nrotation = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
        "translation_m = [-0.5, 0.0, 0.0]\n"
    )
    return folder


# ---- damage ----

Damage = Callable[[Path], object]  # to a folder


def edit(name: str, old: str, new: str, count: int = -1) -> Damage:
    """Replaces text that is there: the first count times, or everywhere."""

    def damage(folder: Path) -> None:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new, count))

    return damage


def remove(name: str) -> Damage:
    return lambda folder: (folder / name).unlink()
