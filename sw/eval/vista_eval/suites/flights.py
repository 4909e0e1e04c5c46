"""The paper's flights: the detector, also under noise, its segmentation, and stereo alone beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from vista import parameters

import vista_eval.metrics
from vista_eval.baselines.stereo_alone import Outcome, outcomes_cached
from vista_eval.dataset.truth import SPLITS, read_truth
from vista_eval.fly import UNDISTURBED, Disturbance, fly_cached, records_name
from vista_eval.jobs import Job
from vista_eval.metrics import comparison as beside
from vista_eval.metrics.comparison import Comparison, compare
from vista_eval.metrics.flight_score import FlightScore, score_records, summary
from vista_eval.metrics.flight_segmentation import FlightSegmentation, rows, segment_cached
from vista_eval.metrics.flight_segmentation import table as segmentation_table
from vista_eval.metrics.free_path import table as free_table
from vista_eval.metrics.free_path import together
from vista_eval.metrics.group import group_score, table
from vista_eval.pose_noise import ATTITUDE_SIGMA_DEG, POSITION_SIGMA_M
from vista_eval.report.filmstrip import filmstrip
from vista_eval.report.flight_plots import plot_comparison, plot_detection, plot_error
from vista_eval.report.page import Page, Section
from vista_eval.report.table import rounded
from vista_eval.score import Scoring
from vista_eval.suites.flight_tables import stated

FACTS = (
    "scored against their exact truth. Parameters are chosen on the flights of the group dev; what counts is "
    "the "
    "group test. One fixed set of parameters for all. In the pictures: yellow a tracked obstacle, red one on "
    "the "
    "collision course, in a thin white box the target's pixels; a red frame: missed, or a false alarm."
)
Work = Callable[[Path], Any]


@dataclass(frozen=True)
class Flights:
    folders: list[Path]
    pose_noise: bool = False
    noise_grey: tuple[float, ...] = ()
    seed: int = 1  # of all noise
    baseline: bool = True  # stereo alone
    anew: bool = False  # fly again what is kept
    name: str = "flights"
    page_name: str = "report.html"

    def works(self, values: parameters.Values) -> dict[str, Work]:
        """What is made of every flight, by title."""
        flown = partial(fly_and_score, values, anew=self.anew)
        works: dict[str, Work] = {"fly": partial(flown, UNDISTURBED)}
        if self.pose_noise:
            works["pose noise"] = partial(flown, Disturbance(poses=True, seed=self.seed))
        for grey in self.noise_grey:
            disturbance = Disturbance(image_grey=grey, seed=self.seed)
            works[f"sensor noise {grey:g}"] = partial(flown, disturbance)
        if self.baseline:
            works["stereo alone"] = partial(stereo_alone, values)
        return works | {"segmentation": partial(segment, values)}

    def jobs(self, values: parameters.Values) -> list[Job]:
        return [
            Job(f"{folder.name}, {title}", partial(work, folder))
            for title, work in self.works(values).items()
            for folder in self.folders
        ]

    def scoring(self, results: list[Any], values: parameters.Values) -> Scoring:
        following = iter(results)
        found = {title: [next(following) for _ in self.folders] for title in self.works(values)}
        scores: list[FlightScore] = found["fly"]
        noisy: list[FlightScore] = found.get("pose noise", [])
        sensed = {grey: found[f"sensor noise {grey:g}"] for grey in self.noise_grey}
        segmented: list[FlightSegmentation] = found["segmentation"]
        alone: list[list[Outcome]] = found.get("stereo alone", [])
        comparison = compare(scores, alone) if alone else None
        tables = [table(scores)]
        if noisy:
            error = f"{POSITION_SIGMA_M:g} m, {ATTITUDE_SIGMA_DEG:g} degrees"
            tables.append(table(noisy, f"With poses as of a navigation filter: {error}, drifting", ""))
        tables += [
            table(found, f"With sensor noise of {grey:g} grey levels", "") for grey, found in sensed.items()
        ]
        shown = [*tables, *([beside.table(comparison)] if comparison else [])]
        free = [(score.name, score.free) for score in scores]
        free.append(("all", together(score.free for score in scores)))
        shown += [free_table("flight", free), segmentation_table(segmented)]
        plots = [Section("Where targets are warned of", plots=[plot_detection(scores)])]
        if comparison is not None:
            plots.append(Section("Missed frames against false alarms", plots=[plot_comparison(comparison)]))
        sections = [Section(one.title, [one]) for one in shown]
        flights = [flight_section(*flight, values) for flight in zip(self.folders, scores, strict=True)]
        return Scoring(
            shown,
            Page(
                "Flights",
                f"{len(scores)} flights, {FACTS}",
                [*sections, *plots, *flights],
                vista_eval.metrics.__doc__ or "",
                values,
            ),
            content(scores, noisy, sensed, segmented, comparison, values),
            stated(scores, sensed),
            rounded(
                {
                    "groups": groups(scores),
                    "pose_noise": groups(noisy),
                    "sensor_noise": noise(scores, sensed),
                },
                2,
            ),
        )


def flight_section(folder: Path, score: FlightScore, values: parameters.Values) -> Section:
    records = fly_cached(folder, values, folder / records_name())
    truth = read_truth(folder)
    return Section(
        f"{score.name} · {score.title} ({score.split})",
        plots=[plot_error((score, truth.focal_baseline_px_m))],
        pictures=filmstrip(truth, score, records),
        anchor=score.name,
    )


def fly_and_score(
    values: parameters.Values, disturbance: Disturbance, folder: Path, anew: bool = False
) -> FlightScore:
    records = fly_cached(folder, values, folder / records_name(disturbance), disturbance, anew)
    return score_records(folder, records, values)


def segment(values: parameters.Values, folder: Path) -> FlightSegmentation:
    return segment_cached(folder, values, folder / "segmentation.json")


def stereo_alone(values: parameters.Values, folder: Path) -> list[Outcome]:
    return outcomes_cached(folder, values, folder / "stereo_alone.json")


def content(
    scores: list[FlightScore],
    noisy: list[FlightScore],
    sensed: dict[float, list[FlightScore]],
    segmented: list[FlightSegmentation],
    comparison: Comparison | None,
    values: parameters.Values,
) -> dict[str, Any]:
    return {
        "parameters": values,
        "flights": [summary(score) for score in scores],
        "groups": groups(scores),
        "segmentation": [asdict(row) for row in rows(segmented) if row.things],
        "stereo_alone": comparison and asdict(comparison),
        "pose_noise": {"flights": [summary(score) for score in noisy], "groups": groups(noisy)},
        "sensor_noise": [
            {"grey_levels": grey, "flights": [summary(score) for score in scored], "groups": groups(scored)}
            for grey, scored in sensed.items()
        ],
    }


def noise(scores: list[FlightScore], sensed: dict[float, list[FlightScore]]) -> list[dict[str, Any]]:
    return [
        {"grey_levels": grey, "groups": groups(scored)} for grey, scored in {0.0: scores, **sensed}.items()
    ]


def groups(scores: list[FlightScore]) -> list[dict[str, Any]]:
    members = {split: [score for score in scores if score.split == split] for split in SPLITS}
    found = [group_score(split, flights) for split, flights in members.items() if flights]
    return [asdict(group) | {"hit_rate": group.hit_rate} for group in found]
