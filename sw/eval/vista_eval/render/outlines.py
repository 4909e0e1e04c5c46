"""Solids as triangles with a place in their albedo map at each corner."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from vista_eval.render.scene import Cylinder, GroundStrip, HeightField, Mesh, Panel, Solid, Sphere

FLATNESS_M = 0.0005  # a round thing is at most this far from its triangles
SIDES = (12, 96)  # of a round thing, at least and at most


class Outline(NamedTuple):
    """Triangles. Places in the map: columns and rows as shares of its width and height."""

    vertices_m: np.ndarray  # (N, 3)
    faces: np.ndarray  # (M, 3)
    place: np.ndarray  # (N, 2) of columns, of rows; of a mesh, which has no map, nothing that counts
    normals: np.ndarray | None = None  # (N, 3) of what is round; flat faces have their own


def outline_of(solid: Solid) -> Outline:
    match solid:
        case Panel():
            return rectangle(*map(np.array, (solid.center_m, solid.half_right_m, solid.half_down_m)))
        case GroundStrip():
            (x0, x1), (y0, y1) = solid.x_m, solid.y_m
            center = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])
            return rectangle(center, np.array([0, (y1 - y0) / 2, 0]), np.array([(x1 - x0) / 2, 0, 0]))
        case HeightField():
            rows, columns = solid.height_m.shape
            row, column = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
            place = np.stack([column, row], axis=-1).reshape(-1, 2)
            return Outline(solid.vertices_m(), solid.faces(), place)
        case Cylinder():
            return cylinder(solid)
        case Sphere():
            return sphere(solid)
        case Mesh():
            return Outline(solid.vertices_m, solid.faces, np.zeros((len(solid.vertices_m), 2)))


def rectangle(center: np.ndarray, right: np.ndarray, down: np.ndarray) -> Outline:
    place = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    corners = center + (2 * place[:, :1] - 1) * right + (2 * place[:, 1:] - 1) * down
    return Outline(corners, np.array([[0, 1, 2], [0, 2, 3]]), place)


def joined(parts: list[Outline]) -> Outline:
    first = np.cumsum([0, *(len(part.vertices_m) for part in parts)])
    round_ones = [part.normals for part in parts if part.normals is not None]
    return Outline(
        np.concatenate([part.vertices_m for part in parts]),
        np.concatenate([part.faces + k for part, k in zip(parts, first, strict=False)]),
        np.concatenate([part.place for part in parts]),
        np.concatenate(round_ones) if len(round_ones) == len(parts) else None,
    )


def sides_of(radius_m: float) -> int:
    """How many sides keep a circle within FLATNESS_M of its polygon."""
    step = math.acos(max(1 - FLATNESS_M / radius_m, 0.5))
    return int(np.clip(math.ceil(math.pi / step), *SIDES))


def lattice(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (N, 2) and faces (M, 3) of a grid of vertices, row by row."""
    row, column = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.stack([column, row], axis=-1).reshape(-1, 2), faces


def cylinder(solid: Cylinder) -> Outline:
    """A tube, the rows of its map along it and the columns around it, and two caps."""
    start, end = np.array(solid.start_m, float), np.array(solid.end_m, float)
    axis = (end - start) / np.linalg.norm(end - start)
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    place, faces = lattice(2, sides_of(solid.radius_m) + 1)
    turn = 2 * math.pi * place[:, :1]
    outwards = np.cos(turn) * side + np.sin(turn) * np.cross(axis, side)
    tube = Outline(
        start + place[:, 1:] * (end - start) + solid.radius_m * outwards, faces, place, normals=outwards
    )
    return joined([tube, *(cap(tube, row, outward) for row, outward in ((0, -axis), (1, axis)))])


def cap(tube: Outline, row: int, outward: np.ndarray) -> Outline:
    rim = tube.vertices_m[tube.place[:, 1] == row]
    k = np.arange(1, len(rim) - 1)
    normals = np.repeat(outward[None], len(rim), axis=0)
    place = np.stack([np.linspace(0, 1, len(rim)), np.full(len(rim), float(row))], axis=1)
    return Outline(rim, np.stack([0 * k, k, k + 1], 1), place, normals)


def sphere(solid: Sphere) -> Outline:
    """Rows of the map from the top down, columns around."""
    sides = sides_of(solid.radius_m)
    place, faces = lattice(sides // 2 + 1, sides + 1)
    turn, down = 2 * math.pi * place[:, 0], math.pi * place[:, 1]
    normals = np.stack([np.cos(turn) * np.sin(down), np.sin(turn) * np.sin(down), np.cos(down)], axis=1)
    return Outline(np.array(solid.center_m) + solid.radius_m * normals, faces, place, normals)
