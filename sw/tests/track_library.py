"""libvista's second half over numpy arrays, for its tests: cameras, poses, detections, trackers and maps."""

from __future__ import annotations

import numpy as np
from stage_library import Arena, default_parameters, ffi, frame_view, lib, status_name

FOCAL, BASELINE, CENTER = 1000.0, 0.4572, (319.5, 239.5)  # the paper's rig
SIGMAS = (1.0, 1.0, 0.25)
SECOND = 1_000_000_000


def parameters_with(section: str, **changes: float):
    """The default vista_parameters with changes in one section. They are not checked."""
    values = default_parameters()
    for name, value in changes.items():
        setattr(getattr(values, section), name, value)
    return values


def camera(width: int = 640, height: int = 480, focal: float = FOCAL, baseline: float = BASELINE):
    return ffi.new("vista_camera *", [width, height, focal, *CENTER, baseline])


MATCHED = {"disparity_max_px": 31.0, "margin_left_px": 36.0, "margin_px": 5.0}  # 32 disparities, block 11


def matched(**changes: float):
    return ffi.new("vista_matched_area *", MATCHED | changes)


def pose(position=(0.0, 0.0, 0.0), rotation=None):
    matrix = np.eye(3) if rotation is None else np.asarray(rotation)
    return ffi.new("vista_pose *", [[float(x) for x in matrix.ravel()], [float(x) for x in position]])


def motion(raw_pose=None, velocity=None, **changes):
    """A vista_motion as that stage would give it; raw_pose: a vista_pose *, None: at the origin."""
    raw_pose = pose() if raw_pose is None else raw_pose
    optical_axis = [raw_pose.rotation[3 * i + 2] for i in range(3)]
    velocity = [0.0, 0.0, 0.0] if velocity is None else [float(x) for x in velocity]
    speed = float(np.linalg.norm(velocity))
    values = {
        "known": True,
        "source": lib.VISTA_MOTION_POSE,
        "pose": raw_pose[0],
        "velocity_m_s": velocity,
        "speed_m_s": speed,
        "direction": [x / speed for x in velocity] if speed >= 0.5 else optical_axis,
    }
    return ffi.new("vista_motion *", values | changes)


def flight_path(raw_motion, length_m: float = 100.0, normal=(0.0, 0.0, 0.0), curvature_1_m: float = 0.0):
    """A vista_flight_path from the camera of that motion on, straight unless told otherwise."""
    start, direction = list(raw_motion.pose.translation_m), list(raw_motion.direction)
    normal = [float(x) for x in normal]
    return ffi.new("vista_flight_path *", [start, direction, normal, curvature_1_m, length_m])


def measure(point, position=(0.0, 0.0, 0.0), rotation=None) -> np.ndarray:
    """(u, v, d) of a world point, written independently of the library."""
    matrix = np.eye(3) if rotation is None else np.asarray(rotation)
    x, y, z = matrix.T @ (np.asarray(point, float) - np.asarray(position, float))
    return np.array([CENTER[0] + FOCAL * x / z, CENTER[1] + FOCAL * y / z, FOCAL * BASELINE / z])


def jacobian(u: float, v: float, d: float) -> np.ndarray:
    """d(X, Y, Z) / d(u, v, d) of the triangulation."""
    du, dv = u - CENTER[0], v - CENTER[1]
    return np.array(
        [
            [BASELINE / d, 0.0, -du * BASELINE / d**2],
            [0.0, BASELINE / d, -dv * BASELINE / d**2],
            [0.0, 0.0, -FOCAL * BASELINE / d**2],
        ]
    )


def detection(measurement, extent=(1.0, 0.8), sigmas=SIGMAS, label: int = 0, cut=(False, False)) -> dict:
    """A detection as a struct initialiser, triangulated here."""
    u, v, d = (float(x) for x in measurement)
    j = jacobian(u, v, d)
    scale = d / BASELINE / 2
    half = sorted((extent[0] * scale, extent[1] * scale), reverse=True)
    return {
        "label": label,
        "u_px": u,
        "v_px": v,
        "disparity_px": d,
        "sigma_u_px": sigmas[0],
        "sigma_v_px": sigmas[1],
        "sigma_disparity_px": sigmas[2],
        "position_camera_m": [
            (u - CENTER[0]) * BASELINE / d,
            (v - CENTER[1]) * BASELINE / d,
            FOCAL * BASELINE / d,
        ],
        "covariance_camera_m2": (j @ np.diag(np.square(sigmas)) @ j.T).ravel().tolist(),
        "extent_m": list(extent),
        "volume_pixels": 100 * (np.hypot(u - CENTER[0], v - CENTER[1]) * BASELINE / d < 2.0),
        "cut_u": cut[0],
        "cut_v": cut[1],
        "ellipse": [u, v, *half, 0.0 if extent[0] >= extent[1] else 90.0],
    }


def seen_at(point, position=(0.0, 0.0, 0.0), rotation=None, **keywords) -> dict:
    return detection(measure(point, position, rotation), **keywords)


CONFIRMATION = {"confirm_hits": 3, "confirm_window": 5}  # whatever the defaults are


class Tracker:
    """One tracker with its memory; `update` answers the status, `tracks` the tracks by id."""

    def __init__(self, max_tracks: int = 32, max_detections: int = 32, **changes: float) -> None:
        out = ffi.new("vista_tracker **")
        self._arena = Arena(lambda arena: lib.vista_tracker_layout(max_tracks, max_detections, arena, out))
        assert self._arena.status == lib.VISTA_OK, status_name(self._arena.status)
        area = {name: changes.pop(name) for name in MATCHED if name in changes}
        self.handle, self._parameters = out[0], parameters_with("tracker", **CONFIRMATION | changes)
        self.params, self.camera, self.matched = self._parameters.tracker, camera(), matched(**area)

    def update(self, t_s: float, detections=(), position=(0.0, 0.0, 0.0), rotation=None, words=None) -> str:
        return self.update_raw(round(t_s * SECOND), detections, motion(pose(position, rotation)), words)

    def update_raw(self, t_ns: int, detections, raw_motion, words=None) -> str:
        """words: (height, width) int16 of the engine, or None."""
        seen = {} if words is None else {"words": words}
        frame = frame_view(
            self._parameters, self.camera, matched=self.matched, motion=raw_motion, t_ns=t_ns, **seen
        )
        items = ffi.new("vista_detection[]", list(detections))
        found = ffi.new("vista_detections *", [items, len(detections), len(detections)])
        return status_name(lib.vista_tracker_update(self.handle, frame, found))

    def raw(self):
        count = ffi.new("int32_t *")
        return lib.vista_tracker_tracks(self.handle, count), count[0]

    @property
    def tracks(self) -> dict[int, object]:
        """Copies, so that they outlive the next update."""
        items, count = self.raw()
        return {items[i].id: ffi.new("vista_track *", items[i]) for i in range(count)}

    @property
    def confirmed(self) -> list[int]:
        return [id_ for id_, track in self.tracks.items() if track.confirmed]

    def memory(self) -> bytes:
        """Everything that the tracker keeps, to the byte."""
        return bytes(ffi.buffer(self._arena.arena.base, self._arena.size))


def state(track) -> tuple[np.ndarray, np.ndarray]:
    mean = np.array([*track.position_m, *track.velocity_m_s])
    return mean, np.array(list(track.covariance)).reshape(6, 6)
