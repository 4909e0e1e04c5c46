"""report.html: one page with everything in it, readable without network and without the other files.

The page holds the figures of the run as JSON; templates/run_report.js draws them, and links pictures, plots
and table.
"""

from __future__ import annotations

import base64
import math
from collections import defaultdict
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.geometry import Pose
from vista.health.alignment_summary import alignment_card
from vista.health.finding import Reason, State
from vista.health.summary import states_sentence, worst_problems
from vista.history import FrameRecord
from vista.report.labels import NAME_WITHOUT_TRACK, counted, obstacle_name
from vista.report.overlay import panel_tiles
from vista.report.page import fill_template
from vista.result_folder import ResultFolder

if TYPE_CHECKING:
    from vista.pipeline import Obstacle

MAX_PICTURES = 80
MAX_PICTURE_BYTES = 10_000_000  # of all JPEGs; base64 makes a third more
PICTURE_WIDTH_PX = 1400
NO_FREE_SPACE = "That nothing is found there does not mean free space."
TOTAL_HINT = "total = read + rectify + stereo + host, without checks and output (pictures, files)."

ENGINES = {
    "golden": "C model of the engine",
    "rtl": "engine in SystemVerilog, simulated",
    "opencv": "StereoBM of OpenCV",
    "board": "engine on a board",
}

Data = dict[str, Any]


def render_report(summary: Data, records: list[FrameRecord], folder: ResultFolder) -> str:
    """The page as HTML, with the pictures that the folder holds, or a selection of many."""
    data = report_data(summary, records, embedded_pictures(records, folder))
    return fill_template(
        "run_report.html.j2",
        summary=summary,
        data=data,
        engine=ENGINES[summary["engine"]],
        verdict=verdict(summary, records),
        alerts=alerts(summary),
        cards=make_cards(summary, records),
        steps=sum("uri" in frame for frame in data["frames"]) or len(records),
        keys=strip_keys(records),
        table=picture_table(records) if summary["stills"] else track_table(data["tracks"], data["frames"]),
        tracks_head=tracks_head(data["tracks"]),
        total_hint=TOTAL_HINT,
    )


def report_data(summary: Data, records: list[FrameRecord], pictures: dict[int, str]) -> Data:
    """What the page's script draws; pictures: data URI of a record, by its place among the records."""
    camera, stills = summary["camera"], summary["stills"]
    tiles = panel_tiles(camera["width"], camera["height"])
    across, ahead = level_axes([record.world_from_camera or Pose() for record in records])
    warned = [place for place, record in enumerate(records) if record.warning]
    stages = list(dict.fromkeys(name for record in records for name in record.stage_ms))
    known = all(record.motion_known for record in records)
    return {
        "stills": stills,
        "unit": "picture" if stills else "frame",
        "shown": warned[0] if warned else 0,
        "panel": [tiles[3][0] + tiles[3][2], tiles[3][1] + tiles[3][3]] if pictures else None,
        "tiles": tiles,
        "axes": ["xyz"[across], "xyz"[ahead]],
        "no_time_left": "no obstacle comes nearer" if known else "unknown without the motion of the camera",
        "stages": [_stage(name, records) for name in stages],
        "frames": [
            _frame(record, records[0].t_ns, stages, (across, ahead), pictures.get(place))
            for place, record in enumerate(records)
        ],
        "tracks": [] if stills else _tracks(records, across, ahead),
    }


def _frame(
    record: FrameRecord, start_ns: int, stages: list[str], plane: tuple[int, int], picture: str | None
) -> Data:
    nearest = record.warning
    camera_m = (record.world_from_camera or Pose()).translation_m
    frame: Data = {
        "n": record.index,
        "t": round((record.t_ns - start_ns) / 1e9, 4),
        "state": record.health.state,
        "why": " ".join(_sentence(finding.text) for finding in record.health.findings),
        "known": record.motion_known,
        "obstacles": len(record.things),
        "valid": round(100 * record.valid_fraction, 1),
        "seen": _number(record.path_seen_m),
        "camera": [_number(camera_m[axis]) for axis in plane],
        "ms": [_number(record.stage_ms[name]) if name in record.stage_ms else None for name in stages],
        "hit": nearest
        and {
            "id": nearest.id,
            "name": obstacle_name(nearest.id),
            "m": _number(nearest.distance_m),
            "s": None if nearest.time_to_collision_s is None else _number(nearest.time_to_collision_s),
        },
    }
    if picture is not None:
        shown = [obstacle for obstacle in record.obstacles if obstacle.confirmed]
        largest_first = sorted(
            shown, key=lambda o: -o.ellipse.axis_a_px * o.ellipse.axis_b_px
        )  # what lies on top counts
        frame |= {"uri": picture, "ellipses": [_ellipse(obstacle) for obstacle in largest_first]}
    return frame


