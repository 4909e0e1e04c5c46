"""What a scoring of the test set asks for and leaves behind, on a small set that is neither rendered nor
flown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from checkout_on_disk import commit, make_checkout
from command_line import Vista, assert_refused, call
from small_worlds import small_families
from vista import parameters
from vista.errors import InputError
from vista_eval import score as scoring
from vista_eval.command import worlds as command
from vista_eval.metrics import scoring_log
from vista_eval.metrics.flight_score import FlightScore
from vista_eval.metrics.free_directions import NO_DIRECTIONS
from vista_eval.metrics.free_path import FreePath
from vista_eval.metrics.scoring_log import LOG
from vista_eval.metrics.world_score import WorldScore
from vista_eval.report.page import Page
from vista_eval.report.table import Table
from vista_eval.rivals import OURS
from vista_eval.suites import worlds as suite
from vista_eval.worlds.sampled import catalog, frozen

COUNT = 2
FLIGHTS = ["three_000", "three_001"]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The checkout of a project whose test set has two flights."""
    families = small_families(one="dev", three="test")
    monkeypatch.setattr(catalog, "FAMILIES", families)
    monkeypatch.setattr(catalog, "COUNT", COUNT)
    monkeypatch.setattr(frozen, "FAMILIES", families)
    monkeypatch.setattr(frozen, "COUNT", COUNT)
    root = make_checkout(tmp_path / "project")
    monkeypatch.setattr(scoring_log, "checkout_of", lambda _: root)
    return root


@pytest.fixture
def vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    return lambda *arguments: call(capsys, *arguments)


def render_nothing(folder: Path, key: command.Key) -> None:
    """Says only of which flight the folder is."""
    family, number, seed = key
    _, content = frozen.content_digest(catalog.FAMILIES[family].flight(number, seed))
    out = folder / command.name_of(key)
    out.mkdir(parents=True, exist_ok=True)
    (out / "content.json").write_text(json.dumps({"content": content}))


def three_hits(folder: Path, **_: object) -> WorldScore:
    """Three hits of five frames that ask for one."""
    found = dict.fromkeys(FlightScore.__dataclass_fields__, 0) | {"name": folder.name, "frames": ()}
    found |= {"band_frames": 5, "hits": 3, "missed": (1, 2), "false_alarm_frames": (), "begins_m": None}
    found |= {"errors_dz": (), "nees": (), "nees_dimensions": (), "free": FreePath()}
    found |= {"directions": NO_DIRECTIONS}
    return WorldScore(folder.name, "three", "test", {OURS: FlightScore(**found)}, None, ())


