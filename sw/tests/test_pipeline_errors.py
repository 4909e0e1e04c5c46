"""Bad input to the chain: the right status, the culprit's name, and tracks that stay as they were."""

from __future__ import annotations

import math

import board_flight as scene
import numpy as np
import pytest
from board_flight import board_flight
from pipeline_library import (
    CALIBRATION,
    Frame,
    Pipeline,
    bytes_needed,
    default_camera,
    default_parameters,
    process,
    snapshot,
)
from stage_library import ffi, lib, status_name
from vista.parameters import defaults
from vista.pipeline import Pipeline as PythonPipeline


def bad_frames(source: scene.BoardFrame) -> dict[str, tuple[Frame, str]]:
    """Frames that fail, by what is wrong with them."""

    def broken(**changes) -> Frame:
        frame = Frame(source)
        for name, value in changes.items():
            owner, _, field = name.partition("__")
            if field:
                setattr(getattr(frame.c, owner), field, value)
            else:
                setattr(frame.c, owner, value)
        return frame

    def turned(values: list[float]) -> Frame:
        frame = Frame(source)
        frame.pose.rotation = values
        return frame

    def moved(value: float) -> Frame:
        frame = Frame(source)
        frame.pose.translation_m[1] = value
        return frame

    def said(velocity_m_s: list[float]) -> Frame:
        frame = broken()
        frame.velocity = frame.c.velocity_m_s = ffi.new("double[3]", velocity_m_s)
        return frame

    def up(value: float) -> Frame:
        frame = Frame(source)
        frame.up_world[2] = value
        return frame

    return {
        "image width": (broken(image__width_px=scene.WIDTH - 1), "VISTA_ERROR_SIZE"),
        "image height": (broken(image__height_px=scene.HEIGHT + 1), "VISTA_ERROR_SIZE"),
        "disparity width": (broken(disparity__width_px=scene.WIDTH + 2), "VISTA_ERROR_SIZE"),
        "disparity height": (broken(disparity__height_px=0), "VISTA_ERROR_SIZE"),
        "image stride 0": (broken(image__stride=0), "VISTA_ERROR_SIZE"),
        "image stride 3": (broken(image__stride=3), "VISTA_ERROR_SIZE"),
        "disparity stride": (broken(disparity__stride=scene.WIDTH - 1), "VISTA_ERROR_SIZE"),
        "negative stride": (broken(disparity__stride=1 - scene.WIDTH), "VISTA_ERROR_SIZE"),
        "NaN velocity": (said([0.0, math.nan, 0.0]), "VISTA_ERROR_NUMBER"),
        "velocity of light": (said([0.0, 3e8, 0.0]), "VISTA_ERROR_RANGE"),
        "no image": (broken(image__data=ffi.NULL), "VISTA_ERROR_ARGUMENT"),
        "no disparity": (broken(disparity__data=ffi.NULL), "VISTA_ERROR_ARGUMENT"),
        "earlier": (broken(t_ns=source.t_ns - 2 * scene.PERIOD_NS), "VISTA_ERROR_ORDER"),
        "same time": (broken(t_ns=source.t_ns - scene.PERIOD_NS), "VISTA_ERROR_ORDER"),
        "NaN position": (moved(math.nan), "VISTA_ERROR_NUMBER"),
        "infinite position": (moved(math.inf), "VISTA_ERROR_NUMBER"),
        "NaN rotation": (turned([math.nan] * 9), "VISTA_ERROR_NUMBER"),
        "no rotation": (turned([0.0] * 9), "VISTA_ERROR_RANGE"),
        "a mirror": (turned([1.0, 0, 0, 0, 1.0, 0, 0, 0, -1.0]), "VISTA_ERROR_RANGE"),
        "NaN up": (up(math.nan), "VISTA_ERROR_NUMBER"),
        "up of no length": (up(0.0), "VISTA_ERROR_RANGE"),
    }


@pytest.fixture(scope="module")
def undisturbed() -> list[dict[str, object]]:
    return Pipeline().fly(board_flight()[:8])


