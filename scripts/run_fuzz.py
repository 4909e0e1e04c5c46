"""Fuzzes the targets of sw/fuzz for a time, one after the other, and says what they executed and covered.

What is new is kept in build/fuzz/corpus, so that the next run goes on from there. An input that fails is left
in build/fuzz/failures; once it is repaired, it goes into sw/fuzz/corpus.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from time import perf_counter

from vista.command.arguments import positive
from vista_eval.report.table import Table, write_measurement

ROOT = Path(__file__).resolve().parents[1]
FUZZ = ROOT / "build" / "fuzz"
CORPUS = ROOT / "sw" / "fuzz" / "corpus"
MAX_BYTES = 8192  # of an input
INPUT_SECONDS = 30  # one that takes longer is a failure
OPTIONS = {"pipeline": ["-entropic=0"]}  # with some thousand inputs it takes a fifth of the time


@dataclass(frozen=True)
class Outcome:
    """What a target did: executions, the frames in them if it counts any, and edges reached of all."""

    target: str
    failed: bool
    executions: int
    edges: int
    all_edges: int
    minutes: float
    frames: int | None = None

    def row(self) -> tuple[str, ...]:
        frames = "" if self.frames is None else f"{self.frames:,}"
        edges = f"{self.edges:,} of {self.all_edges:,}"
        failures = "1" if self.failed else "0"  # a target stops at its first
        return (self.target, f"{self.executions:,}", frames, f"{self.minutes:.1f}", edges, failures)


def table(outcomes: Sequence[Outcome]) -> Table:
    heads = ("target", "executions", "frames", "minutes", "edges reached", "failures")
    return Table("fuzzing", heads, [outcome.row() for outcome in outcomes])


def has_fuzzer() -> bool:
    """Whether the targets are libFuzzer's; else they are gcc's and run the corpus only."""
    return bool((ROOT / "build/tools/clang/command").read_text().strip())


def run_corpus(target: str) -> subprocess.CompletedProcess[str]:
    """The committed inputs, each once."""
    inputs = sorted(str(path) for path in (CORPUS / target).iterdir())
    return subprocess.run([FUZZ / target, *inputs], capture_output=True, text=True, errors="replace")


def fuzz(target: str, *limits: str, jobs: int = 1) -> tuple[Outcome, str]:
    """Runs libFuzzer from the corpora on, in `jobs` processes, each of which takes over the inputs that the
    others find. Returns what they did and what they printed."""
    kept, failures = FUZZ / "corpus" / target, FUZZ / "failures"
    for folder in (kept, failures):
        folder.mkdir(parents=True, exist_ok=True)
    command: list[str | Path] = [
        FUZZ / target, *limits, f"-max_len={MAX_BYTES}", f"-timeout={INPUT_SECONDS}", "-print_final_stats=1",
        "-rss_limit_mb=4096", f"-artifact_prefix={failures}/{target}-", *OPTIONS.get(target, []),
        kept, CORPUS / target,
    ]  # fmt: skip
    start_s = perf_counter()
    with ExitStack() as stack:
        printed = [stack.enter_context(TemporaryFile("w+", errors="replace")) for _ in range(jobs)]
        running = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=file) for file in printed]
        for process in running:
            stack.callback(process.kill)  # of use where this is interrupted
        failed = any([process.wait() != 0 for process in running])
        minutes = (perf_counter() - start_s) / 60.0
        for file in printed:
            file.seek(0)
        texts = [file.read() for file in printed]
    return read_outcome(target, failed, minutes, texts), "\n".join(texts)


def read_outcome(target: str, failed: bool, minutes: float, texts: Sequence[str]) -> Outcome:
    """Reads what libFuzzer prints, in each process."""

    def last(pattern: str) -> list[int]:
        found = [re.findall(pattern, text) for text in texts]
        return [int(numbers[-1]) for numbers in found if numbers]

    frames = last(r"stat::frames: +(\d+)")
    return Outcome(
        target,
        failed,
        sum(last(r"stat::number_of_executed_units: +(\d+)")),
        max(last(r"\bcov: (\d+)"), default=0),
        max(last(r"\((\d+) inline 8-bit counters\)"), default=0),
        minutes,
        sum(frames) if frames else None,
    )


def asked(text: str) -> tuple[str, int | None]:
    """A target, and its seconds if it has its own: TARGET or TARGET=SECONDS."""
    target, equals, seconds = text.partition("=")
    if target not in targets():
        raise argparse.ArgumentTypeError(f"{target!r} is no target; there are {', '.join(targets())}")
    return target, positive(seconds) if equals else None


def targets() -> list[str]:
    return sorted(path.name for path in CORPUS.iterdir())


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("targets", nargs="+", metavar="TARGET[=SECONDS]", type=asked)
    parser.add_argument(
        "--seconds", type=positive, default=600, help="for a target that names none (default 600)"
    )
    parser.add_argument("--jobs", type=positive, default=1, help="processes for each target (default 1)")
    parser.add_argument(
        "--out",
        type=Path,
        default=FUZZ / "fuzz.json",
        help="file of the table (default build/fuzz/fuzz.json)",
    )
    arguments = parser.parse_args()
    if not has_fuzzer():
        print("there is no clang with libFuzzer: only the committed inputs are run")
        return max(run_corpus(target).returncode for target, _ in arguments.targets)
    outcomes = []
    for target, seconds in arguments.targets:
        outcome, text = fuzz(target, f"-max_total_time={seconds or arguments.seconds}", jobs=arguments.jobs)
        outcomes.append(outcome)
        print(table([outcome]).as_text(), flush=True)
        if outcome.failed:
            print("\n".join(text.splitlines()[-40:]), file=sys.stderr)
    write_measurement(arguments.out, [table(outcomes)])
    return int(any(outcome.failed for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
