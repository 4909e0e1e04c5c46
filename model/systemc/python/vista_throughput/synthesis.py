"""What `make synth` placed and routed: the table of rtl/README.md, its only record, read back."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

from vista.errors import InputError

README = Path("rtl/README.md")
MARKS = ("<!-- synth: written by `make synth` -->", "<!-- /synth -->")  # of scripts/synth_rtl.py
_COLUMNS = {
    "disparities": "disparities",
    "block": "block_px",
    "width": "max_width_px",
    "device": "device",
    "speed": "speed_grade",
    "LUT4": "lut4",
    "MHz: median (range)": "clock_mhz",
}


@dataclass(frozen=True)
class Build:
    """One engine, placed and routed; the clock is the highest of its timing reports, median of the seeds."""

    disparities: int
    block_px: int
    max_width_px: int
    device: str
    speed_grade: int
    lut4: int
    clock_mhz: float

    def __str__(self) -> str:
        return (
            f"{self.disparities} disparities, block {self.block_px}, up to {self.max_width_px} px wide, "
            f"on {self.device} speed {self.speed_grade}"
        )


def parse(text: str) -> tuple[Build, ...]:
    """The rows between the marks of rtl/README.md, in their order."""
    _, start, rest = text.partition(MARKS[0])
    rows = [
        [cell.strip() for cell in line.strip().strip("|").split("|")]
        for line in rest.partition(MARKS[1])[0].splitlines()
        if line.startswith("|")
    ]
    if not start or len(rows) < 3:
        raise InputError(README, "has no table of `make synth`")
    head, _, *body = rows
    try:
        places = {field: head.index(column) for column, field in _COLUMNS.items()}
        return tuple(_build({field: row[place] for field, place in places.items()}) for row in body)
    except (ValueError, IndexError) as error:
        raise InputError(README, f"table of `make synth`: {error}") from None


def _build(cells: dict[str, str]) -> Build:
    return Build(
        int(cells["disparities"]),
        int(cells["block_px"]),
        int(cells["max_width_px"]),
        cells["device"],
        int(cells["speed_grade"]),
        int(cells["lut4"]),
        float(cells["clock_mhz"].split()[0]),
    )


@functools.cache
def builds() -> tuple[Build, ...]:
    """Of this checkout; none where there is no checkout."""
    for parent in Path(__file__).resolve().parents:
        if (parent / README).is_file():
            return parse((parent / README).read_text())
    return ()


def find(disparities: int, block_px: int, max_width_px: int | None = None) -> Build | None:
    """The slowest speed grade of such a build, which faster parts keep too; None if there is none."""
    found = [
        build
        for build in builds()
        if (build.disparities, build.block_px) == (disparities, block_px)
        and max_width_px in (None, build.max_width_px)
    ]
    return min(found, key=lambda build: build.speed_grade, default=None)
