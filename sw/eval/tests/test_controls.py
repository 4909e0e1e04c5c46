"""What flies beside the detector: true words by hand, clusters as regions, and each control on a small
flight."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from random_seed import seeded
from vista import parameters
from vista.engine import INVALID, SCALE
from vista.geometry import Calibration, Pose
from vista_eval.baselines.cluster_tracker import HostMotion, Stages, as_regions
from vista_eval.baselines.stereo_alone import label_clusters
from vista_eval.baselines.tracked_stereo import InVolume, Sweep, tracked_cached
from vista_eval.jobs import HERE
from vista_eval.metrics.flight_score import score_records
from vista_eval.metrics.rules import STRICT
from vista_eval.report.filmstrip import told
from vista_eval.rivals import FOREST, IN_HOST, OF_FLIGHTS, OURS, PATHS, PERFECT, SGBM, true_words
from vista_eval.score import score
from vista_eval.suites.worlds import Beside, Worlds, kept_name, score_world

pytestmark = pytest.mark.slow

CAMERA = Calibration(disk.WIDTH, disk.HEIGHT, disk.FOCAL_PX, disk.CU, disk.CV, disk.BASELINE_M)
FRAMES = 14
SMALL = Sweep((100,), (15,), (62.0,), (40,))


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flight at the sign from 33.5 m on, 1 m a frame."""
    return disk.write_flight(
        tmp_path_factory.mktemp("flights") / "sign", frames=FRAMES, last_range_m=20.5, split="dev"
    )


