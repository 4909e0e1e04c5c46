"""The detector from raw pair to line (vista/detector.h), and rectification (vista/rig.h)."""

from __future__ import annotations

import functools
import json
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from random_seed import seeded
from stage_library import default_parameters, ffi, lib, status_name

WIDTH, HEIGHT, STEP_NS = 320, 240, 40_000_000
Image = NDArray[np.uint8]


def image_of(array: NDArray[Any] | None, kind: str = "vista_image") -> Any:
    """The array has to outlive what is made of it."""
    if array is None:
        return ffi.new(f"{kind} *")
    height, width = array.shape
    item = "uint8_t *" if kind == "vista_image" else "int16_t *"
    return ffi.new(
        f"{kind} *", (ffi.cast(item, array.ctypes.data), width, height, array.strides[0] // array.itemsize)
    )


@functools.cache
def wall(seed: int, disparity_px: int = 12) -> tuple[Image, Image]:
    """A textured wall across both images."""
    texture = seeded(seed).integers(0, 256, (HEIGHT, WIDTH + disparity_px), np.uint8)
    texture = np.asarray(cv2.GaussianBlur(texture, (0, 0), 1.5), np.uint8)
    texture = np.asarray(cv2.normalize(texture, None, 0, 255, cv2.NORM_MINMAX), np.uint8)
    return np.ascontiguousarray(texture[:, :WIDTH]), np.ascontiguousarray(texture[:, disparity_px:])


def rig(**changes: Any) -> Any:
    r = ffi.new("vista_rig *")
    r.camera = (WIDTH, HEIGHT, 300.0, 159.5, 119.5, 0.5)
    r.left_from_rectified = r.right.rectified_from_raw = np.eye(3).ravel().tolist()
    r.right.focal_u_px = r.right.focal_v_px = 300.0
    r.right.center_u_px, r.right.center_v_px = 159.5, 119.5
    for name, value in changes.items():
        setattr(r, name, value)
    return r


class Detector:
    """A detector in memory that begins at an odd address, with bytes behind it that nobody may write to."""

    def __init__(self, the_rig: Any = None, parameters: Any = None, **options: bool) -> None:
        self.rig, parameters = the_rig or rig(), parameters or default_parameters()
        chosen, size = ffi.new("vista_detector_options *", options), ffi.new("size_t *")
        self.status = lib.vista_detector_bytes(parameters, self.rig, chosen, size)
        if self.status != lib.VISTA_OK:
            return
        self.size = size[0]
        self.memory = ffi.new("unsigned char[]", self.size + 65)
        self.memory[1 + self.size : self.size + 65] = b"\xa5" * 64
        handle = ffi.new("vista_detector **")
        self.status = lib.vista_detector_create(
            self.memory + 1, self.size, parameters, self.rig, chosen, handle
        )
        self.handle = handle[0]
        self.result, self.t_ns = ffi.new("vista_detector_result *"), 0

    def take(self, pair: tuple[Image, Image | None], t_ns: int | None = None, **more: bool) -> str:
        self.t_ns = self.t_ns + STEP_NS if t_ns is None else t_ns
        images, novelty = [image_of(side) for side in pair], ffi.new("vista_novelty *")
        c = ffi.new(
            "vista_detector_pair *", {"left": images[0][0], "right": images[1][0], "t_ns": self.t_ns} | more
        )
        status = lib.vista_detector_take(self.handle, c, novelty)
        names = {
            lib.VISTA_PAIR_NEW: "new",
            lib.VISTA_PAIR_REPEATED: "repeated",
            lib.VISTA_PAIR_RESTARTED: "anew",
        }
        return names[novelty[0]] if status == lib.VISTA_OK else status_name(status)

    def match(self, words: list[NDArray[np.int16]] | None = None) -> str:
        given = ffi.NULL
        if words is not None:
            given = ffi.new(
                "vista_disparity_image[]", [image_of(w, "vista_disparity_image")[0] for w in words]
            )
        return status_name(lib.vista_detector_match(self.handle, given))

    def judge(self, posed: bool = True, **more: bool) -> str:
        pose = ffi.new("vista_pose *", (np.eye(3).ravel().tolist(), [0.0, 0.0, 1e-9 * self.t_ns]))
        place = ffi.new("vista_detector_place *", {"pose": pose if posed else ffi.NULL} | more)
        return status_name(lib.vista_detector_judge(self.handle, place, self.result))

    def words(self) -> list[NDArray[np.int16]]:
        matched = lib.vista_detector_matched_pair(self.handle)
        levels = [matched.words[k] for k in range(matched.levels)]
        assert all(w.stride == w.width_px for w in levels)
        return [
            np.frombuffer(ffi.buffer(w.data, 2 * w.width_px * w.height_px), np.int16)
            .reshape(w.height_px, w.width_px)
            .copy()
            for w in levels
        ]

    def line(self) -> dict[str, Any]:
        room, length = ffi.new("char[]", lib.VISTA_LINE_BYTES), ffi.new("size_t *")
        status = lib.vista_detector_write_line(self.result, 7, self.t_ns, True, room, len(room), length)
        assert status == lib.VISTA_OK
        line: dict[str, Any] = json.loads(ffi.string(room))
        del line["processing_ms"]
        return line

    def reasons(self) -> list[str]:
        r = self.result
        names = [ffi.string(r.findings[k].reason).decode() for k in range(r.finding_count)]
        assert names == [ffi.string(r.health.reasons[k]).decode() for k in range(r.health.reason_count)]
        return names

    def frame(self, pair: tuple[Image, Image | None], **place: bool) -> list[str]:
        """The whole of a new pair; what is wrong with it."""
        assert self.take(pair) == "new"
        assert (self.match(), self.judge(**place)) == ("VISTA_OK", "VISTA_OK")
        return self.reasons()

    def close(self) -> None:
        assert bytes(self.memory[1 + self.size : self.size + 65]) == b"\xa5" * 64
        lib.vista_detector_destroy(self.handle)


def test_words_from_elsewhere_give_the_same_line() -> None:
    own, other = Detector(), Detector()
    for seed in range(3):
        pair = wall(seed)
        own.frame(pair)
        words = own.words()
        assert [w.shape for w in words] == [(240, 320), (120, 160), (60, 80)]
        middle = words[0][20:-20, 60:-20]
        assert np.mean(np.abs(middle - 12 * 16) <= 2) > 0.9
        assert other.take(pair) == "new"
        assert (other.match(words), other.judge()) == ("VISTA_OK", "VISTA_OK")
        assert other.line() == own.line()
    own.close()
    other.close()


def test_a_pair_that_repeats_says_nothing() -> None:
    detector = Detector()
    one, two = wall(1), wall(2)
    assert [detector.take(one, 100), detector.take(two, 100), detector.take(one, 200)] == ["new"] + 2 * [
        "repeated"
    ]
    assert detector.match() == "VISTA_ERROR_ARGUMENT"  # there is no pair in work
    assert detector.take((one[0], two[1]), 300) == "new"
    assert detector.take(two, 250) == "anew"  # the time went back
    assert detector.take(two, 300, restarts=True) == "anew"
    detector.close()


def test_a_recording_played_patiently_repeats_nothing() -> None:
    detector = Detector(every_pair=True)
    assert [detector.take(wall(1), t_ns) for t_ns in (100, 200, 200, 100)] == ["new", "new", "new", "anew"]
    detector.close()


def test_stills_are_judged_by_themselves() -> None:
    flown, still = Detector(), Detector(stills=True)
    confirmed = []
    for detector in (flown, still):
        detector.frame(wall(1), posed=False)
        confirmed.append(any(o["confirmed"] for o in detector.line()["obstacles"]))
        assert detector.take(wall(1)) == ("repeated" if detector is flown else "new")
        detector.close()
    assert confirmed == [False, True]


def test_findings_come_in_one_order() -> None:
    texts = [ffi.new("char[]", text) for text in (b"5000 m", b"far from the centre")]
    the_rig = rig(baseline_problem=texts[0], calibration_problem=texts[1])
    detector = Detector(the_rig)
    of_rig = ["baseline_implausible", "calibration_misfit"]
    assert detector.frame(wall(1), posed=False)[:3] == [*of_rig, "motion_unknown"]
    assert detector.frame(wall(2))[:2] == of_rig
    assert detector.frame((wall(3)[0], wall(3)[0]))[:3] == [*of_rig, "images_identical"]
    grey = np.full((HEIGHT, WIDTH), 128, np.uint8)
    assert detector.frame((wall(4)[0], grey))[:3] == [*of_rig, "no_contrast"]
    text = ffi.string(detector.result.findings[2].text).decode()
    assert text == "the right image is nearly constant: grey level 128 +- 0.0"
    assert detector.frame(wall(5), anew=True)[:3] == [*of_rig, "pose_jump"]
    detector.close()


def test_what_a_program_finds_stands_before_what_the_pipeline_finds() -> None:
    detector = Detector(motion_watched=True)
    grey = np.full((HEIGHT, WIDTH), 128, np.uint8)
    assert detector.frame((grey, wall(1)[0]), posed=False) == ["no_contrast", "no_disparities"]
    names = [ffi.new("char[]", name) for name in (b"moments_differ", b"no_disparities", b"moments_differ")]
    for name in names:
        finding = ffi.new("vista_finding *", (lib.VISTA_HEALTH_DEGRADED, name, name))
        lib.vista_detector_add(detector.result, finding)
    assert detector.reasons() == ["no_contrast", "moments_differ", "no_disparities"]
    assert detector.result.findings[2].state == lib.VISTA_HEALTH_DEGRADED
    assert detector.result.health.state == lib.VISTA_HEALTH_BLIND
    detector.close()


def test_a_left_image_alone_takes_words_from_elsewhere() -> None:
    full, left = Detector(), Detector()
    pair = wall(1)
    full.frame(pair)
    assert (left.take((pair[0], None)), left.match()) == ("new", "VISTA_ERROR_ARGUMENT")
    assert (left.match(full.words()), left.judge()) == ("VISTA_OK", "VISTA_OK")
    assert left.line() == full.line()
    full.close()
    left.close()


def test_words_without_images_are_degraded() -> None:
    """What no image tells is not called healthy; the words alone tell of the wall all the same."""
    full, alone = Detector(), Detector(motion_watched=True)
    for seed in range(8):
        full.frame(wall(seed))
        assert alone.take((None, None)) == "new" and alone.match() == "VISTA_ERROR_ARGUMENT"
        assert (alone.match(full.words()), alone.judge()) == ("VISTA_OK", "VISTA_OK")
        reasons = alone.reasons()
        assert "image_missing" in reasons and "no_contrast" not in reasons
        assert alone.result.health.state == lib.VISTA_HEALTH_DEGRADED
        assert set(reasons) - {"image_missing"} <= set(full.reasons())
    assert alone.line()["nearest_collision"]["distance_m"] == pytest.approx(12.5, rel=0.05)
    matched = lib.vista_detector_matched_pair(alone.handle)
    assert (matched.left.data, matched.right.data) == (ffi.NULL, ffi.NULL)
    assert alone.take((None, None), alone.t_ns) == "repeated"
    # Nothing tells whether the camera moves.
    assert alone.take((None, None), restarts=True) == "anew"
    assert (alone.match(full.words()), alone.judge(posed=False)) == ("VISTA_OK", "VISTA_OK")
    assert "motion_unknown" in alone.reasons()
    full.close()
    alone.close()


def test_an_image_that_is_forgotten_is_refused() -> None:
    detector, pair = Detector(), wall(1)
    assert detector.take((None, pair[1])) == "VISTA_ERROR_ARGUMENT"
    c, novelty = ffi.new("vista_detector_pair *", {"t_ns": 1}), ffi.new("vista_novelty *")
    c.left = image_of(pair[0])[0]
    c.left.data = ffi.NULL
    assert lib.vista_detector_take(detector.handle, c, novelty) == lib.VISTA_ERROR_ARGUMENT
    detector.close()


def test_refusals() -> None:
    detector, pair = Detector(), wall(1)
    assert detector.judge() == "VISTA_ERROR_ARGUMENT"
    assert detector.take((pair[0][:-1], pair[1])) == "VISTA_ERROR_SIZE"
    assert detector.take(pair) == "new"
    words = [np.zeros(shape, np.int16) for shape in ((240, 320), (120, 160), (61, 80))]
    assert detector.match(words) == "VISTA_ERROR_SIZE"
    assert (detector.match(), detector.judge(), detector.judge()) == (
        2 * ("VISTA_OK",) + ("VISTA_ERROR_ARGUMENT",)
    )
    detector.close()
    assert status_name(Detector(rig(rectify_rows=16)).status) == "VISTA_ERROR_RANGE"
    assert status_name(Detector(rig(camera=(8, 8, 300.0, 4.0, 4.0, 0.5))).status) == "VISTA_ERROR_SIZE"
    contradictory = default_parameters()
    contradictory.tracker.confirm_hits = 1 + contradictory.tracker.confirm_window
    for stills in (False, True):  # stills, which are confirmed at once, too
        refused = Detector(parameters=contradictory, stills=stills)
        assert status_name(refused.status) == "VISTA_ERROR_RANGE"


# ---- rectification ----


@pytest.mark.parametrize("width", [WIDTH, 61])
def test_a_map_is_followed_as_opencv_follows_it(width: int) -> None:
    random = seeded(3)
    raw = random.integers(0, 256, (HEIGHT, width + 7), np.uint8)[:, :width]
    whole = np.stack(
        [random.integers(-3, width + 3, (HEIGHT, width)), random.integers(-3, HEIGHT + 3, (HEIGHT, width))],
        -1,
    ).astype(np.int16)
    fraction = random.integers(0, 1024, (HEIGHT, width)).astype(np.uint16)
    expected = cv2.remap(raw, whole, fraction, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    table = ffi.new("vista_right_table *")
    table.whole, table.fraction = ffi.from_buffer("int16_t[]", whole), ffi.from_buffer("uint16_t[]", fraction)
    camera, out = ffi.new("vista_camera *", (width, HEIGHT, 300.0, 0.0, 0.0, 0.5)), np.empty_like(expected)
    assert lib.vista_rectify(camera, table, image_of(raw), ffi.from_buffer("uint8_t[]", out)) == lib.VISTA_OK
    assert np.array_equal(out, expected)
