"""Run every bench_*.py of some folders, one after the other, and merge what they write into one JSON file.

usage: run_benches.py FOLDER ... --out FILE.json

Each bench prints its tables and writes FOLDER-OF-OUT/bench/<name>.json."""

from __future__ import annotations

import argparse
import json
import platform
import subprocess
import sys
from pathlib import Path


def processor() -> str:
    """Model name of the processor, as far as the system tells."""
    info = Path("/proc/cpuinfo")
    names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
    return names[0] if names else platform.processor()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    parser.add_argument("--out", required=True, type=Path, metavar="FILE.json")
    arguments = parser.parse_args()
    merged: dict[str, object] = {"machine": {"processor": processor(), "system": platform.platform()}}
    failed = []
    for bench in sorted(path for folder in arguments.folders for path in folder.glob("bench_*.py")):
        name = bench.stem.removeprefix("bench_")
        written = arguments.out.parent / "bench" / f"{name}.json"
        written.parent.mkdir(parents=True, exist_ok=True)
        written.unlink(missing_ok=True)
        print(f"\n== {name} ({bench})", flush=True)
        if subprocess.run([sys.executable, bench, "--out", written]).returncode != 0:
            failed.append(str(bench))
        elif written.is_file():
            merged[name] = json.loads(written.read_text())
    arguments.out.write_text(json.dumps(merged, indent=1) + "\n")
    print(f"\nwritten: {arguments.out}")
    if failed:
        print(f"run_benches: failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
