"""The truth of a rendered flight: format, writer and reader.

`truth/disparity/T.png`: KITTI 16 bits, round(256 d) of the left image's disparity d at pixel centres, 0 sky.
`truth/label/T.png`: 8 bits (16 with more than 254 things), k = the scene's k-th thing from 1, 0 = sky.
`truth/objects/T.json`: per thing in view its pixels, their mean world position, their bounding box.
`truth.json` tells of the whole flight; it is written last. Of each frame it may hold `world_from_camera`,
4x4: the true pose of the left camera, where the recorded one is disturbed.
"""

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
from vista.geometry import Array, Pose

from vista_eval.dataset.files import write_image, write_text
from vista_eval.render.course import BodyState
from vista_eval.render.rig import LEFT, Rig, View
from vista_eval.render.scene import Scene, Thing

# ---- format ----

TRUTH = "truth.json"
VERSION = 2
SPLITS = ("dev", "test")  # parameters are chosen on the first, figures are those of the second
DISPARITY_SCALE = 256.0  # KITTI's 16-bit PNG: levels a px
MAX_8_BIT_THINGS = 254


def truth_path(flight: Path, kind: str, t_ns: int) -> Path:
    return flight / "truth" / kind / f"{t_ns}.{'json' if kind == 'objects' else 'png'}"


def has_labels(flight: Path) -> bool:
    """Whether the truth says which object each pixel shows; that of others does not."""
    return (flight / "truth" / "label").is_dir()


# ---- writer ----


def disparity_words(depth_m: np.ndarray, rig: Rig) -> np.ndarray:
    """(H, W) uint16; what is so far that it would round to sky keeps the least disparity."""
    disparity_px = rig.focal_px * rig.baseline_m / depth_m
    words = np.clip(np.rint(DISPARITY_SCALE * disparity_px), 1, 65535)
    return np.where(np.isfinite(depth_m), words, 0).astype(np.uint16)


def objects_in_view(view: View, rig: Rig, world_from_camera: np.ndarray) -> list[dict]:
    """Things by their label in the image: pixels, mean world position of their points, bounding box u0 v0 u1
    v1."""
    v, u = np.nonzero(view.label)
    label = view.label[v, u]
    points = view.world_points_m(rig, world_from_camera)[v, u]
    order = np.argsort(label, kind="stable")
    labels, starts = np.unique(label[order], return_index=True)
    seen = []
    for k, pixels in zip(labels, np.split(order, starts[1:]), strict=True):
        corners = (u[pixels].min(), v[pixels].min(), u[pixels].max(), v[pixels].max())
        seen.append(
            {
                "label": int(k),
                "pixels": len(pixels),
                "position_m": np.round(points[pixels].mean(axis=0), 4).tolist(),
                "bbox_px": [int(corner) for corner in corners],
            }
        )
    return seen


def write_frame_truth(
    flight: Path, t_ns: int, view: View, things: int, rig: Rig, world_from_camera: np.ndarray
) -> None:
    label_type = np.uint8 if things <= MAX_8_BIT_THINGS else np.uint16
    write_image(truth_path(flight, "disparity", t_ns), disparity_words(view.depth_m, rig))
    write_image(truth_path(flight, "label", t_ns), view.label.astype(label_type))
    objects = objects_in_view(view, rig, world_from_camera)
    write_text(truth_path(flight, "objects", t_ns), [json.dumps(objects)])


def object_entry(label: int, thing: Thing, first_frame_s: float) -> dict:
    position_m = np.array(thing.center_m) + np.array(thing.velocity_m_s) * first_frame_s
    return {
        "label": label,
        "name": thing.name,
        "kind": thing.kind,
        "standing": thing.standing,
        "target": thing.target,
        "position_m": [float(x) for x in position_m],
        "velocity_m_s": [float(x) for x in thing.velocity_m_s],
        "extent_m": [float(thing.width_m), float(thing.height_m)],
    }


def flight_truth(
    flight: Path, about: dict, scene: Scene, rig: Rig, states: list[BodyState], first_frame_s: float
) -> dict:
    """`about`: name, title, split, speed, rate. Reads what `write_frame_truth` has written of each frame.

    states: as flown, which need not be what the flight's pose file says."""
    frames = [
        {
            "t_ns": state.t_ns,
            "objects": json.loads(truth_path(flight, "objects", state.t_ns).read_text()),
            "world_from_camera": (state.world_from_body @ rig.body_from_camera(LEFT)).tolist(),
        }
        for state in states
    ]
    return {
        "version": VERSION,
        **about,
        "frame": "world: metres, z up, flight along +x",
        "rig": {"focal_px": rig.focal_px, "baseline_m": rig.baseline_m, "center_px": rig.center_px},
        "objects": [object_entry(k, thing, first_frame_s) for k, thing in enumerate(scene.things, start=1)],
        "frames": frames,
    }


# ---- reader ----


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
    family: str = ""  # of sampled flights: the kind of content
    poses: tuple[Pose, ...] | None = None  # world_from_camera of each frame; None: the recorded ones are true

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
        path = truth_path(self.folder, kind, t_ns)
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
        content.get("family", ""),
        _poses(frames),
    )


def _poses(frames: list[dict[str, Any]]) -> tuple[Pose, ...] | None:
    if not all("world_from_camera" in frame for frame in frames):
        return None
    matrices = [np.array(frame["world_from_camera"], float) for frame in frames]
    return tuple(Pose(matrix[:3, :3], matrix[:3, 3]) for matrix in matrices)
