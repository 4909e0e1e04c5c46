"""Fuzzes the targets of sw/fuzz for a time, one after the other, and says what they executed and covered.

What is new is kept in build/fuzz/corpus, so that the next run goes on from there. An input that fails is left
in build/fuzz/failures; once it is repaired, it goes into sw/fuzz/corpus.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

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
    frames: int | None = None

    def line(self) -> str:
        share = 100 * self.edges / max(self.all_edges, 1)
        end = "FAILED" if self.failed else "passed"
        edges = f"{self.edges:>7} of {self.all_edges:<7} {share:>4.0f} %"
        frames = "" if self.frames is None else f"{self.frames}"
        return f"{self.target:<12} {self.executions:>10} {frames:>9} {edges}   {end}"


HEADING = f"{'target':<12} {'executions':>10} {'frames':>9} {'edges reached':>18}"


def has_fuzzer() -> bool:
    """Whether the targets are libFuzzer's; else they are gcc's and run the corpus only."""
    return bool((ROOT / "build/tools/clang/command").read_text().strip())


def run_corpus(target: str) -> subprocess.CompletedProcess[str]:
    """The committed inputs, each once."""
    inputs = sorted(str(path) for path in (CORPUS / target).iterdir())
    return subprocess.run([FUZZ / target, *inputs], capture_output=True, text=True, errors="replace")


def fuzz(target: str, *limits: str) -> tuple[Outcome, str]:
    """libFuzzer from the corpora on, and what it printed."""
    kept, failures = FUZZ / "corpus" / target, FUZZ / "failures"
    for folder in (kept, failures):
        folder.mkdir(parents=True, exist_ok=True)
    command: list[str | Path] = [
        FUZZ / target, *limits, f"-max_len={MAX_BYTES}", f"-timeout={INPUT_SECONDS}", "-print_final_stats=1",
        "-rss_limit_mb=4096", f"-artifact_prefix={failures}/{target}-", *OPTIONS.get(target, []),
        kept, CORPUS / target,
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    return read_outcome(target, done.returncode != 0, done.stderr), done.stderr


def read_outcome(target: str, failed: bool, text: str) -> Outcome:
    """Reads what libFuzzer prints."""

    def last(pattern: str) -> int:
        found = re.findall(pattern, text)
        return int(found[-1]) if found else 0

    return Outcome(
        target,
        failed,
        last(r"stat::number_of_executed_units: +(\d+)"),
        last(r"\bcov: (\d+)"),
        last(r"\((\d+) inline 8-bit counters\)"),
        last(r"stat::frames: +(\d+)") if "stat::frames:" in text else None,
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("targets", nargs="+", metavar="TARGET")
    parser.add_argument("--seconds", type=int, default=600, help="for each target (default 600)")
    arguments = parser.parse_args()
    if not has_fuzzer():
        print("there is no clang with libFuzzer: only the committed inputs are run")
        return max(run_corpus(target).returncode for target in arguments.targets)
    print(HEADING)
    failed = False
    for target in arguments.targets:
        outcome, text = fuzz(target, f"-max_total_time={arguments.seconds}")
        print(outcome.line(), flush=True)
        if outcome.failed:
            failed = True
            print("\n".join(text.splitlines()[-40:]), file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
