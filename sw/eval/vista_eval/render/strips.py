"""Which share of each pixel straight wires cover: the strip between the outlines of each, cut by pixels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vista_eval.render.rig import Rig

STRIPS = 8  # across the width, each with its own light
NEAREST_M = 0.2
MARGIN_PX = 0.75  # from the outline to the middle of a pixel that it may still touch: half a diagonal
SLANTED = 1.3  # how much wider than in the middle a wire can be drawn where rays are slanted
LEAST_COVER = 1e-6


class Straight(NamedTuple):
    """Wires in the camera; one an entry, or one a row."""

    start_m: np.ndarray  # (n, 3)
    end_m: np.ndarray
    radius_m: np.ndarray

    def where(self, chosen: np.ndarray) -> Straight:
        return Straight(*(each[chosen] for each in self))


class Pieces(NamedTuple):
    """What each pixel shows of each wire; one pixel of one wire an entry."""

    pixel: np.ndarray  # v * width + u
    wire: np.ndarray
    depth_m: np.ndarray  # of its axis, along the optical axis
    across: np.ndarray  # of the pixel's middle, in radii to the right of the axis as it is drawn
    within: np.ndarray  # whether the middle lies between the ends
    cover: np.ndarray  # (n, STRIPS) share of the pixel

    def where(self, chosen: np.ndarray) -> Pieces:
        return Pieces(*(each[chosen] for each in self))


def before_camera(start_m: np.ndarray, end_m: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends (n, 3) with the parts behind the camera cut off, and (n,) whether any is before it."""
    ends = start_m, end_m
    cut = []
    for here, there in (ends, ends[::-1]):
        rise = there[:, 2] - here[:, 2]
        share = (NEAREST_M - here[:, 2]) / np.where(rise == 0, 1.0, rise)
        behind = (here[:, 2] < NEAREST_M) & (there[:, 2] > NEAREST_M)
        cut.append(np.where(behind[:, None], here + share[:, None] * (there - here), here))
    seen = np.maximum(start_m[:, 2], end_m[:, 2]) > NEAREST_M
    return cut[0], cut[1], seen


def pieces_of(rig: Rig, wires: Straight) -> Pieces:
    """wires: in the camera, from end to end before it or behind it."""
    start_m, end_m, seen = before_camera(wires.start_m, wires.end_m)
    cut = Straight(start_m, end_m, wires.radius_m)
    numbers = np.flatnonzero(seen)
    with np.errstate(divide="ignore", invalid="ignore"):
        ends_px = np.stack([rig.project(start_m), rig.project(end_m)], axis=1)
        reach_px = MARGIN_PX + SLANTED * rig.focal_px * wires.radius_m / np.minimum(
            start_m[:, 2], end_m[:, 2]
        )
    low, high = ends_px.min(axis=1) - reach_px[:, None], ends_px.max(axis=1) + reach_px[:, None]
    inside = np.all((high >= 0) & (low <= [rig.width_px - 1, rig.height_px - 1]), axis=1)
    numbers = numbers[inside[numbers]]
    none = np.zeros(0, int)
    near = [pixels_near(rig, ends_px[k], float(reach_px[k])) for k in numbers]
    wire = np.repeat(numbers, [len(u) for u, _ in near])
    u, v = (np.concatenate([*(pair[k] for pair in near), none]) for k in range(2))
    return covered(rig, u, v, wire, cut, ends_px)