@pytest.mark.parametrize("name", bad_frames(scene.render(0)))
def test_a_bad_frame_leaves_everything_as_it_was(name: str, undisturbed: list[dict[str, object]]) -> None:
    pipeline, sources = Pipeline(), board_flight()
    assert pipeline.fly(sources[:4]) == undisturbed[:4]
    frame, expected = bad_frames(sources[4])[name]
    ffi.buffer(pipeline.result)[:] = b"\x5a" * ffi.sizeof("vista_result")
    assert pipeline.process(frame) == expected
    assert bytes(ffi.buffer(pipeline.result)) == b"\x5a" * ffi.sizeof("vista_result")
    assert pipeline.fly(sources[4:8]) == undisturbed[4:]


@pytest.mark.parametrize("name", ["earlier", "image stride 0", "NaN position"])
def test_a_bad_frame_leaves_the_pictures_of_the_last_result(name: str) -> None:
    """What is wrong with a frame is found before anything of the last one is overwritten."""
    pipeline, sources = Pipeline(), board_flight()
    (last,) = pipeline.fly(sources[3:4])
    frame, expected = bad_frames(sources[4])[name]
    frame.c.t_ns = sources[3].t_ns if name == "earlier" else frame.c.t_ns
    assert pipeline.process(frame) == expected
    assert snapshot(pipeline.result) == last


def test_rows_may_run_upwards() -> None:
    sources = board_flight()[:6]
    expected, pipeline = Pipeline().fly(sources), Pipeline()
    for source, undisturbed in zip(sources, expected, strict=True):
        frame = Frame(source)
        for target, array, c_type in (
            (frame.c.image, np.flipud(source.left).copy(), "uint8_t *"),
            (frame.c.disparity, np.flipud(source.words).copy(), "int16_t *"),
        ):
            last_row = array.ctypes.data + (array.shape[0] - 1) * array.strides[0]
            target.data, target.stride = ffi.cast(c_type, last_row), -array.shape[1]
            frame.__dict__.setdefault("kept", []).append(array)
        assert pipeline.process(frame) == "VISTA_OK"
        assert snapshot(pipeline.result) == undisturbed


def test_null_pointers() -> None:
    parameters, camera, size = default_parameters(), default_camera(), ffi.new("size_t *")
    for arguments in ((ffi.NULL, camera, size), (parameters, ffi.NULL, size), (parameters, camera, ffi.NULL)):
        assert lib.vista_pipeline_bytes(*arguments) == lib.VISTA_ERROR_ARGUMENT
    memory, handle = np.zeros(1 << 20, np.uint8), ffi.new("vista_pipeline **")
    start = ffi.cast("void *", memory.ctypes.data)
    arguments = [start, memory.size, parameters, camera, handle]
    for missing in (0, 2, 3, 4):
        holed = [ffi.NULL if k == missing else value for k, value in enumerate(arguments)]
        assert lib.vista_pipeline_create(*holed) == lib.VISTA_ERROR_ARGUMENT
    pipeline, frame = Pipeline(), Frame(board_flight()[0])
    arguments = [pipeline.handle, frame.c, pipeline.result]
    for missing in range(3):
        holed = [ffi.NULL if k == missing else value for k, value in enumerate(arguments)]
        assert process(*holed) == lib.VISTA_ERROR_ARGUMENT


BAD_CAMERAS = {
    "width 15": ({"width_px": 15, "center_u_px": 7.0}, "VISTA_ERROR_SIZE"),
    "height 15": ({"height_px": 15, "center_v_px": 7.0}, "VISTA_ERROR_SIZE"),
    "width 8193": ({"width_px": 8193}, "VISTA_ERROR_SIZE"),
    "width 0": ({"width_px": 0}, "VISTA_ERROR_RANGE"),
    "height -1": ({"height_px": -1}, "VISTA_ERROR_RANGE"),
    "NaN focal length": ({"focal_px": math.nan}, "VISTA_ERROR_NUMBER"),
    "infinite centre": ({"center_v_px": math.inf}, "VISTA_ERROR_NUMBER"),
    "no baseline": ({"baseline_m": 0.0}, "VISTA_ERROR_RANGE"),
    "centre far to the right": ({"center_u_px": 1e12}, "VISTA_ERROR_RANGE"),
    "centre far below": ({"center_v_px": 1e12}, "VISTA_ERROR_RANGE"),
    "centre far above": ({"center_v_px": -1e6}, "VISTA_ERROR_RANGE"),
    "centre beyond twice the width": ({"center_u_px": 2.01 * scene.WIDTH}, "VISTA_ERROR_RANGE"),
    "huge focal length": ({"focal_px": 1e300}, "VISTA_ERROR_RANGE"),
    "tiny focal length": ({"focal_px": 1e-300}, "VISTA_ERROR_RANGE"),
    "huge baseline": ({"baseline_m": 1e300}, "VISTA_ERROR_RANGE"),
    "tiny baseline": ({"baseline_m": 1e-300}, "VISTA_ERROR_RANGE"),
}


