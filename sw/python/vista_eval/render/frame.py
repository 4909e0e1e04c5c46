"""Renders one stereo frame and its truth."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import numpy as np

from vista_eval.dataset.files import write_image
from vista_eval.dataset.layout import image_path
from vista_eval.dataset.truth import truth_path, write_frame_truth
from vista_eval.render.rig import LEFT, RIGHT, Rig
from vista_eval.render.scene import Scene
from vista_eval.render.sensor import Sensor, expose
from vista_eval.render.trajectory import BodyState
from vista_eval.render.view import View


class SceneRenderer(Protocol):
    """A scene, seen from any pose at any time."""

    @property
    def scene(self) -> Scene: ...
    def move_to(self, t_s: float) -> None: ...
    def radiance(self, world_from_camera: np.ndarray, seed: int) -> np.ndarray: ...
    def view(self, world_from_camera: np.ndarray) -> View: ...


def frame_paths(flight: Path, t_ns: int) -> list[Path]:
    images = [image_path(flight, camera, t_ns) for camera in (LEFT, RIGHT)]
    return [*images, *(truth_path(flight, kind, t_ns) for kind in ("disparity", "label", "objects"))]


def render_frame(
    renderer: SceneRenderer, rig: Rig, sensor: Sensor, state: BodyState, seed: tuple[int, int], out: Path
) -> None:
    """Writes what `out` lacks of the frame. `seed`: of the flight, and the frame's index."""
    for camera in (LEFT, RIGHT):
        path = image_path(out, camera, state.t_ns)
        if not path.exists():
            pose = state.world_from_body @ rig.body_from_mounted_camera(camera)
            radiance = renderer.radiance(pose, seed=2 * seed[1] + camera) * renderer.scene.exposure
            write_image(path, expose(sensor, radiance, camera, (*seed, camera)))
    if not all(path.exists() for path in frame_paths(out, state.t_ns)):
        pose = state.world_from_body @ rig.body_from_camera(LEFT)
        write_frame_truth(out, state.t_ns, renderer.view(pose), len(renderer.scene.things), rig, pose)