def _ellipse(obstacle: Obstacle) -> list[Any]:
    e = obstacle.ellipse
    width_m, height_m = obstacle.extent_m
    text = f"{obstacle_name(obstacle.id)}: {obstacle.distance_m:.1f} m away, {width_m:.1f} x {height_m:.1f} m"
    return [obstacle.id, *map(_number, e.memory.item()), text]


def _stage(name: str, records: list[FrameRecord]) -> Data:
    values = [record.stage_ms[name] for record in records if name in record.stage_ms]
    low, q1, median, q3, p99 = map(_number, np.percentile(values, [0, 25, 50, 75, 99]))
    return {"name": name, "low": low, "q1": q1, "median": median, "q3": q3, "p99": p99}


def _tracks(records: list[FrameRecord], across: int, ahead: int) -> list[Data]:
    """Tracks from their confirmation on, longest-lived first; what a blind frame shows is no part of them."""
    seen: dict[int, list[tuple[int, Obstacle]]] = defaultdict(list)
    for place, record in enumerate(records):
        for obstacle in () if record.blind else record.obstacles:
            if obstacle.confirmed:
                seen[obstacle.id].append((place, obstacle))
    hits = {record.warning.id for record in records if record.warning}
    tracks = [
        {
            "id": track_id,
            "name": obstacle_name(track_id),
            "hit": track_id in hits,
            "extent": [_number(side) for side in points[-1][1].extent_m],
            "spread": two_sigma_ellipse(points[-1][1], across, ahead),
            "points": [
                [place, *map(_number, (o.distance_m, o.position_m[across], o.position_m[ahead]))]
                for place, o in points
            ],
        }
        for track_id, points in seen.items()
    ]
    return sorted(tracks, key=lambda track: (-len(track["points"]), track["id"]))


def two_sigma_ellipse(obstacle: Obstacle, across: int, ahead: int) -> list[float]:
    """Semi-axes in metres and the angle of the first in degrees, towards `ahead`."""
    covariance_m2 = np.nan_to_num(
        np.asarray(obstacle.covariance_m2)[np.ix_((across, ahead), (across, ahead))]
    )
    variances, vectors = np.linalg.eigh(covariance_m2)
    half_m = 2.0 * np.sqrt(np.maximum(variances, 0.0))
    return [*map(_number, half_m), _number(np.degrees(np.arctan2(vectors[1, 0], vectors[0, 0])))]


def level_axes(poses: list[Pose]) -> tuple[int, int]:
    """The world axes, in order, without the one nearest to the camera's down (its y)."""
    down = np.mean([pose.rotation[:, 1] for pose in poses], axis=0)
    vertical = int(np.argmax(np.abs(down)))
    across, ahead = (axis for axis in range(3) if axis != vertical)
    return across, ahead


def _number(value: Any) -> float:
    """Enough digits for a plot; JSON has no word for what is not finite."""
    return round(float(value), 2) if math.isfinite(value) else 0.0


# ---- what the page says in words ----


def verdict(summary: Data, records: list[FrameRecord]) -> str:
    """The run in one sentence: what was seen, the nearest warning, and whether the view was healthy."""
    unit = "picture" if summary["stills"] else "frame"
    states = states_sentence(summary["health"], unit)
    if all(record.blind for record in records):
        return f"Nothing can be said of obstacles: {states}."
    count = counted(obstacle_count(summary, records), "obstacle")
    found = f"{count} {'found' if summary['stills'] else 'tracked'}"
    warned = [(record.warning, record.index) for record in records if record.warning]
    if not warned:
        path_m = summary["path_seen_m"]["median"]
        return f"{found}, none in the collision volume, which was seen to {path_m:.0f} m; {states}."
    nearest, index = min(warned, key=lambda one: one[0].distance_m)
    share = f"{len(warned)} of {len(records)} {unit}s"
    where = f"{obstacle_name(nearest.id)} at {nearest.distance_m:.1f} m in {unit} {index}"
    what = "show one in the collision volume" if summary["stills"] else "warn of a collision"
    return f"{found}; {share} {what}, the nearest {where}; {states}."


