"""Renders a flight frame by frame, and continues where it stopped."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from vista_eval.cache import code_digest, content_sha256
from vista_eval.dataset.files import write_image, write_text
from vista_eval.dataset.layout import image_path, write_sequence
from vista_eval.dataset.truth import TRUTH, VERSION, flight_truth, truth_path, write_frame_truth
from vista_eval.render.course import NO_FAULTS, BodyState, Course, PoseFaults, recorded_states
from vista_eval.render.optics import Exposure, FlawedSensor, through_lens
from vista_eval.render.rig import LEFT, PAPER_RIG, RIGHT, Rig
from vista_eval.render.scene import Scene
from vista_eval.render.sensor import Sensor, expose

if TYPE_CHECKING:
    from vista_eval.render.renderer import Renderer

# To be raised when the pictures of the same scene change: flights of another version are rendered anew, and
# none of them is in the frozen set any more.
PICTURES = ("fast", 4), 4  # version of the renderer, rays that a pixel gets besides the first
MARKER = "content.json"
Quality = Literal["full", "quick"]

QUICK_FIRST_RANGE_M = 66.0
QUICK_FRAMES = 60


@dataclass(frozen=True)
class Flight:
    name: str
    title: str
    split: Literal["dev", "test"]
    approach: Course
    scene: Callable[[float, int], Scene]  # of altitude in metres and seed
    rig: Rig = PAPER_RIG
    sensor: Sensor = field(default_factory=Sensor)
    seed: int = 1
    family: str = ""  # of sampled worlds: the kind of content, scored by itself
    pose_faults: PoseFaults = NO_FAULTS


def approach_of(flight: Flight, quality: Quality) -> Course:
    """Quick: only the end of the flight."""
    whole = flight.approach
    if quality == "full":
        return whole
    step_m = whole.speed_m_s / whole.rate_hz
    near_enough = int((QUICK_FIRST_RANGE_M - whole.last_range_m) / step_m) + 1
    return replace(whole, frames=min(whole.frames, QUICK_FRAMES, near_enough))


def frames_of(flight: Flight, quality: Quality = "full") -> int:
    return approach_of(flight, quality).frames


def states_of(flight: Flight, quality: Quality = "full") -> list[BodyState]:
    approach = approach_of(flight, quality)
    return [approach.state_at(frame) for frame in range(approach.frames)]


def about(flight: Flight) -> dict:
    approach = flight.approach
    return {
        "name": flight.name,
        "title": flight.title,
        "split": flight.split,
        **({"family": flight.family} if flight.family else {}),
        "speed_m_s": approach.speed_m_s,
        "rate_hz": approach.rate_hz,
    }


@lru_cache(maxsize=1)
def scene_of(flight: Flight) -> Scene:
    return flight.scene(flight.approach.altitude_m, flight.seed)


# ---- what a folder holds ----


def sources_of(flight: Flight, quality: Quality) -> str:
    """A digest that is quickly made, without the scene: equal means that the flight's content is."""
    maker = code_digest(flight.scene.__module__)
    return content_sha256(PICTURES, maker, flight, approach_of(flight, quality))


def content_of(flight: Flight, quality: Quality) -> str:
    """What stands for every byte of a rendered flight: geometry and albedo of its scene, its parameters, and
    the version of the renderer. A change elsewhere, in another flight's scene say, leaves it as it is."""
    version, rays = PICTURES
    return content_sha256(
        version,
        scene_of(flight),
        (states_of(flight, quality), flight.rig, flight.sensor, rays, flight.seed),
        *([] if flight.pose_faults == NO_FAULTS else [flight.pose_faults]),
    )


def read_marker(out: Path) -> dict:
    try:
        return json.loads((out / MARKER).read_text())
    except FileNotFoundError:
        return {}


def holds(flight: Flight, out: Path, quality: Quality) -> bool:
    """Whether what is in `out` is of this flight. If its scene's maker has changed, the scene decides."""
    marker, sources = read_marker(out), sources_of(flight, quality)
    if marker.get("sources") == sources:
        return True
    if not marker or marker["quality"] != quality:
        return False
    if marker["content"] != content_of(flight, quality):
        return False
    write_text(out / MARKER, [json.dumps(marker | {"sources": sources})])
    return True


