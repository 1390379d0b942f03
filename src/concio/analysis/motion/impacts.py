"""Steps in which something is hit: without the compliance added to hard joints, and without a gain of energy.

The compliance added to joints of rigid blocks makes their forces unique, and would make every impact softer by as much.
It is taken back here: the laws are solved with a (t - t') in place of a t, t' being the forces of the solution before.
Forces that the impulse does not decide, as those of a block on many corners, stay where they are; what the impact
returns depends on a no more.

Restitution acts along the normal, friction on the slip at the end. Where the slip turns back while what is hit is
thrown off, the two can give more energy than the impact has (T. R. Kane, D. A. Levinson, Dynamics, 1985): then less
comes back along the normal, as much as makes the works of the impact vanish. Without any restitution no impact can give
energy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.certified import Returned
from concio.analysis.motion.joint_step import JointStep
from concio.analysis.motion.scheme import Scheme
from concio.problem.tolerances import CERTIFIED
from concio.solvers.stepping.problem import StepProblem, StepSolution
from concio.solvers.stepping.solver import StepSolver

Array = np.ndarray

MOST_RETURNED = 4
"""Times at most that the compliance added to joints is taken back in an impact."""

SLOW = 0.5
"""Share of what was left of it before, above which taking it back goes on too slowly to end."""

RETURNED = 1e-10
"""Share of the velocity of an impact below which what that compliance does to it is nothing."""

HALVINGS = 12
"""Times that a restitution is halved between none and one at which the impact would give energy."""

NO_GAIN = 1e-9
"""Share of the works of an impact that is rounding."""


@dataclass(frozen=True, eq=False)
class Impact:
    """A step with an impact.

    Parameters
    ----------
    solver : StepSolver
    problem : StepProblem
        With the compliance added to joints.
    joint : JointStep
        Of its first pairs, those of contact.
    scheme : Scheme
    begun : (N,) array
        Velocities at the beginning.
    imposed : (m, d) array
        Relative velocities by bodies that are moved [m/s].
    """

    solver: StepSolver
    problem: StepProblem
    joint: JointStep
    scheme: Scheme
    begun: Array
    imposed: Array

    def answer(self, found: StepSolution, before: Returned | None = None) -> tuple[StepSolution, Returned]:
        """Return the answer of the step and what its law was.

        Parameters
        ----------
        found : StepSolution
            With the compliance of joints; or without it, the answer of nearly the same step.
        before : Returned, optional
            The law of that answer.
        """
        if before is None or before.force is None:
            found, law = self._hard(self.problem, found)
        else:
            found, law = self._again(found, before)
        if not self.scheme.restitution or found.residual > CERTIFIED or not self._gives(found):
            return found, law
        (best, law), low, high = self._returning(0.0, found), 0.0, 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            trial, back = self._returning(share, best)
            if trial.residual > CERTIFIED or self._gives(trial):
                high = share
            else:
                low, best, law = share, trial, back
        return best, replace(law, share=low)

    def _returning(self, share: float, near: StepSolution) -> tuple[StepSolution, Returned]:
        """Return the answer with a share of the restitution."""
        gap = self.problem.gap.copy()
        struck = np.flatnonzero(self.joint.struck)
        gap[struck] -= (1.0 - share) * self.scheme.restitution * self.joint.y0[struck, 0]
        p = replace(self.problem, gap=gap)
        return self._hard(p, self.solver.step(p, near.states, near.x, near.t))

    def _gives(self, found: StepSolution) -> bool:
        """Return whether the works of what is hit are a gain."""
        p, m, theta = self.problem, len(self.joint.gap), self.scheme.theta
        mean = np.append(theta * found.x + (1 - theta) * self.begun, 0.0)
        moved = np.einsum("mdw,mw->md", p.values[:m], mean[p.columns[:m]]) + self.imposed
        works = (found.t[:m] * moved)[self.joint.struck]
        return float(works.sum()) > NO_GAIN * float(np.abs(works).sum())

    def _again(self, found: StepSolution, before: Returned) -> tuple[StepSolution, Returned]:
        """Return the answer near to that of nearly the same step, whose law was ``before``.

        The compliance counts from the forces that the answer has where it then does nothing; else from those of before,
        so that what is left of it stays the same and what turns within the step converges.
        """
        p, (lent_n, lent_t) = self.problem, self._lent(self.problem)
        assert before.force is not None
        force = found.t if before.hard else before.force
        counted = _counted(p, lent_n, lent_t, force)
        if before.hard:
            again = self.solver.step(counted, found.states, found.x, found.t)
        else:
            again = self.solver.step_again(counted, found)
        if again.residual <= CERTIFIED:
            return again, Returned(1.0, force, before.hard)
        return self._hard(p, self.solver.step(p, found.states, found.x, found.t))

    def _hard(self, problem: StepProblem, found: StepSolution) -> tuple[StepSolution, Returned]:
        """Return the answer of a problem without the compliance added to joints, and its law."""
        joint, (lent_n, lent_t) = self.joint, self._lent(problem)
        enough = RETURNED * float(np.abs(joint.y0[joint.struck, 0]).max())
        before = counted = np.zeros_like(found.t)
        left = np.inf
        for _ in range(MOST_RETURNED):
            grown, last = np.abs(found.t - before), left
            left = max(float((lent_n * grown[:, 0]).max()), float((lent_t * grown[:, 1:].max(axis=1)).max()))
            if left <= enough or found.residual > CERTIFIED:
                return found, Returned(1.0, counted)
            if left > SLOW * last:
                break
            before = found.t
            again = self.solver.step_again(_counted(problem, lent_n, lent_t, before), found)
            if again.residual > CERTIFIED:
                break
            found, counted = again, before
        return found, Returned(1.0, counted, hard=False)

    def _lent(self, problem: StepProblem) -> tuple[Array, Array]:
        """Return the compliances along normal and tangent that were added to joints (pairs,)."""
        springs, m = self.joint.springs, len(self.joint.gap)
        lent_n, lent_t = problem.a_n.copy(), problem.a_t.copy()
        lent_n[m:] = lent_t[m:] = 0.0
        if springs is not None:
            lent_n[:m][springs.normal] = 0.0
            lent_t[:m][springs.shear] = 0.0
        return lent_n, lent_t


def _counted(problem: StepProblem, lent_n: Array, lent_t: Array, force: Array) -> StepProblem:
    """Return a problem in which compliances (pairs,) count from forces (pairs, d)."""
    origin = problem.origin + lent_t[:, None] * force[:, 1:]
    return replace(problem, gap=problem.gap - lent_n * force[:, 0], origin=origin)
