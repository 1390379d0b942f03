"""How nodes of elastic bodies enter contacts in space: a corner is a node, a point of a face has those around it.

The nodes on the surface of an elastic body are corners of their own (:mod:`concio.contact.moving_solids`). A point of a
face is interpolated in the facet of its mesh in which it lies, as described; what slides over a face changes facets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.slots import MeshedSide
from concio.fem.discretisation import Discretisation
from concio.fem.facets import functions, local_coordinates
from concio.fem.solid import SolidShape
from concio.kinematics.frames import cross, dot, norm

if TYPE_CHECKING:
    from concio.contact.moving_solids import MovingSolids, PlacedSolids
    from concio.contact.solid_touch import SolidTouch, SolidToucher

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class SurfaceNodes:
    """The nodes on the surface of an elastic body.

    Parameters
    ----------
    corner : (v,) integer array
        Node at each vertex.
    node : (k,) integer array
        The others on the surface.
    place : (k, 3) array
        Where these are, from the centroid as described [m].
    faces : tuple of k integer arrays
        Faces on which each of these lies.
    spacing : float
        Square root of the mean area of a facet [m].
    """

    corner: Array
    node: Array
    place: Array
    faces: tuple[Array, ...]
    spacing: float


def surface_nodes(disc: Discretisation) -> list[SurfaceNodes | None]:
    """Return the nodes on the surface of each body in space; None for bodies that are not elastic."""
    found: list[SurfaceNodes | None] = []
    for b, s in enumerate(disc.shape_of.tolist()):
        found.append(_on_surface(disc, b) if s >= 0 else None)
    return found


def _on_surface(disc: Discretisation, b: int) -> SurfaceNodes:
    shape, body = disc.shapes[disc.shape_of[b]], disc.model.polyhedra[b]
    assert isinstance(shape, SolidShape), "bodies in space"
    nodes = disc.nodes(b)
    corner = np.array([int(np.argmin(np.linalg.norm(nodes - v, axis=1))) for v in body.vertices])
    own = [np.unique(mesh.nodes) for mesh in shape.facets]
    every = np.setdiff1d(np.concatenate(own), corner)
    faces = tuple(np.array([f for f, on in enumerate(own) if node in on]) for node in every.tolist())
    count = sum(len(mesh.nodes) for mesh in shape.facets)
    spacing = float(np.sqrt(body.face_areas.sum() / count))
    return SurfaceNodes(corner, every, nodes[every] - disc.centroids[b], faces, spacing)


class FacetSides:
    """Interpolates points of the faces of elastic bodies.

    Parameters
    ----------
    disc : Discretisation
    solids : MovingSolids
    first_node : (B,) integer array
        Number of the first node of each elastic body.
    nodes : int
        Nodes of all elastic bodies.
    """

    def __init__(self, disc: Discretisation, solids: MovingSolids, first_node: Array, nodes: int) -> None:
        self.solids, self.nodes = solids, nodes
        self.elastic = disc.shape_of >= 0
        first_face = np.searchsorted(solids.face_body, np.arange(len(disc.shape_of)))
        self.facets: dict[int, tuple[Array, Array]] = {}
        for b in np.flatnonzero(self.elastic).tolist():
            shape, arm = disc.shapes[disc.shape_of[b]], disc.nodes(b) - disc.centroids[b]
            assert isinstance(shape, SolidShape), "bodies in space"
            for k, mesh in enumerate(shape.facets):
                f = int(first_face[b]) + k
                away = arm[mesh.nodes[:, : mesh.corners]] - solids.start[solids.face_start[f]]
                self.facets[f] = mesh.nodes + int(first_node[b]), away @ self._ways(np.array([f]))[0].T
        self.wide = max((nodes.shape[1] for nodes, _ in self.facets.values()), default=1)
        self.first_node = first_node

    def _ways(self, face: Array) -> Array:
        """Return the tangents (k, 2, 3) of faces as described."""
        tangent = self.solids.tangent[face]
        return np.stack([tangent, cross(self.solids.normal[face], tangent)], axis=1)

    def faces(self, toucher: SolidToucher) -> Array:
        """Return the faces (m, 2) of elastic bodies on which pairs touch; -1 for corners, and on other bodies."""
        solids, q = self.solids, len(toucher.corner)
        found = np.full((len(toucher.body_a), 2), -1)
        found[:q, 0] = toucher.face
        found[q : q + len(toucher.edges)] = solids.edge_faces[toucher.edges, 0]
        elastic = self.elastic[np.column_stack([toucher.body_a, toucher.body_b])]
        return np.where(elastic, found, -1)

    def feet(self, faces: Array, touch: SolidTouch, placed: PlacedSolids) -> Array:
        """Return where pairs touch these faces (m, 2, 2), along the tangents from where these begin [m]."""
        face = np.maximum(faces, 0)
        away = touch.point[:, None] - placed.start[self.solids.face_start[face]]
        tangent = placed.tangent[face]
        across = cross(placed.normal[face], tangent)
        return np.stack([dot(away, tangent), dot(away, across)], axis=2)

    def sides(self, toucher: SolidToucher, faces: Array, feet: Array) -> tuple[MeshedSide, MeshedSide]:
        """Return how nodes enter both sides of pairs."""
        m, q = len(faces), len(toucher.corner)
        node, weight = np.full((2, m, self.wide), self.nodes), np.zeros((2, m, self.wide))
        for side in (0, 1):
            for f in np.unique(faces[faces[:, side] >= 0, side]).tolist():
                own = np.flatnonzero(faces[:, side] == f)
                numbers, weights = self._weights(f, feet[own, side])
                node[side, own, : numbers.shape[1]], weight[side, own, : numbers.shape[1]] = numbers, weights
        corners = np.flatnonzero(self.elastic[toucher.body_b[:q]])
        node[1, corners, 0] = self.solids.node[toucher.corner[corners]] + self.first_node[toucher.body_b[corners]]
        weight[1, corners, 0] = 1.0
        elastic = self.elastic[toucher.body_a], self.elastic[toucher.body_b]
        return MeshedSide(elastic[0], node[0], weight[0]), MeshedSide(elastic[1], node[1], weight[1])

    def _weights(self, face: int, foot: Array) -> tuple[Array, Array]:
        """Return nodes and weights (n, k) of points (n, 2) of a face, of the nearest facet where they lie beside it."""
        nodes, corners = self.facets[face]
        n, f, sides = len(foot), len(nodes), corners.shape[1]
        local = local_coordinates(np.tile(corners, (n, 1, 1)), np.repeat(foot, f, axis=0))
        local = np.clip(local, 0.0, 1.0)
        if sides == 3:
            local /= np.maximum(local.sum(axis=1), 1.0)[:, None]
        place = np.einsum("nk,nkd->nd", functions(sides, local), np.tile(corners, (n, 1, 1))).reshape(n, f, 2)
        pick = np.argmin(norm(place - foot[:, None]), axis=1)
        inner = local.reshape(n, f, 2)[np.arange(n), pick]
        return nodes[pick], functions(nodes.shape[1], inner)
