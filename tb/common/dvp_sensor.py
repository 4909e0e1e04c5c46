"""A sensor with a parallel port (DVP): blanking, jitter of its lines, and what goes wrong with sensors."""

from __future__ import annotations

import random

import numpy as np
from cocotb.handle import SimHandleBase
from cocotb.triggers import FallingEdge
from video import Ports

LINE_BLANKING, JITTER, VSYNC = 40, 3, 6  # clocks
# What may happen to a frame: it is missing, or late; nothing comes from some line on; a line is missing, too
# short or too long.
DROP_OUTS = ("frame", "late", "end", "line", "short", "long")


def frame_clocks(height: int, width: int) -> int:
    """How long a sensor takes for a frame that comes in time."""
    return VSYNC + height * (LINE_BLANKING + JITTER + width) + 1


class Sensor:
    """A camera at the ports with the name of its side."""

    def __init__(self, dut: SimHandleBase, side: str, rng: random.Random) -> None:
        self.ports, self.side, self.rng = Ports(dut), side, rng

    async def clock(self, vsync: int, href: int, data: int) -> None:
        await FallingEdge(self.ports[f"{self.side}_clk_i"])
        self.ports.drive(
            **{f"{self.side}_vsync_i": vsync, f"{self.side}_href_i": href, f"{self.side}_data_i": data}
        )

    async def blank(self, clocks: int, vsync: int = 0) -> None:
        for _ in range(clocks):
            await self.clock(vsync, 0, self.rng.randrange(256))  # the bus is not quiet between lines

    def line(self, pixels: list[int], what: str) -> list[int]:
        shortened = pixels[: self.rng.randrange(1, len(pixels))]
        return {"line": [], "short": shortened, "long": [*pixels, 0]}.get(what, pixels)

    async def send(self, image: np.ndarray, what: str, late_clocks: int) -> None:
        """A frame, from its trigger on."""
        height, width = image.shape
        if what == "frame":
            return
        await self.blank(late_clocks if what == "late" else 0)
        await self.blank(VSYNC, vsync=1)
        hit = self.rng.randrange(1, height - 1)
        for y in range(hit if what == "end" else height):
            jitter = self.rng.randrange(JITTER)
            pixels = image[y].tolist()
            pixels = self.line(pixels, what) if y == hit else pixels
            await self.blank(LINE_BLANKING + jitter)
            for pixel in pixels:
                await self.clock(0, 1, pixel)
            await self.blank(JITTER - jitter + width - len(pixels))
        await self.blank(1)
