"""The chain as a whole: a board that comes nearer becomes one obstacle, ground and sky none; the pipeline
lives in the memory it was given and gives the same numbers every time."""

from __future__ import annotations

import math
from dataclasses import replace

import board_flight as scene
import cv2
import numpy as np
import pytest
import vista.pipeline
from board_flight import board_flight
from pipeline_library import (
    CALIBRATION,
    Frame,
    Pipeline,
    bytes_needed,
    default_camera,
    default_parameters,
    plain,
    snapshot,
)
from random_seed import seeded
from stage_library import INVALID, ffi, lib
from vista.geometry import Calibration, Pose
from vista.parameters import defaults
from vista_eval.cell_graph import OpenPipeline

# The fourth frame: tracker.confirm_hits, and none more, because its foot on the ground shows that it stands.
CONFIRMED_FROM = WARNED_FROM = 3


@pytest.fixture(scope="module")
def flight() -> list[dict]:
    """Snapshots of an undisturbed flight, for others to be compared with."""
    return Pipeline().fly(board_flight())


# ---- what comes out ----


def test_of_more_things_than_are_followed_the_nearest_are_and_it_is_said() -> None:
    side_px, (height, width) = 24, (480, 640)
    camera = Calibration(width, height, 480.0, (width - 1) / 2, (height - 1) / 2, 0.5)
    words = np.random.default_rng(3).integers(2 * 16, 50 * 16, (height // side_px, -(-width // side_px)))
    words = np.kron(words, np.ones((side_px, side_px), np.int16))[:, :width].astype(np.int16)
    image = np.tile(np.arange(width) // 8 % 2 * 40 + 100, (height, 1)).astype(np.uint8)
    result = vista.pipeline.Pipeline(camera).process(image, words, 0, Pose(np.eye(3), np.zeros(3)))
    followed = [obstacle.disparity_px for obstacle in result.obstacles if obstacle.kind == "thing"]
    accepted = [k for k, verdict in enumerate(result.verdict_of_region) if verdict == "ACCEPTED"]
    seen_px = sorted(np.median(result.words[result.region_of_pixel == k]) / 16 for k in accepted)
    assert len(accepted) > 200 and len(followed) == 96
    assert min(followed) > seen_px[-96] - 3.0  # what a region has is no median
    assert result.health.state == "degraded" and "crowded" in result.health.reasons


def test_words_without_an_image_tell_of_the_board() -> None:
    """Compares them with words that have a black image: all but the health is the same."""
    alone, black = Pipeline(), Pipeline()
    for k, source in enumerate(board_flight()):
        frame, dark = Frame(source), Frame(replace(source, left=np.zeros_like(source.left)))
        frame.c.image = ffi.new("vista_image *")[0]
        assert (alone.process(frame), black.process(dark)) == ("VISTA_OK", "VISTA_OK")
        found = snapshot(alone.result)
        assert found == snapshot(black.result)
        assert any(o["confirmed"] for o in found["obstacles"]) == (k >= CONFIRMED_FROM)
        for obstacle in found["obstacles"]:  # its sides are things of their own, at the same distance
            assert obstacle["distance_m"] == pytest.approx(source.board_distance_m, abs=0.5)
        assert alone.result.health.state == lib.VISTA_HEALTH_DEGRADED
        assert alone.result.health.reasons >> lib.VISTA_HEALTH_IMAGE_MISSING & 1
        assert not alone.result.health.reasons >> lib.VISTA_HEALTH_NO_CONTRAST & 1
        assert black.result.health.state == lib.VISTA_HEALTH_BLIND


def test_the_board_is_one_obstacle_throughout(flight: list[dict]) -> None:
    assert [len(frame["obstacles"]) for frame in flight] == [1] * scene.FRAMES
    obstacles = [frame["obstacles"][0] for frame in flight]
    assert {o["id"] for o in obstacles} == {1}
    assert [o["confirmed"] for o in obstacles] == [k >= CONFIRMED_FROM for k in range(scene.FRAMES)]
    assert [o["age_frames"] for o in obstacles] == list(range(1, scene.FRAMES + 1))
    assert not any(o["coasting"] or o["in_blind_zone"] for o in obstacles)


def test_the_board_is_where_it_stands(flight: list[dict]) -> None:
    for frame, source in zip(flight, board_flight(), strict=True):
        obstacle = frame["obstacles"][0]
        error_m = np.array(obstacle["position_m"]) - scene.board_center_m()
        # A word is good for 1/32 px; the foot of the board is a cell's guess between board and ground.
        depth_m = source.board_distance_m
        range_m = depth_m**2 / (scene.FOCAL_PX * scene.BASELINE_M) / 32
        behind_m = 0.25 * min(
            1.0, *obstacle["extent_m"]
        )  # its middle is taken to be, as that of a ball may be
        assert abs(error_m[0] - behind_m) < max(range_m, 0.1)
        assert abs(error_m[1]) < 0.05
        assert abs(error_m[2]) < 0.3
        from_camera_m = np.array(obstacle["position_m"]) - source.position_m
        assert obstacle["distance_m"] == pytest.approx(np.linalg.norm(from_camera_m), rel=1e-12)
        true_px = scene.FOCAL_PX * scene.BASELINE_M / depth_m  # of the surface
        assert obstacle["disparity_px"] == pytest.approx(true_px, abs=1 / 16)
        size_m = [np.ptp(scene.BOARD_Y_M), np.ptp(scene.BOARD_Z_M)]
        assert obstacle["extent_m"] == pytest.approx(size_m, rel=0.2)


def test_the_warning_gives_distance_and_time(flight: list[dict]) -> None:
    warned = [frame["nearest_collision"]["valid"] for frame in flight]
    assert CONFIRMED_FROM <= warned.index(True) <= WARNED_FROM
    assert warned == sorted(warned)
    for frame, source in zip(flight, board_flight(), strict=True):
        nearest, obstacle = frame["nearest_collision"], frame["obstacles"][0]
        assert obstacle["in_collision_volume"] == nearest["valid"]
        if not nearest["valid"]:
            continue
        assert obstacle["world"] == lib.VISTA_WORLD_STANDS
        assert nearest["id"] == obstacle["id"]
        # The board is 5 m high: it is met as high as the camera, in its surface, and on the path.
        ahead, behind = np.array(nearest["position_m"]), np.array(obstacle["position_m"])
        assert ahead[0] < behind[0]
        assert abs(ahead[1] - source.position_m[1]) < 0.1
        assert behind[2] < ahead[2] <= scene.CAMERA_HEIGHT_M
        assert nearest["distance_m"] == pytest.approx(np.linalg.norm(ahead - source.position_m), rel=1e-12)
        assert nearest["time_to_collision_s"] == pytest.approx(
            source.board_distance_m / scene.SPEED_M_S, rel=0.02
        )


def test_a_warning_comes_with_how_likely_something_is_there() -> None:
    pipeline, warned = Pipeline(), 0
    for source in board_flight():
        pipeline.fly([source])
        probability, valid = pipeline.result.collision_probability, pipeline.result.nearest_collision.valid
        warned += valid
        assert 0.5 < probability <= 1.0 if valid else math.isnan(probability)
    assert warned > 3


def test_of_what_is_too_near_to_match_no_frame_tells_how_likely_it_is() -> None:
    random, pipeline = seeded(3), Pipeline()
    for source in board_flight()[:6]:
        grey = cv2.GaussianBlur(random.integers(0, 256, source.left.shape).astype(np.float32), (0, 0), 1.0)
        texture = np.clip(120.0 + 3.0 * (grey - grey.mean()), 0, 255).astype(np.uint8)
        pipeline.fly([replace(source, left=texture, words=np.full_like(source.words, INVALID))])
    assert pipeline.result.nearest_collision.id == lib.VISTA_ID_TOO_NEAR
    assert pipeline.result.nearest_collision.valid and math.isnan(pipeline.result.collision_probability)


@pytest.mark.parametrize("with_ground", [True, False], ids=["ground", "sky"])
def test_ground_and_empty_sky_are_no_obstacles(with_ground: bool) -> None:
    sources = [scene.render(index, with_board=False, with_ground=with_ground) for index in range(6)]
    for frame in Pipeline().fly(sources):
        assert frame["obstacles"] == []
        assert not frame["nearest_collision"]["valid"]


def test_a_board_beside_the_path_gives_no_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene, "BOARD_Y_M", (-9.0, -6.6))
    for frame in Pipeline().fly([scene.render(index) for index in range(6)]):
        assert len(frame["obstacles"]) == 1
        assert not frame["obstacles"][0]["in_collision_volume"]
        assert not frame["nearest_collision"]["valid"]


def test_fields_of_the_result(flight: list[dict]) -> None:
    pipeline, source = Pipeline(), board_flight()[0]
    pipeline.fly([source])
    r = pipeline.result
    assert r.valid_fraction == np.mean(source.words >= 0)
    assert r.stage_count == lib.vista_stage_count()
    stage_ms = [r.stage_ms[stage] for stage in range(r.stage_count)]
    assert all(t >= 0.0 for t in stage_ms)
    assert sum(stage_ms) <= r.host_ms + 1e-6  # and the looks at the clock
    accepted = sum(verdict == lib.VISTA_REGION_ACCEPTED for verdict in flight[0]["regions"])
    assert r.accepted_count == accepted == 1
    names = [ffi.string(lib.vista_stage_name(stage)).decode() for stage in range(r.stage_count)]
    assert names == [
        "motion", "noise", "words", "foveation", "health", "surface", "affinity", "segmentation",
        "refinement", "regions", "thin", "reconstruction", "tracking", "blind_zone", "terrain", "space",
        "map", "footing",
    ]  # fmt: skip
    assert ffi.string(lib.vista_stage_name(r.stage_count)) == b"unknown"


def test_python_gives_the_same_numbers(flight: list[dict]) -> None:
    pipeline = OpenPipeline(CALIBRATION, defaults())
    for source, expected in zip(board_flight(), flight, strict=True):
        pose = Pose(scene.WORLD_FROM_CAMERA, source.position_m)
        result = pipeline.process(source.left, source.words, source.t_ns, pose, scene.UP_WORLD)
        (obstacle,), (reference,) = result.obstacles, expected["obstacles"]
        for field in ("id", "confirmed", "coasting", "in_blind_zone", "age_frames", "distance_m"):
            assert getattr(obstacle, field) == reference[field]
        for field in ("disparity_px", "in_collision_volume"):
            assert getattr(obstacle, field) == reference[field]
        assert obstacle.world == ffi.string(lib.vista_world_verdict_name(reference["world"])).decode()
        assert obstacle.position_m.tolist() == reference["position_m"]
        assert obstacle.covariance_m2.ravel().tolist() == reference["covariance_m2"]
        assert list(obstacle.extent_m) == reference["extent_m"]
        assert result.outcome.region_count == len(expected["regions"])
        assert result.cell_intensity.tobytes() == expected["intensity"]
        assert result.cell_disparity_px.tobytes() == expected["disparity_px"]
        assert result.region_of_cell.tobytes() == expected["label"]
        drawn = pipeline.refine_boundaries(result.region_of_cell)
        left = result.region_of_pixel != drawn  # pixels of the ground that region/footing.h takes out
        assert np.all(result.region_of_pixel[left] == -1)
        assert {result.verdict_of_region[k] for k in np.unique(drawn[left])} <= {"ACCEPTED"}
        nearest = expected["nearest_collision"]
        assert (result.nearest_collision is not None) == nearest["valid"]
        if nearest["valid"]:
            assert result.nearest_collision.time_to_collision_s == nearest["time_to_collision_s"]


def test_without_poses_the_world_is_the_camera() -> None:
    pipeline = Pipeline()
    for index in range(4):  # the same view, tracker.confirm_hits times: the camera hovers before the board
        frame = Frame(scene.render(10))
        frame.c.pose, frame.c.up_world, frame.c.t_ns = ffi.NULL, ffi.NULL, index * scene.PERIOD_NS
        assert pipeline.process(frame) == "VISTA_OK"
    (obstacle,) = snapshot(pipeline.result)["obstacles"]
    source = scene.render(10)
    expected = scene.WORLD_FROM_CAMERA.T @ (scene.board_center_m() - source.position_m)
    assert obstacle["position_m"] == pytest.approx(expected, abs=0.3)
    nearest = plain(pipeline.result.nearest_collision)
    assert nearest["valid"] and nearest["time_to_collision_s"] == "nan"  # closing speed unknown


# ---- frames without a pose ----


def test_a_missing_pose_moves_no_track(flight: list[dict]) -> None:
    """One drop-out, then three: the board stays where it stands, and the velocity what it is."""
    pipeline, missing = Pipeline(), {9, 11, 12, 13}
    for index, source in enumerate(board_flight()):
        frame = Frame(source)
        if index in missing:
            frame.c.pose = ffi.NULL
        assert pipeline.process(frame) == "VISTA_OK"
        assert pipeline.result.motion.known == (index not in missing)
        (obstacle,) = snapshot(pipeline.result)["obstacles"]
        (expected,) = flight[index]["obstacles"]
        assert obstacle["id"] == expected["id"]
        assert obstacle["position_m"] == pytest.approx(expected["position_m"], abs=0.15)
        nearest, undisturbed = plain(pipeline.result.nearest_collision), flight[index]["nearest_collision"]
        assert nearest["valid"] == undisturbed["valid"]
        if nearest["valid"]:
            seconds = undisturbed["time_to_collision_s"]
            assert nearest["time_to_collision_s"] == pytest.approx(seconds, rel=0.02)


@pytest.mark.parametrize("jump_m", [1e200, 5000.0])
def test_one_absurd_pose_moves_no_track(flight: list[dict], jump_m: float) -> None:
    pipeline = Pipeline()
    for index, source in enumerate(board_flight()):
        frame = Frame(source)
        if index == 9:
            frame.pose.translation_m[1] += jump_m
        assert pipeline.process(frame) == "VISTA_OK"
        (obstacle,) = snapshot(pipeline.result)["obstacles"]
        (expected,) = flight[index]["obstacles"]
        assert obstacle["id"] == expected["id"]
        assert obstacle["position_m"] == pytest.approx(expected["position_m"], abs=0.15)
        velocity = list(pipeline.result.motion.velocity_m_s)
        assert velocity == pytest.approx([scene.SPEED_M_S if index else 0.0, 0, 0], abs=1e-6)


def test_poses_that_go_on_elsewhere_start_the_tracks_anew() -> None:
    pipeline = Pipeline()
    ids = []
    for index, source in enumerate(board_flight()):
        frame = Frame(source)
        if index >= 8:
            frame.pose.translation_m[0] += 1e5
        assert pipeline.process(frame) == "VISTA_OK"
        (obstacle,) = snapshot(pipeline.result)["obstacles"]
        ids.append(obstacle["id"])
        assert pipeline.result.motion.restarted == (index == 10)
    assert ids == [1] * 10 + [2] * 6
    assert obstacle["position_m"][0] == pytest.approx(scene.BOARD_X_M + 1e5, abs=0.3)
    assert obstacle["confirmed"]


# ---- determinism and memory ----


def test_a_second_pipeline_gives_the_same(flight: list[dict]) -> None:
    assert Pipeline().fly(board_flight()) == flight


def without_ids(snapshots: list[dict]) -> list[dict]:
    """Ids numbered in the order of their appearance."""
    order: dict[int, int] = {0: 0}

    def renumbered(item: dict) -> dict:
        return item | {"id": order.setdefault(item["id"], len(order))}

    return [
        frame
        | {
            "obstacles": [renumbered(o) for o in frame["obstacles"]],
            "nearest_collision": renumbered(frame["nearest_collision"]),
        }
        for frame in snapshots
    ]


def test_after_a_reset_only_the_ids_differ(flight: list[dict]) -> None:
    pipeline = Pipeline()
    first = pipeline.fly(board_flight())
    pipeline.reset()
    second = pipeline.fly(board_flight())  # at the same times again: those are forgotten, too
    assert {o["id"] for frame in second for o in frame["obstacles"]} == {2}
    assert without_ids(second) == without_ids(first) == without_ids(flight)


@pytest.mark.parametrize("shift", [0, 1, 8, 33, 63])
def test_memory_of_any_alignment_and_nothing_outside(shift: int, flight: list[dict]) -> None:
    pipeline = Pipeline(shift=shift)
    assert pipeline.status == "VISTA_OK"
    assert pipeline.fly(board_flight()[:4]) == flight[:4]
    assert pipeline.guards_hold


@pytest.mark.parametrize("strides", [(scene.WIDTH + 1, 0), (0, scene.WIDTH + 13), (512, 777)])
def test_strides_larger_than_the_width(strides: tuple[int, int], flight: list[dict]) -> None:
    pipeline = Pipeline()
    for source, expected in zip(board_flight()[:4], flight, strict=False):
        assert pipeline.process(Frame(source, *strides)) == "VISTA_OK"
        assert snapshot(pipeline.result) == expected


def test_nothing_of_the_frame_is_kept(flight: list[dict]) -> None:
    pipeline = Pipeline()
    for source, expected in zip(board_flight(), flight, strict=True):
        frame = Frame(source)
        assert pipeline.process(frame) == "VISTA_OK"
        frame.poison()
        assert snapshot(pipeline.result) == expected


@pytest.mark.parametrize("shift", [0, 1])
def test_too_little_memory(flight: list[dict], shift: int) -> None:
    needed = bytes_needed(default_parameters(), default_camera())[1]

    def with_bytes(size: int) -> Pipeline:
        pipeline = Pipeline(shift=shift, missing_bytes=needed - size)
        assert pipeline.guards_hold, size
        assert (pipeline.status == "VISTA_OK") == (pipeline.handle != ffi.NULL)
        assert pipeline.status in ("VISTA_OK", "VISTA_ERROR_MEMORY"), size
        return pipeline

    low, high = 0, needed  # what is asked for is a bound: bisect for what is used
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if with_bytes(middle).status == "VISTA_OK" else (middle, high)
    for size in (0, 1, 63, 64, 5000, needed // 8, low):
        assert with_bytes(size).status == "VISTA_ERROR_MEMORY", size
    tightest = with_bytes(high)
    assert tightest.fly(board_flight()) == flight
    assert tightest.guards_hold
