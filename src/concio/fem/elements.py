r"""Element families, as operators at the integration points of one body.

scikit-fem supplies shape functions and quadrature. What leaves this module is, for one meshed body with ``n`` nodes and
``q`` integration points, the strain operator ``B`` (s q x d n), the interpolation ``N`` (q x n) and the weights ``w``
(area or volume belonging to each point). Stiffness, loads and stresses follow from these three alone:

.. math:: K = B^T (D \otimes w h) B, \qquad \sigma = D B u, \qquad f = N^T w h\, b .

Unknowns are ordered node by node, ``(u_x, u_y)`` or ``(u_x, u_y, u_z)``; strains are ``(e_x, e_y, g_xy)``, in space
``(e_x, e_y, e_z, g_xy, g_yz, g_xz)``; stresses are tension positive. In space a unit thickness takes the place of h.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp

from concio.arguments import closest
from concio.errors import GeometryError, InputError
from concio.representation import short_repr

if TYPE_CHECKING:
    import skfem

Array = np.ndarray


@dataclass(frozen=True)
class Family:
    """An element family: class of scikit-fem or its name, corners, quadrature order, order of its edges, dimension."""

    element: str | type
    cells: int
    quadrature: int
    edge_order: int
    incompatible: bool = False
    dim: int = 2


FAMILIES: dict[str, Family] = {
    "Q4": Family("ElementQuad1", 4, 3, 1),
    "Q4I": Family("ElementQuad1", 4, 3, 1, incompatible=True),
    "Q8": Family("ElementQuadS2", 4, 5, 2),
    "Q9": Family("ElementQuad2", 4, 5, 2),
    "T3": Family("ElementTriP1", 3, 1, 1),
    "T6": Family("ElementTriP2", 3, 4, 2),
}
"""Element families by name. Quadrature integrates the stiffness of parallelograms and triangles exactly, with at least
as many points as an element has nodes, so that stresses can be fitted at the nodes of any mesh."""

SOLID_FAMILIES: dict[str, Family] = {
    "H8": Family("ElementHex1", 8, 3, 1, dim=3),
    "H8I": Family("ElementHex1", 8, 3, 1, incompatible=True, dim=3),
    "H27": Family("ElementHex2", 8, 5, 2, dim=3),
    "T4": Family("ElementTetP1", 4, 2, 1, dim=3),
    "T10": Family("ElementTetP2", 4, 4, 2, dim=3),
}
"""Element families of models in space."""


def family(name: str) -> Family:
    """Return the element family called ``name``.

    Raises
    ------
    InputError
        There is no such family.
    """
    known = {**FAMILIES, **SOLID_FAMILIES}
    if name not in known:
        msg = f"unknown element '{name}'"
        raise InputError(msg, hint=closest(name, known, names="one of"))
    return known[name]


@short_repr
@dataclass(frozen=True, eq=False)
class Elements:
    """Operators of one meshed body.

    Parameters
    ----------
    nodes : (n, d) array
        Node coordinates [m].
    cells : (e, k) array
        Corner nodes of each element: counter-clockwise, k = 3 or 4; in space tetrahedra, k = 4, and hexahedra, k = 8,
        whose lower face runs counter-clockwise seen from above, then the upper.
    B : (s q, d n) CSR array
        Strain operator; rows of point p are ``s p:s p + s``, s = 3 or 6.
    N : (q, n) CSR array
        Interpolation at the integration points.
    weights : (q,) array
        Area or volume of each integration point [m2, m3].
    points : (q, d) array
        Integration points [m].
    cell_of_point : (q,) array
        Element of each integration point.
    edge_order : int
        1: two nodes on an element edge, 2: three.
    connectivity : (e, k) array
        All nodes of each element, in the order of scikit-fem.
    """

    nodes: Array
    cells: Array
    B: sp.csr_array
    N: sp.csr_array
    weights: Array
    points: Array
    cell_of_point: Array
    edge_order: int
    connectivity: Array = field(default_factory=lambda: np.zeros((0, 0), dtype=int))
    """All nodes of each element (e, k), in the order of scikit-fem."""


def build(points: Array, cells: Array, name: str, D: Array) -> Elements:
    """Return the operators of a mesh.

    Parameters
    ----------
    points : (p, d) array
        Mesh vertices [m].
    cells : (e, k) array
        Corners of each element, as in :class:`Elements`.
    name : str
        Element family; a quadrilateral family on a triangular mesh takes the triangles of the same order, hexahedra on
        tetrahedra those that bend as well: T10 for H8I and H27, T4 for H8.
    D : (s, s) array
        Constitutive matrix [kN/m2]; only incompatible modes need it.

    Raises
    ------
    GeometryError
        An element is turned inside out.
    """
    import skfem  # takes as long to load as a small model of rigid blocks to solve

    chosen, cells = _fitting(family(name), cells)
    order = VERTICES.get(chosen.cells if chosen.dim == 3 else 0)
    own = cells if order is None else cells[:, order]
    element: Any = getattr(skfem, chosen.element) if isinstance(chosen.element, str) else chosen.element
    mesh_type = {(2, 4): skfem.MeshQuad, (2, 3): skfem.MeshTri, (3, 8): skfem.MeshHex, (3, 4): skfem.MeshTet}
    mesh = mesh_type[chosen.dim, chosen.cells](np.ascontiguousarray(points.T), np.ascontiguousarray(own.T))
    basis = skfem.Basis(mesh, element(), intorder=chosen.quadrature)
    nodes = np.ascontiguousarray(basis.doflocs.T)
    dofs = basis.element_dofs
    area = basis.dx
    jacobian = mesh.mapping().detDF(np.asarray(mesh.elem.refdom.p, dtype=float))  # at corners, where it is least
    if not ((jacobian > 0).all(1) | (jacobian < 0).all(1)).all():
        msg = "an element of the mesh is turned inside out"
        raise GeometryError(msg, hint="use a finer mesh or a simpler outline")
    e, g = area.shape
    d = chosen.dim
    gradient = np.stack([np.asarray(b[0].grad) for b in basis.basis])  # (k, d, e, g)
    value = np.stack([np.broadcast_to(np.asarray(b[0]), (e, g)) for b in basis.basis])
    strain = _strain_blocks(gradient)
    if chosen.incompatible:
        strain = _with_incompatible_modes(strain, D, basis, nodes[dofs[: chosen.cells].T])
    k, n, s = dofs.shape[0], len(nodes), strain.shape[2]
    columns = np.stack([d * dofs + i for i in range(d)], axis=1).reshape(d * k, e)  # (d k, e)
    rows = s * np.arange(e * g).reshape(e, g)
    row = np.broadcast_to(rows[:, :, None, None] + np.arange(s)[None, None, :, None], (e, g, s, d * k))
    column = np.broadcast_to(columns.T[:, None, None, :], (e, g, s, d * k))
    B = sp.csr_array((strain.ravel(), (row.ravel(), column.ravel())), shape=(s * e * g, d * n))
    point = np.broadcast_to(np.arange(e * g).reshape(e, g)[None], (k, e, g))
    node = np.broadcast_to(dofs[:, :, None], (k, e, g))
    N = sp.csr_array((value.ravel(), (point.ravel(), node.ravel())), shape=(e * g, n))
    where = np.asarray(basis.global_coordinates())
    corners = basis.element_dofs[: chosen.cells].T
    return Elements(
        nodes=nodes,
        cells=np.ascontiguousarray(corners if order is None else corners[:, np.argsort(order)]),
        B=B,
        N=N,
        weights=area.ravel(),
        points=where.reshape(d, -1).T.copy(),
        cell_of_point=np.repeat(np.arange(e), g),
        edge_order=chosen.edge_order,
        connectivity=np.ascontiguousarray(dofs.T),
    )


VERTICES = {8: np.array([6, 2, 5, 7, 1, 3, 4, 0])}
"""Our corner of a hexahedron for each of scikit-fem's, whose first is the one opposite to the origin."""


