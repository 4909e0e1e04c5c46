"""How fast the rows match again after the right camera has turned, and what that costs.

usage: alignment.py OUT.json [--figure PNG] [FLIGHT ...]

Recordings are the real ones of sw/tests/turned_recordings.py, and rendered flights whose folders are given.
They are played at 25 pairs/s, forwards and backwards; the raw right images are turned after 0.8 s. Each pair
is rectified and corrected as in `vista run`. What is measured is not what corrects: the rows of SIFT
features over all recordings of a group, with their median and 90th percentile, and in how many recordings
the median is within the aim at the end."""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

import turned_camera as turned
from turned_camera import Grey, degrees
from turned_recordings import REAL, sampled, turned_places
from vista.alignment import Alignment, Turn
from vista.geometry import RawCalibration
from vista.rectify import Rectifier
from vista.sequence import Frame, open_sequence
from vista_eval.report.table import Table, write_measurement

BEFORE, AFTER = 20, 51  # frames
TIMES_S = (0.0, 0.5, 1.0, 2.0)
LOOKED_AT = (-2, 0, 2, 4, 5, 6, 8, 12, 16, 25, 38, 50)  # frames from the turn on
AIM_PX = 0.2  # median, at the end
FEATURES = 1000
FISHEYE = (0.01, -0.01, 0.0, 0.0)  # k1 to k4
RATIO = 0.6  # of the distance of the best descriptor to that of the second best
ROW_LIMIT_PX = 20.0  # what lies farther apart is taken for a false match
CASES = {
    "no turn": Turn(),
    "pitch 0.5": degrees(0.5, 0.0),
    "roll 0.5": degrees(0.0, 0.5),
    "both 0.5": degrees(-0.5, 0.5),
    "pitch 3": degrees(3.0, 0.0),
}


@dataclass(frozen=True)
class Recording:
    group: str
    name: str
    calibration: RawCalibration
    pairs: turned.Pairs  # raw


def recording(group: str, place: Path) -> Recording:
    sequence = open_sequence(place)
    last = len(sequence.frames) - 1

    @cache
    def pair(index: int) -> tuple[Grey, Grey]:
        frame = sequence.read(sequence.frames[index])
        return frame.left, frame.right

    def played(k: int) -> tuple[Grey, Grey]:
        return pair(last - abs(last - k % (2 * last)))

    return Recording(group, place.name, sequence.calibration, played)


@dataclass(frozen=True)
class Measured:
    rows_px: np.ndarray  # of SIFT features, without the sign
    alignment: Alignment
    applied: Turn


def sift_rows_px(left: Grey, right: Grey) -> np.ndarray:
    """How far apart in rows features lie that have a disparity from 0 to a fifth of the width."""
    sift, matcher = cv2.SIFT.create(FEATURES), cv2.BFMatcher()
    points, words = zip(*(sift.detectAndCompute(image, None) for image in (left, right)), strict=True)
    pairs = matcher.knnMatch(words[0], words[1], k=2)
    best = [pair[0] for pair in pairs if len(pair) == 2 and pair[0].distance < RATIO * pair[1].distance]
    shifts = np.array([np.subtract(points[0][m.queryIdx].pt, points[1][m.trainIdx].pt) for m in best])
    disparity_px, rows_px = shifts.reshape(-1, 2).T
    plausible = (disparity_px > -2.0) & (disparity_px < left.shape[1] / 5) & (np.abs(rows_px) < ROW_LIMIT_PX)
    return np.abs(rows_px[plausible])


def fly(one: Recording, turn: Turn) -> dict[int, Measured]:
    """The frames that are looked at, counted from the turn on."""
    rectifier = Rectifier(one.calibration)
    at = turned_places(rectifier, turn)

    def pairs(k: int) -> tuple[Grey, Grey]:
        left, right = one.pairs(k)
        return left, sampled(right, at) if k >= BEFORE and turn != Turn() else right

    return {
        k - BEFORE: Measured(sift_rows_px(now.frame.left, now.frame.right), now.alignment, now.applied)
        for k, now in enumerate(turned.flown(rectifier, pairs, BEFORE + AFTER))
        if k - BEFORE in LOOKED_AT
    }


def uncorrected_rows_px(one: Recording) -> np.ndarray:
    """Rows of the last frame that is looked at, without any turn."""
    frame = Rectifier(one.calibration).rectify(Frame(0, 0, *one.pairs(BEFORE + LOOKED_AT[-1]), None))
    return sift_rows_px(frame.left, frame.right)


def cost_ms(recordings: list[Recording]) -> dict[str, float]:
    """Least time of a pair that changes nothing, of one recording of each group: what else the machine does
    only adds to it."""
    found = {}
    for one in reversed(recordings):
        rectifier, times_ms = Rectifier(one.calibration), []
        corrector, camera = turned.Corrector(rectifier), rectifier.calibration
        for k in range(100):
            corrector.update(*one.pairs(k), turned.time_ns(k))
            times_ms.append(corrector.detector.times_ms[2])
        found[f"{one.group}, {camera.width}x{camera.height}"] = round(min(times_ms[10:]), 2)
    return found


