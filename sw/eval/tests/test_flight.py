"""The rendered flight: what the images show is what the truth says, and what was rendered once is kept."""

from __future__ import annotations

import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from vista.geometry import quaternion_from_rotation, rotation_from_quaternion
from vista.sequence import open_sequence
from vista_eval.dataset import files
from vista_eval.dataset.layout import image_path
from vista_eval.render.course import rotation_from_angles
from vista_eval.render.flight import Flight, is_complete, prepare, render_flight
from vista_eval.render.renderer import Renderer
from vista_eval.render.rig import LEFT, RIGHT, Rig, View
from vista_eval.render.scene import Scene
from vista_eval.worlds.farm import SIGN_AT_30_FT_S
from vista_eval.worlds.things import SIGN_HEIGHT_M, SIGN_WIDTH_M, sign

pytestmark = pytest.mark.slow

SMALL_RIG = Rig(width_px=160, height_px=120, focal_px=250.0, baseline_m=0.4572)


def sign_alone(altitude_m: float, seed: int) -> Scene:
    """Nothing below it: a ground takes seconds to lay."""
    return Scene((sign(altitude_m, seed),), to_sun=(-0.6, 0.4, 0.7), sky="overcast")


SHORT = replace(
    SIGN_AT_30_FT_S,
    rig=SMALL_RIG,
    scene=sign_alone,
    approach=replace(SIGN_AT_30_FT_S.approach, frames=2),
)


def render(flight: Flight, out: Path) -> list[int]:
    return list(render_flight(flight, out, "quick"))


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("flight") / "short"
    assert render(SHORT, out) == [0, 1]
    return out


def camera_poses(flight: Flight, frame: int) -> list[np.ndarray]:
    body = flight.approach.state_at(frame).world_from_body
    return [body @ flight.rig.body_from_camera(camera) for camera in (LEFT, RIGHT)]


def above_the_pole(view: View, rig: Rig, pose: np.ndarray) -> np.ndarray:
    """Pixels no lower than the sign's board."""
    height_m = view.world_points_m(rig, pose)[..., 2]
    return height_m > SIGN_AT_30_FT_S.approach.altitude_m - SIGN_HEIGHT_M / 2


def test_the_sign_is_where_the_truth_projects_it() -> None:
    """Centre of the sign's pixels in both images against its projection, and their disparity against f B / Z.
    Edges fall on whole pixels, which moves a centre by up to half of one; over frames that averages out."""
    rig = replace(SMALL_RIG, width_px=320, height_px=240, focal_px=1000.0)
    flight = replace(SIGN_AT_30_FT_S, rig=rig)
    scene = sign_alone(flight.approach.altitude_m, flight.seed)
    renderer = Renderer(scene, rig)
    center_world = np.array([*scene.things[0].center_m, 1.0])
    errors_px = []
    for frame in range(20, 40, 2):
        seen = []
        for pose in camera_poses(flight, frame):
            truth = renderer.view(pose)
            v, u = np.nonzero((truth.label == 1) & above_the_pole(truth, rig, pose))
            seen.append((u.mean(), v.mean()))
            center_camera = (np.linalg.inv(pose) @ center_world)[:3]
            z_m = center_camera[2]
            errors_px.append(seen[-1] - rig.project(center_camera))
            assert np.median(truth.depth_m[v, u]) == pytest.approx(z_m, rel=2e-3)
            area_px = SIGN_WIDTH_M * SIGN_HEIGHT_M * (rig.focal_px / z_m) ** 2
            assert len(u) == pytest.approx(area_px, rel=0.1)
        disparity = seen[LEFT][0] - seen[RIGHT][0]
        assert disparity == pytest.approx(rig.focal_px * rig.baseline_m / z_m, abs=0.71)
    assert np.abs(errors_px).max() < 0.5
    assert np.abs(np.mean(errors_px, axis=0)).max() < 0.2


