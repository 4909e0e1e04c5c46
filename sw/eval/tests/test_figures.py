"""The paper's figures from small flights: pictures and not blanks, and what their captions say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import flight_on_disk as disk
import matplotlib as mpl
import numpy as np
import pytest
from vista import parameters
from vista.cli import main
from vista.engine import INVALID
from vista.errors import InputError
from vista.report.plots import STYLE
from vista_eval.dataset.files import write_image
from vista_eval.dataset.truth import FlightTruth, TrueObject
from vista_eval.figures import segmentation
from vista_eval.figures.flights import the_four
from vista_eval.figures.moments import read_flights
from vista_eval.figures.segmentation import various
from vista_eval.figures.stereo_threshold import correctness, shade
from vista_eval.metrics.flight_score import FOOT_M

pytestmark = pytest.mark.slow

WALL_TARGET = replace(disk.WALL, target=True, center_m=(0.0, 0.0, 5.0))


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    flights = tmp_path_factory.mktemp("flights")
    disk.write_flight(flights / "sign", frames=12, last_range_m=25.0)
    disk.write_flight(flights / "wall", (WALL_TARGET,), frames=8, last_range_m=25.0)
    out = flights / "figures"
    assert main(["figures", str(out), "--flights", str(flights)]) == 0
    return out


@pytest.mark.parametrize("number", [2, 3, 4, 5])
def test_every_figure_shows_something(pictures: Path, number: int) -> None:
    figure = cv2.imread(str(pictures / f"figure{number}.png"))
    assert figure.shape[1] >= 900
    assert np.mean(figure < 250) > 0.1


def test_regions_have_colours(pictures: Path) -> None:
    for number, coloured in ((3, False), (4, True), (5, True)):
        figure = cv2.imread(str(pictures / f"figure{number}.png")).astype(int)
        saturated = np.ptp(figure, axis=2) > 100
        assert (saturated.mean() > 0.05) == coloured


def test_captions_are_no_wider_than_their_panels(pictures: Path) -> None:
    title = "facades on three sides, no obstacle"
    truths = [replace(truth, title=title) for truth in read_flights(pictures.parent)]
    with mpl.rc_context(STYLE):
        figure = segmentation.draw(truths, parameters.defaults())
        figure.draw_without_rendering()
    captions = {axes.get_xlabel(): axes for axes in figure.axes if axes.get_xlabel()}
    assert title in {caption.replace("\n", " ") for caption in captions}
    for axes in captions.values():
        assert axes.xaxis.label.get_window_extent().width <= axes.get_window_extent().width


def test_without_flights_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "figures"
    assert main(["figures", str(out), "--flights", str(tmp_path)]) == 2
    assert "holds no flights" in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_that_cannot_be_made_is_named(
    pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "figures"
    assert main(["figures", str(out), "--flights", str(pictures.parent)]) == 2
    assert f"{out}: cannot be written: not a directory" in capsys.readouterr().err
    with pytest.raises(InputError, match="cannot be written: not a directory"):
        write_image(out / "frame.png", np.zeros((2, 2), np.uint8))


def test_correctness_by_hand() -> None:
    """One of 4 sky pixels is matched; 4 of 6 others are, one of them by 2 px off."""
    exact_px = np.array([[0, 0, 0, 0, 8, 8, 8, 8, 8, 8]], np.float32)
    words = np.array([[INVALID, 40, INVALID, INVALID, 128, 130, 126, 160, INVALID, INVALID]], np.int16)
    assert correctness(words, exact_px) == "25 % of the sky matched,\n67 % of the rest, 25 % of that wrong"


def test_shades_are_the_papers() -> None:
    """Dark is far, light is near, white is undefined."""
    far, near, undefined = shade(np.array([[16, 160, INVALID]], np.int16), 31)[0]
    assert far < near < undefined == 255


def flight(name: str, kind: str | None, speed_ft_s: float, frames: int = 0) -> FlightTruth:
    target = kind and TrueObject(1, kind, kind, True, True, np.zeros(3), np.zeros(3), (1.0, 1.0))
    objects = {1: target} if target else {}
    speed_m_s = speed_ft_s * FOOT_M
    times_ns = tuple(range(frames))
    return FlightTruth(Path(), name, name, "dev", 1000.0, 0.5, (0, 0), speed_m_s, 10.0, objects, times_ns, ())


def names(truths: list[FlightTruth]) -> list[str]:
    return [truth.name for truth in truths]


def test_the_four_flights_are_the_papers() -> None:
    held = [flight("a", "pole", 10), flight("b", None, 30), flight("c", "sign", 30), flight("d", "pole", 30)]
    assert names(the_four([*held, flight("e", "sign", 10)])) == ["e", "c", "d", "a"]
    assert names(the_four([*held, flight("e", "tree", 10)])) == ["c", "d", "a", "e"]


def test_of_flights_alike_the_one_so_named_is_shown_or_the_longest() -> None:
    """A sign in haze and one from nearby come before it by name, one in fog is longer."""
    held = [
        flight("close", "sign", 10, 60),
        flight("fog", "sign", 30, 100),
        flight("haze", "sign", 30, 82),
        flight("pole_10", "pole", 10, 172),
    ]
    held += [flight("pole_30", "pole", 30, 82), flight("sign_10", "sign", 10, 172)]
    held += [flight("sign_30", "sign", 30, 82), flight("wind", "pole", 30, 68)]
    assert names(the_four(held)) == ["sign_10", "sign_30", "pole_30", "pole_10"]
    held = [one for one in held if one.name != "sign_30"]
    assert names(the_four(held)) == ["sign_10", "fog", "pole_30", "pole_10"]


def test_segmentations_are_of_many_kinds() -> None:
    kinds = ("sign", "sign", "sign", "pole", "tree", None, "wall", "wall")
    held = [flight(f"{k}", kind, 10) for k, kind in enumerate(kinds)]
    assert names(various(held)) == ["0", "3", "4", "5", "6", "1"]
