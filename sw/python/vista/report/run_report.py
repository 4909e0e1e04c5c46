"""report.html: one page with everything in it, readable without network and without the other files."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np
from markupsafe import Markup

from vista.history import FrameRecord
from vista.report import plots
from vista.report.page import fill_template
from vista.result_folder import ResultFolder

MAX_PICTURES = 80
MAX_PICTURE_BYTES = 10_000_000  # of all JPEGs; base64 makes a third more
PICTURE_WIDTH_PX = 1400
MAX_TRACK_ROWS = 40


def render_report(summary: dict[str, Any], records: list[FrameRecord], folder: ResultFolder) -> str:
    """The page as HTML, with the pictures that the folder holds, or a selection of many."""
    drawings = {
        name: Markup(plot(records))
        for name, plot in {
            "distances": plots.plot_distances,
            "map": plots.plot_map,
            "stages": plots.plot_stages,
            "collision": plots.plot_collision,
            "regions": plots.plot_regions,
        }.items()
    }
    pictures = embedded_pictures(records, folder)
    return fill_template(
        "run_report.html.j2",
        summary=summary,
        cards=make_cards(summary, records),
        pictures=pictures,
        shown=next((index for index, picture in enumerate(pictures) if picture["collision"]), 0),
        plots=drawings,
        tracks=track_rows(records)[:MAX_TRACK_ROWS],
    )


def make_cards(summary: dict[str, Any], records: list[FrameRecord]) -> list[tuple[str, str, str]]:
    """(value, name, remark) of the figures at the top of the page."""
    stages = summary["stages_ms"]
    host, total = stages["host"], stages["total"]
    hits = [
        (record.nearest_collision.distance_m, record.index) for record in records if record.nearest_collision
    ]
    first_hit = hits[0] if hits else None
    duration_s = (records[-1].t_ns - records[0].t_ns) / 1e9
    return [
        (str(summary["frames"]), "frames", f"{duration_s:.1f} s of flight"),
        (str(summary["obstacles_confirmed"]), "obstacles tracked", "confirmed over several frames"),
        (
            str(len(hits)),
            "frames with a collision warning",
            f"first at {first_hit[0]:.1f} m, frame {first_hit[1]}"
            if first_hit
            else "the collision volume stayed clear",
        ),
        (f"{host['median']:.1f} ms", "host stage", f"median; p99 {host['p99']:.1f} ms"),
        (
            f"{stages['stereo']['median']:.1f} ms",
            "stereo engine",
            f"median; p99 {stages['stereo']['p99']:.1f} ms",
        ),
        (
            f"{total['median']:.1f} ms",
            "read to obstacle map",
            f"{1e3 / max(total['median'], 1e-3):.0f} frames/s",
        ),
    ]


def embedded_pictures(records: list[FrameRecord], folder: ResultFolder) -> list[dict[str, Any]]:
    """Frames as data URIs, small enough together; evenly spaced when there are more than MAX_PICTURES."""
    present = [record for record in records if folder.frame_path(record.index).is_file()]
    chosen = np.unique(np.linspace(0, len(present) - 1, min(len(present), MAX_PICTURES)).round().astype(int))
    pictures: list[dict[str, Any]] = []
    for position in chosen:
        record = present[position]
        coded = np.fromfile(folder.frame_path(record.index), np.uint8)  # OpenCV opens no names but UTF-8
        jpeg = _scaled_jpeg(
            np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR)), MAX_PICTURE_BYTES // len(chosen)
        )
        pictures.append(
            {
                "frame": record.index,
                "collision": record.nearest_collision is not None,
                "uri": "data:image/jpeg;base64," + base64.b64encode(jpeg).decode(),
            }
        )
    return pictures


def _scaled_jpeg(picture: np.ndarray, limit_bytes: int) -> bytes:
    """At most PICTURE_WIDTH_PX wide; then quality, then size give way until the limit holds."""
    scale = min(1.0, PICTURE_WIDTH_PX / picture.shape[1])
    while True:
        scaled = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        for quality in (85, 75, 60):
            jpeg = cv2.imencode(".jpg", scaled, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
            if len(jpeg) <= limit_bytes:
                return jpeg
        scale *= 0.8


def track_rows(records: list[FrameRecord]) -> list[dict[str, Any]]:
    """One row a confirmed track, longest-lived first."""
    rows = []
    in_volume = {record.nearest_collision.id for record in records if record.nearest_collision}
    for track_id, points in plots.confirmed_tracks(records).items():
        distances_m = [obstacle.distance_m for _, obstacle in points]
        last = points[-1][1]
        rows.append(
            {
                "id": track_id,
                "frames": len(points),
                "from_s": points[0][0],
                "to_s": points[-1][0],
                "first_m": distances_m[0],
                "closest_m": min(distances_m),
                "width_m": float(last.extent_m[0]),
                "height_m": float(last.extent_m[1]),
                "collision": track_id in in_volume,
            }
        )
    return sorted(rows, key=lambda row: (-row["frames"], row["id"]))