@pytest.mark.parametrize("name", BAD_CAMERAS)
def test_bad_cameras(name: str) -> None:
    changes, expected = BAD_CAMERAS[name]
    parameters, camera = default_parameters(), default_camera(**changes)
    assert bytes_needed(parameters, camera)[0] == expected
    memory, handle = np.zeros(1 << 20, np.uint8), ffi.new("vista_pipeline **")
    start = ffi.cast("void *", memory.ctypes.data)
    status = lib.vista_pipeline_create(start, memory.size, parameters, camera, handle)
    assert (status_name(status), handle[0]) == (expected, ffi.NULL)


EDGE_CAMERAS = [
    {"center_u_px": -scene.WIDTH},
    {"center_u_px": 2 * scene.WIDTH, "center_v_px": 2 * scene.HEIGHT},
    {"focal_px": 1e6, "baseline_m": 1e6},
    {"focal_px": 1e-6, "baseline_m": 1e-6},
    {"focal_px": 1e-6, "baseline_m": 1e6},
    {"focal_px": 1e6, "baseline_m": 1e-6},
]


@pytest.mark.parametrize("changes", EDGE_CAMERAS, ids=str)
def test_cameras_at_the_edge_of_what_is_accepted(changes: dict[str, float]) -> None:
    """No crash, no number that fits no type (under sanitizers), whatever comes out."""
    pipeline = Pipeline(camera=default_camera(**changes))
    for source in board_flight()[:3]:
        assert pipeline.process(Frame(source)) == "VISTA_OK"


@pytest.mark.parametrize("size", [(16, 16), (17, 200), (300, 16)])
def test_the_smallest_images(size: tuple[int, int]) -> None:
    width, height = size
    camera = default_camera(width_px=width, height_px=height, center_u_px=width / 2, center_v_px=height / 2)
    source = scene.BoardFrame(
        np.full((height, width), 9, np.uint8), np.full((height, width), 80, np.int16), 0, np.zeros(3)
    )
    assert Pipeline(camera=camera).fly([source])[0]["valid_fraction"] == 1.0


BAD_PARAMETERS = {
    "foveation.sector_count": 15,
    "region.min_size_m": -1.0,
    "tracker.gate_chi2": 0.0,
    "tracker.confirm_hits": 7,  # more than confirm_window
}


@pytest.mark.parametrize("name", BAD_PARAMETERS)
def test_bad_parameters_are_named(name: str) -> None:
    parameters = default_parameters(**{name.replace(".", "__"): BAD_PARAMETERS[name]})
    assert bytes_needed(parameters, default_camera())[0] == "VISTA_ERROR_RANGE"
    culprit = ffi.new("char const **")
    assert lib.vista_parameters_check(parameters, culprit) == lib.VISTA_ERROR_RANGE
    assert ffi.string(culprit[0]).decode() == name
    section, _, field = name.partition(".")
    values = defaults()
    values[section][field] = BAD_PARAMETERS[name]
    with pytest.raises(ValueError, match=f"^{name} is out of range$"):
        PythonPipeline(CALIBRATION, values)


def test_python_refuses_arrays_of_other_types() -> None:
    pipeline, source = PythonPipeline(CALIBRATION), board_flight()[0]
    for left, words in (
        (source.left.astype(np.float32), source.words),
        (source.left, source.words.astype(np.int8)),
        (source.left[..., None], source.words),
    ):
        with pytest.raises(ValueError, match="uint8 and int16"):
            pipeline.process(left, words, 0)
