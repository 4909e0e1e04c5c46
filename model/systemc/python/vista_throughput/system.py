"""The configuration of model/systemc as a Python object, named as in doc/design/system-model.md."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace

DEFAULT_PIXEL_CLOCK_HZ = 25.2e6  # VGA timing: 800 x 525 pixel clocks a frame, 60 Hz

Samples = tuple[float, ...]


@dataclass(frozen=True)
class SystemConfig:
    """One system. Ranges are judged by build/bin/vista_system, which names the key that is out of range."""

    width_px: int = 640
    height_px: int = 480
    disparities: int = 32
    block_px: int = 11
    max_width_px: int = 1024  # the engine is built for
    engine_clock_hz: float = 100e6
    lanes: int = 1
    rectify_rows: int = 0  # of the front end in hardware; 0: none, the host does its work
    levels: int = 1  # of the pyramid, matched one after the other
    link_bytes_s: float = 0.0  # each way, to a board; 0: the camera feeds the engine's memory
    link_round_trip_ns: float = 0.0  # of network and host, beside the time of the packets
    memory_clock_hz: float = 0.0  # of the SDRAM of a board, to which nothing else of memory applies
    board_cameras: bool = False  # a board's own: no pair goes over the link
    camera_rate_hz: float = 60.0
    camera_pixel_clock_hz: float = DEFAULT_PIXEL_CLOCK_HZ
    camera_horizontal_blanking_px: int = 160
    camera_vertical_blanking_lines: int = 45
    memory_bandwidth_bytes_s: float = 1.6e9
    memory_latency_ns: float = 100.0
    memory_burst_overhead_ns: float = 0.0
    burst_bytes: int = 256
    dma_fifo_bytes: int = 4096
    result_bytes_px: int = 2  # disparities; 4: with Smin, which the host does not read
    buffers: int = 3
    memory_arbitration: str = "round_robin"
    buffer_policy: str = "latest"
    host_cores: int = 1
    frames: int = 100
    seed: int = 1
    compute_words: bool = False
    rectify_ms: Samples = ()
    host_stage_ms: Mapping[str, Samples] = field(default_factory=dict)  # in the order in which they run

    @property
    def has_board(self) -> bool:
        return self.link_bytes_s > 0

    @property
    def readout_pixel_clocks(self) -> int:
        """Pixel clocks of one frame, blanking included."""
        columns = self.width_px + self.camera_horizontal_blanking_px
        return columns * (self.height_px + self.camera_vertical_blanking_lines)

    def text(self) -> str:
        """The text that build/bin/vista_system reads."""
        lines = []
        for name in (f.name for f in fields(self) if f.name not in ("rectify_ms", "host_stage_ms")):
            value = getattr(self, name)
            lines.append(f"{name} = {_word(value)}")
        if self.rectify_ms:
            lines.append(f"rectify_ms = {_list(self.rectify_ms)}")
        for name, samples in self.host_stage_ms.items():
            lines.append(f"host_stage.{name}_ms = {_list(samples)}")
        return "\n".join(lines) + "\n"

    def faster_camera(self, factor: float) -> SystemConfig:
        """Rate and pixel clock; this one a hair more, as the exact quotient may round to below the rate."""
        return replace(
            self,
            camera_rate_hz=self.camera_rate_hz * factor,
            camera_pixel_clock_hz=self.camera_pixel_clock_hz * factor * (1 + 1e-9),
        )

    def faster_memory(self, factor: float) -> SystemConfig:
        return replace(
            self,
            memory_bandwidth_bytes_s=self.memory_bandwidth_bytes_s * factor,
            memory_latency_ns=self.memory_latency_ns / factor,
            memory_burst_overhead_ns=self.memory_burst_overhead_ns / factor,
            memory_clock_hz=self.memory_clock_hz * factor,
        )

    def faster_link(self, factor: float) -> SystemConfig:
        return replace(
            self,
            link_bytes_s=self.link_bytes_s * factor,
            link_round_trip_ns=self.link_round_trip_ns / factor,
        )

    def faster_engine(self, factor: float) -> SystemConfig:
        return replace(self, engine_clock_hz=self.engine_clock_hz * factor)

    def faster_host(self, factor: float) -> SystemConfig:
        """Rectification and the stages behind the engine."""
        return replace(
            self,
            rectify_ms=tuple(t / factor for t in self.rectify_ms),
            host_stage_ms={n: tuple(t / factor for t in s) for n, s in self.host_stage_ms.items()},
        )

    def steady_host(self) -> SystemConfig:
        """Every frame takes the mean time."""
        return replace(
            self,
            rectify_ms=_mean(self.rectify_ms),
            host_stage_ms={name: _mean(samples) for name, samples in self.host_stage_ms.items()},
        )

    def without_host(self) -> SystemConfig:
        return replace(self, rectify_ms=(), host_stage_ms={})


def _mean(samples: Samples) -> Samples:
    return (sum(samples) / len(samples),) if samples else ()


def _word(value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return repr(value) if isinstance(value, float) else str(value)


def _list(samples: Samples) -> str:
    return ", ".join(f"{t:.4f}" for t in samples)
