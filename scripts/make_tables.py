"""Write the tables of the documentation from the measured figures that are committed as JSON.

usage: make_tables.py [--check]
       make_tables.py --save NAME=FILE.json ... --command COMMAND

Without options, every table between the marks `<!-- table: NAME -->` and `<!-- end of table -->` of a
Markdown file is written anew; --check changes nothing and fails when a table differs from its figures.
--save takes what a command has measured (for example host=build/bench/host.json), keeps what the
documentation states, adds commit, date and machine, and replaces doc/results/data/NAME.json. The tables
follow at once.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from pathlib import Path

from measured_figures import REDUCE, ROOT, STATISTICS, Record, figure_files, figures, file_of, save

sys.path.insert(0, str(ROOT / "rtl" / "flow"))
from nextpnr_report import sentence

MARKED = re.compile(r"(<!-- table: ([a-z-]+) -->\n).*?(<!-- end of table -->)", re.DOTALL)

WORKERS = 1000  # of a cluster that the costs of a job are reckoned up for


# ---- cells ----


def span(values: list[float] | None, unit: str = "") -> str:
    """The ends of a range; one number where there is only one."""
    if values is None:
        return ""
    ends = f"{values[0]:g}" if len(values) == 1 else f"{values[0]:g} to {values[1]:g}"
    return ends + unit


def fixed(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def spread(times: Record, digits: int, unit: str = "") -> str:
    """Median, with the 10th and 90th percentile where they are known."""
    text = f"{times['median']:.{digits}f}{unit}"
    return text + (f" ({times['p10']:.{digits}f} to {times['p90']:.{digits}f})" if "p10" in times else "")


def markdown(head: str, rows: list[list[str]]) -> str:
    """head: the columns' names, between ` | `."""
    lines = [f"| {head} |", "|---" * (head.count(" | ") + 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


# ---- tables ----


def engine_table() -> str:
    headline = figures("engine")["engine"]["headline"]
    rows = [
        [name, spread(times, 2), spread(headline["ratio"][name], 1)]
        for name, times in headline["ms"].items()
        if name != "opencv"
    ]
    return markdown(
        "instruction set | ms: median (10th to 90th percentile) | times as fast as StereoBM", rows
    )


def engine_sizes_table() -> str:
    engine = figures("engine")["engine"]
    isa, table = engine["isa"], engine["table"]
    disparities = sorted({row["num_disparities"] for row in table})
    cells: dict[str, list[str]] = {}
    for row in table:
        ms, ratio = row["ms"][isa]["median"], row["ratio"][isa]["median"]
        cells.setdefault(f"{row['width']}x{row['height']}", []).append(f"{ms:.3g} ({ratio:.1f})")
    head = [f"{isa}: ms (times as fast)", *(f"{count} disparities" for count in disparities)]
    return markdown(" | ".join(head), [[size, *values] for size, values in cells.items()])


def frontend_table() -> str:
    found = figures("frontend")["isas"]
    names = {"smooth": "smoothing; ratio to `GaussianBlur`", "reduce": "level 1; ratio to `pyrDown`"}
    names |= {name: name for name in found[0]["ms"] if "level" in name}

    def cell(one: Record, name: str) -> str:
        ratio = f"; {spread(one['ratio'][name], 2)}" if name in one["ratio"] else ""
        return f"{one['ms'][name]['median']:.2f}{ratio}"

    rows = [[text, *(cell(one, name) for one in found)] for name, text in names.items()]
    return markdown(" | ".join(["ms; ratio to one level", *(one["isa"] for one in found)]), rows)


def disparity_quality_table() -> str:
    def share(found: Record) -> str:
        return f"{found['value']:.3f} ({found['low']:.3f} to {found['high']:.3f})"

    rows = []
    for method, parts in figures("disparity-quality")["methods"].items():
        near = [fixed(parts["near"][key]["value"], 3) for key in ("density", "bad")]
        rows.append([method, share(parts["all"]["density"]), share(parts["all"]["bad"]), *near])
    return markdown("method | density | bad-3 | density of near pixels | bad-3 of these", rows)


def with_interval(share: Record) -> str:
    return f"{share['value']:.3f} ({share['low']:.3f} to {share['high']:.3f})"


POINT_MEASURES = ("recall", "on surface", "engine", "wrong", "road", "cylinder")


def lidar_table() -> str:
    rows = []
    for half, found in figures("lidar")["halves"].items():
        for detector, measures in found["detectors"].items():
            values = [with_interval(measures["measures"][key]) for key in (*POINT_MEASURES, "too near")]
            rows.append([f"{half}, {found['pairs']} pairs", detector, *values])
    return markdown(" | ".join(["half", "detector", *POINT_MEASURES, "too near"]), rows)


def evidence_table() -> str:
    variants = figures("evidence")["variants"].items()
    rows = [[name, *(fixed(found[key]["value"], 3) for key in POINT_MEASURES)] for name, found in variants]
    return markdown(" | ".join(["detector", *POINT_MEASURES]), rows)


SEQUENCES = {
    "street": "KITTI odometry 00, 1226x370",
    "street 640x480": "the middle of the same images, enlarged to 640x480",
    "oak-d": "OAK-D pairs, 640x480",
}


def host_table() -> str:
    rows = []
    for name, sequence in figures("host")["sequences"].items():
        by_threads = {"1": sequence["stages"]["host"], "2": sequence["two_threads"]["host"]}
        for threads, host in by_threads.items():
            rows.append(
                [
                    SEQUENCES.get(name, name),
                    str(sequence["frames"]),
                    f"{sequence['nodes']:,}",
                    threads,
                    f"{host['median_ms']:.1f} ({span([round(t, 1) for t in host['spread']['median_ms']])})",
                    f"{host['p99_over_median']:.1f}",
                    f"{host['median_hz']:.0f}",
                ]
            )
    head = (
        "images | frames | graph nodes | threads | ms: median (of the blocks) | 99th percentile / median | "
        "frames/s"
    )
    return markdown(head, rows)


def stages_table() -> str:
    sequences = {
        name: sequence["stages"]
        for name, sequence in figures("host")["sequences"].items()
        if "segmentation" in sequence["stages"]
    }
    names = [name for name in sequences["street"] if name not in ("host", "cpu")]
    rows = []
    for name in names:
        cells = [name]
        for stages in sequences.values():
            median_ms, p99_ms = stages[name]["median_ms"], stages[name].get("p99_ms")
            cells.append(f"{median_ms:.1f}" + (f" ({p99_ms:.1f})" if p99_ms is not None else ""))
            cells.append(f"{100 * median_ms / stages['host']['median_ms']:.0f} %")
        rows.append(cells)
    head = [f"{SEQUENCES.get(name, name)}: ms, median (p99) | share" for name in sequences]
    return markdown(" | ".join(["stage", *head]), rows)


def maxflow_table() -> str:
    found = figures("maxflow")
    rows = [
        [
            group["graphs"],
            span(group["vista_ms"]),
            span(group["ratio_flow"]),
            span(group["ratio_whole"]),
        ]
        for group in found["groups"]
    ]
    mean = found["geometric_mean"]
    rows.append(
        [
            f"geometric mean of {mean['rows']} graphs",
            "",
            f"{mean['ratio_flow']:g}",
            f"{mean['ratio_whole']:g}",
        ]
    )
    head = (
        "graphs | libvista: whole call, ms | PyMaxflow's `maxflow()` alone, times as long | PyMaxflow "
        "with construction, times as long"
    )
    return markdown(head, rows)


def street_table() -> str:
    keys = ("kept_of_12", "ghost_frames", "confirmed", "seen_frames_median", "host_ms")
    rows = [[row["variant"], *(f"{row[key]:g}" for key in keys)] for row in figures("street")["variants"]]
    head = (
        "variant | things that keep one id, of 12 | frames with an obstacle where the car drove | "
        "confirmed obstacles | frames that one is seen in, median | host ms"
    )
    return markdown(head, rows)


def statistic(key: str, value: float) -> str:
    return f"{value:.0f}" if key == "regions" else f"{value:.3f}"


def segmentation_table(split: str) -> str:
    rows = []
    for variant in figures("segmentation")["variants"]:
        values = [statistic(key, variant[split][key]) for key in STATISTICS]
        rows.append([variant["variant"], *values, fixed(variant["host_ms"], 1)])
    return markdown(" | ".join(["variant", *STATISTICS.values(), "host ms"]), rows)


def with_difference(found: Record, digits: int = 3) -> str:
    """A figure, and the ends of the interval of its difference to what is shipped."""
    text = f"{found['value']:.{digits}f}"
    if "low" not in found or (found["low"], found["high"]) == (0.0, 0.0):
        return text
    return f"{text} ({found['low']:+.{digits}f} to {found['high']:+.{digits}f})"


def roads_table(parts: dict[str, dict[str, int]]) -> str:
    """parts: of the figures, the columns and their digits."""
    rows = []
    for row in figures("segmentation-roads")["variants"]:
        cells = [
            with_difference(row[part][key], digits) if part in row else ""
            for part, keys in parts.items()
            for key, digits in keys.items()
        ]
        rows.append([row["variant"], *cells, fixed(row["host_ms"], 1)])
    names = [
        f"{part}: {STATISTICS.get(key, key)}" if part in ("scenes", "frames") else key
        for part, keys in parts.items()
        for key in keys
    ]
    return markdown(" | ".join(["road", *names, "host ms"]), rows)


ROADS_OF_PARTITIONS = {
    part: {"iou_median": 3, "iou_mean": 3, "boundary_recall": 3, "undersegmentation": 3}
    for part in ("scenes", "frames")
}
ROADS_OF_DETECTION = {
    "flights": {"hits": 2, "false": 0},
    "lidar": {"recall": 3, "wrong": 3, "road": 3, "cylinder": 3},
}


def scenes_table() -> str:
    rows = []
    for row in figures("scenes")["cut_minus_reference_95"]:
        rows.append(
            [row["reference"], *(span([round(end, 2) + 0.0 for end in row[key]]) for key in STATISTICS)]
        )
    return markdown(" | ".join(["cut minus", *STATISTICS.values()]), rows)


def flights_table(split: str) -> str:
    found = figures("flights")
    rows = []
    for flight in found["flights"]:
        if flight["split"] == split:
            hits = f"{flight['hits']}/{flight['band_frames']}" if "hits" in flight else ""
            rms = fixed(flight.get("rms_ft"), 1)
            rms += f" ({flight['companion_rms_ft']})" if "companion_rms_ft" in flight else ""
            rows.append(
                [
                    flight["title"],
                    fixed(flight.get("tracked_from_m"), 1),
                    fixed(flight.get("warned_from_m"), 1),
                    hits,
                    str(flight["false_alarm_frames"]),
                    fixed(flight.get("median_dz"), 2),
                    rms,
                    fixed(flight.get("error_at_50_ft"), 1),
                    nees(flight.get("nees")),
                ]
            )
    (group,) = (one for one in found["groups"] if one["split"] == split)
    rows.append(
        [
            f"**{group['flights']} flights, {group['frames']} frames**",
            "",
            "",
            f"**{group['hits']}/{group['band_frames']}**",
            f"**{group['false_alarm_frames']}**",
            f"**{group['median_dz']:.2f}**",
            "",
            "",
            nees(group["nees"]),
        ]
    )
    head = (
        "flight | tracked from, m | warned from, m | hits, 14.5 to 45 m | frames with a false alarm | "
        "median error, dz | RMS, ft (companion paper) | error at 50 ft, ft | NEES (95 % band)"
    )
    within = f"{100 * group['within_2dz']:.0f} % of the {group['matched_frames']} frames"
    return f"{markdown(head, rows)}\n\nThe position is within 2 dz in {within} with a warning of the target."


def flights_noise_table() -> str:
    rows = []
    for level in figures("flights")["sensor_noise"]:
        row = [f"{level['grey_levels']:.0f}"]
        for group in sorted(level["groups"], key=lambda found: found["split"], reverse=True):
            state = f"{group['degraded_frames']} + {group['unseeing_frames']} of {group['frames']}"
            row += [f"{group['hits']}/{group['band_frames']}", str(group["false_alarm_frames"]), state]
        rows.append(row)
    columns = [
        f"{split}: {what}" for split in ("test", "dev") for what in ("hits", "false", "degraded + blind")
    ]
    return markdown(" | ".join(["grey levels", *columns]), rows)


def nees(values: list[float] | None) -> str:
    return "" if values is None else f"{values[0]:.1f} ({values[1]:.1f} to {values[2]:.1f})"


def throughput_table() -> str:
    rows = []
    for system in figures("throughput")["systems"]:
        p99 = f" ({system['latency_p99_ms']})" if "latency_p99_ms" in system else ""
        needed, clock = system["needed_clock_mhz"], system["clock_mhz"]
        rows.append(
            [
                f"`{system['preset']}`",
                system["camera"],
                f"{system['disparities']} disparities, {clock:.1f} MHz",
                f"{system['dropped']} of {system['frames']}",
                f"{system['latency_p50_ms']}{p99}",
                f"{system['limit_hz']}, limited by the {system['limit_stage']}",
                f"{needed:.3g}, 1/{clock / needed:.1f} of the clock",
            ]
        )
    head = (
        "preset | camera | engine | frames dropped | first pixel to obstacle map, ms: median (99th "
        "percentile) | maximum rate with a faster camera, frames/s | clock that the camera needs, MHz"
    )
    return markdown(head, rows)


def rectification_table() -> str:
    def values(errors: list[float]) -> str:
        return ", ".join(f"{error:.2f}" for error in errors)

    rows = [
        [p["pairs"], values(p["raw_px"]), values(p["rectified_px"])]
        for p in figures("rectification")["pairs"]
    ]
    return markdown("pair | median row error before, px | after, px", rows)


CALIBRATION = {  # what a calibration found against the truth, with the names that the table gives it
    "focal_percent": "focal length (%)",
    "center_px": "principal point (px)",
    "baseline_percent": "baseline (%)",
    "turn_deg": "turn (degrees)",
    "rows_before_px": "rows before (px)",
    "exact_rows_px": "rows after (px)",
    "exact_rows_worst_px": "worst (px)",
    "far_disparity_px": "disparity (px)",
}


def calibration_table() -> str:
    def ends(row: Record, key: str) -> str:
        return span([float(f"{value:.2g}") for value in row[key]])

    rows = [[row["case"], *(ends(row, key) for key in CALIBRATION)] for row in figures("calibration")["rows"]]
    return markdown(" | ".join(["case", *CALIBRATION.values()]), rows)


def alignment_table() -> str:
    """Rows over time after a turn: median and 90th percentile; and how many recordings reach the aim."""

    def rows_of(px: list[float] | None) -> str:
        return "" if px is None else f"{px[0]:.2f}, {px[1]:.2f}"

    def reached(row: Record) -> str:
        count = row["recordings"]
        known = row["rows_px"][times[-1]] is not None
        return f"{count - len(row['short_px'])} of {count}" if known else ""

    found = figures("alignment")["rows"]
    times = list(found[0]["rows_px"])
    rows = [
        [
            f"{row['group']} ({row['recordings']})",
            row["case"],
            *(rows_of(row["rows_px"][time]) for time in times),
            reached(row),
            f"{row['alarms']} of {row['recordings']}",
        ]
        for row in found
    ]
    head = " | ".join(f"{time} s (px)" for time in times)
    return markdown(f"recordings | turn (degrees) | {head} | 0.2 px at {times[-1]} s | alarms", rows)


def rectification_grid_table() -> str:
    """Errors of a control grid against the exact map, and what line buffers of each depth serve."""

    def errors(found: Record, digits: int) -> str:
        return ", ".join(f"{found[key]:.{digits}f}" for key in ("mean", "p99", "max"))

    def share(found: Record) -> str:
        return f"{100 * found['share']:.1f} %" + ("" if found["accepted"] else ", refused")

    cameras = figures("rectification-grid")["cameras"]
    depths = list(cameras[0]["buffer_rows"])
    rows = [
        [
            one["camera"],
            errors(one["error_px"], 3),
            errors(one["error_grey"], 2),
            f"{one['rows_away'][0]:g} to {one['rows_away'][1]:g}",
            *(share(one["buffer_rows"][depth]) for depth in depths),
        ]
        for one in cameras
    ]
    head = "camera | error, px: mean, p99, max | grey levels: mean, p99, max | rows away | "
    return markdown(head + " | ".join(f"{depth} rows" for depth in depths), rows)


def health_table() -> str:
    """What the checks of a run say of real pairs, as recorded and with each fault."""

    def cells(row: Record) -> list[str]:
        reasons = ", ".join(f"`{name}` {count}" for name, count in row["reasons"].items()) or "none"
        measures = ("agreeing_share", "row_error_px", "row_spread_px", "negative_share")
        ranges = [span(row[name]) if name in row else "" for name in measures]
        return [row["recording"], row["fault"], str(row["frames"]), reasons, *ranges]

    head = "recording | fault | frames | reasons and frames | features that agree (share) | "
    head += "row error (px) | scatter of rows (px) | negative (share)"
    return markdown(head, [cells(row) for row in figures("health")["rows"]])


def synthesis_table() -> str:
    builds = figures("synthesis")["builds"]
    rows = []
    for b in builds:
        counts = [f"{b[key]:,}" for key in ("lut4", "sites", "ff", "block_ram", "multipliers")]
        build = [b["disparities"], b["block_px"], b["max_width_px"], b["device"], b["speed_grade"]]
        rows.append([*map(str, build), *counts, clock(b)])
    head = (
        "disparities | block | width | device | speed | LUT4 | sites | flip-flops | block RAMs | "
        "multipliers | MHz: median (range)"
    )
    lines = [with_slowest_paths(head, rows, builds), ""]
    older = [b for b in builds if "commit" in b]
    for b in older:
        lines.append(f"- The row of {b['disparities']} disparities was measured at commit {b['commit']}.")
    alike = [b for b in builds if all(b[key] == builds[0][key] for key in ("speed_grade", "max_width_px"))]
    made = [b for b in alike if b not in older]
    slow = sorted(made, key=lambda b: b["disparities"])
    for one, next_one in pairwise(slow):
        low, high = one["disparities"], next_one["disparities"]
        each = [(next_one[key] - one[key]) / (high - low) for key in ("lut4", "sites")]
        lines.append(
            f"- From {low} to {high} disparities, each takes {each[0]:.0f} LUT4 and {each[1]:.0f} sites."
        )
    return "\n".join(lines)


def blocks_table() -> str:
    """The blocks before the core."""
    rows = []
    blocks = figures("synthesis")["blocks"]
    for b in blocks["list"]:
        counts = [f"{b[key]:,}" for key in ("lut4", "sites", "ff", "block_ram", "multipliers")]
        name = [f"`{b['block']}`", str(b["max_width_px"]), b["device"], str(b["speed_grade"])]
        rows.append([*name, *counts, clock(b)])
    head = "block | width | device | speed | LUT4 | sites | flip-flops | block RAMs | multipliers | MHz"
    return f"{with_slowest_paths(head, rows, blocks['list'])}\n\n*{origin(blocks['measured'])}.*"


def with_slowest_paths(head: str, rows: list[list[str]], builds: list[Record]) -> str:
    """The table with one more column, if that is known of a build."""
    if any(b.get("critical_path") for b in builds):
        head += " | slowest path"
        rows = [[*row, slowest_path(b)] for row, b in zip(rows, builds, strict=True)]
    return markdown(head, rows)


def slowest_path(found: Record) -> str:
    return sentence(path) if (path := found.get("critical_path")) else ""


def board_table() -> str:
    """What the bitstream takes of the chip, and its clocks."""
    board = figures("synthesis")["board"]
    names = {
        "sites": "LUT4 places",
        "ff": "flip-flops",
        "block_ram": "block RAMs",
        "multipliers": "multipliers",
        "pll": "PLLs",
    }
    rows = []
    for key, name in names.items():
        used, available = board[key], board["available"][key]
        rows.append([name, f"{used:,} of {available:,} ({100 * used / available:.0f} %)"])
    for found in board["clocks"]:
        reached = f"{found['needed_mhz']:g} MHz, reaches {found['reached_mhz']:g}"
        rows.append([f"clock of {found['name']}", ": ".join(filter(None, [reached, slowest_path(found)]))])
    table = markdown(f"{board['board']}, {board['device']}-{board['speed_grade']} | used", rows)
    return f"{table}\n\n*{origin(board['measured'])}.*"


def board_clocks_table() -> str:
    def compared(row: Record, key: str) -> list[str]:
        board, model = row["board"][key], row["model"][key]
        return [f"{board:,}", f"{model:,} ({100 * (model / board - 1):+.1f} %)"]

    rows = []
    for row in figures("board-clocks")["rows"]:
        rates = [f"{row[side]:.1f}" for side in ("board_rate_hz", "model_rate_hz")]
        clocks = [*compared(row, "period_clocks"), *compared(row, "engine_clocks")]
        rows.append([row["size"], str(row["levels"]), *clocks, *rates])
    head = (
        "size | levels | clocks from frame to frame: board | model | "
        "clocks at work at a frame: board | model | frames/s: board | model"
    )
    return markdown(head, rows)


def board_soak_table() -> str:
    found = figures("board-soak")
    packets = found["packets"]
    numbers = {
        "frames sent": found["frames"],
        "answered": found["answered"],
        "reported lost": found["lost"],
        "words compared": found["words"],
        "of which with a disparity": found["matched_words"],
        "words that differ": found["differing_words"],
        "packets": packets["packets"],
        "dropped": packets["dropped"],
        "doubled": packets["doubled"],
        "chunks of pixels sent again": found["chunks_sent_again"],
    }
    return markdown("through the simulated system | count", [[k, f"{n:,}"] for k, n in numbers.items()])


def clock(build: Record) -> str:
    if build["clock_mhz"] is None:
        return "not routed"
    if build["seeds"] == 1:
        return f"{build['clock_mhz']:.1f} (1 seed)"
    low, high = build["clock_range_mhz"]
    return f"{build['clock_mhz']:.1f} ({low:.1f} to {high:.1f}, {build['seeds']} seeds)"


def coverage_table() -> str:
    c = figures("verification")["coverage"]
    bins = f"{c['functional_percent']} % of {c['functional_bins']} bins in {c['runs']} runs"
    rows = [
        ["functional", bins],
        ["line", f"{c['line_percent']} %"],
        ["branch", f"{c['branch_percent']} %"],
        ["toggle", f"{c['toggle_percent']} % ({c['toggle_points_waived']} points waived)"],
    ]
    return markdown("coverage | reached", rows)


def mutants_table() -> str:
    found = figures("verification")
    rows = [[f"the flattened core, seed {found['mutation']['seed']}", *caught(found["mutation"])]]
    rows += [[one["modules"], *caught(one)] for one in [*found["front_end"], *found["hand_made"]]]
    later = [
        f"{one['modules'].split()[0].rstrip(',')} at {one['measured']['commit']}, {one['measured']['date']}"
        for one in found["front_end"]
    ]
    text = "; ".join([origin(found["measured"]), *later])
    return f"{markdown('mutants of | planted | caught', rows)}\n\n*{text}.*"


def caught(mutants: Record) -> list[str]:
    return [str(mutants["planted"]), str(mutants["caught"])]


def system_model_table() -> str:
    rows = [
        [f"`{one['run']}`", str(one["builds"]), str(one["cases"]), str(one["differences"])]
        for one in figures("verification")["system_model"]
    ]
    return markdown("run | builds | cases | differences", rows)


def headline_table() -> str:
    """The few figures that the front page states, each with the command that gives it and the commit at which
    it did."""
    engine, build = figures("engine")["engine"], figures("synthesis")["builds"][0]
    headline, isa = engine["headline"], engine["isa"]
    sequences = figures("host")["sequences"].items()
    host = {name: one["stages"]["host"]["median_ms"] for name, one in sequences}
    helped = {name: one["two_threads"]["host"]["median_ms"] for name, one in sequences}
    lidar = figures("lidar")["halves"]["test"]
    pairs = {key: found["value"] for key, found in lidar["detectors"]["as configured"]["measures"].items()}
    pixels_s = build["clock_mhz"] * 1e6
    rows = [
        [
            "stereo engine in C, 640x480, 32 disparities, one thread",
            f"{headline['ms'][isa]['median']:.1f} ms, {headline['ratio'][isa]['median']:.1f} times as "
            "fast as OpenCV's StereoBM with the same words",
            "engine",
        ],
        [
            "stereo engine in an LFE5U-25F, 32 disparities",
            f"one pixel a clock at {build['clock_mhz']:.1f} MHz: {pixels_s / (640 * 480):.0f} frames/s "
            f"at 640x480; {build['lut4']:,} LUT4",
            "synthesis",
        ],
        [
            "host on a street",
            f"{host['street']:.0f} ms a frame of 1226x370, {host['street 640x480']:.0f} ms of 640x480, on "
            f"one core; {helped['street']:.0f} and {helped['street 640x480']:.0f} ms with a second thread on "
            "another (the paper: 100 to 200 ms)",
            "host",
        ],
        [
            f"{lidar['pairs']} real street pairs with LiDAR that nothing was chosen on",
            f"{pairs['recall']:.0%} of the points that stand are found, {pairs['cylinder']:.0%} of those "
            f"within 2 m of the optical axis; {pairs['road']:.1%} of the road's points are taken for "
            "obstacles",
            "lidar",
        ],
    ]
    table = []
    for what, found, name in rows:
        measured = figures(name)["measured"]
        table.append([what, found, f"`{measured['command']}`", measured["commit"]])
    return markdown("what | measured | command | at commit", table)


def sources_table() -> str:
    rows = []
    for path in figure_files():
        measured = json.loads(path.read_text())["measured"]
        cells = [f"`{path.relative_to(ROOT)}`", f"`{measured['command']}`"]
        rows.append([*cells, f"{measured['commit']}, {measured['date']}", measured["machine"]])
    return markdown("figures | command | commit, date | machine", rows)


def jobs_table() -> str:
    """Wall times only where no start of a process is in them."""
    found = figures("jobs")
    rows = []
    for place in ("in this process", "two processes", "Dask, two workers"):
        ms = found[place]["per_job_ms"]
        rows.append([place, *(fixed(ms.get(name), 2) for name in ("asking", "scheduler", "worker"))])
    return markdown("processor time per job, ms | process that asks | scheduler | one of the workers", rows)


def jobs_limits_table() -> str:
    """What follows for a cluster from the costs of one job."""
    found = figures("jobs")
    cluster, rows_ms = found["Dask, two workers"]["per_job_ms"], found["rows_ms"]
    busiest_ms = max(cluster["scheduler"], cluster["asking"] + rows_ms["keep"])
    rows = [
        ["jobs per second that the scheduler or the process that asks can take", f"{1e3 / busiest_ms:.0f}"],
        [
            "mean length of a job at which 1,000 workers take a quarter of that",
            f"{4 * WORKERS * busiest_ms / 1e3:.0f} s",
        ],
        ["to look at a file of a recording on a local disk", f"{rows_ms['look at a file']:.3f} ms"],
        ["to find the row of a recording kept", f"{rows_ms['find']:.3f} ms"],
    ]
    return markdown("what | figure", rows)


def worlds_table(split: str, name: str) -> str:
    """One of the tables that `vista worlds` prints, with its legend."""
    (table,) = (one for one in figures(f"worlds-{split}")["tables"] if one["name"] == name)
    return f"{markdown(' | '.join(table['heads']), table['rows'])}\n\nIn the columns are: {table['legend']}."


def worlds_tables() -> Iterator[tuple[str, str]]:
    """Split and name of each table that was measured; a split that has not been scored has none."""
    for split in ("dev", "test"):
        if file_of(f"worlds-{split}").exists():
            yield from ((split, table["name"]) for table in figures(f"worlds-{split}")["tables"])


TABLES: dict[str, dict[str, Callable[[], str]]] = {  # by the figures that they state
    "": {  # of several, or measured in parts: these say themselves when
        "headline": headline_table,
        "sources": sources_table,
        "blocks": blocks_table,
        "board": board_table,
        "mutants": mutants_table,
    },
    "engine": {"engine": engine_table, "engine-sizes": engine_sizes_table},
    "frontend": {"frontend": frontend_table},
    "disparity-quality": {"disparity-quality": disparity_quality_table},
    "lidar": {"lidar": lidar_table},
    "evidence": {"evidence": evidence_table},
    "host": {"host": host_table, "stages": stages_table},
    "maxflow": {"maxflow": maxflow_table},
    "jobs": {"jobs": jobs_table, "jobs-limits": jobs_limits_table},
    "street": {"street": street_table},
    "segmentation": {
        f"segmentation-{split}": partial(segmentation_table, split) for split in ("dev", "test")
    },
    "segmentation-roads": {
        "roads-partitions": partial(roads_table, ROADS_OF_PARTITIONS),
        "roads-detection": partial(roads_table, ROADS_OF_DETECTION),
    },
    "scenes": {"scenes": scenes_table},
    "flights": {
        **{f"flights-{split}": partial(flights_table, split) for split in ("dev", "test")},
        "flights-noise": flights_noise_table,
    },
    "throughput": {"throughput": throughput_table},
    "board-clocks": {"board-clocks": board_clocks_table},
    "board-soak": {"board-soak": board_soak_table},
    "rectification": {"rectification": rectification_table},
    "rectification-grid": {"rectification-grid": rectification_grid_table},
    "calibration": {"calibration": calibration_table},
    "alignment": {"alignment": alignment_table},
    "health": {"health": health_table},
    "synthesis": {"synthesis": synthesis_table},
    "verification": {"coverage": coverage_table, "system-model": system_model_table},
}


def all_tables() -> dict[str, Callable[[], str]]:
    """Names all tables, with those of sampled worlds, of which there are as many as were measured up to now.
    Below each stands when its figures were measured."""
    made: dict[str, Callable[[], str]] = {
        name: partial(with_origin, source, table)
        for source, tables in TABLES.items()
        for name, table in tables.items()
    }
    for split, name in worlds_tables():
        source = f"worlds-{split}"
        made[f"{source}-{name}"] = partial(with_origin, source, partial(worlds_table, split, name))
    return made


def with_origin(source: str, table: Callable[[], str]) -> str:
    return f"{table()}\n\n*{origin(figures(source)['measured'])}.*" if source else table()


def origin(measured: Record) -> str:
    return f"Measured at commit {measured['commit']}, {measured['date']}"


def pages() -> Iterator[Path]:
    yield ROOT / "README.md"
    yield from sorted((ROOT / "doc").rglob("*.md"))


def with_tables(text: str) -> str:
    made = all_tables()
    return MARKED.sub(lambda found: f"{found[1]}\n{made[found[2]]()}\n\n{found[3]}", text)


def write_tables(check: bool) -> list[Path]:
    """The pages whose tables were not those of the figures."""
    stale = []
    for path in pages():
        text = path.read_text()
        if (wanted := with_tables(text)) != text:
            stale.append(path)
            if not check:
                path.write_text(wanted)
    return stale


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing; fail when a table is stale")
    parser.add_argument("--save", nargs="+", default=[], metavar="NAME=FILE.json", help="figures to commit")
    parser.add_argument("--command", default="", help="the command that has measured them")
    arguments = parser.parse_args()
    for one in arguments.save:
        name, _, source = one.partition("=")
        if name not in REDUCE or not arguments.command:
            parser.error(f"--save takes {', '.join(REDUCE)}, and needs --command")
        save(name, Path(source), arguments.command)
    stale = write_tables(arguments.check)
    if arguments.check and stale:
        names = ", ".join(str(path.relative_to(ROOT)) for path in stale)
        print(f"make_tables: {names}: differs from the figures in JSON; run make generate", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
