r"""Dilatancy homotopy: from associated flow, which is convex, to Coulomb friction, for jammed structures.

With the dilatancy :math:`d + \theta(\mu - d)` the problem at theta = 1 is a convex programme, solvable whenever forces
within the cones balance the loads. The walk keeps a point near the central path at the product ``LEVEL`` and lowers
theta in steps that grow while they succeed; from theta = 0 the interior point goes down to a solution. A turning point
in theta (the path bends back) stops the walk; the caller then tries another path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from concio.problem.limits_of_work import HOMOTOPY_ITERATIONS
from concio.solvers.interior.interior_point import InteriorPoint
from concio.solvers.interior.point import Point

LEVEL = 1e-2
"""Mean product at which the walk stays, scaled units."""


@dataclass(frozen=True)
class Walk:
    """How a homotopy ended.

    Parameters
    ----------
    theta : float
        Smallest theta reached; 0 is the problem itself.
    iterations : int
    """

    theta: float
    iterations: int


def walk(
    engine: InteriorPoint,
    *,
    watch: Callable[[int, float], bool | None] | None = None,
) -> tuple[Point, Walk]:
    """Follow the path from theta = 1 to 0.

    Parameters
    ----------
    engine : InteriorPoint
    watch : callable, optional
        See :meth:`InteriorPoint.run`.
    """
    z = engine.start()
    z, outcome = engine.run(z, theta=1.0, level=LEVEL, most=80, watch=watch)
    total = outcome.iterations
    if not outcome.converged:
        return z, Walk(1.0, total)
    theta, stride = 1.0, 0.2
    while theta > 0 and total < HOMOTOPY_ITERATIONS:
        new = max(0.0, theta - stride)
        trial, outcome = engine.run(z, theta=new, level=2 * LEVEL, most=25, watch=watch)
        total += outcome.iterations
        if outcome.converged:
            z, theta = trial, new
            stride *= 1.7 if outcome.iterations < 8 else 1.0
        else:
            stride /= 2.5
            if stride < 2e-4:
                return z, Walk(theta, total)
    return z, Walk(theta, total)
