"""A flight as a film: what the camera sees with what was found in it, beside a view from above with what
stands there, what was known of it at that moment, and what was decided."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import chain, pairwise
from pathlib import Path

import cv2
import numpy as np
from vista.pipeline import Directions
from vista.report.overlay import draw_obstacles

from vista_eval.closed_loop.collision import triangles_of
from vista_eval.closed_loop.loop import Flight, Moment
from vista_eval.render.motion import moves, solids_at
from vista_eval.render.scene import Solid

SIDE_PX = 480
VIEW_M, WIDE_M = 56.0, 160.0  # that the map shows, from one side to the other; of a fixed wing
BAND_M = 1.5  # above and below the flight, of what the map shows
BAR_PX = 46
WHITE, INK, SOFT = (245, 245, 245), (40, 40, 40), (150, 150, 150)
RED, GREEN, BLUE, AMBER = (60, 60, 220), (90, 190, 90), (210, 140, 60), (40, 170, 240)
OF_ACTION = {
    "proceeds": GREEN,
    "looks": SOFT,
    "arrived": GREEN,
    "evades": AMBER,
    "brakes": AMBER,
    "holds": AMBER,
}
FREE_TINT = np.array([200, 240, 200])
Picture = np.ndarray


class Map:
    """The view from above, north to the left as the flight begins: x to the right, y up."""

    def __init__(self, flight: Flight) -> None:
        self.world = flight.world
        self.view_m = WIDE_M if flight.conditions.vehicle == "fixed-wing" else VIEW_M
        self.track_m = np.array([moment.state.position_m for moment in flight.moments])
        things = [thing for thing in self.world.scene.things if thing.standing]
        self.heights_m = self.track_m[:, 2].min() - BAND_M, self.track_m[:, 2].max() + BAND_M
        self.moving = [thing for thing in things if moves(thing)]
        corners = joined(solid for thing in things if not moves(thing) for solid in thing.solids)
        low_m, high_m = self.track_m.min(axis=0) - self.view_m / 2, self.track_m.max(axis=0) + self.view_m / 2
        self.middle_m = (low_m + high_m) / 2
        width, height = np.ceil((high_m - low_m)[:2] * SIDE_PX / self.view_m).astype(int)
        self.still = self.outlines(corners, self.middle_m, (int(width), int(height)))

    def draw(self, moment: Moment, until: int) -> Picture:
        center = moment.state.position_m
        picture = np.full((SIDE_PX, SIDE_PX, 3), 255, np.uint8)
        if moment.record is not None and moment.record.directions is not None:
            self.draw_free(picture, moment, moment.record.directions, center)
        self.draw_still(picture, center)
        if self.moving:
            now = joined(solid for thing in self.moving for solid in solids_at(thing, moment.t_s))
            picture[self.outlines(now, center, (SIDE_PX, SIDE_PX)) > 0] = INK
        route = [np.array(point) for point in self.world.route_m]
        for a, b in pairwise(route):
            cv2.line(picture, self.pixel(a, center), self.pixel(b, center), SOFT, 1, cv2.LINE_AA)
        cv2.circle(picture, self.pixel(route[-1], center), 5, GREEN, 2, cv2.LINE_AA)
        for points, kind in moment.decision.paths:
            colour = GREEN if kind == "chosen" else (190, 190, 230)
            line = np.array([self.pixel(point, center) for point in points], np.int32)
            cv2.polylines(picture, [line], False, colour, 2 if kind == "chosen" else 1, cv2.LINE_AA)
        track = np.array([self.pixel(point, center) for point in self.track_m[: until + 1]], np.int32)
        cv2.polylines(picture, [track], False, BLUE, 2, cv2.LINE_AA)
        if moment.record is not None:
            for obstacle in moment.record.things:
                spread = float(np.sqrt(np.trace(obstacle.covariance_m2[:2, :2]) / 2))
                half = max(float(obstacle.extent_m[0]) / 2, 0.2)
                colour = RED if obstacle.in_collision_volume else AMBER
                at = self.pixel(obstacle.position_m, center)
                cv2.circle(picture, at, max(3, self.pixels(half)), colour, 2, cv2.LINE_AA)
                cv2.circle(picture, at, max(3, self.pixels(half + spread)), colour, 1, cv2.LINE_AA)
        heading = moment.state.heading_rad
        nose = center + 1.5 * np.array([math.cos(heading), math.sin(heading), 0.0])
        cv2.circle(
            picture,
            self.pixel(center, center),
            max(3, self.pixels(self.world.radius_m)),
            INK,
            -1,
            cv2.LINE_AA,
        )
        cv2.line(picture, self.pixel(center, center), self.pixel(nose, center), INK, 2, cv2.LINE_AA)
        ruler = self.pixels(10.0)
        cv2.line(picture, (12, SIDE_PX - 14), (12 + ruler, SIDE_PX - 14), INK, 2)
        put(picture, "10 m", (16 + ruler, SIDE_PX - 10), INK, 0.42)
        return picture

    def draw_free(self, picture: Picture, moment: Moment, directions: Directions, center: np.ndarray) -> None:
        """The directions that are known to be free, as far as they are."""
        record = moment.record
        pose = None if record is None else record.world_from_camera
        if pose is None:
            return
        ahead = math.atan2(pose.rotation[1, 2], pose.rotation[0, 2])
        for k, free_m in enumerate(directions.free_m):
            if free_m <= 0:
                continue
            edges = [ahead - math.radians(Directions.FIRST_DEG + k + share) for share in (0.0, 1.0)]
            reach = min(float(free_m), 2 * self.view_m)
            corners = [pose.translation_m] + [
                pose.translation_m + reach * np.array([math.cos(a), math.sin(a), 0.0]) for a in edges
            ]
            points = np.array([self.pixel(corner, center) for corner in corners], np.int32)
            cv2.fillConvexPoly(picture, points, FREE_TINT.tolist())

    def draw_still(self, picture: Picture, center: np.ndarray) -> None:
        """What stands, moved to where the vehicle is in the middle."""
        middle = np.array(self.pixel(center, self.middle_m)) - SIDE_PX / 2
        at = middle + (np.array(self.still.shape[::-1]) - SIDE_PX) / 2
        shift = np.array([[1.0, 0.0, -at[0]], [0.0, 1.0, -at[1]]])
        picture[cv2.warpAffine(self.still, shift, (SIDE_PX, SIDE_PX), flags=cv2.INTER_NEAREST) > 0] = INK

    def outlines(self, corners: np.ndarray, center: np.ndarray, size_px: tuple[int, int]) -> np.ndarray:
        """An image of the triangles that reach into the heights of the flight."""
        low, high = corners[..., 2].min(axis=1), corners[..., 2].max(axis=1)
        chosen = corners[(low < self.heights_m[1]) & (high > self.heights_m[0])][..., :2] - center[:2]
        points = np.rint(np.array(size_px) / 2 + SIDE_PX / self.view_m * chosen * [1, -1]).clip(-20000, 20000)
        drawn = np.zeros(size_px[::-1], np.uint8)
        cv2.polylines(drawn, list(points.astype(np.int32)), True, 255, 1)
        return drawn

    def pixel(self, point: np.ndarray, center: np.ndarray) -> tuple[int, int]:
        right, up = point[0] - center[0], point[1] - center[1]
        scale = SIDE_PX / self.view_m
        return round(SIDE_PX / 2 + scale * float(right)), round(SIDE_PX / 2 - scale * float(up))

    def pixels(self, length_m: float) -> int:
        return round(min(length_m, self.view_m) * SIDE_PX / self.view_m)


def joined(solids: Iterable[Solid]) -> np.ndarray:
    """The triangles of all (n, 3, 3)."""
    return np.concatenate([np.zeros((0, 3, 3)), *map(triangles_of, solids)])


def put(picture: Picture, text: str, at: tuple[int, int], colour: tuple[int, int, int], scale: float) -> None:
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv2.LINE_AA)


def camera_view(moment: Moment) -> Picture:
    width = SIDE_PX * 4 // 3
    if moment.left is None or moment.record is None:
        return np.full((SIDE_PX, width, 3), 60, np.uint8)
    drawn = draw_obstacles(moment.left, moment.record.obstacles, moment.record.nearest_collision)
    return np.asarray(cv2.resize(drawn, (width, SIDE_PX), interpolation=cv2.INTER_CUBIC))


def frames_of(flight: Flight) -> Iterator[Picture]:
    seen = Map(flight)
    for k, moment in enumerate(flight.moments):
        yield frame_of(flight, seen, moment, k)


def frame_of(flight: Flight, seen: Map, moment: Moment, k: int) -> Picture:
    both = np.hstack([camera_view(moment), seen.draw(moment, k)])
    bar = np.full((BAR_PX, both.shape[1], 3), 25, np.uint8)
    speed = float(np.linalg.norm(moment.state.velocity_m_s))
    free = "" if moment.record is None else f"path free {moment.record.path_seen_m:.0f} m"
    last = k == len(flight.moments) - 1
    action = flight.end if last else moment.decision.action
    colour = RED if action == "collision" else OF_ACTION.get(action, AMBER)
    put(bar, f"{flight.world.name}   {moment.t_s:5.1f} s   {speed:4.1f} m/s   {free}", (10, 19), WHITE, 0.5)
    said = f"{action} {flight.hit}" if last else f"{action}  {moment.decision.why}"
    put(bar, said, (10, 39), colour, 0.5)
    put(bar, f"nearest {moment.near.distance_m:.1f} m", (both.shape[1] - 150, 39), WHITE, 0.5)
    return np.vstack([bar, both])


def write_film(path: Path, flight: Flight) -> None:
    """A WebM file, which browsers play."""
    frames = frames_of(flight)
    first = next(frames)
    size = first.shape[1], first.shape[0]
    with nothing_said():
        code = cv2.VideoWriter.fourcc(*"VP80")
        writer = cv2.VideoWriter(str(path), code, flight.conditions.rate_hz, size)
    frame = first
    for frame in chain([first], frames):
        writer.write(frame)
    for _ in range(round(flight.conditions.rate_hz)):  # the end stays for a second
        writer.write(frame)
    writer.release()


@contextmanager
def nothing_said() -> Iterator[None]:
    """Keeps what OpenCV prints about the name of the codec, which WebM does not store, from stderr."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)
