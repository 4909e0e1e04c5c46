"""Folders of pairs made of the real images in the shared data, each with its calibration."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import sequence_cases as cases
from shared_data import SHARED_DATA
from vista.geometry import Pose
from vista.sequence import read_grey

BASELINE_M = 0.53715  # KITTI 2012
KITTI_2012 = {  # focal length and principal point, px, of each size of image
    (1226, 370): (707.0912, 601.8873, 183.1104),
    (1241, 376): (718.856, 607.1928, 185.2157),
    (1242, 375): (721.5377, 609.5593, 172.854),
}
MIDDLEBURY = {
    "tsukuba": ("scene1.row3.col3.ppm", "scene1.row3.col4.ppm"),
    "venus": ("im2.ppm", "im6.ppm"),
    "teddy": ("im2.png", "im6.png"),
    "cones": ("im2.png", "im6.png"),
}


def make_bumblebee2(folder: Path, scenes: list[str]) -> Path:
    """The calibration is written out here: p_left = R p_right + t, of the data's stereo.yaml."""
    R = np.array(
        [
            [0.9999694757041413, -0.002167658916924345, 0.007506591423858594],
            [0.002144760822245101, 0.9999930270271246, 0.0030571061711613945],
            [-0.007513165844052039, -0.003040913011953583, 0.999967152054033],
        ]
    )
    t_m = np.array([0.12004374261980637, 0.0008974418603859871, -0.0009149583203134171])
    right_from_left = Pose(R, t_m).inverse()
    text = f"""
        [left]
        fx_px = 524.6141554796689
        fy_px = 526.9202267407102
        cx = 312.4508572809385
        cy = 247.40163214599613
        distortion = [-0.3625365821238732, 0.17532754393079863, 0.0, 0.0]
        [right]
        fx_px = 526.437309515818
        fy_px = 528.6524795626539
        cx = 318.40405668073225
        cy = 245.93504188705572
        distortion = [-0.35299970494414057, 0.16297446727663975, 0.0, 0.0]
        [right_from_left]
        rotation = {right_from_left.rotation.ravel().tolist()}
        translation_m = {right_from_left.translation_m.tolist()}
        """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "calibration.toml").write_text("stills = true\n" + text)
    for scene in scenes:
        for side in ("left", "right"):
            name = f"{scene}_{side}.jpg"
            shutil.copy(SHARED_DATA / "bumblebee2" / name, folder / name)
    return folder


def make_kitti2012(folder: Path, size: tuple[int, int]) -> Path:
    """The pairs of images of that size with an even number; the others are kept for results."""
    for left in sorted((SHARED_DATA / "kitti2012" / "image_0").iterdir()):
        if int(left.stem.split("_")[0]) % 2:
            continue
        image = read_grey(left)
        if image.shape[::-1] == size:
            cases.write_image(folder / f"{left.stem}_left.png", image)
            shutil.copy(SHARED_DATA / "kitti2012" / "image_1" / left.name, folder / f"{left.stem}_right.png")
    write_calibration(folder, *KITTI_2012[size], BASELINE_M)
    return folder


def make_middlebury(folder: Path, scene: str) -> Path:
    """The data has no calibration; a lens of 50 degrees and a baseline of 16 cm stand for it."""
    for side, name in zip(("left", "right"), MIDDLEBURY[scene], strict=True):
        image = read_grey(SHARED_DATA / "middlebury" / scene / name)
        cases.write_image(folder / f"{scene}_{side}.png", image)
    height, width = image.shape
    write_calibration(folder, width * 1.07, width / 2, height / 2, 0.16)
    return folder


def write_calibration(folder: Path, focal_px: float, cx: float, cy: float, baseline_m: float) -> None:
    lines = f"focal_px = {focal_px}\ncx = {cx}\ncy = {cy}\nbaseline_m = {baseline_m}\nstills = true\n"
    (folder / "calibration.toml").write_text(lines)
