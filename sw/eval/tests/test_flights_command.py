"""`vista flights` from end to end on small flights: table, flights.json, report.html, what is kept."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import flight_on_disk as disk
import pytest
from vista import parameters
from vista.cli import main
from vista_eval import fly
from vista_eval.fly import Disturbance
from vista_eval.metrics.flight_score import score_flight
from vista_eval.suites import flights as command

pytestmark = pytest.mark.slow

FREE = "free"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("flights")
    disk.write_flight(folder / "sign", frames=20, last_range_m=16.0)
    disk.write_flight(folder / FREE, (disk.WALL,), frames=5, split="dev")
    return folder


@pytest.fixture(scope="module")
def printed(folder: Path) -> str:
    """What the first run says; the flights of the catalogue stay out of it."""
    with pytest.MonkeyPatch.context() as patch:
        lines: list[str] = []
        patch.setattr("builtins.print", lambda text="", **_: lines.append(str(text)))
        assert main(["flights", str(folder), "--no-render", "--pose-noise", "--noise", "4", "40"]) == 0
    return "\n".join(lines)


def test_the_table_has_both_groups_and_the_noise(printed: str) -> None:
    assert re.search(r"^sign +\d", printed, re.M)
    assert re.search(rf"^{FREE} ", printed, re.M)
    assert printed.count("= dev: 1 flights") == printed.count("= test: 1 flights") == 4
    assert "\nWith poses as of a navigation filter: 0.1 m, 0.3 degrees, drifting\n" in printed
    assert "\nWith sensor noise of 4 grey levels\n" in printed
    assert "\nWith sensor noise of 40 grey levels\n" in printed
    assert "stereo alone, 540 thresholds over 2 flights" in printed
    assert re.search(r"^segmentation +things +IoU median, cut", printed, re.M)


def test_the_figures_are_those_of_the_python_function(folder: Path, printed: str) -> None:
    content = json.loads((folder / "flights.json").read_text())
    by_name = {flight["name"]: flight for flight in content["flights"]}
    direct = score_flight(folder / "sign", parameters.defaults())
    for key, value in by_name["sign"].items():
        if key != "host_ms":
            assert json.loads(json.dumps(direct[key])) == value, key
    assert [group["split"] for group in content["groups"]] == ["dev", "test"]
    assert content["groups"][1]["hits"] == direct["hits"]
    assert len(content["pose_noise"]["flights"]) == 2
    assert [noisy["grey_levels"] for noisy in content["sensor_noise"]] == [4.0, 40.0]
    weak, strong = (noisy["flights"] for noisy in content["sensor_noise"])
    assert [flight["name"] for flight in weak] == [flight["name"] for flight in content["flights"]]
    alone = score_flight(folder / "sign", parameters.defaults(), Disturbance(image_grey=4.0))
    of_sign = next(flight for flight in weak if flight["name"] == "sign")
    assert json.loads(json.dumps(alone["frames"])) == of_sign["frames"]
    assert all(flight["false_alarm_frames"] == [] for flight in [*weak, *strong])
    for flight in strong:  # nothing is left to see, and that is what the detector says
        assert flight["degraded_frames"] + flight["unseeing_frames"] == len(flight["frames"])
    assert {row["name"] for row in content["segmentation"]} >= {"sign", "= test"}


class Fetched(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.urls: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.urls += [value or "" for name, value in attributes if name in ("src", "href", "xlink:href")]

    handle_startendtag = handle_starttag


def test_the_page_stands_alone(folder: Path, printed: str) -> None:
    page = (folder / "report.html").read_text()
    parser = Fetched()
    parser.feed(page)
    assert all(url.startswith(("data:", "#")) for url in parser.urls)
    assert sum(url.startswith("data:image/jpeg") for url in parser.urls) >= 10
    assert page.count("<svg") == 4  # two for all, one a flight
    for text in ("tracked from, m", "warned from, m", "Scores<", "0.1 m, 0.3 degrees, drifting<"):
        assert text in page
    for name in ("sign", FREE):
        assert f'id="{name}"' in page


@pytest.fixture
def flown(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the flights that are flown, in time."""
    names: list[str] = []
    original = fly.fly

    def spy(sequence: object, values: object) -> object:
        names.append(sequence.name)
        return original(sequence, values)

    monkeypatch.setattr(fly, "fly", spy)
    return names


def test_flown_once(folder: Path, printed: str, flown: list[str]) -> None:
    """It is not flown again until parameters or images change."""
    values = parameters.defaults()
    command.fly_and_score(values, fly.UNDISTURBED, folder / FREE)
    assert flown == []
    values["tracker"]["confirm_hits"] = 2
    changed = command.fly_and_score(values, fly.UNDISTURBED, folder / FREE)
    assert flown == [FREE]
    assert command.fly_and_score(values, fly.UNDISTURBED, folder / FREE) == changed
    image = next((folder / FREE / "mav0" / "cam0" / "data").iterdir())
    image.touch()
    command.fly_and_score(values, fly.UNDISTURBED, folder / FREE)
    assert flown == [FREE, FREE]


def test_flown_again_when_asked_to(folder: Path, printed: str, flown: list[str]) -> None:
    """Host times on a quiet machine need it; what is flown again is kept like the rest."""
    command_line = ["flights", str(folder), "--no-render", "--no-baseline", "--only", FREE]
    for options, flights in ((["--fly-again"], 1), ([], 1), (["--fly-again", "--pose-noise"], 3)):
        assert main(command_line + options) == 0
        assert flown == [FREE] * flights


def test_bad_input_is_named(tmp_path: Path, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["flights", str(tmp_path), "--no-render"]) == 2
    assert "holds no flights" in capsys.readouterr().err
    for bad in ("-1", "nan", "much"):
        with pytest.raises(SystemExit):
            main(["flights", str(folder), "--no-render", "--noise", bad])
        assert "is not a number from 0 on" in capsys.readouterr().err
    assert main(["flights", str(folder), "--no-render", "--only", "nowhere"]) == 2
    assert "no flight nowhere" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_bad_input_is_named_from_another_process(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("one", "two"):
        disk.write_flight(tmp_path / name, frames=2)
    next((tmp_path / "two" / "mav0" / "cam1" / "data").iterdir()).write_bytes(b"")
    assert main(["flights", str(tmp_path), "--no-render", "--jobs", "2"]) == 2
    assert capsys.readouterr().err.startswith(f"vista: {tmp_path}/two/mav0/cam1/data/")
