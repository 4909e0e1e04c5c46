"""What a run saw and found, for Rerun's viewer: into a file, or to a viewer that runs on this machine."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from vista.chain import Step
from vista.engine import SCALE
from vista.errors import InputError
from vista.geometry import Array, Calibration, Pose, level_world, quaternion_from_rotation, turned
from vista.history import FrameRecord
from vista.output import unwritable
from vista.report.labels import obstacle_name

LOOPBACK = ("127.0.0.1", "localhost", "::1")
CAMERA = "world/camera"
RED, YELLOW = (255, 60, 60), (255, 215, 30)
THICK_M = 0.3  # an obstacle is a board that faces the camera
LEAST_M = 0.05  # what is thinner is not to be seen
FAR_M = 100.0  # the colours of the depths end here


class RerunLog:
    """Writes beside a file's place; leaving the `with` block puts it there."""

    def __init__(self, target: Path | str, name: str, camera: Calibration, up_world: Array | None) -> None:
        """target: a new file, or the address of a viewer on this machine; camera: of the rectified pair.
        Raises InputError when there is something at the path, or nothing can be written there."""
        self._camera, self._up_world = camera, up_world
        self._level: Array | None = None
        self._state, self._frames = "", 0
        self._stream = rr.RecordingStream("vista")
        self._beside: Path | None = None
        self._path: Path | None = None
        if isinstance(target, Path):
            self._path = target
            self._open_file(target)
        else:
            if urlsplit(target).hostname not in LOOPBACK:
                raise InputError(target, "no viewer on this machine: 127.0.0.1 or localhost")
            self._stream.connect_grpc(target)
        self._stream.send_recording_name(name)
        self._stream.send_blueprint(layout())
        self._lens()

    def _open_file(self, path: Path) -> None:
        if path.exists():
            raise InputError(path, "exists; name a new file")
        try:
            self._beside = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}."))
        except OSError as error:
            raise unwritable(path, error) from None
        self._stream.save(self._beside / path.name)

    def __enter__(self) -> RerunLog:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._stream.disconnect()
            whole = self._frames > 0 and (kind is None or issubclass(kind, InputError))
            if whole and self._path is not None and self._beside is not None:
                (self._beside / self._path.name).rename(self._path)
        except OSError as error:
            raise unwritable(Path(str(self._path)), error) from None
        finally:
            if self._beside is not None:
                shutil.rmtree(self._beside, ignore_errors=True)

    def write(self, step: Step, record: FrameRecord, jpeg: bytes | None) -> None:
        """record: with the health of the frame; jpeg: the picture of the frame."""
        frame, log = step.frame, self._stream.log
        self._stream.set_time("frame", sequence=record.index)
        self._stream.set_time("time", timestamp=np.datetime64(record.t_ns, "ns"))
        if frame.world_from_camera is not None:
            pose = self._levelled(frame.world_from_camera)
            log(CAMERA, rr.Transform3D(translation=pose.translation_m, mat3x3=pose.rotation))
        log(f"{CAMERA}/left", rr.Image(frame.left).compress(jpeg_quality=90))
        depth = rr.DepthImage(self._depth_m(step.result.words), meter=1.0, depth_range=(0.0, FAR_M))
        log(f"{CAMERA}/depth", depth)
        self._obstacles(record)
        if jpeg is not None:
            log("overlay", rr.EncodedImage(contents=jpeg, media_type="image/jpeg"))
        self._figures(record)
        self._frames += 1

    def _lens(self) -> None:
        c = self._camera
        self._stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        for view in ("left", "depth"):
            lens = rr.Pinhole(
                focal_length=c.focal_px,
                principal_point=(c.cx, c.cy),
                resolution=(c.width, c.height),
                camera_xyz=rr.ViewCoordinates.RDF,
                image_plane_distance=2.0,
            )
            self._stream.log(f"{CAMERA}/{view}", lens, static=True)

    def _depth_m(self, words: Any) -> Any:
        """0 where nothing was matched."""
        c = self._camera
        depth_m = SCALE * c.focal_px * c.baseline_m / np.maximum(words, 1)
        return np.where(words > 0, depth_m, 0.0).astype(np.float32)

    def _levelled(self, pose: Pose) -> Pose:
        if self._level is None:
            self._level = level_world(self._up_world, pose)
        return Pose(self._level) @ pose

    def _obstacles(self, record: FrameRecord) -> None:
        """Confirmed obstacles as boards, with the ellipsoid of one sigma, in the frame of the camera."""
        camera_from_world = (record.world_from_camera or Pose()).inverse()
        shown = [o for o in record.obstacles if o.confirmed and np.all(np.isfinite(o.position_m))]
        if not shown:
            self._stream.log(f"{CAMERA}/obstacles", rr.Clear(recursive=True))
            return
        centers_m = np.array([camera_from_world.apply(o.position_m) for o in shown])
        colours = [RED if o.in_collision_volume else YELLOW for o in shown]
        sizes_m = [[max(extent_m, LEAST_M) for extent_m in o.extent_m] + [THICK_M] for o in shown]
        labels = [f"{obstacle_name(o.id)} {o.distance_m:.1f} m" for o in shown]
        boards = rr.Boxes3D(centers=centers_m, sizes=np.array(sizes_m), colors=colours, labels=labels)
        self._stream.log(f"{CAMERA}/obstacles/boards", boards)
        sigmas_m, turns = zip(
            *(ellipsoid(turned(o.covariance_m2, camera_from_world)) for o in shown), strict=True
        )
        clouds = rr.Ellipsoids3D(
            centers=centers_m, half_sizes=np.array(sigmas_m), quaternions=np.array(turns), colors=colours
        )
        self._stream.log(f"{CAMERA}/obstacles/one_sigma", clouds)

    def _figures(self, record: FrameRecord) -> None:
        log, nearest = self._stream.log, record.nearest_collision
        if nearest is None:
            log("figures/nearest_m", rr.Clear(recursive=False))
        else:
            log("figures/nearest_m", rr.Scalars([nearest.distance_m]))
        log("figures/path_seen_m", rr.Scalars([record.path_seen_m]))
        for name, value_ms in record.stage_ms.items():
            log(f"figures/ms/{name}", rr.Scalars([value_ms]))
        reasons = "; ".join(finding.text for finding in record.health.findings)
        state = f"{record.health.state}: {reasons}" if reasons else str(record.health.state)
        if state != self._state:
            level = rr.TextLogLevel.INFO if not reasons else rr.TextLogLevel.WARN
            log("health", rr.TextLog(state, level=level))
            self._state = state


