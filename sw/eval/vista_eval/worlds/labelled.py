"""Render labelled single scenes: python -m vista_eval.worlds.labelled OUT_DIR

The segmentation is tuned and scored on them. Each is a flight of one frame, scene_NNNN of seed NNNN; even
seeds are the group dev.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from tqdm import tqdm

from vista_eval.render.flight import Flight, Quality, is_complete, render_flight
from vista_eval.render.scene import Scene
from vista_eval.render.trajectory import START_NS, BodyState, rotation_from_angles
from vista_eval.worlds.random_scene import Viewpoint, random_scene

SCENES = 160


@lru_cache(maxsize=1)
def drawn(seed: int) -> tuple[Scene, Viewpoint]:
    return random_scene(seed)


@dataclass(frozen=True)
class Still:
    """An approach of one frame, from where the scene of this seed is to be seen."""

    seed: int
    frames: int = 1
    rate_hz: float = 10.0
    speed_m_s: float = 0.0
    last_range_m: float = 0.0

    @property
    def altitude_m(self) -> float:
        return drawn(self.seed)[1].altitude_m

    def before_last_s(self, _: float) -> float:
        return 0.0

    def state_at(self, _: float) -> BodyState:
        view = drawn(self.seed)[1]
        pose = np.eye(4)
        pose[:3, :3] = rotation_from_angles(view.roll_deg, view.pitch_deg, 0.0)
        pose[2, 3] = view.altitude_m
        return BodyState(START_NS, pose, np.zeros(3))


def scene_of_seed(_: float, seed: int) -> Scene:
    return drawn(seed)[0]


def labelled(seed: int) -> Flight:
    name = f"scene_{seed:04d}"
    return Flight(
        name,
        f"random scene {seed}",
        "test" if seed % 2 else "dev",
        Still(seed),
        scene_of_seed,
        seed=seed,
    )


def render_labelled(seed: int, out: Path, quality: Quality = "full") -> None:
    """Renders out/scene_NNNN if it is not there. Raises OSError where `render_flight` does."""
    flight = labelled(seed)
    if not is_complete(flight, out / flight.name, quality):
        list(render_flight(flight, out / flight.name, quality))


def main() -> int:
    parser = argparse.ArgumentParser(prog="vista_eval.worlds.labelled", description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT_DIR")
    parser.add_argument("--count", type=int, default=SCENES, help=f"seeds 0 to count - 1 (default {SCENES})")
    arguments = parser.parse_args()
    try:
        for seed in tqdm(range(arguments.count), desc="rendering the scenes", unit="scene"):
            render_labelled(seed, arguments.out)
    except OSError as error:
        print(f"vista_eval.worlds.labelled: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; the next run goes on from here", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
