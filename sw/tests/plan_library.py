"""The planner over simple worlds, for its tests: what a camera in them sees, and what is decided.

World: x to the right, y down, z forward. The vehicle looks along z unless it says otherwise."""

from __future__ import annotations

import numpy as np
from space_library import SPACE_FRAMES, Space, Wall, scene, with_faces
from stage_library import ffi, lib, parameters, status_name
from track_library import SECOND
from vista.plan import Decision

UP = np.array([0.0, -1.0, 0.0])
AHEAD = np.array([0.0, 0.0, 1.0])
RADIUS_M = 1.0
GROUND_M = 8.0
SIDE_M = 0.5 * RADIUS_M  # of a cube of the surroundings


def vehicle_parameters(**changes):
    """changes: section__name=number or name of a choice."""
    made = parameters({"obstacle_map.collision_radius_m": RADIUS_M})
    for name, value in changes.items():
        set_it = lib.vista_parameters_set_choice if isinstance(value, str) else lib.vista_parameters_set
        text = value.encode() if isinstance(value, str) else value
        assert set_it(made, name.replace("__", ".").encode(), text) == lib.VISTA_OK
    return made


class Planner:
    """A vista_planner and the decision that it made last."""

    def __init__(self, **changes) -> None:
        self.handle = ffi.new("vista_planner *")
        self.parameters = vehicle_parameters(**changes)
        assert lib.vista_planner_start(self.handle, self.parameters) == lib.VISTA_OK

    def decide(self, space: Space, state, goal, obstacles=(), tracks=()) -> Decision:
        status, decision = self.try_to(space, state, goal, obstacles, tracks)
        assert status == "VISTA_OK"
        return decision

    def try_to(self, space: Space, state, goal, obstacles=(), tracks=()) -> tuple[str, Decision]:
        seen, directions = ffi.new("vista_pipeline_stages *"), ffi.new("vista_directions *")
        items, faces = with_faces(space.frame, obstacles)
        followed = ffi.new("vista_track[]", list(tracks))
        seen.frame, seen.space = space.frame, space.handle
        seen.obstacles, seen.obstacle_count, seen.faces = items, len(items), faces
        seen.tracks, seen.track_count = followed, len(followed)
        lib.vista_free_directions(space.frame, space.handle, items, faces, len(items), directions)
        decision = ffi.new("vista_plan_decision *")
        status = lib.vista_planner_decide_in(self.handle, seen, directions, state, goal, decision)
        return status_name(status), Decision.copied(ffi, decision)


def state_of(position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), t_s: float = 1.0, heading=AHEAD, **more):
    values = {
        "t_ns": round(t_s * SECOND),
        "position_m": list(map(float, position)),
        "velocity_m_s": list(map(float, velocity)),
        "up": UP.tolist(),
        "heading": list(map(float, heading)),
    }
    return ffi.new("vista_plan_state *", values | more)


def goal_of(to=(0.0, 0.0, 200.0), speed_m_s: float = 5.0, origin=None, passed: bool = True):
    values = {
        "from_m": list(map(float, to if origin is None else origin)),
        "to_m": list(map(float, to)),
        "speed_m_s": speed_m_s,
        "passed": passed,
    }
    return ffi.new("vista_plan_goal *", values)


def seen_world(
    walls=(), ground_y_m: float | None = GROUND_M, frames: int = SPACE_FRAMES, **keywords
) -> Space:
    """The map of a camera that has stood at the origin for some frames before second 1."""
    space = Space(collision_radius_m=RADIUS_M)
    look = scene(walls, ground_y_m, **keywords)
    for k in range(frames):
        space.take(look, 1.0 - 0.1 * (frames - 1 - k), up_camera=UP)
    return space


def distance_m(point, wall: Wall) -> float:
    x, y, z = point
    aside = max(wall.x_m[0] - x, 0.0, x - wall.x_m[1]), max(wall.y_m[0] - y, 0.0, y - wall.y_m[1])
    return float(np.hypot(np.hypot(*aside), wall.z_m - z))


