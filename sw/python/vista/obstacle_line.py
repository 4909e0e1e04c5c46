"""One line of obstacles.jsonl: the obstacle map of a frame as JSON, described in obstacles.schema.json.

libvista writes it (vista/line.h), here as in vista-fly."""

from __future__ import annotations

from pathlib import Path

from vista import native
from vista.history import FrameRecord
from vista.structs import names_of


def schema_text() -> str:
    """The JSON Schema (draft 2020-12) of a line."""
    return Path(__file__).with_name("obstacles.schema.json").read_text(encoding="utf-8")


def version() -> int:
    """The number that the lines carry."""
    return int(native.load("vista")[1].VISTA_LINE_VERSION)


def obstacle_line(record: FrameRecord, all_tracks: bool = False) -> str:
    """The line without its break. all_tracks: also the tracks that are not confirmed."""
    ffi, lib = native.load("vista")
    reasons = [ffi.new("char[]", str(reason).encode()) for reason in record.health.reasons]
    state = names_of("health_state").index(record.health.state)
    health = ffi.new("vista_line_health *", (state, len(reasons), reasons))
    capacity, length = int(lib.VISTA_LINE_BYTES), ffi.new("size_t *")
    while True:
        text = ffi.new("char[]", capacity)
        about = (record.index, record.t_ns, all_tracks)
        status = lib.vista_line_write(*record.in_c(), health, *about, text, capacity, length)
        if status != lib.VISTA_ERROR_MEMORY:
            break
        capacity *= 2
    native.check(ffi, lib, status)
    return bytes(ffi.buffer(text, length[0] - 1)).decode()
