"""Renders one stereo frame and its truth."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import numpy as np

from vista_eval.dataset.files import write_image
from vista_eval.dataset.layout import image_path
from vista_eval.dataset.truth import truth_path, write_frame_truth
from vista_eval.render.flight import Flight
from vista_eval.render.optics import Exposure, FlawedSensor, through_lens
from vista_eval.render.rig import LEFT, RIGHT
from vista_eval.render.scene import Scene
from vista_eval.render.sensor import expose
from vista_eval.render.trajectory import Course
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


def render_frame(renderer: SceneRenderer, flight: Flight, course: Course, frame: int, out: Path) -> None:
    """Writes what `out` lacks of the frame. course: as it is flown."""
    rig, seed, state = flight.rig, flight.seed, course.state_at(frame)
    for camera in (LEFT, RIGHT):
        path = image_path(out, camera, state.t_ns)
        if not path.exists():
            pose = state.world_from_body @ rig.body_from_mounted_camera(camera)
            radiance = renderer.radiance(pose, seed=2 * frame + camera) * renderer.scene.exposure
            if isinstance(flight.sensor, FlawedSensor):
                exposure = exposure_of(renderer, flight, flight.sensor, course, camera, frame)
                radiance = through_lens(flight.sensor, radiance, exposure)
            write_image(path, expose(flight.sensor, radiance, camera, (seed, frame, camera)))
    if not all(path.exists() for path in frame_paths(out, state.t_ns)):
        pose = state.world_from_body @ rig.body_from_camera(LEFT)
        write_frame_truth(out, state.t_ns, renderer.view(pose), len(renderer.scene.things), rig, pose)


def exposure_of(
    renderer: SceneRenderer, flight: Flight, lens: FlawedSensor, course: Course, camera: int, frame: int
) -> Exposure:
    half = lens.exposure_s * course.rate_hz / 2
    opens, pose, closes = (
        course.state_at(frame + offset).world_from_body @ flight.rig.body_from_mounted_camera(camera)
        for offset in (-half, 0.0, half)
    )
    depth_m = renderer.view(pose).depth_m
    return Exposure(flight.rig, camera, opens, pose, closes, depth_m, renderer.scene.to_sun, flight.seed)
