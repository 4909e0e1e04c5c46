"""Writes what `vista throughput --out DIR` found, as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from vista.errors import InputError
from vista.output import unwritable, write_atomically

from vista_throughput.assess import Answer, as_json

JSON = "throughput.json"


def check_folder(folder: Path) -> None:
    """Checks the folder before minutes are spent. Raises InputError for a file, or a folder that holds
    anything else."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(folder, "not a folder")
    foreign = sorted({path.name for path in folder.iterdir()} - {JSON})
    if foreign:
        reason = f"holds other files ({foreign[0]}); name a new folder, or one of an earlier run"
        raise InputError(folder, reason)


def write_results(folder: Path, answer: Answer) -> Path:
    """Returns the path of the file."""
    found = as_json(answer)
    content = json.dumps({"tables": [stated(found)]} | found, indent=1, allow_nan=False) + "\n"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None
    write_atomically(folder / JSON, content)
    return folder / JSON


def stated(found: dict[str, Any]) -> dict[str, Any]:
    """The row of the documentation's table; those of other presets stay when it is taken over."""
    system, figures, needed, limit = (found[key] for key in ("system", "figures", "clock_needed", "limit"))
    clock_mhz, needed_mhz = (round(hz / 1e6, 2) for hz in (system["engine_clock_hz"], needed["clock_hz"]))
    row = {
        "preset": f"`{found['preset']}`",
        "camera": f"{system['width_px']}x{system['height_px']}, {system['camera_rate_hz']:g} Hz",
        "engine": f"{system['disparities']} disparities, {clock_mhz:.1f} MHz",
        "frames dropped": f"{figures['dropped']} of {figures['delivered'] + figures['dropped']}",
        "first pixel to obstacle map, ms: median (99th percentile)": f"{figures['latency_p50_ms']:.1f} "
        f"({figures['latency_p99_ms']:.1f})",
        "maximum rate with a faster camera, frames/s": f"{limit['rate_hz']:.0f}, "
        f"limited by the {limit['stage']}",
        "clock that the camera needs, MHz": f"{needed_mhz:.3g}, 1/{clock_mhz / needed_mhz:.1f} of the clock",
    }
    return {"name": "throughput", "heads": list(row), "rows": [list(row.values())], "parts": True}
