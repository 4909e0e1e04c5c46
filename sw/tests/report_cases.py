"""Records of a run that was not made, and the report of them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from fake_pipeline import (
    FakePipeline,
    fake_ground,
    fake_motion,
    fake_nearest,
    fake_obstacle,
    fake_place,
    fake_record,
    fake_too_near,
    items_of,
)
from vista.command.run import path_seen
from vista.geometry import Calibration, Pose
from vista.health.alignment_summary import summarize_alignment
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.health.summary import summarize_health
from vista.history import FrameRecord, stage_statistics
from vista.report.overlay import panel_tiles
from vista.report.run_report import render_report
from vista.result_folder import ResultFolder, encoded

CAMERA = Calibration(160, 120, 120.0, 80.0, 60.0, 0.25)
BLIND = FrameHealth((Finding(next(iter(Reason)), State.BLIND, "The image is black."),))


def make_records(
    frames: int, poses: bool = True, blind: range = range(0), crowd: int = 0
) -> list[FrameRecord]:
    """crowd: so many tracks more that stand close together."""
    pipeline = FakePipeline(CAMERA)
    image, words = np.zeros((120, 160), np.uint8), np.full((120, 160), 64, np.int16)
    records = []
    for index in range(frames):
        result = pipeline.process(image, words, index, None, None)
        many = [fake_obstacle(10 + k, 60.0 + 0.1 * k, CAMERA) for k in range(crowd)]
        pose = Pose(np.eye(3), np.array([0.0, 0.0, float(index)])) if poses else None
        stage_ms = {"read": 1.0, "rectify": 0.5, "stereo": 3.0, **result.stage_ms, "total": 10.0}
        records.append(
            fake_record(
                index,
                index * 100_000_000,
                [*result.obstacles, *many],
                result.nearest_collision,
                fake_motion(pose, known=poses),
                stage_ms=stage_ms,
                health=BLIND if index in blind else None,
                region_count=result.outcome.region_count,
                valid_fraction=result.valid_fraction,
            )
        )
    return records


def with_ground_ahead(records: list[FrameRecord]) -> list[FrameRecord]:
    """The ground is what is met first, something is too near to match, and something else is on the path;
    none of them has a track."""
    ground, too_near, place = fake_ground(CAMERA, 9.0), fake_too_near(CAMERA), fake_place(CAMERA, 30.0)
    nearest = fake_nearest(ground, 1.5, distance_m=9.0)
    return [
        dataclasses.replace(
            record,
            outcome=record.outcome.but(nearest_collision=nearest),
            items=items_of([*record.obstacles, ground, too_near, place]),
        )
        for record in records
    ]


def make_summary(records: list[FrameRecord], stills: bool = False) -> dict:
    return {
        "version": "1.2.3",
        "commit": "0123abc",
        "command": "vista run <here>",
        "stills": stills,
        "health": summarize_health(records),
        "alignment": summarize_alignment(records),
        "sequence": "a <flight> & more",
        "layout": "pairs",
        "notes": ["a note"],
        "frames": len(records),
        "engine": "golden",
        "camera": {"width": 160, "height": 120, "focal_px": 120.0, "baseline_m": 0.25},
        "rectified": False,
        "obstacles_confirmed": 3,
        "path_seen_m": path_seen(records),
        "parameters": {"stereo": {"num_disparities": 32, "block_size": 11}},
        "stages_ms": stage_statistics(records),
    }


def render(folder: Path, records: list[FrameRecord], noise: bool = False, stills: bool = False) -> str:
    results = ResultFolder(folder)
    rng = np.random.default_rng(0)
    left, top, width, height = panel_tiles(CAMERA.width, CAMERA.height)[-1]
    for record in records:
        picture = np.full((top + height, left + width, 3), 8 * record.index % 256, np.uint8)
        if noise:
            picture = rng.integers(0, 256, (900, 1600, 3), np.uint8)
        results.write_frame(record.index, "{}", encoded(picture))
    results.close()
    page = render_report(make_summary(records, stills), records, results)
    results.write_report(page)
    return page
