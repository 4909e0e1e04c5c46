"""Pairs left and right images by their times as they come; vista.sequence.pairing does so with recordings."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista.sequence.bag_images import grey, stamp_ns
from vista.sequence.pairing import default_tolerance_ns

HELD = 10  # images of a side that wait for a partner
PERIODS = 20  # that the tolerance is taken from
LEFT, RIGHT = 0, 1


@dataclass(frozen=True)
class TopicImage:
    """A sensor_msgs/Image or a sensor_msgs/CompressedImage that came."""

    topic: str
    message: Any
    number: int  # of the images of its topic
    arrived_ns: int  # on time.monotonic_ns()

    def __str__(self) -> str:
        return self.topic

    @property
    def t_ns(self) -> int:
        return stamp_ns(self.message.header)

    def read_grey(self) -> NDArray[np.uint8]:
        return grey(self.topic, self.message)


class LivePairs:
    def __init__(self, tolerance_ms: float | None) -> None:
        """tolerance_ms: None is a tenth of the frame period, at most 5 ms."""
        self.skipped = 0  # images without a partner
        self._given_ns = None if tolerance_ms is None else round(1e6 * tolerance_ms)
        self._waiting: tuple[deque[TopicImage], ...] = (deque(), deque())
        self._lefts_ns: deque[int] = deque(maxlen=PERIODS)

    @property
    def tolerance_ns(self) -> int:
        return default_tolerance_ns(self._lefts_ns) if self._given_ns is None else self._given_ns

    def add(self, side: int, image: TopicImage) -> tuple[TopicImage, TopicImage] | None:
        """The pair that the image completes. The times of a side increase."""
        own, others = self._waiting[side], self._waiting[1 - side]
        if side == LEFT:
            self._lefts_ns.append(image.t_ns)
        partner = min(others, key=lambda other: abs(other.t_ns - image.t_ns), default=None)
        if partner is None or abs(partner.t_ns - image.t_ns) > self.tolerance_ns:
            own.append(image)
            if len(own) > HELD:
                own.popleft()
                self.skipped += 1
            return None
        self.skipped += len(own)
        own.clear()
        while others.popleft() is not partner:
            self.skipped += 1
        return (image, partner) if side == LEFT else (partner, image)

    def clear(self) -> None:
        for waiting in self._waiting:
            self.skipped += len(waiting)
            waiting.clear()
        self._lefts_ns.clear()
