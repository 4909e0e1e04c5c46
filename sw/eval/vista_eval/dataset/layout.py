"""The images, poses and calibration of a flight on disk, in the EuRoC ASL layout."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from vista.geometry import quaternion_from_rotation

from vista_eval.dataset.files import write_text
from vista_eval.render.course import BodyState
from vista_eval.render.rig import LEFT, RIGHT, Rig

POSE_COLUMNS = (
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
    "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]"
)


def image_path(flight: Path, camera: int, t_ns: int) -> Path:
    return flight / "mav0" / f"cam{camera}" / "data" / f"{t_ns}.png"


def sensor_yaml(rig: Rig, camera: int, rate_hz: float) -> list[str]:
    u, v = rig.center_px
    data = ", ".join(repr(float(value)) for value in rig.body_from_camera(camera).ravel())
    return [
        "sensor_type: camera",
        f"comment: rendered {'left' if camera == LEFT else 'right'} camera, body x forward, y left, z up",
        "T_BS:",
        "  cols: 4",
        "  rows: 4",
        f"  data: [{data}]",
        f"rate_hz: {rate_hz}",
        f"resolution: [{rig.width_px}, {rig.height_px}]",
        "camera_model: pinhole",
        f"intrinsics: [{rig.focal_px}, {rig.focal_px}, {u}, {v}] #fu, fv, cu, cv",
        "distortion_model: radial-tangential",
        "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]",
    ]


def pose_line(state: BodyState) -> str:
    position, quaternion = (
        state.world_from_body[:3, 3],
        quaternion_from_rotation(state.world_from_body[:3, :3]),
    )
    numbers = [*position, *quaternion, *state.velocity_world_m_s, *np.zeros(6)]
    return ",".join([str(state.t_ns), *(f"{number:.9f}" for number in numbers)])


def write_sequence(flight: Path, rig: Rig, states: list[BodyState], rate_hz: float) -> None:
    """Everything of the ASL layout but the images."""
    for camera in (LEFT, RIGHT):
        folder = flight / "mav0" / f"cam{camera}"
        write_text(folder / "sensor.yaml", sensor_yaml(rig, camera, rate_hz))
        images = [f"{state.t_ns},{state.t_ns}.png" for state in states]
        write_text(folder / "data.csv", ["#timestamp [ns],filename", *images])
    poses = [pose_line(state) for state in states]
    write_text(flight / "mav0" / "state_groundtruth_estimate0" / "data.csv", [POSE_COLUMNS, *poses])
