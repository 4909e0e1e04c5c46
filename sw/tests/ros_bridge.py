"""A process of ROS 2 that tests talk to: it publishes what they say, and says what it hears.

It runs in the environment of ROS 2 (scripts/setup_ros.sh) and knows nothing of VISTA. It takes lines of JSON,
{"publish": TOPIC, "type": TYPE, "data": base64 of CDR} and {"hear": TOPIC, "type": TYPE}, and answers
{"matched": TOPIC} once somebody is at the other end. What it hears is decoded by ROS 2's own types, and
encoded again: {"heard": TOPIC, "data": base64 of CDR}. It ends with its input.
"""

from __future__ import annotations

import base64
import importlib
import json
import sys
import threading
import time
from contextlib import suppress
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.serialization import serialize_message

SAYING = threading.Lock()


def message_class(name: str) -> Any:
    package, _, kind = name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), kind)


def say(**what: str) -> None:
    with SAYING:  # two threads do
        print(json.dumps(what), flush=True)


class Bridge:
    def __init__(self) -> None:
        rclpy.init()
        self._node = rclpy.create_node("test_bridge")
        self._publishers: dict[str, Any] = {}

    def serve(self) -> None:
        listening = threading.Thread(target=self._listen)
        listening.start()
        for line in sys.stdin:
            told = json.loads(line)
            if "hear" in told:
                self._hear(told["hear"], told["type"])
            else:
                self._publish(told["publish"], told["type"], base64.b64decode(told["data"]))
        rclpy.shutdown()
        listening.join()  # a node that is gone while its thread still waits ends the process by abort()
        self._node.destroy_node()

    def _listen(self) -> None:
        with suppress(ExternalShutdownException):
            rclpy.spin(self._node)

    def _hear(self, topic: str, kind: str) -> None:
        def heard(message: Any) -> None:
            say(heard=topic, data=base64.b64encode(serialize_message(message)).decode())

        self._node.create_subscription(message_class(kind), topic, heard, 10)
        while self._node.count_publishers(topic) == 0:
            time.sleep(0.01)
        say(matched=topic)

    def _publish(self, topic: str, kind: str, data: bytes) -> None:
        if topic not in self._publishers:
            publisher = self._node.create_publisher(message_class(kind), topic, 10)
            while publisher.get_subscription_count() == 0:
                time.sleep(0.01)
            self._publishers[topic] = publisher
            say(matched=topic)
        if data:
            self._publishers[topic].publish(data)


if __name__ == "__main__":
    Bridge().serve()
