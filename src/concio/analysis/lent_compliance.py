r"""Rigid blocks are the limit of stiff joints: a vanishing compliance for hard joints that nothing else makes yield.

Between bodies that do not deform, joined by hard joints, forces are not determined, and Coulomb's law is void: slip is
opposed by friction only where it is known which way a pair would slip, and without displacements no pair does. Any
forces within the cones would pass for a solution: a block squeezed between two faces would hang there, though nothing
ever squeezed it. So such joints are lent a compliance, and everybody who solves, follows a path or asks for a margin
lends the same and says so. It is spread like that of a thin layer, in proportion to one over the area of a pair, and
is tangentially :data:`SHEAR_TO_NORMAL` times the normal one.

Where no support moves and no gap is closed the problem is homogeneous: forces, states and multipliers do not depend on
the size of the compliance at all, displacements are proportional to it. Otherwise it is small beside what moves. Forces
do depend on the ratio, as they do on the stiffness of a real wall.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.contact.assembly import Assembly, as_assembly
from concio.model.model import Model
from concio.problem.contact_problem import Array, ContactProblem, Laws

SHEAR_TO_NORMAL = 2.5
"""Tangential over normal compliance lent: that of an elastic layer with Poisson's ratio 0.25."""

CLOSING = 1e-9
"""Closing of a pair of mean area under the heaviest nodal load [m]..."""

OF_MOVEMENTS = 1e-4
"""...or, where supports move, this share of the largest movement imposed on a joint: less, and double precision could
not tell forces from rounding."""


def lent_assembly(model: Model | Assembly) -> Assembly:
    """Return the assembly of a model, see :func:`lend`; raises as :func:`concio.contact.assembly.as_assembly` does."""
    return lend(as_assembly(model))


def lend(assembly: Assembly) -> Assembly:
    """Lend a vanishing compliance to every hard pair neither side of which deforms.

    Parameters
    ----------
    assembly : Assembly
        One to which compliance was lent already is returned as it is.

    Returns
    -------
    Assembly
        Its ``lent_compliance`` says how much [m/kN, a pair of mean area], 0 where none was needed.
    """
    pairs, law = assembly.pairs, assembly.laws
    if assembly.lent_compliance or not len(pairs):
        return assembly
    deforms = np.array([body.kind == "elastic" for body in assembly.model.bodies] + [False])  # the last: a fixed point
    stiff = ~(deforms[pairs.body_a] | deforms[pairs.body_b])
    normal, tangential = stiff & (law.normal_compliance == 0), stiff & (law.tangential_compliance == 0)
    force = max((float(np.abs(load).max(initial=0.0)) for load in assembly.loads.values()), default=0.0)
    if not (normal | tangential).any() or not force:
        return assembly
    lent = max(CLOSING, OF_MOVEMENTS * _movements(assembly)[stiff].max(initial=0.0)) / force
    return replace(assembly, laws=_softer(law, pairs.area, stiff, lent), lent_compliance=lent)


def with_compliance(problem: ContactProblem, live: Array) -> tuple[ContactProblem, float]:
    """Lend a small compliance to every hard pair of a problem in which nothing deforms; return it and the compliance.

    Parameters
    ----------
    problem : ContactProblem
    live : (N,) array
        Loads from which the size is taken where the problem has none.

    Returns
    -------
    ContactProblem
        The problem itself where something deforms, or no pair is hard.
    float
        Normal compliance of a pair of mean area [m/kN], 0 where none was lent.
    """
    law = problem.laws
    hard = (law.normal_compliance == 0) | (law.tangential_compliance == 0)
    force = float(np.abs(problem.f).max(initial=0.0)) or float(np.abs(live).max(initial=0.0))
    if (problem.K.nnz and np.abs(problem.K.data).any()) or not hard.any() or not force:
        return problem, 0.0
    everywhere = np.ones(problem.pairs, dtype=bool)
    return replace(problem, laws=_softer(law, problem.area, everywhere, CLOSING / force)), CLOSING / force


def _softer(law: Laws, area: Array, where: Array, lent: float) -> Laws:
    """Return the laws with compliance lent to the hard pairs among ``where`` (m,), in proportion to 1 / area."""
    compliance = lent * area[where].mean() / area
    normal, tangential = where & (law.normal_compliance == 0), where & (law.tangential_compliance == 0)
    return replace(
        law,
        normal_compliance=np.where(normal, compliance, law.normal_compliance),
        tangential_compliance=np.where(tangential, SHEAR_TO_NORMAL * compliance, law.tangential_compliance),
    )


def _movements(assembly: Assembly) -> Array:
    """Return the largest movement (m,) that supports, moved obstacles or overlaps impose on each pair [m]."""
    pairs = assembly.pairs
    m = len(pairs)
    moved = [np.maximum(-pairs.gap, 0.0)]
    for normal, tangential in assembly.moved.values():
        moved += [np.abs(normal), np.abs(tangential).reshape(m, -1).max(axis=1)]
    for u in assembly.supported.imposed.values():
        moved += [np.abs(pairs.C_n @ u), np.abs(pairs.C_t @ u).reshape(m, -1).max(axis=1)]
    return np.asarray(np.max(moved, axis=0))