def is_complete(flight: Flight, out: Path, quality: Quality = "full") -> bool:
    if not (out / TRUTH).exists() or not holds(flight, out, quality):
        return False
    truth = json.loads((out / TRUTH).read_text())
    told = {"version": VERSION, **about(flight)}
    return all(truth.get(key) == value for key, value in told.items())


def prepare(flight: Flight, out: Path, quality: Quality = "full") -> None:
    """Empties a folder that another flight was rendered to.

    Raises OSError if it holds anything else, or frames of another quality, which may have taken long.
    """
    if holds(flight, out, quality):
        return
    marker = read_marker(out)
    if marker and marker["quality"] != quality:
        raise OSError(f"{out}: holds a flight of {marker['quality']} quality; choose another folder")
    if marker:
        shutil.rmtree(out)
    elif out.exists() and any(out.iterdir()):
        raise OSError(f"{out}: not empty and not a rendered flight")
    digests = {"sources": sources_of(flight, quality), "content": content_of(flight, quality)}
    write_text(out / MARKER, [json.dumps({"quality": quality, **digests})])


# ---- rendering ----


def render_flight(flight: Flight, out: Path, quality: Quality = "full") -> Iterator[int]:
    """Renders what `out` lacks, yielding each frame's index when all of it is there.

    Raises OSError where `prepare` does.
    """
    if is_complete(flight, out, quality):
        yield from range(frames_of(flight, quality))
        return
    prepare(flight, out, quality)
    approach, states = approach_of(flight, quality), states_of(flight, quality)
    for frame in range(approach.frames):
        render_frame(flight, out, quality, frame)
        yield frame
    write_sequence(out, flight.rig, recorded_states(approach, flight.pose_faults), approach.rate_hz)
    first_s = approach.before_last_s(0)
    truth = flight_truth(out, about(flight), scene_of(flight), flight.rig, states, first_s)
    write_text(out / TRUTH, [json.dumps(truth)])


@lru_cache(maxsize=1)
def renderer_of(flight: Flight) -> Renderer:
    from vista_eval.render.renderer import Renderer  # Embree takes a moment, and a complete flight needs none

    return Renderer(scene_of(flight), flight.rig)


def frame_paths(flight: Path, t_ns: int) -> list[Path]:
    images = [image_path(flight, camera, t_ns) for camera in (LEFT, RIGHT)]
    return [*images, *(truth_path(flight, kind, t_ns) for kind in ("disparity", "label", "objects"))]


def render_frame(flight: Flight, out: Path, quality: Quality, frame: int) -> None:
    """Writes what `out` lacks of the frame and its truth."""
    course, rig = approach_of(flight, quality), flight.rig
    state = course.state_at(frame)
    if all(path.exists() for path in frame_paths(out, state.t_ns)):
        return
    renderer = renderer_of(flight)
    renderer.move_to(course.before_last_s(frame))
    for camera in (LEFT, RIGHT):
        path = image_path(out, camera, state.t_ns)
        if not path.exists():
            pose = state.world_from_body @ rig.body_from_mounted_camera(camera)
            radiance = renderer.radiance(pose) * renderer.scene.exposure
            if isinstance(flight.sensor, FlawedSensor):
                exposure = exposure_of(renderer, flight, flight.sensor, course, camera, frame)
                radiance = through_lens(flight.sensor, radiance, exposure)
            write_image(path, expose(flight.sensor, radiance, camera, (flight.seed, frame, camera)))
    pose = state.world_from_body @ rig.body_from_camera(LEFT)
    write_frame_truth(out, state.t_ns, renderer.view(pose), len(renderer.scene.things), rig, pose)


def exposure_of(
    renderer: Renderer, flight: Flight, lens: FlawedSensor, course: Course, camera: int, frame: int
) -> Exposure:
    half = lens.exposure_s * course.rate_hz / 2
    mount: np.ndarray = flight.rig.body_from_mounted_camera(camera)
    opens, pose, closes = (
        course.state_at(frame + offset).world_from_body @ mount for offset in (-half, 0.0, half)
    )
    depth_m = renderer.view(pose).depth_m
    return Exposure(flight.rig, camera, opens, pose, closes, depth_m, renderer.scene.to_sun, flight.seed)
