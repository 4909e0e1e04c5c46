"""Pictures of one frame: what the chain saw and what it concluded, side by side.

    left image, obstacles | disparity
    ----------------------+----------
    foveated image        | regions

Tracked obstacles are yellow ellipses (dashed while they are not seen), tracks that are not confirmed yet thin
grey ones; the nearest obstacle in the collision volume is green, with its distance and the time left.
"""

from __future__ import annotations

import math
from dataclasses import astuple
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.engine import SCALE
from vista.report.labels import PADDING_PX, Labels, put_text, text_scale, text_size
from vista.report.palette import GREEN, GREY, INK, WHITE, YELLOW, Colour, RegionColours
from vista.sequence.types import Frame

if TYPE_CHECKING:
    from vista.pipeline import Nearest, Obstacle, Result

Picture = NDArray[np.uint8]  # HxWx3, BGR
GAP_PX = 4
MAX_LABELS = 16  # the nearest; more hide the scene
SUBPIXEL_BITS = 4


class Overlay:
    """Draws the frames of one run; it remembers the colours of the regions."""

    def __init__(self, name: str, num_disparities: int) -> None:
        self._name = name
        self._num_disparities = num_disparities
        self._region_colours = RegionColours()

    def draw(self, frame: Frame, words: NDArray[np.int16], result: Result) -> Picture:
        """frame: rectified; words: its disparity image, 1/16 px; result: what the host made of the two."""
        foveated = np.clip(np.rint(result.cell_intensity), 0, 255).astype(np.uint8)[result.cell_of_pixel]
        colours = self._region_colours.assign(result.region_of_cell)
        tiles = [
            draw_obstacles(frame.left, result.obstacles, result.nearest_collision),
            draw_disparity(words, self._num_disparities),
            _caption(_coloured(foveated), "foveated"),
            draw_regions(frame.left, result.region_of_pixel, colours, result.verdict_of_region),
        ]
        return _stack(self._headline(frame, result), tiles)

    def _headline(self, frame: Frame, result: Result) -> tuple[str, str]:
        confirmed = sum(obstacle.confirmed for obstacle in result.obstacles)
        facts = f"{self._name}   frame {frame.index}   {confirmed} obstacle{'s' * (confirmed != 1)}"
        nearest = result.nearest_collision
        return facts, "" if nearest is None else f"collision: #{nearest.id}  {_distance_and_time(nearest)}"


def draw_obstacles(left: NDArray[np.uint8], obstacles: list[Obstacle], nearest: Nearest | None) -> Picture:
    """Ellipses and labels over the left image; near obstacles get their labels first."""
    picture = _coloured(left)
    labels = Labels(picture)
    by_distance = sorted(obstacles, key=lambda obstacle: obstacle.distance_m)
    for obstacle in reversed(by_distance):
        unseen_newborn = obstacle.coasting and not obstacle.confirmed
        if unseen_newborn or (nearest is not None and obstacle.id == nearest.id):
            continue
        _draw_ellipse(
            picture, obstacle, YELLOW if obstacle.confirmed else GREY, 2 if obstacle.confirmed else 1
        )
    for obstacle in by_distance:
        if nearest is not None and obstacle.id == nearest.id:
            _draw_ellipse(picture, obstacle, GREEN, 3)
            labels.reserve(f"#{obstacle.id}  {_distance_and_time(nearest)}", *_top(obstacle), GREEN)
    labelled = [o for o in by_distance if o.confirmed and not o.coasting]
    for obstacle in labelled[:MAX_LABELS]:
        if nearest is None or obstacle.id != nearest.id:
            where = "near" if obstacle.in_blind_zone else _distance(obstacle.distance_m)
            labels.reserve(f"#{obstacle.id}  {where}", *_top(obstacle), YELLOW)
    labels.draw()
    return _caption(picture, "left image, obstacles")


def draw_disparity(words: NDArray[np.int16], num_disparities: int) -> Picture:
    """Near is red, far is blue, invalid is dark."""
    levels = np.clip(words.astype(np.float32) * (255.0 / (SCALE * (num_disparities - 1))), 0, 255)
    picture = np.asarray(cv2.applyColorMap(levels.astype(np.uint8), cv2.COLORMAP_TURBO), np.uint8)
    picture[words < 0] = INK
    valid = 100.0 * np.mean(words >= 0)
    return _caption(picture, f"disparity 0 to {num_disparities - 1} px, {valid:.0f} % valid")


