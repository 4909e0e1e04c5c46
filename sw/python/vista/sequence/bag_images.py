"""Images of one topic of a bag: sensor_msgs/Image and sensor_msgs/CompressedImage as 8-bit grey."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.errors import InputError
from vista.sequence.bag_file import Bag
from vista.sequence.image import decode_grey

# Channels, and OpenCV's conversion to grey. ROS names a Bayer pattern by its first pixels.
ENCODINGS: dict[str, tuple[int, int | None]] = {
    "mono8": (1, None),
    "8uc1": (1, None),
    "bgr8": (3, cv2.COLOR_BGR2GRAY),
    "8uc3": (3, cv2.COLOR_BGR2GRAY),
    "rgb8": (3, cv2.COLOR_RGB2GRAY),
    "bgra8": (4, cv2.COLOR_BGRA2GRAY),
    "8uc4": (4, cv2.COLOR_BGRA2GRAY),
    "rgba8": (4, cv2.COLOR_RGBA2GRAY),
    "bayer_rggb8": (1, cv2.COLOR_BayerRGGB2GRAY),
    "bayer_bggr8": (1, cv2.COLOR_BayerBGGR2GRAY),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGBRG2GRAY),
    "bayer_grbg8": (1, cv2.COLOR_BayerGRBG2GRAY),
}


@dataclass(frozen=True)
class Entry:
    t_ns: int  # of the exposure, by the header of the message
    recorded_ns: int
    number: int  # in the order of recording


class ImageTopic:
    """The images are read one after the other; going back starts again at the time of recording."""

    def __init__(self, path: Path, topic: str) -> None:
        """Reads the times of all messages."""
        self.name = f"{path}, topic {topic}"
        self.topic = topic
        self._bag = Bag(path)  # of its own: two topics are read in turns
        self.frame_id = ""
        entries: dict[int, Entry] = {}
        self._first: dict[int, int] = {}  # number of the first message of each time of recording
        count = 0
        for recorded_ns, message in self._bag.messages(topic):
            t_ns = stamp_ns(message.header)
            self.frame_id = message.header.frame_id
            entries.setdefault(t_ns, Entry(t_ns, recorded_ns, count))
            self._first.setdefault(recorded_ns, count)
            count += 1
        if len(entries) < 2 < count:
            raise InputError(self.name, "the headers of its messages have no times")
        self.entries = [entries[t_ns] for t_ns in sorted(entries)]
        repeated = count - len(entries)
        self.notes = (f"{repeated} of {count} images of {topic} repeat a time, and are left out",) * (
            repeated > 0
        )
        self._messages: Iterator[tuple[int, Any]] = iter(())
        self._next = count  # number of the message that comes next

    def read_grey(self, index: int) -> NDArray[np.uint8]:
        """Reads entries[index]."""
        entry = self.entries[index]
        if entry.number < self._next:
            self._messages = self._bag.messages(self.topic, entry.recorded_ns)
            self._next = self._first[entry.recorded_ns]
        for _, message in self._messages:
            self._next += 1
            if self._next > entry.number:
                return grey(f"{self.name}, message {entry.number}", message)
        raise InputError(self.name, f"message {entry.number} is not there any more")


def stamp_ns(header: Any) -> int:
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)


def grey(culprit: str, message: Any) -> NDArray[np.uint8]:
    """InputError for an encoding that is not known, and for data that do not fit the size."""
    if not hasattr(message, "encoding"):
        image = decode_grey(culprit, bytes(message.data))
        pattern = str(message.format).partition(";")[0].strip().lower()
        code = ENCODINGS.get(pattern, (1, None))[1] if pattern.startswith("bayer") else None
        return image if code is None else np.asarray(cv2.cvtColor(image, code), np.uint8)
    encoding = str(message.encoding)
    if encoding.lower() not in ENCODINGS:
        raise InputError(culprit, f"encoding {encoding!r} is not read; known: {', '.join(ENCODINGS)}")
    channels, code = ENCODINGS[encoding.lower()]
    width, height, step = int(message.width), int(message.height), int(message.step)
    data = np.asarray(message.data, np.uint8)
    if width < 1 or height < 1 or step < width * channels or len(data) < height * step:
        raise InputError(
            culprit, f"{len(data)} bytes in rows of {step} are no image of {width}x{height} in {encoding}"
        )
    image = data[: height * step].reshape(height, step)[:, : width * channels]
    if code is None:
        return np.ascontiguousarray(image)
    if channels > 1:
        image = image.reshape(height, width, channels)
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(image), code), np.uint8)
