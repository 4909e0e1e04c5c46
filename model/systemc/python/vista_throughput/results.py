"""Writes the files of `vista throughput --out DIR`: JSON, report, timeline and sweeps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from markupsafe import Markup
from vista.errors import InputError
from vista.output import unwritable, write_atomically
from vista.report.page import fill_template

from vista_throughput import plots
from vista_throughput.assess import Answer, Sweeps, as_json
from vista_throughput.explore import PROBE_FRAMES
from vista_throughput.table import table

JSON, PAGE, TIMELINE, SWEEP = "throughput.json", "report.html", "timeline.png", "sweep.png"


def check_folder(folder: Path) -> None:
    """Checks the folder before minutes are spent. Raises InputError for a file, or a folder that holds
    anything else."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(folder, "not a folder")
    foreign = sorted({path.name for path in folder.iterdir()} - {JSON, PAGE, TIMELINE, SWEEP})
    if foreign:
        reason = f"holds other files ({foreign[0]}); name a new folder, or one of an earlier run"
        raise InputError(folder, reason)


def write_results(folder: Path, answer: Answer, swept: Sweeps, simulations: int) -> Path:
    """Everything is made before the first file is written. Returns the page's path."""
    timeline, sweep = plots.timeline(answer), plots.sweep_plot(answer, swept)
    found = as_json(answer, swept)
    content = json.dumps({"tables": [stated(found)]} | found, indent=1, allow_nan=False) + "\n"
    page = _render(answer, timeline.svg, sweep.svg, simulations)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None
    write_atomically(folder / JSON, content)
    write_atomically(folder / TIMELINE, timeline.png)
    write_atomically(folder / SWEEP, sweep.png)
    write_atomically(folder / PAGE, page)
    return folder / PAGE


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


def _render(answer: Answer, timeline: str, sweep: str, simulations: int) -> str:
    config = answer.config
    return fill_template(
        "throughput.html.j2",
        package="vista_throughput",
        title=answer.preset or f"{config.width_px}x{config.height_px} at {config.camera_rate_hz:g} Hz",
        cards=_cards(answer),
        table=table(answer),
        timeline=Markup(timeline),
        sweep=Markup(sweep),
        simulations=simulations,
        probe_frames=PROBE_FRAMES,
        main_frames=len(answer.run.frames),
        config=config,
    )


def _cards(answer: Answer) -> list[tuple[str, str, str]]:
    """(value, name, remark) of the figures at the top of the page."""
    found, config, limit = answer.figures, answer.config, answer.limit
    total = found.delivered + found.dropped
    cards: list[tuple[str, str, str]] = [
        (f"{found.rate_hz:.1f} Hz", "obstacle maps", f"of {config.camera_rate_hz:g} Hz of the camera"),
        (str(found.dropped), "frames dropped", f"of {total}"),
        (
            f"{found.latency_p50_ms:.1f} ms",
            "first pixel to map",
            f"median; p99 {found.latency_p99_ms:.1f} ms",
        ),
    ]
    cards.append((answer.bottleneck, "bottleneck", "all that follows keeps up" if answer.keeps_up else ""))
    cards.append((f"{limit.rate_hz:.0f} Hz", "possible at most", f"limited by the {limit.stage}"))
    cards.append(_clock_card(answer))
    return cards


def _clock_card(answer: Answer) -> tuple[str, str, Any]:
    wanted, needed, margin = answer.config.camera_rate_hz, answer.needed, answer.clock_margin
    if needed is None or margin is None:
        return ("none", f"clock for {wanted:g} Hz", "memory does not keep up")
    clock_mhz = answer.config.engine_clock_hz / 1e6
    remark = f"1/{margin:.1f} of {clock_mhz:.4g} MHz" if margin >= 1 else f"above {clock_mhz:.4g} MHz"
    return (f"{needed.clock_hz / 1e6:.2f} MHz", f"clock for {wanted:g} Hz", remark)
