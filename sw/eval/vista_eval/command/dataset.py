"""Run the whole chain on many recordings, and find the worst of them.

PREFIX is a folder, or a prefix of an object store such as s3://bucket/flights (with the fsspec package of
that store). Every folder below it that looks like a recording counts; `vista run --help` names the layouts.
Recordings of an object store are copied to a temporary folder, one at a time for each worker.

DIR receives recordings.parquet (one row per recording, by name), report.html (worst first) and rows/, which
keeps the row of each recording until its files, the parameters or the code change: a run that was interrupted
continues. With --engine rtl no row is kept, for nothing tells whether the core has changed. A recording that
cannot be read is a row with its error.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vista.command.arguments import add_config, add_engine, load_parameters
from vista.errors import EXIT_OK
from vista.output import write_atomically

from vista_eval.jobs import add_place, chosen_place

TABLE, REPORT, ROWS = "recordings.parquet", "report.html", "rows"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("prefix", metavar="PREFIX", help="folder or URL of an object store")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    add_engine(parser, "as for `vista run`")
    add_place(parser)
    add_config(parser)


def execute(arguments: argparse.Namespace) -> int:
    # fsspec and pyarrow are of an extra, and take a moment, for which `--help` need not wait.
    from vista_eval.recordings.examine import Detector
    from vista_eval.recordings.examine_all import examine_all
    from vista_eval.recordings.page import closing_lines, page
    from vista_eval.recordings.storage import absolute
    from vista_eval.recordings.table import worst_first, write_table

    detector = Detector(arguments.engine, load_parameters(arguments.config, arguments.engine))
    place, out = chosen_place(arguments), arguments.out
    rows = examine_all(detector, absolute(arguments.prefix), place, out / ROWS)
    write_table(out / TABLE, rows)
    ordered = worst_first(rows)
    write_atomically(out / REPORT, page(arguments.prefix, ordered).render())
    print("\n".join(closing_lines(ordered)))
    print(f"table: {out / TABLE}\nreport: {out / REPORT}")
    return EXIT_OK
