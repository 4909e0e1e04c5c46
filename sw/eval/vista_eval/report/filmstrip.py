"""Chooses frames of a flight to look at: some evenly over the ranges, and those that fail."""

from __future__ import annotations

from math import isnan

import cv2
import numpy as np
from vista.history import FrameRecord
from vista.report.overlay import Picture as Pixels
from vista.report.overlay import draw_obstacles
from vista.report.palette import WHITE
from vista.sequence import read_grey

from vista_eval.dataset.truth import FlightTruth
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.judge import FrameScore
from vista_eval.report.page import Picture, as_jpeg

EVEN_FRAMES, FAILING_FRAMES = 5, 6
WIDTH_PX, QUALITY = 420, 72


def filmstrip(truth: FlightTruth, score: FlightScore, records: list[FrameRecord]) -> list[Picture]:
    by_time = {record.t_ns: record for record in records}
    failing = spread([k for k, f in enumerate(score.frames) if f.missed or f.false_alarms], FAILING_FRAMES)
    even = spread(list(range(len(score.frames))), EVEN_FRAMES)
    return [
        Picture(
            f"frame {k}: {caption(score.frames[k])}; {told(by_time[score.frames[k].t_ns])}",
            as_jpeg(reduced(draw_still(truth, k, by_time[score.frames[k].t_ns])), QUALITY),
            score.frames[k].missed or bool(score.frames[k].false_alarms),
        )
        for k in sorted({*even, *failing})
    ]


def spread(frames: list[int], count: int) -> list[int]:
    """Chooses at most `count` of them, first and last included."""
    chosen = np.linspace(0, len(frames) - 1, min(count, len(frames))).round().astype(int)
    return [frames[k] for k in dict.fromkeys(chosen.tolist())]


def caption(frame: FrameScore) -> str:
    parts = [f"{frame.target} at {frame.range_m:.1f} m" if frame.range_m is not None else "path clear"]
    if frame.error_m is not None:
        parts.append(f"error {frame.error_m:.1f} m")
    if frame.missed:
        parts.append("missed")
    parts += [
        f"false alarm #{alarm.id} at {alarm.range_m:.0f} m" + ("" if alarm.ghost else " (beside the path)")
        for alarm in frame.false_alarms
    ]
    return ", ".join(parts)


def told(record: FrameRecord) -> str:
    """What the detector says of the path: how far it is free, and what is in the way."""
    free, warning = f"told free to {record.path_seen_m:.0f} m", record.warning
    if record.blind or warning is None:
        return "told blind" if record.blind else free
    sure = record.outcome.collision_probability
    return f"{free}, in the way at {warning.distance_m:.0f} m" + ("" if isnan(sure) else f" (p {sure:.2f})")


def draw_still(truth: FlightTruth, index: int, record: FrameRecord) -> Pixels:
    """Obstacles as the chain has them; a thin white box around what is seen of each target."""
    left = read_grey(truth.folder / "mav0" / "cam0" / "data" / f"{record.t_ns}.png")
    picture = draw_obstacles(left, list(record.obstacles), record.nearest_collision)
    for target in truth.targets:
        seen = truth.seen[index].get(target.label)
        if seen is not None:
            u0, v0, u1, v1 = (round(side) for side in seen["bbox_px"])
            cv2.rectangle(picture, (u0 - 2, v0 - 2), (u1 + 2, v1 + 2), WHITE, 1, cv2.LINE_AA)
    return picture


def reduced(picture: Pixels) -> Pixels:
    scale = min(1.0, WIDTH_PX / picture.shape[1])
    return np.asarray(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)
