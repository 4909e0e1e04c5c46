"""Real pairs with measured truth through every detector: `vista scenes --lidar`."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray
from vista import parameters
from vista.chain import engine_parameters
from vista.errors import InputError
from vista.geometry import Calibration
from vista.report.overlay import draw_disparity
from vista.report.palette import INK, WHITE

from vista_eval.dataset.kitti_stereo import PairFiles, find_pairs, read_pair
from vista_eval.dataset.stereo_pair import TruthPair
from vista_eval.dataset.truth import SPLITS
from vista_eval.jobs import Job, jobs_of
from vista_eval.metrics import free_directions
from vista_eval.metrics import standing_points as standing
from vista_eval.metrics.free_directions import NO_DIRECTIONS, FreeDirections
from vista_eval.metrics.segmentation import matched_area
from vista_eval.metrics.standing_points import (
    MEASURES,
    Counts,
    Judged,
    Points,
    Share,
    count_points,
    fates,
    shares,
    street_points,
)
from vista_eval.report.page import Page, Picture, Section, as_jpeg
from vista_eval.report.table import Table, with_interval
from vista_eval.rivals import DETECTOR, OF_PAIRS, OURS, RIVALS, OneCamera
from vista_eval.score import Scoring


@dataclass(frozen=True)
class MeasuredPair:
    name: str
    split: str
    counts: dict[str, Counts] | None  # by detector; None: no road was found
    directions: FreeDirections = NO_DIRECTIONS


def points_of(pair: TruthPair) -> Points | None:
    """Those that the shipped engine can match, whatever is measured."""
    stereo = engine_parameters(parameters.defaults())
    height, width = pair.left.shape
    area = matched_area(height, width, stereo.num_disparities, stereo.block_size)
    largest_px = stereo.num_disparities - 1.0
    return street_points(pair.camera, pair.disparity_px, area, largest_px)


def measure(values: parameters.Values, source: PairFiles) -> MeasuredPair:
    pair = read_pair(source)
    points = points_of(pair)
    if points is None:
        return MeasuredPair(source.name, source.split, None)
    camera = camera_of(pair, values)
    counts = {name: count_points(points, RIVALS[name].judge(camera, pair)) for name in OF_PAIRS}
    return MeasuredPair(source.name, source.split, counts, directions_of(pair, camera))


def directions_of(pair: TruthPair, camera: OneCamera) -> FreeDirections:
    stands = standing.standing_pixels(pair.camera, pair.disparity_px)
    told = DETECTOR.process(camera, pair).directions
    assert stands is not None and told is not None
    stereo = engine_parameters(camera.values)
    height, width = pair.left.shape
    area = matched_area(height, width, stereo.num_disparities, stereo.block_size)
    return free_directions.free_directions(told, pair.camera, pair.disparity_px, area, stands)


def look(values: parameters.Values, source: PairFiles, detector: str) -> tuple[TruthPair, Points, Judged]:
    """One pair once more, for its picture."""
    pair = read_pair(source)
    points = points_of(pair)
    assert points is not None
    return pair, points, RIVALS[detector].judge(camera_of(pair, values), pair)


def camera_of(pair: TruthPair, values: parameters.Values) -> OneCamera:
    try:
        return _of_camera(pair.camera, _Same(values))
    except ValueError as error:
        raise InputError(pair.name, str(error)) from None


class _Same:
    """Parameters as a key: equal if all values are."""

    def __init__(self, values: parameters.Values) -> None:
        self.values = values

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.values == other.values

    def __hash__(self) -> int:
        return 0


@lru_cache(maxsize=8)  # KITTI has images of five sizes
def _of_camera(camera: Calibration, same: _Same) -> OneCamera:
    return OneCamera(camera, same.values)


# ---- all pairs ----

TITLE = "street pairs with LiDAR: what stands, and what becomes of it"
HALVES = (
    "Pairs in even places of the sorted names are the group dev, on which parameters may be chosen; those in "
    "odd "
    "places are the group test. In brackets: 95 % of a bootstrap over pairs."
)
FACTS = "Standing points: LiDAR pixels 0.5 m or more above the road, 5 to 45 m away."


@dataclass(frozen=True)
class Pairs:
    folder: Path
    name: str = "lidar"
    page_name: str = "lidar.html"

    def jobs(self, values: parameters.Values) -> list[Job]:
        return jobs_of(partial(measure, values), find_pairs(self.folder), lambda source: source.name)

    def scoring(self, results: list[MeasuredPair], values: parameters.Values) -> Scoring:
        if not any(one.counts is not None for one in results):
            raise InputError(self.folder, "no pair shows a road")
        shown, content = tables(results), as_json(results, values)
        shown.append(directions_table(results, "directions"))
        halves = content["halves"]
        without = [one.name for one in results if one.counts is None]
        sections = [Section(table.title, [replace(table, title="")]) for table in shown]
        if without:
            sections.insert(0, Section("Not measured", text=f"No road was found in {', '.join(without)}."))
        return Scoring(
            shown,
            Page(
                f"{len(results)} {TITLE}",
                f"{FACTS} {HALVES}",
                [*sections, self._worst(results, values)],
                (standing.__doc__ or "").strip(),
                values,
                wide=True,
            ),
            content,
            [documented(halves), directions_table(results, "lidar-directions")],
            {"halves": compact(halves)},
            front_page(halves["test"]) if "test" in halves else None,
        )

    def _worst(self, results: list[MeasuredPair], values: parameters.Values) -> Section:
        sources, pictures = {one.name: one for one in find_pairs(self.folder)}, []
        for one in worst(results):
            pair, points, judged = look(values, sources[one.name], OURS)
            drawn = draw_pair(pair, points, judged, values["stereo"]["num_disparities"])
            title = f"{one.name} ({one.split}): recall {recall_of(one):.2f}; {caption(one)}"
            pictures.append(Picture(title, as_jpeg(drawn)))
        text = (
            "Top: standing points by what becomes of them; middle: the regions by their verdict; bottom: the "
            "disparities. "
        )
        return Section("The worst pairs", text=Markup.escape(text) + legend(), pictures=pictures)


def by_half(measured: list[MeasuredPair]) -> dict[str, list[dict[str, Counts]]]:
    """Counts by detector of the pairs that could be measured; halves without any are left out."""
    halves = {s: [m.counts for m in measured if m.split == s and m.counts is not None] for s in SPLITS}
    return {split: counts for split, counts in halves.items() if counts}


def tables(measured: list[MeasuredPair]) -> list[Table]:
    """Three of each half: by detector, by distance, by verdict."""
    result = []
    for split, half in by_half(measured).items():
        whole = MEASURES | standing.TOO_NEAR
        ours = [counts[OURS] for counts in half]
        points = sum(counts["standing"] for counts in ours)
        rows: list[tuple[str, ...]] = []
        for name in half[0]:
            found = shares([counts[name] for counts in half], whole)
            rows.append((name, *(written(found[key]) for key in whole)))
        title = f"{split}: {len(half)} pairs, {points} standing points"
        result.append(Table("detectors", ("", *whole), rows, title=title))
        rows = []
        for band in bands(ours):
            found = shares(ours, standing.in_band(MEASURES, band))
            rows.append((band, *(written(found[key]) for key in MEASURES)))
        result.append(Table("distances", (OURS, *MEASURES), rows, title=f"{split}: by distance"))
        names, rows = bands(ours), []
        verdicts = standing.verdict_measures(ours)
        columns = [shares(ours, standing.in_band(verdicts, band)) for band in (None, *names)]
        for verdict in verdicts:
            rows.append((verdict.lower().replace("_", " "), *(written(c[verdict]) for c in columns)))
        heads = ("standing points", "all", *names)
        result.append(Table("verdicts", heads, rows, title=f"{split}: by verdict"))
    return result


def bands(pairs: list[Counts]) -> list[str]:
    return [name.partition(" | ")[2] for name in pairs[0] if name.startswith("standing | ")]


def written(share: Share) -> str:
    if not np.isfinite(share.value):
        return ""
    return f"{share.value:.3f} ({share.low:.3f} .. {share.high:.3f})"


def as_json(measured: list[MeasuredPair], values: parameters.Values) -> dict[str, Any]:
    halves: dict[str, Any] = {}
    for split, half in by_half(measured).items():
        halves[split] = {"pairs": len(half), "detectors": {}}
        for name in half[0]:
            counts = [of_pair[name] for of_pair in half]
            verdicts = standing.verdict_measures(counts)
            halves[split]["detectors"][name] = {
                "measures": found(counts, MEASURES | standing.TOO_NEAR),
                "verdicts": found(counts, verdicts),
                "by_distance": {
                    band: {
                        "measures": found(counts, standing.in_band(MEASURES, band)),
                        "verdicts": found(counts, standing.in_band(verdicts, band)),
                    }
                    for band in bands(counts)
                },
            }
    return {
        "version": 1,
        "halves": halves,
        "without_road": [m.name for m in measured if m.counts is None],
        "pairs": [{"name": m.name, "split": m.split, "counts": m.counts} for m in measured],
        "parameters": values,
    }


def directions_table(measured: list[MeasuredPair], name: str) -> Table:
    rows = []
    for split in SPLITS:
        half = [one.directions for one in measured if one.split == split and one.counts is not None]
        if half:
            rows.append((f"{split}, {len(half)} pairs", free_directions.together(half)))
    return replace(free_directions.table("half", rows), name=name)


def documented(halves: dict[str, Any]) -> Table:
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

Pixels = NDArray[np.uint8]
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


def draw_pair(pair: TruthPair, points: Points, judged: Judged, num_disparities: int) -> Pixels:
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


def draw_verdicts(pair: TruthPair, judged: Judged) -> Pixels:
    colours = np.array([*(COLOURS.get(v, OTHER) for v in judged.verdict_of_region), INK], np.uint8)
    label = judged.region_of_pixel
    picture = (cv2.cvtColor(pair.left, cv2.COLOR_GRAY2BGR) // 2 + colours[label] // 3).astype(np.uint8)
    border = np.zeros(label.shape, np.bool_)
    border[:, 1:] |= label[:, 1:] != label[:, :-1]
    border[1:] |= label[1:] != label[:-1]
    picture[border] = WHITE
    return picture


def legend() -> Markup:
    entries = {
        "accepted, at the depth of its region": COLOURS["ACCEPTED"],
        "accepted, at another depth": AT_ANOTHER_DEPTH,
    }
    entries |= {n.lower().replace("_", " "): c for n, c in COLOURS.items() if n != "ACCEPTED"}
    entries |= {"any other verdict": OTHER, "road inside an accepted region": ROAD_HIT}
    swatch = Markup('<span class="swatch" style="background: rgb({2}, {1}, {0})"></span>{3}')
    return Markup("").join(swatch.format(*colour, name) for name, colour in entries.items())


def caption(measured: MeasuredPair) -> str:
    assert measured.counts is not None
    counts = measured.counts[OURS]
    verdicts = {v: counts[f"verdict {v}"] / counts["standing"] for v in standing.verdict_names([counts])}
    parts = ", ".join(f"{v.lower().replace('_', ' ')} {share:.0%}" for v, share in verdicts.items())
    return f"{counts['standing']} standing points: {parts}"
