"""The map of space over numpy arrays, for its tests: simple worlds, the words that a camera in them has, and
the map that takes them. World: x to the right, y down, z forward, as a level camera sees it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stage_library import INVALID, Arena, Foveation, camera, ffi, frame_view, lib, parameters, rays, view
from track_library import SECOND, flight_path, motion, pose

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 320, 240, 300.0, 0.8
SPACE_FRAMES: int = lib.VISTA_SPACE_FRAMES
SPACING_S = 0.08  # of kept_lines.h: frames that follow closer count as one
TOLERANCE_PX, TOLERANCE_SHARE = 0.75, 0.03  # of evidence.h: what differs by less is at a place
RADIUS_M = 2.0
CHANGES = {"obstacle_map.collision_radius_m": RADIUS_M, "obstacle_map.path_sigmas": 0.0}


WITHOUT_END = (-1e3, 1e3)


@dataclass(frozen=True)
class Wall:
    """Upright, facing a level camera; without texture nothing of it is matched."""

    z_m: float
    x_m: tuple[float, float] = WITHOUT_END
    y_m: tuple[float, float] = WITHOUT_END
    textured: bool = True


@dataclass(frozen=True)
class Look:
    """What a camera at this place matches, and where that is ground."""

    words: NDArray[np.int16]
    ground: NDArray[np.bool_]
    pose: object


def seen_ellipse(frame, position_m, extent_m) -> dict[str, float]:
    """The ellipse of what is seen about a place, as wide and high as that."""
    turn = np.array(list(frame.motion.pose.rotation)).reshape(3, 3)
    camera_m = turn.T @ (np.array(list(position_m)) - np.array(list(frame.motion.pose.translation_m)))
    pixel_m = camera_m[2] / frame.camera.focal_px
    half_px = [0.5 * extent / pixel_m for extent in extent_m]
    return {
        "center_u_px": frame.camera.center_u_px + camera_m[0] / pixel_m,
        "center_v_px": frame.camera.center_v_px + camera_m[1] / pixel_m,
        "axis_a_px": max(half_px),
        "axis_b_px": min(half_px),
        "angle_deg": 0.0 if half_px[0] >= half_px[1] else 90.0,
    }


def with_faces(frame, obstacles):
    """Obstacles of a frame and their faces. One without an ellipse is seen in its extent."""
    items, faces = ffi.new("vista_obstacle[]", list(obstacles)), ffi.new("vista_face[]", len(obstacles))
    for k, item in enumerate(items):
        if item.ellipse.axis_a_px == 0.0:
            item.ellipse = seen_ellipse(frame, item.position_m, item.extent_m)
        faces[k] = lib.vista_face_of(frame, ffi.addressof(item))
    return items, faces


def scene(
    walls=(), ground_y_m: float | None = None, position=(0.0, 0.0, 0.0), rotation=None, lens=None
) -> Look:
    """rotation: world from camera. Beyond walls and ground is sky, of which nothing is matched."""
    lens = lens or camera(WIDTH, HEIGHT, FOCAL_PX, BASELINE_M)
    turn, place = np.eye(3) if rotation is None else np.asarray(rotation), np.asarray(position, float)
    x_ray, y_ray, z_ray = np.ascontiguousarray(
        np.moveaxis(rays(lens) @ turn.T, -1, 0)
    )  # of depth 1 in the camera
    depth_m, matched = np.full(z_ray.shape, np.inf), np.zeros(z_ray.shape, bool)
    ground = np.zeros(z_ray.shape, bool)
    with np.errstate(divide="ignore", invalid="ignore"):
        for wall in walls:
            at_m = (wall.z_m - place[2]) / z_ray
            hit = (at_m > 0.1) & (at_m < depth_m)
            for start, along, (low, high) in ((place[0], x_ray, wall.x_m), (place[1], y_ray, wall.y_m)):
                if (low, high) != WITHOUT_END:
                    over_m = start + at_m * along
                    hit &= (over_m >= low) & (over_m <= high)
            depth_m[hit], matched[hit] = at_m[hit], wall.textured
        if ground_y_m is not None:
            at_m = (ground_y_m - place[1]) / y_ray
            ground = (at_m > 0.1) & (at_m < depth_m)
            depth_m[ground], matched[ground] = at_m[ground], True
    words = np.rint(16.0 * lens.focal_px * lens.baseline_m / depth_m)
    words = np.where(matched & (words > 0), words, INVALID).astype(np.int16)
    return Look(words, ground, pose(place, turn))


class Space:
    """A vista_space_map with its memory, and the frame that it took last."""

    def __init__(self, lens=None, **changes: float) -> None:
        self.camera = lens or camera(WIDTH, HEIGHT, FOCAL_PX, BASELINE_M)
        self.parameters = parameters(CHANGES | {f"obstacle_map.{k}": v for k, v in changes.items()})
        self.foveation = Foveation(self.camera.width_px, self.camera.height_px)
        self.handle, self._surfaces = ffi.new("vista_space_map *"), ffi.new("vista_surfaces *")
        layout = lib.vista_space_map_layout
        self._arenas = [
            Arena(lambda arena: layout(self.handle, arena, self.camera)),
            Arena(lambda arena: lib.vista_surfaces_layout(self._surfaces, arena, self.foveation.handle)),
        ]
        self.frame = None

    def take(self, look: Look, t_s: float, velocity=None, length_m: float = 100.0, lines=(), **given) -> None:
        """lines: thin things that were found; given: members of the frame's view; its levels, if none are
        given: the words."""
        horizontal = view(self._surfaces.horizontal, self.foveation.node_count, np.uint8)
        ground = np.zeros(self.foveation.node_count)
        np.add.at(ground, self.foveation.cell_of_pixel[look.ground], 1)
        horizontal[:] = 2 * ground > view(
            self.foveation.handle.pixel_count, self.foveation.node_count, np.int32
        )
        moved = motion(look.pose, velocity)
        self.frame = frame_view(
            self.parameters,
            self.camera,
            foveation=self.foveation.handle,
            motion=moved,
            path=flight_path(moved, length_m),
            t_ns=round(t_s * SECOND),
            words=look.words,
            **({"levels": [look.words]} | given),
        )
        items = ffi.new("vista_thin_line[]", [line[0] for line in lines])
        found = ffi.new("vista_thin_lines *", [items, len(lines)])
        lib.vista_space_map_add(self.handle, self.frame, self._surfaces, found)

    def watch(self, look: Look, frames: int = SPACE_FRAMES, **keywords) -> None:
        """The same view again and again, at 10 Hz."""
        for k in range(frames):
            self.take(look, 0.1 * k, **keywords)

    def look(self, point, radius_m: float = RADIUS_M):
        return lib.vista_space_map_look(self.handle, [float(x) for x in point], radius_m)

    def look_around(self, point, radius_m: float = RADIUS_M, start=(0.0, 0.0, 0.0)):
        point, start = ([float(x) for x in place] for place in (point, start))
        return lib.vista_space_map_look_around(self.handle, point, radius_m, start)

    def reset(self) -> None:
        lib.vista_space_map_reset(self.handle)

    @property
    def times_s(self) -> list[float]:
        """Times of the frames that are kept, the newest first."""
        ages = range(self.handle.count)
        return [lib.vista_space_map_frame(self.handle, age).t_ns / SECOND for age in ages]


UNMATCHED = Look(np.full((HEIGHT, WIDTH), INVALID, np.int16), np.zeros((HEIGHT, WIDTH), bool), pose())


def disparity_px(lens, z_m: float) -> float:
    return lens.focal_px * lens.baseline_m / z_m


def tolerances_off_m(lens, z_m: float, count: float) -> float:
    """The depth so many tolerances of the map behind another one; negative: before it."""
    px = disparity_px(lens, z_m)
    return lens.focal_px * lens.baseline_m / (px - count * max(TOLERANCE_PX, TOLERANCE_SHARE * px))
