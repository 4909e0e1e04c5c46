"""`vista run --bag`: what other programs read from it, and that it is a source like any other."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
from command_line import Vista, assert_refused, lines_without_times
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from random_seed import seeded
from vista.geometry import Pose, level_world, quaternion_from_rotation, rotation_from_quaternion
from vista.report.labels import obstacle_name

UP = "up_world = [0.0, 0.0, 1.0]\n"


@pytest.fixture
def board(tmp_path: Path) -> Path:
    """A board before a wall; the camera stands, level, with poses."""
    folder = cases.make_board_scenes(tmp_path / "board", 6, stills=False)
    calibration = folder / "calibration.toml"
    calibration.write_text(UP + calibration.read_text())
    times = "".join(f"scene{k:02d},{0.1 * k + 1.0:.1f}\n" for k in range(6))
    (folder / "times.csv").write_text("name,t_s\n" + times)
    # x right of the camera is world x, its axis is world y, its down is world -z
    q = quaternion_from_rotation(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]))
    turn = ",".join(f"{x:.12f}" for x in (*q[1:], q[0]))
    rows = "".join(f"{0.1 * k + 0.95:.2f},0,{0.2 * k},10,{turn}\n" for k in range(7))
    (folder / "poses.csv").write_text("t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" + rows)
    return folder


def messages(bag: Path, topic: str) -> list[Any]:
    """Messages as the readers of MCAP's own project give them, which know nothing of rosbags."""
    (file,) = bag.glob("*.mcap")
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [decoded for *_, decoded in reader.iter_decoded_messages(topics=[topic])]


@pytest.mark.slow
def test_a_bag_is_a_source_that_gives_the_same_obstacles(
    tmp_path: Path, board: Path, run_vista: Vista
) -> None:
    assert run_vista("run", board, "--out", tmp_path / "one", "--bag", tmp_path / "bag")[0] == 0
    assert sorted(p.name for p in (tmp_path / "bag").iterdir()) == ["bag.mcap", "metadata.yaml"]
    assert run_vista("run", tmp_path / "bag", "--out", tmp_path / "two")[0] == 0
    lines = lines_without_times(tmp_path / "one")
    assert lines == lines_without_times(tmp_path / "two")
    assert '"confirmed": true' in lines[-1]


