r"""The units in which errors of an answer are measured: those of what they belong to.

A force is measured by the loads of its own part of the structure (:mod:`concio.problem.parts`),

.. math:: F = \sum |f_i| \quad\text{over the unknowns of the part,}

or by its largest contact force where no load acts on it. A gap or a slip is measured by the displacements of the part,
or by less: a pair with compliance a takes up a F under all of the load, so that a length well below a F changes no
force,

.. math:: U = \max(\max |u_i|,\ \max a_k t_k), \qquad U_k = \min(U,\ a_k F) \text{ where } a_k > 0.

Without the second, forces of stiff joints could be chosen at will wherever something else in the part moves far: what
they would close is little beside that. Where nothing moves and no joint gives way, U is zero, and every gap or slip
that is not zero is wrong.

Rounding is distinguished from error: y = x + C u + a t is known to a few eps of the sizes it is summed from, and no
better, whoever solves. :data:`BALANCE_ROUNDING` of these is granted, never more than :data:`GRANTED` of the unit: where
displacements are so large beside the compliance of a joint that they do not determine its force, nothing is certified.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Parts, connected_parts
from concio.problem.products import product_of_sizes
from concio.problem.tolerances import BALANCE_ROUNDING, GRANTED
from concio.representation import short_repr

BEYOND = 1e100
"""What a length that is not zero counts where the unit is: much more than any tolerance."""


@short_repr
@dataclass(frozen=True, eq=False)
class Measure:
    """Units of one answer.

    Parameters
    ----------
    parts : Parts
    force : (P,) array
        F of each part [kN], never zero.
    length : (P,) array
        U of each part [m]; zero where nothing moves and no joint gives way.
    """

    parts: Parts
    force: Array
    length: Array

    @property
    def node_force(self) -> Array:
        """F at each unknown (N,) [kN]."""
        return np.asarray(self.force[self.parts.of_unknown])

    @property
    def pair_force(self) -> Array:
        """F of each pair (m,) [kN]."""
        return np.asarray(self.force[self.parts.of_pair])

    @property
    def pair_length(self) -> Array:
        """U of each pair (m,) [m], whatever its compliance."""
        return np.asarray(self.length[self.parts.of_pair])

    def length_of(self, compliance: Array) -> Array:
        """Return U_k of pairs with a compliance (m,) [m/kN] along a direction, (m,) [m]."""
        own = np.where(compliance > 0, compliance * self.pair_force, np.inf)
        return np.asarray(np.minimum(self.pair_length, own))


def measure(
    problem: ContactProblem,
    u: Array,
    t_n: Array,
    t_t: Array,
    *,
    total_load: float | None = None,
    moved: Array | float = 0.0,
) -> Measure:
    """Return the units of an answer u (N,), t_n (m,), t_t (m, d-1).

    Parameters
    ----------
    problem : ContactProblem
    u, t_n, t_t : arrays
    total_load : float, optional
        F of every part, where the problem's own loads are not the measure [kN].
    moved : (m,) array or float
        How far obstacles, or the edges of a periodic cell, have moved at each pair: U is not less [m].
    """
    parts = connected_parts(problem)
    if total_load:
        force = np.full(parts.count, float(total_load))
    else:
        carried = np.maximum(np.abs(t_n), np.abs(t_t).max(axis=1, initial=0.0))
        force = _loads(problem, parts)
        force = np.where(force > 0, force, parts.largest(parts.of_pair, carried))
        force = np.where(force > 0, force, 1.0)
    law = problem.laws
    slipped = law.tangential_compliance * np.linalg.norm(t_t, axis=1)
    at_pairs = np.maximum(np.maximum(law.normal_compliance * np.abs(t_n), slipped), moved)
    length = parts.largest(parts.of_unknown, np.abs(u))
    return Measure(parts, force, np.maximum(length, parts.largest(parts.of_pair, at_pairs)))


def _loads(problem: ContactProblem, parts: Parts) -> Array:
    """Return the total load of each part (P,) [kN]."""
    if not isinstance(problem.load, np.ndarray):
        if problem.load:
            return np.full(parts.count, problem.load)
        return parts.total(parts.of_unknown, np.abs(problem.f))
    found = parts.total(parts.of_unknown, np.abs(problem.load))
    return np.where(found > 0, found, parts.total(parts.of_unknown, np.abs(problem.f)))


def in_units(length: Array, unit: Array) -> Array:
    """Return lengths over their units, both (m,); what is not zero counts much where the unit is zero."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        found = np.where(length == 0.0, 0.0, length / unit)
    return np.asarray(np.clip(np.nan_to_num(found, nan=BEYOND, posinf=BEYOND, neginf=-BEYOND), -BEYOND, BEYOND))


def rounding(problem: ContactProblem, u: Array, t_n: Array, t_t: Array, measured: Measure) -> tuple[Array, Array]:
    """Return what rounding may have put gaps and slips wrong by, (m,) and (m,) [m]."""
    law, s = problem.laws, problem.dim - 1
    size = np.abs(u)
    slip = product_of_sizes(problem.C_t, size).reshape(problem.pairs, s) + np.abs(problem.slip_origin)
    slip += law.tangential_compliance[:, None] * np.abs(t_t)
    along = np.linalg.norm(slip, axis=1)
    normal = np.abs(problem.gap) + product_of_sizes(problem.C_n, size) + law.normal_compliance * np.abs(t_n)
    normal += law.dilatancy * along
    known = (BALANCE_ROUNDING * normal, BALANCE_ROUNDING * along)
    units = (measured.length_of(law.normal_compliance), measured.length_of(law.tangential_compliance))
    return np.minimum(known[0], GRANTED * units[0]), np.minimum(known[1], GRANTED * units[1])
