"""Measure what each mechanism earns: it is switched off alone, and sampled flights are scored.

usage: ablation.py DIR [--only NAME ...] [--count N] [--perfect] [--out FILE.json]

DIR holds flights of `vista worlds`, split dev. mechanisms.toml, beside this program, says how each mechanism
is switched off: by an edit of the sources of libvista, or by parameters. Each variant is a library of its
own, and every flight is matched and its truth read once for all of them. --perfect takes the true disparities
for those of the engine. The table has the hits, the frames
with a false alarm, those that call the path free through something and the positions within 2 dz, each beside
the detector as it is, and the families that win or lose. --out also writes the figures, for
`scripts/make_tables.py --save ablation=FILE.json`.
"""

from __future__ import annotations

import argparse
import shlex
import shutil
import subprocess
import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from vista import native, parameters
from vista.chain import make_chain
from vista.health.finding import FrameHealth
from vista.health.monitor import findings_of_host
from vista.history import FrameRecord
from vista.pipeline import Pipeline
from vista_eval.dataset.truth import read_truth
from vista_eval.fly import open_flight
from vista_eval.jobs import add_place, chosen_place, exit_on_failure, jobs_of, run
from vista_eval.metrics.flight_score import FlightScore, score_records
from vista_eval.metrics.rules import STRICT
from vista_eval.metrics.world_score import in_tolerance
from vista_eval.report.table import Table, rounded, write_measurement
from vista_eval.rivals import IN_HOST, PERFECT
from vista_eval.worlds.sampled.catalog import DEV

ROOT = Path(__file__).resolve().parents[3]
MECHANISMS = Path(__file__).with_name("mechanisms.toml")
SOURCES = ROOT / "sw" / "src"
INCLUDED = [ROOT / folder for folder in ("sw/include", "model/c/include", "rtl/csr", "rtl/board")]
FLAGS = "-O3 -std=c17 -fPIC -ffp-contract=off -fno-math-errno -fno-trapping-math -w"
AS_IT_IS = "as it is"


# ---- variants ----


@dataclass(frozen=True)
class Edit:
    file: str  # below sw/src
    old: str
    new: str


@dataclass(frozen=True)
class Mechanism:
    name: str
    edits: tuple[Edit, ...] = ()
    values: dict[str, object] = field(default_factory=dict)  # of parameters, "section.name"
    kept: str = ""  # why it stays whatever it earns


def read_mechanisms(path: Path = MECHANISMS) -> list[Mechanism]:
    content = tomllib.loads(path.read_text())["mechanism"]
    return [Mechanism(**one | {"edits": tuple(Edit(**e) for e in one.get("edits", []))}) for one in content]


def apply(mechanism: Mechanism, sources: Path) -> list[Path]:
    """Edits a copy of the sources; the files that changed. ValueError: the old text is not there once."""
    for edit in mechanism.edits:
        file = sources / edit.file
        text = file.read_text()
        if text.count(edit.old) != 1:
            raise ValueError(f"{mechanism.name}: {edit.file} has the old text {text.count(edit.old)} times")
        file.write_text(text.replace(edit.old, edit.new))
    return [sources / edit.file for edit in mechanism.edits]


def compile_all(sources: Path, files: list[Path], objects: Path) -> None:
    for file in files:
        out = objects / f"{'_'.join(file.relative_to(sources).parts)}.o"
        include = [f"-I{folder}" for folder in (sources, *INCLUDED)]
        command = ["gcc", *shlex.split(FLAGS), *include, "-c", str(file), "-o", str(out)]
        subprocess.run(command, check=True)


