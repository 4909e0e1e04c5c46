"""The answer of `vista throughput` as lines of text."""

from __future__ import annotations

import math

from vista_throughput.assess import Answer
from vista_throughput.figures import Stage


def table(answer: Answer) -> str:
    return "\n".join([*_system(answer), "", *_stages(answer), "", *_verdict(answer)])


def _system(answer: Answer) -> list[str]:
    c = answer.config
    lanes = f"{c.lanes} engines" if c.lanes > 1 else "1 engine"
    if c.rectify_rows:
        lanes += f" with front end, {c.levels} level" + "s" * (c.levels > 1)
    if c.has_board:
        lanes += f", link {8 * c.link_bytes_s / 1e9:g} Gbit/s"
    memory = f"{c.memory_bandwidth_bytes_s / 1e9:.4g} GB/s"
    if c.has_board:
        memory = f"SDRAM at {c.memory_clock_hz / 1e6:.4g} MHz"
    return [
        f"{answer.preset or 'system'}: {c.width_px}x{c.height_px}, {c.disparities} disparities, block "
        f"{c.block_px}; camera {c.camera_rate_hz:g} Hz, pixel clock {c.camera_pixel_clock_hz / 1e6:.4g} MHz",
        f"{lanes} at {c.engine_clock_hz / 1e6:.4g} MHz ({answer.clock.origin})",
        f"memory {memory}, {c.buffers} buffers; host {answer.host.origin}",
    ]


def _stages(answer: Answer) -> list[str]:
    head = f"{'ms a frame':24}{'p50':>9}{'p99':>9}{'at work':>9}"
    found = answer.figures
    total = Stage("first pixel to map", found.latency_p50_ms, found.latency_p99_ms)
    return [head, *(_stage(stage) for stage in (*found.stages, total))]


def _stage(stage: Stage) -> str:
    times = "".join(f"{'' if math.isnan(t) else f'{t:.2f}':>9}" for t in (stage.p50_ms, stage.p99_ms))
    busy = "" if stage.utilisation is None else f"{stage.utilisation:.0%}"
    return f"{stage.name:24}{times}{busy:>9}".rstrip()


def _verdict(answer: Answer) -> list[str]:
    found, wanted = answer.figures, answer.config.camera_rate_hz
    total = found.delivered + found.dropped
    reasons = ", ".join(f"{reason} {count}" for reason, count in found.drops.items())
    lost = f"{found.dropped} of {total} frames dropped" + (f" ({reasons})" if reasons else "")
    lines = [
        f"rate: {found.rate_hz:.1f} of {wanted:g} frames/s, {lost}",
        f"latency, first pixel to obstacle map: {found.latency_p50_ms:.1f} ms "
        f"(p99 {found.latency_p99_ms:.1f})",
    ]
    if answer.keeps_up:
        lines.append("bottleneck: the camera; all that follows keeps up")
        most = "behind a faster camera"
    else:
        lines.append(f"bottleneck: the {answer.limit.stage}")
        most = "at most"
    lines.append(f"{most}: {answer.limit.rate_hz:.0f} frames/s, limited by the {answer.limit.stage}")
    faster = answer.limit.rate_if_twice_as_fast_hz.items()
    lines.append(
        "with one stage twice as fast: " + ", ".join(f"{name} {rate:.0f} frames/s" for name, rate in faster)
    )
    lines.append(_clock(answer))
    return lines


def _clock(answer: Answer) -> str:
    wanted, needed, margin = answer.config.camera_rate_hz, answer.needed, answer.clock_margin
    if needed is None or margin is None:
        return f"engine clock for {wanted:g} Hz: none, memory does not keep up"
    side = f"1/{margin:.1f} of" if margin >= 1 else f"{1 / margin:.2f} times"
    return (
        f"engine clock for {wanted:g} Hz: {needed.clock_hz / 1e6:.2f} MHz, {side} the engine's "
        f"{answer.config.engine_clock_hz / 1e6:.4g} MHz (confirmed: {needed.confirmed_dropped} of "
        f"{needed.confirmed_frames} frames dropped)"
    )
