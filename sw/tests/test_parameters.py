"""Parameters: one TOML, from which the C structs are generated, and by which Python and C judge alike."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from cut_library import ffi, lib
from shared_data import REPOSITORY
from vista import parameters
from vista.cli import main
from vista.errors import InputError

GENERATOR = REPOSITORY / "scripts" / "make_parameters.py"
TOML = REPOSITORY / "sw" / "parameters.toml"
HEADER = REPOSITORY / "sw" / "include" / "vista" / "parameters.h"
SOURCE = REPOSITORY / "sw" / "src" / "parameters.c"

ENTRIES = {
    f"{section}.{name}": entry
    for section in parameters.schema()
    for name, entry in parameters.entries(section).items()
}


# ---- the generator ----


def generate(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    paths = [folder / path.name for path in (TOML, HEADER, SOURCE)]
    command = [sys.executable, str(GENERATOR), *map(str, paths), *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.fixture
def generated(tmp_path: Path) -> Path:
    for path in (TOML, HEADER, SOURCE):
        shutil.copy(path, tmp_path)
    return tmp_path


def test_the_generated_files_are_up_to_date(generated: Path) -> None:
    before = [(generated / path.name).stat().st_mtime_ns for path in (HEADER, SOURCE)]
    for options in (("--check",), ()):
        run = generate(generated, *options)
        assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    assert [(generated / path.name).stat().st_mtime_ns for path in (HEADER, SOURCE)] == before


@pytest.mark.parametrize("path", [HEADER, SOURCE], ids=lambda path: path.name)
@pytest.mark.parametrize("damage", ["edited", "missing"])
def test_drift_is_found_and_mended(generated: Path, path: Path, damage: str) -> None:
    stale, wanted = generated / path.name, path.read_text()
    if damage == "edited":
        stale.write_text(wanted.replace("16", "17", 1))
    else:
        stale.unlink()
    before = stale.read_text() if stale.exists() else None
    run = generate(generated, "--check")
    assert (run.returncode, run.stdout) == (1, "")
    assert run.stderr.count("\n") == 1 and str(stale) in run.stderr
    assert (stale.read_text() if stale.exists() else None) == before
    assert generate(generated).returncode == 0
    assert stale.read_text() == wanted
    assert generate(generated, "--check").returncode == 0


def test_a_changed_default_reaches_the_source(generated: Path) -> None:
    toml = generated / TOML.name
    toml.write_text(toml.read_text().replace("default = 11.34", "default = 12.5"))
    assert generate(generated, "--check").returncode == 1
    assert generate(generated).returncode == 0
    assert ".tracker.gate_chi2 = 12.5," in (generated / SOURCE.name).read_text()


def test_what_is_generated_says_so() -> None:
    for path in (HEADER, SOURCE):
        assert "Generated" in path.read_text().splitlines()[0]


# ---- C and Python ----


def field(values: Any, name: str) -> Any:
    section, _, key = name.partition(".")
    return getattr(getattr(values, section), key)


def other_value(name: str) -> float:
    """A value in the middle of the range that is not the default."""
    entry = ENTRIES[name]
    if entry["type"] == "choice":
        return float(1 - entry["choices"].index(entry["default"]))
    middle = 0.5 * (entry["min"] + entry["max"])
    return math.floor(middle) if entry["type"] == "int" else middle


def set_by_name(values: Any, name: str, number: float) -> int:
    return lib.vista_parameters_set(values, name.encode(), number)


def culprit_in_c(values: Any) -> str | None:
    culprit = ffi.new("char const **")
    status = lib.vista_parameters_check(values, culprit)
    assert status == (lib.VISTA_OK if culprit[0] == ffi.NULL else lib.VISTA_ERROR_RANGE)
    assert status == lib.vista_parameters_check(values, ffi.NULL)
    return None if culprit[0] == ffi.NULL else ffi.string(culprit[0]).decode()


def test_the_structs_hold_the_entries_and_nothing_else() -> None:
    fields = [
        f"{section}.{name}"
        for section, struct in ffi.typeof("vista_parameters").fields
        for name, _ in struct.type.fields
    ]
    assert fields == list(ENTRIES)


def test_the_defaults_agree_and_lie_in_their_ranges() -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    assert culprit_in_c(values) is None
    expected = parameters.as_numbers(parameters.defaults())
    assert {name: float(field(values, name)) for name in ENTRIES} == expected


@pytest.mark.parametrize("name", ENTRIES)
def test_set_changes_the_named_parameter_only(name: str) -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    expected = {other: float(field(values, other)) for other in ENTRIES} | {name: other_value(name)}
    assert set_by_name(values, name, other_value(name)) == lib.VISTA_OK
    assert {other: float(field(values, other)) for other in ENTRIES} == expected


@pytest.mark.parametrize("name", ["", "foveation", "foveation.", "foveation.rho", "rho_0_px", "a" * 1000])
def test_set_refuses_unknown_names(name: str) -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    before = bytes(ffi.buffer(values))
    assert set_by_name(values, name, 1.0) == lib.VISTA_ERROR_RANGE
    assert bytes(ffi.buffer(values)) == before


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 1e10, -1e300])
@pytest.mark.parametrize("name", ["stereo.block_size", "affinity.form", "foveation.rho_0_px"])
def test_set_refuses_numbers_that_no_parameter_has(name: str, number: float) -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    before = bytes(ffi.buffer(values))
    assert set_by_name(values, name, number) == lib.VISTA_ERROR_RANGE
    assert bytes(ffi.buffer(values)) == before


def test_null_pointers() -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    assert lib.vista_parameters_set(ffi.NULL, b"stereo.block_size", 11.0) == lib.VISTA_ERROR_ARGUMENT
    assert lib.vista_parameters_set(values, ffi.NULL, 11.0) == lib.VISTA_ERROR_ARGUMENT
    assert lib.vista_parameters_check(ffi.NULL, ffi.NULL) == lib.VISTA_ERROR_ARGUMENT


def probes(entry: dict[str, Any]) -> dict[str, tuple[Any, bool]]:
    """Values at the ends of a range and just outside, each with whether it is allowed."""
    if entry["type"] == "choice":
        last = len(entry["choices"]) - 1
        return {"first": (0, True), "last": (last, True), "below": (-1, False), "above": (last + 1, False)}
    low, high = entry["min"], entry["max"]
    if entry["type"] == "int":
        return {
            "min": (low, True),
            "max": (high, True),
            "below": (low - 1, False),
            "above": (high + 1, False),
        }
    return {
        "min": (low, True),
        "max": (high, True),
        "below": (math.nextafter(low, -math.inf), False),
        "above": (math.nextafter(high, math.inf), False),
        "NaN": (math.nan, False),
        "infinite": (math.inf, False),
    }


def partner(name: str, value: Any) -> dict[str, Any]:
    """What has to change with a parameter so that only the parameter's own range is at stake."""
    for section in parameters.schema():
        for limited, entry in parameters.entries(section).items():
            limit = entry.get("at_most")
            if limit and name == f"{section}.{limited}":
                return {f"{section}.{limit}": ENTRIES[f"{section}.{limit}"]["max"]}
            if limit and name == f"{section}.{limit}":
                return {f"{section}.{limited}": entry["min"]}
    return {}


