"""Turns shapes and textures into things of a scene; each is one object of the truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vista_eval.render import textures
from vista_eval.render.scene import Cylinder, Mesh, Panel, Solid, Sway, Thing, board, thing
from vista_eval.worlds import street
from vista_eval.worlds.triangles import Triangles, placed
from vista_eval.worlds.vegetation import TREES, crown, crown_clumps

SIGN_WIDTH_M, SIGN_HEIGHT_M = 40 * 0.0254, 30 * 0.0254
SIGN_POLE_DIAMETER_M = 0.75 * 0.0254
POLE_WIDTH_M, POLE_HEIGHT_M = 20 * 0.0254, 90 * 0.0254
STAND_RADIUS_M = 0.03


def mesh(name: str, shape: Triangles) -> Mesh:
    return Mesh(
        name,
        shape.vertices_m.astype(np.float32),
        shape.faces.astype(np.uint32),
        shape.albedo.astype(np.float32),
    )


def one(
    name: str, kind: str, shape: Triangles, foot_m: ArrayLike = (0, 0, 0), yaw_deg: float = 0.0, **more
) -> Thing:
    """A thing of a single mesh, placed."""
    return thing(name, kind, [mesh(name, placed(shape, foot_m, yaw_deg))], **more)


def tree(
    name: str,
    form: str,
    foot_m: ArrayLike,
    height_m: float,
    seed: int,
    tuft_m: float = 0.2,
    sway: Sway | None = None,
    **more,
) -> Thing:
    rng = np.random.default_rng(seed)
    spread = (
        height_m
        * {"broadleaf": 0.34, "conifer": 0.2, "poplar": 0.11, "bare": 0.3}[form]
        * rng.uniform(0.85, 1.15)
    )
    shape = TREES[form](height_m, spread, rng, tuft_m)
    return one(name, "tree", shape, foot_m, rng.uniform(0, 360), sway=sway, **more)


def swaying_tree(name: str, foot_m: ArrayLike, height_m: float, seed: int, sway: Sway) -> Thing:
    """A broadleaf whose trunk stands still while each clump of leaves moves by itself."""
    rng = np.random.default_rng(seed)
    foot = np.asarray(foot_m, float)
    centers, radii = crown_clumps(height_m, 0.34 * height_m, 0.25 * height_m, rng)
    top = foot + np.array([0.0, 0.0, 0.75 * height_m])
    trunk = Cylinder(f"{name}_trunk", tuple(foot), tuple(top), 0.02 * height_m, textures.bark(seed))
    clumps = [
        mesh(f"{name}_clump{k}", placed(crown(centers[k : k + 1], radii[k : k + 1], 0.2, 0.3, rng), foot))
        for k in range(len(centers))
    ]
    return thing(name, "tree", [trunk, *clumps], sway=sway)


def rectangle(
    name: str, left_foot_m: ArrayLike, right_foot_m: ArrayLike, height_m: float, albedo: np.ndarray
) -> Panel:
    """An upright panel seen with `left_foot_m` on the left; row 0 of the albedo on top."""
    left, right = np.asarray(left_foot_m, float), np.asarray(right_foot_m, float)
    up = np.array([0.0, 0.0, height_m / 2])
    return Panel(name, tuple((left + right) / 2 + up), tuple((right - left) / 2), tuple(-up), albedo)


def house(
    name: str,
    left_foot_m: ArrayLike,
    right_foot_m: ArrayLike,
    height_m: float,
    depth_m: float,
    style: street.FacadeStyle,
    seed: int,
    with_balconies: bool = False,
    texel_m: float = street.TEXEL_M,
) -> Thing:
    """A block with windows on the face seen from left foot to right foot and on its two gables."""
    left, right = np.asarray(left_foot_m, float), np.asarray(right_foot_m, float)
    width = float(np.linalg.norm(right - left))
    along = (right - left) / width
    back = depth_m * np.array([-along[1], along[0], 0.0])
    gable = street.facade_texture(depth_m, height_m, style, seed + 1, texel_m)
    front = street.facade_texture(width, height_m, style, seed, texel_m)
    solids: list[Solid] = [
        rectangle(f"{name}_front", left, right, height_m, front),
        rectangle(f"{name}_left", left + back, left, height_m, gable),
        rectangle(f"{name}_right", right, right + back, height_m, gable),
    ]
    roof_z = np.array([0, 0, height_m])
    roof = Panel(
        f"{name}_roof",
        tuple((left + right + back) / 2 + roof_z),
        tuple((right - left) / 2),
        tuple(back / 2),
        textures.paint(0.2, seed),
    )
    solids.append(roof)
    if with_balconies and height_m > 2 * street.FLOOR_M:
        rng = np.random.default_rng(seed)
        shape = street.balconies(width, height_m, style.window_pitch_m, rng)
        # The balconies' wall runs along +y with its outside at -x; here along `right - left`.
        yaw = np.degrees(np.arctan2(along[1], along[0])) + 90.0
        mirrored = shape._replace(vertices_m=shape.vertices_m * [1, -1, 1])
        solids.append(mesh(f"{name}_balconies", placed(mirrored, left, yaw)))
    return thing(name, "facade", solids)


def wall(
    name: str,
    left_foot_m: ArrayLike,
    right_foot_m: ArrayLike,
    height_m: float,
    albedo: float,
    seed: int,
    bricks: bool = False,
    plain: bool = False,
    texel_m: float = street.TEXEL_M,
    **more,
) -> Thing:
    """A free-standing wall, 0.25 m thick, under a coping; `plain`: smooth paint without any texture."""
    left, right = np.asarray(left_foot_m, float), np.asarray(right_foot_m, float)
    along = (right - left) / np.linalg.norm(right - left)
    back = 0.25 * np.array([-along[1], along[0], 0.0])
    if plain:
        front = np.full((8, 8), albedo, np.float32)
    else:
        width_m = float(np.linalg.norm(right - left))
        front = street.wall_texture(width_m, height_m, albedo, bricks, 0.8, seed, texel_m)
    side = textures.paint(albedo, seed)
    top = Panel(
        f"{name}_top",
        tuple((left + right + back) / 2 + [0, 0, height_m]),
        tuple((right - left) / 2),
        tuple(back / 2),
        textures.paint(min(0.8, 1.2 * albedo), seed),
    )
    solids = [
        rectangle(f"{name}_front", left, right, height_m, front),
        rectangle(f"{name}_left", left + back, left, height_m, side),
        rectangle(f"{name}_right", right, right + back, height_m, side),
        rectangle(f"{name}_back", right + back, left + back, height_m, side),
        top,
    ]
    return thing(name, "wall", solids, **more)


def overhead_board(
    name: str, x_m: float, half_span_m: float, middle_m: float, height_m: float, seed: int, **more
) -> Thing:
    """A sign board over a road, on two posts."""
    size = (2 * (half_span_m - 1.0), height_m)
    print_ = textures.printed_sign(*size, seed, 60)
    top = middle_m + height_m / 2
    posts = [
        Cylinder(
            f"{name}_post{k}", (x_m + 0.15, y, 0.0), (x_m + 0.15, y, top), 0.1, textures.paint(0.3, seed)
        )
        for k, y in enumerate((half_span_m, -half_span_m))
    ]
    ends = (x_m + 0.15, half_span_m, top - 0.2), (x_m + 0.15, -half_span_m, top - 0.2)
    beam = Cylinder(f"{name}_beam", *ends, 0.08, textures.paint(0.3, seed))
    front = board(f"{name}_board", (x_m, 0.0, middle_m), *size, print_)
    return thing(name, "board", [front, *posts, beam], **more)


def tarpaulin(
    name: str, center_m: ArrayLike, width_m: float, length_m: float, yaw_deg: float, albedo: float, seed: int
) -> Thing:
    """A sheet on the ground, a hand's breadth above it where it bulges."""
    turn = np.radians(yaw_deg)
    ahead = np.array([np.cos(turn), np.sin(turn), 0.0])
    right = np.array([ahead[1], -ahead[0], 0.0])
    center = np.array([*np.asarray(center_m, float)[:2], 0.03])
    albedos = textures.tarpaulin(width_m, length_m, albedo, seed)
    panel = Panel(name, tuple(center), tuple(right * width_m / 2), tuple(ahead * length_m / 2), albedos)
    return thing(name, "tarpaulin", [panel], standing=False)


