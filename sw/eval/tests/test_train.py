"""`vista train`: what is fitted against what is known by hand, and a small flight from its evidence to the
header of C."""

from __future__ import annotations

import json
import re
from pathlib import Path

import flight_on_disk as disk
import numpy as np
import pytest
from command_line import Vista, assert_refused, call
from random_seed import seeded
from vista import parameters
from vista.geometry import Calibration
from vista_eval.metrics import scoring_log
from vista_eval.training import affinity
from vista_eval.training.evidence import (
    EMPTY,
    OCCUPIED,
    PIECES,
    UNTOLD,
    FlightEvidence,
    collect_cached,
    from_json,
    truth_of_places,
)
from vista_eval.training.logistic import cross_validate, fit, probability, same_for_each
from vista_eval.training.odds import HEADER, contacts, header, learn, reliability
from vista_eval.training.path_truth import PAPER_FAMILY, PathTruth, path_truth

ROOT = Path(__file__).parents[3]
DEFINED = re.compile(r"^#define VISTA_ODDS_(\w+) \(?(-?[\d.]+)\)?$", re.MULTILINE)


def test_one_piece_has_the_odds_of_its_table() -> None:
    """1,000 of 10,000 entries without it are occupied, 4,000 of 5,000 with it: log-odds of -2.20 and 1.39."""
    x = np.repeat([0.0, 1.0], (10_000, 5_000))[:, np.newaxis]
    y = np.concatenate([np.arange(10_000) < 1_000, np.arange(5_000) < 4_000]).astype(np.int64)
    prior, weight = fit(x, y, np.ones(15_000))
    assert prior == pytest.approx(np.log(1 / 9), abs=0.02)
    assert prior + weight == pytest.approx(np.log(4), abs=0.05)
    thinned = np.where(y == 1, 0.5, 1.0)  # half of the weight halves the odds
    assert fit(x, y, thinned)[0] == pytest.approx(np.log(1 / 18), abs=0.02)


def test_the_ridge_keeps_a_piece_that_is_never_wrong_finite() -> None:
    x = np.repeat([0.0, 1.0], 50)[:, np.newaxis]
    prior, weight = fit(x, (x[:, 0] > 0).astype(np.int64), np.ones(100))
    assert -5.0 < prior < 0.0 < weight < 10.0


def test_a_group_is_judged_by_the_others() -> None:
    """Three groups say that the piece means occupied, and one says the opposite."""
    random = seeded(3)
    x = random.integers(0, 2, (400, 1)).astype(float)
    group = np.repeat(["a", "b", "c", "odd"], 100)
    y = np.where(group == "odd", 1 - x[:, 0], x[:, 0]).astype(np.int64)
    y[::10] = -1
    held = cross_validate(x, y, group)
    assert held.loss["odd"] > 3.0 and max(held.loss[name] for name in "abc") < 1.0
    assert cross_validate(x, y, group, ["odd"]).loss["a"] < 0.1
    assert np.isfinite(held.probability).all()
    assert same_for_each(np.array(["a", "b", "b"])).tolist() == [1.0, 0.5, 0.5]


def test_the_truth_of_places() -> None:
    """A thing at 30 m: one disparity is 2 m deep there, so from 28.8 to 31.2 m places are occupied; beyond
    nothing can be told. Something at 14 m is beside the path, and ground at 7 m beneath it."""
    truth = PathTruth(0, np.array([30.0]), np.array([14.0, 30.0]), np.array([7.0]))
    along_m = np.array([4.0, 7.0, 10.0, 14.0, 20.0, 26.0, 29.0, 31.0, 36.0, 45.0])
    expected = [EMPTY, UNTOLD, EMPTY, UNTOLD, EMPTY, UNTOLD, OCCUPIED, OCCUPIED, UNTOLD, UNTOLD]
    assert truth_of_places(along_m, truth, 450.0).tolist() == expected
    nothing = PathTruth(0, np.zeros(0), np.zeros(0), np.zeros(0))
    assert (truth_of_places(along_m, nothing, 450.0) == EMPTY).all()