def covered(
    rig: Rig, u: np.ndarray, v: np.ndarray, wire: np.ndarray, wires: Straight, ends_px: np.ndarray
) -> Pieces:
    """Those of the pixels and wires that may meet that do meet."""
    step = ends_px[:, 1] - ends_px[:, 0]
    length = np.maximum(np.hypot(*step.T), 1e-9)
    along = (step / length[:, None])[wire]
    offset = np.stack([u, v], axis=1) - ends_px[wire, 0]
    t_px = offset[:, 0] * along[:, 0] + offset[:, 1] * along[:, 1]
    q_px = offset[:, 1] * along[:, 0] - offset[:, 0] * along[:, 1]
    half_px = half_width(rig, u, v, wires.where(wire))
    beside = np.abs(along[:, ::-1])
    whole = below(half_px - q_px, beside) - below(-half_px - q_px, beside)
    whole *= below(length[wire] - t_px, np.abs(along)) - below(-t_px, np.abs(along))
    kept = np.flatnonzero(whole > LEAST_COVER)
    u, v, wire, t_px, q_px, half_px = (each[kept] for each in (u, v, wire, t_px, q_px, half_px))
    edges = np.linspace(-1, 1, STRIPS + 1)
    strips = np.diff([below(half_px * edge - q_px, beside[kept]) for edge in edges], axis=0).T
    cover = strips * (whole[kept] / np.maximum(strips.sum(axis=1), 1e-12))[:, None]
    share = np.clip(t_px / length[wire], 0, 1)
    depth_m = 1 / ((1 - share) / wires.start_m[wire, 2] + share / wires.end_m[wire, 2])
    within = (t_px >= 0) & (t_px < length[wire])
    return Pieces(v * rig.width_px + u, wire, depth_m, q_px / half_px, within, cover)


def pixels_near(rig: Rig, ends_px: np.ndarray, within_px: float) -> tuple[np.ndarray, np.ndarray]:
    """Columns and rows of all pixels that a segment comes near to, and of some others."""
    step = ends_px[1] - ends_px[0]
    major = int(abs(step[1]) > abs(step[0]))
    size = (rig.width_px, rig.height_px)
    low, high = sorted((float(ends_px[0, major]), float(ends_px[1, major])))
    first = max(int(np.floor(low - within_px)), 0)
    last = min(int(np.ceil(high + within_px)), size[major] - 1)
    line = np.arange(first, last + 1)
    slope = float(step[1 - major] / step[major]) if abs(step[major]) > 1e-9 else 0.0
    middle = ends_px[0, 1 - major] + slope * (np.clip(line, low, high) - ends_px[0, major])
    reach = int(np.ceil(within_px * np.hypot(1, slope) + 0.5))  # half a pixel for the rounding
    beside = np.rint(middle).astype(int)[:, None] + np.arange(-reach, reach + 1)
    line = np.repeat(line, beside.shape[1])
    beside = beside.ravel()
    inside = (beside >= 0) & (beside < size[1 - major])
    pair = line[inside], beside[inside]
    return pair if major == 0 else (pair[1], pair[0])


def half_width(rig: Rig, u: np.ndarray, v: np.ndarray, wires: Straight) -> np.ndarray:
    """(n,) px from the axis to the outline, square to the axis as it is drawn. A ray along d passes a line
    through s along a at the distance d . (a x s) / |d x a|."""
    axis = wires.end_m - wires.start_m
    axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    (cu, cv), focal = rig.center_px, rig.focal_px
    ray = np.stack([(u - cu) / focal, (v - cv) / focal, np.ones(len(u))], axis=1)
    turn = np.hypot(*np.cross(axis, wires.start_m)[:, :2].T) / focal
    return wires.radius_m * np.linalg.norm(np.cross(ray, axis), axis=1) / np.maximum(turn, 1e-12)


def below(limit_px: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(n,) share of a pixel where the distance to a line through its middle is below `limit_px`. normal: the
    line's (n, 2), of length 1, with no side below 0. The share of a square is a trapezoid's integral."""
    long, short = np.maximum(*normal.T), np.minimum(*normal.T)
    reach, flat = (long + short) / 2, (long - short) / 2
    x = np.clip(limit_px, -reach, reach)
    corner = np.clip(reach - np.abs(x), 0, short) ** 2 / (2 * long * np.maximum(short, 1e-12))
    return np.where(np.abs(x) <= flat, 0.5 + x / long, np.where(x > 0, 1 - corner, corner))
