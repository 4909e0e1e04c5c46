"""The detector of libvista from end to end (vista/detector.h), which vista-fly runs as well.

A raw pair, its time and the camera's pose go in; what was found and what is wrong with the frame come out."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Sequence
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista import native, parameters
from vista.alignment import Alignment
from vista.control_grid import Grid
from vista.geometry import Array, Pose
from vista.health.finding import Finding, Reason, State
from vista.pipeline import Result, c_parameters, copied_image, destroy, read_result
from vista.rectify import RawCamera, Rectifier
from vista.structs import c_camera, c_image, c_pose, c_vector, names_of

Words = Sequence[NDArray[np.int16]]


class Novelty(IntEnum):
    """What is decided of a pair before it is matched, as vista_novelty numbers it."""

    NEW = 0
    REPEATED = 1  # it says nothing that the pair before did not
    RESTARTED = 2  # what came before was forgotten


class MatchedPair:
    """The rectified pair in work and its words (vista_detector_matched). An image that was not given is
    black. Each is copied when first asked for; after the next pair was taken that raises RuntimeError."""

    def __init__(self, ffi: Any, in_c: Callable[[], Any]) -> None:
        """in_c: gives the struct, as long as the pair is in work."""
        self._ffi, self._in_c = ffi, in_c

    @cached_property
    def left(self) -> NDArray[np.uint8]:
        return self._copied(self._in_c().left, np.uint8)

    @cached_property
    def right(self) -> NDArray[np.uint8]:
        return self._copied(self._in_c().right, np.uint8)

    @cached_property
    def levels(self) -> list[NDArray[np.int16]]:
        """The words of each level, once they were found."""
        pair = self._in_c()
        return [self._copied(words, np.int16) for words in pair.words[0 : pair.levels]]

    def _copied(self, image: Any, dtype: Any) -> NDArray[Any]:
        shape = image.height_px, image.width_px
        if image.data == self._ffi.NULL:
            return np.zeros(shape, dtype)
        return copied_image(self._ffi, image.data, dtype, shape)


class Detector:
    """The detector of one pair of cameras. Its steps are taken in this order: take, match, judge."""

    def __init__(
        self,
        rectifier: Rectifier,
        values: parameters.Values,
        problems: Iterable[Finding] = (),
        stills: bool = False,
        every_pair: bool = True,
        other_words: bool = False,
    ) -> None:
        """problems: what is wrong with the calibration; every_pair: pairs that repeat the one before are
        judged, too; other_words: words come from a matcher that is not that of the contract. Raises
        ValueError for images of a size that is not handled."""
        self._ffi, self._lib = ffi, lib = native.load("vista")
        self._rectifier = rectifier
        self._rig, self._leads_to = c_rig(ffi, rectifier, problems)
        options = ffi.new("vista_detector_options *", (every_pair, stills, other_words, True))
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
        self._taken = 0

    def take(
        self,
        left: NDArray[np.uint8] | None,
        right: NDArray[np.uint8] | None,
        t_ns: int,
        restarts: bool = False,
        rectified: bool = False,
    ) -> Novelty:
        """Looks at a pair, and rectifies it unless it is repeated or is so already. None, both of them: words
        come without images. restarts: it begins another flight."""
        ffi = self._ffi
        whole = {"left": left, "right": right}
        kept = {side: np.ascontiguousarray(image) for side, image in whole.items() if image is not None}
        pair = ffi.new("vista_detector_pair *", {"t_ns": t_ns, "restarts": restarts, "rectified": rectified})
        for side, image in kept.items():
            setattr(pair, side, c_image(ffi, image)[0])
        novelty = ffi.new("vista_novelty *")
        self._taken += 1
        self._check(self._lib.vista_detector_take(self._detector, pair, novelty))
        return Novelty(int(novelty[0]))

    def match(self, words: Words | None = None) -> None:
        """Finds the disparities of the pair with the engine in C, or takes those of each level. Raises
        ValueError for words of another number of levels or of another size."""
        ffi, images = self._ffi, None
        if words is not None:
            levels = [np.ascontiguousarray(level, np.int16) for level in words]
            asked = self._lib.vista_detector_matched_pair(self._detector).levels
            if len(levels) != asked:
                raise ValueError(f"a pair has words of {asked} levels, not of {len(levels)}")
            images = ffi.new("vista_disparity_image[]", [c_image(ffi, level)[0] for level in levels])
        self._check(self._lib.vista_detector_match(self._detector, ffi.NULL if images is None else images))

    def pair(self) -> MatchedPair:
        """The pair in work."""
        taken, matched_pair = self._taken, self._lib.vista_detector_matched_pair

        def in_c() -> Any:
            if self._taken != taken:
                raise RuntimeError("a pair was not kept, and the next one has begun")
            return matched_pair(self._detector)

        return MatchedPair(self._ffi, in_c)

    def judge(self, pose: Pose | None, up_world: Array | None, anew: bool = False) -> Result:
        """Finds the obstacles of the pair that was matched. pose: world_from_camera, rectified; anew: it does
        not continue those before. Raises ValueError for a pose that is not finite and for times that do not
        increase."""
        ffi, place = self._ffi, self._ffi.new("vista_detector_place *", {"anew": anew})
        if pose is not None:
            where = c_pose(ffi, pose)
            place.pose = where
        if up_world is not None:
            up = c_vector(ffi, up_world)
            place.up_world = up
        self._check(self._lib.vista_detector_judge(self._detector, place, self._found))
        outcome, directions = (ffi.addressof(self._found, name) for name in ("result", "directions"))
        taken = self._taken
        return read_result(ffi, self._lib, outcome, directions, lambda: self._taken == taken)

    def reset(self) -> None:
        """Forgets everything: what comes next does not continue what came before."""
        self._lib.vista_detector_reset(self._detector)

    def forget(self) -> None:
        """Forgets the tracks alone, as after a frame that was refused."""
        self._lib.vista_detector_forget(self._detector)

    def state(self) -> bytes:
        """Everything that the detector knows, for `resume`: all of it lies in its memory."""
        return bytes(self._ffi.buffer(self._memory))

    def resume(self, state: bytes) -> None:
        """Goes on from a state of this detector."""
        self._ffi.memmove(self._memory, state, len(state))

    @property
    def in_c(self) -> Any:
        """The vista_detector itself, for what else of libvista asks it."""
        return self._detector

    @property
    def alignment(self) -> Alignment | None:
        """What the pair that was judged says of the alignment of the cameras; None: it is not looked at."""
        return self.rows if self._corrects else None

    @property
    def rows(self) -> Alignment:
        """What the pair that was judged says of the rows of both images, corrected or not."""
        return Alignment.copied(self._ffi, self._ffi.addressof(self._found, "alignment"))

    @property
    def times_ms(self) -> tuple[float, float, float, float]:
        """How long rectifying, matching, the alignment and the watch took."""
        found = self._found
        return found.rectify_ms, found.match_ms, found.alignment_ms, found.watch_ms

    @property
    def shown(self) -> bool:
        """Whether the images that were judged show anything: not the same twice, and not one grey."""
        return bool(self._found.shown)

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
        return None if grids is None else copied_image(self._ffi, table.grid, np.int16, grids.right.shape)

    def rectified_pose(self, pose: Pose) -> Pose:
        """The pose of the rectified left camera from that of the raw one."""
        made = self._lib.vista_rig_rectified_pose(self._rig, c_pose(self._ffi, pose))
        return Pose(np.array(list(made.rotation)).reshape(3, 3), np.array(list(made.translation_m)))

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
