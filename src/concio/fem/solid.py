"""A meshed elastic shape in space, and the facets of its elements on each face."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.fem.elements import Elements
from concio.fem.facets import FacetMesh, functions, local_coordinates, quadrature
from concio.fem.shape import Meshed
from concio.kinematics.frames import cross, tangents
from concio.model.overlay import common
from concio.model.topology import Loop

Array = np.ndarray

HEXAHEDRON_SIDES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5))
TETRAHEDRON_SIDES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
"""Corners of the sides of elements, counter-clockwise seen from outside."""


@dataclass(frozen=True, eq=False)
class SolidShape(Meshed):
    """A meshed elastic shape in space, placed with its first vertex at the origin.

    Parameters
    ----------
    vertices : (v, 3) array
        Relative to the first [m].
    faces : tuple of tuples of int
        As in :class:`concio.model.polyhedron.Polyhedron`.
    holes : tuple of (face, loop)
    normals : (f, 3) array
        Of the faces.
    elements : Elements
    D : (6, 6) array
        Constitutive matrix [kN/m2].
    thickness : float
        1: integrals are over the volume.
    """

    vertices: Array
    faces: tuple[Loop, ...]
    holes: tuple[tuple[int, Loop], ...]
    normals: Array
    elements: Elements
    D: Array
    thickness: float = 1.0

    @cached_property
    def facets(self) -> tuple[FacetMesh, ...]:
        """Facets on each face, in order.

        Raises
        ------
        GeometryError
            The elements do not fill the shape.
        """
        surface, corners = surface_facets(self.elements)
        nodes = self.elements.nodes
        at = nodes[surface[:, :corners]]
        middle = at.mean(1)
        size = float(np.ptp(self.vertices, axis=0).max())
        normal = cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        offsets = np.array([self.vertices[list(f)].mean(0) @ n for f, n in zip(self.faces, self.normals, strict=True)])
        height = np.abs(np.einsum("kcd,fd->kcf", at, self.normals) - offsets).max(1)
        candidates = (height <= 1e-5 * size) & (normal @ self.normals.T > 0.9)
        face = np.argmax(candidates, axis=1)
        for k in np.flatnonzero(candidates.sum(1) > 1):  # faces in one plane: where the middle lies
            for f in np.flatnonzero(candidates[k]):
                axes = tangents(self.normals[f])
                rings = [self.vertices[list(loop)] @ axes.T for loop in self.loops_of(int(f))]
                if shapely.intersects_xy(shapely.Polygon(rings[0], rings[1:]), *(axes @ middle[k])):
                    face[k] = f
                    break
        if not candidates.any(1).all():
            x, y, z = middle[int(np.argmin(candidates.any(1)))]
            msg = f"the mesh leaves the faces of the block at ({x:.4g}, {y:.4g}, {z:.4g}) m from its first vertex"
            raise GeometryError(msg, hint="give the block a 'grid', or split it into simpler blocks")
        return tuple(FacetMesh(surface[face == f]) for f in range(len(self.faces)))

    def loops_of(self, face: int) -> list[Loop]:
        """Return the boundary of a face and those of its holes."""
        return [self.faces[face], *(loop for number, loop in self.holes if number == face)]

    def face_weights(self, face: int, part: shapely.Geometry, origin: Array, axes: Array) -> tuple[Array, Array]:
        """Return nodes (k,) and the integrals (k,) of their shape functions over part of a face [m2].

        Parameters
        ----------
        face : int
        part : polygon or polygons in the plane
        origin : (3,) array
            Where the coordinates of the plane are zero, from the first vertex [m].
        axes : (2, 3) array
        """
        mesh = self.facets[face]
        flat = (self.elements.nodes[mesh.nodes[:, : mesh.corners]] - origin) @ axes.T
        cells = shapely.polygons(flat)
        number = np.flatnonzero(shapely.intersects(cells, part))
        pieces = common(cells[number], part)
        total = np.zeros(len(self.elements.nodes))
        for k, piece in zip(number.tolist(), pieces, strict=True):
            triangles = triangles_in(piece)
            if not len(triangles):
                continue
            points, weights = quadrature(triangles)
            points = points.reshape(-1, 2)
            local = local_coordinates(np.broadcast_to(flat[k], (len(points), *flat[k].shape)), points)
            values = functions(mesh.nodes.shape[1], local)
            np.add.at(total, mesh.nodes[k], weights.ravel() @ values)
        used = np.flatnonzero(total)
        return used, total[used]


SAME = 1e-7
"""Distance over the square root of the area up to which vertices of a polygon count as one."""

STRAIGHT = 1e-9
"""Twice the area that a vertex of a polygon adds, over that of the polygon, up to which it counts as none."""


def _corners(ring: Array, area: float) -> Array:
    """Return the vertices (n, 2) of a convex polygon that are corners.

    Whether a cut leaves further ones on a side, or one twice, depends on how the structure is turned.
    """
    ring = ring[np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1) > SAME * np.sqrt(area)]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    corners: Array = ring[np.abs(cross(before, after)) > STRAIGHT * area]
    return corners


def triangles_in(shape: shapely.Geometry) -> Array:
    """Return triangles (t, 3, 2) that fill a polygon or several."""
    found = []
    for part in shapely.get_parts(shape):
        if part.geom_type != "Polygon" or part.area == 0.0:
            continue
        ring = shapely.get_coordinates(part.exterior)[:-1]
        if len(part.interiors) == 0 and shapely.convex_hull(part).area - part.area <= 1e-12 * part.area:
            ring = _corners(ring, part.area)
            middle = np.tile(shapely.get_coordinates(part.centroid), (len(ring), 1))
            found.append(np.stack([middle, ring, np.roll(ring, -1, axis=0)], 1))
        else:
            cells = shapely.get_parts(shapely.constrained_delaunay_triangles(part))
            found.append(shapely.get_coordinates(cells).reshape(-1, 4, 2)[:, :3])
    return np.concatenate(found) if found else np.zeros((0, 3, 2))


def surface_facets(elements: Elements) -> tuple[Array, int]:
    """Return the facets (f, k) on the surface of a mesh, numbered as in :mod:`concio.fem.facets`, and their corners."""
    cells = elements.cells
    sides = HEXAHEDRON_SIDES if cells.shape[1] == 8 else TETRAHEDRON_SIDES
    corners = len(sides[0])
    every = np.concatenate([cells[:, list(side)] for side in sides])
    owner = np.tile(np.arange(len(cells)), len(sides))
    number = np.repeat(np.arange(len(sides)), len(cells))
    _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    facets, owner, number = every[outer], owner[outer], number[outer]
    a, b, c = (elements.nodes[facets[:, k]] for k in (0, 1, corners - 1))
    inside = elements.nodes[cells[owner]].mean(1)
    turned = (cross(b - a, c - a) * (inside - a)).sum(1) > 0
    facets[turned] = facets[turned][:, ::-1]
    if elements.edge_order == 2:
        facets = _with_middles(elements, facets, owner, corners)
    return facets, corners


def _with_middles(elements: Elements, facets: Array, owner: Array, corners: int) -> Array:
    """Return facets with the nodes in the middle of their sides and, of quadrilaterals, in their centre."""
    nodes = elements.nodes
    after = np.roll(facets, -1, axis=1)
    wanted = [0.5 * (nodes[facets[:, k]] + nodes[after[:, k]]) for k in range(corners)]
    if corners == 4:
        wanted.append(nodes[facets].mean(1))
    own = elements.connectivity[owner]
    found = [facets]
    for place in wanted:
        distance = np.linalg.norm(nodes[own] - place[:, None], axis=2)
        found.append(own[np.arange(len(own)), np.argmin(distance, axis=1)][:, None])
    return np.concatenate(found, axis=1)