def _fitting(chosen: Family, cells: Array) -> tuple[Family, Array]:
    """Return the family that fits the cells of a mesh, and the cells, split where the family asks for simplices."""
    corners = cells.shape[1]
    if corners == chosen.cells:
        return chosen, cells
    if chosen.dim == 2:
        if corners == 3:
            return FAMILIES["T6" if chosen.edge_order == 2 else "T3"], cells
        return chosen, np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    if corners == 4:
        return SOLID_FAMILIES["T10" if chosen.edge_order == 2 or chosen.incompatible else "T4"], cells
    return chosen, np.vstack([cells[:, list(part)] for part in TETRAHEDRA])


TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
"""Corners of six tetrahedra round the diagonal of a hexahedron from its first corner; alike in neighbours that are
numbered alike."""


def _strain_blocks(gradient: Array) -> Array:
    """Strain matrices (e, g, s, d k) of shape-function gradients (k, d, e, g)."""
    k, d, e, g = gradient.shape
    block = np.zeros((e, g, STRAINS[d], d * k))
    slopes = np.moveaxis(gradient, 0, -1)  # (d, e, g, k)
    for i in range(d):
        block[:, :, i, i::d] = slopes[i]
    for row, (i, j) in enumerate(SHEARS[d], d):
        block[:, :, row, i::d] = slopes[j]
        block[:, :, row, j::d] = slopes[i]
    return block


STRAINS = {2: 3, 3: 6}
"""Number of strain components by dimension."""
SHEARS = {2: ((0, 1),), 3: ((0, 1), (1, 2), (0, 2))}
"""Axes of the shear strains by dimension."""


def _with_incompatible_modes(strain: Array, D: Array, basis: skfem.Basis, corners: Array) -> Array:
    """Add the modes 1 - xi^2, 1 - eta^2 (and the third) of Wilson with Taylor's correction, condensed by element.

    The gradients of the modes use the Jacobian of the element's centre, scaled by det J0 / det J, so that constant
    strain does no work on them and the patch test holds (Taylor, Beresford and Wilson, 1976). The amplitudes that
    minimise the element's energy are linear in the nodal displacements; they are put back into the strain operator.
    """
    xi = 2 * basis.X - 1  # (d, g)
    d = len(xi)
    local = np.zeros((d, d, xi.shape[1]))  # mode, direction, point
    for i in range(d):
        local[i, i] = -4 * xi[i]  # d(1 - xi^2) / dX, X in [0, 1]
    reference = np.asarray(basis.mesh.elem.refdom.p, dtype=float)
    centre = (2 * reference - 1) / 2 ** (d - 1)  # dN / dX at the centre
    jacobian = np.einsum("dk,ekc->edc", centre, corners)  # dx_c / dX_d
    inverse = np.linalg.inv(jacobian)
    scale = np.abs(np.linalg.det(jacobian))[:, None] / (basis.dx / basis.W)  # det J0 / det J, (e, g)
    modes = _strain_blocks(np.einsum("ecd,adg,eg->aceg", inverse, local, scale))  # (e, g, s, d d)
    weighted = np.einsum("eg,egsi,st->egti", basis.dx, modes, D)
    k_aa = np.einsum("egti,egtj->eij", weighted, modes)
    k_au = np.einsum("egti,egtj->eij", weighted, strain)
    amplitudes = -np.linalg.solve(k_aa, k_au)
    corrected: Array = strain + np.einsum("egsi,eij->egsj", modes, amplitudes)
    return corrected
