r"""Rigid blocks are the limit of stiff joints: a vanishing compliance for hard joints that nothing else makes yield.

Between bodies that do not deform, joined by hard joints, forces are not determined, and Coulomb's law is void: slip is
opposed by friction only where it is known which way a pair would slip, and without displacements no pair does. Any
forces within the cones would pass for a solution: a block squeezed between two faces would hang there, though nothing
ever squeezed it. So such joints are given a compliance, and everybody who solves, follows a path or asks for a margin
adds the same and says so. It is spread like that of a thin layer, in proportion to one over the area of a pair, and
is tangentially :data:`SHEAR_TO_NORMAL` times the normal one.

Where no support moves and no gap is closed the problem is homogeneous: forces, states and multipliers do not depend on
the size of the compliance at all, displacements are proportional to it. Otherwise it is small beside what moves. Forces
do depend on the ratio, as they do on the stiffness of a real wall.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.contact.assembly import Assembly, as_assembly
from concio.model.model import Model
from concio.problem.contact_problem import Array, ContactProblem, Laws

SHEAR_TO_NORMAL = 2.5
"""Tangential over normal compliance added: that of an elastic layer with Poisson's ratio 0.25."""

CLOSING = 1e-9
"""Closing of a pair of mean area under the heaviest nodal load of its connected part [m]..."""

OF_MOVEMENTS = 1e-4
"""...or, where supports move, this share of the largest movement imposed on a joint: less, and double precision could
not tell forces from rounding."""


def lent_assembly(model: Model | Assembly) -> Assembly:
    """Return the assembly of a model, see :func:`lend`; raises as :func:`concio.contact.assembly.as_assembly` does."""
    return lend(as_assembly(model))


def lend(assembly: Assembly) -> Assembly:
    """Add a vanishing compliance to every hard pair neither side of which deforms.

    Parameters
    ----------
    assembly : Assembly
        One to which compliance was given already is returned as it is.

    Returns
    -------
    Assembly
        Its ``lent_compliance`` says how much [m/kN, a pair of mean area], 0 where none was needed, and the most where
        connected parts, each by its own loads and areas, were given different ones.
    """
    pairs, law = assembly.pairs, assembly.laws
    if assembly.lent_compliance or not len(pairs):
        return assembly
    deforms = np.array([body.kind == "elastic" for body in assembly.model.bodies] + [False])  # the last: a fixed point
    stiff = ~(deforms[pairs.body_a] | deforms[pairs.body_b])
    hard = stiff & _hard(law)
    if not hard.any():
        return assembly
    of_body, of_pair = connected_bodies(assembly)
    owner = np.repeat(of_body, np.diff(assembly.disc.offsets))
    count = int(max(of_body.max(initial=0), of_pair.max(initial=0))) + 1
    force, movement = np.zeros(count), np.zeros(count)
    for load in assembly.loads.values():
        np.maximum.at(force, owner, np.abs(load))
    np.maximum.at(movement, of_pair[stiff], _movements(assembly)[stiff])
    force = np.where((force == 0) & (movement > 0), 1.0, force)  # only moved: any force will do as a unit
    closing = np.maximum(CLOSING, OF_MOVEMENTS * movement)
    lent = np.where(force > 0, closing / np.where(force > 0, force, 1.0), 0.0)
    if not lent[of_pair[hard]].any():
        return assembly
    laws = _softer(law, pairs.area, stiff, lent[of_pair], of_pair)
    return replace(assembly, laws=laws, lent_compliance=float(lent[of_pair[hard]].max()))


def stiffened(lent: Assembly, hard: Assembly, left: Array) -> Assembly:
    """Return the assembly that keeps the compliance added to some pairs only, and says how much if to any.

    Parameters
    ----------
    lent, hard : Assembly
        With and without it.
    left : (m,) boolean array
        Pairs that keep it.
    """
    if not left.any():
        return hard
    if left.all():
        return lent
    softer, law = lent.laws, hard.laws
    kept = replace(
        law,
        normal_compliance=np.where(left, softer.normal_compliance, law.normal_compliance),
        tangential_compliance=np.where(left, softer.tangential_compliance, law.tangential_compliance),
    )
    names = ("normal_compliance", "tangential_compliance")
    changed = any((getattr(kept, name) != getattr(law, name)).any() for name in names)
    return replace(hard, laws=kept, lent_compliance=lent.lent_compliance) if changed else hard


def connected_bodies(assembly: Assembly) -> tuple[Array, Array]:
    """Return the number of the connected part of each body (B,) and of each pair (m,).

    Bodies without free unknowns connect nothing, and are parts of their own; so are pairs between two of them.
    """
    pairs, free = assembly.pairs, np.append(np.diff(assembly.supported.bodies) > 0, False)
    bodies, m = len(free) - 1, len(pairs)
    ends = [(np.arange(m), body) for body in (pairs.body_a, pairs.body_b)]
    row, column = (np.concatenate(c) for c in zip(*((k[free[b]], b[free[b]]) for k, b in ends), strict=True))
    size = bodies + m
    graph = sp.csr_array((np.ones(row.size, dtype=np.int8), (bodies + row, column)), shape=(size, size))
    _, label = connected_components(graph, directed=False)
    return label[:bodies], label[bodies:]


def with_compliance(problem: ContactProblem, live: Array) -> tuple[ContactProblem, float]:
    """Add a small compliance to every hard pair of a problem in which nothing deforms; return it and the compliance.

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
        Normal compliance of a pair of mean area [m/kN], 0 where none was given.
    """
    law = problem.laws
    hard = _hard(law)
    force = float(np.abs(problem.f).max(initial=0.0)) or float(np.abs(live).max(initial=0.0))
    if (problem.K.nnz and np.abs(problem.K.data).any()) or not hard.any() or not force:
        return problem, 0.0
    everywhere, one = np.ones(problem.pairs, dtype=bool), np.zeros(problem.pairs, dtype=int)
    return replace(problem, laws=_softer(law, problem.area, everywhere, CLOSING / force, one)), CLOSING / force


def _hard(law: Laws) -> Array:
    """Tell which pairs (m,) are hard along their normal, or along the joint where they can carry shear; ties cannot."""
    shears = (law.friction > 0) | (law.cohesion > 0)
    return np.asarray((law.normal_compliance == 0) | (shears & (law.tangential_compliance == 0)))


def _softer(law: Laws, area: Array, where: Array, lent: Array | float, part: Array) -> Laws:
    """Return the laws with compliance added to the hard pairs among ``where`` (m,), in proportion to 1 / area.

    ``lent`` (m,) belongs to a pair of the mean area of its ``part`` (m,); pairs without area count as such.
    """
    some = where & (area > 0)
    total, count = (np.bincount(part[some], weights=w, minlength=part.max() + 1) for w in (area[some], None))
    mean = np.where(count > 0, total / np.maximum(count, 1), 1.0)[part]
    compliance = lent * mean / np.where(area > 0, area, mean)
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
