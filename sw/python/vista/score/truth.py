"""What a rendered flight says of itself: truth.json, disparity and label of every pixel of the left image."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.geometry import Array

TRUTH = "truth.json"
VERSION = 1
SPLITS = ("tune", "report")  # parameters are chosen on the first, figures are those of the second
DISPARITY_SCALE = 256.0  # KITTI's 16-bit PNG: levels a px


@dataclass(frozen=True)
class TrueObject:
    label: int  # of its pixels; 0 is the sky
    name: str
    kind: str
    standing: bool  # in life an obstacle, as against ground, road, tarpaulin
    target: bool  # what the aircraft flies at
    position_m: Array  # (3,) its own centre in the first frame, world
    velocity_m_s: Array  # (3,)
    extent_m: tuple[float, float]  # width, height


@dataclass(frozen=True)
class FlightTruth:
    folder: Path
    name: str
    title: str
    split: str  # of SPLITS
    focal_px: float
    baseline_m: float
    center_px: tuple[float, float]
    speed_m_s: float
    rate_hz: float
    objects: dict[int, TrueObject]  # by label
    times_ns: tuple[int, ...]
    seen: tuple[dict[int, dict[str, Any]], ...]  # of each frame, by label: pixels, position_m, bbox_px

    @property
    def focal_baseline_px_m(self) -> float:
        return self.focal_px * self.baseline_m

    def depth_of_one_disparity_m(self, range_m: Any) -> Any:
        """dz(r) = r^2 / (f B)."""
        return np.square(range_m) / self.focal_baseline_px_m

    def disparity_px(self, t_ns: int) -> NDArray[np.float32]:
        """(height, width), 0 = sky."""
        return self._image("disparity", t_ns).astype(np.float32) / DISPARITY_SCALE

    def labels(self, t_ns: int) -> NDArray[np.uint16]:
        return self._image("label", t_ns).astype(np.uint16)

    def _image(self, kind: str, t_ns: int) -> NDArray[Any]:
        path = self.folder / "truth" / kind / f"{t_ns}.png"
        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if image is None or image.ndim != 2:
            raise InputError(path, "missing, or not a grey PNG")
        return image

    @cached_property
    def targets(self) -> tuple[TrueObject, ...]:
        return tuple(o for o in self.objects.values() if o.target)


def read_truth(folder: Path) -> FlightTruth:
    """Raises InputError naming the file when it is missing or of another layout."""
    path = folder / TRUTH
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, (error.strerror or "cannot be read").lower()) from None
    except json.JSONDecodeError as error:
        raise InputError(path, f"not readable as JSON: {error}") from None
    if content.get("version") != VERSION:
        raise InputError(path, f"version {content.get('version')} of the truth, expected {VERSION}")
    try:
        return _flight_truth(folder, content)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(path, f"not the truth of a flight: {error!r}") from None


def _flight_truth(folder: Path, content: dict[str, Any]) -> FlightTruth:
    rig = content["rig"]
    objects = [
        TrueObject(
            o["label"],
            o["name"],
            o["kind"],
            o["standing"],
            o["target"],
            np.array(o["position_m"], float),
            np.array(o.get("velocity_m_s", (0.0, 0.0, 0.0)), float),
            (float(o["extent_m"][0]), float(o["extent_m"][1])),
        )
        for o in content["objects"]
    ]
    frames = content["frames"]
    return FlightTruth(
        folder,
        content["name"],
        content["title"],
        content["split"],
        rig["focal_px"],
        rig["baseline_m"],
        (rig["center_px"][0], rig["center_px"][1]),
        content["speed_m_s"],
        content["rate_hz"],
        {o.label: o for o in objects},
        tuple(frame["t_ns"] for frame in frames),
        tuple({o["label"]: o for o in frame["objects"]} for frame in frames),
    )
