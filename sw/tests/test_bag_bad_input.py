"""Every damage a bag can have: one line that names the culprit, exit status 2, nothing written."""

from __future__ import annotations

import random
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import bag_cases as bags
import numpy as np
import pytest
import sequence_cases as cases
from bag_cases import KINDS, LEFT, RIGHT, BagWriter, bag_writer
from command_line import Vista, assert_refused
from random_seed import seeded
from source_cases import Recording
from vista.errors import InputError
from vista.geometry import Pose
from vista.sequence import Frame, Options, open_sequence

START_NS = 1_700_000_000_000_000_000
FRAMES = [
    Frame(index, START_NS + index * 50_000_000, *cases.texture_pair(index), Pose()) for index in range(4)
]
RECORDING = Recording(FRAMES, cases.RIG)


def write(path: Path, kind: str) -> tuple[Path, Path]:
    """The bag, and the file with its messages."""
    if kind == "ros1":
        bag = bags.write_bag(path / "flight.bag", RECORDING, kind)
        return bag, bag
    bag = bags.write_bag(path / "flight", RECORDING, kind)
    (file,) = (p for p in bag.iterdir() if p.suffix in (".db3", ".mcap"))
    return bag, file


# ---- damaged files ----

Damage = Callable[[Path], object]


def keep(share: float) -> Damage:
    return lambda path: path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])


def overwrite(share: float) -> Damage:
    def damage(path: Path) -> None:
        data = bytearray(path.read_bytes())
        at = int(share * len(data))
        data[at : at + 4000] = bytes(4000)
        path.write_bytes(data)

    return damage


