"""report.html: self-contained, well-formed, of bounded size, and true to the records."""

from __future__ import annotations

import base64
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fake_pipeline import FakePipeline
from vista.geometry import Calibration, Pose
from vista.history import FrameRecord, stage_statistics
from vista.obstacle_line import obstacle_line
from vista.report import plots
from vista.report import run_report as report
from vista.report.run_report import render_report, track_rows
from vista.result_folder import ResultFolder

CAMERA = Calibration(160, 120, 120.0, 80.0, 60.0, 0.25)
VOID = {"meta", "img", "input", "br"}


def make_records(frames: int, poses: bool = True) -> list[FrameRecord]:
    pipeline = FakePipeline(CAMERA)
    image, words = np.zeros((120, 160), np.uint8), np.full((120, 160), 64, np.int16)
    records = []
    for index in range(frames):
        result = pipeline.process(image, words, index, None, None)
        pose = Pose(np.eye(3), np.array([0.0, 0.0, float(index)])) if poses else None
        stage_ms = {"read": 1.0, "rectify": 0.5, "stereo": 3.0, **result.stage_ms, "total": 10.0}
        records.append(
            FrameRecord(
                index,
                index * 100_000_000,
                pose,
                tuple(result.obstacles),
                result.nearest_collision,
                result.regions,
                result.valid_fraction,
                stage_ms,
            )
        )
    return records


def make_summary(records: list[FrameRecord]) -> dict:
    return {
        "sequence": "a <flight> & more",
        "layout": "pairs",
        "notes": ["a note"],
        "frames": len(records),
        "engine": "golden",
        "camera": {"width": 160, "height": 120, "focal_px": 120.0, "baseline_m": 0.25},
        "rectified": False,
        "obstacles_confirmed": 3,
        "parameters": {"stereo": {"num_disparities": 32, "block_size": 11}},
        "stages_ms": stage_statistics(records),
    }


def render(folder: Path, records: list[FrameRecord], noise: bool = False) -> str:
    results = ResultFolder(folder)
    rng = np.random.default_rng(0)
    for record in records:
        picture = (
            rng.integers(0, 256, (900, 1600, 3), np.uint8) if noise else np.zeros((244, 324, 3), np.uint8)
        )
        results.write_frame(record.index, "{}", picture)
    results.close()
    return render_report(make_summary(records), records, results)


class Checker(HTMLParser):
    """Open elements must close in order; collects what a browser would fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.fetched += [value or "" for name, value in attributes if name in ("src", "href", "xlink:href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.fetched += [value or "" for name, value in attributes if name in ("src", "href", "xlink:href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize("frames", [1, 12])
@pytest.mark.parametrize("poses", [True, False])
def test_the_page_stands_alone(tmp_path: Path, frames: int, poses: bool) -> None:
    page = render(tmp_path / "out", make_records(frames, poses))
    checker = Checker()
    checker.feed(page)
    assert checker.open == []
    assert all(url.startswith(("data:", "#")) for url in checker.fetched)
    assert not re.search(r"@import|url\((?!#|&quot;#)", page)
    assert "a &lt;flight&gt; &amp; more" in page
    assert "a note" in page
    assert page.count("<svg") == 5


def test_every_picture_is_there(tmp_path: Path) -> None:
    page = render(tmp_path / "out", make_records(7))
    pictures = json.loads(re.search(r"const pictures = (\[.*?\]);", page)[1])
    assert [picture["frame"] for picture in pictures] == list(range(7))
    assert [picture["collision"] for picture in pictures] == [False] + [True] * 6
    for picture in pictures:
        assert base64.b64decode(picture["uri"].partition(",")[2]).startswith(b"\xff\xd8")


def test_the_size_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise is the worst picture to compress; the limits are scaled down to keep the test short."""
    monkeypatch.setattr(report, "MAX_PICTURES", 5)
    monkeypatch.setattr(report, "MAX_PICTURE_BYTES", 600_000)
    page = render(tmp_path / "out", make_records(9), noise=True)
    pictures = json.loads(re.search(r"const pictures = (\[.*?\]);", page)[1])
    assert [picture["frame"] for picture in pictures] == [0, 2, 4, 6, 8]
    assert sum(len(picture["uri"]) for picture in pictures) < 600_000 * 4 / 3 + 1000
    assert "5 of 9 frames are shown" in page


def test_without_obstacles_the_plots_say_so(tmp_path: Path) -> None:
    records = [
        FrameRecord(0, 0, None, (), None, 0, 0.0, {"read": 1.0, "stereo": 1.0, "host": 1.0, "total": 3.0})
    ]
    page = render(tmp_path / "out", records)
    assert "no obstacle was confirmed" in page
    assert "nothing in the collision volume" in page


@pytest.mark.parametrize(
    "plot",
    [plots.plot_distances, plots.plot_collision, plots.plot_map, plots.plot_regions, plots.plot_stages],
)
def test_plots_are_well_formed_and_repeatable(plot) -> None:
    records = make_records(5)
    element = plot(records)
    assert ElementTree.fromstring(element).tag.endswith("svg")
    assert plot(records) == element


def test_ids_of_different_plots_differ() -> None:
    records = make_records(5)
    distances, regions = (
        set(re.findall(r'<clipPath id="(\w+)"', p(records)))
        for p in (plots.plot_distances, plots.plot_regions)
    )
    assert distances and regions and not distances & regions


def test_the_map_leaves_out_the_vertical_axis() -> None:
    """KITTI's world is the first camera (y down); EuRoC's has z up."""
    assert plots.level_axes([Pose()]) == (0, 2)
    camera_looking_along_x = Pose(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]))
    assert plots.level_axes([camera_looking_along_x]) == (0, 1)


def test_track_rows() -> None:
    rows = track_rows(make_records(6))
    assert [row["id"] for row in rows] == [1, 2, 3]  # number 4 is never confirmed
    assert rows[1]["frames"] == 6
    assert rows[1]["closest_m"] == 15.0
    assert [row["collision"] for row in rows] == [False, True, False]


def test_stage_statistics_against_numpy() -> None:
    records = make_records(50)
    values = [record.stage_ms["host"] for record in records]
    expected = {"median": round(np.median(values), 3), "p99": round(np.percentile(values, 99), 3)}
    assert stage_statistics(records)["host"] == expected


def test_lines_hold_finite_numbers_only() -> None:
    record = make_records(2)[1]
    obstacle = record.obstacles[0]
    obstacle.covariance_m2[0, 0] = np.nan
    obstacle.position_m[:] = [1.23456, np.inf, -0.0001]
    parsed = json.loads(obstacle_line(record), parse_constant=pytest.fail)["obstacles"][0]
    assert parsed["covariance_m2"][0][0] is None
    assert parsed["position_m"] == [1.235, None, 0.0]
    assert "-0.0" not in obstacle_line(record)