def test_true_words_of_the_levels() -> None:
    """16 words a pixel of the level; nothing for sky, nor for what is nearer than the level's 8 candidates
    match."""
    disparity_px = np.zeros((5, 7), np.float32)
    disparity_px[0, 0], disparity_px[2, 4], disparity_px[4, 6], disparity_px[0, 4] = 3.03, 7.0, 7.1, 20.0
    expected = [
        {(0, 0): 48, (2, 4): 112},
        {(0, 0): 24, (1, 2): 56, (2, 3): 57, (0, 2): None},
        {(0, 0): 12, (0, 1): 80},
    ]
    for level, wanted in enumerate(expected):
        words = true_words(disparity_px, level, 8)
        assert words.shape == ((5 + 2**level - 1) // 2**level, (7 + 2**level - 1) // 2**level)
        found = {
            place: int(words[place]) for place in zip(*map(list, np.nonzero(words != INVALID)), strict=True)
        }
        assert found == {place: word for place, word in wanted.items() if word is not None}


def test_clusters_as_regions() -> None:
    """Their moments and medians against numpy's, cluster by cluster."""
    random = seeded(1)
    stages = Stages(CAMERA, parameters.defaults())
    for _ in range(10):
        words = (random.integers(1, 4, (40, 60)) * 12).astype(np.int16)
        words[random.random(words.shape) < 0.5] = INVALID
        label = label_clusters(words, 10)
        regions, pixels = as_regions(stages, words, label, (7, 3))
        assert pixels == np.bincount(label[label >= 0]).tolist()
        for k in range(len(pixels)):
            v, u = np.nonzero(label == k)
            region, disparity_px = regions[k], words[label == k] / SCALE
            assert region.pixel_count == region.boundary_inliers == len(u)
            assert (region.mean_u_px, region.mean_v_px) == pytest.approx((u.mean() + 7, v.mean() + 3))
            spread = np.cov(u, v, bias=True)
            found = (region.cov_uu_px2 - 1 / 12, region.cov_uv_px2, region.cov_vv_px2 - 1 / 12)
            assert found == pytest.approx((spread[0, 0], spread[0, 1], spread[1, 1]))
            assert (region.min_u_px, region.max_u_px) == (u.min() + 7, u.max() + 7)
            assert (region.min_v_px, region.max_v_px) == (v.min() + 3, v.max() + 3)
            assert region.disparity_px == pytest.approx(np.median(disparity_px))
            assert region.disparity_sigma_px == pytest.approx(disparity_px.std())


def test_words_in_the_volume_that_the_host_expects() -> None:
    """Flying along x: within 2 m of that line and up to 100 m, pixel by pixel; thresholds drop words only."""
    random = seeded(2)
    stages = Stages(CAMERA, parameters.defaults())
    motion = HostMotion(stages)
    for k in range(5):
        moved = motion.update(k * 100_000_000, Pose(disk.WORLD_FROM_CAMERA, np.array([float(k), 0.0, 6.0])))
    words = random.integers(1, 500, (disk.HEIGHT, disk.WIDTH)).astype(np.int16)
    inside = InVolume(stages, moved)
    depth_m = SCALE * disk.FOCAL_PX * disk.BASELINE_M / words
    v, u = np.mgrid[: disk.HEIGHT, : disk.WIDTH]
    aside_m = depth_m * np.hypot((u - disk.CU) / disk.FOCAL_PX, (v - disk.CV) / disk.FOCAL_PX)
    expected = (aside_m <= 2.0) & (depth_m <= 100.0)
    sure = (abs(aside_m - 2.0) > 1e-3) & (abs(depth_m - 100.0) > 1e-2)
    assert np.array_equal(inside.mask(words)[sure], expected[sure])
    fewer = np.where(random.random(words.shape) < 0.5, words, INVALID).astype(np.int16)
    assert np.array_equal(inside.mask(fewer)[sure], (expected & (fewer > 0))[sure])


def test_stereo_alone_warns_once_its_track_is_confirmed(flight: Path, tmp_path: Path) -> None:
    """It warns of the sign, in all frames that ask for it but those that confirming takes; never of anything
    else."""
    (found,) = tracked_cached(flight, parameters.defaults(), tmp_path / "kept.json", SMALL)
    assert found.asked == 10  # from 30 m on: 3 s at 10 m/s
    assert found.hits >= 7
    assert (found.hits + found.missed, found.alarmed) == (found.asked, 0)
    assert [found] == tracked_cached(flight, parameters.defaults(), tmp_path / "kept.json", SMALL)


@pytest.mark.parametrize("control", [*OF_FLIGHTS, PATHS])
def test_each_control_finds_the_sign(flight: Path, tmp_path: Path, control: str) -> None:
    values = parameters.defaults()
    records = IN_HOST[control].fly_cached(flight, values, tmp_path / "records.json")
    score = score_records(flight, records, values, STRICT)
    if control != SGBM:  # which joins the sign with what it fills in around it
        assert score.false_alarm_frames == ()
    assert score.hits >= 7
    assert len(IN_HOST[control].fly_cached(flight, values, tmp_path / "records.json")) == FRAMES


def test_the_forest_is_another_partition(flight: Path, tmp_path: Path) -> None:
    """Else nothing would be compared."""
    values = parameters.defaults()
    ours, forest = (
        IN_HOST[control].fly_cached(flight, values, tmp_path / f"{control}.json")
        for control in (OURS, FOREST)
    )
    assert [record.outcome.region_count for record in ours] != [
        record.outcome.region_count for record in forest
    ]


def test_worlds_of_a_folder(flight: Path, capsys: pytest.CaptureFixture) -> None:
    """Two flights of one family, with everything beside them; then one of them is made to fail."""
    values = parameters.defaults()
    twin = flight.parent / "twin"
    disk.write_flight(twin, frames=FRAMES, last_range_m=20.5, split="dev")
    for folder in (flight, twin):
        path = folder / "truth.json"
        path.write_text(path.read_text().replace('"split"', '"family": "signs", "split"'))
    beside = Beside(controls=(PERFECT,), sweep=SMALL, noise_grey=(2.0,))
    suite = Worlds([flight, twin], beside, "worlds")
    score(suite, flight.parent, values, HERE)
    text = capsys.readouterr().out
    worlds = [score_world(folder, values, beside) for folder in (flight, twin)]  # of what is kept
    assert [(world.name, world.family) for world in worlds] == [("sign", "signs"), ("twin", "signs")]
    for title in (
        "By family",
        "in the same host",
        "free, beside it",
        "Stereo alone",
        "sensor noise",
        "Segmentation",
    ):
        assert title in text
    page = (flight.parent / "worlds.html").read_text()
    assert "By family" in page and "signs" in page
    failing = replace(worlds[0].scores[OURS], missed=(3, 4), false_alarm_frames=(4, 5))
    passing = replace(worlds[1].scores[OURS], missed=(), false_alarm_frames=())
    made = [replace(w, scores=w.scores | {OURS: s}) for w, s in zip(worlds, (failing, passing), strict=True)]
    assert "Frames that fail: 3, in 1 flights." in suite.scoring(made, values).page.render()
    records = IN_HOST[OURS].fly_cached(flight, values, flight / kept_name(OURS))
    warned = next(record for record in records if record.warning)
    assert warned.warning is not None
    assert f"free to {warned.path_seen_m:.0f} m, in the way at {warned.warning.distance_m:.0f} m" in told(
        warned
    )
