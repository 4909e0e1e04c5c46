"""Images, parameters and replayable random numbers for the engine's tests."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from random_seed import seed_of
from vista_model import Parameters

Pair = tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]
_DATA = Path(os.environ.get("VISTA_SHARED_DATA") or Path(__file__).resolve().parents[3] / "shared" / "data")


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """A failing test shows the command that reruns it."""
    seed = seed_of(request.node.nodeid)
    print(f"rerun: VISTA_SEED={seed} .venv/bin/python -m pytest '{request.node.nodeid}'")
    return np.random.default_rng(seed)


@pytest.fixture
def random_pair(rng: np.random.Generator) -> Callable[[int, int], Pair]:
    """Noise, few grey values, or a texture of random grain, shifted and noisy: matches, ties and flats."""

    def make(height: int, width: int) -> Pair:
        kind = rng.integers(4)
        if kind == 0:
            return tuple(rng.integers(0, 256, (2, height, width), dtype=np.uint8))
        if kind == 1:  # few grey values: many equal costs
            return tuple((rng.integers(0, 2, (2, height, width)) * 255).astype(np.uint8))
        scene = rng.integers(0, 256, (height, width + 300)).astype(np.float32)
        scene = cv2.GaussianBlur(scene, (0, 0), float(rng.uniform(0.4, 4)))
        scene = cv2.normalize(scene, None, 0, float(rng.integers(5, 256)), cv2.NORM_MINMAX)
        shift = np.full(height, rng.integers(0, 60)) if kind == 2 else np.linspace(0, 120, height).astype(int)
        noise = rng.integers(0, int(rng.integers(1, 20)), (height, width))
        left = scene[:, 150 : 150 + width]
        right = np.stack([row[150 + d : 150 + d + width] for row, d in zip(scene, shift, strict=True)])
        return left.astype(np.uint8), np.clip(right + noise, 0, 255).astype(np.uint8)

    return make


@pytest.fixture
def random_parameters(rng: np.random.Generator) -> Callable[..., Parameters]:
    def make(**fixed: object) -> Parameters:
        values: dict[str, object] = {
            "num_disparities": 16 * int(rng.integers(1, 17)),
            "block_size": 2 * int(rng.integers(2, 11)) + 1,
            "prefilter": str(rng.choice(["xsobel", "none"])),
            "prefilter_cap": int(rng.integers(1, 64)),
            "texture_threshold": int(rng.choice([0, 1, 10, 507, 3000, 30000])),
            "uniqueness_ratio": int(rng.choice([0, 1, 5, 15, 40, 100])),
            "lr_max_diff": [None, 0, 1, 5, 300][int(rng.integers(5))],
        }
        return Parameters(**{**values, **fixed})

    return make


def _grey(path: Path) -> npt.NDArray[np.uint8]:
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert image is not None, path
    return image


@pytest.fixture(scope="session")
def real_pairs() -> list[Pair]:
    """Outdoor and indoor pairs of several sizes."""
    if not _DATA.is_dir():
        pytest.skip(f"no real stereo pairs: {_DATA} is absent (VISTA_SHARED_DATA names another folder)")
    kitti = [_DATA / "kitti_odometry/sequences/00", _DATA / "kitti2012"]
    names = [
        (left, folder / "image_1" / left.name)
        for folder in kitti
        for left in sorted((folder / "image_0").glob("*.png"))[::4]
    ]
    for scene in ("teddy", "cones"):
        names.append(tuple(_DATA / "middlebury" / scene / f"{name}.png" for name in ("im2", "im6")))
    return [(_grey(left), _grey(right)) for left, right in names]