def bale(name: str, foot_m: ArrayLike, yaw_deg: float, seed: int, radius_m: float = 0.75) -> Thing:
    """A round bale, 1.2 m wide, on its side."""
    axis = 0.6 * np.array([np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg)), 0.0])
    center = np.asarray(foot_m, float) + np.array([0, 0, radius_m])
    solid = Cylinder(name, tuple(center - axis), tuple(center + axis), radius_m, textures.straw(seed))
    return thing(name, "bale", [solid])


def sign(altitude_m: float, seed: int, x_m: float = 0.0, y_m: float = 0.0) -> Thing:
    """The paper's "sign": white foamcore 40 in x 30 in on a 0.75 in pole."""
    center = (x_m, y_m, altitude_m)
    print_ = textures.printed_sign(SIGN_WIDTH_M, SIGN_HEIGHT_M, seed)
    radius = SIGN_POLE_DIAMETER_M / 2
    behind = x_m + 2 * radius
    top_m = altitude_m + SIGN_HEIGHT_M / 2
    solids = (
        board("sign_board", center, SIGN_WIDTH_M, SIGN_HEIGHT_M, print_),
        Cylinder("sign_pole", (behind, y_m, 0.0), (behind, y_m, top_m), radius, textures.paint(0.35, seed)),
    )
    return Thing("sign", "sign", solids, True, center, SIGN_WIDTH_M, SIGN_HEIGHT_M, target=True)


def foamcore_pole(altitude_m: float, seed: int, x_m: float = 0.0, y_m: float = 0.0) -> Thing:
    """The paper's "pole": black foamcore 90 in x 20 in, upright on a stand, its middle at `altitude_m`."""
    center = (x_m, y_m, altitude_m)
    front = board("pole_board", center, POLE_WIDTH_M, POLE_HEIGHT_M, textures.foamcore(0.035, seed))
    behind = x_m + 2 * STAND_RADIUS_M
    foot, top = (behind, y_m, 0.0), (behind, y_m, altitude_m + 0.3 * POLE_HEIGHT_M)
    stand = Cylinder("pole_stand", foot, top, STAND_RADIUS_M, textures.paint(0.3, seed))
    return Thing("pole", "pole", (front, stand), True, center, POLE_WIDTH_M, POLE_HEIGHT_M, target=True)