def test_the_scene_holds_what_the_lines_say(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    lines = [json.loads(line) for line in (tmp_path / "out" / "obstacles.jsonl").read_text().splitlines()]
    updates = messages(tmp_path / "bag", "/vista/obstacles")
    assert len(updates) == len(lines) == 6
    for line, update in zip(lines, updates, strict=True):
        entities = {entity.id: entity for entity in update.entities}
        met = entities.pop("nearest collision", None)
        assert (met is None) == (line["nearest_collision"] is None)
        assert len(entities) == len(line["obstacles"])
        for obstacle in line["obstacles"]:
            entity = entities[obstacle_name(obstacle["id"])]
            assert entity.frame_id == "left_camera_optical"
            assert entity.timestamp.sec * 10**9 + entity.timestamp.nanosec == line["t_ns"]
            centre = entity.cubes[0].pose.position
            np.testing.assert_allclose(
                (centre.x, centre.y, centre.z), obstacle["position_camera_m"], atol=6e-4
            )
            figures = {pair.key: json.loads(pair.value) for pair in entity.metadata}
            assert figures["in_collision_volume"] == obstacle["in_collision_volume"]
            of_camera = np.reshape(figures["covariance_m2"], (3, 3))
            of_world = np.array(obstacle["covariance_m2"])
            np.testing.assert_allclose(np.trace(of_camera), np.trace(of_world), rtol=1e-3, atol=1e-5)
            # The camera's axis is the world's y.
            np.testing.assert_allclose(of_camera[2, 2], of_world[1, 1], rtol=1e-3, atol=1e-5)
            # The ellipsoid: its volume is that of one sigma, where no axis is too thin to be seen.
            size = entity.spheres[0].size
            variances = np.sort(np.linalg.eigvalsh(of_camera))
            drawn = np.sort([size.x, size.y, size.z])
            np.testing.assert_allclose(drawn, np.maximum(2.0 * np.sqrt(variances), 0.05), rtol=1e-2)


def test_what_is_gone_is_deleted(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    shown: set[str] = set()
    for update in messages(tmp_path / "bag", "/vista/obstacles"):
        now = {entity.id for entity in update.entities}
        assert {deletion.id for deletion in update.deletions} == shown - now
        shown = now


def test_images_disparities_and_transforms(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    image = messages(tmp_path / "bag", "/stereo/left/image_rect")[0]
    assert (image.encoding, image.width, image.height, image.step) == ("mono8", 320, 240, 320)
    info = messages(tmp_path / "bag", "/stereo/right/camera_info")[0]
    assert info.p[3] == pytest.approx(-300.0 * 0.5)
    disparity = messages(tmp_path / "bag", "/stereo/disparity")[-1]
    pixels = np.frombuffer(bytes(disparity.image.data), "<f4").reshape(240, 320)
    assert np.median(pixels[80:160, 160:200]) == pytest.approx(cases.BOARD_DISPARITY_PX, abs=0.2)
    assert pixels.min() == -1.0 < disparity.min_disparity
    assert disparity.t == pytest.approx(0.5) and disparity.f == pytest.approx(300.0)
    tf = messages(tmp_path / "bag", "/tf")[0].transforms[0]
    assert (tf.header.frame_id, tf.child_frame_id) == ("world", "left_camera_optical")
    assert tf.transform.translation.z == pytest.approx(10.0)
    q = tf.transform.rotation
    rotation = rotation_from_quaternion(np.array([q.w, q.x, q.y, q.z]))
    np.testing.assert_allclose(rotation @ (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), atol=1e-9)  # up is z
    status = messages(tmp_path / "bag", "/diagnostics")[0].status[0]
    assert status.name == "vista" and {"host_ms", "path_seen_m"} <= {v.key for v in status.values}
    assert bytes(messages(tmp_path / "bag", "/vista/overlay/compressed")[0].data)[:2] == b"\xff\xd8"


def test_without_poses_and_pictures(tmp_path: Path, run_vista: Vista) -> None:
    folder = cases.make_pairs(tmp_path / "pairs")
    status, _, _ = run_vista(
        "run", folder, "--out", tmp_path / "out", "--bag", tmp_path / "bag", "--no-overlay"
    )
    assert status == 0
    assert messages(tmp_path / "bag", "/tf") == []
    assert messages(tmp_path / "bag", "/vista/overlay/compressed") == []
    assert len(messages(tmp_path / "bag", "/stereo/left/image_rect")) == 4


def test_the_world_of_a_bag_has_z_up() -> None:
    rng = seeded(81)
    for _ in range(200):
        up = rng.normal(size=3)
        up /= np.linalg.norm(up)
        turn = level_world(up, Pose())
        np.testing.assert_allclose(turn @ up, (0.0, 0.0, 1.0), atol=1e-9)
        np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(turn) > 0.0
    for up in ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)):
        np.testing.assert_allclose(level_world(np.array(up), Pose()) @ up, (0.0, 0.0, 1.0))
    turn = level_world(None, Pose())
    np.testing.assert_allclose(turn @ (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    np.testing.assert_allclose(turn @ (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))


def test_nothing_is_half_written(tmp_path: Path, board: Path, run_vista: Vista) -> None:
    (tmp_path / "there").mkdir()
    outcome = run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "there")
    assert_refused(outcome, "exists; name a new folder")
    outcome = run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "no" / "bag")
    assert_refused(outcome, "cannot be written")
    # An image that cannot be read ends the run; the frames before it are a whole bag.
    sorted(board.glob("*_left.png"))[3].write_bytes(b"no image")
    status, _, err = run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    assert status == 2 and "scene03_left.png" in err
    assert len(messages(tmp_path / "bag", "/vista/obstacles")) == 3
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".")] == []


def test_a_time_that_ros_cannot_hold(tmp_path: Path, run_vista: Vista) -> None:
    pairs = cases.make_pairs(tmp_path / "pairs")
    rows = [f"scene{k:02d},{2**31 - 2 + k}" for k in range(cases.FRAMES)]
    (pairs / "times.csv").write_text("\n".join(["name,t_s", *rows]))
    status, _, err = run_vista("run", pairs, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    assert status == 2 and err.count("\n") == 1
    assert err.endswith("--bag: the time 2147483648 s is beyond those of ROS, which end at 2147483648 s\n")
    assert len(messages(tmp_path / "bag", "/vista/obstacles")) == 2  # the frames before


def test_the_extra_is_named_where_it_is_missing(
    tmp_path: Path, board: Path, run_vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "vista.bag.writer", None)
    outcome = run_vista("run", board, "--out", tmp_path / "out", "--bag", tmp_path / "bag")
    assert_refused(outcome, "needs the extra [bags]")
