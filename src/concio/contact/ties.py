"""Tie rods: bars that take tension only, as pairs whose gap closes when the bar is stretched.

A bar of stiffness k and prestress T0 between points a and b carries ``T = max(0, T0 + k e)`` with the elongation e. As
a pair: C_n u = -e, compliance 1/k, initial gap -T0/k, so ``0 <= y_n = -T0/k - e + T/k _|_ T >= 0``. It has no friction.
A bar that yields is a pair with a cap, and so is one that breaks: it never carries more than as it breaks. Soil is the
same with e the shortening: it presses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.arguments import closest
from concio.contact.attachments import Ties
from concio.contact.pairs import CONTACT_MODELS, Pairs
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.fem.discretisation import FIXED, Discretisation
from concio.kinematics.frames import tangents
from concio.kinematics.spins import SpinAxes
from concio.model.model import Tie
from concio.problem.contact_problem import Laws

Array = np.ndarray


def add_ties(reference: Reference, pairs: Pairs, laws: Laws) -> tuple[Pairs, Laws]:
    """Return the pairs and laws with one more pair for each tie of the model (interface -1).

    Raises
    ------
    InputError
        A tie has no length, no stiffness, or an end that lies on no body.
    """
    disc, ties = reference.disc, reference.model.ties
    if not ties:
        return pairs, laws
    n, ends = len(ties), _ends(disc, ties)
    bars, here = _along_world_axes(Ties.of(reference), disc), reference.at_rest()
    span, length = bars.span(here.placement, here.strain)
    normals = -(bars.sign / length)[:, None] * span  # the force of a bar on b points back to a
    rows, _, _, _ = bars.rows(here.placement, here.strain)
    moves = bars.columns < disc.unknowns
    entries = rows[:, 0][moves], (np.nonzero(moves)[0], bars.columns[moves])
    C_n = sp.csr_array(entries, shape=(n, disc.unknowns))  # minus the elongations
    stiffness, prestress = bars.stiffness, bars.prestress
    zero, one = np.zeros(n), np.ones(n)
    joined = replace(
        pairs,
        body_a=np.concatenate([pairs.body_a, ends[:, 0]]),
        body_b=np.concatenate([pairs.body_b, ends[:, 1]]),
        interface=np.concatenate([pairs.interface, np.full(n, -1)]),
        point=np.vstack([pairs.point, [(np.array(t.at_a) + np.array(t.at_b)) / 2 for t in ties]]),
        normal=np.vstack([pairs.normal, normals]),
        tangents=np.concatenate([pairs.tangents, tangents(normals)]),
        length=np.concatenate([pairs.length, zero]),
        area=np.concatenate([pairs.area, one]),
        gap=np.concatenate([pairs.gap, -prestress / stiffness]),
        law=np.concatenate([pairs.law, np.full(n, -1)]),
        C_n=sp.csr_array(sp.vstack([pairs.C_n, C_n])),
        C_t=sp.csr_array(sp.vstack([pairs.C_t, sp.csr_array((n * (disc.dim - 1), disc.unknowns))])),
        rule=np.concatenate([pairs.rule, np.full(n, CONTACT_MODELS.index("tie"))]),
    )
    tie_laws = Laws(zero, zero, zero, zero, 1.0 / stiffness, zero, np.array([t.strength for t in ties]))
    names = Laws.__dataclass_fields__
    return joined, Laws(*(np.concatenate([getattr(laws, name), getattr(tie_laws, name)]) for name in names))


def _along_world_axes(bars: Ties, disc: Discretisation) -> Ties:
    """Return ties whose rows turn bodies about the axes of the model, as statics does, not about their principal axes.

    Principal axes come in the order of their moments: about them the moment of a tie stood at another axis.
    """
    if disc.dim == 2:
        return bars
    axes = SpinAxes(np.tile(np.eye(3), (len(disc.model.bodies), 1, 1)))
    return replace(bars, a=replace(bars.a, axes=axes), b=replace(bars.b, axes=axes))


def _ends(disc: Discretisation, ties: Sequence[Tie]) -> Array:
    """Return the bodies at both ends (t, 2) of ties, all checked; -1 for a fixed point."""
    number = {b.name: i for i, b in enumerate(disc.model.bodies)}
    ends = np.zeros((len(ties), 2), dtype=int)
    for k, tie in enumerate(ties):
        where = f"tie '{tie.name}'"
        _check(tie, where)
        for side, name in enumerate((tie.body_a, tie.body_b)):
            if name and name not in number:
                msg = f"there is no body called '{name}'"
                hint = closest(name, number, otherwise="leave body_b empty for a fixed point")
                raise InputError(msg, where=where, hint=hint)
            ends[k, side] = number.get(name, -1)
        if all(e < 0 or disc.shape_of[e] == FIXED for e in ends[k]):
            msg = "neither end is fastened to a block that can move"
            raise InputError(msg, where=where, hint="name a block at one end at least")
    return ends


def _check(tie: Tie, where: str) -> None:
    """Raise InputError where a tie has no length, pulls on one block alone, or has numbers that cannot be."""
    if not float(np.linalg.norm(np.array(tie.at_b, dtype=float) - np.array(tie.at_a, dtype=float))) > 0:
        msg = "its ends coincide"
        raise InputError(msg, where=where, hint="give two different points")
    if tie.body_a == tie.body_b != "":
        msg = f"both of its ends are on '{tie.body_a}'"
        raise InputError(msg, where=where, hint="a bar within one block pulls on nothing else: name two bodies")
    if not (0 < tie.stiffness < np.inf) or not (0 <= tie.prestress < np.inf):
        msg = f"stiffness {tie.stiffness:g} must be positive and prestress {tie.prestress:g} not negative"
        raise InputError(msg, where=where)
    if not tie.prestress <= tie.most or not tie.most > 0:
        msg = f"yield_force {tie.most:g} must be positive and not below the prestress {tie.prestress:g}"
        raise InputError(msg, where=where, hint="both in kN; leave yield_force out for a bar that never yields")
    if tie.break_elongation is not None and not 0 < tie.break_elongation < np.inf:
        msg = f"break_elongation {tie.break_elongation:g} must be positive"
        raise InputError(msg, where=where, hint="in m; leave it out for a bar that never breaks")
