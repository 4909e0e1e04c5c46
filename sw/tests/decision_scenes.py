"""Random scenes of many kinds, as recordings of words and poses: what the planner decides over."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from space_library import INVALID, WITHOUT_END, Wall, scene
from stage_library import camera
from vista import parameters
from vista.geometry import Calibration, Pose
from vista.recording import Content, Recorder, rectified_source
from vista.rectify import Rectifier
from vista.sequence import Frame

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 320, 240, 200.0, 0.4
UP_WORLD = np.array([0.0, -1.0, 0.0])
PERIOD_NS, START_NS = 100_000_000, 1_700_000_000_000_000_000
FRAMES = 8
Random = np.random.Generator
Things = Callable[[Random], list[Wall]]


def between(rng: Random, low: float, high: float) -> tuple[float, float]:
    a, b = sorted(rng.uniform(low, high, 2))
    return float(a), float(b) + 0.3


def boxes(rng: Random) -> list[Wall]:
    return [
        Wall(rng.uniform(4, 40), between(rng, -20, 20), between(rng, -6, 6))
        for _ in range(rng.integers(1, 8))
    ]


def poles(rng: Random) -> list[Wall]:
    """Trunks of a wood."""
    places = zip(rng.uniform(3, 45, 25), rng.uniform(-25, 25, 25), rng.uniform(0.1, 0.5, 25), strict=True)
    return [Wall(z, (x - half, x + half), (-12.0, 20.0)) for z, x, half in places]


def wires(rng: Random) -> list[Wall]:
    return [Wall(z, WITHOUT_END, (y, y + 0.06)) for z, y in rng.uniform((6, -2), (25, 2), (4, 2))]


def gap(rng: Random) -> list[Wall]:
    """A wall with a gap, which a vehicle may or may not pass."""
    z, x, half = rng.uniform(8, 30), rng.uniform(-6, 6), rng.uniform(0.3, 4.0)
    return [Wall(z, (-60.0, x - half), (-20.0, 20.0)), Wall(z, (x + half, 60.0), (-20.0, 20.0))]


def plain(rng: Random) -> list[Wall]:
    """A wall of which nothing is matched, and something before it."""
    return [Wall(rng.uniform(6, 30), textured=False), *boxes(rng)[:2]]


def corridor(rng: Random) -> list[Wall]:
    """Walls that end in steps on both sides, and one across."""
    steps = [Wall(z, (-30.0, -1.0 - rng.uniform(0, 5))) for z in np.arange(4.0, 30.0, 4.0)]
    steps += [Wall(z, (1.0 + rng.uniform(0, 5), 30.0)) for z in np.arange(5.0, 30.0, 4.0)]
    return [*steps, Wall(rng.uniform(12, 45))]


def nothing(rng: Random) -> list[Wall]:
    return []


KINDS: dict[str, Things] = {
    kind.__name__: kind for kind in (boxes, poles, wires, gap, plain, corridor, nothing)
}


def turned(rng: Random) -> NDArray[np.float64]:
    """A level turn, and a small one around each axis. World from camera."""
    yaw, pitch, roll = rng.uniform((-0.4, -0.15, -0.15), (0.4, 0.15, 0.15))
    (a, b), (c, d), (e, f) = ((np.cos(angle), np.sin(angle)) for angle in (yaw, pitch, roll))
    about_y = np.array([[a, 0, b], [0, 1, 0], [-b, 0, a]])
    about_x = np.array([[1, 0, 0], [0, c, -d], [0, d, c]])
    about_z = np.array([[e, -f, 0], [f, e, 0], [0, 0, 1]])
    return np.asarray(about_y @ about_x @ about_z)


def disturbed(rng: Random, words: NDArray[np.int16]) -> NDArray[np.int16]:
    """Words without a match here and there, in patches too, some that are off, and noise of a sixteenth."""
    noise = np.where(words > 16, words + rng.integers(-1, 2, words.shape), words)
    chance = rng.random(words.shape)
    noise = np.where((words > 0) & (chance < 0.01), rng.integers(16, 1000, words.shape), noise)
    patches = np.kron(rng.random((HEIGHT // 16, WIDTH // 16)) < rng.uniform(0, 0.3), np.ones((16, 16), bool))
    noise = np.where(patches | (chance > 0.95) | (noise > 1008), INVALID, noise)
    return np.asarray(noise, np.int16)


def values_of(rng: Random) -> parameters.Values:
    """A vehicle and the room that it needs."""
    values = parameters.defaults()
    values["stereo"]["levels"] = 1
    values["obstacle_map"]["collision_radius_m"] = float(rng.choice([0.5, 0.8, 1.0, 1.5]))
    values["plan"]["climb_max_m_s"] = float(rng.choice([0.0, 2.0, 3.0]))
    values["plan"]["acceleration_max_m_s2"] = float(rng.uniform(3.0, 8.0))
    values["plan"]["bank_max_deg"] = float(rng.uniform(30.0, 55.0))
    return values


def record(path: Path, kind: str, rng: Random, frames: int = FRAMES) -> Path:
    """A camera that flies through a scene, from a place anywhere in the world; something may move across."""
    things, values = KINDS[kind](rng), values_of(rng)
    lens = camera(WIDTH, HEIGHT, FOCAL_PX, BASELINE_M)
    source = rectified_source(
        Calibration(WIDTH, HEIGHT, FOCAL_PX, (WIDTH - 1) / 2, (HEIGHT - 1) / 2, BASELINE_M), False, UP_WORLD
    )
    start_m, velocity = rng.uniform(-500, 500, 3), rng.uniform((-1, -0.5, 0), (1, 0.5, 10))
    ground_m = float(rng.uniform(3, 15)) if rng.random() < 0.8 else None
    mover = boxes(rng)[0] if rng.random() < 0.3 else None
    mover_m_s = float(rng.uniform(-6, 6))
    turn, grey = turned(rng), rng.integers(0, 256, (HEIGHT, WIDTH), np.uint8)
    with Recorder(path, source, Rectifier(source.calibration), values, Content.LEFT) as recorder:
        for index in range(frames):
            t_s = index * PERIOD_NS * 1e-9
            walls = list(things)
            if mover is not None:
                (first, last), off_m = mover.x_m, mover_m_s * t_s
                walls.append(Wall(mover.z_m, (first + off_m, last + off_m), mover.y_m))
            look = scene(walls, ground_m, velocity * t_s, turn, lens)
            words = disturbed(rng, look.words)
            left = np.where(words > 0, (7 * words.astype(np.int32)) % 200, grey // 8 + 200).astype(np.uint8)
            pose = Pose(turn, start_m + velocity * t_s)
            t_ns = START_NS + index * PERIOD_NS
            recorder.write(Frame(index, t_ns, left, left, pose), [words])
    return path
