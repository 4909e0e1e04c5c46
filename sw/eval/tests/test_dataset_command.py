"""vista dataset on small recordings: one row each, the same wherever it is made, an error never a stop."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sequence_cases as cases
from command_line import assert_refused
from command_line import call as call_vista
from fake_pipeline import DescendingDetector, fake_record
from vista import parameters
from vista.errors import EXIT_OK, InputError
from vista.health.finding import Finding, FrameHealth, Reason, State
from vista.pipeline import Nearest

pytestmark = pytest.mark.slow

fsspec = pytest.importorskip("fsspec", reason="no fsspec: make setup-jobs")
parquet = pytest.importorskip("pyarrow.parquet", reason="no pyarrow: make setup-jobs")

from vista_eval.jobs import HERE  # noqa: E402
from vista_eval.recordings import examine as module  # noqa: E402
from vista_eval.recordings import examine_all, storage  # noqa: E402
from vista_eval.recordings.storage import find_recordings  # noqa: E402
from vista_eval.recordings.table import SCHEMA, worst_first  # noqa: E402

MEASURED = ("host_ms_median", "host_ms_p99", "total_ms_median")
NAMES = ["car/sequences/00", "cut", "drone", "nothing", "pairs", "site/flown"]


def write_recordings(folder: Path) -> Path:
    cases.make_pairs(folder / "pairs")
    cases.make_flown_pairs(folder / "site" / "flown")
    cases.make_kitti(folder / "car")
    cases.make_asl(folder / "drone")
    cut = cases.make_flown_pairs(folder / "cut") / "scene02_right.png"
    cut.write_bytes(cut.read_bytes()[:500])
    (folder / "nothing").mkdir()
    (folder / "nothing" / "calibration.toml").write_text("focal_px = 1")
    (folder / "notes").mkdir()
    (folder / "notes" / "readme.txt").write_text("no recording")
    return folder


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_recordings(tmp_path_factory.mktemp("recordings"))


def rows_in(out: Path) -> list[dict[str, Any]]:
    table = parquet.read_table(out / "recordings.parquet")
    assert table.schema.equals(SCHEMA)
    return table.to_pylist()


def test_a_warning_of_a_blind_frame_does_not_count() -> None:
    blind = FrameHealth((Finding(Reason.LEFT_RIGHT_SWAPPED, State.BLIND, "swapped"),))
    nearest = Nearest.made(valid=True, id=1, distance_m=9.0, time_to_collision_s=np.nan)
    stage_ms = {"host": 1.0, "total": 2.0}
    seen = fake_record(0, 0, nearest=nearest, stage_ms=stage_ms)
    row = module.figures([seen, replace(seen, index=1, health=blind)])
    assert (row["frames_warned"], row["frames_blind"], row["nearest_warning_m"]) == (1, 1, 9.0)


def without_times(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{key: value for key, value in row.items() if key not in MEASURED} for row in rows]


@pytest.fixture(scope="module")
def in_one_process(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("one")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("builtins.print", lambda *_, **__: None)
        from vista.cli import main

        assert main(["dataset", str(prefix), "--out", str(out), "--jobs", "1"]) == EXIT_OK
    return out


def test_every_recording_is_a_row(prefix: Path, in_one_process: Path) -> None:
    rows = {row["recording"]: row for row in rows_in(in_one_process)}
    assert list(rows) == NAMES
    assert {name for name, row in rows.items() if row["error"]} == {"cut", "nothing"}
    for name in ("car/sequences/00", "drone", "pairs", "site/flown"):
        row = rows[name]
        assert row["frames"] == row["frames_examined"] == cases.FRAMES
        assert row["frames_healthy"] + row["frames_degraded"] + row["frames_blind"] == cases.FRAMES
        assert 0.0 < row["host_ms_median"] <= row["host_ms_p99"]
    assert rows["car/sequences/00"]["layout"] == "KITTI odometry"
    assert rows["site/flown"]["seconds"] == pytest.approx(0.3)
    assert rows["cut"]["error"] == "scene02_right.png: truncated image"
    assert (rows["cut"]["frames"], rows["cut"]["frames_examined"]) == (cases.FRAMES, 2)
    assert (rows["nothing"]["frames_examined"], rows["nothing"]["layout"]) == (0, None)
    files = [path for path in (prefix / "car").rglob("*") if path.is_file()]
    assert rows["car/sequences/00"]["bytes"] == sum(path.stat().st_size for path in files)


def test_only_things_count_as_obstacles(prefix: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three confirmed tracks; neither the ground nor what is too near to match is one more."""
    monkeypatch.setattr("vista.chain.Detector", DescendingDetector)
    row = module.examine(module.Detector("golden", parameters.defaults()), str(prefix), "site/flown")
    assert (row["obstacles_confirmed"], row["error"]) == (3, None)


