"""A place to put content into: path, ground, light, and what stands around without being in the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vista_eval.render.course import Course
from vista_eval.render.motion import moved
from vista_eval.render.scene import Mesh, Point, Scene, Thing, thing
from vista_eval.worlds.courses import Courses
from vista_eval.worlds.draws import draws, log_uniform, some_seed
from vista_eval.worlds.grounds import COVERS
from vista_eval.worlds.landscape import far_houses, forest, hills, tree_row
from vista_eval.worlds.laying import Relief, ground
from vista_eval.worlds.light import light
from vista_eval.worlds.path import Path, clear_of, path_of
from vista_eval.worlds.standing import STANDING, Place
from vista_eval.worlds.triangles import turned

RURAL = ("broadleaf", "conifer", "poplar", "bare", "bush", "hedge", "bale", "picket fence", "rail fence")
URBAN = ("thin post", "lamp post", "car", "van", "person", "crates", "wall", "house", "bush")
BACKGROUND_M = (98.0, 160.0)
HILLS_TURN_DEG = 48.0


@dataclass(frozen=True)
class Site:
    seed: int
    altitude_m: float
    course: Course
    path: Path
    cover: str
    contrast: float
    relief: Relief | None = field(default=None, compare=False)

    def draws(self, purpose: str) -> np.random.Generator:
        return draws(self.seed, purpose)

    def ground_m(self, x_m: float, y_m: float) -> float:
        if self.relief is None:
            return 0.0
        return float(self.relief(np.array([[x_m]]), np.array([[y_m]]))[0, 0])

    def foot_m(self, x_m: float, y_m: float) -> tuple[float, float, float]:
        """A little into the ground, where that slopes."""
        around = [self.ground_m(x_m + dx, y_m + dy) for dx, dy in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))]
        return (x_m, y_m, min(around))


def site(altitude_m: float, seed: int, courses: Courses, covers: Sequence[str]) -> Site:
    rng = draws(seed, "cover")
    cover = str(rng.choice(list(covers)))
    course = courses.draw(seed)
    return Site(seed, altitude_m, course, path_of(course), cover, float(rng.uniform(0.45, 1.0)))


def ridges(altitude_m: float, seed: int, foot_m: float = 0.0) -> list[Thing]:
    """Ahead and to both sides, for flights that turn."""
    found = []
    for k, yaw_deg in enumerate((0.0, -HILLS_TURN_DEG, HILLS_TURN_DEG)):
        (solid,) = hills(altitude_m, seed + k).solids
        assert isinstance(solid, Mesh)
        vertices = (turned(solid.vertices_m, yaw_deg) + np.array([0.0, 0.0, foot_m])).astype(np.float32)
        found.append(thing(f"hills{k}", "hills", [replace(solid, name=f"hills{k}", vertices_m=vertices)]))
    return found


def background(site: Site, kinds: Sequence[str] = ("trees", "forest", "houses", "open")) -> list[Thing]:
    """Far off on level ground; a ridge closes the view."""
    rng = site.draws("background")
    kind, far_m, seed = rng.choice(list(kinds)), float(rng.uniform(*BACKGROUND_M)), some_seed(rng)
    found = ridges(site.altitude_m, seed)
    if kind == "trees":
        found.append(tree_row((far_m, far_m + 30), 0.5 * far_m + 10, seed))
    if kind == "houses":
        found += far_houses(far_m, seed)
    if kind in ("forest", "trees"):
        found.append(forest(far_m + 60, seed))
    return found


def clutter(site: Site, kinds: Sequence[str], most: int = 14) -> list[Thing]:
    """Puts up to `most` things at 3 to 35 m beside the path and up to 100 m beyond its end."""
    rng = site.draws("clutter")
    first_m = site.path.points_m[0, 0]
    found: list[Thing] = []
    for k in range(int(rng.integers(most // 3, most + 1))):
        kind = str(rng.choice(list(kinds)))
        x = float(rng.uniform(first_m + 15, 100))
        y = site.path.y_m(x) + float(rng.choice([-1, 1])) * log_uniform(rng, 3.0, 35.0)
        foot = site.foot_m(x, y)
        # The makers take the range for the distance along x, which decides how fine they are.
        range_m = float(np.clip(max(x + 12.0, 3 * abs(y)), 12.0, 90.0))
        place = Place(f"{kind}{k}", (range_m, *foot[1:]), site.altitude_m, some_seed(rng))
        _, _, build = STANDING[kind]
        found.append(shifted(build(place, rng), (x - range_m, 0.0, 0.0)))
    return found


def shifted(its: Thing, by_m: Point) -> Thing:
    by = np.array(by_m)
    solids = tuple(moved(solid, by) for solid in its.solids)
    x, y, z = (float(c) for c in its.center_m + by)
    return replace(its, solids=solids, center_m=(x, y, z))


def scene_of(
    site: Site,
    target: Sequence[Thing],
    around: Sequence[Thing],
    meets_at_m: float | None = 0.0,
    meets_ground: bool = False,
) -> Scene:
    """Ground, target, and of the rest what leaves the path free until `meets_at_m` (None: all along)."""
    path = site.path if meets_at_m is None else site.path.until(meets_at_m + 3.0)
    flown = site.path.points_m[: site.path.flown : 8]
    lowest_m = min(float(z) - site.ground_m(float(x), float(y)) for x, y, z in flown)
    base = ground(
        site.path, max(lowest_m, 1.0), site.cover, site.contrast, site.seed, site.relief, meets_ground
    )
    things = [base, *target, *clear_of(path, around)]
    return Scene(tuple(things), **light(site.seed, COVERS[site.cover].mean))
