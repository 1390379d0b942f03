"""From a dense complementarity form to a judged solution: Lemke's method, states read off, and the exact finish."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import Normal
from concio.problem.solution import Progress, ProgressCallback, Solution, Status, failed, judge, pair_states
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.lcp.lemke_method import LemkeResult, Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.methods.forms.condensation import condense
from concio.solvers.methods.forms.force_method import force_method
from concio.solvers.methods.forms.forms import MixedForm
from concio.solvers.methods.forms.split_motions import join, split
from concio.solvers.pivoting import sparse_lemke
from concio.solvers.pivoting.lemke_outcome import no_solution
from concio.solvers.pivoting.state_solution import finish

Back = Callable[[LemkeResult], "tuple[Array, Array, Array | None]"]

EXACT_ENOUGH = 1e-12
"""An answer less exact than this is finished by pivoting on the sparse form."""

ROUGH = 1e-6
"""An answer less exact than this is not worth it."""

Elimination = Literal["condensation", "force-method", "split"]


@dataclass
class DenseRun:
    """Runs of Lemke's method on forms of one problem, and what they cost.

    Parameters
    ----------
    method : str
        Name of the method that runs.
    progress : callable, optional
    limit : int, optional
        Largest number of pivots of a run.
    """

    method: str
    progress: ProgressCallback | None = None
    limit: int | None = None
    pivots: int = 0
    factorisations: int = 0
    trace: list[str] = field(default_factory=list)
    info: dict[str, Any] = field(default_factory=dict)
    velocity: Array | None = None
    ray: bool = False

    def attempt(self, form: MixedForm, elimination: Elimination, **options: Any) -> Solution | None:
        """Solve ``form`` with its rigid motions treated by ``elimination``; None where that gave no solution.

        Two covers are tried: the one under which friction does no work along a ray, and ones after scaling.
        """
        lcp, back, details = _standard(form, elimination, **options)
        self.info.update(
            form=form.name, elimination=elimination, unknowns=lcp.size, rigid_motions=form.motions, **details
        )
        for cover in (np.concatenate([form.cover(), np.ones(lcp.size - form.size)]), None):
            solution = self._run(form, elimination, lcp, back, cover)
            if solution is not None:
                return solution
        return None

    def _run(
        self, form: MixedForm, elimination: Elimination, lcp: LinearComplementarity, back: Back, cover: Array | None
    ) -> Solution | None:
        result = lemke(lcp, cover=cover, limit=self.limit, progress=self._tell if self.progress else None)
        self.pivots += result.pivots
        self.factorisations += result.factorisations
        self.info["pivots"] = self.pivots
        self.trace.append(
            f"{form.name} form, {elimination}: {result.outcome.value} after {result.pivots} pivots "
            f"({lcp.size} unknowns)."
        )
        if result.outcome is Outcome.CANCELLED:
            return failed(form.reduction.system.problem, Status.CANCELLED, method=self.method, **self.extra())
        if result.outcome is Outcome.RAY:
            self.ray = True
            self.velocity = self._ray_velocity(form, elimination, result)
            return None
        if result.outcome is not Outcome.SOLVED:
            return None
        z, w, alpha = back(result)
        solution = self._judge(form, z, w, alpha)
        if not solution.solved:
            self.trace.append(f"the answer is exact only to {solution.certificate.worst:.1e}.")
        return solution

    def extra(self) -> dict[str, Any]:
        """Return the fields of a solution that tell the work done."""
        return {
            "iterations": self.pivots,
            "factorisations": self.factorisations,
            "trace": tuple(self.trace),
            "info": dict(self.info),
        }

    def give_up(self, form: MixedForm) -> Solution:
        """Return the solution that says no answer was found, with a mechanism where there is one."""
        return no_solution(
            form.reduction.system.problem, self.method, velocity=self.velocity, ray=self.ray, **self.extra()
        )

    def _tell(self, progress: Progress) -> bool | None:
        assert self.progress is not None
        return self.progress(Progress(self.method, progress.iteration, progress.residual, progress.message))

    def _judge(self, form: MixedForm, z: Array, w: Array, alpha: Array | None) -> Solution:
        """Judge the forces as they come, and the exact solution of the states they show; return the better."""
        reduction = form.reduction
        t, y = form.forces(z), form.components(z, w)
        if alpha is None:
            alpha = reduction.best_motion(t, y[: reduction.F.shape[0]])
        problem = reduction.system.problem
        t_n, t_t = reduction.forces(t)
        plain = judge(problem, reduction.displacement(t, alpha), t_n, t_t, method=self.method, **self.extra())
        normal, sign = read_states(form, z, w)
        try:
            exact = finish(reduction.system, normal, sign, method=self.method, **self.extra())
        except SingularMatrixError:
            exact = plain
        best = exact if exact.certificate.worst <= plain.certificate.worst else plain
        if best.certificate.worst > EXACT_ENOUGH and best.certificate.worst < ROUGH:
            best = self._cross_over(problem, best)
        return best

    def _cross_over(self, problem: ContactProblem, near: Solution) -> Solution:
        """Finish an answer that is nearly right by pivoting from its states; return the better of the two."""
        start = near.displacement, near.normal_force, near.friction_force
        states = pair_states(problem, near, ROUGH)
        exact = sparse_lemke.solve(problem, start_states=states, start=start, tries=0)
        if exact.certificate.worst >= near.certificate.worst:
            return near
        self.trace.append(f"finished exactly by {exact.iterations} pivots on the states of the pairs.")
        return replace(exact, method=self.method, **self.extra())

    @staticmethod
    def _ray_velocity(form: MixedForm, elimination: str, result: LemkeResult) -> Array | None:
        """Return the rigid motion of a ray of the split form, (N,)."""
        if elimination != "split" or result.ray is None or not form.motions:
            return None
        _, alpha = join(form, result.ray.dz)
        size = float(np.abs(alpha).max(initial=0.0))
        if size <= 0.0:
            return None
        velocity: Array = form.reduction.system.problem.R @ (alpha / size)
        return velocity


def read_states(form: MixedForm, z: Array, w: Array) -> tuple[Array, Array]:
    """Return normal codes (m,) and signs of slip (m,) of a complementary solution."""
    reduction = form.reduction
    m, k, system = reduction.pairs, reduction.rough.size, reduction.system
    normal = np.where(w[:m] > z[:m], Normal.OPEN, Normal.CLOSED)
    sign = np.where(system.frictionless, 1, 0)
    if form.name == "normal" or not k:
        return normal, np.full(m, 1)
    if form.name == "3m":
        plus, minus = w[m : m + k] > z[m : m + k], z[m + k :] > w[m + k :]
    else:
        slips = z[m + 2 * k :] > w[m + 2 * k :]
        forward = w[m : m + k] >= w[m + k : m + 2 * k]
        plus, minus = slips & forward, slips & ~forward
    side = np.where(plus, 1, np.where(minus, -1, 0))
    y_t = form.components(z, w)[m:]
    loose = (normal[reduction.rough] == Normal.OPEN) & system.weak[reduction.rough]
    side = np.where(loose, np.where(y_t < 0, -1, 1), side)
    sign[reduction.rough] = side
    return normal, sign


def _standard(
    form: MixedForm, elimination: Elimination, **options: Any
) -> tuple[LinearComplementarity, Back, dict[str, Any]]:
    """Return the standard problem, what maps its answer back to (z, w, alpha), and numbers worth keeping."""
    if elimination == "condensation":
        return condense(form), lambda r: (r.z, r.w, np.zeros(0)), {}
    if elimination == "split":
        n = form.size

        def unsplit(result: LemkeResult) -> tuple[Array, Array, Array | None]:
            z, alpha = join(form, result.z)
            return z, result.w[:n], alpha

        return split(form), unsplit, {}
    chosen = force_method(form, **options)
    lcp, back = chosen.standard()
    details = {"condition": chosen.condition, "normal_only": chosen.normal_only}
    return lcp, lambda r: (*back(r.z, r.w), None), details
