"""A small compliance for hard joints between rigid blocks, whose forces are otherwise not determined.

A path needs to know which joint slips next, and between rigid blocks on hard joints the forces are not unique. For
paths only, such joints get a uniform compliance, tangential 2.5 times the normal one, and whoever lends it says so.
Without initial gaps the multipliers of a path do not depend on its size, but they do on the ratio.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.contact.assembly import Assembly
from concio.problem.contact_problem import Array, ContactProblem

SHEAR_TO_NORMAL = 2.5
"""Tangential over normal compliance lent to hard joints of rigid blocks: Poisson's ratio 0.25."""

CLOSING = 1e-6
"""Displacement under the heaviest nodal load that fixes the size of the compliance [m]."""


def with_compliance(problem: ContactProblem, live: Array) -> tuple[ContactProblem, float]:
    """Lend a small compliance to every hard pair where bodies do not deform; return the problem and a_n [m/kN].

    Parameters
    ----------
    problem : ContactProblem
    live : (N,) array
        Loads from which the size is taken where the problem has none.
    """
    if problem.K.nnz and np.abs(problem.K.data).any():
        return problem, 0.0
    return _lend(problem, live, np.ones(problem.pairs, dtype=bool))


def assembly_with_compliance(assembly: Assembly) -> tuple[Assembly, float]:
    """Lend a small compliance to every hard pair neither side of which deforms; return the assembly and a_n [m/kN]."""
    bodies = assembly.model.bodies
    elastic = np.array([body.kind == "elastic" for body in bodies] + [False])  # the last one: a point fixed in space
    problem = assembly.problem()
    live = np.sum([np.abs(assembly.supported.T.T @ load) for load in assembly.loads.values()], axis=0)
    pairs = assembly.pairs
    lent, size = _lend(problem, np.atleast_1d(live), ~(elastic[pairs.body_a] | elastic[pairs.body_b]))
    return (replace(assembly, laws=lent.laws), size) if size else (assembly, 0.0)


def _lend(problem: ContactProblem, live: Array, where: Array) -> tuple[ContactProblem, float]:
    law = problem.laws
    normal = where & (law.normal_compliance == 0)
    tangential = where & (law.tangential_compliance == 0)
    force = float(np.abs(problem.f).max(initial=0.0)) or float(np.abs(live).max(initial=0.0))
    if not (normal | tangential).any() or not force:
        return problem, 0.0
    lent = CLOSING / force
    laws = replace(
        law,
        normal_compliance=np.where(normal, lent, law.normal_compliance),
        tangential_compliance=np.where(tangential, SHEAR_TO_NORMAL * lent, law.tangential_compliance),
    )
    return replace(problem, laws=laws), lent