def test_the_reader_gets_the_poses_that_were_flown(rendered: Path) -> None:
    sequence = open_sequence(rendered)
    assert len(sequence.frames) == 2
    for frame, of_frame in enumerate(sequence.frames):
        expected = camera_poses(SHORT, frame)[LEFT]
        np.testing.assert_allclose(of_frame.world_from_camera.rotation, expected[:3, :3], atol=1e-8)
        np.testing.assert_allclose(of_frame.world_from_camera.translation_m, expected[:3, 3], atol=1e-8)
    truth = json.loads((rendered / "truth.json").read_text())
    assert truth["objects"][0]["position_m"] == pytest.approx([0.0, 0.0, 6.4008])
    assert truth["rig"]["baseline_m"] == SMALL_RIG.baseline_m


def test_quaternions_are_those_of_the_rotations() -> None:
    for angles in ((0.0, 0.0, 0.0), (2.0, -3.0, 40.0), (-10.0, 5.0, -120.0)):
        rotation = rotation_from_angles(*angles)
        np.testing.assert_allclose(
            rotation_from_quaternion(quaternion_from_rotation(rotation)), rotation, atol=1e-12
        )


def test_a_seed_gives_the_same_bytes_and_another_one_others(rendered: Path, tmp_path: Path) -> None:
    bytes_of = []
    for name, flight in (("again", SHORT), ("another", replace(SHORT, seed=2))):
        render(flight, tmp_path / name)
        path = image_path(tmp_path / name, LEFT, flight.approach.state_at(0).t_ns)
        bytes_of.append(path.read_bytes())
    first = image_path(rendered, LEFT, SHORT.approach.state_at(0).t_ns).read_bytes()
    assert bytes_of[0] == first != bytes_of[1]


def test_only_what_is_missing_is_rendered(rendered: Path) -> None:
    paths = [
        image_path(rendered, camera, SHORT.approach.state_at(frame).t_ns)
        for frame in (0, 1)
        for camera in (LEFT, RIGHT)
    ]
    assert is_complete(SHORT, rendered, "quick")
    before = {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in paths}
    paths[3].unlink()
    (rendered / "truth.json").unlink()
    assert not is_complete(SHORT, rendered, "quick")
    assert render(SHORT, rendered) == [0, 1]
    assert is_complete(SHORT, rendered, "quick")
    for path in paths[:3]:
        assert (path.stat().st_mtime_ns, path.read_bytes()) == before[path]
    assert paths[3].read_bytes() == before[paths[3]][1]


def test_an_interruption_leaves_whole_images_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "flight"
    written = []

    def interrupted_encode(extension: str, image: np.ndarray) -> tuple[bool, np.ndarray]:
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(extension)
        return cv2_imencode(extension, image)

    cv2_imencode = cv2.imencode
    monkeypatch.setattr(files.cv2, "imencode", interrupted_encode)
    with pytest.raises(KeyboardInterrupt):
        render(SHORT, out)
    assert not is_complete(SHORT, out, "quick")
    images = sorted(out.rglob("*.png"))
    assert len(images) == 2
    assert all(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).shape == (120, 160) for path in images)
    assert not list(out.rglob(".*"))


def test_two_programs_may_write_the_same_image(tmp_path: Path) -> None:
    image = np.full((120, 160), 7, np.uint8)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: files.write_image(tmp_path / "0.png", image), range(100)))
    assert [path.name for path in tmp_path.iterdir()] == ["0.png"]
    assert (cv2.imread(str(tmp_path / "0.png"), cv2.IMREAD_GRAYSCALE) == image).all()


def test_a_folder_with_other_things_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(OSError, match="not a rendered flight"):
        prepare(SHORT, tmp_path, "quick")
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_another_flight_replaces_an_earlier_one(rendered: Path, tmp_path: Path) -> None:
    out = tmp_path / "flight"
    shutil.copytree(rendered, out)
    prepare(replace(SHORT, approach=replace(SHORT.approach, frames=1)), out, "quick")
    assert not list(out.rglob("*.png"))
