"""What buildings are faced with: albedo maps of upright rectangles, row 0 on top."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vista_eval.render.textures import smoothstep
from vista_eval.worlds import street
from vista_eval.worlds.draws import draws, log_uniform
from vista_eval.worlds.patterns import cloudy, laid, spread, stones

Wall = Callable[[float, float, int, float], np.ndarray]  # width, height in metres, seed, texel in metres


def _grid(width_m: float, height_m: float, texel_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates across (1, M) and height above the foot (N, 1)."""
    rows, columns = max(2, round(height_m / texel_m)), max(2, round(width_m / texel_m))
    y = (np.arange(columns, dtype=np.float32) + 0.5)[None, :] * texel_m
    z = (rows - 0.5 - np.arange(rows, dtype=np.float32))[:, None] * texel_m
    return y, z


def _finished(albedo: np.ndarray) -> np.ndarray:
    return np.clip(albedo, 0.02, 0.85).astype(np.float32)


def plain(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Fresh plaster: one shade, and hardly more than that it darkens towards one end."""
    rng = draws(seed, "plain")
    y, z = _grid(width_m, height_m, texel_m)
    clouds = spread(cloudy(seed, 1.6), z, y, 14.0, 0.4)
    fades = rng.uniform(-0.06, 0.06) * y / width_m + rng.uniform(-0.06, 0.06) * z / height_m
    return _finished(rng.uniform(0.25, 0.7) * (1 + fades + rng.uniform(0.0, 0.012) * clouds))


def roughcast(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Weathered: grain, runs below the edge, damp at the foot, cracks."""
    rng = draws(seed, "roughcast")
    y, z = _grid(width_m, height_m, texel_m)
    grain = spread(cloudy(seed, 0.5), z, y, 4.0, 0.3)
    runs = laid(cloudy(seed + 1, 0.9, 0.08), z, y, 9.0, np.pi / 2) * smoothstep(0.2 * height_m, height_m, z)
    damp = 1 - smoothstep(0.1, 1.0, z + 0.25 * laid(cloudy(seed + 2, 1.1), z, y, 8.0))
    crack = np.abs(laid(cloudy(seed + 3, 2.2), z, y, 17.0)) < 0.008
    shade = 1 + 0.05 * grain + 0.07 * runs - 0.35 * damp - 0.3 * crack
    return _finished(rng.uniform(0.25, 0.65) * shade)


def brick(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    rng = draws(seed, "brick")
    fine = min(texel_m, street.BRICK_TEXEL_M)
    grain = float(rng.uniform(0.3, 1.0))
    return street.wall_texture(width_m, height_m, rng.uniform(0.15, 0.45), True, grain, seed, fine)


def ashlar(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Rubble stone."""
    rng = draws(seed, "ashlar")
    y, z = _grid(width_m, height_m, texel_m)
    blocks = spread(stones(seed, 300, 3.0), z, y, rng.uniform(4.0, 8.0), 0.0)
    grain = spread(cloudy(seed + 1, 0.5), z, y, 2.5, 0.7)
    return _finished(rng.uniform(0.22, 0.5) * (1 + 0.22 * blocks + 0.06 * grain))


def concrete_panels(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Cast slabs: joints, tie holes at even distances, stains."""
    rng = draws(seed, "concrete")
    y, z = _grid(width_m, height_m, texel_m)
    wide, high = rng.uniform(1.2, 5.0), rng.uniform(1.0, 3.2)
    joint = (np.mod(y, wide) < 0.03) | (np.mod(z, high) < 0.03)
    dy, dz = np.mod(y, wide / 2) - wide / 4, np.mod(z, high / 2) - high / 4
    holes = dy**2 + dz**2 < 0.025**2
    slab = np.random.default_rng(seed).normal(0, 0.05, 4096)
    which = (np.floor(y / wide).astype(int) * 31 + np.floor(z / high).astype(int) * 7) % 4096
    stains = laid(cloudy(seed, 1.1, 0.3), z, y, 13.0, np.pi / 2)
    shade = np.where(joint | holes, 0.6, 1 + slab[which] + 0.06 * stains)
    return _finished(rng.uniform(0.3, 0.5) * shade)


def corrugated(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Trapezoidal sheet: upright ribs at one pitch, laps, screws, rust at the foot."""
    rng = draws(seed, "corrugated")
    y, z = _grid(width_m, height_m, texel_m)
    pitch = rng.uniform(0.18, 0.4)
    rib = smoothstep(0.55, 0.7, np.abs(np.mod(y / pitch, 1.0) * 2 - 1))
    edge = 0.16 * np.sin(2 * np.pi * y / pitch)
    lap = np.mod(z, rng.uniform(2.5, 6.0)) < 0.04
    rust = smoothstep(0.4, 2.0, laid(cloudy(seed, 1.1, 0.2), z, y, 13.0, np.pi / 2) - 0.4 * z)
    shade = (1 + edge - 0.25 * rib) * np.where(lap, 0.75, 1.0) * (1 - 0.45 * rust)
    return _finished(rng.uniform(0.15, 0.6) * shade)


def boards(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Level timber boards, weathered each by itself."""
    rng = draws(seed, "boards")
    y, z = _grid(width_m, height_m, texel_m)
    high = rng.uniform(0.12, 0.25)
    number = np.floor(z / high).astype(int)
    tone = np.random.default_rng(seed).lognormal(0, 0.14, 512)[number % 512]
    veins = laid(cloudy(seed, 0.8, 14.0), z, y, 5.0, np.pi / 2)
    butt = np.mod(y + 1.7 * (number % 5), 4.2) < 0.012
    gap = np.mod(z, high) < 0.018
    shade = np.where(gap | butt, 0.4, tone * (1 + 0.12 * veins))
    return _finished(rng.uniform(0.15, 0.5) * shade)


def windows(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Every window alike, floor above floor."""
    rng = draws(seed, "windows")
    pitch = rng.uniform(1.6, 4.2)
    style = street.FacadeStyle(
        window_pitch_m=pitch,
        window_m=(pitch * rng.uniform(0.35, 0.65), rng.uniform(1.1, 2.0)),
        wall=rng.uniform(0.2, 0.65),
        frame=rng.uniform(0.05, 0.8),
        bricks=False,
        grain=rng.uniform(0.0, 0.5),
        variety=rng.uniform(0.0, 0.12),
    )
    return street.facade_texture(width_m, height_m, style, seed, texel_m)


def lived_in(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """Windows with curtains, blinds, doors."""
    style = street.any_style(draws(seed, "lived in"))
    return street.facade_texture(width_m, height_m, style, seed, texel_m)


def dark_glass(width_m: float, height_m: float, seed: int, texel_m: float) -> np.ndarray:
    """A curtain wall: dark panes that mirror a smooth sky between thin mullions."""
    rng = draws(seed, "glass")
    y, z = _grid(width_m, height_m, texel_m)
    wide, high = rng.uniform(1.0, 2.4), rng.uniform(1.4, 3.8)
    bar = rng.uniform(0.04, 0.09)
    mullion = (np.mod(y, wide) < bar) | (np.mod(z, high) < bar)
    spandrel = (np.mod(z, high) < rng.uniform(0.0, 0.9)) & (rng.random() < 0.6)
    bent = 0.5 * laid(cloudy(seed, 2.2), z, y, 35.0)
    # Panes are never quite in one plane: each mirrors another piece of the sky.
    tilt = np.random.default_rng(seed).normal(0, log_uniform(rng, 0.05, 0.5), 4096)
    pane = tilt[(np.floor(y / wide).astype(int) * 131 + np.floor(z / high).astype(int) * 17) % 4096]
    mirrored = 0.03 + 0.11 * smoothstep(-1.5, 2.5, bent + pane + 1.5 * z / max(height_m, 1.0))
    facing = rng.uniform(0.02, 0.5)
    return _finished(np.where(mullion, facing, np.where(spandrel, 0.08, mirrored)))


TEXTURED: tuple[Wall, ...] = (roughcast, brick, ashlar, concrete_panels, boards)
