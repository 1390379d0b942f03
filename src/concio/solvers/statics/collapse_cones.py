r"""Forces of round cones that go with a motion: collapse states of structures in space.

A pair that slips along the unit direction d carries :math:`t_t = -(c + \mu t_n)\,d`: one unknown force t_n >= 0 along
n - mu d, beside a constant. A pair that opens or crushes has its normal force, and friction on a disc. All others keep
their cone. What is left is a cone programme in fewer forces; it minimises the multiplier, as the linear programme of
the plane does.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import CHECKED, FRICTION_ROOM
from concio.solvers.statics.cone_statics import ConeStatics

NONE = -1e4
"""Multiplier, in units of the programme, below which a bound tells that no forces go with a motion: bounds of states
that exist end at their multipliers, of the order of one; where there are none they fall below this in a few iterations,
while the programme would look for forces twice as long as where it finds them."""


class Asked(Protocol):
    """What a motion asks of the pairs."""

    @property
    def opens(self) -> Array:
        """Pairs that open (m,)."""

    @property
    def slips(self) -> Array:
        """Pairs that slip (m,)."""

    @property
    def crushes(self) -> Array:
        """Pairs that crush (m,)."""

    @property
    def direction(self) -> Array:
        """Unit slips (m, d-1)."""


def forces_in_space(problem: ContactProblem, motion: Asked, live: Array) -> tuple[float, Array, Array] | None:
    """Return the least multiplier with forces t_n (m,), t_t (m, d-1) [kN] that a motion asks for; None if none are.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    motion : Motion
    live : (N,) array
    """
    m, s = problem.pairs, problem.dim - 1
    cone, laws = problem.cone, problem.laws
    known = motion.opens | motion.crushes
    normal = np.where(motion.crushes, np.where(cone.capped, cone.cap, 0.0), -cone.tension)
    disc = np.where(motion.crushes, cone.strength(np.where(known, normal, 0.0)), cone.spare)
    slides = motion.slips & ~known
    stays = ~known | (~motion.slips & (disc > 0))
    # what does not depend on unknown forces
    force = max(float(np.abs(problem.f).sum()), float(np.abs(live).sum()))
    t_n = np.where(known, normal, 0.0)
    t_t = -np.where(motion.slips, np.where(known, disc, cone.cohesion), 0.0)[:, None] * motion.direction
    fixed = problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel()
    # unknown forces: of pairs that slip along n - mu d, of pairs whose normal force is known on a disc
    rows = np.repeat(np.arange(m), s)
    along = np.where(slides, cone.friction, 0.0)[:, None] * motion.direction
    D = sp.csr_array((along.ravel(), (rows, np.arange(m * s))), shape=(m, m * s))
    C_n = sp.diags_array((~known).astype(float)) @ (problem.C_n - D @ problem.C_t)
    C_t = sp.diags_array(np.repeat((~(motion.slips & known)).astype(float), s)) @ problem.C_t
    smooth = slides | known
    changed = replace(
        laws, friction=np.where(smooth, 0.0, laws.friction), dilatancy=np.zeros(m),
        cohesion=np.where(known, disc, np.where(slides, FRICTION_ROOM * force, laws.cohesion)),
        tension=np.where(known, 0.0, laws.tension), cap=np.where(known, 1.0, laws.cap),
    )  # fmt: skip
    less = replace(
        problem, f=problem.f + fixed, C_n=sp.csr_array(sp.csr_array(C_n)[stays]),
        C_t=sp.csr_array(sp.csr_array(C_t)[np.repeat(stays, s)]), laws=changed[stays], gap=problem.gap[stays],
        slip_origin=problem.slip_origin[stays], area=problem.area[stays],
    )  # fmt: skip
    if not less.pairs:
        return None
    found = ConeStatics(less, problem.f if problem.f.any() else live).largest(-live, NONE)
    if not (np.isfinite(found.multiplier) and found.residual <= CHECKED):
        return None
    t_n[stays] += np.where(known[stays], 0.0, found.t[:, 0])
    t_t[stays] += found.t[:, 1:]
    t_t -= np.where(slides, cone.friction * t_n, 0.0)[:, None] * motion.direction
    return -found.multiplier, t_n, t_t
