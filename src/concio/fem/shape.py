"""One shape: everything that identical bodies share. Stiffness, loads, rigid motions and boundary nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.fem.elements import Elements
from concio.kinematics.frames import turned_left
from concio.kinematics.rigid import rigid_modes
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True)
class EdgeNodes:
    """Nodes along one edge of an outline.

    Parameters
    ----------
    nodes : (k,) integer array
        Node numbers in the order of the outline.
    at : (k,) array
        Distance of each from the first vertex of the edge [m].
    order : int
        1: each two neighbours are an element edge; 2: each three (corner, middle, corner).
    """

    nodes: Array
    at: Array
    order: int


class Meshed:
    """What follows from the elements of a shape alone, in the plane and in space: d dimensions, s strain components."""

    elements: Elements
    D: Array
    thickness: float

    @property
    def dim(self) -> int:
        """Dimension d."""
        return int(self.elements.nodes.shape[1])

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns."""
        return int(self.elements.nodes.size)

    @cached_property
    def K(self) -> sp.csr_array:
        """Stiffness (d n, d n) [kN/m], symmetric to the last bit."""
        el = self.elements
        weighted = sp.kron(sp.diags_array(el.weights * self.thickness), self.D, format="csr")
        K = el.B.T @ (weighted @ el.B)
        K = sp.csr_array((K + K.T) * 0.5)
        K.sum_duplicates()
        return K

    @cached_property
    def R(self) -> Array:
        """Rigid motions (d n, 3 or 6), orthonormal: translations, then rotations about the nodes' mean."""
        return rigid_modes(self.elements.nodes)

    @cached_property
    def volume_weights(self) -> Array:
        """Volume belonging to each node (n,): the load of a unit body force [m3]."""
        el = self.elements
        weights: Array = el.N.T @ (el.weights * self.thickness)
        return weights

    @cached_property
    def mass(self) -> sp.csr_array:
        """Integrals of the products of two shape functions (n, n) [m3]: the mass of density one, symmetric."""
        el = self.elements
        if el.connectivity.shape[1] == self.dim + 1:  # linear on simplices: fewer points than products need
            mass = _mass_of_simplices(el, self.thickness)
        else:
            mass = el.N.T @ (sp.diags_array(el.weights * self.thickness) @ el.N)
        return sp.csr_array((mass + mass.T) * 0.5)

    @cached_property
    def stress_operator(self) -> sp.csr_array:
        """D B (s q, d n): stresses at the integration points from displacements."""
        return sp.csr_array(sp.kron(sp.eye_array(len(self.elements.weights)), self.D) @ self.elements.B)

    @cached_property
    def projection(self) -> Array:
        """(n, n): inverse of the mass matrix of the interpolation, for least-squares fits at the nodes."""
        el = self.elements
        return np.linalg.inv((el.N.T @ (sp.diags_array(el.weights) @ el.N)).toarray())

    @cached_property
    def mean_stress_operator(self) -> Array:
        """(s, d n): mean stress of the body from displacements."""
        w = self.elements.weights / self.elements.weights.sum()
        mean = sp.csr_array(sp.kron(w[None, :], np.eye(len(self.D))))
        return np.asarray((mean @ self.stress_operator).todense())


def _mass_of_simplices(el: Elements, thickness: float) -> sp.csr_array:
    """Return the mass (n, n) of linear triangles or tetrahedra: V (1 + delta_ij) / ((d + 1) (d + 2)) each."""
    nodes = el.connectivity
    k = nodes.shape[1]
    volume = np.bincount(el.cell_of_point, el.weights, len(nodes)) * thickness
    value = volume[:, None, None] * (1.0 + np.eye(k)) / (k * (k + 1))
    row, column = np.repeat(nodes, k, axis=1), np.tile(nodes, (1, k))
    return sp.csr_array((value.ravel(), (row.ravel(), column.ravel())), shape=(len(el.nodes), len(el.nodes)))


@short_repr
@dataclass(frozen=True, eq=False)
class Shape(Meshed):
    """A meshed elastic shape in the plane, placed with its first vertex at the origin.

    Parameters
    ----------
    outline : (v, 2) array
        Outline relative to its first vertex [m].
    elements : Elements
    D : (3, 3) array
        Constitutive matrix [kN/m2].
    thickness : float
        [m].
    holes : tuple of (k, 2) arrays
        Holes, clockwise, relative to the first vertex of the outline [m].
    """

    outline: Array
    elements: Elements
    D: Array
    thickness: float
    holes: tuple[Array, ...] = ()

    @property
    def rings(self) -> tuple[Array, ...]:
        """The outline and the holes."""
        return self.outline, *self.holes

    @cached_property
    def edges(self) -> tuple[EdgeNodes, ...]:
        """Boundary nodes of each edge of the outline, then of the holes, in order."""
        nodes = self.elements.nodes
        tolerance = 1e-7 * float(np.ptp(self.outline, axis=0).max())
        found = []
        for a, b in ((a, b) for ring in self.rings for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)):
            length = float(np.linalg.norm(b - a))
            tangent = (b - a) / length
            at = (nodes - a) @ tangent
            off = np.abs((nodes - a) @ turned_left(tangent))
            on = np.flatnonzero((off <= tolerance) & (at >= -tolerance) & (at <= length + tolerance))
            on = on[np.argsort(at[on])]
            found.append(EdgeNodes(on, at[on], self.elements.edge_order))
        return tuple(found)
