"""What `make synth` placed and routed, as rtl/synth/results.json records it."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from pathlib import Path

from vista.errors import InputError

RESULTS = Path("rtl/synth/results.json")


@dataclass(frozen=True)
class Build:
    """One engine, placed and routed. The clock is the median over the seeds of the placer."""

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
    """The builds that have a clock, in the order of the file. Raises InputError naming the file."""
    try:
        return tuple(
            Build(
                int(one["disparities"]),
                int(one["block_px"]),
                int(one["max_width_px"]),
                str(one["device"]),
                int(one["speed_grade"]),
                int(one["lut4"]),
                float(one["clock_mhz"]),
            )
            for one in json.loads(text)["builds"]
            if one["clock_mhz"] is not None
        )
    except (ValueError, TypeError, KeyError) as error:
        raise InputError(RESULTS, f"not what `make synth` writes: {error}") from None


@functools.cache
def builds() -> tuple[Build, ...]:
    """The builds that this checkout records; none where there is no checkout."""
    for parent in Path(__file__).resolve().parents:
        if (parent / RESULTS).is_file():
            return parse((parent / RESULTS).read_text())
    return ()


def find(disparities: int, block_px: int, max_width_px: int | None = None) -> Build | None:
    """The build with the slowest speed grade, whose clock faster parts reach too; None if there is none."""
    found = [
        build
        for build in builds()
        if (build.disparities, build.block_px) == (disparities, block_px)
        and max_width_px in (None, build.max_width_px)
    ]
    return min(found, key=lambda build: build.speed_grade, default=None)
