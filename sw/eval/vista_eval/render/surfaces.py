"""Everything of a scene that rays can meet, as triangles, and what a ray finds where it meets one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.metadata import files
from typing import Any, NamedTuple
from weakref import finalize

import numpy as np
from vista import native
from vista.errors import InputError

from vista_eval.render.albedo_maps import AlbedoMaps
from vista_eval.render.outlines import Outline, joined, outline_of
from vista_eval.render.scene import Mesh, Solid

NO_MAP = -1  # as in surfaces.h
OFF_SURFACE_M = 0.002  # where rays for shadows begin


class Rays(NamedTuple):
    """Rays from one point, world."""

    origin_m: np.ndarray  # (3,) float32
    direction: np.ndarray  # (n, 3) float32
    right: np.ndarray  # (3,) how the direction changes over a pixel to the right
    down: np.ndarray
    order: np.ndarray  # (n,) int64 of the rays, those first that are near each other


class Hits(NamedTuple):
    """Places where some of the rays meet a surface; one an entry."""

    ray: np.ndarray  # its index among the rays
    depth_m: np.ndarray  # in units of the ray's direction
    face: np.ndarray
    second: np.ndarray  # weight of the face's second corner
    third: np.ndarray


HIT_KINDS = (np.float32, np.int32, np.float32, np.float32)  # of all but the ray


@dataclass(frozen=True)
class Matter:
    """What is there where rays have met surfaces."""

    point_m: np.ndarray  # (n, 3)
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
        self.ffi, self.library = native.load("vista_render")
        self.shown = self.shared()
        self.obstructions = self.opened()

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

    def shared(self) -> Any:
        """The arrays of the surfaces as C reads them."""
        shown = self.ffi.new("vista_surfaces *")
        arrays = {
            "corner": (self.faces, np.int32),
            "corner_albedo": (self.albedo, np.float32),
            "face_normal": (self.face_normal, np.float32),
            "row": (self.row, np.int32),
            "map": (self.map_of, np.int32),
            "slope": (self.slope, np.float32),
            "offset": (self.offset, np.float32),
            "corner_normals": (self.normals, np.float32),
            "size": (self.maps.sizes, np.int32),
            "start": (self.maps.starts, np.int64),
            "texels": (self.maps.texels, np.float32),
        }
        self.kept = {name: np.ascontiguousarray(array, kind) for name, (array, kind) in arrays.items()}
        for name, array in self.kept.items():
            setattr(shown, name, self.pointer(array))
        shown.levels = self.maps.sizes.shape[1]
        return shown

    def pointer(self, array: np.ndarray) -> Any:
        kind = "float" if array.dtype == np.float32 else f"{array.dtype}_t"
        return self.ffi.from_buffer(f"{kind}[]", array)

    def opened(self) -> Any:
        """The triangles as rays meet them."""
        found = self.ffi.new("vista_obstructions *")
        finalize(self, self.library.vista_rays_close, found)
        if len(self.faces):
            self.kept["padded"] = np.pad(self.corners_m, ((0, 2), (0, 0)))
            corners, faces = self.pointer(self.kept["padded"]), self.pointer(self.faces.view(np.uint32))
            path = embree().encode()
            if not self.library.vista_rays_open(
                found, path, corners, len(self.corners_m), faces, len(self.faces)
            ):
                raise InputError(embree(), "Embree does not start")
        return found

    def met(self, rays: Rays) -> Hits:
        """The nearest surface that each ray meets."""
        count = len(rays.direction)
        hits = Hits(np.empty(count, np.int64), *(np.empty(count, kind) for kind in HIT_KINDS))
        if not len(self.faces):
            return Hits(*(each[:0] for each in hits))
        out = self.ffi.new("vista_hits *", [self.pointer(each) for each in hits])
        seen, order = self.rays_of(rays), self.pointer(rays.order)
        found = self.library.vista_rays_met(self.obstructions, seen, order, count, out)
        return Hits(*(each[:found] for each in hits))

    def rays_of(self, rays: Rays) -> Any:
        vectors = (rays.origin_m, rays.right, rays.down)
        return self.ffi.new("vista_rays *", [self.pointer(rays.direction), *(v.tolist() for v in vectors)])

    def hide(self, reached: np.ndarray, point_m: np.ndarray, normal: np.ndarray, towards: np.ndarray) -> None:
        """Takes those points (n, 3) out of `reached` (n,) from which something is in the way along one
        direction (3,)."""
        if len(self.faces):
            shown = [self.pointer(np.ascontiguousarray(each, np.float32)) for each in (point_m, normal)]
            out = self.ffi.from_buffer("bool[]", reached)
            self.library.vista_rays_hide(
                self.obstructions, len(reached), *shown, OFF_SURFACE_M, towards.tolist(), out
            )

    def matter(self, hits: Hits, rays: Rays) -> Matter:
        """The matter where the rays meet the surfaces."""
        count = len(hits.ray)
        point_m, normal = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
        albedo, plain = np.empty(count, np.float32), np.empty(count, np.float32)
        where = self.ffi.new("vista_hits *", [self.pointer(each) for each in hits])
        out = self.ffi.new(
            "vista_matter *", [self.pointer(each) for each in (point_m, normal, albedo, plain)]
        )
        self.library.vista_surfaces_look(self.shown, self.rays_of(rays), count, where, out)
        return Matter(point_m, albedo, plain, normal, self.label[hits.face], self.part[hits.face])


@cache
def embree() -> str:
    """The path of the library that the package embreex carries. Its own binding traces one ray at a time."""
    held = [file for file in files("embreex") or [] if file.name.startswith("libembree")]
    if not held:
        raise InputError("embreex", "it carries no Embree")
    return str(held[0].locate())


def place_of_point(outline: Outline) -> tuple[np.ndarray, np.ndarray]:
    """The matrix (2, 3) and the offset of each face that turn a point on it into its place in the map."""
    a, b, c = (outline.vertices_m[outline.faces[:, k]] for k in range(3))
    pa, pb, pc = (outline.place[outline.faces[:, k]] for k in range(3))
    edges = np.stack([b - a, c - a], axis=2)  # (M, 3, 2)
    steps = np.stack([pb - pa, pc - pa], axis=2)  # (M, 2, 2)
    slope = steps @ np.linalg.pinv(edges)
    return slope, pa - np.einsum("nij,nj->ni", slope, a)


def unit_rows(vectors: np.ndarray) -> np.ndarray:
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return vectors / np.maximum(length, np.float32(1e-30))[:, None]
