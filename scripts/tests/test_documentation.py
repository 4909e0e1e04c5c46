"""What the documentation names exists, its tables are those of the figures, generated parts are complete."""

from __future__ import annotations

import argparse
import functools
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import make_pages  # noqa: E402
import make_tables  # noqa: E402
from vista import cli  # noqa: E402
from vista_eval.report.table import Table, write_measurement  # noqa: E402

FOLDERS = ("rtl", "model", "sw", "tb", "scripts", "doc")
GENERATED = {
    "generated/parameters.md",
    "generated/obstacles.md",
    "generated/requirements.md",
    "generated/c.md",
    "../generated/testplan.md",
}
PAGES = [*ROOT.glob("*.md"), *(page for folder in FOLDERS for page in sorted((ROOT / folder).rglob("*.md")))]
PAGES = [page for page in PAGES if page.parent.name != "generated"]


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def code(text: str) -> Iterator[str]:
    """What stands in backticks, and the lines of code blocks."""
    yield from re.findall(r"`([^`\n]+)`", text)
    yield from (line for line in text.splitlines() if line.startswith("    "))
    for block in re.findall(r"^```\w*\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        yield from block.splitlines()


# ---- links, targets, options, files ----


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_relative_link_leads_somewhere(page: Path) -> None:
    text = page.read_text()
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text) + re.findall(
        r"^```{include} (\S+)$", text, re.MULTILINE
    )
    links += [f"{entry}.md" for tree in re.findall(r"```{toctree}(.*?)```", text, re.DOTALL)
              for entry in tree.split("\n") if re.fullmatch(r"[\w/-]+", entry)]  # fmt: skip
    local = [link for link in links if not re.match(r"[a-z]+:", link) and link not in GENERATED]
    assert [link for link in local if not (page.parent / link).exists()] == []


def make_targets() -> set[str]:
    rules = "\n".join(
        path.read_text() for path in [ROOT / "Makefile", *ROOT.glob("*/*.mk"), *ROOT.glob("*/*/*.mk")]
    )
    return set(re.findall(r"^([a-z][a-z0-9-]*):", rules, re.MULTILINE))


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_make_target_exists(page: Path) -> None:
    calls = [
        call
        for text in code(page.read_text())
        for call in re.findall(r"\bmake ((?:[a-z][a-z0-9-]* ?)+)", text)
    ]
    named = {target for call in calls for target in call.split()}
    assert named - make_targets() == set()


@functools.cache
def options_of(command: str) -> set[str]:
    """The options that `vista COMMAND` takes."""
    parser = cli.make_parser(command)
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    return {option for action in commands.choices[command]._actions for option in action.option_strings}


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_command_takes_the_options_that_are_named(page: Path) -> None:
    for text in code(page.read_text()):
        for command, rest in re.findall(r"\bvista ([a-z]+)((?: [^;#]*)?)", text):
            if command in cli.commands_known():
                assert set(re.findall(r"(?<= )--[a-z-]+", rest)) - options_of(command) == set(), text


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_file_that_is_named_exists(page: Path) -> None:
    named = {
        path.partition("::")[0]
        for text in code(page.read_text())
        for path in re.findall(
            r"(?<![\w./])[\w./-]+\.(?:py|toml|json|sv|svh|md|h|c|cpp|f|core|rdl|vlt|txt|sh)\b", text
        )
        if path.partition("/")[0] in FOLDERS
    }
    assert {path for path in named if "NAME" not in path and not (ROOT / path).exists()} == set()


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text().splitlines()) <= 120


def test_one_version_for_everything() -> None:
    version = (ROOT / "VERSION").read_text().strip()
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(
        rf"^## (Unreleased: |\[?){re.escape(version)}\b", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE
    )


# ---- tables ----


def test_tables_are_those_of_the_figures() -> None:
    assert make_tables.write_tables(check=True) == []


def test_a_changed_figure_changes_its_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(make_tables.DATA, tmp_path, dirs_exist_ok=True)
    content = json.loads((tmp_path / "engine.json").read_text())
    content["tables"][0]["rows"][0][1] = "77.77"
    content["measured"]["commit"] = "0123abc"
    (tmp_path / "engine.json").write_text(json.dumps(content))
    page = (ROOT / "doc" / "results" / "engine.md").read_text()
    monkeypatch.setattr(make_tables, "DATA", tmp_path)
    assert "77.77" not in page and "0123abc" not in page
    made = make_tables.with_tables(page, make_tables.measured_tables())
    assert "77.77" in made and made.count("*Measured at commit 0123abc, ") == 2


def test_figures_that_are_saved_for_the_first_time_have_their_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, page, raw = tmp_path / "data", tmp_path / "page.md", tmp_path / "raw.json"
    data.mkdir()
    page.write_text("<!-- table: hits -->\n<!-- end of table -->\n")
    table = {
        "name": "hits",
        "heads": ["family", "hits"],
        "rows": [["bare", "77 of 88"]],
        "legend": "H: h.",
    }
    raw.write_text(json.dumps({"figures": {"hits": 77}, "tables": [table], "flights": ["left out"]}))
    monkeypatch.setattr(make_tables, "DATA", data)
    monkeypatch.setattr(make_tables, "pages", lambda: [page])
    save = ["--save", f"worlds-test={raw}", "--command", "vista worlds"]
    monkeypatch.setattr(sys, "argv", ["make_tables.py", *save])
    assert make_tables.main() == 0
    assert "| bare | 77 of 88 |\n\nH: h.\n\n*Measured at commit" in page.read_text()
    assert set(json.loads((data / "worlds-test.json").read_text())) == {"measured", "figures", "tables"}


