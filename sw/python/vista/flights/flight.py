"""A flight: what is seen, from where, with what; rendered frame by frame, taken up again where it stopped."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path

from .rig import LEFT, PAPER_RIG, RIGHT, Rig
from .scene import Scene, sign_in_meadow
from .sensor import Sensor, expose
from .trajectory import FOOT_M, Approach, state_at
from .writer import image_path, write_image, write_sequence, write_text, write_truth

MARKER = "content.sha256"


@dataclass(frozen=True)
class Flight:
    approach: Approach
    scene: Callable[[float, int], Scene] = sign_in_meadow  # of altitude in metres and seed
    rig: Rig = PAPER_RIG
    sensor: Sensor = field(default_factory=Sensor)
    rays: int = 4
    seed: int = 1


# 30 ft/s at 21 ft straight at the sign, from 58 m to 22 m.
SIGN_AT_30_FT_S = Flight(Approach(21 * FOOT_M, 30 * FOOT_M, last_range_m=22.0, frames=40, rate_hz=10.0))


def content_sha256(flight: Flight) -> str:
    """Stands for every byte of the rendered flight: its parameters, this code, the libraries."""
    parameters = (flight.scene.__name__, flight.approach, flight.rig, flight.sensor, flight.rays, flight.seed)
    digest = hashlib.sha256(repr(parameters).encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    for library in ("mitsuba", "numpy", "opencv-python-headless"):
        digest.update(version(library).encode())
    return digest.hexdigest()


def is_complete(flight: Flight, out: Path) -> bool:
    return (out / "truth.json").exists() and holds(flight, out)


def holds(flight: Flight, out: Path) -> bool:
    marker = out / MARKER
    return marker.exists() and marker.read_text().strip() == content_sha256(flight)


def prepare(flight: Flight, out: Path) -> None:
    """Empties a folder that another flight was rendered to. Raises OSError if it holds anything else."""
    if holds(flight, out):
        return
    if (out / MARKER).exists():
        shutil.rmtree(out)
    elif out.exists() and any(out.iterdir()):
        raise OSError(f"{out}: not empty and not a rendered flight")
    write_text(out / MARKER, [content_sha256(flight)])


def render_missing(flight: Flight, out: Path) -> Iterator[int]:
    """Renders what `out` lacks, yielding each frame's index when both its images are there."""
    from .render import Renderer  # Mitsuba takes a second to load: not for a flight that is complete

    approach, rig = flight.approach, flight.rig
    states = [state_at(approach, frame) for frame in range(approach.frames)]
    scene = flight.scene(approach.altitude_m, flight.seed)
    renderer = None
    for frame, state in enumerate(states):
        for camera in (LEFT, RIGHT):
            path = image_path(out, camera, state.t_ns)
            if path.exists():
                continue
            renderer = renderer or Renderer(scene, rig, flight.rays)
            pose = state.world_from_body @ rig.body_from_camera(camera)
            radiance = renderer.radiance(pose, seed=2 * frame + camera)
            write_image(path, expose(flight.sensor, radiance, camera, (flight.seed, frame, camera)))
        yield frame
    write_sequence(out, rig, states, approach.rate_hz)
    write_truth(out, rig, scene.obstacles)