def test_both_layouts_of_truth_say_the_same(tmp_path: Path) -> None:
    """Contacts at the sign, 19, 18 and 17 m ahead; others do not say what is what."""
    folder = disk.write_flight(tmp_path / "sign", frames=3, last_range_m=17.0, split="dev")
    camera = Calibration(disk.WIDTH, disk.HEIGHT, disk.FOCAL_PX, disk.CU, disk.CV, disk.BASELINE_M)
    ours = path_truth(folder, camera)
    (folder / "truth.json").write_text(json.dumps({"flight": "sign", "obstacles": []}))
    others = path_truth(folder, camera)
    assert (ours.family, others.family) == (PAPER_FAMILY, "sign, by others")
    for found in (ours, others):
        first_m = [frame.things_m[0] for frame in found.frames]
        assert first_m == pytest.approx([19.0, 18.0, 17.0], abs=0.1)
        assert all(len(frame.beside_m) >= len(frame.things_m) for frame in found.frames)


def evidence(truth: list[int], **columns: list) -> FlightEvidence:
    """Evidence of one frame, with places 10 m apart from 10 m on."""
    n = len(truth)
    usual = {
        "frame": [0] * n,
        "along_m": [10.0 * (k + 1) for k in range(n)],
        "pieces": [[0.0] * len(PIECES)] * n,
    }
    usual |= {"known": [True] * n, "told": [0.0] * n, "truth": truth, "reach_m": [1.0] * n}
    return from_json({"name": "made", "family": "made"} | usual | columns)


def test_the_first_place_that_is_warned_of_counts() -> None:
    ahead = evidence([EMPTY, EMPTY, OCCUPIED, UNTOLD])
    assert contacts(ahead, np.array([0.1, 0.1, 0.9, 0.9])) == (1, 1, 1, 0)
    assert contacts(ahead, np.array([0.1, 0.9, 0.9, 0.9])) == (1, 0, 1, 1)
    assert contacts(ahead, np.array([0.1, 0.1, 0.7, 0.7])) == (1, 0, 1, 0)
    unseen = evidence([EMPTY, EMPTY, OCCUPIED], known=[True, True, False])
    assert contacts(unseen, np.array([0.1, 0.1, 0.9])) == (1, 0, 1, 0)
    assert contacts(evidence([OCCUPIED]), np.array([0.9])) == (0, 0, 1, 0)  # at 10 m no hit is asked for
    near = evidence([UNTOLD, OCCUPIED], along_m=[18.1, 20.0])  # within 2 m
    assert contacts(near, np.array([0.9, 0.1])) == (1, 1, 1, 0)
    two = evidence([EMPTY, OCCUPIED, EMPTY, EMPTY], frame=[0, 0, 1, 1], along_m=[10.0, 20.0, 10.0, 20.0])
    assert contacts(two, np.array([0.1, 0.9, 0.9, 0.1])) == (1, 1, 2, 1)


def test_reliability_of_tenths() -> None:
    given, truth = np.array([0.05, 0.95, 1.0, 0.93]), np.array([0, 1, 1, 0])
    bins = reliability(given, truth, np.array([1.0, 1.0, 1.0, 2.0]))
    assert (bins[0].places, bins[0].given, bins[0].occupied) == (1, 0.05, 0.0)
    assert (bins[9].places, bins[9].occupied) == (3, 0.5)
    assert sum(one.places for one in bins) == 4


