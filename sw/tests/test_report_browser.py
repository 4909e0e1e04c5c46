"""report.html in a real browser, at the widths of a phone, a tablet and a desktop."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Page, needs_browser
from report_cases import make_records, render, with_ground_ahead

pytestmark = [needs_browser, pytest.mark.slow]
WIDTHS_PX = (375, 800, 1300)
FRAMES = 12
PLOTS = ("distances", "map", "left", "valid", "seen")

# Boxes of all visible texts of the charts; of two that overlap, their words.
COVERED_LABELS = """(() => {
  const covered = [];
  for (const chart of document.querySelectorAll("svg.chart")) {
    const texts = [...chart.querySelectorAll("text")]
      .map((text) => [text.textContent, text.getBoundingClientRect()]);
    texts.forEach(([a, p], k) => texts.slice(k + 1).forEach(([b, q]) => {
      const beside = p.left > q.right - 1 || q.left > p.right - 1;
      const apart = beside || p.top > q.bottom - 3 || q.top > p.bottom - 3;
      if (!apart) covered.push(a + " / " + b);
    }));
    const area = chart.getBoundingClientRect();
    for (const [text, box] of texts)
      if (box.left < area.left - 1 || box.right > area.right + 1) covered.push(text + " / edge");
  }
  return covered;
})()"""
TOO_WIDE = """[...document.querySelectorAll("main *")]
  .filter((e) => !e.closest("#stage, .rows, .thumb, svg, details"))
  .filter((e) => e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.outerHTML.slice(0, 80))"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    browser = Page(tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A flight with two blind frames and a crowd of tracks that end in one place, stills, and both again with
    the ground ahead."""
    folder = tmp_path_factory.mktemp("reports")
    render(folder / "flight", make_records(FRAMES, blind=range(5, 7), crowd=25))
    render(folder / "stills", make_records(5, poses=False), stills=True)
    render(folder / "descent", with_ground_ahead(make_records(3)))
    render(folder / "meadows", with_ground_ahead(make_records(3, poses=False)), stills=True)
    return {name: folder / name / "report.html" for name in ("flight", "stills", "descent", "meadows")}


def place(page: Page, selector: str, x: float = 0.5, y: float = 0.5) -> tuple[float, float]:
    """A place of the window: so far from left to right and from top to bottom of the element."""
    script = f"""(() => {{ const e = document.querySelector({selector!r});
      e.scrollIntoView({{block: "center"}});
      const b = e.getBoundingClientRect(); return [b.left + {x} * b.width, b.top + {y} * b.height]; }})()"""
    return tuple(page.run(script))


def shown(page: Page) -> str:
    return page.run('document.getElementById("frame").textContent')


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width_px", WIDTHS_PX)
@pytest.mark.parametrize("name", ["flight", "stills"])
def test_everything_fits(page: Page, reports: dict[str, Path], name: str, width_px: int, dark: bool) -> None:
    page.problems.clear()
    page.open(reports[name], width_px, dark=dark)
    assert page.problems == []
    assert page.run("document.documentElement.scrollWidth") <= width_px
    assert page.run(TOO_WIDE) == []
    assert page.run(COVERED_LABELS) == []
    if name == "flight":
        assert page.run('document.querySelectorAll("#distances .label").length') >= 8  # not all dropped


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_the_slider_changes_the_picture(page: Page, reports: dict[str, Path], width_px: int) -> None:
    page.open(reports["flight"], width_px)
    assert shown(page) == "frame 1"  # the first with a warning
    pictures = set()
    for step in range(FRAMES):
        page.run(f'(() => {{ slider.value = {step}; slider.dispatchEvent(new Event("input")); }})()')
        assert shown(page) == f"frame {step}"
        pictures.add(page.run('document.getElementById("picture").src'))
    assert len(pictures) == FRAMES


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_pointing_at_a_plot_shows_its_frame_everywhere(
    page: Page, reports: dict[str, Path], width_px: int
) -> None:
    page.open(reports["flight"], width_px)
    for plot in PLOTS[:1] + PLOTS[2:]:
        seen = []
        for x in (0.35, 0.75):
            page.mouse(*place(page, f"#{plot} svg", x))
            seen.append((shown(page), page.run('document.getElementById("picture").src')))
            charts = '[...document.querySelectorAll(".chart")]'
            assert page.run(f'{charts}.every((chart) => chart.querySelector(".cursor > *"))')
        assert seen[0][0] != seen[1][0] and seen[0][1] != seen[1][1], plot
    heights = set()
    for step in range(FRAMES):  # the blind frames have more to say
        page.run(f'(() => {{ slider.value = {step}; slider.dispatchEvent(new Event("input")); }})()')
        heights.add(page.run("document.documentElement.scrollHeight"))
    assert len(heights) == 1  # else the plots would move away from the pointer
    page.mouse(*place(page, "#map path.path", 0.5, 1.0))  # the start of the camera's way
    assert shown(page) == "frame 0"


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_a_click_selects_a_track_everywhere(page: Page, reports: dict[str, Path], width_px: int) -> None:
    page.open(reports["flight"], width_px)
    line = """(() => { const e = document.querySelector('#distances path[data-track="3"]');
      e.scrollIntoView({block: "center"});
      const p = e.getPointAtLength(0.5 * e.getTotalLength()).matrixTransform(e.getScreenCTM());
      return [p.x, p.y]; })()"""
    page.mouse(*page.run(line), click=True)
    for chart in ("distances", "map"):
        chosen = f'[...document.querySelectorAll("#{chart} path.selected")].map((e) => e.dataset.track)'
        assert page.run(chosen) == ["3"], chart
    row = '[...document.querySelectorAll("#tracks tr[aria-selected=true]")].map((e) => e.dataset.key)'
    assert page.run(row) == ["3"]
    ellipse = 'new Set([...document.querySelectorAll(".finder .selected")].map((e) => e.dataset.track)).size'
    assert page.run(ellipse) == 1
    assert "#3 selected" in page.run("chosen.textContent")
    page.key("Escape")
    assert page.run(row) == [] and "selected" not in page.run("chosen.textContent")
    page.run("document.querySelector('#tracks tr[data-key=\"2\"]').focus()")
    page.key("Enter")
    assert page.run(row) == ["2"]
    page.mouse(*place(page, '#stage ellipse[data-track="1"]'), click=True)
    assert page.run(row) == ["1"]


def test_keys_and_tables(page: Page, reports: dict[str, Path]) -> None:
    page.open(reports["flight"], 1300)
    for key, frame in (("ArrowRight", 2), ("ArrowLeft", 1), ("End", FRAMES - 1), ("Home", 0)):
        page.key(key)
        assert shown(page) == f"frame {frame}"
    column = (
        '[...document.querySelectorAll("#tracks tbody tr")].map((row) => Number(row.cells[5].dataset.value))'
    )
    for order in (False, True):
        page.mouse(*place(page, "#tracks th:nth-child(6) button"), click=True)
        values = page.run(column)
        assert values == sorted(values, reverse=order)


def test_a_tab_shows_one_view_alone(page: Page, reports: dict[str, Path]) -> None:
    page.open(reports["flight"], 1300)
    size = "[stage.clientWidth / stage.clientHeight, picture.clientWidth / stage.clientWidth]"
    assert page.run(size)[1] == pytest.approx(1.0, abs=0.01)
    page.mouse(*place(page, '#tabs [data-tile="1"]'), click=True)
    aspect, enlarged = page.run(size)
    assert aspect == pytest.approx(160 / 120, abs=0.01) and enlarged == pytest.approx(2.0, abs=0.05)


def test_blind_frames_are_marked(page: Page, reports: dict[str, Path]) -> None:
    page.open(reports["flight"], 800)
    marked = '[...document.querySelectorAll("#strip .blind")].map((e) => e.dataset.frame)'
    assert page.run(marked) == ["5", "6"]
    assert page.run('document.querySelectorAll("#distances .band.blind").length') == 2
    page.run('(() => { slider.value = 5; slider.dispatchEvent(new Event("input")); })()')
    assert "blind: nothing found does not mean free space" in page.run("says.textContent")
    assert "In 2 of 12 frames" in page.run('document.querySelector("[role=alert]").textContent')


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("descent", "collision warning: ground at 9.0 m, "),
        ("meadows", "in the collision volume: ground at 9.0 m"),
    ],
)
def test_ground_ahead_is_called_ground(page: Page, reports: dict[str, Path], name: str, words: str) -> None:
    page.problems.clear()
    page.open(reports[name], 800)
    assert words in page.run("says.textContent")
    assert page.problems == []


def test_stills_are_a_gallery(page: Page, reports: dict[str, Path]) -> None:
    page.problems.clear()
    page.open(reports["stills"], 800)
    assert page.run('document.querySelectorAll("#gallery button").length') == 5
    before = page.run("picture.src")
    page.mouse(*place(page, "#gallery button:nth-child(4)"), click=True)
    assert shown(page) == "picture 3" and page.run("picture.src") != before
    page.mouse(*place(page, '#pictures tr[data-key="1"]'), click=True)
    assert shown(page) == "picture 1"
    assert (
        page.run('["tracks", "map", "distances", "strip"].filter((id) => document.getElementById(id))') == []
    )
    page.mouse(*place(page, '#stage ellipse[data-track="1"]'), click=True)
    selected = '[...document.querySelectorAll(".finder .selected")].map((e) => e.dataset.track)'
    assert set(page.run(selected)) == {"1"} and page.run("chosen.textContent") == ""  # there are no tracks
    assert page.problems == []
