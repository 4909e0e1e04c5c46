"""Calibration files: VISTA's own and those of other programs.

Each format is a module with `recognises`, `read` and `write`.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np

from vista.calibration.formats import boofcv, euroc, kalibr, opencv, ros, toml
from vista.calibration.formats.common import File, Options
from vista.calibration.rig import Rig
from vista.errors import InputError
from vista.health.checks import BASELINE_M
from vista.rectify import check_side_by_side
from vista.sequence.pairs import read_table as read_toml
from vista.sequence.yaml_file import read_table as read_yaml

FORMATS: dict[str, ModuleType] = {
    "toml": toml,
    "ros": ros,
    "kalibr": kalibr,
    "opencv": opencv,
    "euroc": euroc,
    "boofcv": boofcv,
}


def read_rig(paths: list[Path], options: Options) -> tuple[str, Rig]:
    """The name of the format, which is recognised by the keys of the files, and the pair.

    Raises InputError for what is no calibration of a pair."""
    files = [File(path, _table(path)) for path in paths]
    name = next((name for name in FORMATS if _are(files, name)), None)
    if name is None:
        known = ", ".join(FORMATS)
        reason = f"is no calibration that is known ({known}), or not of one format with the others"
        raise InputError(paths[0], reason)
    module = FORMATS[name]
    if len(files) not in module.FILES:
        expected = " or ".join(map(str, module.FILES))
        raise InputError(
            paths[0], f"files of the format {name}: {len(files)}, expected {expected}: {module.HELP}"
        )
    rig: Rig = module.read(files, options)
    _check(rig, paths[-1], name)
    if options.size_px not in (None, (rig.left.width, rig.left.height)):
        size = f"{rig.left.width}x{rig.left.height}"
        raise InputError("--size-px", f"the images are {size} px, as {paths[0]} says")
    return name, rig


def _are(files: list[File], name: str) -> bool:
    return all(FORMATS[name].recognises(file.table) for file in files)


def _table(path: Path) -> dict[str, object]:
    return read_toml(path) if path.suffix.lower() == ".toml" else read_yaml(path)


def _check(rig: Rig, path: Path, name: str) -> None:
    motion = rig.right_from_left
    baseline_m = float(np.linalg.norm(motion.translation_m))
    lowest, highest = BASELINE_M
    if not lowest <= baseline_m <= highest:
        unit = "; --unit says what lengths in this format are in" if FORMATS[name].HAS_UNIT else ""
        raise InputError(
            path, f"the baseline is {baseline_m:g} m, expected {lowest:g} to {highest:g} m{unit}"
        )
    check_side_by_side(rig.raw(str(path)))


def write_rig(rig: Rig, name: str, options: Options) -> dict[str, str]:
    """Text of each file, by its name. Raises InputError when the format cannot hold this calibration."""
    files: dict[str, str] = FORMATS[name].write(rig, options)
    return files