def test_the_parts_that_are_not_measured_now_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(make_tables, "DATA", tmp_path)
    raw = tmp_path / "raw"
    for rows in ([["`vga` 60 Hz", "1"], ["`hd`", "2"]], [["`vga`", "3"]]):
        table = {"name": "rates", "heads": ["preset", "rate"], "rows": rows, "parts": True}
        raw.write_text(json.dumps({"tables": [table]}))
        make_tables.save("rates", raw, "vista throughput")
    (table,) = make_tables.tables_of(tmp_path / "rates.json")
    assert table["rows"] == [["`hd`", "2"], ["`vga`", "3"]]


def test_a_table_of_what_never_happened_has_no_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(make_tables, "DATA", tmp_path)
    raw = tmp_path / "raw"
    write_measurement(raw, [Table("losses", ("lost", "by"), [])])
    make_tables.save("losses", raw, "vista fly")
    assert make_tables.tables_of(tmp_path / "losses.json")[0]["rows"] == []


def test_the_commits_of_figures_are_in_the_history() -> None:
    """Not those of a branch that was rebased: nobody else has them."""
    if run_git("rev-parse", "--is-shallow-repository") != "false":
        pytest.skip("no history here")
    for path in make_tables.figure_files():
        for commit in re.findall(r'"commit": "([0-9a-f]+)"', path.read_text()):
            assert run_git("merge-base", "--is-ancestor", commit, "HEAD") is not None, f"{path}: {commit}"


def run_git(*arguments: str) -> str | None:
    """None: it failed."""
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else None


def test_every_table_is_used() -> None:
    found = [found for page in make_tables.pages() for found in make_tables.MARKED.findall(page.read_text())]
    assert {name for _, name, *_ in found} == {"headline", "sources", *make_tables.measured_tables()}


# ---- generated pages ----


def test_every_parameter_is_documented() -> None:
    schema = {
        "stereo": {
            "doc": "About stereo.",
            "cap": {
                "type": "int",
                "default": 3,
                "min": 1,
                "max": 9,
                "unit": "px",
                "doc": "A cap.",
                "at_most": "top",
            },
            "form": {"type": "choice", "choices": ["a", "b"], "default": "a", "doc": "A form."},
        }
    }
    page = make_pages.parameters_page(schema)
    assert "## stereo" in page and "About stereo." in page
    assert "| `cap` | `3` | 1 to 9 px, at most `top` | A cap. |" in page
    assert "| `form` | `a` | `a`, `b` | A form. |" in page


def test_every_key_of_the_schema_is_documented() -> None:
    schema = json.loads(make_pages.SCHEMA.read_text())
    page = make_pages.obstacles_page(schema)

    def keys(part: object) -> Iterator[str]:
        if isinstance(part, dict):
            yield from part.get("properties", {})
            for content in part.values():
                yield from keys(content)

    assert {key for key in keys(schema) if f"{key}`" not in page} == set()
    assert "`obstacles[].ellipse_px.center`" in page and "array of 2 (number)" in page


HEADER = """/* The head * of the file. */
#ifndef A_H
#define A_H /* stays */

/* A point.
 * In px. */
typedef struct point {
  double u_px; /* to the right,
                * not to the left */
  double v_px; /* down */
  int a, *b;
} point;
#endif
"""


def test_comments_of_headers_come_before_what_they_describe() -> None:
    lines = make_pages.documented(HEADER).splitlines()
    assert lines[0] == "/* The head * of the file. */" and "#define A_H /* stays */" in lines
    place = lines.index("  double u_px;")
    assert lines[place - 4 : place] == ["  /**", "   * to the right,", "   * not to the left", "   */"]
    assert lines[lines.index("typedef struct point {") - 3 :][:2] == [" * A point.", " * In px."]
    assert "  /** */\n  int a;\n  /** */\n  int *b;" in "\n".join(lines)
    assert "The head * of the file." in make_pages.c_page({"a.h": HEADER})


def undocumented(header: str) -> list[str]:
    """Functions, structs and enums of a header that have no comment before them."""
    lines = make_pages.documented(header).splitlines()
    starts = [
        (number, line)
        for number, line in enumerate(lines)
        if re.match(r"typedef (struct|enum) \w+ {|VISTA_API |VISTA_ENGINE_API |static inline \w", line)
    ]
    return [line for number, line in starts if not lines[number - 1].endswith("*/")]


@pytest.mark.parametrize(("header", "text"), make_pages.headers().items(), ids=list(make_pages.headers()))
def test_everything_public_in_c_is_documented(header: str, text: str) -> None:
    assert undocumented(text) == []


def test_an_undocumented_declaration_is_found() -> None:
    assert undocumented(HEADER) == []
    assert undocumented(HEADER.replace("/* A point.\n * In px. */\n", "")) == ["typedef struct point {"]
