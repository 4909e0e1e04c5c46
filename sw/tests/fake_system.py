"""A stand-in for build/bin/vista_system: servers whose times are formulas, in its documented JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from vista_throughput.simulate import Run
from vista_throughput.system import SystemConfig

LATENCY_CLOCKS = 3845
BYTES_PX = 8  # captured, fetched, and the result


@dataclass
class FakeSimulator:
    """Stands for vista_throughput.simulate.Simulator."""

    program: object = None
    option_of_key: dict[str, str] = field(default_factory=dict)
    runs: dict[str, Run] = field(default_factory=dict)

    def run(self, config: SystemConfig) -> Run:
        return self.runs.setdefault(config.text(), Run(config, simulate(config)))


def memory_ns(config: SystemConfig) -> float:
    return 1e9 * config.width_px * config.height_px * BYTES_PX / config.memory_bandwidth_bytes_s


def engine_ns(config: SystemConfig) -> float:
    """A pixel a clock, or as fast as memory lets it."""
    pixels_ns = 1e9 * config.width_px * config.height_px / config.engine_clock_hz
    return max(pixels_ns, memory_ns(config))


def host_ns(config: SystemConfig, frame: int) -> float:
    series = config.host_stage_ms.values()
    return 1e6 * sum(samples[frame % len(samples)] for samples in series)


def simulate(config: SystemConfig) -> dict[str, Any]:
    period_ns = 1e9 / config.camera_rate_hz
    readout_ns = 1e9 * config.readout_pixel_clocks / config.camera_pixel_clock_hz
    clock_ns = 1e9 / config.engine_clock_hz
    latency_ns = LATENCY_CLOCKS * clock_ns
    lane_free_ns, host_free_ns = [0.0] * config.lanes, 0.0
    engine_starts: list[float] = []
    frames = []
    for number in range(config.frames):
        start = number * period_ns
        end = start + readout_ns
        lane = min(range(config.lanes), key=lane_free_ns.__getitem__)
        frame: dict[str, Any] = {
            "frame": number, "dropped": None, "lane": lane, "capture_start_ns": start, "capture_end_ns": end,
            "rectify_start_ns": None, "rectify_end_ns": None,
        }  # fmt: skip
        frames.append(frame)
        if sum(begun > start for begun in engine_starts) >= config.buffers:
            empty = ("fetch_start_ns", "engine_start_ns", "engine_first_word_ns", "engine_last_word_ns")
            clocks = ("engine_start_clock", "engine_last_pixel_clock")
            rest = ("result_end_ns", "host_start_ns", "host_end_ns")
            frame |= dict.fromkeys((*empty, *clocks, *rest)) | {"dropped": "no_buffer"}
            continue
        begin = max(end, lane_free_ns[lane])
        # A result that the host has not taken holds the engine: one is on its way.
        begin = max(begin, host_free_ns - engine_ns(config))
        engine_starts.append(begin)
        lane_free_ns[lane] = begin + engine_ns(config)
        last_word = lane_free_ns[lane] + latency_ns
        host_start = max(last_word, host_free_ns)
        host_free_ns = host_start + host_ns(config, number)
        frame |= {
            "fetch_start_ns": begin, "engine_start_ns": begin, "engine_first_word_ns": begin + latency_ns,
            "engine_last_word_ns": last_word, "engine_start_clock": round(begin / clock_ns),
            "engine_last_pixel_clock": round(lane_free_ns[lane] / clock_ns) - 1,
            "result_end_ns": last_word, "host_start_ns": host_start, "host_end_ns": host_free_ns,
        }  # fmt: skip
    return _output(config, frames, period_ns, readout_ns)


def _output(config: SystemConfig, frames: list, period_ns: float, readout_ns: float) -> dict[str, Any]:
    kept = [frame for frame in frames if frame["dropped"] is None]
    total_ns = max((frame["host_end_ns"] for frame in kept), default=period_ns)
    lanes = []
    for lane in range(config.lanes):
        mine = sum(frame["lane"] == lane for frame in kept)
        lanes.append({"frames": mine, "utilisation": mine * engine_ns(config) / total_ns})
    lost = len(frames) - len(kept)
    host = sum(frame["host_end_ns"] - frame["host_start_ns"] for frame in kept) / total_ns
    return {
        "version": 1,
        "camera": {"period_ns": period_ns, "readout_ns": readout_ns},
        "frames": frames,
        "totals": {
            "frames": len(frames), "delivered": len(kept), "dropped": lost, "drops": {"no_buffer": lost},
        },
        "lanes": lanes,
        "memory": {"utilisation": len(kept) * memory_ns(config) / total_ns},
        "host": {"utilisation": host, "link_utilisation": None, "rectify_utilisation": 0.0},
    }  # fmt: skip
