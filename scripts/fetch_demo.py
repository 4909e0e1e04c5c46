"""Fetch the real stereo pairs of the demo and lay them out as a folder of pairs.

usage: fetch_demo.py OUT_DIR

OUT_DIR gets NAME_left.png, NAME_right.png (640x480, grey, rectified), calibration.toml and provenance.json
with the sha256 of every file. A folder that still matches its provenance is left as it is, without a network.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path, PurePosixPath

PIN = Path(__file__).parent / "requirements" / "demo_pairs.txt"
DATASET = "stereodemo/datasets/oak-d"
LEFT_OUT = "selfie"  # a portrait of a person
PROVENANCE = "provenance.json"


class FetchError(Exception):
    """What went wrong, in one line."""


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def pinned_sha256(pin: Path = PIN) -> str:
    match = re.search(r"--hash=sha256:([0-9a-f]{64})", pin.read_text())
    if match is None:
        raise FetchError(f"{pin}: no sha256")
    return match.group(1)


def is_complete(folder: Path, wheel_sha256: str) -> bool:
    """Whether `folder` holds just what the pinned wheel gave, unchanged."""
    try:
        provenance = json.loads((folder / PROVENANCE).read_text())
        return provenance["wheel_sha256"] == wheel_sha256 and all(
            sha256(folder / name) == digest for name, digest in provenance["files"].items()
        )
    except (OSError, ValueError, KeyError):
        return False


def download(pin: Path, into: Path) -> Path:
    """The pinned wheel; pip checks its hash."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    run = subprocess.run(
        [*command, "--require-hashes", "--requirement", str(pin), "--dest", str(into)],
        capture_output=True,
        text=True,
        check=False,
    )
    wheels = sorted(into.glob("*.whl"))
    if run.returncode != 0 or len(wheels) != 1:
        errors = [line for line in run.stderr.splitlines() if line.startswith("ERROR")]
        raise FetchError(f"cannot download the demo pairs: {errors[-1] if errors else 'pip gave no wheel'}")
    return wheels[0]


def calibration_toml(shipped: dict[str, float]) -> str:
    """`calibration.toml` of a folder of pairs, out of the JSON that the data set ships."""
    if shipped["fx"] != shipped["fy"] or shipped["cx0"] != shipped["cx1"]:
        raise FetchError("the data set's calibration is not that of a rectified pair")
    return (
        f"focal_px = {shipped['fx']}\n"
        f"cx = {shipped['cx0']}\n"
        f"cy = {shipped['cy']}\n"
        f"baseline_m = {shipped['baseline_meters']}\n"
    )


def unpack(wheel: Path, folder: Path) -> None:
    """Writes the pairs of `wheel` and their calibration.toml into `folder`."""
    try:
        with zipfile.ZipFile(wheel) as archive:
            members = [PurePosixPath(name) for name in archive.namelist()]
            pairs = [m for m in members if str(m.parent) == DATASET and m.suffix == ".png"]
            for member in pairs:
                if not member.name.startswith(LEFT_OUT):
                    (folder / member.name).write_bytes(archive.read(str(member)))
            shipped = json.loads(archive.read(f"{DATASET}/stereodemo_calibration.json"))
    except (zipfile.BadZipFile, KeyError, ValueError) as error:
        raise FetchError(f"{wheel.name}: {error}") from error
    if not any(folder.iterdir()):
        raise FetchError(f"{wheel.name}: no pairs in {DATASET}")
    (folder / "calibration.toml").write_text(calibration_toml(shipped))


def write_provenance(folder: Path, wheel: Path) -> None:
    provenance = {
        "source": f"{wheel.name}, {DATASET}",
        "licence": "CC BY 4.0, by the author of stereodemo",
        "wheel_sha256": sha256(wheel),
        "files": {path.name: sha256(path) for path in sorted(folder.iterdir())},
    }
    (folder / PROVENANCE).write_text(json.dumps(provenance, indent=1) + "\n")


def fetch(out: Path, pin: Path = PIN) -> bool:
    """Makes `out` complete; returns whether anything had to be fetched. Raises FetchError."""
    if is_complete(out, pinned_sha256(pin)):
        return False
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=f".{out.name}.") as scratch:
        downloads, folder = Path(scratch, "download"), Path(scratch, "pairs")
        downloads.mkdir()
        folder.mkdir()
        wheel = download(pin, downloads)
        unpack(wheel, folder)
        write_provenance(folder, wheel)
        if out.exists():
            shutil.rmtree(out)
        folder.rename(out)  # complete or absent, never half
    return True


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT_DIR")
    out = parser.parse_args().out
    try:
        if not is_complete(out, pinned_sha256()):
            print("fetching real stereo pairs (4 MB)", flush=True)
        fetch(out)
    except (FetchError, OSError) as error:
        print(f"fetch_demo: {error}", file=sys.stderr)
        return 2
    print(f"{len(list(out.glob('*_left.png')))} real stereo pairs in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
