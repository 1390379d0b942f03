r"""One load step that keeps the forces of the last state where equilibrium and friction leave them open.

Three hard pairs at a corner for two relative motions leave a self-stress undetermined, and with it which pair slips
next. Incremental analysis asks for a choice, at each step the same one. Were the pairs a little compliant there would
be none: a self-stress changes only by what the step strains, so that of all forces the step allows it takes those
nearest to the last ones. This is the limit of a vanishing compliance (Moreau's sweeping process, one implicit step),
and the choice that an exact path makes (:mod:`concio.solvers.path.equations`).

The step is therefore solved with a small compliance whose springs are relaxed under the last forces,

.. math:: y_n = x_n + C_n u + (a_n + \delta)\,t_n - \delta\,t_n^0, \qquad
          y_t = C_t u - s + (a_t + \delta)\,t_t - \delta\,t_t^0,

and the compliance is then taken out by the exact finish of the original problem, which keeps the forces near to where
it begins. delta goes with the inverse of a pair's area, so that the distance is one of tractions. Very soft springs
between the bodies and their last place settle likewise what only neutral equilibrium leaves open (a block balancing on
one point).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution, judge
from concio.problem.tolerances import RESTING
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.algebra.scales import typical_stiffness
from concio.solvers.interior import engine, newton_finish
from concio.solvers.interior.run import WEIGHTS, Run
from concio.solvers.states.settle import Settler
from concio.solvers.states.state_reading import read_states

SOFT = 1e-5
"""The compliance added to hard pairs of mean area, over the typical compliance of the bodies."""

TETHER = 1e-8
"""Stiffness of the springs that hold what nothing else holds, over the typical stiffness of the bodies."""

FLIPS = 3
"""Factorisations that trying the states of the last step may cost beyond the first."""

PATIENCE = 3
"""Newton steps in a row that such a try in space goes on without a smaller residual."""

State = tuple[Array, Array, Array]
"""Displacements (N,) [m], t_n (m,) and t_t (m, d-1) [kN]."""

NAME = "interior-point near the last forces"
"""Method of the solutions found here."""


def needed(problem: ContactProblem) -> bool:
    """Tell whether a problem has hard pairs, whose forces may not be unique."""
    law = problem.laws
    return not ((law.normal_compliance > 0) & (law.tangential_compliance > 0)).all()


def softened(problem: ContactProblem, u: Array, t_n: Array, t_t: Array) -> ContactProblem:
    """Return the problem with a small compliance, relaxed under the forces given, in its hard pairs.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        [m].
    t_n, t_t : (m,), (m,) or (m, d-1) arrays
        [kN].
    """
    law = problem.laws
    lent = SOFT / typical_stiffness(problem) / problem.area_share
    lent_n, lent_t = (np.where(a > 0, 0.0, lent) for a in (law.normal_compliance, law.tangential_compliance))
    laws = replace(
        law,
        normal_compliance=law.normal_compliance + lent_n,
        tangential_compliance=law.tangential_compliance + lent_t,
    )
    origin = problem.slip_origin + lent_t[:, None] * t_t.reshape(problem.pairs, -1)
    held = TETHER * typical_stiffness(problem)
    return replace(
        problem,
        laws=laws,
        gap=problem.gap - lent_n * t_n,
        slip_origin=origin,
        K=sp.csr_array(problem.K + held * sp.eye_array(problem.unknowns)),
        f=problem.f + held * u,
        R=sp.csc_array((problem.unknowns, 0)),  # every motion is held now
    )


class Nearby:
    """What the steps of one structure share: units, ordering, and the factors of the last one.

    The states of a point nearby are tried first. Where few of them change, which is what small steps are for, that
    takes a few updates of the factors at hand, or in space a few steps of Newton's method, instead of an iteration
    from nothing, and of several answers it is the nearest.
    """

    def __init__(self) -> None:
        self._kept: dict[str, Scaled] = {}

    def scaled(self, problem: ContactProblem, which: str = "as it is") -> Scaled:
        """Return a problem of this structure in the units of its first step; ``which`` tells stiffnesses apart."""
        kept = self._kept.get(which)
        self._kept[which] = scale(problem) if kept is None else kept.renewed(problem)
        return self._kept[which]

    def made(self, which: str = "as it is") -> int:
        """Return how many factorisations were made so far with such stiffnesses."""
        kept = self._kept.get(which)
        return 0 if kept is None else kept.factor.made

    def answer(self, problem: ContactProblem, begin: State, which: str = "as it is") -> Solution | None:
        """Return the answer of a problem whose states differ in few pairs from those of a point, if it has one.

        Parameters
        ----------
        problem : ContactProblem
        begin : arrays
            Displacements [m], t_n and t_t [kN] of the point; None is returned where all are zero.
        which : str
            See :meth:`scaled`.
        """
        if not any(part.any() for part in begin):
            return None
        made = self.made(which)
        s = self.scaled(problem, which)
        point, run = s.bring(*begin), Run(s)
        if problem.dim == 2:
            found = run.settle(*point, flips=FLIPS)
        else:
            found = run.newton(*point, WEIGHTS[:1], patience=PATIENCE)
        if found is None:
            return None
        return replace(run.solution(found, method=NAME), factorisations=s.factor.made - made)


def solve_near(
    problem: ContactProblem,
    u: Array,
    t_n: Array,
    t_t: Array,
    *,
    starts: int | None = None,
    nearby: Nearby | None = None,
    begin: State | None = None,
    progress: ProgressCallback | None = None,
) -> Solution:
    """Solve one load step, taking of all answers it allows the one near to the state given.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        Displacements of the last state [m].
    t_n, t_t : (m,), (m,) or (m, d-1) arrays
        Its forces [kN].
    starts : int, optional
        How many starts of the interior point are tried at most, in the plane.
    nearby : Nearby, optional
        What the steps before kept, where they are small: the states of a point nearby are then tried first.
    begin : arrays, optional
        Displacements, t_n and t_t of that point; default is the state given.
    progress : callable, optional

    Returns
    -------
    Solution
        Certified by the problem itself, or GAVE_UP (or CANCELLED).
    """
    plane, begin = problem.dim == 2, begin or (u, t_n, t_t)

    def one(step: ContactProblem, which: str) -> Solution:
        before = 0 if nearby is None else nearby.made(which)
        found = None if nearby is None else nearby.answer(step, begin, which)
        if found is not None:
            return found
        tried = 0 if nearby is None else nearby.made(which) - before
        found = engine.solve(step, homotopy=False, starts=starts if plane else None, progress=progress)
        return replace(found, factorisations=found.factorisations + tried)

    if not needed(problem):
        return one(problem, "as it is")
    soft = softened(problem, u, t_n, t_t)
    first = one(soft, "softened")
    if not first.solved:
        return replace(first, method=NAME)
    made = 0 if nearby is None else nearby.made()
    s = scale(problem) if nearby is None else nearby.scaled(problem)
    v, p = s.bring(first.displacement, first.normal_force, first.friction_force)
    if plane:
        found = Settler(s).settle(s, v, p, read_states(s.renewed(soft), v, p), least=False)
    else:
        found = newton_finish.finish(s, v, p, least=False)
    still = float(np.abs(found.u).max(initial=0.0)) < RESTING
    v, p_n, p_t = s.restore(found.u, found.t)
    rest = np.zeros_like(v)
    if still and certify(problem, rest, p_n, p_t).certified:
        v = rest  # nothing moves: rounding must not be measured against itself
    return judge(
        problem,
        v,
        p_n,
        p_t,
        method=NAME,
        iterations=first.iterations,
        factorisations=first.factorisations + s.factor.made - made,
        trace=(*first.trace, f"compliance taken out: {found.solves} linear solves, residual {found.error:.1e}"),
        info=first.info,
    )
