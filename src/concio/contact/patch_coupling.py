r"""Coupling of two meshed faces over a patch: node pairs where the meshes match, dual mortar where they do not.

As along the joints of the plane (:mod:`concio.contact.coupling`), contact is stated at the nodes j of one side, the
*slave*, with functions :math:`\psi_j` that sum to one and are biorthogonal to its linear shape functions; the relative
displacement of pair j is

.. math:: \frac{1}{w_j} \int \psi_j\,(u_b - u_a)\,dA , \qquad w_j = \int N_j\, dA .

The facets of both sides and the patch are cut into each other as polygons, and the pieces integrated as triangles, so
that any uniform pressure passes exactly. Where the patch covers quadratic facets whole, N and psi are
quadratic, so that pairs meet hardly more than the node they stand at. Those of six-node triangles have no integral at
the corners: a fifth of those of the two sides is added there, which leaves all positive (Popp, Wohlmuth, Gee and Wall,
SIAM J. Sci. Comput. 34, 2012). Quadratic facets that are covered in part count as linear ones between all their nodes.
Where the patch ends inside a linear facet the dual functions are those of the part that is covered; where hardly any
is, the linear functions themselves take their place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded when they are used: scipy.spatial takes long
import shapely

from concio.contact.coupling import EVEN, Side
from concio.fem.facets import FacetMesh, functions, local_coordinates, quadrature
from concio.fem.solid import triangles_in
from concio.model.overlay import common

Array = np.ndarray

HARDLY = 1e-2
"""Share of a linear piece of a facet that must be covered for dual functions of its own."""

POSITIVE = np.eye(6)
"""Functions of a six-node triangle with positive integrals from those of its interpolation, column by column."""
for _corner, _sides in ((0, (3, 5)), (1, (3, 4)), (2, (4, 5))):
    POSITIVE[_sides, _corner] = 0.2
POSITIVE[3:, 3:] *= 0.6


@dataclass(frozen=True, eq=False)
class FaceSide:
    """One meshed side of a patch: its facets, and where the nodes of its body (N, 2) lie in the plane of the patch."""

    mesh: FacetMesh
    flat: Array

    @property
    def corners(self) -> Array:
        """Corners of the facets (f, c, 2) [m]."""
        found: Array = self.flat[self.mesh.nodes[:, : self.mesh.corners]]
        return found


@dataclass(frozen=True, eq=False)
class PatchCoupling:
    """Pairs of one patch.

    Parameters
    ----------
    at : (p, 2) array
        Where each pair stands in the plane of the patch [m].
    area : (p,) array
        Tributary area of each pair [m2].
    a, b : Side or None
        None where that side is rigid or fixed and moves as the point at ``at``.
    model : str
        How contact is stated, in words.
    """

    at: Array
    area: Array
    a: Side | None
    b: Side | None
    model: str


def couple_faces(a: FaceSide | None, b: FaceSide | None, patch: shapely.Polygon) -> PatchCoupling:
    """Return the pairs of a patch of which at least one side is meshed.

    Parameters
    ----------
    a, b : FaceSide or None
        None for a rigid or fixed side.
    patch : shapely.Polygon
        In the same plane.
    """
    if a is not None and b is not None:
        found = _matching(a, b, patch)
        if found is not None:
            return found
    if a is None or (b is not None and _finer(b, a, patch)):
        assert b is not None
        at, area, own, other = _mortar(b, a, patch)
        return PatchCoupling(at, area, other, own, "dual mortar")
    at, area, own, other = _mortar(a, b, patch)
    return PatchCoupling(at, area, own, other, "dual mortar")


def _covering(side: FaceSide, patch: shapely.Polygon) -> tuple[Array, Array, Array]:
    """Return numbers of the facets that the patch covers in part, their polygons and the covered areas."""
    cells = shapely.polygons(side.corners)
    near = shapely.STRtree(cells).query(patch, predicate="intersects")
    near.sort()
    area = shapely.area(common(cells[near], patch))
    some = area > 1e-12 * patch.area
    return near[some], cells[near[some]], area[some]


def _covered_whole(side: FaceSide, patch: shapely.Polygon) -> bool:
    """Return whether the patch covers whole facets only."""
    _, cells, area = _covering(side, patch)
    return bool(np.abs(shapely.area(cells) - area).max(initial=0.0) <= 1e-6 * patch.area)


def _quartered(triangles: Array) -> Array:
    """Return each triangle (t, 3, 2) as the four that the middles of its sides make (4 t, 3, 2)."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
    four = np.stack([np.stack(v, 1) for v in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))], 1)
    return np.reshape(four, (-1, 3, 2))


def _finer(side: FaceSide, other: FaceSide, patch: shapely.Polygon) -> bool:
    """Return whether a side has more nodes in the patch than another one, or as many on facets more alike in area.

    The numbering of the bodies does not decide it, except between sides that are alike or mirror images.
    """
    first, second = _nodes_in(side, patch), _nodes_in(other, patch)
    if first != second:
        return first > second
    own, others = (float((shapely.area(_covering(mesh, patch)[1]) ** 2).sum()) for mesh in (side, other))
    return own < (1 - EVEN) * others


def _nodes_in(side: FaceSide, patch: shapely.Polygon) -> int:
    return len(np.unique(side.mesh.nodes[_covering(side, patch)[0]]))


