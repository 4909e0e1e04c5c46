"""Solids of a scene as Mitsuba shapes.

A shape's `surface` is what light does at it: {"bsdf": ...} when it is lit, {"emitter": ...} when it is to
glow in the colour of its label.
"""

from __future__ import annotations

import mitsuba as mi
import numpy as np

from vista_eval.render.scene import (
    Board,
    Box,
    Cylinder,
    GroundStrip,
    HeightField,
    Mesh,
    Panel,
    Solid,
    Sphere,
)

mi.set_variant("scalar_rgb")

Transform = mi.ScalarTransform4f
Surface = dict[str, mi.Object | dict]


def texture_of(solid: Solid) -> dict:
    """The albedo, rows and columns along Mitsuba's v and u."""
    match solid:
        case Mesh():
            return {"type": "mesh_attribute", "name": "vertex_albedo"}
        case Board() | Panel():
            albedo = solid.albedo[::-1]
        case GroundStrip():
            albedo = solid.albedo[:, ::-1]
        case _:
            albedo = solid.albedo
    bitmap = mi.Bitmap(np.ascontiguousarray(albedo[:, :, None], dtype=np.float32))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}


def lit_surface(solid: Solid) -> Surface:
    diffuse = {"type": "diffuse", "reflectance": texture_of(solid)}
    return {"bsdf": mi.load_dict({"type": "twosided", "bsdf": diffuse})}


def glowing_surface(radiance: float) -> Surface:
    return {"emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}}}


def rectangle(center: np.ndarray, half_u: np.ndarray, half_v: np.ndarray) -> dict:
    to_world = np.eye(4)
    to_world[:3, :4] = np.stack([half_u, half_v, np.cross(half_u, half_v), center], axis=1)
    return {"type": "rectangle", "to_world": Transform(to_world.tolist())}


def cylinder(solid: Cylinder) -> list[dict]:
    """A tube and its two caps; Mitsuba's cylinder is open."""
    start, end = np.array(solid.start_m), np.array(solid.end_m)
    tube = {"type": "cylinder", "p0": solid.start_m, "p1": solid.end_m, "radius": solid.radius_m}
    shapes = [tube]
    up = [1.0, 0.0, 0.0] if abs(end[2] - start[2]) > 1e-9 else [0.0, 0.0, 1.0]
    for center, outward in ((start, start - end), (end, end - start)):
        look_at = Transform().look_at(origin=list(center), target=list(center + outward), up=up)
        shapes.append({"type": "disk", "to_world": look_at.scale([solid.radius_m, solid.radius_m, 1.0])})
    return shapes


def outlines(solid: Solid) -> list[dict]:
    """The shapes of one solid but a mesh, without surface, faces outwards."""
    match solid:
        case Cylinder():
            return cylinder(solid)
        case Sphere():
            return [{"type": "sphere", "center": solid.center_m, "radius": solid.radius_m}]
        case Box():
            to_world = Transform().translate(solid.center_m).rotate([0, 0, 1], solid.yaw_deg)
            return [{"type": "cube", "to_world": to_world.scale([s / 2 for s in solid.size_m])}]
        case Board():  # seen from -x: right is -y
            half_u, half_v = np.array([0, -solid.width_m / 2, 0]), np.array([0, 0, solid.height_m / 2])
            return [rectangle(np.array(solid.center_m), half_u, half_v)]
        case Panel():
            half_u, half_v = np.array(solid.half_right_m), -np.array(solid.half_down_m)
            return [rectangle(np.array(solid.center_m), half_u, half_v)]
        case GroundStrip():
            (x0, x1), (y0, y1) = solid.x_m, solid.y_m
            center = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])
            half_u, half_v = np.array([0, (y0 - y1) / 2, 0]), np.array([(x1 - x0) / 2, 0, 0])
            return [rectangle(center, half_u, half_v)]
        case Mesh() | HeightField():
            raise TypeError("triangles have no outline")


def triangles(
    solid: Solid, vertices_m: np.ndarray, faces: np.ndarray, surface: Surface, textured: bool
) -> tuple[mi.Mesh, mi.SceneParameters]:
    """Flat faces: without vertex normals each triangle is shaded by its own. The caller updates."""
    properties = mi.Properties()
    for name, value in surface.items():
        properties[name] = mi.load_dict(value) if isinstance(value, dict) else value
    shape = mi.Mesh(solid.name, len(vertices_m), len(faces), properties, has_vertex_texcoords=textured)
    if isinstance(solid, Mesh):
        shape.add_attribute("vertex_albedo", 3, np.repeat(solid.albedo, 3).astype(np.float32).tolist())
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = np.ravel(vertices_m).astype(np.float32)
    parameters["faces"] = np.ravel(faces).astype(np.uint32)
    return shape, parameters


def mesh(solid: Mesh, surface: Surface, backwards: bool) -> mi.Mesh:
    faces = solid.faces[:, ::-1] if backwards else solid.faces
    shape, parameters = triangles(solid, solid.vertices_m, faces, surface, textured=False)
    parameters.update()
    return shape


def height_field(solid: HeightField, surface: Surface, backwards: bool) -> mi.Mesh:
    faces = solid.faces()[:, ::-1] if backwards else solid.faces()
    shape, parameters = triangles(solid, solid.vertices_m(), faces, surface, textured=True)
    rows, columns = solid.height_m.shape
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    parameters["vertex_texcoords"] = np.stack([u, v], axis=-1).ravel().astype(np.float32)
    parameters.update()
    return shape


def shapes_of(solid: Solid, surface: Surface, backwards: bool = False) -> list[mi.Shape]:
    """`backwards`: faces inwards, which is where light emitted by the surface then goes."""
    if isinstance(solid, Mesh):
        return [mesh(solid, surface, backwards)]
    if isinstance(solid, HeightField):
        return [height_field(solid, surface, backwards)]
    return [mi.load_dict(outline | {"flip_normals": backwards} | surface) for outline in outlines(solid)]
