"""Writes the hand-made inputs that the fuzz targets start from into a folder: make_fuzz_corpus.py DIR

sw/fuzz/corpus holds them, and what `make fuzz` has found beside them. They are read by position: after a
change of a target's reader or of the format of recordings, write them anew.
"""

from __future__ import annotations

import struct
import sys
from pathlib import Path

from pymavlink.dialects.v20 import ardupilotmega as dialect
from vista.recording import ANEW, FRAME, HAS_POSE, HAS_UP, HEAD, MAGIC, PARAMETER, VERSION, Content

ENGINE = "<B8HB3HB2HIB"  # parameters, whether they match, columns, rows, bands, what is shown, stride
EYE = (1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0)


def head(
    size: tuple[int, int],
    kind: int,
    content: Content,
    count: int,
    center_px: tuple[float, float],
    stills: bool = False,
) -> bytes:
    """kind: what rectifies raw images; count: of the parameters that follow."""
    rectified, lens = (90.0, *center_px, 0.5), (0.1, -0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    raw = (90.0, 91.0, 8.0, 7.5, *lens, *EYE, int(kind == 2))
    numbers = (*size, kind, 0, content, stills, count)
    return HEAD.pack(MAGIC, VERSION, *numbers, *rectified, *EYE, *raw, b"", b"")


def recording(
    width: int, height: int, frames: int, has_pose: bool, center_px: float, stills: bool = False
) -> bytes:
    """A thing in the middle that comes nearer, over words that grow downwards."""
    given = (b"region.min_size_m", 0.05), (b"foveation.sector_count", 32.0), (b"stereo.levels", 1.0)
    content = head((width, height), 0, Content.LEFT, len(given), (width / 2, center_px), stills)
    content += b"".join(PARAMETER.pack(name, b"", value) for name, value in given)
    for frame in range(frames):
        pose = (*EYE, 0, 0, 0.5 * frame) if has_pose else 12 * (0.0,)
        flags = HAS_UP | HAS_POSE * has_pose | ANEW * stills
        content += FRAME.pack(10**9 + 10**8 * frame, frame, flags, *pose, 0, -1.0, 0)
        thing = [
            [abs(2 * u - width) < width // 2 and 4 < v < height - 4 for u in range(width)]
            for v in range(height)
        ]
        content += bytes(
            (60 if thing[v][u] else 160) + 7 * u * v % 30 for v in range(height) for u in range(width)
        )
        content += b"".join(
            struct.pack("<h", 200 + 12 * frame if thing[v][u] else v)
            for v in range(height)
            for u in range(width)
        )
    return content


def pipeline(camera: bytes, frames: list[bytes]) -> bytes:
    """One changed parameter, and a comparison with a new detector at the end."""
    return camera + bytes([1]) + bytes([30, 0, 128]) + bytes([0]) + b"".join(frames)


def scene(kind: int, words: int, near: int, far: int) -> bytes:
    return struct.pack("<BBIHH", kind, words, 77, near + 32, far + 32)


def camera(flags: int = 0, extra: bytes = b"") -> bytes:
    return struct.pack("<BHHB", flags, 48, 32, 30) + extra


def link(params: bytes, obstacles: int) -> bytes:
    """Two frames, 50 ms apart, of things ahead; health and clock as they come."""
    metres = [struct.pack("<BH", 1, 32768 + 256 * x) for x in (1, 2, 0, 0, 12)]
    things = b"".join(struct.pack("<i", k + 1) + b"".join(metres) for k in range(obstacles))
    frame = (
        bytes([0, 1, 0, obstacles]) + things + bytes([1, 1, 1, 60]) + metres[4] + bytes([1]) + 7 * metres[0]
    )
    return params + (struct.pack("<HBB", 2500, 1, 1) + frame) * 2


def rig(kind: int) -> bytes:
    """16x16 px, rectified by nothing, by a map or by a control grid, and a raw pair."""
    tables = (
        b"",
        struct.pack("<2h", 3, -5) * 256 + struct.pack("<H", 777) * 256,
        struct.pack("<2h", 40, -9) * 4,
    )
    frame = FRAME.pack(10**9, 0, HAS_POSE, *EYE, 0, 0, 0, 0, 0, 0) + bytes(k * k % 251 for k in range(512))
    return head((16, 16), kind, Content.RAW, 0, (8.0, 8.0)) + 2 * tables[kind] + frame


def heard() -> bytes:
    """Half a second of an autopilot, in pieces."""
    link = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    content = b""
    for boot_ms in range(1000, 1500, 50):
        data = dialect.MAVLink_attitude_quaternion_message(boot_ms, 1, 0, 0, 0, 0, 0.1, 0).pack(link)
        data += dialect.MAVLink_local_position_ned_message(boot_ms, 1, 2, 3, 4, 5, 6).pack(link)
        content += struct.pack("<2H", len(data), 2500) + bytes(data) + struct.pack("<H", 20)
    return content


def seeds() -> dict[str, bytes]:
    approach = [bytes([0x01, 0x00]) + scene(1, 1, 200 + 12 * i, 40) for i in range(4)]
    lost_pose = [*approach[:2], bytes([0x00]) + scene(1, 1, 230, 40), approach[3]]
    absurd = struct.pack("<3d", 1e200, 1e200, 1e200)
    return {
        "engine/texture": struct.pack(ENGINE, 0, 1, 3, 1, 30, 1, 15, 2, 0, 1, 13, 5, 1, 1, 6, 3, 7, 0),
        "engine/ties": struct.pack(ENGINE, 0, 2, 0, 0, 62, 0, 0, 0, 0, 1, 19, 3, 2, 2, 3, 0, 9, 1),
        "engine/rows_apart": struct.pack(ENGINE, 0, 1, 0, 1, 30, 0, 15, 2, 0, 1, 17, 5, 3, 3, 5, 0, 8, 2),
        "engine/anything": struct.pack("<BBi", 255, 255, -1) + bytes(range(90)),
        "pipeline/approach": pipeline(camera(), approach),
        "pipeline/pose lost": pipeline(camera(), lost_pose),
        "pipeline/absurd pose": pipeline(
            camera(), [approach[0], bytes([0x01, 0x04]) + scene(1, 1, 220, 40) + absurd]
        ),
        "pipeline/center at 1e12": pipeline(camera(2, struct.pack("<d", 1e12)), approach[:1]),
        "pipeline/center below at 1e12": pipeline(camera(4, struct.pack("<d", 1e12)), approach[:1]),
        "pipeline/stride of 0": pipeline(
            camera(), [bytes([0x02, 0x03]) + scene(1, 1, 200, 40) + struct.pack("<HH", 8, 11)]
        ),
        "mavlink/px4": link(bytes([1, 1]), 2),
        "mavlink/ardupilot": link(bytes([0, 0]) + struct.pack("<BH", 1, 32768 + 256) + bytes([1, 1]), 30),
        "mavlink/anything": bytes(range(256)) * 4,
        "fly/passthrough": b"\0" + rig(0),
        "fly/map": b"\0" + rig(1),
        "fly/grid": b"\0" + rig(2),
        "fly/approach": b"\0" + recording(64, 48, 5, True, 24.0),
        "fly/stills": b"\0" + recording(20, 16, 2, False, 8.0, stills=True),
        "fly/center at 1e12": b"\0" + recording(16, 16, 1, True, 1e12),
        "fly/autopilot": b"\1" + heard(),
    }


def main() -> None:
    for name, content in seeds().items():
        path = Path(sys.argv[1], name.replace(" ", "_"))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


if __name__ == "__main__":
    main()