def _matching(a: FaceSide, b: FaceSide, patch: shapely.Polygon) -> PatchCoupling | None:
    """Return node pairs where both sides cover the patch by whole facets with the same nodes."""
    if a.mesh.nodes.shape[1] != b.mesh.nodes.shape[1] or a.mesh.nodes.shape[1] == 6:
        return None
    if not all(_covered_whole(side, patch) for side in (a, b)):
        return None
    chosen = [_covering(side, patch)[0] for side in (a, b)]
    nodes_a, nodes_b = (np.unique(side.mesh.nodes[own]) for side, own in zip((a, b), chosen, strict=True))
    if len(chosen[0]) != len(chosen[1]) or len(nodes_a) != len(nodes_b):
        return None
    size = float(np.ptp(a.flat[nodes_a], axis=0).max())
    distance, partner = (np.asarray(v) for v in scipy.spatial.cKDTree(b.flat[nodes_b]).query(a.flat[nodes_a]))
    if distance.max() > 1e-7 * size or len(np.unique(partner)) < len(partner):
        return None
    weights = np.zeros(len(a.flat))
    k = a.mesh.nodes.shape[1]
    corners = a.corners[chosen[0]]
    for cell in [(0, 1, 2)] if a.mesh.corners == 3 else [(0, 1, 2), (0, 2, 3)]:
        points, area = quadrature(corners[:, list(cell)])
        flat = points.reshape(-1, 2)
        local = local_coordinates(np.repeat(corners, points.shape[1], axis=0), flat)
        values = functions(k, local) * area.reshape(-1, 1)
        np.add.at(weights, np.repeat(a.mesh.nodes[chosen[0]], points.shape[1], axis=0), values)
    pair, one = np.arange(len(nodes_a)), np.ones(len(nodes_a))
    own, other = Side(pair, nodes_a, one), Side(pair, nodes_b[partner], one)
    return PatchCoupling(a.flat[nodes_a], weights[nodes_a], own, other, "node pairs")


def _mortar(slave: FaceSide, master: FaceSide | None, patch: shapely.Polygon) -> tuple[Array, Array, Side, Side | None]:
    """Return positions, areas, and the entries of slave and master."""
    whole = slave.mesh.order == 2 and _covered_whole(slave, patch)
    parts = slave.mesh.nodes if whole else slave.mesh.parts
    corners = slave.corners if whole else slave.flat[parts]
    cells = shapely.polygons(corners)
    near = shapely.STRtree(cells).query(patch, predicate="intersects")
    near.sort()
    covered = common(cells[near], patch)
    some = shapely.area(covered) > 1e-12 * patch.area
    piece_part, pieces = near[some], covered[some]
    piece_master = np.zeros(len(pieces), dtype=int)
    if master is not None:
        facets = shapely.polygons(master.corners)
        k, m = shapely.STRtree(facets).query(pieces, predicate="intersects")
        cut = common(pieces[k], facets[m])
        some = shapely.area(cut) > 1e-13 * patch.area
        pieces, piece_part, piece_master = cut[some], piece_part[k[some]], m[some]
    triangles = [triangles_in(piece) for piece in pieces]
    count = np.array([len(t) for t in triangles], dtype=int)
    cut_in = np.concatenate(triangles)
    if whole:
        cut_in, count = _quartered(cut_in), 4 * count
    points, weights = quadrature(cut_in)
    each = points.shape[1]
    x, w = points.reshape(-1, 2), weights.ravel()
    part, of_master = (np.repeat(np.repeat(v, count), each) for v in (piece_part, piece_master))

    number, own_part = np.unique(part, return_inverse=True)
    c = parts.shape[1]
    basis = functions(c, local_coordinates(corners[part], x))  # (n, c)
    if c == 6:
        basis = basis @ POSITIVE
    lumped, mass = np.zeros((len(number), c)), np.zeros((len(number), c, c))
    np.add.at(lumped, own_part, w[:, None] * basis)
    np.add.at(mass, own_part, w[:, None, None] * basis[:, :, None] * basis[:, None, :])
    full = shapely.area(cells[number])
    dual = lumped[:, :, None] * np.linalg.inv(mass + 1e-300 * np.eye(c))
    dual[lumped.sum(1) < HARDLY * full] = np.eye(c)
    psi = w[:, None] * np.einsum("nij,nj->ni", dual[own_part], basis)

    nodes, at_node = np.unique(parts[number], return_inverse=True)
    pair = at_node.reshape(len(number), c)[own_part]  # (n, c)
    area, position = np.zeros(len(nodes)), np.zeros((len(nodes), 2))
    np.add.at(area, pair, w[:, None] * basis)
    np.add.at(position, pair, psi[:, :, None] * x[:, None])
    own = _entries(slave, part // (len(parts) // len(slave.mesh.nodes)), x, pair, psi, area)
    other = None if master is None else _entries(master, of_master, x, pair, psi, area)
    return position / area[:, None], area, own, other


def _entries(side: FaceSide, facet: Array, x: Array, pair: Array, psi: Array, area: Array) -> Side:
    """Return the weights with which the nodes of a side enter the pairs, from its facet (n,) at each point x (n, 2)."""
    values = functions(side.mesh.nodes.shape[1], local_coordinates(side.corners[facet], x))
    nodes, column = np.unique(side.mesh.nodes[facet], return_inverse=True)
    column = column.reshape(values.shape)
    matrix = np.zeros((len(area), len(nodes)))
    np.add.at(matrix, (pair[:, :, None], column[:, None, :]), psi[:, :, None] * values[:, None, :])
    matrix /= area[:, None]
    row, col = np.nonzero(np.abs(matrix) > 1e-13)
    return Side(row, nodes[col], matrix[row, col])
