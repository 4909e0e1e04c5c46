"""The detector of libvista from end to end (vista/detector.h), which vista-fly runs as well.

A raw pair, its time and the camera's pose go in; what was found and what is wrong with the frame come out."""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.alignment import Alignment, c_camera, c_images
from vista.control_grid import Grid
from vista.geometry import Array, Pose
from vista.health.finding import Finding, Reason, State
from vista.pipeline import Result, c_parameters, destroy, read_result
from vista.rectify import RawCamera, Rectifier
from vista.structs import names_of

Words = Sequence[NDArray[np.int16]]


class Novelty(IntEnum):
    """What is decided of a pair before it is matched, as vista_novelty numbers it."""

    NEW = 0
    REPEATED = 1  # it says nothing that the pair before did not
    RESTARTED = 2  # what came before was forgotten


class Detector:
    """The detector of one pair of cameras. Its steps are taken in this order: take, match, judge."""

    def __init__(
        self,
        rectifier: Rectifier,
        values: parameters.Values,
        problems: Iterable[Finding] = (),
        stills: bool = False,
        every_pair: bool = True,
    ) -> None:
        """problems: what is wrong with the calibration; every_pair: pairs that repeat the one before are
        judged, too. Raises ValueError for images of a size that is not handled."""
        self._ffi, self._lib = ffi, lib = native.load("vista")
        self._rectifier, camera = rectifier, rectifier.calibration
        self._shape = camera.height, camera.width
        self._rig, self._leads_to = c_rig(ffi, rectifier, problems)
        options = ffi.new("vista_detector_options *", (every_pair, stills, True))
        given = c_parameters(ffi, lib, values), self._rig, options
        size, handle = ffi.new("size_t *"), ffi.new("vista_detector **")
        self._check(lib.vista_detector_bytes(*given, size))
        self._memory = ffi.new("unsigned char[]", size[0])
        self._check(lib.vista_detector_create(self._memory, size[0], *given, handle))
        self._detector = handle[0]
        # A second thread works in this memory, so it ends before that is given back.
        weakref.finalize(self, destroy, lib.vista_detector_destroy, self._detector, self._memory)
        self._found = ffi.new("vista_detector_result *")
        self._corrects = values["alignment"]["correct"] == "on" and not stills
        self._cell_of_pixel: NDArray[np.int32] | None = None

    def take(
        self,
        left: NDArray[np.uint8],
        right: NDArray[np.uint8],
        t_ns: int,
        restarts: bool = False,
        rectified: bool = False,
    ) -> Novelty:
        """Looks at a pair, and rectifies it unless it is repeated or is so already. restarts: it begins
        another flight."""
        ffi = self._ffi
        images = c_images(ffi, left, right)
        pair = ffi.new("vista_detector_pair *", {"t_ns": t_ns, "restarts": restarts, "rectified": rectified})
        pair.left, pair.right = (image[0] for image in images)
        novelty = ffi.new("vista_novelty *")
        self._check(self._lib.vista_detector_take(self._detector, pair, novelty))
        return Novelty(int(novelty[0]))

    def match(self, words: Words | None = None) -> None:
        """Finds the disparities of the pair with the engine in C, or takes those of each level."""
        ffi, images = self._ffi, None
        if words is not None:
            levels = [np.ascontiguousarray(level, np.int16) for level in words]
            images = ffi.new("vista_disparity_image[]", len(levels))
            for image, level in zip(images, levels, strict=True):
                image.data = ffi.cast("int16_t *", level.ctypes.data)
                image.height_px, image.width_px = level.shape
                image.stride = level.shape[1]
        self._check(self._lib.vista_detector_match(self._detector, ffi.NULL if images is None else images))

    def rectified(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """The pair that was taken."""
        pair = self._lib.vista_detector_matched_pair(self._detector)
        return self._copy(pair.left.data, np.uint8, self._shape), self._copy(
            pair.right.data, np.uint8, self._shape
        )

    def levels(self) -> list[NDArray[np.int16]]:
        """The words of each level of the pair that was matched."""
        pair = self._lib.vista_detector_matched_pair(self._detector)
        shapes = [(words.height_px, words.width_px) for words in pair.words[0 : pair.levels]]
        return [self._copy(pair.words[k].data, np.int16, shape) for k, shape in enumerate(shapes)]

    def judge(self, pose: Pose | None, up_world: Array | None, anew: bool = False) -> Result:
        """Finds the obstacles of the pair that was matched. pose: world_from_camera, rectified; anew: it does
        not continue those before. Raises ValueError for a pose that is not finite and for times that do not
        increase."""
        ffi, place = self._ffi, self._ffi.new("vista_detector_place *", {"anew": anew})
        if pose is not None:
            c_pose = self._pose(pose)
            place.pose = c_pose
        if up_world is not None:
            up = ffi.new("double[3]", np.asarray(up_world, float).tolist())
            place.up_world = up
        self._check(self._lib.vista_detector_judge(self._detector, place, self._found))
        outcome, directions = (ffi.addressof(self._found, name) for name in ("result", "directions"))
        result = read_result(ffi, self._lib, outcome, directions, self._cell_of_pixel)
        self._cell_of_pixel = result.cell_of_pixel
        return result

    @property
    def alignment(self) -> Alignment | None:
        """What the pair that was judged says of the alignment of the cameras; None: it is not looked at."""
        if not self._corrects:
            return None
        return Alignment.copied(self._ffi, self._ffi.addressof(self._found, "alignment"))

    @property
    def times_ms(self) -> tuple[float, float, float]:
        """How long rectifying, matching and the alignment took."""
        return self._found.rectify_ms, self._found.match_ms, self._found.alignment_ms

    @property
    def shown(self) -> bool:
        """Whether the images that were judged show anything: not the same twice, and not one grey."""
        blinding = (Reason.NO_CONTRAST, Reason.IMAGES_IDENTICAL)
        own = self.findings()[: self._found.next_finding]
        return not any(finding.reason in blinding for finding in own)

    def findings(self, besides: Iterable[Finding] = ()) -> tuple[Finding, ...]:
        """What is wrong with the frame that was judged, with what was found besides."""
        ffi = self._ffi
        texts = []
        for finding in besides:
            texts += [ffi.new("char[]", text.encode()) for text in (str(finding.reason), finding.text)]
            state = names_of("health_state").index(finding.state)
            self._lib.vista_detector_add(self._found, ffi.new("vista_finding *", (state, *texts[-2:])))
        return tuple(
            Finding(
                Reason(ffi.string(found.reason).decode()),
                State(names_of("health_state")[found.state]),
                ffi.string(found.text).decode(),
            )
            for found in self._found.findings[0 : self._found.finding_count]
        )

    def right_grid(self) -> Grid | None:
        """The control grid by which right images are rectified now; None: a map does it."""
        table = self._lib.vista_detector_right_table(self._detector)
        grids = self._rectifier.grids
        return None if grids is None else self._copy(table.grid, np.int16, grids.right.shape)

    def rectified_pose(self, pose: Pose) -> Pose:
        """The pose of the rectified left camera from that of the raw one."""
        made = self._lib.vista_rig_rectified_pose(self._rig, self._pose(pose))
        return Pose(np.array(list(made.rotation)).reshape(3, 3), np.array(list(made.translation_m)))

    def _pose(self, pose: Pose) -> Any:
        return self._ffi.new("vista_pose *", (pose.rotation.ravel().tolist(), pose.translation_m.tolist()))

    def _copy(self, pointer: Any, kind: Any, shape: tuple[int, ...]) -> NDArray[Any]:
        size = int(np.prod(shape)) * np.dtype(kind).itemsize
        return np.frombuffer(self._ffi.buffer(pointer, size), kind).reshape(shape).copy()

    def _check(self, status: int) -> None:
        native.check(self._ffi, self._lib, status)


def c_rig(ffi: Any, rectifier: Rectifier, problems: Iterable[Finding]) -> tuple[Any, list[Any]]:
    """vista_rig, and what it leads to."""
    cameras = {
        "camera": c_camera(ffi, rectifier.calibration)[0],
        "right": c_raw_camera(ffi, rectifier.right)[0],
    }
    rig = ffi.new("vista_rig *", cameras)
    rig.rectify_rows = rectifier.buffer_rows
    rig.left_from_rectified = rectifier.left_from_rectified.rotation.ravel().tolist()
    tables: list[dict[str, NDArray[Any]]] = [{}, {}]
    if rectifier.grids is not None:
        tables = [{"grid": grid} for grid in (rectifier.grids.left, rectifier.grids.right)]
    elif rectifier.maps:
        tables = [{"whole": whole, "fraction": fraction} for whole, fraction in rectifier.maps]
    kept: list[Any] = []
    for table, members in zip(rig.tables, tables, strict=True):
        for name, values in members.items():
            kept.append(np.ascontiguousarray(values))
            kind = "uint16_t *" if name == "fraction" else "int16_t *"
            setattr(table, name, ffi.cast(kind, kept[-1].ctypes.data))
    for problem in problems:
        kept.append(ffi.new("char[]", problem.text.encode()))
        name = "baseline" if problem.reason == Reason.BASELINE_IMPLAUSIBLE else "calibration"
        setattr(rig, f"{name}_problem", kept[-1])
    return rig, kept


def c_raw_camera(ffi: Any, camera: RawCamera) -> Any:
    """vista_raw_camera."""
    rotation = camera.rectified_from_raw.ravel().tolist()
    return ffi.new("vista_raw_camera *", (camera.lens, *camera.intrinsics_px, camera.distortion, rotation))
