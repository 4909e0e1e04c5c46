"""`vista scenes --lidar FOLDER` and `--dense FOLDER`: real pairs with measured truth."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from vista import parameters
from vista.errors import InputError
from vista.output import write_atomically

from vista_eval.detectors import OURS
from vista_eval.jobs import Place, jobs_of, run
from vista_eval.measured_pairs import LIDAR, MeasuredPair, find_sources, look, measure
from vista_eval.report import pairs_page
from vista_eval.report.table import write_measurement


def measure_folder(kind: str, folder: Path, out: Path, values: parameters.Values, place: Place) -> None:
    """Prints the tables; `out` receives <kind>.json and <kind>.html. Raises InputError."""
    sources = find_sources(kind, place.known_to_all(folder))
    jobs = jobs_of(partial(measure, values), sources, lambda source: source.name)
    measured: list[MeasuredPair] = run(jobs, place, "measure", "pair")
    if not any(m.counts is not None for m in measured):
        raise InputError(folder, "no pair shows a road")
    tables = pairs_page.tables(kind, measured)
    by_name = {source.name: source for source in sources}
    pictures = []
    for one in pairs_page.worst(measured):
        pair, points, judged = look(values, by_name[one.name], OURS)
        picture = pairs_page.draw_pair(pair, points, judged, values["stereo"]["num_disparities"])
        title = f"{one.name} ({one.split}): recall {pairs_page.recall_of(one):.2f}"
        pictures.append(pairs_page.encode(title, pairs_page.caption(one), picture))
    content = pairs_page.as_json(kind, measured, values)
    halves = content["halves"]
    stated = [pairs_page.stated(halves)] if kind == LIDAR else []
    headline = pairs_page.front_page(halves["test"]) if kind == LIDAR and "test" in halves else None
    figures = {"halves": pairs_page.compact(halves)}
    write_measurement(out / f"{kind}.json", stated, figures, headline, **content)
    report = out / f"{kind}.html"
    write_atomically(report, pairs_page.render_page(kind, measured, tables, pictures))
    print("\n".join(pairs_page.lines(tables)))
    print(f"report: {report}")
