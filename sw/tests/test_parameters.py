"""Parameters: one TOML, from which the C structs are generated, and by which Python and C judge alike."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from shared_data import REPOSITORY
from stage_library import default_parameters, ffi, lib
from vista import parameters
from vista.cli import main
from vista.errors import InputError

GENERATOR = REPOSITORY / "scripts" / "make_parameters.py"
TOML = REPOSITORY / "sw" / "parameters.toml"
HEADER = REPOSITORY / "sw" / "include" / "vista" / "parameters.h"
TABLE = REPOSITORY / "sw" / "src" / "common" / "parameters_table.h"

ENTRIES = {
    f"{section}.{name}": entry
    for section in parameters.schema()
    for name, entry in parameters.entries(section).items()
}


# ---- the generator ----


def generate(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    paths = [folder / path.name for path in (TOML, HEADER, TABLE)]
    command = [sys.executable, str(GENERATOR), *map(str, paths), *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.fixture
def generated(tmp_path: Path) -> Path:
    for path in (TOML, HEADER, TABLE):
        shutil.copy(path, tmp_path)
    return tmp_path


@pytest.mark.parametrize("path", [HEADER, TABLE], ids=lambda path: path.name)
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
    (row,) = (line for line in (generated / TABLE.name).read_text().splitlines() if "gate_chi2)" in line)
    assert "VISTA_PARAMETER_FLOAT, 12.5, 0.1, 1000.0" in row


# ---- C and Python ----


def number(entry: dict[str, Any], value: Any) -> float:
    """A value as C has it: a choice is an enum."""
    return float(entry["choices"].index(value) if entry["type"] == "choice" else value)


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


def test_the_defaults_agree_and_lie_in_their_ranges() -> None:
    values = default_parameters()
    assert culprit_in_c(values) is None
    expected = {name: number(entry, entry["default"]) for name, entry in ENTRIES.items()}
    assert {name: float(field(values, name)) for name in ENTRIES} == expected


@pytest.mark.parametrize("name", ENTRIES)
def test_set_changes_the_named_parameter_only(name: str) -> None:
    values = default_parameters()
    expected = {other: float(field(values, other)) for other in ENTRIES} | {name: other_value(name)}
    assert set_by_name(values, name, other_value(name)) == lib.VISTA_OK
    assert {other: float(field(values, other)) for other in ENTRIES} == expected


UNKNOWN = ["", "foveation", "foveation.", "foveation.rho", "rho_0_px", "a" * 1000]
KNOWN = ["stereo.block_size", "affinity.form", "foveation.rho_0_px"]
NO_NUMBER = [math.nan, math.inf, -math.inf, 1e10, -1e300]


@pytest.mark.parametrize(
    ("name", "number"), [(name, 1.0) for name in UNKNOWN] + list(product(KNOWN, NO_NUMBER))
)
def test_set_refuses_unknown_names_and_numbers_that_no_parameter_has(name: str, number: float) -> None:
    values = default_parameters()
    before = bytes(ffi.buffer(values))
    assert set_by_name(values, name, number) == lib.VISTA_ERROR_RANGE
    assert bytes(ffi.buffer(values)) == before


def test_null_pointers() -> None:
    values = default_parameters()
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
        values = default_parameters()
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
    values = default_parameters()
    values.tracker.confirm_hits, values.tracker.confirm_window = hits, window
    expected = None if hits <= window else "tracker.confirm_hits"
    assert culprit_in_c(values) == expected
    changes = {"tracker.confirm_hits": hits, "tracker.confirm_window": window}
    assert culprit_in_python(tmp_path, changes) == expected


# ---- the table of C, and headers of other versions ----


def test_the_table_lists_what_the_toml_says() -> None:
    assert lib.vista_parameter_count() == len(ENTRIES)
    assert lib.vista_parameter_info(-1) == lib.vista_parameter_info(len(ENTRIES)) == ffi.NULL
    kinds = {"int": lib.VISTA_PARAMETER_INT, "float": lib.VISTA_PARAMETER_FLOAT}
    for index, (name, entry) in enumerate(ENTRIES.items()):
        info = lib.vista_parameter_info(index)
        texts = [ffi.string(text).decode() for text in (info.name, info.unit, info.doc, info.at_most)]
        limit = f"{name.partition('.')[0]}.{entry['at_most']}" if "at_most" in entry else ""
        assert texts == [name, entry.get("unit", ""), entry["doc"], limit]
        assert info.type == kinds.get(entry["type"], lib.VISTA_PARAMETER_CHOICE)
        choices = [ffi.string(info.choices[k]).decode() for k in range(info.choice_count)]
        assert choices == entry.get("choices", [])
        assert info.default_value == number(entry, entry["default"])
        ends = (0, len(choices) - 1) if choices else (entry["min"], entry["max"])
        assert (info.min, info.max) == ends


def test_a_choice_is_set_by_its_name_and_read_back() -> None:
    values, value = default_parameters(), ffi.new("double *")
    for name, entry in ENTRIES.items():
        for k, choice in enumerate(entry.get("choices", [])):
            assert lib.vista_parameters_set_choice(values, name.encode(), choice.encode()) == lib.VISTA_OK
            assert field(values, name) == k
            assert lib.vista_parameters_get(values, name.encode(), value) == lib.VISTA_OK
            assert value[0] == k
    for name, choice in (("affinity.form", "none"), ("affinity.form", ""), ("none.form", "sum")):
        status = lib.vista_parameters_set_choice(values, name.encode(), choice.encode())
        assert status == lib.VISTA_ERROR_RANGE


def test_a_caller_with_fewer_parameters_keeps_what_lies_behind_them() -> None:
    """An older header: its struct ends before the last section."""
    size = ffi.offsetof("vista_parameters", "obstacle_map")
    memory = ffi.new("unsigned char[]", ffi.sizeof("vista_parameters"))
    ffi.memmove(memory, b"\xa5" * len(memory), len(memory))
    old = ffi.cast("vista_parameters *", memory)
    assert lib.vista_parameters_init(old, size) == lib.VISTA_OK
    assert bytes(ffi.buffer(memory))[size:] == b"\xa5" * (len(memory) - size)
    assert culprit_in_c(old) is None
    assert old.tracker.gate_chi2 == ENTRIES["tracker.gate_chi2"]["default"]
    unknown = b"obstacle_map.collision_radius_m"
    assert lib.vista_parameters_set(old, unknown, 3.0) == lib.VISTA_ERROR_RANGE
    assert lib.vista_parameters_get(old, unknown, ffi.new("double *")) == lib.VISTA_ERROR_RANGE


def test_a_caller_with_more_parameters_gets_zeros_behind_them() -> None:
    size = ffi.sizeof("vista_parameters") + 256
    memory = ffi.new("unsigned char[]", size)
    ffi.memmove(memory, b"\xa5" * size, size)
    new = ffi.cast("vista_parameters *", memory)
    assert lib.vista_parameters_init(new, size) == lib.VISTA_OK
    assert not any(bytes(ffi.buffer(memory))[size - 256 : size])
    assert culprit_in_c(new) is None


def test_parameters_that_nobody_initialised_are_refused() -> None:
    zeros = ffi.new("vista_parameters *")
    assert lib.vista_parameters_check(zeros, ffi.NULL) == lib.VISTA_ERROR_SIZE
    assert lib.vista_parameters_init(zeros, 8) == lib.VISTA_ERROR_SIZE
    assert lib.vista_parameters_init(ffi.NULL, 1000) == lib.VISTA_ERROR_ARGUMENT


# ---- vista config ----


def test_config_prints_the_defaults(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["config"]) == 0
    printed = capsys.readouterr().out
    for name in ENTRIES:
        assert f"\n{name.partition('.')[2]} = " in printed
    (tmp_path / "config.toml").write_text(printed)
    nothing = {section: dict.fromkeys(content) for section, content in parameters.defaults().items()}
    assert parameters.load(tmp_path / "config.toml", base=nothing) == parameters.defaults()