def obstacle_count(summary: Data, records: list[FrameRecord]) -> int:
    """How many obstacles the report counts: those of each picture, or the tracks of a flight."""
    return (
        sum(len(record.things) for record in records) if summary["stills"] else summary["obstacles_confirmed"]
    )


def alerts(summary: Data) -> list[Data]:
    """What is wrong with the run, worst first, for the top of the page."""
    health, frames = summary["health"], summary["frames"]
    unit = "picture" if summary["stills"] else "frame"
    found: list[Data] = [
        {
            "kind": str(problem["state"]),
            "head": f"In {problem['frames']} of {frames} {unit}s, from {unit} {problem['first_frame']}:",
            "text": _sentence(problem["text"]),
        }
        for problem in worst_problems(health)
    ]
    if health["frames"][State.BLIND]:
        found[0]["text"] += f" {NO_FREE_SPACE}"
    unknown = frames - health["frames_with_known_motion"]
    told = any(problem["reason"] == Reason.MOTION_UNKNOWN for problem in health["problems"])
    if unknown and not summary["stills"] and not told:
        found.append(
            {
                "kind": "unknown",
                "head": f"Own motion unknown in {unknown} of {frames} frames.",
                "text": "Without a pose nothing is known there about times to collision, and the collision "
                "volume lies along the last known direction of flight, or else along the optical axis.",
            }
        )
    return found


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:].rstrip(".") + "." * (not text.endswith("?"))


def strip_keys(records: list[FrameRecord]) -> list[tuple[str, str]]:
    """(class, text) of the colours in the strip below the slider."""
    states = [record.health.state for record in records]
    counts = {
        "hit": (sum(record.warning is not None for record in records), "collision warning"),
        "blind": (states.count(State.BLIND), "blind: nothing found does not mean free space"),
        "degraded": (states.count(State.DEGRADED), "degraded"),
        "unknown": (sum(not record.motion_known for record in records), "own motion unknown"),
    }
    return [(kind, f"{text} ({count})") for kind, (count, text) in counts.items() if count]


def make_cards(summary: Data, records: list[FrameRecord]) -> list[tuple[str, str, str]]:
    """(value, name, remark) of the figures at the top of the page."""
    stages, stills = summary["stages_ms"], summary["stills"]
    host, stereo, total = stages["host"], stages["stereo"], stages["total"]
    hits = [record for record in records if record.warning]
    duration_s = (records[-1].t_ns - records[0].t_ns) / 1e9
    found = str(obstacle_count(summary, records))
    if stills:
        cards = [
            (str(len(records)), "unrelated pictures", "each judged by itself"),
            (found, "obstacles found", "in all pictures together, at first sight"),
            (str(len(hits)), "pictures with an obstacle ahead", _remark(summary, hits)),
        ]
    else:
        cards = [
            (str(len(records)), "frames", f"{duration_s:.1f} s of recording"),
            (found, "obstacles tracked", "confirmed over several frames"),
            (str(len(hits)), "frames with a collision warning", _remark(summary, hits)),
        ]
    if summary["alignment"] is not None:
        cards.append(alignment_card(summary))
    rate = 1e3 / max(total["median"], 1e-3)
    return [
        *cards,
        (f"{host['median']:.1f} ms", "host stage", f"median; p99 {host['p99']:.1f} ms"),
        (f"{stereo['median']:.1f} ms", "stereo engine", f"median; p99 {stereo['p99']:.1f} ms"),
        (
            f"{total['median']:.1f} ms",
            "read to obstacle map",
            f"{rate:.0f} {'pairs' if stills else 'frames'}/s",
        ),
    ]


def _remark(summary: Data, hits: list[FrameRecord]) -> str:
    """The remark below the count of warnings. Blind is never called clear."""
    blind, unit = summary["health"]["frames"][State.BLIND], "picture" if summary["stills"] else "frame"
    if blind:
        return f"those in which the view was blind, {blind}, left out"
    if not hits:
        median_m = summary["path_seen_m"]["median"]
        return f"nothing was found in the collision volume, seen to {median_m:.0f} m in half of the {unit}s"
    nearest = hits[0].warning
    if summary["stills"] or nearest is None:
        return "within the collision volume along the optical axis"
    return f"first at {nearest.distance_m:.1f} m, frame {hits[0].index}"


# ---- tables ----


