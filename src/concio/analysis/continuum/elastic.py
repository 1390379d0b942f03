r"""The elastic continuum: six-node triangles with homogenised moduli, held by the joints of the wall's supports.

Hard joints hold the wall like glue, compliant ones like springs k_n, k_t for each area: all joints are taken as closed
and stuck, as in the moduli themselves. What is shown has been checked: the residual of the equations, the balance of
loads and reactions, and energy equal to half the work.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import sym_grad

from concio.analysis.continuum.continuum import Continuum
from concio.errors import SolverError
from concio.problem.tolerances import CHECKED
from concio.read_only import read_only

Array = np.ndarray


@dataclass(frozen=True, eq=False)
@read_only
class ElasticContinuum:
    """Answer of the elastic continuum.

    Parameters
    ----------
    wall : Continuum
    matrix : (3, 3) array
        Moduli [kN/m2].
    factors : mapping of str to float
        Load factors; groups not named have 1.
    displacement : (n, 2) array
        At the nodes of the mesh [m].
    stress : (e, 3) array
        Mean stress xx, yy, xy of each triangle [kN/m2].
    reactions : mapping of str to (2,) array
        Force of each fixed body on the wall [kN].
    residual : float
        Worst of: residual of the equations, imbalance of loads and reactions, both relative to the load, and energy
        against work, relative.
    at_quadratic : (2, q) array
        Nodes of the quadratic elements, mid-sides included [m].
    motion : (q, 2) array
        Displacements there [m].
    """

    wall: Continuum
    matrix: Array
    factors: Mapping[str, float]
    displacement: Array
    stress: Array
    reactions: Mapping[str, Array]
    residual: float
    at_quadratic: Array
    motion: Array

    @property
    def max_settlement(self) -> float:
        """Largest downward displacement [m]; zero if everything rises."""
        return max(0.0, -float(self.motion[:, 1].min()))

    @cached_property
    def _finder(self) -> Any:
        mesh = skfem.MeshTri(self.wall.points.T.copy(), self.wall.triangles.T.copy())
        return mesh.element_finder()

    def at(self, places: Array) -> tuple[Array, Array]:
        """Return displacements (k, 2) [m] and stresses (k, 3) [kN/m2] at places (k, 2) within the wall."""
        wall = self.wall
        element = self._finder(*places.T)
        corners = wall.points[wall.triangles[element]]
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        share = np.linalg.solve(edges, (places - corners[:, 0])[:, :, None])[:, :, 0]
        weights = np.column_stack([1 - share.sum(1), share])
        u = np.einsum("kv,kvi->ki", weights, self.displacement[wall.triangles[element]])
        return u, self.stress[element]


def solve_elastic(wall: Continuum, matrix: Array, factors: Mapping[str, float]) -> ElasticContinuum:
    """Solve the elastic continuum under load factors.

    Raises
    ------
    SolverError
        Its equations are singular, or the answer does not stand up to its check.
    """
    mesh = skfem.MeshTri(wall.points.T.copy(), wall.triangles.T.copy())
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    t = wall.thickness

    def stiffness(u: Any, v: Any, _: Any) -> Any:
        e, d = _voigt(sym_grad(u)), _voigt(sym_grad(v))
        return t * sum(matrix[i, j] * e[j] * d[i] for i in range(3) for j in range(3))

    force = wall.force(factors)

    def weight(v: Any, _: Any) -> Any:
        return t * (force[0] * v[0] + force[1] * v[1])

    K = sp.csr_array(skfem.BilinearForm(stiffness).assemble(basis))
    f = skfem.LinearForm(weight).assemble(basis)
    facet = _facets(mesh, wall)
    pull = wall.pull(factors)
    for k in np.flatnonzero(np.abs(pull).any(axis=1)):
        f += _edge_load(skfem.FacetBasis(mesh, basis.elem, facets=facet[k : k + 1], intorder=4), pull[k], t)
    held = _supports(wall, basis, facet, wall.moved(factors), K.shape[0])
    springs, spring_load = sp.csr_array(K.shape), np.zeros(K.shape[0])
    for h in held:
        springs, spring_load = sp.csr_array(springs + h.springs), spring_load + h.load
    u = np.zeros(K.shape[0])
    for h in reversed(held):
        u[h.glued] = h.value
    glued = np.unique(np.concatenate([h.glued for h in held]))
    free = np.setdiff1d(np.arange(K.shape[0]), glued)
    whole = sp.csr_array(K + springs)
    right = f + spring_load - whole @ u
    try:
        factor = splu(sp.csc_matrix(whole[free][:, free]))
        u[free] = factor.solve(right[free])
    except RuntimeError:
        msg = "the equations of the continuum are singular"
        raise SolverError(msg, hint="the wall is not held, or its moduli leave it without stiffness") from None
    rest = whole @ u - f - spring_load
    stiff = float(np.abs(u) @ (abs(K) @ np.abs(u)))  # what the energy is a small difference of
    size = float(np.abs(f).sum()) or stiff / (float(np.abs(u).max()) or 1.0) or 1.0
    residual = float(np.abs(rest[free]).max(initial=0.0)) / size
    reaction = K @ u - f
    reactions = _reactions(wall, held, basis, u, reaction)
    total = np.sum([*reactions.values(), wall.resultant(factors)], axis=0)
    energy, work = float(u @ (K @ u)), float(u @ f + u @ reaction)
    unequal = abs(energy - work) / max(abs(energy), 1e-6 * stiff, 1e-300)
    residual = max(residual, float(np.abs(total).max()) / size, unequal)
    if not residual <= CHECKED:
        msg = f"the continuum does not stand up to its check: residual {residual:.1e}"
        raise SolverError(msg, hint="the wall is hardly held, or its moduli leave it nearly without stiffness")
    first, second = basis.split_indices()
    motion, places = np.column_stack([u[first], u[second]]), basis.doflocs[:, first]
    nodal = basis.nodal_dofs
    at_nodes = np.column_stack([u[nodal[0]], u[nodal[1]]])
    strain = _voigt(sym_grad(basis.interpolate(u)))
    mean = np.array([(e * basis.dx).sum(1) / basis.dx.sum(1) for e in strain])
    stress = (matrix @ mean).T
    return ElasticContinuum(wall, matrix, dict(factors), at_nodes, stress, reactions, residual, places, motion)


def _voigt(e: Any) -> tuple[Any, Any, Any]:
    return e[0, 0], e[1, 1], 2 * e[0, 1]


def _facets(mesh: skfem.MeshTri, wall: Continuum) -> Array:
    """Return the facet of the mesh of each boundary edge (b,)."""
    known = {tuple(pair): k for k, pair in enumerate(np.sort(mesh.facets.T, axis=1).tolist())}
    return np.array([known[tuple(pair)] for pair in np.sort(wall.edges, axis=1).tolist()])


@dataclass(frozen=True, eq=False)
class Held:
    """What one support does: unknowns held like glue with their values; springs (n, n) and their loads (n,)."""

    glued: Array
    value: Array
    springs: sp.csr_array
    load: Array


def _supports(wall: Continuum, basis: skfem.Basis, facet: Array, moved: Array, n: int) -> list[Held]:
    """Return what each support does; ``moved`` (supports, 3) are their motions."""
    found = []
    for number, (_, law) in enumerate(wall.supports):
        glued: dict[int, float] = {}
        springs, load = sp.csr_array((n, n)), np.zeros(n)
        ux, uy, turn = moved[number]
        for axis in (0, 1):  # edges run along x or y: their normals do, too
            for normal in (True, False):
                across = np.abs(wall.outward[:, axis]) > 0.5
                chosen = facet[(wall.held_by == number) & (across == normal)]
                if not len(chosen):
                    continue
                k = law.normal_stiffness if normal else law.tangential_stiffness
                if k is None:
                    dofs = basis.get_dofs(facets=chosen).all()
                    own = dofs[np.isin(dofs, basis.split_indices()[axis])]
                    x, y = basis.doflocs[:, own]
                    value = ux - turn * y if axis == 0 else uy + turn * x
                    glued |= dict(zip(own.tolist(), np.broadcast_to(value, own.shape).tolist(), strict=True))
                    continue
                edge = skfem.FacetBasis(basis.mesh, basis.elem, facets=chosen, intorder=4)
                stiffness, pushed = _springs(edge, axis, k * wall.thickness, moved[number])
                springs, load = sp.csr_array(springs + stiffness), load + pushed
        order = np.array(sorted(glued), dtype=int)
        found.append(Held(order, np.array([glued[k] for k in order.tolist()]), springs, load))
    return found


def _edge_load(edge: skfem.FacetBasis, pull: Array, thickness: float) -> Array:
    """Return the nodal forces (n,) of a constant traction (2,) on an edge."""
    px, py = pull
    return np.asarray(skfem.LinearForm(lambda v, _: thickness * (px * v[0] + py * v[1])).assemble(edge))


def _springs(edge: skfem.FacetBasis, axis: int, stiff: float, moved: Array) -> tuple[Any, Array]:
    """Return stiffness (n, n) and loads (n,) of springs along x or y on edges, whose other ends have moved (3,)."""

    def spring(u: Any, v: Any, _: Any) -> Any:
        return stiff * u[axis] * v[axis]

    def pushed(v: Any, w: Any) -> Any:
        given = moved[0] - moved[2] * w.x[1] if axis == 0 else moved[1] + moved[2] * w.x[0]
        return stiff * given * v[axis]

    return skfem.BilinearForm(spring).assemble(edge), np.asarray(skfem.LinearForm(pushed).assemble(edge))


def _reactions(
    wall: Continuum, held: list[Held], basis: skfem.Basis, u: Array, rest: Array
) -> dict[str, Array]:  # fmt: skip
    """Return the force (2,) of each fixed body; what several hold like glue at a corner they share evenly."""
    sharing = np.zeros(len(u))
    for h in held:
        sharing[h.glued] += 1
    from_springs = np.sum([h.load - h.springs @ u for h in held], axis=0)
    glue = rest - from_springs
    found: dict[str, Array] = {}
    for h, (name, _) in zip(held, wall.supports, strict=True):
        force = h.load - h.springs @ u
        force[h.glued] += glue[h.glued] / sharing[h.glued]
        total = np.array([force[part].sum() for part in basis.split_indices()])
        found[name] = found.get(name, np.zeros(2)) + total
    return found