class Surroundings:
    """The surroundings of a vehicle at its camera, as its planner keeps them."""

    def __init__(self) -> None:
        self.planner, self.space = Planner(), Space(collision_radius_m=RADIUS_M)
        self.asked = ffi.new("vista_plan_space *")

    def take(
        self, walls: list[Wall], position, t_s: float, turn=None, ground_y_m: float | None = 20.0
    ) -> None:
        turn = np.eye(3) if turn is None else turn
        position = np.asarray(position, float)
        self.space.take(scene(walls, ground_y_m, position, turn), t_s, up_camera=turn.T @ UP)
        self.ask_at(position, t_s)

    def ask_at(self, position, t_s: float) -> None:
        self.asked.seen.frame, self.asked.seen.space = self.space.frame, self.space.handle
        self.asked.planner, self.asked.t_ns = self.planner.handle, round(t_s * SECOND)
        self.asked.radius_m, self.asked.start_m = RADIUS_M, list(map(float, position))
        self.asked.looks = 0
        lib.vista_plan_take_surroundings(self.asked)

    @property
    def agree(self) -> np.ndarray:
        return np.frombuffer(ffi.buffer(self.planner.handle.agree), np.int8)

    def middle_m(self, place: int) -> np.ndarray:
        return (np.array(list(self.planner.handle.cubes[place].at)) + 0.5) * SIDE_M

    @property
    def standing_m(self) -> list[np.ndarray]:
        found = []
        for place in self.asked.standing[0 : self.asked.standing_count]:
            cube = self.planner.handle.cubes[place]
            found.append(np.array(list(cube.at)) * SIDE_M + np.array(list(cube.from_corner_m)))
        return found

    def stands_near(self, point, within_m: float) -> bool:
        return bool(lib.vista_plan_stands_within(self.asked, list(map(float, point)), within_m) < within_m)

    def was_free(self, point, within_m: float = 0.5 * RADIUS_M) -> bool:
        return bool(lib.vista_plan_was_free(self.asked, list(map(float, point)), within_m))

    def stood_at(self, point) -> bool:
        return bool(lib.vista_plan_stood_at(self.asked, list(map(float, point))))

    def is_free(self, point) -> bool:
        """The planner's own look at a place, in the map of space and in the surroundings."""
        place = lib.vista_plan_look(self.asked, list(map(float, point)), 0.0)
        return bool(place.ruling == lib.VISTA_PLAN_CHOSEN)


class Flight:
    """A vehicle that flies exactly what is decided, once a tenth of a second."""

    def __init__(self, walls, goal, velocity=(0.0, 0.0, 0.0), **changes) -> None:
        self.walls, self.goal = list(walls), goal
        self.space, self.planner = Space(collision_radius_m=RADIUS_M), Planner(**changes)
        self.t_s, self.position_m = 1.0, np.zeros(3)
        self.velocity, self.acceleration, self.heading = np.array(velocity), np.zeros(3), AHEAD
        self.clearance_m, self.way_m = np.inf, 0.0
        self.decisions: list[Decision] = []

    def step(self, seconds: float = 0.1) -> Decision:
        """Looks, decides, and flies on for so long."""
        right = np.cross([0.0, 1.0, 0.0], self.heading)
        turn = np.stack([right / np.linalg.norm(right), [0.0, 1.0, 0.0], self.heading], 1)
        look = scene(self.walls, 20.0, self.position_m, turn)
        self.space.take(look, self.t_s, self.velocity, up_camera=turn.T @ UP)
        state = state_of(
            self.position_m,
            self.velocity,
            self.t_s,
            self.heading,
            acceleration_m_s2=self.acceleration.tolist(),
        )
        decision = self.planner.decide(self.space, state, self.goal)
        self.decisions.append(decision)
        for k in range(1, round(10 * seconds) + 1):
            at = decision.at(0.1 * k)
            self.way_m += float(np.linalg.norm(at.position_m - self.position_m))
            self.position_m = np.array(at.position_m)
            near_m = [distance_m(self.position_m, wall) for wall in self.walls]
            self.clearance_m = min([self.clearance_m, *near_m])
        self.velocity, self.acceleration = np.array(at.velocity_m_s), np.array(at.acceleration_m_s2)
        self.heading, self.t_s = np.array(at.heading), self.t_s + seconds
        return decision
