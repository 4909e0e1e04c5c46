"""What the scenes promise: targets stand in the way, clear scenes leave it free."""

from __future__ import annotations

import numpy as np
import pytest
from vista_eval.render.scene import Mesh, Scene, Solid, Thing, bounds_m
from vista_eval.worlds import grounds, street
from vista_eval.worlds.catalog import FLIGHTS
from vista_eval.worlds.meadow_flights import FIRST_X_M, LAST_X_M

pytestmark = pytest.mark.slow

CYLINDER_RADIUS_M, CYLINDER_LENGTH_M = 2.0, 100.0
SWAY_M = 0.5  # of the aircraft about its path, and more


@pytest.fixture
def plain_surfaces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Paints ground and walls grey: their textures take most of a scene's time and none of its shape."""
    grey = grounds.Cover(lambda x, y, seed: 0.0 * (x + y) + 0.2, 0.2)
    for cover in grounds.COVERS:
        monkeypatch.setitem(grounds.COVERS, cover, grey)

    def grey_wall(width_m: float, height_m: float, *_: object, texel_m: float = street.TEXEL_M) -> np.ndarray:
        return np.full((round(height_m / texel_m), round(width_m / texel_m)), 0.4, np.float32)

    monkeypatch.setattr(street, "wall_texture", grey_wall)


def boxes_m(solid: Solid) -> tuple[np.ndarray, np.ndarray]:
    """(N, 3) lowest and highest corners: of each triangle of a mesh, of the solid otherwise."""
    if isinstance(solid, Mesh):
        corners = solid.vertices_m[solid.faces]
        return corners.min(axis=1), corners.max(axis=1)
    low, high = bounds_m(solid)
    return low[None], high[None]


def from_path_m(thing: Thing, height_m: float) -> float:
    """Least distance of the thing's boxes from the path, which goes on along x to the cylinder's last end."""
    nearest = np.inf
    for solid in thing.solids:
        low, high = boxes_m(solid)
        along = (high[:, 0] > FIRST_X_M) & (low[:, 0] < LAST_X_M + CYLINDER_LENGTH_M)
        axis = np.array([0.0, height_m])
        outside = np.maximum(low[along, 1:] - axis, axis - high[along, 1:]).clip(min=0)
        nearest = min(nearest, np.linalg.norm(outside, axis=1).min(initial=np.inf))
    return nearest


def check_things(scene: Scene) -> None:
    names = [thing.name for thing in scene.things]
    assert len(set(names)) == len(names) <= 254  # labels are bytes
    solids = [solid.name for solid in scene.solids]
    assert len(set(solids)) == len(solids) < 1500
    for thing in scene.things:
        assert thing.solids, thing.name
        for solid in thing.solids:
            albedo = np.asarray(solid.albedo)
            assert np.isfinite(albedo).all(), solid.name
            assert 0 <= albedo.min() <= albedo.max() <= 1, solid.name
            if isinstance(solid, Mesh):
                assert solid.faces.max() < len(solid.vertices_m) == len(solid.albedo), solid.name


@pytest.mark.usefixtures("plain_surfaces")
@pytest.mark.parametrize("name", FLIGHTS)
def test_only_targets_stand_in_the_way(name: str) -> None:
    flight = FLIGHTS[name]
    altitude_m = flight.approach.altitude_m
    scene = flight.scene(altitude_m, flight.seed)
    check_things(scene)
    targets = [thing for thing in scene.things if thing.target]
    assert scene.things[: len(targets)] == tuple(targets)
    assert bool(targets) != name.startswith("clear_")
    for thing in scene.things:
        distance = from_path_m(thing, altitude_m)
        if thing.target:
            assert thing.standing
            assert distance < CYLINDER_RADIUS_M, thing.name
        else:
            assert distance > CYLINDER_RADIUS_M + (0 if targets else SWAY_M), thing.name
