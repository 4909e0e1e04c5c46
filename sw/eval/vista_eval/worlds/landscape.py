"""The background of a scene: rows of trees, forest, distant houses, hills."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Sway, Thing, thing
from vista_eval.worlds import street, things
from vista_eval.worlds.triangles import Triangles, placed
from vista_eval.worlds.vegetation import TREES, crown


def tree_row(
    x_m: tuple[float, float],
    half_width_m: float,
    seed: int,
    spacing_m: float = 4.0,
    tuft_m: float = 0.55,
    name: str = "tree_row",
    gap_m: float = 0.0,
    sway: Sway | None = None,
) -> Thing:
    """Trees of several kinds whose crowns meet: one thing; none within `gap_m` of the plane y = 0."""
    rng = np.random.default_rng((seed, 2))
    trees = []
    for y in np.arange(-half_width_m, half_width_m, spacing_m):
        foot = (rng.uniform(*x_m), y + rng.uniform(-1.5, 1.5), 0.0)
        height = rng.uniform(6.0, 13.0)
        form = rng.choice(["broadleaf", "conifer", "poplar"], p=[0.65, 0.25, 0.1])
        spread = height * {"broadleaf": 0.32, "conifer": 0.2, "poplar": 0.12}[form]
        if abs(foot[1]) - 1.3 * spread > gap_m or gap_m == 0:
            trees.append(placed(TREES[form](height, spread, rng, tuft_m), foot))
    return thing(
        name, "tree line", [things.mesh(f"{name}{k}", tree) for k, tree in enumerate(trees)], sway=sway
    )


def forest(x_m: float, seed: int) -> Thing:
    """A closed canopy, seen from so far that single leaves do not count; hides the edge of the ground."""
    rng = np.random.default_rng((seed, 3))
    half_width = 0.5 * x_m
    y = np.arange(-half_width, half_width, 3.5)
    centers = np.stack([x_m + rng.uniform(0, 25, len(y)), y, rng.uniform(2.5, 6.0, len(y))], 1)
    radii = rng.uniform(3.5, 6.0, (len(y), 1)) * [1.0, 1.0, 1.2]
    return thing("forest", "forest", [things.mesh("forest", crown(centers, radii, 1.0, 0.12, rng))])


def far_houses(x_m: float, seed: int) -> list[Thing]:
    """A street front across the view, with gaps."""
    rng = np.random.default_rng((seed, 4))
    houses: list[Thing] = []
    y = 0.45 * x_m
    while y > -0.45 * x_m:
        width = rng.uniform(10, 26)
        depth = x_m + rng.uniform(0, 12)
        height = street.FLOOR_M * rng.integers(2, 6) + 0.8
        ends = (depth, y, 0.0), (depth, y - width, 0.0)
        style = street.any_style(rng)
        name, texel_m = f"far_house{len(houses)}", 0.6e-3 * x_m
        house_seed = int(rng.integers(1 << 30))
        houses.append(things.house(name, *ends, height, 9.0, style, house_seed, texel_m=texel_m))
        y -= width + rng.choice([0.0, rng.uniform(2, 12)])
    return houses


HILLS_FOOT_X_M, HILLS_CREST_X_M = 1360.0, 1450.0  # short of HORIZON_M, where the ground ends
HILLS_HALF_WIDTH_M = 640.0  # the view's at the crest, and what roll and yaw add
HILLS_OVER_EYE_M = 18.0
HILLS_TREE_M = 5.0
HILLS_ROWS = 9


def hills(altitude_m: float, seed: int) -> Thing:
    """A wooded ridge across the view, 14 to 22 m higher than the camera: 9 to 15 pixels above the horizon, so
    that what stands against the sky still does."""
    rng = np.random.default_rng((seed, 12))
    y = np.arange(-HILLS_HALF_WIDTH_M, HILLS_HALF_WIDTH_M, HILLS_TREE_M)
    waves = [np.sin(2 * np.pi * (y / length + rng.uniform())) for length in (910.0, 370.0, 140.0)]
    relief_m = np.dot([1.8, 1.1, 0.5], waves) + rng.uniform(-0.6, 0.6, len(y))
    crest_m = altitude_m + HILLS_OVER_EYE_M + relief_m
    up = np.linspace(0.0, 1.0, HILLS_ROWS)[:, None]
    x = HILLS_FOOT_X_M + (HILLS_CREST_X_M - HILLS_FOOT_X_M) * up
    vertices_m = np.stack(np.broadcast_arrays(x, y, up * crest_m), axis=-1).reshape(-1, 3)
    row, column = (each.ravel() for each in np.mgrid[: HILLS_ROWS - 1, : len(y) - 1])
    a = row * len(y) + column
    b = a + len(y)
    faces = np.concatenate([np.stack([a, a + 1, b], 1), np.stack([a + 1, b + 1, b], 1)])
    albedo = np.clip(0.09 * rng.lognormal(0.0, 0.4, len(vertices_m)), 0.03, 0.3)
    return thing("hills", "hills", [things.mesh("hills", Triangles(vertices_m, faces, albedo))])
