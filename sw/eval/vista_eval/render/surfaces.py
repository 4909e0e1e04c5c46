"""Everything of a scene that rays can meet, as triangles, and what a ray finds where it meets one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from embreex.mesh_construction import TriangleMesh  # type: ignore[import-untyped]
from embreex.rtcore_scene import EmbreeScene  # type: ignore[import-untyped]

from vista_eval.render.albedo_maps import AlbedoMaps
from vista_eval.render.outlines import Outline, joined, outline_of
from vista_eval.render.scene import Mesh, Solid

NO_MAP = -1


class Hits(NamedTuple):
    """Places where some of the rays meet a surface; one an entry."""

    ray: np.ndarray  # its index among the rays
    depth_m: np.ndarray  # in units of the ray's direction
    face: np.ndarray
    weights: np.ndarray  # (n, 2) of the face's second and third corner


@dataclass(frozen=True)
class Matter:
    """What is there where rays have met surfaces."""

    albedo: np.ndarray  # (n,)
    plain: np.ndarray  # (n,) albedo without maps
    normal: np.ndarray  # (n, 3) unit, towards the viewer
    label: np.ndarray  # (n,)
    part: np.ndarray  # (n,) number of the solid


class Surfaces:
    """The triangles of solids, each with the label of its thing."""

    def __init__(self, parts: list[tuple[int, Solid]]) -> None:
        outlines = [outline_of(solid) for _, solid in parts]
        whole = joined([Outline(np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros((0, 2))), *outlines])
        counts = [len(outline.faces) for outline in outlines]
        self.parts = len(parts)
        self.corners_m, self.faces = whole.vertices_m.astype(np.float32), whole.faces.astype(np.int32)
        albedo = [
            solid.albedo if isinstance(solid, Mesh) else np.ones(len(outline.vertices_m))
            for (_, solid), outline in zip(parts, outlines, strict=True)
        ]
        self.albedo = np.concatenate([*albedo, np.zeros(0)]).astype(np.float32)  # at corners, but for maps
        a, b, c = (self.corners_m[self.faces[:, k]] for k in range(3))
        self.face_normal = unit_rows(np.cross(b - a, c - a))
        self.label = np.repeat(np.array([label for label, _ in parts], np.int32), counts)
        self.part = np.repeat(np.arange(len(parts), dtype=np.int32), counts)
        first = np.cumsum([0, *counts])
        mapped = [k for k, (_, solid) in enumerate(parts) if not isinstance(solid, Mesh)]
        self.mapped = [(int(first[k]), outlines[k]) for k in mapped]
        maps = [parts[k][1].albedo for k in mapped]
        self.maps = AlbedoMaps(maps)
        self.place_maps()
        self.scene = EmbreeScene()
        if len(self.faces):
            TriangleMesh(self.scene, self.corners_m, self.faces)

    def place_maps(self) -> None:
        """Works out, for each face with a map, how places in it follow from points in the world, and its
        normals."""
        size = sum(len(outline.faces) for _, outline in self.mapped)
        self.row = np.full(len(self.faces), NO_MAP, np.int32)
        self.map_of = np.zeros(size, np.int32)
        self.slope = np.zeros((size, 2, 3), np.float32)  # of the place, a metre
        self.offset = np.zeros((size, 2), np.float32)
        self.normals = np.zeros((size, 3, 3), np.float32)  # at the corners; 0: the face is flat
        row = 0
        for k, (first, outline) in enumerate(self.mapped):
            rows = slice(row, row + len(outline.faces))
            self.row[first : first + len(outline.faces)] = np.arange(rows.start, rows.stop)
            self.map_of[rows] = k
            self.slope[rows], self.offset[rows] = place_of_point(outline)
            if outline.normals is not None:
                self.normals[rows] = outline.normals[outline.faces]
            row = rows.stop

    def met(self, origin_m: np.ndarray, direction: np.ndarray) -> Hits:
        """The nearest surface that each ray (n, 3) meets."""
        if not len(self.faces) or not len(origin_m):
            none = np.zeros(0, np.int32)
            return Hits(none, np.zeros(0, np.float32), none, np.zeros((0, 2), np.float32))
        found = self.scene.run(origin_m, direction, query="INTERSECT", output=True)
        ray = np.flatnonzero(found["primID"] >= 0)
        weights = np.stack([found["u"][ray], found["v"][ray]], axis=1)
        return Hits(ray, found["tfar"][ray], found["primID"][ray], weights)

    def hides(self, origin_m: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """(n,) whether anything is in the way of each ray."""
        if not len(self.faces) or not len(origin_m):
            return np.zeros(len(origin_m), bool)
        return np.asarray(self.scene.run(origin_m, direction, query="OCCLUDED")) >= 0

    def matter(
        self, hits: Hits, point_m: np.ndarray, ray: np.ndarray, sides: tuple[np.ndarray, np.ndarray]
    ) -> Matter:
        """The matter at `point_m` (n, 3) of the hits, seen along `ray` (n, 3). sides: how the direction of a
        ray changes over its pixel to the right and down, world."""
        normal = self.face_normal[hits.face]
        row = self.row[hits.face]
        mapped = np.flatnonzero(row != NO_MAP)
        plain = self.corner_albedo(hits)
        albedo, row = plain.copy(), row[mapped]
        if len(mapped):
            du, dv = (
                self.moved(row, footprint(side, ray[mapped], normal[mapped], hits.depth_m[mapped]))
                for side in sides
            )
            place = self.moved(row, point_m[mapped]) + self.offset[row]
            albedo[mapped] = self.maps.read(self.map_of[row], place, du, dv)
            bent = self.round_normal(row, hits.weights[mapped])
            is_round = np.any(bent != 0, axis=1)
            normal[mapped[is_round]] = bent[is_round]
        away = np.einsum("ij,ij->i", normal, ray) > 0
        normal[away] *= -1
        return Matter(albedo, plain, normal, self.label[hits.face], self.part[hits.face])

    def corner_albedo(self, hits: Hits) -> np.ndarray:
        a, b, c = (self.albedo[self.faces[hits.face, k]] for k in range(3))
        second, third = hits.weights.T
        return a + second * (b - a) + third * (c - a)

    def round_normal(self, row: np.ndarray, weights: np.ndarray) -> np.ndarray:
        a, b, c = (self.normals[row, k] for k in range(3))
        return unit_rows(a + weights[:, :1] * (b - a) + weights[:, 1:] * (c - a))

    def moved(self, row: np.ndarray, by_m: np.ndarray) -> np.ndarray:
        """(n, 2) how much the place in the map changes over a vector (n, 3)."""
        return np.einsum("nij,nj->ni", self.slope[row], by_m)


def place_of_point(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """The matrix (2, 3) and the offset of each face that turn a point on it into its place in the map."""
    a, b, c = (outline.vertices_m[outline.faces[:, k]] for k in range(3))
    pa, pb, pc = (outline.place[outline.faces[:, k]] for k in range(3))
    edges = np.stack([b - a, c - a], axis=2)  # (M, 3, 2)
    steps = np.stack([pb - pa, pc - pa], axis=2)  # (M, 2, 2)
    slope = steps @ np.linalg.pinv(edges)
    return slope, pa - np.einsum("nij,nj->ni", slope, a)


def footprint(side: np.ndarray, ray: np.ndarray, normal: np.ndarray, depth_m: np.ndarray) -> np.ndarray:
    """(n, 3) how far the point that a ray meets moves in its plane, when the ray turns by `side`."""
    slant = np.einsum("ij,ij->i", normal, ray)
    slant = np.where(np.abs(slant) < 1e-4, np.float32(1e-4), slant)
    return depth_m[:, None] * (side - ray * (normal @ side / slant)[:, None])


def unit_rows(vectors: np.ndarray) -> np.ndarray:
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return vectors / np.maximum(length, np.float32(1e-30))[:, None]