@pytest.fixture
def flights(tmp_path: Path, checkout: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(command, "render", render_nothing)
    monkeypatch.setattr(suite, "score_world", three_hits)
    monkeypatch.setattr(suite, "tables", lambda _: [Table("made up", (), [("the figures",)])])
    monkeypatch.setattr(suite, "page", lambda *_: Page("", "", []))
    return tmp_path / "flights"


@pytest.fixture
def frozen_set(checkout: Path, vista: Vista, tmp_path: Path) -> Path:
    assert vista("worlds", tmp_path, "--split", "test", "--freeze", "--jobs", 1)[0] == 0
    commit(checkout, "frozen")
    return checkout


def lines(root: Path) -> list[dict]:
    path = root / LOG
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def score(vista: Vista, flights: Path) -> tuple[int, str, str]:
    return vista("worlds", flights, "--split", "test", "--no-controls", "--jobs", 1)


@pytest.mark.parametrize("breaks", [False, True])
def test_a_scoring_is_logged_before_its_figures_are_seen(
    frozen_set: Path, flights: Path, vista: Vista, monkeypatch: pytest.MonkeyPatch, breaks: bool
) -> None:
    """Else a scoring that is stopped as it writes its report would leave no trace."""
    seen: list[int] = []

    def write(*_: object, **__: object) -> None:
        seen.append(len(lines(frozen_set)))
        if breaks:
            raise InputError(flights, "No space left on device")

    monkeypatch.setattr(scoring, "write_measurement", write)
    status, out, _ = score(vista, flights)
    assert status == (2 if breaks else 0)
    assert breaks or out.index("logged:") < out.index("the figures")
    assert seen == [1]
    (line,) = lines(frozen_set)
    assert line["families"]["three"]["hits"] == line["families"]["all"]["hits"] == 6
    assert line["families"]["three"]["asked_frames"] == 10
    assert line["commit"] == scoring_log.clean_commit(frozen_set)
    assert line["set"] == frozen.digest_of_set(frozen.read_frozen(frozen_set, "test"))


def test_the_test_set_is_rendered_without_a_scoring(
    checkout: Path, flights: Path, vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is flown, nothing is logged, and nothing of results is printed or written."""
    flown: list[Path] = []
    monkeypatch.setattr(suite, "score_world", lambda folder, **_: flown.append(folder))
    status, out, _ = vista("worlds", flights, "--split", "test", "--render-only", "--jobs", 1)
    assert status == 0 and not flown and lines(checkout) == []
    assert sorted(path.name for path in flights.iterdir()) == FLIGHTS
    assert out == ""


# ---- what is asked for ----


def test_the_set_is_frozen_anew_until_it_is_scored(
    frozen_set: Path, flights: Path, vista: Vista, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = frozen.read_frozen(frozen_set, "test")
    assert sorted(first) == FLIGHTS and len(set(first.values())) == COUNT
    freeze = ("worlds", flights, "--split", "test", "--freeze", "--jobs", 1)
    monkeypatch.setattr(frozen, "SEED", 2)
    assert vista(*freeze)[0] == 0
    assert not frozen.changed(
        frozen.read_frozen(frozen_set, "test"),
        dict(map(frozen.content_digest, frozen.flights_of_the_set("test"))),
    )
    monkeypatch.setattr(frozen, "SEED", 1)
    assert vista(*freeze)[0] == 0
    assert frozen.read_frozen(frozen_set, "test") == first

    assert score(vista, flights)[0] == 0
    status, out, _ = vista(*freeze)
    assert status == 0 and "all as they were frozen" in out
    monkeypatch.setattr(frozen, "SEED", 2)
    status, _, err = vista(*freeze)
    assert status == 2 and f"{COUNT} flights changed, the first {FLIGHTS[0]}" in err
    assert frozen.read_frozen(frozen_set, "test") == first


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ("no set", "is not frozen"),
        ("the code", "code.py is not committed"),
        ("the log", "was edited"),
    ],
)
def test_nothing_is_scored_unless_it_may_be(
    request: pytest.FixtureRequest, checkout: Path, flights: Path, vista: Vista, wrong: str, reason: str
) -> None:
    """And nothing is logged."""
    if wrong != "no set":
        request.getfixturevalue("frozen_set")
    if wrong == "the code":
        (checkout / "code.py").write_text("2\n")
    elif wrong == "the log":
        (checkout / LOG).write_text("{}\n")
    before = lines(checkout)
    assert_refused(score(vista, flights), reason)
    assert lines(checkout) == before


def test_other_flights_are_not_scored(frozen_set: Path, flights: Path) -> None:
    folders = [flights / name for name in FLIGHTS]
    render_nothing(flights, ("three", 0, 1))
    command.before_a_scoring("test", folders[:1])
    folders[1].mkdir()
    (folders[1] / "content.json").write_text('{"content": "other"}')
    with pytest.raises(InputError, match=r"three_001.* is not the flight of that name"):
        command.before_a_scoring("test", folders)


def test_every_scoring_adds_a_line(frozen_set: Path, flights: Path, vista: Vista) -> None:
    """The line has the parameters that were used."""
    assert [score(vista, flights)[0] for _ in range(2)] == [0, 0]
    first, second = lines(frozen_set)
    assert first["parameters"] == second["parameters"] and first["previous"] != second["previous"]
    values = parameters.defaults()
    judged = command.before_a_scoring("test", [flights / name for name in FLIGHTS])
    values["tracker"]["confirm_hits"] += 1
    command.log_scoring(judged, [three_hits(flights / FLIGHTS[0])], values)
    third = lines(frozen_set)[2]
    assert third["parameters"] != first["parameters"]
    assert {key: third[key] for key in judged} == {key: first[key] for key in judged} | {
        "date": judged["date"]
    }
    assert third["families"]["three"]["flights"] == 1