def build(mechanism: Mechanism, unchanged: Path, libraries: Path) -> Path:
    """The library of a variant; unchanged: the objects of the sources as they are."""
    library = libraries / f"{mechanism.name.replace(' ', '_')}.so"
    with tempfile.TemporaryDirectory() as name:
        sources, objects = Path(name) / "src", Path(name) / "objects"
        shutil.copytree(SOURCES, sources)
        shutil.copytree(unchanged, objects)
        changed = apply(mechanism, sources)
        headers = any(file.suffix == ".h" for file in changed)
        compile_all(
            sources, sorted(sources.rglob("*.c")) if headers else list(dict.fromkeys(changed)), objects
        )
        engine = native.library_path("vista_engine")
        inputs = [str(file) for file in (*objects.glob("*.o"), engine)]
        link = ["gcc", "-shared", "-o", str(library), *inputs, f"-Wl,-rpath,{engine.parent}"]
        subprocess.run([*link, "-lm", "-lpthread"], check=True)
    return library


def variant_class(library: Path) -> type[Pipeline]:
    """The pipeline in the library of a variant."""
    ffi, _ = native.load("vista")
    pair = ffi, ffi.dlopen(str(library))

    class Variant(Pipeline):
        @classmethod
        def opened(cls) -> tuple[Any, Any]:
            return pair

    return Variant


# ---- flights ----


@dataclass(frozen=True)
class Matched:
    """A frame as the host takes it."""

    index: int
    t_ns: int
    left: Any
    levels: list[Any]
    pose: Any


def matched_frames(folder: Path, values: parameters.Values, perfect: bool) -> tuple[Any, list[Matched], Any]:
    """The rectified camera, the frames and the direction up of a flight."""
    sequence = open_flight(folder)
    chain = make_chain(sequence, "golden", values, threads=1)
    engine = IN_HOST[PERFECT].engine_of(values, read_truth(folder)) if perfect else chain.engine
    frames = []
    for files in sequence.frames:
        raw = sequence.read(files)
        pair = chain.rectifier.rectify(raw)
        levels = list(engine.levels(pair.left, pair.right))
        frames.append(Matched(raw.index, raw.t_ns, pair.left, levels, pair.world_from_camera))
    return chain.rectifier.calibration, frames, sequence.up_world


def fly(pipeline: Pipeline, frames: list[Matched], up_world: Any, levels: int) -> Iterator[FrameRecord]:
    """The records of a flight; without the free directions, which no figure of the table needs."""
    for frame in frames:
        found = pipeline.process(frame.left, frame.levels[:levels], frame.t_ns, frame.pose, up_world)
        yield FrameRecord(
            found.outcome,
            found.items,
            None,
            found.stage_ms,
            index=frame.index,
            t_ns=frame.t_ns,
            health=FrameHealth(findings_of_host(found.health)),
        )


def figures_of(score: FlightScore) -> dict[str, float]:
    good, all_matched = in_tolerance(score)
    return {
        "hits": score.hits,
        "asked": score.band_frames,
        "false": len(score.false_alarm_frames),
        "frames": len(score.frames),
        "through": score.free.through,
        "clear": score.free.clear_seen,
        "good": good,
        "matched": all_matched,
    }


@dataclass(frozen=True)
class Variant:
    name: str
    library: Path
    values: dict[str, object]


def with_values(values: parameters.Values, changes: dict[str, object]) -> parameters.Values:
    changed = {section: dict(content) for section, content in values.items()}
    for name, value in changes.items():
        section, parameter = name.split(".")
        changed[section][parameter] = value
    return changed


def measure_flight(variants: list[Variant], perfect: bool, folder: Path) -> dict[str, dict[str, float]]:
    """Figures by variant."""
    values = parameters.defaults()
    camera, frames, up_world = matched_frames(folder, values, perfect)
    found = {}
    for variant in variants:
        changed = with_values(values, variant.values)
        levels = int(changed["stereo"]["levels"])
        pipeline = variant_class(variant.library)(camera, changed)
        records = list(fly(pipeline, frames, up_world, levels))
        found[variant.name] = figures_of(score_records(folder, records, values, STRICT))
    return found


# ---- the table ----

HEADS = ("without", "hits", "false", "through", "within 2 dz", "wins in", "loses in", "kept for")


def total(results: list[dict[str, dict[str, float]]], name: str) -> dict[str, float]:
    return {key: sum(one[name][key] for one in results) for key in results[0][name]}


