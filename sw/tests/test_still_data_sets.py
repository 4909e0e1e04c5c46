"""KITTI stereo and Middlebury: pairs of which each is judged by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from sequence_cases import Damage, edit, remove
from vista import StereoEngine
from vista.errors import InputError
from vista.rectify import Rectifier
from vista.sequence import Options, open_sequence

FOCAL, CX, CY, BASELINE_M = cases.FOCAL_PX, cases.CX, cases.CY, cases.BASELINE_M


def projection(key: str, cx: float, x: float, y: float = 0.0, z: float = 0.0) -> str:
    return f"{key}: {FOCAL} 0 {cx} {x} 0 {FOCAL} {CY} {y} 0 0 1 {z}\n"


def make_kitti(folder: Path, year: int, pairs: int = 4) -> Path:
    """The last pair has another principal point."""
    cameras = {2012: ("image_0", "image_1"), 2015: ("image_2", "image_3")}[year]
    for index in range(pairs):
        cx = CX + (index == pairs - 1)
        for side, name in enumerate(cameras):
            image = cases.texture_pair(index)[side]
            cases.write_image(folder / name / f"{index:06d}_10.png", image)
            cases.write_image(folder / name / f"{index:06d}_11.png", 255 - image)
        if year == 2012:
            text = projection("P0", cx, 0.0) + projection("P1", cx, -FOCAL * BASELINE_M)
            text += projection("P2", cx, 5.0) + projection("P3", cx, -FOCAL * BASELINE_M + 5.0)
            path = folder / "calib" / f"{index:06d}.txt"
        else:  # as in the data set, with small offsets besides
            text = "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
            text += projection("P_rect_00", cx, 0.0) + projection("P_rect_02", cx, 7.0, 0.2, 0.003)
            text += projection("P_rect_03", cx, 7.0 - FOCAL * BASELINE_M, 0.5, 0.003)
            path = folder / "calib_cam_to_cam" / f"{index:06d}.txt"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder


@pytest.mark.parametrize("year", [2012, 2015])
def test_kitti_stereo(tmp_path: Path, year: int) -> None:
    sequence = open_sequence(make_kitti(tmp_path / "training", year))
    assert (sequence.layout, sequence.stills) == ("KITTI stereo", True)
    assert [files.index for files in sequence.frames] == [0, 1, 2]
    for files in sequence.frames:
        frame = sequence.read(files)
        np.testing.assert_array_equal(frame.left, cases.texture_pair(files.index)[0])
        np.testing.assert_array_equal(frame.right, cases.texture_pair(files.index)[1])
    rectifier = Rectifier(sequence.calibration)
    assert rectifier.is_passthrough
    assert rectifier.calibration.baseline_m == pytest.approx(BASELINE_M)
    assert sequence.notes == (
        "1 of 4 pairs have another size or calibration than 000000_10.png, and are left out; "
        "--frames N: takes that of N",
    )


def test_frames_choose_the_calibration(tmp_path: Path, run_vista: Vista) -> None:
    folder = make_kitti(tmp_path / "training", 2012)
    sequence = open_sequence(folder, Options(first_frame=3))
    assert [files.index for files in sequence.frames] == [3]
    assert Rectifier(sequence.calibration).calibration.cx == CX + 1
    run = ("run", folder, "--no-overlay", "--out", tmp_path / "out")
    assert run_vista(*run, "--frames", "3:")[0] == 0
    assert len((tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()) == 1
    message = "--frames: selects none; the folder has frames 0 to 3"
    assert_refused(run_vista(*run, "--frames", "4:"), message)


def test_one_calibration_for_all(tmp_path: Path) -> None:
    folder = make_kitti(tmp_path / "training", 2012)
    rig = tmp_path / "rig.toml"
    rig.write_text(cases.PAIR_CALIBRATION)
    assert len(open_sequence(folder, Options(calibration=rig)).frames) == 4


KITTI: dict[str, tuple[Damage, str]] = {
    "no right image": (
        remove("image_1/000001_10.png"),
        r"image_1/000001_10\.png: no such file: the right",
    ),
    "no calibration": (
        remove("calib/000002.txt"),
        r"calib/000002\.txt: no such file; give --calibration",
    ),
    "no P1": (edit("calib/000000.txt", "P1", "P4"), r"calib/000000\.txt: P1 is missing"),
    "no baseline": (
        edit("calib/000000.txt", "-30.0", "0.0"),
        r"000000\.txt: baseline is 0 m, must be positive",
    ),
    "half an image": (
        lambda folder: (folder / "image_0/000000_10.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(20)),
        r"image_0/000000_10\.png: ",
    ),
}


@pytest.mark.parametrize("name", KITTI)
def test_damaged_kitti(tmp_path: Path, name: str) -> None:
    folder = make_kitti(tmp_path / "training", 2012)
    damage, message = KITTI[name]
    damage(folder)
    with pytest.raises(InputError, match=message):
        open_sequence(folder)


def test_the_root_of_kitti_stereo(tmp_path: Path) -> None:
    make_kitti(tmp_path / "training", 2015)
    with pytest.raises(InputError, match="holds the parts of KITTI stereo; name one, such as training"):
        open_sequence(tmp_path)


# ---- Middlebury ----

DOFFS_PX = 10.0
CALIBRATION = (
    f"cam0=[{FOCAL} 0 {CX}; 0 {FOCAL} {CY}; 0 0 1]\ncam1=[{FOCAL} 0 {CX + DOFFS_PX}; 0 {FOCAL} {CY}; 0 0 1]\n"
    f"doffs={DOFFS_PX}\nbaseline={1000 * BASELINE_M}\nwidth={cases.WIDTH}\nheight={cases.HEIGHT}\n"
    "ndisp=64\nisint=0\nvmin=2\nvmax=60\n"
)


def make_middlebury(folder: Path, names: tuple[str, str] = ("im0", "im1")) -> Path:
    for name, image in zip(names, cases.texture_pair(0), strict=True):
        cases.write_image(folder / f"{name}.png", image)
    if names[0] == "im0":
        (folder / "calib.txt").write_text(CALIBRATION)
    return folder


def test_middlebury_with_doffs(tmp_path: Path) -> None:
    """What has the disparity d in the images is f B / (d + doffs) away."""
    sequence = open_sequence(make_middlebury(tmp_path / "Motorcycle"))
    assert (sequence.name, sequence.layout, sequence.stills) == ("Motorcycle", "Middlebury", True)
    rectifier = Rectifier(sequence.calibration)
    frame = rectifier.rectify(sequence.read(sequence.frames[0]))
    words = StereoEngine(num_disparities=32, block_size=11).compute(frame.left, frame.right)
    disparity_px = float(np.median(words[words >= 0])) / 16.0
    depth_m = rectifier.calibration.focal_px * rectifier.calibration.baseline_m / disparity_px
    assert depth_m == pytest.approx(FOCAL * BASELINE_M / (cases.DISPARITY_PX + DOFFS_PX), rel=0.02)
    assert (words >= 0).mean() > 0.5


@pytest.mark.parametrize("names", [("im2", "im6"), ("view1", "view5")])
def test_earlier_middlebury_scenes(tmp_path: Path, names: tuple[str, str]) -> None:
    folder = make_middlebury(tmp_path / "cones", names)
    with pytest.raises(
        InputError, match=r"calib\.txt: no such file, and no .*calibration\.toml; give --calib"
    ):
        open_sequence(folder)
    (folder / "calibration.toml").write_text(cases.PAIR_CALIBRATION)
    assert Rectifier(open_sequence(folder).calibration).is_passthrough


MIDDLEBURY = {
    "no doffs": ("doffs", "dofs", r"calib\.txt: doffs is missing"),
    "another doffs": ("doffs=10.0", "doffs=31.1", r"calib\.txt:3: doffs is 31\.1, but cam0 and cam1 say 10"),
    "another size": ("width=160", "width=320", r"calib\.txt: is for images of 320x120, these are 160x120"),
    "baseline": ("baseline=250.0", "baseline=-1", r"calib\.txt:4: baseline is -1 mm, must be positive"),
    "bad number": ("baseline=250.0", "baseline=x", r"calib\.txt:4: bad number 'x'"),
    "no matrix": ("cam1=[", "cam1=(", r"calib\.txt:2: expected a matrix \[f 0 cx; 0 f cy; 0 0 1\]"),
    "short matrix": (f"0 {CX};", "0;", r"calib\.txt:1: 2 numbers, expected 3"),
    "negative": (f"[{FOCAL}", f"[-{FOCAL}", r"calib\.txt:1: expected a matrix .* positive focal lengths"),
}


@pytest.mark.parametrize("name", MIDDLEBURY)
def test_damaged_middlebury(tmp_path: Path, name: str) -> None:
    folder = make_middlebury(tmp_path / "scene")
    old, new, message = MIDDLEBURY[name]
    edit("calib.txt", old, new)(folder)
    with pytest.raises(InputError, match=message):
        open_sequence(folder)


def test_stills_have_no_poses(tmp_path: Path, run_vista: Vista) -> None:
    folder = make_middlebury(tmp_path / "scene")
    outcome = run_vista("run", folder, "--out", tmp_path / "out", "--poses", tmp_path / "poses.txt")
    assert_refused(outcome, f"--poses: does not go with {folder}, which shows unrelated scenes")