@pytest.fixture(scope="module")
def flights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two, at the sign and past the wall; of families of their own."""
    folder = tmp_path_factory.mktemp("flights")
    for name, boards in (("sign", (disk.SIGN, disk.WALL)), ("wall", (disk.WALL,))):
        disk.write_flight(folder / name, boards, frames=12, last_range_m=18.0, split="dev")
        path = folder / name / "truth.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | {"family": name}))
    return folder


@pytest.mark.slow
def test_the_detector_weighs_the_pieces_as_they_are_learned(flights: Path) -> None:
    """The probability that C gives each place follows from the pieces and from the header."""
    found = collect_cached(flights / "sign", parameters.defaults(), flights / "kept")
    weights = {name: float(value) for name, value in DEFINED.findall((ROOT / HEADER).read_text())}
    assert list(weights) == ["PRIOR", *PIECES]
    told = probability(np.array(list(weights.values())), found.pieces)
    assert np.allclose(told, found.told, atol=1e-9)
    assert set(found.truth.tolist()) == {OCCUPIED, EMPTY, UNTOLD}
    assert found.pieces[:, PIECES.index("VOTES")][found.truth == OCCUPIED].mean() > 0.3


@pytest.mark.slow
def test_from_flights_to_the_header(
    flights: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    vista: Vista = lambda *arguments: call(capsys, *arguments)  # noqa: E731
    monkeypatch.setattr(scoring_log, "checkout_of", lambda _: tmp_path)
    path = tmp_path / HEADER
    path.parent.mkdir(parents=True)
    status, out, _ = vista("train", tmp_path / "out", flights, tmp_path / "none", "--jobs", 1, "--dry-run")
    assert (status, path.exists()) == (0, False)
    assert "none is not there" in out and "sign" in out
    assert vista("train", tmp_path / "out", flights / "sign", flights / "wall", "--jobs", 1)[0] == 0
    learned = learn(
        [
            collect_cached(flights / name, parameters.defaults(), tmp_path / "out" / "evidence")
            for name in ("sign", "wall")
        ]
    )
    assert path.read_text() == header(learned)
    written = {name: float(value) for name, value in DEFINED.findall(path.read_text())}
    assert written == learned.weights
    assert learned.digest in path.read_text().splitlines()[1]
    figures = json.loads((tmp_path / "out" / "space-odds.json").read_text())["figures"]
    assert [family["name"] for family in figures["families"]] == ["sign", "wall"]
    assert "truly occupied" in (tmp_path / "out" / "space-odds.html").read_text()
    weights = json.loads((tmp_path / "out" / "affinity-weights.json").read_text())["figures"]
    assert (weights["flights"], sorted(weights["weight_by_family"])) == (2, ["sign", "wall"])


def test_a_flight_of_the_split_test_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    disk.write_flight(tmp_path / "held", frames=3, split="test")
    assert_refused(call(capsys, "train", tmp_path / "out", tmp_path / "held", "--jobs", 1), "split test")


def pairs(intensity: list[float], same: list[int], family: str) -> affinity.FlightPairs:
    n = len(same)
    columns = {"disparity_px": [0.0] * n, "nearest_px": [10.0] * n, "distance_px": [3.0] * n}
    return affinity.from_json(
        {"name": "made", "family": family, "intensity": intensity, "same": same} | columns
    )


def test_the_object_of_a_cell_is_what_nearly_all_of_its_pixels_show() -> None:
    label, cells = np.repeat([3, 0, 3, 1], (9, 1, 8, 2))[np.newaxis], np.repeat([0, 2], 10)[np.newaxis]
    assert affinity.object_of_cells(label, cells, 3).tolist() == [3, -1, -1]


def test_the_feature_that_tells_objects_apart_gets_the_weight() -> None:
    """Objects differ in intensity, and not in disparity, in three families."""
    random = seeded(11)
    flights = []
    for family in "abc":
        same = random.integers(0, 2, 300)
        intensity = np.where(same, random.uniform(0.0, 4.0, 300), random.uniform(20.0, 60.0, 300))
        flights.append(pairs(intensity.tolist(), same.tolist(), family))
    found = affinity.learn(flights, parameters.defaults())
    ways = {way.name: way for way in found.ways}
    assert ways["disparity alone"].log_loss == pytest.approx(np.log(2.0), abs=0.02)
    assert max(way.wrong for name, way in ways.items() if name != "disparity alone") < 0.02
    assert found.weight_of_intensity > 0.9
    assert set(found.weight_by_family) == set("abc")
