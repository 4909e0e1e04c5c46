"""Frames that took a night are deleted on purpose only: by a new version of the renderer, for which this
test asks.

The renderer's code, as the cache sees it, and the libraries that draw are recorded in rendered_code.json.
To record them anew: python sw/eval/tests/test_render_version.py --accept
"""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

from vista_eval.cache import code_of
from vista_eval.render.version import FAST_RENDER_VERSION, RENDER_VERSION

RECORD = Path(__file__).with_name("rendered_code.json")
ENTRY = "vista_eval.render.flight"
LIBRARIES = ("embreex", "mitsuba", "numpy", "opencv-python-headless")
NO_PART = ("vista.errors", "vista.output", "vista_eval.cache")  # in what is drawn
ADVICE = """\
{what}. Frames rendered before are still taken for good.
If pictures or truth change: raise in vista_eval/render/version.py RENDER_VERSION (by path tracing) or
FAST_RENDER_VERSION (by casting rays), or both; they will be rendered anew.
In either case record the code: .venv/bin/python sw/eval/tests/test_render_version.py --accept"""


def as_it_is() -> dict[str, Any]:
    drawn_by = {name: digest for name, digest in code_of(ENTRY).items() if name not in NO_PART}
    return {
        "render_version": RENDER_VERSION,
        "fast_render_version": FAST_RENDER_VERSION,
        "libraries": {library: version(library) for library in LIBRARIES},
        "modules": dict(sorted(drawn_by.items())),
    }


def changed(recorded: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """Names of what draws otherwise; a module that was only moved is none of it."""
    known = set(recorded["modules"].values())
    modules = [name for name, digest in now["modules"].items() if digest not in known]
    gone = set(recorded["modules"].values()) - set(now["modules"].values())
    dropped = [name for name, digest in recorded["modules"].items() if digest in gone]
    libraries = [name for name, found in now["libraries"].items() if found != recorded["libraries"].get(name)]
    return sorted({*modules, *dropped, *libraries})


def test_the_version_is_raised_when_pictures_change() -> None:
    recorded, now = json.loads(RECORD.read_text()), as_it_is()
    what = changed(recorded, now)
    assert not what, ADVICE.format(what=f"Changed since the renderer was recorded: {', '.join(what)}")
    for name in ("render_version", "fast_render_version"):
        assert recorded[name] == now[name], ADVICE.format(what=f"{name.upper()} was raised")


def test_changed_and_moved_code_are_told_apart() -> None:
    now = as_it_is()
    moved = now | {"modules": {f"elsewhere.{name}": code for name, code in now["modules"].items()}}
    assert changed(now, moved) == []
    other = now | {"modules": now["modules"] | {ENTRY: "other"}}
    assert changed(now, other) == [ENTRY]
    assert changed(now, now | {"libraries": now["libraries"] | {"mitsuba": "0"}}) == ["mitsuba"]


def test_what_draws_is_recorded() -> None:
    """The renderer is loaded within functions: it counts all the same; what reads flights does not."""
    modules = set(as_it_is()["modules"])
    assert {
        f"vista_eval.render.{name}" for name in ("renderer", "shapes", "motion", "sensor", "rig")
    } <= modules
    assert "vista_eval.render.fast.renderer" in modules
    assert {"vista_eval.dataset.truth", "vista_eval.dataset.layout"} <= modules
    assert not any(name.startswith(("vista_eval.worlds", "vista_eval.metrics")) for name in modules)


if __name__ == "__main__":
    if sys.argv[1:] != ["--accept"]:
        sys.exit("usage: test_render_version.py --accept")
    RECORD.write_text(json.dumps(as_it_is(), indent=1) + "\n")
