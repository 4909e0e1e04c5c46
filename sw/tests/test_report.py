"""report.html: self-contained, well-formed, of bounded size, and true to the records."""

from __future__ import annotations

import base64
import dataclasses
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from fake_pipeline import fake_motion, fake_record
from report_cases import make_records, make_summary, render, with_ground_ahead
from vista.geometry import Pose
from vista.history import FrameRecord, stage_statistics
from vista.obstacle_line import obstacle_line
from vista.pipeline import ID_GROUND, ID_PLACE, ID_TOO_NEAR, Nearest
from vista.report import run_report as report
from vista.report.run_report import level_axes, render_report
from vista.result_folder import ResultFolder

pytestmark = pytest.mark.slow

VOID = {"meta", "img", "input", "br"}


def data_of(page: str) -> dict:
    return json.loads(
        re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)[1]
    )


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


def without_collision(record: FrameRecord) -> FrameRecord:
    return dataclasses.replace(record, outcome=record.outcome.but(nearest_collision=Nearest.made()))


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


def test_every_picture_is_there(tmp_path: Path) -> None:
    frames = data_of(render(tmp_path / "out", make_records(7)))["frames"]
    assert [frame["n"] for frame in frames] == list(range(7))
    assert [frame["hit"] and frame["hit"]["id"] for frame in frames] == [None] + [2] * 6
    for frame in frames:
        assert base64.b64decode(frame["uri"].partition(",")[2]).startswith(b"\xff\xd8")
        assert [ellipse[0] for ellipse in frame["ellipses"]] == [2, 3, 1]  # the largest lies at the bottom


