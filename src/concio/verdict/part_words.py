"""Which connected part of a structure an outcome is about, and what a regularised problem says, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from concio.problem.solution import PROVEN_FAILURES, Status
from concio.verdict.unseen import listed

if TYPE_CHECKING:
    from concio.analysis.result import Result


def parts_told(result: Result) -> tuple[str, ...]:
    """Return a sentence on the parts that decide the outcome of a structure in several parts that does not stand."""
    parts, status = result.solution.parts, result.status
    if not parts or result.solved:
        return ()
    deciding = [part for part in parts if part.status is status]
    names = tuple(result.model.bodies[int(b)].name for part in deciding for b in part.bodies)
    falls = status in PROVEN_FAILURES
    told = [f"{len(deciding)} of {len(parts)} parts that touch each other only through fixed bodies"]
    told.append(("does" if len(deciding) == 1 else "do") + (" not stand" if falls else " not end in an answer"))
    rest = [part for part in parts if part.status is not status]
    stands = all(part.status is Status.SOLVED for part in rest)
    end = "" if not rest else "; the others are in equilibrium" if stands else "; of the others not all stand either"
    return (f"This is about {listed(names)}: {' '.join(told)}{end}.",)


def regularised(result: Result) -> str:
    """Return what an exclusion of joint states is about where joints were given a compliance, else nothing."""
    if result.status is not Status.NO_COULOMB_STATE or not result.lent_compliance:
        return ""
    return (
        f"with a compliance of {result.lent_compliance:.3g} m/kN in hard joints between rigid blocks, which have no "
        "states to exclude without it"
    )
