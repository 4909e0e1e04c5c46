"""Ground that is no plane: its surface, its texture and its light are where the arrays say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from vista_eval.cache import content_sha256
from vista_eval.render.motion import moved
from vista_eval.render.renderer import Renderer
from vista_eval.render.rig import LEFT, Rig
from vista_eval.render.scene import HeightField, Scene, bounds_m, thing

RIG = Rig(width_px=160, height_px=120, focal_px=250.0, baseline_m=0.4572)
X_M, Y_M = (0.0, 60.0), (-30.0, 30.0)
SLOPE = 0.2


def hill(albedo: np.ndarray) -> HeightField:
    """It rises along +x by SLOPE and along +y by half of that."""
    x, y = np.meshgrid(np.linspace(*X_M, 31), np.linspace(*Y_M, 13), indexing="ij")
    return HeightField("hill", X_M, Y_M, SLOPE * x + SLOPE / 2 * y, albedo)


def scene_of(field: HeightField) -> Scene:
    return Scene((thing("hill", "ground", [field], standing=False),), to_sun=(0.0, 0.0, 1.0), sky="overcast")


def pose_at(height_m: float) -> np.ndarray:
    """Level, 20 m before the field."""
    pose = np.eye(4)
    pose[:3, 3] = -20.0, 0.0, height_m
    return pose @ RIG.body_from_camera(LEFT)


def test_rows_of_the_albedo_run_along_x_and_columns_along_y() -> None:
    """One white texel of 6 m by 3 m on black: where it is bright, and where it is not."""
    albedo = np.zeros((10, 20), np.float32)
    albedo[3, 12] = 1.0  # x 18 to 24, y 6 to 9
    renderer, pose = Renderer(scene_of(hill(albedo)), RIG), pose_at(12.0)
    bright = (renderer.radiance(pose) > 0.5) & (renderer.view(pose).label == 1)
    shown = renderer.view(pose).world_points_m(RIG, pose)[bright]
    assert len(shown) > 20
    # Between the middles of texels the albedo changes linearly: it is 0 a texel away.
    assert shown.mean(axis=0)[:2] == pytest.approx([21.0, 7.5], abs=0.5)
    assert np.all(np.abs(shown[:, :2] - [21.0, 7.5]) < [5.5, 2.75])


def test_its_bounds_and_its_digest_are_those_of_its_arrays() -> None:
    field = hill(np.full((4, 4), 0.5))
    low, high = bounds_m(field)
    assert low == pytest.approx([0.0, -30.0, -3.0]) and high == pytest.approx([60.0, 30.0, 15.0])
    other = replace(field, height_m=field.height_m + 1e-3)
    assert content_sha256(field) != content_sha256(other)
    assert content_sha256(field) == content_sha256(hill(np.full((4, 4), 0.5)))
    with pytest.raises(ValueError, match="does not move"):
        moved(field, np.ones(3))


def test_the_faces_look_up() -> None:
    field = hill(np.full((4, 4), 0.5))
    a, b, c = np.moveaxis(field.vertices_m()[field.faces()], 1, 0)
    assert len(a) == 2 * 30 * 12
    assert np.all(np.cross(b - a, c - a)[:, 2] > 0)
