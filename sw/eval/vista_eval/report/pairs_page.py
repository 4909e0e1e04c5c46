"""Measures of real pairs -> tables, JSON, and one page that shows the worst."""

from __future__ import annotations

import base64
from dataclasses import asdict
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from vista import parameters
from vista.report.overlay import draw_disparity
from vista.report.page import fill_template
from vista.report.palette import INK, WHITE

from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.dataset.truth import SPLITS
from vista_eval.detectors import OURS
from vista_eval.measured_pairs import DENSE, MeasuredPair
from vista_eval.metrics import standing_points as standing
from vista_eval.metrics.standing_points import MEASURES, Counts, Judged, Points, Share, fates, shares
from vista_eval.report.table import Table, with_interval

ROAD_ONLY = ("road", "cylinder")  # measures of scenes with a road
TITLES = {
    "lidar": "street pairs with LiDAR: what stands, and what becomes of it",
    "dense": "indoor pairs with dense truth: what is seen, and what becomes of it",
}
FACTS = {
    "lidar": "Standing points: LiDAR pixels 0.5 m or more above the road, 5 to 45 m away.",
    "dense": "No road and no scale: every measured pixel counts as standing. Distances: nearer and farther "
    "than the median disparity of the scene.",
}


def measures_of(kind: str) -> dict[str, tuple[str, str]]:
    return {name: both for name, both in MEASURES.items() if kind != DENSE or name not in ROAD_ONLY}


def by_half(measured: list[MeasuredPair]) -> dict[str, list[dict[str, Counts]]]:
    """Counts by detector of the pairs that could be measured; halves without any are left out."""
    halves = {s: [m.counts for m in measured if m.split == s and m.counts is not None] for s in SPLITS}
    return {split: counts for split, counts in halves.items() if counts}


Cells = tuple[str, ...]


def tables(kind: str, measured: list[MeasuredPair]) -> list[tuple[str, list[Cells]]]:
    """(title, rows), the first row the heading."""
    result = []
    for split, half in by_half(measured).items():
        measures = measures_of(kind)
        whole = measures | standing.TOO_NEAR
        ours = [counts[OURS] for counts in half]
        points = sum(counts["standing"] for counts in ours)
        rows: list[Cells] = [("", *whole)]
        for name in half[0]:
            found = shares([counts[name] for counts in half], whole)
            rows.append((name, *(written(found[key]) for key in whole)))
        result.append((f"{split}: {len(half)} pairs, {points} standing points", rows))
        rows = [(f"{OURS}, by distance", *measures)]
        for band in bands(ours):
            found = shares(ours, standing.in_band(measures, band))
            rows.append((band, *(written(found[key]) for key in measures)))
        result.append((f"{split}: by distance", rows))
        names = bands(ours)
        rows = [("standing points by verdict", "all", *names)]
        verdicts = standing.verdict_measures(ours)
        columns = [shares(ours, standing.in_band(verdicts, band)) for band in (None, *names)]
        for verdict in verdicts:
            rows.append((verdict.lower().replace("_", " "), *(written(c[verdict]) for c in columns)))
        result.append((f"{split}: by verdict", rows))
    return result


def bands(pairs: list[Counts]) -> list[str]:
    return [name.partition(" | ")[2] for name in pairs[0] if name.startswith("standing | ")]


def written(share: Share) -> str:
    if not np.isfinite(share.value):
        return ""
    return f"{share.value:.3f} ({share.low:.3f} .. {share.high:.3f})"


def lines(tables: list[tuple[str, list[Cells]]]) -> list[str]:
    """Markdown."""
    result = []
    for title, rows in tables:
        result += [
            f"**{title}**",
            "",
            "| " + " | ".join(rows[0]) + " |",
            "|---|" + "---|" * (len(rows[0]) - 1),
        ]
        result += ["| " + " | ".join(row) + " |" for row in rows[1:]] + [""]
    return result


def as_json(kind: str, measured: list[MeasuredPair], values: parameters.Values) -> dict[str, Any]:
    measures = measures_of(kind)
    halves: dict[str, Any] = {}
    for split, half in by_half(measured).items():
        halves[split] = {"pairs": len(half), "detectors": {}}
        for name in half[0]:
            counts = [of_pair[name] for of_pair in half]
            verdicts = standing.verdict_measures(counts)
            halves[split]["detectors"][name] = {
                "measures": found(counts, measures | standing.TOO_NEAR),
                "verdicts": found(counts, verdicts),
                "by_distance": {
                    band: {
                        "measures": found(counts, standing.in_band(measures, band)),
                        "verdicts": found(counts, standing.in_band(verdicts, band)),
                    }
                    for band in bands(counts)
                },
            }
    return {
        "version": 1,
        "kind": kind,
        "halves": halves,
        "without_road": [m.name for m in measured if m.counts is None],
        "pairs": [{"name": m.name, "split": m.split, "counts": m.counts} for m in measured],
        "parameters": values,
    }


def stated(halves: dict[str, Any]) -> Table:
    """What the documentation has of pairs with LiDAR."""
    keys = (*MEASURES, *standing.TOO_NEAR)
    rows = [
        (f"{half}, {one['pairs']} pairs", name, *(with_interval(of["measures"][key]) for key in keys))
        for half, one in halves.items()
        for name, of in one["detectors"].items()
    ]
    return Table("lidar", ("half", "detector", *keys), rows)


