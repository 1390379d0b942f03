r"""Forces that equilibrium leaves open, well inside of what the joint laws allow.

Where several blocks meet in a node, part of the contact forces does no work, and the answer takes the least of them:
pairs may touch there without force, or be at the limit of friction without slip. None of them is about to change for
that reason: other forces at the same displacements keep each pair well inside of its state. Such forces are

.. math:: \max \sum_k s_k, \qquad C^T t = C^T t^*, \quad 0 \le s_k \le \bar s, \quad t_k \text{ at least } s_k
   \text{ inside of } S_k(u),

a linear programme, with t* the forces found and S_k(u) the forces that the laws allow at these displacements. In space
cones are replaced by pyramids inside of them.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.programme import optimise

Array = np.ndarray

INSIDE = 1e-4
"""How far inside of their sets forces are moved at most, over the largest force."""
SIDES = 16
"""Sides of the pyramid inside of a cone of friction in space."""


def inner_forces(problem: ContactProblem, forces: Array, touches: Array, way: Array) -> Array:
    """Return forces with the same resultants, inside of the sets that the joint laws allow wherever there are any.

    Parameters
    ----------
    problem : ContactProblem
    forces : (m, d) array
        Of an answer [kN], normal first.
    touches : (m,) boolean array
        Pairs that are closed, whose forces may change.
    way : (m, d-1) array
        Directions of slips, of length one; zero for pairs that do not slip.

    Returns
    -------
    (m, d) array
        ``forces`` itself where there is no choice.
    """
    law, size = problem.laws, float(np.abs(forces).max(initial=0.0))
    hard = (law.normal_compliance == 0) & (law.tangential_compliance == 0)
    pick = np.flatnonzero(touches & hard)
    if not len(pick) or size == 0.0:
        return forces
    c, d = len(pick), problem.dim
    C = sp.vstack([sp.csr_array(problem.C_n)[pick], *(sp.csr_array(problem.C_t)[pick * (d - 1) + j]
                                                      for j in range(d - 1))], format="csr")  # fmt: skip
    meets = sp.csr_array(C.T)
    meets = meets[np.diff(meets.indptr) > 0]
    found = forces[pick].T.ravel() / size
    rows, right, equal, equal_right = _laws(problem, pick, way[pick], size)
    zero = sp.csr_array((meets.shape[0], c))
    answer = optimise(
        -np.repeat([0.0, 1.0], [c * d, c]),
        (sp.csc_array(sp.vstack([sp.hstack([meets, zero]), equal])), np.concatenate([meets @ found, equal_right])),
        np.repeat([[-np.inf, np.inf], [0.0, INSIDE]], [c * d, c], axis=0),
        (sp.csc_array(rows), right),
        method="highs",
    )
    if answer.status != 0:
        return forces
    change = answer.x[: c * d] - found
    change = change - spl.lsmr(meets, meets @ change, atol=1e-15, btol=1e-15)[0]
    moved = forces.copy()
    moved[pick] += size * change.reshape(d, c).T
    return moved


def _laws(
    problem: ContactProblem, pick: Array, way: Array, size: float
) -> tuple[sp.csr_array, Array, sp.csr_array, Array]:
    """Return inequalities and equations of (normal forces, friction forces by component, distances inside)."""
    law, c, d = problem.laws, len(pick), problem.dim
    one, none = sp.eye_array(c, format="csr"), sp.csr_array((c, c))
    friction = sp.diags_array(law.friction[pick], format="csr")
    tension, cap = law.tension[pick] / size, law.cap[pick] / size
    strength = law.cohesion[pick] / size  # without normal force
    slips = np.linalg.norm(way, axis=1) > 0
    still = np.flatnonzero(~slips)
    sides = _sides(d)
    shrink = float(np.cos(np.pi / len(sides))) if d == 3 else 1.0
    rows = [sp.hstack([-one, *[none] * (d - 1), one])]
    right = [tension]
    capped = np.flatnonzero(np.isfinite(cap))
    rows.append(sp.hstack([one, *[none] * (d - 1), one], format="csr")[capped])
    right.append(cap[capped])
    rough = still[law.friction[pick][still] + strength[still] > 0]
    for side in sides:
        row = sp.hstack([-shrink * friction, *(float(x) * one for x in side), friction], format="csr")
        rows.append(row[rough])
        right.append(shrink * strength[rough])
    moving = np.flatnonzero(slips)
    equal, equal_right = [], []
    for j in range(d - 1):
        along = [none] * (d - 1)
        along[j] = one
        turned = sp.diags_array(way[:, j], format="csr")
        equal.append(sp.hstack([turned @ friction, *along, none], format="csr")[moving])
        equal_right.append(-(way[:, j] * strength)[moving])
    return (
        sp.vstack(rows, format="csr"), np.concatenate(right), sp.vstack(equal, format="csr"),
        np.concatenate(equal_right),
    )  # fmt: skip


def _sides(d: int) -> Array:
    """Return the normals (k, d-1) of the sides of a pyramid."""
    if d == 2:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.column_stack([np.cos(angle), np.sin(angle)])
