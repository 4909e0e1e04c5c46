"""Video files as a source: their times, their halves, and every damage they can have."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused
from numpy.typing import NDArray
from random_seed import seeded
from source_cases import write_video
from vista.errors import InputError
from vista.sequence import Options, Sequence, open_sequence
from vista.sequence.video_file import VideoFile

FRAMES = 8
RATE_HZ = 20.0


def images(side: int) -> list[NDArray[np.uint8]]:
    return [cases.texture_pair(index)[side] for index in range(FRAMES)]


def both(axis: int = 1) -> list[NDArray[np.uint8]]:
    return [np.concatenate(pair, axis) for pair in zip(images(0), images(1), strict=True)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "calibration.toml").write_text(cases.PAIR_CALIBRATION)
    return tmp_path


def read_all(sequence: Sequence) -> list[int]:
    """The numbers of the frames whose images are those that were written."""
    right = []
    for files in sequence.frames:
        frame = sequence.read(files)
        pair = cases.texture_pair(files.index)
        if np.array_equal(frame.left, pair[0]) and np.array_equal(frame.right, pair[1]):
            right.append(files.index)
    return right


@pytest.mark.parametrize("name", ["video.mkv", "video.avi"])
@pytest.mark.parametrize("axis", [0, 1])
def test_both_halves_and_the_times(folder: Path, name: str, axis: int) -> None:
    sequence = open_sequence(write_video(folder / name, both(axis), RATE_HZ))
    assert sequence.layout == "video"
    assert [files.t_ns for files in sequence.frames] == [index * 50_000_000 for index in range(FRAMES)]
    assert read_all(sequence) == list(range(FRAMES))
    assert not sequence.notes


def test_frames_in_any_order(folder: Path) -> None:
    sequence = open_sequence(write_video(folder / "video.mkv", both(), RATE_HZ))
    for index in (5, 5, 2, 7, 0, 1):
        np.testing.assert_array_equal(
            sequence.read(sequence.frames[index]).left, cases.texture_pair(index)[0]
        )


def test_lossy_codecs_and_other_containers(folder: Path) -> None:
    for name, code in (("video.mp4", "mp4v"), ("video.avi", "MJPG")):
        codec = cv2.VideoWriter_fourcc(*code)
        sequence = open_sequence(write_video(folder / name, both(), RATE_HZ, codec))
        assert len(sequence.frames) == FRAMES
        for files in sequence.frames:
            error = sequence.read(files).left.astype(int) - cases.texture_pair(files.index)[0]
            assert np.abs(error).mean() < 6.0


def test_a_rate_in_place_of_the_times(folder: Path) -> None:
    path = write_video(folder / "video.mkv", both(), RATE_HZ)
    times_ns = [files.t_ns for files in open_sequence(path, Options(rate=3.0, start="7.5")).frames]
    assert times_ns == [7_500_000_000 + round(1e9 * index / 3.0) for index in range(FRAMES)]


def test_two_videos_are_paired_by_their_times(folder: Path) -> None:
    """The right one has every second frame."""
    write_video(folder / "a_left.mkv", images(0), RATE_HZ)
    write_video(folder / "a_right.mkv", images(1)[::2], RATE_HZ / 2)
    sequence = open_sequence(folder / "a_left.mkv")
    assert sequence.name == "a"
    assert read_all(sequence) == [0, 2, 4, 6]
    assert sequence.notes == ("4 of 12 images have no partner within 5 ms and are left out",)


def test_a_square_picture_needs_a_word(folder: Path) -> None:
    square = [image[:100, :80] for image in images(0)]
    path = write_video(folder / "video.mkv", [np.hstack([image, image]) for image in square], RATE_HZ)
    with pytest.raises(InputError, match=r"video\.mkv: 160x100 does not tell .* give --split"):
        open_sequence(path)
    sequence = open_sequence(path, Options(split="side-by-side"))
    np.testing.assert_array_equal(sequence.read(sequence.frames[3]).right, square[3])


def test_poses_of_a_video(folder: Path) -> None:
    path = write_video(folder / "video.mkv", both(), RATE_HZ)
    poses = folder / "poses.txt"
    poses.write_text("# t x y z qx qy qz qw\n1000.1 0 0 0 0 0 0 1\n1000.3 0 0 2 0 0 0 1\n")
    sequence = open_sequence(path, Options(poses=poses, start="1000"))
    z_m = [files.world_from_camera.translation_m[2] for files in sequence.frames]
    assert [files.index for files in sequence.frames] == [2, 3, 4, 5, 6]
    assert z_m == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])
    assert sequence.notes == (f"3 of 8 frames lie outside the time of {poses}",)
    with pytest.raises(InputError, match=r"poses\.txt: covers .* 8 frames: it has 1000\.100 to 1000\.300 "):
        open_sequence(path, Options(poses=poses))


# ---- bad input ----

Damage = Callable[[Path], object]


def keep(share: float) -> Damage:
    return lambda path: path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])


def replaced(content: bytes) -> Damage:
    return lambda path: path.write_bytes(content)


UNREADABLE = "not readable as a video: damaged, truncated, or of a codec that OpenCV does not have here"
DAMAGES: dict[str, tuple[str, Damage, str]] = {
    "empty": ("video.mkv", replaced(b""), "empty file"),
    "no video": ("video.mkv", replaced(b"hello" * 100), UNREADABLE),
    "half of a Matroska file": ("video.mkv", keep(0.5), "truncated: 3 of the 8 frames are there"),
    "the last frame is cut": ("video.mkv", keep(0.98), "truncated: 7 of the 8 frames are there"),
    "half of an AVI file": ("video.avi", keep(0.5), "truncated: "),
    "half of an MP4 file": ("video.mp4", keep(0.5), UNREADABLE),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_videos(folder: Path, run_vista: Vista, name: str) -> None:
    file, damage, message = DAMAGES[name]
    codec = cv2.VideoWriter_fourcc(*("mp4v" if file.endswith("mp4") else "FFV1"))
    path = write_video(folder / file, both(), RATE_HZ, codec)
    damage(path)
    assert_refused(run_vista("run", path, "--out", folder / "out"), f"{path}: {message}")
    assert not (folder / "out").exists()


def test_an_unknown_codec(folder: Path, run_vista: Vista) -> None:
    path = write_video(folder / "video.avi", both(), RATE_HZ)
    data = path.read_bytes()
    assert data.count(b"FFV1") >= 2
    path.write_bytes(data.replace(b"FFV1", b"QQQQ"))
    assert_refused(run_vista("run", path, "--out", folder / "out"), f"{path}: {UNREADABLE}")


def test_a_frame_that_cannot_be_decoded(folder: Path, run_vista: Vista) -> None:
    """The index is whole, so this shows only when the frame is read; what was written before stays."""
    path = write_video(folder / "video.avi", both(), RATE_HZ, cv2.VideoWriter_fourcc(*"MJPG"))
    data = bytearray(path.read_bytes())
    chunks = [at for at in range(data.find(b"movi"), len(data)) if data[at : at + 4] == b"00dc"]
    start, end = chunks[5] + 8, chunks[6]
    data[start:end] = bytes(end - start)
    path.write_bytes(data)
    status, _, err = run_vista("run", path, "--out", folder / "out", "--no-overlay")
    assert status == 2
    assert f"vista: {path}: frame 5 of 8 cannot be decoded: damaged or truncated\n" in err
    assert len((folder / "out" / "obstacles.jsonl").read_text().splitlines()) == 5


def test_two_videos_that_do_not_fit(folder: Path, run_vista: Vista) -> None:
    left = write_video(folder / "left.mkv", images(0), RATE_HZ)
    small = write_video(folder / "small.mkv", [image[:, :100] for image in images(1)], RATE_HZ)
    run = ("run", left, "--out", folder / "out")
    assert_refused(
        run_vista(*run, "--right", small),
        f"{small}: the left and the right video differ in size, 160x120 and 100x120",
    )
    assert_refused(run_vista(*run, "--right", folder / "no.mkv"), "no.mkv: no such file or directory")
    assert_refused(run_vista(*run, "--right", small, "--split", "top-bottom"), "--split: does not go with")


OPTIONS = {
    "another calibration": (("--calibration", "none.toml"), "none.toml: no such file"),
    "no rate": (("--rate", "0"), "0 is not from 0.001 to 100000 frames per second"),
    "no time": (("--start", "noon"), "--start: bad number 'noon'"),
    "one file": (("--pair-tolerance-ms", "3"), "--pair-tolerance-ms: does not go with"),
    "no poses": (("--poses", "none.txt"), "none.txt: no such file"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_do_not_fit(folder: Path, run_vista: Vista, name: str) -> None:
    path = write_video(folder / "video.mkv", both(), RATE_HZ)
    given, message = OPTIONS[name]
    assert_refused(run_vista("run", path, "--out", folder / "out", *given), message)


def test_an_odd_width_has_no_halves(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """OpenCV writes even sizes only."""
    path = write_video(folder / "video.mkv", both(), RATE_HZ)
    monkeypatch.setattr(VideoFile, "read_size", lambda video: (321, 120))
    with pytest.raises(InputError, match=r"video\.mkv: cannot be split in two: its width is 321 px, an odd"):
        open_sequence(path)


def test_options_of_other_sources(tmp_path: Path, run_vista: Vista) -> None:
    """What a layout does not know is refused, not ignored."""
    folder = cases.make_kitti(tmp_path)
    for option in (("--rate", "10"), ("--split", "top-bottom"), ("--pair-tolerance-ms", "2")):
        outcome = run_vista("run", folder, "--out", tmp_path / "out", *option)
        assert_refused(outcome, f"{option[0]}: does not go with this source, whose layout is KITTI odometry")


def test_calibration_of_stills(folder: Path) -> None:
    path = write_video(folder / "video.mkv", both(), RATE_HZ)
    (folder / "calibration.toml").write_text("stills = true\n" + cases.PAIR_CALIBRATION)
    with pytest.raises(InputError, match=r"calibration\.toml: stills = true does not go with"):
        open_sequence(path)


TRAJECTORIES = {
    "": "holds no poses",
    "0 0 0 0 0 0 1\n": r"poses\.txt:1: 6 numbers, expected 7",
    "0 0 0 0 0 0 0 2\n": r"poses\.txt:1: quaternion of length 2",
    "0 0 0 nan 0 0 0 1\n": r"poses\.txt:1: number is not finite",
    "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n": r"poses\.txt:2: time does not increase",
    "-1 0 0 0 0 0 0 1\n": r"poses\.txt:1: time out of range",
}


@pytest.mark.parametrize("text", TRAJECTORIES)
def test_damaged_trajectories(tmp_path: Path, text: str) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text(text)
    folder = cases.make_flown_pairs(tmp_path / "pairs")
    with pytest.raises(InputError, match=TRAJECTORIES[text]):
        open_sequence(folder, Options(poses=poses))


def test_poses_of_pairs_without_times(tmp_path: Path) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    with pytest.raises(InputError, match=r"times\.csv: no such file: .*poses\.txt needs the times"):
        open_sequence(folder, Options(poses=tmp_path / "poses.txt"))


@pytest.mark.parametrize("name", ["video.mkv", "video.avi"])
def test_random_damage(folder: Path, name: str) -> None:
    """The reader succeeds or raises InputError in one line, never anything else."""
    rng = random.Random(int(seeded(1).integers(2**32)))
    path = write_video(folder / name, both(), RATE_HZ)
    whole = path.read_bytes()
    for _ in range(30):
        data = bytearray(whole)
        at = rng.randrange(len(data) if rng.random() < 0.5 else 600)
        data[at : at + rng.choice([1, 4, 16, len(data)])] = rng.randbytes(rng.choice([0, 1, 8]))
        path.write_bytes(data)
        try:
            sequence = open_sequence(path)
            for files in sequence.frames:
                sequence.read(files)
        except InputError as error:
            assert "\n" not in str(error)