def map_ms(recordings: list[Recording]) -> dict[str, float]:
    """Least time of a whole map of the right camera, with its own lens and with a fisheye lens."""
    found = {}
    for one in reversed(recordings):
        own = one.calibration
        lenses = [replace(camera, lens="fisheye", distortion=FISHEYE) for camera in (own.left, own.right)]
        fisheye = replace(own, left=lenses[0], right=lenses[1])
        for name, calibration in ((one.group, own), (f"{one.group}, fisheye", fisheye)):
            rectifier, times_ms = Rectifier(calibration), []
            for _ in range(15):
                start_s = time.perf_counter()
                turned.turned_map(rectifier, CASES["both 0.5"])
                times_ms.append(1e3 * (time.perf_counter() - start_s))
            found[name] = round(min(times_ms), 2)
    return found


def percentiles(of_recordings: list[np.ndarray], least: int = 100) -> list[float] | None:
    """Median and 90th, of so many features at least."""
    rows_px = np.concatenate(of_recordings)
    if len(rows_px) < least:
        return None
    return [round(float(value), 3) for value in np.percentile(rows_px, [50, 90])]


def short_of_aim_px(recordings: list[Recording], measured: list[Measured]) -> dict[str, float | None]:
    """Median row errors of the recordings that have more than the aim; None: too few features."""
    medians_px = {
        one.name: percentiles([of_it.rows_px], 20) for one, of_it in zip(recordings, measured, strict=True)
    }
    return {
        name: None if px is None else px[0] for name, px in medians_px.items() if px is None or px[0] > AIM_PX
    }


def measure(recordings: list[Recording]) -> list[dict[str, Any]]:
    """A row for each group and case."""
    rows = []
    for group in dict.fromkeys(one.group for one in recordings):
        of_group = [one for one in recordings if one.group == group]
        for case, turn in CASES.items():
            runs = [fly(one, turn) for one in of_group]
            series = {k: percentiles([run[k].rows_px for run in runs]) for k in runs[0]}
            at_end = [run[max(run)] for run in runs]
            row = {
                "group": group,
                "recordings": len(runs),
                "case": case,
                "rows_px": {f"{t:g}": series[int(t * turned.RATE_HZ)] for t in TIMES_S},
                "series": series,
                "short_px": short_of_aim_px(of_group, at_end),
                "alarms": sum(one.alignment.health != "healthy" for one in at_end),
                "corrected": sum(one.applied != Turn() for one in at_end),
            }
            if case == "no turn":
                row["rows_uncorrected_px"] = percentiles([uncorrected_rows_px(one) for one in of_group])
            rows.append(row)
            print(group, case, row["rows_px"], row["short_px"], "alarms", row["alarms"], flush=True)
    return rows


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """The median row error over time, a panel for each group."""
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from vista.report.plots import ACCENT, GOOD, MUTED, STYLE, WARNING

    colours = dict(zip(list(CASES)[1:4], (ACCENT, WARNING, GOOD), strict=True))
    groups: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        groups[row["group"]].append(row)
    with mpl.rc_context(STYLE):
        figure = Figure((3.2 * len(groups), 3.0), layout="constrained")
        for axes, (group, of_group) in zip(
            figure.subplots(1, len(groups), sharey=True, squeeze=False)[0], groups.items(), strict=True
        ):
            for row in of_group:
                if row["case"] in colours:
                    points = [
                        (k / turned.RATE_HZ, px[0]) for k, px in row["series"].items() if px is not None
                    ]
                    axes.plot(
                        *zip(*points, strict=True), ".-", color=colours[row["case"]], label=row["case"] + "°"
                    )
            axes.axhline(AIM_PX, color=MUTED, linestyle="--", linewidth=1.0)
            axes.set(title=group, xlabel="time after the turn (s)", yscale="log", ylim=(0.05, 20.0))
        figure.axes[0].set_ylabel("row error, median (px)")
        figure.axes[0].legend(frameon=False)
        figure.savefig(path, dpi=110)


def table_of(rows: list[dict[str, Any]]) -> Table:
    """Rows over time after a turn: median and 90th percentile; and how many recordings reach the aim."""
    times = list(rows[0]["rows_px"])

    def rows_of(px: list[float] | None) -> str:
        return "" if px is None else f"{px[0]:.2f}, {px[1]:.2f}"

    def reached(row: dict[str, Any]) -> str:
        if row["rows_px"][times[-1]] is None:
            return ""
        return f"{row['recordings'] - len(row['short_px'])} of {row['recordings']}"

    cells = [
        (
            f"{row['group']} ({row['recordings']})",
            row["case"],
            *(rows_of(row["rows_px"][time]) for time in times),
            reached(row),
            f"{row['alarms']} of {row['recordings']}",
        )
        for row in rows
    ]
    after = (f"{time} s (px)" for time in times)
    heads = ("recordings", "turn (degrees)", *after, f"{AIM_PX:g} px at {times[-1]} s", "alarms")
    return Table("alignment", heads, cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("flights", type=Path, nargs="*")
    parser.add_argument("--figure", type=Path)
    options = parser.parse_intermixed_args()
    recordings = [recording(name, place) for name, (place, _) in REAL.items() if place.is_dir()]
    recordings += [recording("rendered flights", flight) for flight in options.flights]
    rows, cost = measure(recordings), cost_ms(recordings)
    if options.figure:
        draw(rows, options.figure)
    for row in rows:
        del row["series"]
    found = {"rows": rows, "cost_ms": cost, "map_ms": map_ms(recordings)}
    write_measurement(options.out, [table_of(rows)], found)


if __name__ == "__main__":
    main()
