"""The measured figures that are committed as JSON: where they are, and how those that a command has just
measured take their place (make_tables.py --save)."""

from __future__ import annotations

import datetime
import json
import os
import statistics
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

from run_benches import processor

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "doc" / "results" / "data"
SYNTHESIS = ROOT / "rtl" / "synth" / "results.json"

Record = dict[str, Any]

STATISTICS = {  # of a segmentation, with the names that tables give them
    "iou_median": "IoU median",
    "iou_mean": "IoU mean",
    "found": "IoU > 0.5",
    "boundary_recall": "boundary recall",
    "undersegmentation": "under-segmentation",
    "regions": "regions",
}


def file_of(name: str) -> Path:
    return SYNTHESIS if name == "synthesis" else DATA / f"{name}.json"


def figure_files() -> list[Path]:
    return [*sorted(DATA.glob("*.json")), SYNTHESIS]


def figures(name: str) -> Record:
    found: Record = json.loads(file_of(name).read_text())
    return found


def measured(command: str) -> Record:
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    return {
        "commit": commit.stdout.strip(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "machine": f"{os.cpu_count()} processors, {processor()}",
        "command": command,
    }


def reduce_maxflow(raw: Record) -> Record:
    groups: dict[str, list[Record]] = {}
    for row in raw["rows"]:
        groups.setdefault(row["name"].rpartition(", ")[2], []).append(row)

    def ends(rows: list[Record], value: Callable[[Record], float]) -> list[float]:
        return [round(end(map(value, rows)), 2) for end in (min, max)]

    def mean(key: str) -> float:
        return round(statistics.geometric_mean(row[key] for row in raw["rows"]), 2)

    return {
        "groups": [
            {
                "graphs": name,
                "vista_ms": ends(rows, lambda row: row["vista"]["median_ms"]),
                "ratio_flow": ends(rows, lambda row: row["ratio_flow"]),
                "ratio_whole": ends(rows, lambda row: row["ratio_whole"]),
            }
            for name, rows in groups.items()
        ],
        "geometric_mean": {
            "ratio_flow": mean("ratio_flow"),
            "ratio_whole": mean("ratio_whole"),
            "rows": len(raw["rows"]),
        },
    }


def reduce_flights(raw: Record) -> Record:
    def consistency(found: Record | None) -> list[float] | None:
        return None if found is None else [round(found[key], 1) for key in ("average", "low", "high")]

    def flight(score: Record) -> Record:
        values = {
            "title": score["title"],
            "split": score["split"],
            "tracked_from_m": score["tracked_from_m"],
            "warned_from_m": score["first_detection_m"],
            "hits": score["hits"] if score["band_frames"] else None,
            "band_frames": score["band_frames"] or None,
            "false_alarm_frames": len(score["false_alarm_frames"]),
            "median_dz": score["median_dz"],
            "rms_ft": score["rms_ft"],
            "companion_rms_ft": score["companion_rms_ft"],
            "error_at_50_ft": score["error_at_50_ft"],
            "nees": consistency(score["consistency"]),
        }
        return {key: rounded(value) for key, value in values.items() if value is not None}

    def group(found: Record) -> Record:
        keys = (
            "split",
            "flights",
            "frames",
            "hits",
            "band_frames",
            "false_alarm_frames",
            "median_dz",
            "within_2dz",
            "matched_frames",
        )
        return {key: rounded(found[key]) for key in keys} | {"nees": consistency(found["consistency"])}

    def of_noise(found: Record) -> Record:
        keys = ("split", "frames", "hits", "band_frames", "false_alarm_frames", "degraded_frames")
        return {key: found[key] for key in (*keys, "unseeing_frames")}

    host = [score["host_ms"] for score in raw["flights"]]
    alone = raw["stereo_alone"]
    noisy = {found["split"]: {key: found[key] for key in ("hits", "band_frames", "false_alarm_frames")}
             for found in raw["pose_noise"]["groups"]}  # fmt: skip
    return {
        "groups": [group(found) for found in raw["groups"]],
        "flights": [flight(score) for score in raw["flights"]],
        "stereo_alone": alone
        and {
            "thresholds": len(alone["alone"]),
            "frames_near": alone["near_frames"],
            "frames": alone["frames"],
            "missed": alone["ours"]["missed"],
            "false_alarm_frames": alone["ours"]["alarms"],
        },
        "pose_noise": noisy,
        "sensor_noise": [
            {"grey_levels": level["grey_levels"], "groups": [of_noise(found) for found in level["groups"]]}
            for level in [{"grey_levels": 0.0, "groups": raw["groups"]}, *raw["sensor_noise"]]
        ],
        "host_ms": {"least": round(min(host), 1), "largest": round(max(host), 1)},
    }


def rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [rounded(one) for one in value]
    return round(value, 2) if isinstance(value, float) else value


def reduce_scenes(raw: Record) -> Record:
    intervals = raw["halves"]["test"]["cut_minus_reference_95"]
    return {
        "cut_minus_reference_95": [
            {"reference": name} | {key: rounded(values[key]) for key in STATISTICS}
            for name, values in intervals.items()
        ]
    }


def reduce_throughput(raw: Record) -> Record:
    """One system; the others stay."""
    system, found, needed = raw["system"], raw["figures"], raw["clock_needed"]
    row = {
        "preset": raw["preset"],
        "camera": f"{system['width_px']}x{system['height_px']}, {system['camera_rate_hz']:g} Hz",
        "disparities": system["disparities"],
        "clock_mhz": round(system["engine_clock_hz"] / 1e6, 1),
        "dropped": found["dropped"],
        "frames": found["delivered"] + found["dropped"],
        "latency_p50_ms": round(found["latency_p50_ms"], 1),
        "latency_p99_ms": round(found["latency_p99_ms"], 1),
        "limit_hz": round(raw["limit"]["rate_hz"]),
        "limit_stage": raw["limit"]["stage"],
        "needed_clock_mhz": round(needed["clock_hz"] / 1e6, 2),
    }
    others = [one for one in figures("throughput")["systems"] if one["preset"].split()[0] != raw["preset"]]
    return {"systems": [*others, row]}


def reduce_lidar(raw: Record) -> Record:
    """Leaves out what belongs to single pairs."""
    halves = {
        half: {
            "pairs": found["pairs"],
            "detectors": {
                name: {"measures": one["measures"], "verdicts": one["verdicts"]}
                for name, one in found["detectors"].items()
            },
        }
        for half, found in raw["halves"].items()
    }
    return {"halves": halves}


def reduce_worlds(raw: Record) -> Record:
    """Leaves out the single flights."""
    return {"rules": raw["rules"], "families": rounded_all(raw["families"]), "tables": raw["tables"]}


def rounded_all(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: rounded_all(one) for key, one in value.items()}
    if isinstance(value, list):
        return [rounded_all(one) for one in value]
    return round(value, 3) if isinstance(value, float) else value


REDUCE: dict[str, Callable[[Record], Record]] = {
    "engine": lambda raw: raw,
    "frontend": lambda raw: raw,
    "disparity-quality": lambda raw: raw,
    "lidar": reduce_lidar,
    "evidence": lambda raw: raw,
    "health": lambda raw: raw,
    "rectification-grid": lambda raw: raw,
    "calibration": lambda raw: raw,
    "alignment": lambda raw: raw,
    "host": lambda raw: {"sequences": raw["sequences"]},
    "street": lambda raw: raw,
    "segmentation": lambda raw: raw,
    "segmentation-roads": lambda raw: raw,
    "maxflow": reduce_maxflow,
    "jobs": lambda raw: raw,
    "flights": reduce_flights,
    "scenes": reduce_scenes,
    "throughput": reduce_throughput,
    "board-clocks": lambda raw: raw,
    "board-soak": lambda raw: raw,
    **{f"worlds-{split}": reduce_worlds for split in ("dev", "test")},
}


def as_text(content: Any, indent: int = 0) -> str:
    """JSON with a line for whatever fits on one."""
    flat = json.dumps(content, ensure_ascii=False)
    if not isinstance(content, dict | list) or len(flat) + indent <= 118:
        return flat
    pad, end = " " * (indent + 1), " " * indent
    if isinstance(content, dict):
        inside = [f"{pad}{json.dumps(key)}: {as_text(value, indent + 1)}" for key, value in content.items()]
        return "{\n" + ",\n".join(inside) + f"\n{end}}}"
    return "[\n" + ",\n".join(pad + as_text(value, indent + 1) for value in content) + f"\n{end}]"


def save(name: str, source: Path, command: str) -> None:
    content = {"measured": measured(command)} | REDUCE[name](json.loads(source.read_text()))
    file_of(name).write_text(as_text(content) + "\n")
