"""calibration.toml, which `vista run` reads beside pairs of images."""

from __future__ import annotations

from vista.calibration.formats.common import File, Options, Table, floats, intrinsics
from vista.calibration.rig import Rig, rig_of
from vista.errors import InputError
from vista.geometry import CameraModel, Pose
from vista.sequence.pairs import read_body_poses, read_calibration, read_size_px

FILES = (1,)
HAS_UNIT = False
HELP = "calibration.toml"


def recognises(table: Table) -> bool:
    return "right_from_left" in table or "focal_px" in table


def read(files: list[File], options: Options) -> Rig:
    path, table = files[0].path, files[0].table
    size = read_size_px(path, table) or options.size_px
    if size is None:
        raise InputError(
            path, "does not say the size of the images: add size_px = [WIDTH, HEIGHT], or give --size-px"
        )
    raw = read_calibration(path, table, size)
    body = read_body_poses(path, table)
    if body is None:
        return rig_of(raw)
    return Rig(raw.left, raw.right, *body, is_body=True)


def write(rig: Rig, options: Options) -> dict[str, str]:
    return {"calibration.toml": written(rig)}


def written(rig: Rig) -> str:
    """The text of calibration.toml."""
    tables = [
        f"size_px = [{rig.left.width}, {rig.left.height}]\n",
        _camera("left", rig.left),
        _camera("right", rig.right),
        "# p_right = rotation p_left + translation_m",
        _pose("right_from_left", rig.right_from_left),
    ]
    if rig.is_body:
        tables += [
            _pose("body_from_left", rig.frame_from_left),
            _pose("body_from_right", rig.frame_from_right),
        ]
    return "\n".join(tables)


def _camera(name: str, camera: CameraModel) -> str:
    values = zip(("fx_px", "fy_px", "cx", "cy"), intrinsics(camera), strict=True)
    lines = [f"[{name}]", *(f"{key} = {value!r}" for key, value in values)]
    lines.append(f"distortion = {[float(value) for value in camera.distortion]}")
    if camera.lens != "pinhole":
        lines.append(f'lens = "{camera.lens}"')
    return "\n".join(lines) + "\n"


def _pose(name: str, pose: Pose) -> str:
    rows = [floats(row) for row in pose.rotation]
    rotation = ",\n  ".join(", ".join(map(repr, row)) for row in rows)
    return f"[{name}]\nrotation = [\n  {rotation},\n]\ntranslation_m = {floats(pose.translation_m)}\n"
