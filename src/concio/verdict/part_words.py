"""Which connected part of a structure an outcome is about, and what a regularised problem says, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.problem.parts import connected_parts
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.problem.tolerances import CERTIFIED

if TYPE_CHECKING:
    from concio.analysis.result import Result

SEEN = 2.0
"""Loads of a body below this times the allowed residual, relative to its part, would leave no trace if unbalanced."""

NAMED = 5
"""More bodies of a part than this are counted."""


def parts_told(result: Result) -> tuple[str, ...]:
    """Return a sentence on the parts that decide the outcome of a structure in several parts that does not stand."""
    parts, status = result.solution.parts, result.status
    if not parts or result.solved:
        return ()
    deciding = [part for part in parts if part.status is status]
    names = [result.model.bodies[int(b)].name for part in deciding for b in part.bodies]
    listed = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")
    falls = status in PROVEN_FAILURES
    told = [f"{len(deciding)} of {len(parts)} parts that touch each other only through fixed bodies"]
    told.append(("does" if len(deciding) == 1 else "do") + (" not stand" if falls else " not end in an answer"))
    rest = [part for part in parts if part.status is not status]
    stands = all(part.status is Status.SOLVED for part in rest)
    end = "" if not rest else "; the others are in equilibrium" if stands else "; of the others not all stand either"
    return (f"This is about {listed}: {' '.join(told)}{end}.",)


def unresolved(result: Result) -> tuple[str, ...]:
    """Return a sentence on bodies whose loads are too small beside those of their part for the certificate to see."""
    if not result.solved:
        return ()
    problem = result.assembly.problem(result.factors)
    loads = problem.applied if isinstance(problem.applied, np.ndarray) else problem.f
    parts, sizes = connected_parts(problem), np.diff(problem.bodies)
    total = parts.total(parts.of_unknown, np.abs(loads))
    body = np.repeat(np.arange(sizes.size), sizes)
    own = np.bincount(body, weights=np.abs(loads), minlength=sizes.size)
    beside = np.zeros(sizes.size)
    beside[body] = total[parts.of_unknown]
    names = [result.model.bodies[int(b)].name for b in np.flatnonzero((own > 0) & (own < SEEN * CERTIFIED * beside))]
    if not names:
        return ()
    listed = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")
    return (
        f"whether {listed} {'is' if len(names) == 1 else 'are'} held: the loads there are less than "
        f"{SEEN * CERTIFIED:.0e} of those of the structure around, which is as far as residuals tell",
    )


def regularised(result: Result) -> str:
    """Return what an exclusion of joint states is about where joints were lent a compliance, else nothing."""
    if result.status is not Status.NO_COULOMB_STATE or not result.lent_compliance:
        return ""
    return (
        f"with a compliance of {result.lent_compliance:.3g} m/kN in hard joints between rigid blocks, which have no "
        "states to exclude without it"
    )
