"""The log of scorings: nothing in it is edited, and nothing is scored that is not committed."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from checkout_on_disk import commit, make_checkout
from shared_data import REPOSITORY
from vista.errors import InputError
from vista_eval.metrics.scoring_log import LOG, append, broken_at, clean_commit, git, read_log
from vista_eval.worlds.sampled.frozen import (
    FROZEN,
    changed,
    check_rendered,
    digest_of_set,
    flights_of_the_set,
    read_frozen,
    write_frozen,
)


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    return make_checkout(tmp_path)


def logged(root: Path, scorings: int) -> list[str]:
    for number in range(scorings):
        append(root, {"commit": f"c{number}", "families": {"bare": {"hits": number}}})
    return (root / LOG).read_text().splitlines()


def test_a_line_is_appended_for_each_scoring(checkout: Path) -> None:
    assert read_log(checkout) == ""
    lines = logged(checkout, 3)
    assert [json.loads(line)["commit"] for line in lines] == ["c0", "c1", "c2"]
    assert broken_at(read_log(checkout)) is None


@pytest.mark.parametrize("edit", ["a figure", "a line left out", "two lines swapped", "a line put in"])
def test_an_edited_log_is_refused(checkout: Path, edit: str) -> None:
    lines = logged(checkout, 4)
    if edit == "a figure":
        lines[1] = lines[1].replace('"hits": 1', '"hits": 9')
    elif edit == "a line left out":
        del lines[1]
    elif edit == "two lines swapped":
        lines[1], lines[2] = lines[2], lines[1]
    else:
        lines.insert(2, lines[1])
    (checkout / LOG).write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="edited"):
        append(checkout, {"commit": "next"})


def test_only_what_is_committed_is_scored(checkout: Path) -> None:
    assert clean_commit(checkout) == git(checkout, "rev-parse", "HEAD").strip()
    logged(checkout, 1)  # an earlier scoring of the same commit
    clean_commit(checkout)
    (checkout / "code.py").write_text("2\n")
    with pytest.raises(InputError, match=r"code\.py is not committed"):
        clean_commit(checkout)
    commit(checkout, "second")
    (checkout / "more.py").write_text("3\n")
    with pytest.raises(InputError, match=r"more\.py is not committed"):
        clean_commit(checkout)


def test_the_frozen_set_tells_what_changed(checkout: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not frozen"):
        read_frozen(checkout, "test")
    write_frozen(checkout, "test", {"a_000": "1", "b_000": "2"})
    frozen = read_frozen(checkout, "test")
    assert changed(frozen, {"b_000": "2", "a_000": "1"}) == []
    assert changed(frozen, {"a_000": "3", "c_000": "4"}) == ["a_000", "b_000", "c_000"]
    for name, content in (("a_000", "1"), ("b_000", "other")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "content.json").write_text(json.dumps({"content": content}))
    check_rendered(frozen, [tmp_path / "a_000"])
    with pytest.raises(InputError, match="frozen"):
        check_rendered(frozen, [tmp_path / "a_000", tmp_path / "b_000"])
    content = json.loads((checkout / FROZEN["test"]).read_text())
    content["flights"]["a_000"] = "3"
    (checkout / FROZEN["test"]).write_text(json.dumps(content))
    with pytest.raises(InputError, match="edited"):
        read_frozen(checkout, "test")


# ---- the project's own ----


def test_the_projects_log_is_whole() -> None:
    assert broken_at(read_log(REPOSITORY)) is None


def test_every_version_of_the_projects_log_begins_with_the_one_before() -> None:
    """What the digests cannot tell: that lines at the end were left out, or all of them written anew."""
    try:
        commits = git(REPOSITORY, "log", "--format=%H", "--", str(LOG)).split()
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a checkout: the log's history is not there")
    now = read_log(REPOSITORY)
    for each in commits:
        shown = subprocess.run(
            ["git", "-C", str(REPOSITORY), "show", f"{each}:{LOG}"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert shown.returncode == 0, f"{each} deletes the log"
        assert now.startswith(shown.stdout), f"the log of {each} is not how it begins now"


@pytest.mark.slow
def test_what_is_scored_is_the_frozen_set() -> None:
    """Scorings name the digest of the set; the set has the flights of the catalog."""
    digests = {}
    for split in FROZEN:
        frozen = read_frozen(REPOSITORY, split)
        assert {flight.name for flight in flights_of_the_set(split)} == set(frozen)
        digests[split] = digest_of_set(frozen)
    for scoring in map(json.loads, read_log(REPOSITORY).splitlines()):
        assert scoring["set"] == digests[scoring.get("split", "test")]
