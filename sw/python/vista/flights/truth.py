"""What is really there: the disparity and label images of a frame, where each thing is seen, truth.json.

`truth/disparity/T.png`: KITTI 16 bits, round(256 d) of the left image's disparity d at pixel centres, 0 sky.
`truth/label/T.png`: 8 bits (16 with more than 254 things), k = the scene's k-th thing from 1, 0 = sky.
`truth/objects/T.json`: per thing in view its pixels, their mean world position, their bounding box.
`truth.json` tells of the whole flight; it is written last.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .rig import Rig
from .scene import Scene, Thing
from .view import View
from .writer import write_image, write_text

VERSION = 1
MAX_8_BIT_THINGS = 254


def truth_path(flight: Path, kind: str, t_ns: int) -> Path:
    return flight / "truth" / kind / f"{t_ns}.{'json' if kind == 'objects' else 'png'}"


def disparity_words(depth_m: np.ndarray, rig: Rig) -> np.ndarray:
    """(H, W) uint16, 1/256 px; what is so far that it would round to sky keeps the least disparity."""
    disparity_px = rig.focal_px * rig.baseline_m / depth_m
    words = np.clip(np.rint(256 * disparity_px), 1, 65535)
    return np.where(np.isfinite(depth_m), words, 0).astype(np.uint16)


def objects_in_view(view: View, rig: Rig, world_from_camera: np.ndarray) -> list[dict]:
    """Per label in the image: pixels, mean world position of their points, bounding box u0 v0 u1 v1."""
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
    flight: Path, about: dict, scene: Scene, rig: Rig, times_ns: list[int], first_frame_s: float
) -> dict:
    """`about`: name, title, split, speed, rate. Reads what `write_frame_truth` has written of each frame."""
    frames = [
        {"t_ns": t_ns, "objects": json.loads(truth_path(flight, "objects", t_ns).read_text())}
        for t_ns in times_ns
    ]
    return {
        "version": VERSION,
        **about,
        "frame": "world: metres, z up, flight along +x",
        "rig": {"focal_px": rig.focal_px, "baseline_m": rig.baseline_m, "center_px": rig.center_px},
        "objects": [object_entry(k, thing, first_frame_s) for k, thing in enumerate(scene.things, start=1)],
        "frames": frames,
    }