def tracks_head(tracks: list[Data]) -> str:
    """How many obstacles the table of the tracks lists, and what else is in it."""
    others = [track["name"] for track in tracks if track["id"] in NAME_WITHOUT_TRACK]
    also = f", and what has no track: {', '.join(others)}" if others else ""
    return f"{counted(len(tracks) - len(others), 'tracked obstacle')}{also}"


def track_table(tracks: list[Data], frames: list[Data]) -> Data:
    heads = [
        "track",
        "frames",
        "from (s)",
        "to (s)",
        "first at (m)",
        "closest (m)",
        "width (m)",
        "height (m)",
    ]
    rows = []
    for track in tracks:
        points = track["points"]
        times_s = [frames[points[end][0]]["t"] for end in (0, -1)]
        distances_m = [point[1] for point in points]
        figures = [*times_s, distances_m[0], min(distances_m), *track["extent"]]
        cells = [
            _cell(track["id"], track["name"]),
            _cell(len(points)),
            *(_cell(x, f"{x:.1f}") for x in figures),
        ]
        cells.append(_cell(int(track["hit"]), "yes" if track["hit"] else "", track["hit"]))
        rows.append({"key": track["id"], "cells": cells})
    return {
        "heads": _heads([*heads, "collision course"], "from (s)", "to (s)", "width (m)", "height (m)"),
        "rows": rows,
    }


def picture_table(records: list[FrameRecord]) -> Data:
    heads = ["picture", "obstacles", "nearest (m)", "ahead (m)", "valid (%)", "regions", "host (ms)", "view"]
    rows = []
    for place, record in enumerate(records):
        distances_m = [obstacle.distance_m for obstacle in record.things]
        hit = record.warning
        cells = [
            _cell(record.index),
            _cell(len(distances_m)),
            _metres(min(distances_m, default=None)),
            _metres(None if hit is None else hit.distance_m, hit=True),
            _cell(record.valid_fraction, f"{100 * record.valid_fraction:.0f}"),
            _cell(record.outcome.region_count),
            _cell(record.stage_ms["host"], f"{record.stage_ms['host']:.1f}"),
            _cell(list(State).index(record.health.state), record.health.state),
        ]
        rows.append({"key": place, "cells": cells})
    return {"heads": _heads(heads, "regions", "host (ms)"), "rows": rows}


def _heads(names: list[str], *wide: str) -> list[Data]:
    """wide: left out where there is little room."""
    return [{"name": name, "wide": name in wide} for name in names]


def _cell(value: float, text: str | None = None, hit: bool = False) -> Data:
    """value: what the column is sorted by."""
    return {"value": value, "text": str(value) if text is None else text, "hit": hit}


def _metres(distance_m: float | None, hit: bool = False) -> Data:
    return _cell(1e9, "-") if distance_m is None else _cell(distance_m, f"{distance_m:.1f}", hit)


# ---- pictures ----


def embedded_pictures(records: list[FrameRecord], folder: ResultFolder) -> dict[int, str]:
    """Frames as data URIs, by their place among the records; small enough together. When there are more than
    MAX_PICTURES they are evenly spaced, and the first with a warning is among them."""
    present = [place for place, record in enumerate(records) if folder.frame_path(record.index).is_file()]
    evenly = np.linspace(0, len(present) - 1, min(len(present), MAX_PICTURES)).round().astype(int)
    warned = [place for place in present if records[place].warning]
    chosen = sorted({*(present[k] for k in evenly), *warned[:1]})
    uris = {}
    for place in chosen:
        coded = np.fromfile(
            folder.frame_path(records[place].index), np.uint8
        )  # OpenCV opens no names but UTF-8
        picture = cv2.imdecode(coded, cv2.IMREAD_COLOR)
        if picture is not None:
            jpeg = _scaled_jpeg(picture, MAX_PICTURE_BYTES // len(chosen))
            uris[place] = "data:image/jpeg;base64," + base64.b64encode(jpeg).decode()
    return uris


def _scaled_jpeg(picture: NDArray[Any], limit_bytes: int) -> bytes:
    """Encodes it at most PICTURE_WIDTH_PX wide; then quality, then size give way until the limit holds."""
    scale = min(1.0, PICTURE_WIDTH_PX / picture.shape[1])
    while True:
        scaled = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        for quality in (85, 75, 60):
            jpeg = cv2.imencode(".jpg", scaled, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
            if len(jpeg) <= limit_bytes:
                return jpeg
        scale *= 0.8
