"""What the scenes promise: targets stand in the way, clear scenes leave it free, seeds fix random scenes."""

from __future__ import annotations

import numpy as np
import pytest
from vista_eval.render.flight import Flight
from vista_eval.render.scene import Mesh, Scene, Solid, Thing, bounds_m
from vista_eval.worlds import grounds, street
from vista_eval.worlds.catalog import FLIGHTS
from vista_eval.worlds.labelled import FARTHEST_M, labelled
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


def same(a: Scene, b: Scene) -> bool:
    if len(a.solids) != len(b.solids) or a != b:  # arrays do not take part in ==
        return False
    pairs = zip(a.solids, b.solids, strict=True)
    return all(s.albedo.shape == t.albedo.shape and (s.albedo == t.albedo).all() for s, t in pairs)


def scene_of(flight: Flight) -> Scene:
    return flight.scene(flight.approach.altitude_m, flight.seed)


def test_a_seed_fixes_a_labelled_scene() -> None:
    assert labelled(11) == labelled(11) != labelled(12)
    scene, again, other = (scene_of(labelled(seed)) for seed in (11, 11, 12))
    assert same(scene, again) and not same(scene, other)


@pytest.mark.usefixtures("plain_surfaces")
def test_labelled_scenes_hold_standing_things_within_range() -> None:
    kinds: set[str] = set()
    for seed in range(12):
        scene = scene_of(labelled(seed))
        check_things(scene)
        near = [thing for thing in scene.things if thing.standing and thing.center_m[0] < FARTHEST_M + 10]
        kinds |= {thing.kind for thing in near}
        assert 2 <= len([thing for thing in near if bounds_m(thing.solids[0])[0][0] < FARTHEST_M]) <= 7, seed
        assert 2.5 <= labelled(seed).approach.altitude_m <= 9
        assert any(thing.kind == "hills" for thing in scene.things), seed
    assert len(kinds) >= 10