def front_page(half: dict[str, Any]) -> tuple[str, str]:
    share = {key: one["value"] for key, one in half["detectors"][OURS]["measures"].items()}
    return f"{half['pairs']} real street pairs with LiDAR that nothing was chosen on", (
        f"{share['recall']:.0%} of the points that stand are found, {share['cylinder']:.0%} of those within "
        f"2 m of the optical axis; {share['road']:.1%} of the road's points are taken for obstacles"
    )


def compact(halves: dict[str, Any]) -> dict[str, Any]:
    """Leaves out the distances."""
    return {
        half: {
            "pairs": one["pairs"],
            "detectors": {
                name: {key: of[key] for key in ("measures", "verdicts")}
                for name, of in one["detectors"].items()
            },
        }
        for half, one in halves.items()
    }


def found(counts: list[Counts], wanted: dict[str, tuple[str, str]]) -> dict[str, dict[str, float | None]]:
    return {
        name: {key: round(v, 4) if np.isfinite(v) else None for key, v in asdict(share).items()}
        for name, share in shares(counts, wanted).items()
    }


# ---- pictures ----

Picture = NDArray[np.uint8]
SHOWN, LEAST_POINTS = 8, 500
COLOURS = {  # BGR, of the standing points by what becomes of them
    "ACCEPTED": (80, 230, 60),
    "UNKNOWN": (255, 120, 40),
    "INCONSISTENT": (60, 60, 255),
    "HORIZONTAL": (255, 60, 220),
}
OTHER, AT_ANOTHER_DEPTH, ROAD_HIT = (200, 200, 200), (0, 255, 255), (128, 0, 255)


def worst(measured: list[MeasuredPair]) -> list[MeasuredPair]:
    """Pairs with enough to find, by recall."""
    scored = [m for m in measured if m.counts is not None and m.counts[OURS]["standing"] >= LEAST_POINTS]
    return sorted(scored, key=recall_of)[:SHOWN]


def recall_of(measured: MeasuredPair) -> float:
    assert measured.counts is not None
    counts = measured.counts[OURS]
    return counts["recalled"] / counts["standing"]


def draw_pair(pair: TruthPair, points: Points, judged: Judged, num_disparities: int) -> Picture:
    """Draws above the points by their fate, and below the regions, accepted ones tinted, and the
    disparities."""
    fate = fates(points, judged)
    picture = cv2.cvtColor(pair.left, cv2.COLOR_GRAY2BGR) // 2
    colour = np.array([COLOURS.get(v, OTHER) for v in fate.verdict], np.uint8).reshape(-1, 3)
    colour[fate.accepted & ~fate.recalled] = AT_ANOTHER_DEPTH
    chosen = points.standing
    picture[points.v[chosen], points.u[chosen]] = colour[chosen]
    hit = points.road & fate.accepted
    picture[points.v[hit], points.u[hit]] = ROAD_HIT
    return np.vstack([picture, draw_verdicts(pair, judged), draw_disparity(judged.words, num_disparities)])


def draw_verdicts(pair: TruthPair, judged: Judged) -> Picture:
    colours = np.array([*(COLOURS.get(v, OTHER) for v in judged.verdict_of_region), INK], np.uint8)
    label = judged.region_of_pixel
    picture = (cv2.cvtColor(pair.left, cv2.COLOR_GRAY2BGR) // 2 + colours[label] // 3).astype(np.uint8)
    border = np.zeros(label.shape, np.bool_)
    border[:, 1:] |= label[:, 1:] != label[:, :-1]
    border[1:] |= label[1:] != label[:-1]
    picture[border] = WHITE
    return picture


def legend() -> list[dict[str, str]]:
    entries = {
        "accepted, at the depth of its region": COLOURS["ACCEPTED"],
        "accepted, at another depth": AT_ANOTHER_DEPTH,
    }
    entries |= {n.lower().replace("_", " "): c for n, c in COLOURS.items() if n != "ACCEPTED"}
    entries |= {"any other verdict": OTHER, "road inside an accepted region": ROAD_HIT}
    return [{"name": name, "colour": f"rgb({r}, {g}, {b})"} for name, (b, g, r) in entries.items()]


def encode(title: str, text: str, picture: Picture) -> dict[str, str]:
    done, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 75])
    assert done
    uri = "data:image/jpeg;base64," + base64.b64encode(jpeg.tobytes()).decode()
    return {"title": title, "text": text, "uri": uri}


def caption(measured: MeasuredPair) -> str:
    assert measured.counts is not None
    counts = measured.counts[OURS]
    verdicts = {v: counts[f"verdict {v}"] / counts["standing"] for v in standing.verdict_names([counts])}
    parts = ", ".join(f"{v.lower().replace('_', ' ')} {share:.0%}" for v, share in verdicts.items())
    return f"{counts['standing']} standing points: {parts}"


def render_page(
    kind: str,
    measured: list[MeasuredPair],
    written_tables: list[tuple[str, list[Cells]]],
    pictures: list[dict[str, str]],
) -> str:
    return fill_template(
        "pairs.html.j2",
        package="vista_eval.report",
        pairs=len(measured),
        title=TITLES[kind],
        facts=FACTS[kind],
        tables=[{"title": title, "heading": rows[0], "rows": rows[1:]} for title, rows in written_tables],
        legend=legend(),
        pictures=pictures,
        without_road=[m.name for m in measured if m.counts is None],
        definitions=(standing.__doc__ or "").strip(),
    )