def layout() -> rrb.Blueprint:
    """What the viewer shows where, until its user says otherwise."""
    distances = ["figures/nearest_m", "figures/path_seen_m"]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(origin="world", name="from the side"),
            rrb.Vertical(
                rrb.Spatial2DView(origin="overlay", name="frame"),
                rrb.TimeSeriesView(contents=distances, name="nearest collision and seen path, m"),
                rrb.TimeSeriesView(origin="figures/ms", name="times of the stages, ms"),
                rrb.TextLogView(origin="health", name="health"),
                row_shares=[4, 2, 2, 1],
            ),
        ),
        rrb.TimePanel(timeline="frame", state="collapsed"),
        collapse_panels=True,
    )


def ellipsoid(covariance_m2: Array) -> tuple[Array, Array]:
    """Half axes of one sigma and their rotation (x, y, z, w); the least size where there is no covariance."""
    if not np.all(np.isfinite(covariance_m2)):
        return np.full(3, LEAST_M), np.array([0.0, 0.0, 0.0, 1.0])
    variances_m2, axes = np.linalg.eigh(covariance_m2)
    if np.linalg.det(axes) < 0.0:
        axes = -axes
    w, x, y, z = quaternion_from_rotation(axes)
    return np.maximum(np.sqrt(np.maximum(variances_m2, 0.0)), LEAST_M), np.array([x, y, z, w])
