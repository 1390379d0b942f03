r"""Interior point for the second-order cone programmes of statics, on the graph of the blocks.

The largest multiplier of a load under which forces inside the cones are in balance,

.. math:: \max \lambda, \qquad C^T t + e + \lambda g = 0, \qquad
          t_n \ge 0,\ t_n \le N,\ \beta = (c + \mu t_n, t_t) \in Q,

and its dual, the motion v of least :math:`h(Cv) - e^T v` with g'v = 1. C holds the velocities of the pairs in rigid
motions of the blocks, d rows for each pair. With slacks s = G t + h in a product of half-lines and second-order cones,
multipliers z in the same and the scaling of Nesterov and Todd, Mehrotra's predictor and corrector leave in each step

.. math:: \begin{bmatrix} C^T D C & -g \\ g^T & 0 \end{bmatrix}, \qquad D = (G^T M G)^{-1},

D with a small dense block for each pair, symmetric, of the pattern of the blocks' graph, ordered once. The multipliers
of an iterate lie strictly inside their cones, so the motion is admissible to rounding as soon as Cv = G'z holds; what
forces and motion prove is for the caller to recompute from the original data.

Degenerate structures, where M spans twenty powers of ten, decide how it must be computed. The roots F of D come from
the scaling itself, never from inverting M, and forces are unknown as F dx. The change of the multipliers is read from
the motion, G'dz = C dv + residual, whose rounding is small, not from M d beta, which cancels: without this the gap
stops at 1e-6 to 1e-8, with it at 1e-12. Where friction is exhausted in all joints at once, C'DC is worse than 1e16:
then the system in dx and dv is solved as a whole, with pivoting.

Reference: Alizadeh and Goldfarb, Second-order cone programming, Math. Programming 95 (2003), 3-51.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import CONE_ITERATIONS
from concio.problem.tolerances import CONE_TARGET
from concio.solvers.statics.cone_programme import ConeProgramme
from concio.solvers.statics.cone_step import Step

PATIENCE = 15
"""Iterations without progress after which the best point met is returned."""


@dataclass(frozen=True, eq=False)
class ConeAnswer:
    """A point of the programme.

    Parameters
    ----------
    t : (m, d) array
        Shifted forces.
    multiplier : float
    v : (r,) array
        Motion.
    primal, dual, gap : float
        Largest residual of balance, of Cv = G'z and g'v = 1, and the relative duality gap.
    iterations : int
    bound : float
        Multiplier beyond which the motion, once admissible, lets none be; falls without bound where no forces exist.
    """

    t: Array
    multiplier: float
    v: Array
    primal: float
    dual: float
    gap: float
    iterations: int
    bound: float = np.inf


def maximise(
    programme: ConeProgramme,
    e: Array,
    g: Array,
    *,
    start: Array | None = None,
    stop: Callable[[ConeAnswer], bool] | None = None,
    target: float = CONE_TARGET,
) -> ConeAnswer:
    """Maximise the multiplier of g beside e, (r,) both, scaled so that the larger has entries of about one.

    Parameters
    ----------
    programme : ConeProgramme
    e, g : (r,) arrays
    start : (m, d) array, optional
        Initial forces, strictly inside the cones.
    stop : callable, optional
        Looks at each iterate; true ends the iteration.
    target : float
        Residuals and relative gap at which it ends.
    """
    p = programme.start()
    programme.degenerate = False
    if start is not None:
        p.t = start.copy()
    best: ConeAnswer | None = None
    since, iteration, least = 0, 0, np.inf
    with np.errstate(all="ignore"):
        for iteration in range(CONE_ITERATIONS + 1):
            r_p = programme.pull(p.t) + e + p.multiplier * g
            r_d = programme.rate(p.v) - programme.pressed(p.z, p.eta, p.w)
            if not programme.all_rough:
                r_d[~programme.rough, 1:] = 0.0
            r_g = 1.0 - float(g @ p.v)
            gap = programme.gap(p)
            force, speed = max(1.0, float(p.t[:, 0].max())), max(1.0, float(np.abs(p.v).max()))
            primal = float(np.abs(r_p).max(initial=0.0)) / force
            dual = max(float(np.abs(r_d).max(initial=0.0)) / speed, abs(r_g))
            relative = gap / max(1.0, abs(p.multiplier))
            worst = max(primal, dual, relative)
            if not np.isfinite(worst):
                break
            since = 0 if worst < 0.9 * least else since + 1
            bound = p.multiplier + gap - float(r_p @ p.v)
            now = ConeAnswer(p.t, p.multiplier, p.v, primal, dual, relative, iteration, bound)
            if worst < least:
                least, best = worst, now
            if stop is not None and stop(now):
                return now
            if worst < target or since > PATIENCE or iteration == CONE_ITERATIONS:
                break
            step = Step.at(programme, p, g, r_p, r_d, r_g)
            following = None if step is None else step.mehrotra(gap)
            if following is None:
                break
            p = following
    found = best or ConeAnswer(p.t, p.multiplier, p.v, np.inf, np.inf, np.inf, 0)
    return replace(found, iterations=iteration)
