"""Pictures of one frame: what the chain saw and what it concluded, side by side.

    left image, obstacles | disparity
    ----------------------+----------
    log-polar cells       | regions of the cut

Obstacles on the collision course are red ellipses; the nearest of them is drawn thicker and is labelled with
its distance and the time left. Other tracked obstacles are yellow, and tracks that are not confirmed yet are
thin and grey. The ellipse of an obstacle that is not seen in this frame is dashed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.engine import SCALE
from vista.geometry import Calibration
from vista.health.finding import FrameHealth, State
from vista.report.labels import FONT, PADDING_PX, Labels, obstacle_name, put_text, text_scale, text_size
from vista.report.palette import ALARM, GREY, INK, RED, WHITE, YELLOW, Colour, RegionColours
from vista.sequence.types import Frame

if TYPE_CHECKING:
    from vista.pipeline import Nearest, Obstacle, Result

Picture = NDArray[np.uint8]  # HxWx3, BGR
GAP_PX = 4
HEADLINE_INSET_PX = 10
MAX_LABELS = 16  # the nearest; more hide the scene
SUBPIXEL_BITS = 4
HEALTHY = FrameHealth()


Box = tuple[int, int, int, int]  # left, top, width, height


def panel_tiles(width: int, height: int) -> list[Box]:
    """Places of the four tiles in the picture of a frame of this size, below the bar with the headline."""
    bar = _bar_height(width, height)
    return [((k % 2) * (width + GAP_PX), bar + (k // 2) * (height + GAP_PX), width, height) for k in range(4)]


class Overlay:
    """Draws the frames of one run; it remembers the colours of the regions."""

    def __init__(
        self, name: str, num_disparities: int, camera: Calibration | None = None, stills: bool = False
    ) -> None:
        """camera: of the rectified images, for distances beside the disparity; stills: unrelated pictures."""
        self._name = name
        self._num_disparities = num_disparities
        self._focal_baseline_px_m = None if camera is None else camera.focal_px * camera.baseline_m
        self._unit, self._warning = ("picture", "ahead") if stills else ("frame", "collision")
        self._region_colours = RegionColours()

    def draw(
        self,
        frame: Frame,
        result: Result,
        health: FrameHealth = HEALTHY,
    ) -> Picture:
        """frame: rectified; result: what the host made of it."""
        nearest = None if health.state == State.BLIND else result.nearest_collision
        foveated = np.clip(np.rint(result.cell_intensity), 0, 255).astype(np.uint8)[result.cell_of_pixel]
        colours = self._region_colours.assign(result.region_of_cell)
        tiles = [
            self.obstacles(frame, result, nearest),
            draw_disparity(result.words, self._num_disparities, self._focal_baseline_px_m),
            _caption(_coloured(foveated), "log-polar cells"),
            draw_regions(self._shown(frame), result.region_of_pixel, colours, result.verdict_of_region),
        ]
        return _stack(self._headline(frame, result, health, nearest), tiles)

    def obstacles(self, frame: Frame, result: Result, nearest: Nearest | None) -> Picture:
        """The first tile by itself."""
        name = "left image" if frame.words is None else "disparities"
        return draw_obstacles(self._shown(frame), result.obstacles, nearest, name)

    def _shown(self, frame: Frame) -> NDArray[np.uint8]:
        """The left image; where the images stayed elsewhere, the disparities, the nearer the brighter."""
        return frame.left if frame.words is None else _nearness(frame.words[0], self._num_disparities)

    def _headline(
        self, frame: Frame, result: Result, health: FrameHealth, nearest: Nearest | None
    ) -> tuple[str, str]:
        things = 0 if health.state == State.BLIND else sum(o.is_thing for o in result.obstacles)
        facts = f"{self._name}   {self._unit} {frame.index}   {things} obstacle{'s' * (things != 1)}"
        seen_m = result.path_seen_m if nearest is None else min(result.path_seen_m, nearest.distance_m)
        with_path = facts + f"   path seen to {seen_m:.0f} m"
        height, width = frame.left.shape
        # Not of stills, which have no flight path, and not where it would run below the warning beside it.
        if (
            self._unit == "frame"
            and text_size(with_path, _headline_scale(width, height))[0] <= width - 2 * HEADLINE_INSET_PX
        ):
            facts = with_path
        warnings = [] if health.state == State.HEALTHY else [str(health.state)]
        if nearest is not None:
            warnings.insert(0, f"{self._warning}: {obstacle_name(nearest.id)}  {_distance_and_time(nearest)}")
        return facts, "   ".join(warnings)


def draw_obstacles(
    image: NDArray[np.uint8], obstacles: list[Obstacle], nearest: Nearest | None, name: str = "left image"
) -> Picture:
    """Ellipses and labels over an image, whose name the caption has. What is nearer is drawn later and gets
    its label earlier; what is on the collision course comes before everything else."""
    picture = _coloured(image)
    nearest_id = None if nearest is None else nearest.id

    def importance(obstacle: Obstacle) -> tuple[bool, bool, bool, float]:
        course = on_collision_course(obstacle)
        return obstacle.id != nearest_id, not course, not obstacle.confirmed, obstacle.distance_m

    shown = sorted((o for o in obstacles if o.confirmed or not o.coasting), key=importance)
    for obstacle in reversed(shown):
        thickness = 4 if obstacle.id == nearest_id else 2 if obstacle.confirmed else 1
        _draw_ellipse(picture, obstacle, _colour(obstacle, nearest_id), thickness)
    labels = Labels(picture)
    labelled = [o for o in shown if o.id == nearest_id or (o.confirmed and not o.coasting)]
    for obstacle in labelled[: MAX_LABELS + 1]:
        if nearest is not None and obstacle.id == nearest_id:
            labels.reserve(
                f"{obstacle_name(obstacle.id)}  {_distance_and_time(nearest)}", *_top(obstacle), WHITE, ALARM
            )
            continue
        where = "near" if obstacle.in_blind_zone else _distance(obstacle.distance_m)
        labels.reserve(
            f"{obstacle_name(obstacle.id)}  {where}", *_top(obstacle), _colour(obstacle, nearest_id)
        )
    labels.draw()
    return _caption(picture, f"{name}, obstacles")


def on_collision_course(obstacle: Obstacle) -> bool:
    return obstacle.confirmed and obstacle.in_collision_volume


def _colour(obstacle: Obstacle, nearest_id: int | None) -> Colour:
    if obstacle.id == nearest_id or on_collision_course(obstacle):
        return RED
    return YELLOW if obstacle.confirmed else GREY


def _nearness(words: NDArray[np.int16], num_disparities: int) -> NDArray[np.uint8]:
    """0 without a disparity or with that of 0, 255 for the largest one."""
    levels = words.astype(np.float32) * (255.0 / (SCALE * (num_disparities - 1)))
    return np.asarray(np.clip(levels, 0, 255), np.uint8)


def draw_disparity(
    words: NDArray[np.int16], num_disparities: int, focal_baseline_px_m: float | None = None
) -> Picture:
    """Near is red, far is blue, invalid is dark. A scale gives the distances if the product of focal length
    and baseline is given."""
    picture = _turbo(_nearness(words, num_disparities))
    picture[words < 0] = INK
    valid = 100.0 * np.mean(words >= 0)
    text = f"disparity 0 to {num_disparities - 1} px, {valid:.0f} % valid"
    if focal_baseline_px_m is not None:
        scale = 0.9 * text_scale(*words.shape)
        _draw_scale(picture, text_size(text, scale)[0], focal_baseline_px_m / (num_disparities - 1))
    return _caption(picture, text)


def _draw_scale(picture: Picture, caption_px: int, nearest_m: float) -> None:
    """A colour bar right of the caption, with distances; its right end is the nearest that is measured."""
    rows, columns = picture.shape[:2]
    scale = 0.9 * text_scale(rows, columns)
    text_height = text_size("0", scale)[1]
    left, right = max(columns // 2, caption_px + 6 * PADDING_PX), columns - 3 * PADDING_PX
    bottom = rows - 2 * PADDING_PX
    top = bottom - text_height
    baseline = top - 2 * PADDING_PX
    if right - left < 8 * text_height or baseline < 2 * text_height:
        return  # no room
    picture[baseline - text_height - PADDING_PX :, left - 2 * PADDING_PX :] = INK
    ramp = np.linspace(0, 255, right - left).astype(np.uint8)[np.newaxis]
    picture[top:bottom, left:right] = _turbo(ramp)
    free_to = right + 2 * PADDING_PX
    for distance_m in round_distances(nearest_m):
        x = left + round((right - left - 1) * nearest_m / distance_m)
        text = f"{distance_m:.2g} m" if distance_m < 100.0 else f"{distance_m:.0f} m"
        width = text_size(text, scale)[0]
        start = min(x - width // 2, free_to - width)
        if start < left or abs(start + width // 2 - x) > width // 2:
            continue  # it would cover its neighbour
        picture[top - PADDING_PX : bottom, x] = WHITE
        cv2.putText(picture, text, (start, baseline), FONT, scale, WHITE, 1, cv2.LINE_AA)
        free_to = start - 2 * PADDING_PX


def round_distances(nearest_m: float) -> list[float]:
    """The nearest distance that can be measured, and 1, 2, 5, 10 ... above it, three decades far."""
    decade = math.floor(math.log10(nearest_m))
    steps = [factor * 10.0**power for power in range(decade, decade + 4) for factor in (1.0, 2.0, 5.0)]
    return [nearest_m] + [step for step in steps if step > nearest_m]


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
    grey = cv2.multiply(left, grey_share[labels], scale=1.0 / 255.0)
    picture = np.asarray(cv2.add(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), tint[labels]), np.uint8)
    picture[_borders(labels)] = INK
    return _caption(picture, f"{len(accepted)} regions of the cut, {accepted.sum()} accepted (full colour)")


def _coloured(grey: NDArray[np.uint8]) -> Picture:
    return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), np.uint8)


def _turbo(levels: NDArray[np.uint8]) -> Picture:
    return np.asarray(cv2.applyColorMap(levels, cv2.COLORMAP_TURBO), np.uint8)


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
    half_height_px = math.hypot(ellipse.axis_a_px * math.sin(angle), ellipse.axis_b_px * math.cos(angle))
    return ellipse.center_u_px, ellipse.center_v_px - half_height_px


def _draw_ellipse(picture: Picture, obstacle: Obstacle, colour: Colour, thickness: int) -> None:
    u, v, a, b, angle_deg = obstacle.ellipse.memory.item()
    reach_px = 4 * picture.shape[1]  # nothing of use lies beyond, and OpenCV's fixed point overflows
    if not (math.isfinite(angle_deg) and max(abs(u), abs(v), a, b) < reach_px):
        return
    points = np.asarray(cv2.ellipse2Poly((0, 0), (1000, 1000), 0, 0, 360, 4), float)[:-1] / 1000.0
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
    scale = 0.9 * text_scale(*picture.shape[:2])
    put_text(picture, text, PADDING_PX, picture.shape[0] - 2 * PADDING_PX, scale, WHITE)
    return picture


def _headline_scale(width: int, height: int) -> float:
    return 1.2 * text_scale(height, width)


def _bar_height(width: int, height: int) -> int:
    return text_size("Ag", _headline_scale(width, height))[1] + 6 * PADDING_PX


def _stack(headline: tuple[str, str], tiles: list[Picture]) -> Picture:
    height, width = tiles[0].shape[:2]
    bar_height = _bar_height(width, height)
    picture = np.empty((bar_height + 2 * height + GAP_PX, 2 * width + GAP_PX, 3), np.uint8)
    picture[:] = INK
    for tile, (left, top, _, _) in zip(tiles, panel_tiles(width, height), strict=True):
        picture[top : top + height, left : left + width] = tile
    facts, warning = headline
    scale = _headline_scale(width, height)
    put_text(picture, facts, HEADLINE_INSET_PX, bar_height - 3 * PADDING_PX, scale, WHITE)
    if warning:
        left = width + GAP_PX + HEADLINE_INSET_PX
        put_text(picture, warning, left, bar_height - 3 * PADDING_PX, scale, WHITE, ALARM)
    return picture
