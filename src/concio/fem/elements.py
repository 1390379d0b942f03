r"""Element families, as operators at the integration points of one body.

scikit-fem supplies shape functions and quadrature. What leaves this module is, for one meshed body with ``n`` nodes and
``q`` integration points, the strain operator ``B`` (3q x 2n), the interpolation ``N`` (q x n) and the weights ``w``
(area belonging to each point). Stiffness, loads and stresses follow from these three alone:

.. math:: K = B^T (D \otimes w h) B, \qquad \sigma = D B u, \qquad f = N^T w h\, b .

Unknowns are ordered node by node, ``(u_x, u_y)``; strains are ``(e_x, e_y, g_xy)``; stresses are tension positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import skfem

from concio.arguments import closest
from concio.errors import GeometryError, InputError

Array = np.ndarray


@dataclass(frozen=True)
class Family:
    """An element family: scikit-fem element, quadrature order, and the order of its edges."""

    element: type
    cells: int
    quadrature: int
    edge_order: int
    incompatible: bool = False


FAMILIES: dict[str, Family] = {
    "Q4": Family(skfem.ElementQuad1, 4, 3, 1),
    "Q4I": Family(skfem.ElementQuad1, 4, 3, 1, incompatible=True),
    "Q8": Family(skfem.ElementQuadS2, 4, 5, 2),
    "Q9": Family(skfem.ElementQuad2, 4, 5, 2),
    "T3": Family(skfem.ElementTriP1, 3, 1, 1),
    "T6": Family(skfem.ElementTriP2, 3, 4, 2),
}
"""Element families by name. Quadrature integrates the stiffness of parallelograms and triangles exactly, with at least
as many points as an element has nodes, so that stresses can be fitted at the nodes of any mesh."""


def family(name: str) -> Family:
    """Return the element family called ``name``.

    Raises
    ------
    InputError
        There is no such family.
    """
    if name not in FAMILIES:
        msg = f"unknown element '{name}'"
        raise InputError(msg, hint=closest(name, FAMILIES, names="one of"))
    return FAMILIES[name]


@dataclass(frozen=True, eq=False)
class Elements:
    """Operators of one meshed body.

    Parameters
    ----------
    nodes : (n, 2) array
        Node coordinates [m].
    cells : (e, k) array
        Corner nodes of each element, counter-clockwise, k = 3 or 4.
    B : (3q, 2n) CSR array
        Strain operator; rows of point p are ``3p:3p+3``.
    N : (q, n) CSR array
        Interpolation at the integration points.
    weights : (q,) array
        Area of each integration point [m2].
    points : (q, 2) array
        Integration points [m].
    cell_of_point : (q,) array
        Element of each integration point.
    edge_order : int
        1: two nodes on an element edge, 2: three.
    """

    nodes: Array
    cells: Array
    B: sp.csr_array
    N: sp.csr_array
    weights: Array
    points: Array
    cell_of_point: Array
    edge_order: int


def build(points: Array, cells: Array, name: str, D: Array) -> Elements:
    """Return the operators of a mesh.

    Parameters
    ----------
    points : (p, 2) array
        Mesh vertices [m].
    cells : (e, 3) or (e, 4) array
        Vertices of each element, counter-clockwise.
    name : str
        Element family; a quadrilateral family on a triangular mesh takes the triangles of the same order.
    D : (3, 3) array
        Constitutive matrix [kN/m2]; only the incompatible modes of Q4I need it.

    Raises
    ------
    GeometryError
        An element is turned inside out.
    """
    chosen = family(name)
    if cells.shape[1] == 3 and chosen.cells == 4:
        chosen = FAMILIES["T6" if chosen.edge_order == 2 else "T3"]
    if cells.shape[1] == 4 and chosen.cells == 3:
        cells = np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    mesh_type = skfem.MeshQuad if chosen.cells == 4 else skfem.MeshTri
    mesh = mesh_type(np.ascontiguousarray(points.T), np.ascontiguousarray(cells.T))
    basis = skfem.Basis(mesh, chosen.element(), intorder=chosen.quadrature)
    nodes = np.ascontiguousarray(basis.doflocs.T)
    dofs = basis.element_dofs
    area = basis.dx
    jacobian = mesh.mapping().detDF(np.asarray(mesh.elem.refdom.p, dtype=float))  # at corners, where it is least
    if not ((jacobian > 0).all(1) | (jacobian < 0).all(1)).all():
        msg = "an element of the mesh is turned inside out"
        raise GeometryError(msg, hint="use a finer mesh or a simpler outline")
    e, g = area.shape
    gradient = np.stack([np.asarray(b[0].grad) for b in basis.basis])  # (k, 2, e, g)
    value = np.stack([np.broadcast_to(np.asarray(b[0]), (e, g)) for b in basis.basis])
    strain = _strain_blocks(gradient)
    if chosen.incompatible:
        strain = _with_incompatible_modes(strain, D, basis, nodes[dofs[:4].T])
    k, n = dofs.shape[0], len(nodes)
    columns = np.stack([2 * dofs, 2 * dofs + 1], axis=1).reshape(2 * k, e)  # (2k, e)
    rows = 3 * np.arange(e * g).reshape(e, g)
    row = np.broadcast_to(rows[:, :, None, None] + np.arange(3)[None, None, :, None], (e, g, 3, 2 * k))
    column = np.broadcast_to(columns.T[:, None, None, :], (e, g, 3, 2 * k))
    B = sp.csr_array((strain.ravel(), (row.ravel(), column.ravel())), shape=(3 * e * g, 2 * n))
    point = np.broadcast_to(np.arange(e * g).reshape(e, g)[None], (k, e, g))
    node = np.broadcast_to(dofs[:, :, None], (k, e, g))
    N = sp.csr_array((value.ravel(), (point.ravel(), node.ravel())), shape=(e * g, n))
    where = np.asarray(basis.global_coordinates())
    return Elements(
        nodes=nodes,
        cells=np.ascontiguousarray(basis.element_dofs[: chosen.cells].T),
        B=B,
        N=N,
        weights=area.ravel(),
        points=where.reshape(2, -1).T.copy(),
        cell_of_point=np.repeat(np.arange(e), g),
        edge_order=chosen.edge_order,
    )


def _strain_blocks(gradient: Array) -> Array:
    """Strain matrices (e, g, 3, 2k) of shape-function gradients (k, 2, e, g)."""
    k, _, e, g = gradient.shape
    block = np.zeros((e, g, 3, 2 * k))
    gx, gy = np.moveaxis(gradient, 0, -1)  # each (e, g, k)
    block[:, :, 0, 0::2] = gx
    block[:, :, 1, 1::2] = gy
    block[:, :, 2, 0::2] = gy
    block[:, :, 2, 1::2] = gx
    return block


def _with_incompatible_modes(strain: Array, D: Array, basis: skfem.Basis, corners: Array) -> Array:
    """Add the modes 1 - xi^2 and 1 - eta^2 of Wilson with Taylor's correction, condensed element by element.

    The gradients of the modes use the Jacobian of the element's centre, scaled by det J0 / det J, so that constant
    strain does no work on them and the patch test holds (Taylor, Beresford and Wilson, 1976). The amplitudes that
    minimise the element's energy are linear in the nodal displacements; they are put back into the strain operator.
    """
    xi = 2 * basis.X - 1  # (2, g)
    local = np.zeros((2, 2, xi.shape[1]))  # mode, direction, point
    local[0, 0] = -4 * xi[0]  # d(1 - xi^2) / dX, X in [0, 1]
    local[1, 1] = -4 * xi[1]
    centre = 0.5 * np.array([[-1.0, 1, 1, -1], [-1, -1, 1, 1]])  # dN / dX at the centre
    jacobian = np.einsum("dk,ekc->edc", centre, corners)  # dx_c / dX_d
    inverse = np.linalg.inv(jacobian)
    scale = np.linalg.det(jacobian)[:, None] / (basis.dx / basis.W)  # det J0 / det J, (e, g)
    modes = _strain_blocks(np.einsum("ecd,adg,eg->aceg", inverse, local, scale))  # (e, g, 3, 4)
    weighted = np.einsum("eg,egsi,st->egti", basis.dx, modes, D)
    k_aa = np.einsum("egti,egtj->eij", weighted, modes)
    k_au = np.einsum("egti,egtj->eij", weighted, strain)
    amplitudes = -np.linalg.solve(k_aa, k_au)  # (e, 4, 8)
    corrected: Array = strain + np.einsum("egsi,eij->egsj", modes, amplitudes)
    return corrected
