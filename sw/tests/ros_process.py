"""The node of ROS 2 and a bridge to its topics, processes of their own on the loopback interface."""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import Any

import pytest
from bag_cases import BagWriter
from rosbags.typesys import Stores, get_typestore
from shared_data import REPOSITORY

PYTHON = REPOSITORY / "build" / "tools" / "ros" / "bin" / "python"
READY_S = 60.0
STORE = get_typestore(Stores.ROS2_KILTED)
MAKE = BagWriter(None, STORE, is1=False)  # of single messages

needs_ros = pytest.mark.skipif(
    "VISTA_TEST_ROS" not in os.environ or not PYTHON.exists(), reason="`make test-ros` runs it, with ROS 2"
)


def environment(folder: Path) -> dict[str, str]:
    """folder: for the logs of ROS."""
    own = {
        "ROS_DOMAIN_ID": str(1 + os.getpid() % 100),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",  # that of the profile: this machine alone
        "FASTDDS_DEFAULT_PROFILES_FILE": str(REPOSITORY / "sw" / "python" / "vista" / "ros" / "loopback.xml"),
        "ROS_LOG_DIR": str(folder / "log"),
    }
    return os.environ | own


class Process:
    def __init__(self, folder: Path, *arguments: object) -> None:
        self.lines: Queue[str] = Queue()  # of stdout
        self.errors: list[str] = []
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(
            [PYTHON, *map(str, arguments)],
            env=environment(folder), stdin=pipe, stdout=pipe, stderr=pipe, text=True,
        )  # fmt: skip
        self._readers = [
            Thread(target=self._read, args=(self.process.stdout, self.lines.put), daemon=True),
            Thread(target=self._read, args=(self.process.stderr, self.errors.append), daemon=True),
        ]
        for reader in self._readers:
            reader.start()

    @staticmethod
    def _read(stream: Any, take: Callable[[str], None]) -> None:
        for line in stream:
            take(line.rstrip("\n"))

    def stop(self, number: int = signal.SIGINT) -> int:
        self.process.send_signal(number)
        try:
            status = self.process.wait(READY_S)
        finally:
            self.process.kill()
        for reader in self._readers:
            reader.join(READY_S)
        return status

    def end(self) -> None:
        """Ends the process without a kill if it can: one that is killed leaves its shared memory behind, 64
        MiB."""
        if self.process.poll() is None:
            self.ask_to_end()
        try:
            self.process.wait(READY_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def ask_to_end(self) -> None:
        self.process.send_signal(signal.SIGINT)

    def kill(self) -> list[Path]:
        """Returns the shared memory that it leaves behind, and that of those it talked to."""
        maps = Path(f"/proc/{self.process.pid}/maps").read_text()
        self.process.kill()
        self.process.wait()
        return [Path(name) for name in set(re.findall(r"/dev/shm/fastdds_\w+", maps))]

    def says(self, text: str) -> None:
        """Waits for a line on stderr that holds the text."""
        until(lambda: any(text in line for line in list(self.errors)), lambda: f"{text!r}: {self.errors}")


def until(condition: Callable[[], bool], state: Callable[[], object] = str) -> None:
    deadline = time.monotonic() + READY_S
    while not condition():
        assert time.monotonic() < deadline, state()
        time.sleep(0.01)


class Bridge(Process):
    """Messages are those of rosbags."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, Path(__file__).with_name("ros_bridge.py"))
        self.heard: dict[str, list[Any]] = {}
        self._types: dict[str, str] = {}
        self._matched: set[str] = set()

    def ask_to_end(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.close()

    def hear(self, topic: str, kind: str) -> None:
        """Returns once the node publishes there."""
        self._types[topic], self.heard[topic] = kind, []
        self._say(hear=topic, type=kind)
        self._await(lambda: topic in self._matched)

    def publish(self, topic: str, message: Any) -> None:
        """Returns, the first time, once the node has subscribed."""
        kind = message.__msgtype__
        if topic not in self._matched:
            self._say(publish=topic, type=kind, data="")
            self._await(lambda: topic in self._matched)
            time.sleep(SETTLED_S)
        data = base64.b64encode(STORE.serialize_cdr(message, kind)).decode()
        self._say(publish=topic, type=kind, data=data)

    def wait_for(self, topic: str, count: int, counts: Callable[[Any], bool] = lambda _: True) -> None:
        """Messages in all that count."""
        self._await(lambda: sum(map(counts, self.heard[topic])) >= count)

    def wait_until(self, topic: str, condition: Callable[[Any], bool]) -> None:
        self._await(lambda: any(map(condition, self.heard[topic])))

    def _say(self, **what: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(what) + "\n")
        self.process.stdin.flush()

    def _await(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + READY_S
        while not condition():
            try:
                said = json.loads(self.lines.get(timeout=max(deadline - time.monotonic(), 0.0)))
            except Empty:
                counts = {topic: len(messages) for topic, messages in self.heard.items()}
                raise AssertionError(f"nothing comes: {counts}, {self.errors}") from None
            if "matched" in said:
                self._matched.add(said["matched"])
            else:
                topic = said["heard"]
                message = STORE.deserialize_cdr(base64.b64decode(said["data"]), self._types[topic])
                self.heard[topic].append(message)


SETTLED_S = 0.3  # the other side may learn of a match a little later


@contextmanager
def running_node(folder: Path, *ros_arguments: str) -> Iterator[Process]:
    node = Process(folder, "-m", "vista", "ros", "--ros-args", *ros_arguments)
    try:
        yield node
    finally:
        node.end()


@contextmanager
def running_bridge(folder: Path) -> Iterator[Bridge]:
    bridge = Bridge(folder)
    try:
        yield bridge
    finally:
        bridge.end()