def test_the_size_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise is the worst picture to compress; the limits are scaled down to keep the test short."""
    monkeypatch.setattr(report, "MAX_PICTURES", 5)
    monkeypatch.setattr(report, "MAX_PICTURE_BYTES", 600_000)
    page = render(tmp_path / "out", make_records(9), noise=True)
    pictures = {frame["n"]: frame["uri"] for frame in data_of(page)["frames"] if "uri" in frame}
    assert list(pictures) == [0, 1, 2, 4, 6, 8]  # evenly, and the first with a warning
    assert sum(map(len, pictures.values())) < 600_000 * 4 / 3 + 1000
    assert "6 of 9 frames are shown" in page


def test_the_page_opens_at_the_first_warning(tmp_path: Path) -> None:
    assert data_of(render(tmp_path / "out", make_records(4)))["shown"] == 1


def test_without_obstacles_the_page_says_so(tmp_path: Path) -> None:
    stage_ms = {"read": 1.0, "stereo": 1.0, "host": 1.0, "total": 3.0}
    page = render(tmp_path / "out", [fake_record(0, 0, motion=fake_motion(known=True), stage_ms=stage_ms)])
    assert "nothing was found in the collision volume" in page
    assert data_of(page)["tracks"] == []


def test_blind_frames_are_never_called_clear(tmp_path: Path) -> None:
    records = [without_collision(record) for record in make_records(6, blind=range(2, 4))]
    page = render(tmp_path / "out", records)
    assert "In 2 of 6 frames, from frame 2:" in page
    assert "the view was blind in 2 of 6 frames." in page
    assert "The image is black. That nothing is found there does not mean free space." in page
    assert "nothing was found in the collision volume" not in page
    assert not re.search(r"\bclear\b", re.sub(r"<script.*", "", page, flags=re.DOTALL))
    states = [frame["state"] for frame in data_of(page)["frames"]]
    assert states == ["healthy"] * 2 + ["blind"] * 2 + ["healthy"] * 2


VERDICT = re.compile(r'<p id="verdict">(.*?)</p>')


def test_the_page_begins_with_its_verdict(tmp_path: Path) -> None:
    page = render(tmp_path / "out", make_records(6))
    assert VERDICT.search(page)[1] == (
        "3 obstacles tracked; 5 of 6 frames warn of a collision, the nearest #2 at 15.0 m in frame 5; "
        "the view was healthy in all 6 frames."
    )
    assert page.index('id="verdict"') < page.index('class="cards"')
    nothing = [without_collision(record) for record in make_records(6)]
    assert (
        "3 obstacles tracked, none in the collision volume, which was seen to "
        in VERDICT.search(render(tmp_path / "none", nothing))[1]
    )
    stills = render(tmp_path / "stills", make_records(3, poses=False), stills=True)
    assert (
        "9 obstacles found; 2 of 3 pictures show one in the collision volume, " in VERDICT.search(stills)[1]
    )


def test_what_is_seen_in_blind_frames_is_counted_nowhere(tmp_path: Path) -> None:
    """The verdict, the figures at the top, the frames, the strip, the plots and the table agree."""
    records = make_records(6, blind=range(3, 6))
    page, data = render(tmp_path / "out", records), data_of(render(tmp_path / "again", records))
    assert "2 of 6 frames warn of a collision" in VERDICT.search(page)[1]
    assert "<b>2</b><span>frames with a collision warning</span>" in page
    assert "collision warning (2)" in page
    assert [bool(frame["hit"]) for frame in data["frames"]] == [False, True, True, False, False, False]
    assert [len(track["points"]) for track in data["tracks"]] == [3, 3, 3]


def test_the_card_the_table_and_the_plot_show_the_same_tracks(tmp_path: Path) -> None:
    """No row of the table is hidden in a box of its own, and what is no obstacle is said to be none."""
    records = make_records(2, crowd=25)
    page = render(tmp_path / "out", records)
    assert "<h2>28 tracked obstacles</h2>" in page
    assert len(re.findall(r'<tr data-key="', page)) == len(data_of(page)["tracks"]) == 28
    assert not re.search(r"\.rows\s*{[^}]*(max-height|overflow)", page)
    page = render(tmp_path / "ground", with_ground_ahead(make_records(2)))
    assert "<h2>3 tracked obstacles, and what has no track: " in page


@pytest.mark.parametrize(("engine", "name"), report.ENGINES.items())
def test_engine_and_views_have_plain_names(tmp_path: Path, engine: str, name: str) -> None:
    summary, records = make_summary(make_records(1)) | {"engine": engine}, make_records(1)
    page = render_report(summary, records, ResultFolder(tmp_path))
    assert f"· {name}," in page and "golden" not in page
    assert "<h1>Obstacles in a &lt;flight&gt; &amp; more</h1>" in page


def test_unknown_motion_is_said(tmp_path: Path) -> None:
    page = render(tmp_path / "out", make_records(3, poses=False))
    assert "Own motion unknown in 3 of 3 frames." in page
    assert "own motion unknown (3)" in page
    assert "Own motion unknown" not in render(tmp_path / "known", make_records(3))


def test_stills_are_not_presented_as_a_flight(tmp_path: Path) -> None:
    page = render(tmp_path / "out", make_records(3, poses=False), stills=True)
    data = data_of(page)
    assert data["stills"] and data["tracks"] == []
    assert "unrelated pictures" in page and "each judged by itself" in page
    seen = re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL)
    seen = seen.replace("a &lt;flight&gt; &amp; more", "").replace("nothing is tracked", "")
    for word in ("track", "time (s)", "of recording", "flight", "From above", "warning", "motion"):
        assert word not in seen, word
    assert re.findall(r'<tr data-key="(\d+)"', seen) == ["0", "1", "2"]


def test_the_map_leaves_out_the_vertical_axis() -> None:
    """KITTI's world is the first camera (y down); EuRoC's has z up."""
    assert level_axes([Pose()]) == (0, 2)
    camera_looking_along_x = Pose(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]))
    assert level_axes([camera_looking_along_x]) == (0, 1)


def test_tracks(tmp_path: Path) -> None:
    page = render(tmp_path / "out", make_records(6))
    tracks = {track["id"]: track for track in data_of(page)["tracks"]}
    assert list(tracks) == [1, 2, 3]  # number 4 is never confirmed
    assert [point[:2] for point in tracks[2]["points"]] == [[frame, 20.0 - frame] for frame in range(6)]
    assert [tracks[k]["hit"] for k in tracks] == [False, True, False]
    cells = re.search(r'<tr data-key="2".*?</tr>', page, re.DOTALL)[0]
    assert re.findall(r">([^<>]+)</td>", cells) == [
        "#2",
        "6",
        "0.0",
        "0.5",
        "20.0",
        "15.0",
        "1.0",
        "2.0",
        "yes",
    ]


def test_what_has_no_track_is_called_what_it_is(tmp_path: Path) -> None:
    page = render(tmp_path / "out", with_ground_ahead(make_records(3)))
    assert data_of(page)["frames"][0]["hit"]["name"] == "ground"
    first_cells = dict(re.findall(r'<tr data-key="(-?\d+)"[^>]*>\s*<td[^>]*>([^<]*)</td>', page))
    assert first_cells == {
        "1": "#1",
        "2": "#2",
        "3": "#3",
        str(ID_GROUND): "ground",
        str(ID_TOO_NEAR): "too near",
        str(ID_PLACE): "in the way",
    }


@pytest.mark.parametrize("stills", [False, True])
def test_only_things_count_as_obstacles(tmp_path: Path, stills: bool) -> None:
    """Three confirmed tracks a frame; what has no track is not one more."""
    records = with_ground_ahead(make_records(2, poses=not stills))
    page = render(tmp_path / "out", records, stills=stills)
    assert [frame["obstacles"] for frame in data_of(page)["frames"]] == [3, 3]
    if stills:
        assert ("6", "obstacles found") in [
            card[:2] for card in report.make_cards(make_summary(records, stills), records)
        ]
        cells = re.findall(r'<tr data-key="0".*?</tr>', page, re.DOTALL)[0]
        assert re.findall(r">([^<>]+)</td>", cells)[:4] == ["0", "3", "20.0", "9.0"]


def test_the_ellipse_from_above_has_two_sigma() -> None:
    obstacle = make_records(1)[0].obstacles[0]
    obstacle.covariance_m2[:] = np.diag([0.25, 9.0, 4.0])
    half_x_m, half_z_m, angle_deg = report.two_sigma_ellipse(obstacle, 0, 2)
    assert (half_x_m, half_z_m, angle_deg % 180.0) == (1.0, 4.0, 0.0)


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