def draw_regions(
    left: NDArray[np.uint8],
    labels: NDArray[np.int32],
    colours: NDArray[np.uint8],
    verdict_of_region: list[str],
) -> Picture:
    """Accepted regions in full colour, the others pale; labels: region of each pixel, -1 for none."""
    accepted = np.array([verdict == "ACCEPTED" for verdict in verdict_of_region], bool)
    # The last entry of each table serves the label -1: pixels of no region stay grey.
    strength = np.append(np.where(accepted, 0.7, 0.2), 0.0)[:, np.newaxis]
    tint = np.rint(strength * np.vstack([colours, np.zeros((1, 3), np.uint8)])).astype(np.uint8)
    grey_share = np.rint(255.0 * (1.0 - strength[:, 0])).astype(np.uint8)
    grey = np.asarray(cv2.multiply(left, grey_share[labels], scale=1.0 / 255.0), np.uint8)
    picture = np.asarray(cv2.add(_coloured(grey), tint[labels]), np.uint8)
    picture[_borders(labels)] = INK
    return _caption(picture, f"{len(accepted)} regions, {accepted.sum()} accepted (full colour)")


def _coloured(grey: NDArray[np.uint8]) -> Picture:
    return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), np.uint8)


def _borders(labels: NDArray[np.int32]) -> NDArray[np.bool_]:
    border = np.zeros(labels.shape, bool)
    border[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    border[1:] |= labels[1:] != labels[:-1]
    return border


def _distance(distance_m: float) -> str:
    return f"{distance_m:.1f} m" if distance_m < 10.0 else f"{distance_m:.0f} m"


def _distance_and_time(nearest: Nearest) -> str:
    time_s = nearest.time_to_collision_s
    return f"{nearest.distance_m:.1f} m" + (f"  {time_s:.1f} s" if time_s is not None else "")


def _top(obstacle: Obstacle) -> tuple[float, float]:
    """Highest point of the ellipse, px."""
    ellipse = obstacle.ellipse
    angle = math.radians(ellipse.angle_deg)
    half_height_px = math.hypot(ellipse.axis_a * math.sin(angle), ellipse.axis_b * math.cos(angle))
    return ellipse.center_u, ellipse.center_v - half_height_px


def _draw_ellipse(picture: Picture, obstacle: Obstacle, colour: Colour, thickness: int) -> None:
    u, v, a, b, angle_deg = astuple(obstacle.ellipse)
    reach_px = 4 * picture.shape[1]  # nothing of use lies beyond, and OpenCV's fixed point overflows
    if not (math.isfinite(angle_deg) and max(abs(u), abs(v), a, b) < reach_px):
        return
    points = np.asarray(cv2.ellipse2Poly((0, 0), (1000, 1000), 0, 0, 360, 4), np.float64)[:-1] / 1000.0
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    x, y = points[:, 0] * max(a, 2.0), points[:, 1] * max(b, 2.0)
    outline = np.stack([u + x * cosine - y * sine, v + x * sine + y * cosine], axis=-1)
    fixed = np.rint(outline * (1 << SUBPIXEL_BITS)).astype(np.int32)
    if obstacle.coasting:
        dashes = [
            np.take(fixed, range(start, start + 4), axis=0, mode="wrap") for start in range(0, len(fixed), 6)
        ]
        cv2.polylines(picture, dashes, False, colour, thickness, cv2.LINE_AA, SUBPIXEL_BITS)
        return
    cv2.polylines(picture, [fixed], True, INK, thickness + 2, cv2.LINE_AA, SUBPIXEL_BITS)
    cv2.polylines(picture, [fixed], True, colour, thickness, cv2.LINE_AA, SUBPIXEL_BITS)


def _caption(picture: Picture, text: str) -> Picture:
    put_text(picture, text, PADDING_PX, picture.shape[0] - 2 * PADDING_PX, 0.9 * text_scale(picture), WHITE)
    return picture


def _stack(headline: tuple[str, str], tiles: list[Picture]) -> Picture:
    height, width = tiles[0].shape[:2]
    scale = 1.2 * text_scale(tiles[0])
    bar_height = text_size("Ag", scale)[1] + 6 * PADDING_PX
    picture = np.empty((bar_height + 2 * height + GAP_PX, 2 * width + GAP_PX, 3), np.uint8)
    picture[:] = INK
    for index, tile in enumerate(tiles):
        top = bar_height + (index // 2) * (height + GAP_PX)
        start = (index % 2) * (width + GAP_PX)
        picture[top : top + height, start : start + width] = tile
    facts, warning = headline
    put_text(picture, facts, 10, bar_height - 3 * PADDING_PX, scale, WHITE)
    put_text(picture, warning, width + GAP_PX + 10, bar_height - 3 * PADDING_PX, scale, GREEN)
    return picture