DAMAGES: dict[str, Damage] = {
    "empty": lambda path: path.write_bytes(b""),
    "another file": lambda path: path.write_bytes(b"hello" * 2000),
    "30 %": keep(0.3),
    "80 %": keep(0.8),
    "the last bytes missing": keep(0.9995),
    "zeros at the beginning": overwrite(0.0),
    "gone": lambda path: path.unlink(),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_bags(tmp_path: Path, run_vista: Vista, kind: str, name: str) -> None:
    bag, file = write(tmp_path, kind)
    DAMAGES[name](file)
    assert_refused(run_vista("run", bag, "--out", tmp_path / "out"), f"{bag}")
    assert not (tmp_path / "out").exists()


METADATA = {
    "no YAML": ("a: [1\nb: {", "not readable as a bag: Could not load YAML"),
    "no keys": ("other: 1\n", "not readable as a bag: A metadata key is missing"),
    "empty": ("", "not readable as a bag: "),
}


@pytest.mark.parametrize("name", METADATA)
def test_damaged_metadata(tmp_path: Path, run_vista: Vista, name: str) -> None:
    bag, _ = write(tmp_path, "mcap")
    text, message = METADATA[name]
    (bag / "metadata.yaml").write_text(text)
    assert_refused(run_vista("run", bag, "--out", tmp_path / "out"), f"{bag}: {message}")


def test_without_metadata_the_only_file_is_read(tmp_path: Path) -> None:
    bag, file = write(tmp_path, "sqlite3")
    (bag / "metadata.yaml").unlink()
    assert len(open_sequence(bag).frames) == len(FRAMES)
    (bag / "another.db3").write_bytes(file.read_bytes())
    with pytest.raises(InputError, match=r"metadata\.yaml: no such file; without it, name one file of"):
        open_sequence(bag)
    assert len(open_sequence(file).frames) == len(FRAMES)


def test_a_folder_with_the_name_of_a_file(tmp_path: Path) -> None:
    bag, _ = write(tmp_path, "mcap")
    with pytest.raises(InputError, match=r"x\.bag: a folder named \.bag is taken for a file of ROS 1"):
        open_sequence(bag.rename(tmp_path / "x.bag"))


def test_without_the_extra(tmp_path: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch) -> None:
    bag, _ = write(tmp_path, "ros1")
    for name in ("rosbags.highlevel", "rosbags.typesys"):
        monkeypatch.setitem(__import__("sys").modules, name, None)
    message = f"{bag}: reading bags needs the extra [bags]: pip install 'vista-stereo[bags]'"
    assert_refused(run_vista("run", bag, "--out", tmp_path / "out"), message)


@pytest.mark.slow
@pytest.mark.parametrize("topic", [LEFT, "/stereo/right/camera_info", "/odometry"])
def test_an_index_that_promises_too_much(tmp_path: Path, run_vista: Vista, topic: str) -> None:
    bag, file = write(tmp_path, "sqlite3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute(
            "DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name = ?)", [topic]
        )
    message = f"{bag}, topic {topic}: has no messages"
    assert_refused(run_vista("run", bag, "--out", tmp_path / "out"), message)


# ---- messages that are not what they should be ----


def images(bag: BagWriter, side: str, message: Callable[..., Any], **info: Any) -> None:
    for frame in FRAMES:
        bag.write(f"/stereo/{side}/image_raw", frame.t_ns, message(bag, frame.t_ns, getattr(frame, side)))
        info_message = bags.camera_info(bag, frame, RECORDING, side, **info)
        bag.write(f"/stereo/{side}/camera_info", frame.t_ns, info_message)


def deep(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    return bags.raw_image(bag, t_ns, pixels.astype(np.uint16), "mono16")


def narrow(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    return bags.raw_image(bag, t_ns, pixels[:, :100])


def short(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    message = bags.raw_image(bag, t_ns, pixels)
    message.data = message.data[:-1]
    return message


def half_png(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    message = bags.compressed_image(bag, t_ns, pixels)
    message.data = message.data[: len(message.data) // 2]
    return message


def no_png(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    message = bags.compressed_image(bag, t_ns, pixels)
    message.data = np.zeros(100, np.uint8)
    return message


def timeless(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    return bags.raw_image(bag, 0, pixels)


def later(bag: BagWriter, t_ns: int, pixels: np.ndarray) -> Any:
    return bags.raw_image(bag, t_ns + 3_600_000_000_000, pixels)


MESSAGES: dict[str, tuple[Callable[..., Any], dict[str, Any], str]] = {
    "16 bits": (deep, {}, f"topic {RIGHT}, message 0: encoding 'mono16' is not read; known: mono8, "),
    "another size": (narrow, {}, f"topic {RIGHT}, message 0: image is 100x120, the calibration says 160x120"),
    "data too short": (
        short,
        {},
        f"topic {RIGHT}, message 0: 19199 bytes in rows of 160 are no image of 160x",
    ),
    "half a PNG": (half_png, {}, f"topic {RIGHT}, message 0: truncated image"),
    "no PNG": (no_png, {}, f"topic {RIGHT}, message 0: not a PNG, JPEG, PGM or PPM image"),
    "no times": (timeless, {}, f"topic {RIGHT}: the headers of its messages have no times"),
    "times of another clock": (later, {}, f"topic {RIGHT}: no right image within 5 ms of any left one"),
    "not calibrated": (bags.raw_image, {"k": np.zeros(9)}, "camera_info: the camera is not calibrated"),
    "no baseline": (bags.raw_image, {"p": np.eye(3, 4).ravel() * 9}, "camera_info: baseline is 0 m"),
}


@pytest.mark.parametrize("name", MESSAGES)
def test_bad_messages(tmp_path: Path, run_vista: Vista, name: str) -> None:
    message, info, text = MESSAGES[name]
    path = tmp_path / "flight.bag"
    with bag_writer(path, "ros1") as bag:
        images(bag, "left", bags.raw_image)
        images(bag, "right", message, **info)
    assert_refused(run_vista("run", path, "--out", tmp_path / "out"), text)
    assert not (tmp_path / "out" / "obstacles.jsonl").exists()


def not_finite(bag: BagWriter) -> Any:
    return bags.odometry(bag, START_NS, np.array([np.nan, 0.0, 0.0]), bags.CAMERA)


def not_unit(bag: BagWriter) -> Any:
    message = bags.odometry(bag, START_NS, np.zeros(3), bags.CAMERA)
    message.pose.pose.orientation.w = 0.5
    return message


def two_parents(bag: BagWriter) -> Any:
    place = np.zeros(3)
    transforms = [bags.transform(bag, START_NS, parent, bags.CAMERA, place) for parent in ("a", "b")]
    return bags.tf(bag, *transforms)


POSES = {
    "NaN": (not_finite, "topic /poses, message 0: a pose holds a number that is not finite"),
    "length": (not_unit, "topic /poses, message 0: quaternion of length 0.5, expected 1"),
    "two parents": (two_parents, "topic /poses: left_optical has two parents, a and b"),
}


@pytest.mark.parametrize("name", POSES)
def test_bad_poses(tmp_path: Path, run_vista: Vista, name: str) -> None:
    make, text = POSES[name]
    path = tmp_path / "flight"
    with bag_writer(path, "mcap") as bag:
        images(bag, "left", bags.raw_image)
        images(bag, "right", bags.raw_image)
        bag.write("/poses", START_NS, make(bag))
    assert_refused(run_vista("run", path, "--out", tmp_path / "out"), text)


def test_topics_that_hold_nothing_are_named_as_empty(tmp_path: Path, run_vista: Vista) -> None:
    """A recorder that subscribed to cameras which never spoke leaves such a bag."""
    path = tmp_path / "flight.bag"
    with bag_writer(path, "ros1") as bag:
        for side in ("left", "right"):
            bag.connect(f"/stereo/{side}/image_raw", "sensor_msgs/msg/Image")
        bag.write("/odometry", START_NS, bags.odometry(bag, START_NS, np.zeros(3)))
    text = "its image topics: /stereo/left/image_raw (empty), /stereo/right/image_raw (empty)"
    assert_refused(run_vista("run", path, "--out", tmp_path / "out"), text)
    chosen = ("--left-topic", LEFT, "--right-topic", LEFT.replace("left", "right"))
    assert_refused(
        run_vista("run", path, "--out", tmp_path / "out", *chosen), f"no image topic {LEFT}; {text}"
    )


def test_missing_topics(tmp_path: Path, run_vista: Vista) -> None:
    path = tmp_path / "flight.bag"
    with bag_writer(path, "ros1") as bag:
        images(bag, "left", bags.raw_image)
        bag.write("/tail", START_NS, bags.raw_image(bag, START_NS, FRAMES[0].left))
    text = f"choose --left-topic and --right-topic; its image topics: {LEFT}, /tail"
    assert_refused(run_vista("run", path, "--out", tmp_path / "out"), text)
    chosen = ("--left-topic", LEFT, "--right-topic", "/tail")
    text = f"no camera_info beside {LEFT} and /tail (it has: /stereo/left/camera_info); give --calibration"
    assert_refused(run_vista("run", path, "--out", tmp_path / "out", *chosen), text)


def test_calibration_of_stills(tmp_path: Path) -> None:
    bag, _ = write(tmp_path, "ros1")
    still = tmp_path / "still.toml"
    still.write_text("stills = true\n" + cases.PAIR_CALIBRATION)
    with pytest.raises(InputError, match=r"still\.toml: stills = true does not go with"):
        open_sequence(bag, Options(calibration=still))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_random_damage(tmp_path: Path, kind: str) -> None:
    """The reader succeeds or raises InputError in one line, never anything else."""
    rng = random.Random(int(seeded(1).integers(2**32)))
    bag, file = write(tmp_path, kind)
    files = [file] if bag == file else [file, bag / "metadata.yaml"]
    for _ in range(20):
        path = rng.choice(files)
        whole = path.read_bytes()
        data = bytearray(whole)
        for _ in range(rng.choice([1, 1, 50])):
            at = rng.randrange(len(data) + 1)
            data[at : at + rng.choice([1, 4, len(data)])] = rng.randbytes(rng.choice([0, 1, 4]))
        path.write_bytes(data)
        try:
            sequence = open_sequence(bag)
            for files_of_frame in sequence.frames:
                sequence.read(files_of_frame)
        except InputError as error:
            assert "\n" not in str(error)
        path.write_bytes(whole)