def balance(found: dict[str, float], before: dict[str, float]) -> float:
    """Frames that are right: hits more, false frames less."""
    return found["hits"] - before["hits"] - (found["false"] - before["false"])


def families_of(
    results: dict[str, dict[str, dict[str, float]]],
) -> dict[str, list[dict[str, dict[str, float]]]]:
    families: dict[str, list[dict[str, dict[str, float]]]] = {}
    for flight, found in results.items():
        families.setdefault(flight.rsplit("_", 1)[0], []).append(found)
    return families


def row_of(mechanism: Mechanism, results: dict[str, dict[str, dict[str, float]]]) -> tuple[str, ...]:
    """What changes without it, and the families that the detector wins or loses with it."""
    every = list(results.values())
    before, found = total(every, AS_IT_IS), total(every, mechanism.name)
    gains = {
        family: -balance(total(members, mechanism.name), total(members, AS_IT_IS))
        for family, members in families_of(results).items()
    }
    wins = [f"{family} {gain:g}" for family, gain in gains.items() if gain > 0]
    losses = [f"{family} {-gain:g}" for family, gain in gains.items() if gain < 0]
    good = 100.0 * (found["good"] / max(found["matched"], 1.0) - before["good"] / max(before["matched"], 1.0))
    return (
        mechanism.name,
        *(f"{found[key] - before[key]:+g}" for key in ("hits", "false", "through")),
        f"{good:+.1f} %",
        ", ".join(wins),
        ", ".join(losses),
        mechanism.kept,
    )


def table_of(mechanisms: list[Mechanism], results: dict[str, dict[str, dict[str, float]]]) -> Table:
    before = total(list(results.values()), AS_IT_IS)
    legend = (
        f"{len(results)} flights of {len(families_of(results))} families; with everything in place "
        f"{before['hits']:g} hits of {before['asked']:g}, a false alarm in {before['false']:g} of "
        f"{before['frames']:g} frames, and {before['through']:g} frames that call the path free through "
        "something. In the columns are: what changes in these, and in the share of positions within 2 dz, "
        "without the mechanism; the families in which it wins or loses, by hits gained and false frames "
        "spared."
    )
    ordered = sorted(mechanisms, key=lambda one: balance(total([*results.values()], one.name), before))
    return Table("ablation", HEADS, [row_of(one, results) for one in ordered], legend)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    mechanisms = read_mechanisms()
    names = [one.name for one in mechanisms]
    parser.add_argument("folder", type=Path, metavar="DIR", help="flights of `vista worlds`")
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME")
    parser.add_argument(
        "--count", type=int, default=3, metavar="N", help="flights of each family (default 3)"
    )
    parser.add_argument("--perfect", action="store_true", help="true disparities in place of the engine's")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="also write the figures")
    add_place(parser)
    arguments = parser.parse_args()
    chosen = [one for one in mechanisms if one.name in arguments.only]
    folders = [
        arguments.folder / f"{family.name}_{number:03d}"
        for family in DEV
        for number in range(arguments.count)
    ]
    with tempfile.TemporaryDirectory() as name, exit_on_failure():
        unchanged, libraries = Path(name) / "objects", Path(name) / "libraries"
        unchanged.mkdir()
        libraries.mkdir()
        compile_all(SOURCES, sorted(SOURCES.rglob("*.c")), unchanged)
        variants = [
            Variant(one.name, build(one, unchanged, libraries), one.values)
            for one in [Mechanism(AS_IT_IS), *chosen]
        ]
        place = chosen_place(arguments)
        jobs = jobs_of(
            partial(measure_flight, variants, arguments.perfect), folders, lambda folder: folder.name
        )
        measured = run(jobs, place, "measure", "flight")
    results = {folder.name: found for folder, found in zip(folders, measured, strict=True)}
    table = table_of(chosen, results)
    print(table.as_text())
    if arguments.out is not None:
        write_measurement(arguments.out, [table], rounded(results, 2))


if __name__ == "__main__":
    main()