def test_the_report_has_the_worst_first(in_one_process: Path) -> None:
    page = (in_one_process / "report.html").read_text()
    ordered = [row["recording"] for row in worst_first(rows_in(in_one_process))]
    assert set(ordered[:2]) == {"cut", "nothing"}
    places = [page.index(f"<td>{name}</td>") for name in ordered]
    assert places == sorted(places)
    assert "scene02_right.png: truncated image" in page
    assert "http" not in page


def test_two_processes_find_the_same(
    prefix: Path, in_one_process: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    status, out, err = call_vista(capsys, "dataset", prefix, "--out", tmp_path, "--jobs", 2)
    assert status == EXIT_OK
    assert without_times(rows_in(tmp_path)) == without_times(rows_in(in_one_process))
    assert "6 recordings, 2 with an error" in out
    assert "vista: scene02_right.png: truncated image (cut)" in err.splitlines()
    assert {path.name for path in tmp_path.iterdir()} == {"recordings.parquet", "report.html", "rows"}
    kept = sorted(path.name for path in (tmp_path / "rows").rglob("*.json"))
    assert kept == sorted(path.name for path in (in_one_process / "rows").rglob("*.json"))


def test_only_what_has_changed_is_examined_again(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    prefix, out = write_recordings(tmp_path / "recordings"), tmp_path / "out"
    flown: list[str] = []
    fly = module.fly
    monkeypatch.setattr(module, "fly", lambda *args: (flown.append(args[1].name), fly(*args)))
    command = ("dataset", prefix, "--out", out, "--jobs", 1)
    assert call_vista(capsys, *command)[0] == EXIT_OK
    assert len(flown) == len(NAMES) - 1  # one has nothing to fly
    before = rows_in(out)
    flown.clear()
    (prefix / "pairs").rename(prefix / "renamed")
    assert call_vista(capsys, *command)[0] == EXIT_OK
    assert flown == []
    assert sorted(map(str, without_names(rows_in(out)))) == sorted(map(str, without_names(before)))
    image = prefix / "drone" / "mav0" / "cam0" / "data"
    os.utime(next(image.iterdir()), ns=(0, 0))
    assert call_vista(capsys, *command)[0] == EXIT_OK
    assert flown == ["drone"]


@pytest.mark.parametrize(("engine", "times"), [("golden", 1), ("rtl", 2)])
def test_rows_of_the_simulated_core_are_not_kept(
    prefix: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, engine: str, times: int
) -> None:
    """It is built anew when its sources change, which no digest tells."""
    examined: list[str] = []

    def examine(_: module.Detector, __: str, name: str) -> module.Row:
        examined.append(name)
        return module.row_of(None, [], set()) | {"error": None}

    monkeypatch.setattr(examine_all, "examine", examine)
    detector = module.Detector(engine, parameters.defaults())
    rows = [examine_all.examine_all(detector, str(prefix), HERE, tmp_path) for _ in range(2)]
    assert rows[0] == rows[1] and [row["recording"] for row in rows[0]] == NAMES
    assert examined == NAMES * times


def without_names(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [row | {"recording": None} for row in rows]


def test_an_object_store_gives_the_same_rows(
    prefix: Path, in_one_process: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    store = fsspec.filesystem("memory")
    try:
        for path in prefix.rglob("*"):
            if path.is_file():
                store.pipe_file(f"/bucket/flights/{path.relative_to(prefix)}", path.read_bytes())
        command = ("dataset", "memory://bucket/flights", "--out", tmp_path, "--jobs", 1)
        assert call_vista(capsys, *command)[0] == EXIT_OK
    finally:
        store.store.clear()
        store.pseudo_dirs[:] = [""]
    assert without_times(rows_in(tmp_path)) == without_times(rows_in(in_one_process))


def test_no_file_of_a_store_is_copied_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(storage, "files_of", lambda files, folder: {"../../../../etc/x": {"size": 1}})
    with pytest.raises(InputError, match="has files outside of itself"), storage.as_folder("memory://a", "b"):
        pass


def test_one_recording_may_be_the_prefix(prefix: Path) -> None:
    assert find_recordings(str(prefix / "pairs")) == ["."]


def test_links_are_followed_and_loops_are_not(tmp_path: Path) -> None:
    cases.make_pairs(tmp_path / "elsewhere" / "pairs")
    (tmp_path / "prefix").mkdir()
    (tmp_path / "prefix" / "linked").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "elsewhere" / "back").symlink_to(tmp_path / "prefix")
    (tmp_path / "elsewhere" / "pairs" / "again").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "elsewhere" / "pairs" / "gone").symlink_to(tmp_path / "nowhere")
    assert find_recordings(str(tmp_path / "prefix")) == ["linked/pairs"]
    content = storage.content_of(str(tmp_path / "prefix"), "linked/pairs")
    assert content.bytes >= storage.content_of(str(tmp_path / "elsewhere"), "pairs").bytes > 0


def test_what_breaks_at_one_recording_is_its_row(
    prefix: Path, tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error that nobody has foreseen; it is not kept, so that it goes away with its cause."""
    fly = module.fly

    def breaks(detector: object, sequence: Any, *rest: object) -> None:
        if sequence.name == "drone":
            raise ZeroDivisionError("by zero")
        fly(detector, sequence, *rest)

    monkeypatch.setattr(module, "fly", breaks)
    command = ("dataset", prefix, "--out", tmp_path, "--jobs", 1)
    assert call_vista(capsys, *command)[0] == EXIT_OK
    [row] = [row for row in rows_in(tmp_path) if row["recording"] == "drone"]
    assert row["error"].startswith("ZeroDivisionError at test_dataset_command.py:")
    monkeypatch.setattr(module, "fly", fly)
    assert call_vista(capsys, *command)[0] == EXIT_OK
    assert not any(row["error"] for row in rows_in(tmp_path) if row["recording"] == "drone")


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda folder: folder / "absent", "absent: no such folder"),
        (lambda folder: folder, "holds no recordings"),
        (lambda _: "s3://bucket/flights", "s3://bucket/flights: Install s3fs"),
        (lambda _: "nonsense://bucket", "nonsense://bucket: Protocol not known"),
    ],
)
def test_a_bad_prefix_is_named(make: Any, text: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    assert_refused(call_vista(capsys, "dataset", make(tmp_path), "--out", out), text)
    assert not out.exists()


def test_worst_first() -> None:
    def row(name: str, error: str | None = None, **frames: int) -> dict[str, Any]:
        return {"recording": name, "error": error, "frames_examined": 10} | {
            f"frames_{k}": n for k, n in frames.items()
        }

    rows = [row("b"), row("warned", warned=3), row("blind", blind=1, degraded=0), row("degraded", degraded=9)]
    rows += [row("a"), row("broken", error="broken")]
    shuffled = [rows[k] for k in np.random.default_rng(0).permutation(len(rows))]
    names = [row["recording"] for row in worst_first(json.loads(json.dumps(shuffled)))]
    assert names == ["broken", "blind", "degraded", "warned", "a", "b"]