def culprit_in_python(folder: Path, changes: dict[str, Any]) -> str | None:
    def text(value: Any) -> str:
        return f"'{value}'" if isinstance(value, str) else repr(value)

    sections: dict[str, str] = {}
    for name, value in changes.items():
        section, _, key = name.partition(".")
        sections[section] = sections.get(section, f"[{section}]\n") + f"{key} = {text(value)}\n"
    path = folder / "config.toml"
    path.write_text("".join(sections.values()))
    try:
        parameters.load(path)
    except InputError as error:
        return str(error).removeprefix(f"{path}: ").split(" ")[0]
    return None


@pytest.mark.parametrize("name", ENTRIES)
def test_c_and_python_agree_on_the_range(tmp_path: Path, name: str) -> None:
    section, _, key = name.partition(".")
    entry = ENTRIES[name]
    for case, (value, allowed) in probes(entry).items():
        others = partner(name, value)
        values = ffi.new("vista_parameters *", lib.vista_parameters_default())
        for other, number in others.items():
            assert set_by_name(values, other, number) == lib.VISTA_OK
        if entry["type"] == "choice":
            assert set_by_name(values, name, value) == lib.VISTA_OK
            inside = 0 <= value < len(entry["choices"])
            value = entry["choices"][value] if inside else f"choice {value}"
        else:
            setattr(getattr(values, section), key, value)
        expected = None if allowed else name
        assert culprit_in_c(values) == expected, case
        assert culprit_in_python(tmp_path, others | {name: value}) == expected, case


@pytest.mark.parametrize("hits,window", [(1, 1), (5, 5), (6, 5), (32, 31), (32, 32)])
def test_c_and_python_agree_on_the_pair(tmp_path: Path, hits: int, window: int) -> None:
    values = ffi.new("vista_parameters *", lib.vista_parameters_default())
    values.tracker.confirm_hits, values.tracker.confirm_window = hits, window
    expected = None if hits <= window else "tracker.confirm_hits"
    assert culprit_in_c(values) == expected
    changes = {"tracker.confirm_hits": hits, "tracker.confirm_window": window}
    assert culprit_in_python(tmp_path, changes) == expected


# ---- vista config ----


def test_config_prints_the_defaults(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["config"]) == 0
    printed = capsys.readouterr().out
    for name in ENTRIES:
        assert f"\n{name.partition('.')[2]} = " in printed
    (tmp_path / "config.toml").write_text(printed)
    nothing = {section: dict.fromkeys(content) for section, content in parameters.defaults().items()}
    assert parameters.load(tmp_path / "config.toml", base=nothing) == parameters.defaults()
