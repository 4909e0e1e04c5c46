"""A ROS 1 bag, a ROS 2 bag (sqlite3 or MCAP) or a single MCAP file, by topic, through the package rosbags."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vista.errors import InputError
from vista.version import installing

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

STORAGES = (".db3", ".mcap")  # of ROS 2


class Bag:
    """Messages are objects of rosbags with the fields of their type. All its errors become InputError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with reported(path):
            self._reader = _open(_storage_of(path))
        connections = self._reader.connections
        self.types = {one.topic: one.msgtype for one in connections if one.msgcount != 0}
        self._empty = {one.topic: one.msgtype for one in connections if one.topic not in self.types}

    def topics(self, *types: str) -> list[str]:
        """Those with messages of one of the types, such as sensor_msgs/msg/Image."""
        return sorted(topic for topic, of_topic in self.types.items() if of_topic in types)

    def listed(self, *types: str) -> str:
        """The topics of these types for a message to people, with those that hold nothing."""
        empty = sorted(topic for topic, of_topic in self._empty.items() if of_topic in types)
        return ", ".join([*self.topics(*types), *(f"{topic} (empty)" for topic in empty)]) or "none"

    def messages(self, topic: str, start_ns: int | None = None) -> Iterator[tuple[int, Any]]:
        """(time of recording, message) in the order of recording; start_ns: from this time on.

        InputError if there are none, whatever the index of the bag says."""
        empty = True
        connections = [c for c in self._reader.connections if c.topic == topic]
        with reported(self.path, topic):
            for connection, recorded_ns, data in self._reader.messages(connections, start=start_ns):
                empty = False
                yield recorded_ns, self._reader.deserialize(data, connection.msgtype)
        if empty:
            raise InputError(f"{self.path}, topic {topic}", "has no messages")


@contextmanager
def reported(path: Path, topic: str | None = None) -> Iterator[None]:
    """rosbags and the decoders below it raise whatever they meet in a damaged file."""
    try:
        yield
    except InputError:
        raise
    except ModuleNotFoundError:
        raise InputError(path, f"reading bags needs the extra [bags]: {installing('bags')}") from None
    except Exception as error:
        where = path if topic is None else f"{path}, topic {topic}"
        text = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(where, f"not readable as a bag: {text}") from None


def _storage_of(path: Path) -> Path:
    """The folder of a ROS 2 bag has metadata.yaml; where that was lost, its only file will do."""
    if path.is_file() and path.stat().st_size == 0:
        raise InputError(path, "empty file")
    if path.is_dir() and path.suffix == ".bag":  # rosbags goes by the name
        raise InputError(path, "a folder named .bag is taken for a file of ROS 1; rename it")
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return path
    files = sorted(p for p in path.iterdir() if p.suffix in STORAGES)
    if len(files) != 1:
        raise InputError(path / "metadata.yaml", "no such file; without it, name one file of the bag")
    return files[0]


def _open(path: Path) -> AnyReader:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    # Bags of early ROS 2 have no message definitions; the types that are read have not changed since.
    reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
    reader.open()
    return reader
