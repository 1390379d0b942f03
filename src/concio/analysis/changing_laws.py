"""Joint laws whose constants depend on what a joint has undergone, in one load step.

The constants and the answer depend on each other: the step is solved with the constants as they are at first, the
constants are evaluated again at the answer, and so on until they stay. The answer then obeys the joint laws with the
constants that belong to it, exactly and with a certificate, and no solver depends on the law. Where the constants do
not stay, or a round has no certified answer, the result is undecided: constants of an uncertified state prove nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.problem.contact_problem import Array, ContactProblem, Laws
from concio.problem.limits_of_work import LAW_ROUNDS
from concio.problem.solution import Solution, Status, failed
from concio.problem.tolerances import CONSTANTS_STAY

OVER_AREA = ("normal_compliance", "tangential_compliance")
TIMES_AREA = ("cohesion", "tension", "cap")


@dataclass(frozen=True, eq=False)
class Undergone:
    """What k contact points of a joint law have undergone in a step.

    Parameters
    ----------
    slip : (k,) array
        Size of the slip that stays when the force goes [m].
    opening : (k,) array
        Gap [m].
    pressure : (k,) array
        Normal force over area, compression positive [kN/m2].
    shear : (k,) array
        Size of the friction force over area [kN/m2].
    """

    slip: Array
    opening: Array
    pressure: Array
    shear: Array


def points_that_change(assembly: Assembly) -> dict[str, Array]:
    """Return the pairs (k,) of each joint law whose constants depend on what the joint undergoes."""
    found = {}
    for number, name in enumerate(assembly.pairs.law_names):
        law = assembly.model.laws.get(name)
        if law is not None and law.changes:
            found[name] = np.flatnonzero((assembly.pairs.law == number) & (assembly.pairs.interface >= 0))
    return found


def solve_changing(
    assembly: Assembly, problem: ContactProblem, solve: Callable[[ContactProblem], Solution]
) -> tuple[Solution, Laws]:
    """Return the answer in which laws and answer agree, and the laws; UNDECIDED with the trace where there is none.

    Parameters
    ----------
    assembly : Assembly
        Of which the problem is.
    problem : ContactProblem
        With the constants as they are at first.
    solve : callable
    """
    first = laws = problem.laws
    points = points_that_change(assembly)
    for number in range(1, LAW_ROUNDS + 1):
        found = solve(replace(problem, laws=laws))
        if not found.solved:
            said = f"with the joint laws of round {number}: {found.status.value}"
            return _undecided(problem, found, said), laws
        asked = first
        for name, pick in points.items():
            asked = _changed(assembly, name, asked, pick, found)
        if _stay(laws, asked, first):
            return found, laws
        laws = asked
    return _undecided(problem, found, f"joint laws and answer did not agree in {LAW_ROUNDS} rounds"), laws


def _undecided(problem: ContactProblem, found: Solution, said: str) -> Solution:
    if found.status is Status.CANCELLED:
        return found
    return failed(problem, Status.UNDECIDED, method=found.method, trace=(*found.trace, said))


def _changed(assembly: Assembly, name: str, laws: Laws, pick: Array, found: Solution) -> Laws:
    """Return all laws with those of the points of one joint law as they are after an answer.

    Raises
    ------
    InputError
        A change returns something else than constants, a constant that is negative or not a number, or constants for
        another number of points.
    """
    area = assembly.pairs.area[pick]
    seen = Undergone(
        slip=np.linalg.norm(found.kinematics.slip[pick], axis=1),
        opening=found.kinematics.gap[pick],
        pressure=found.normal_force[pick] / area,
        shear=np.linalg.norm(found.friction_force[pick], axis=1) / area,
    )
    new = _times(laws[pick], 1.0 / area)
    for change in assembly.model.laws[name].changes:
        new = change(new, seen)
        if not isinstance(new, Laws):
            msg = f"joint law '{name}': a change returns {type(new).__name__} instead of the constants"
            raise InputError(msg, hint="return dataclasses.replace(law, ...)")
    for f in fields(Laws):
        value = np.asarray(getattr(new, f.name), dtype=float)
        if value.shape != pick.shape or not (value >= 0).all():
            msg = f"joint law '{name}': its changes return {f.name} of shape {value.shape} that is not zero or positive"
            raise InputError(msg, hint=f"return {pick.size} values, none negative or not a number")
    back, whole = _times(new, area), {}
    for f in fields(Laws):
        whole[f.name] = getattr(laws, f.name).copy()
        whole[f.name][pick] = getattr(back, f.name)
    return Laws(**whole)


def _times(laws: Laws, area: Array) -> Laws:
    """Return laws with strengths times an area (k,) and compliances over it."""
    strong = {name: getattr(laws, name) * area for name in TIMES_AREA}
    return replace(laws, **strong, **{name: getattr(laws, name) / area for name in OVER_AREA})


def _stay(laws: Laws, asked: Laws, first: Laws) -> bool:
    """Tell whether constants that are evaluated again are those the answer was found with."""
    for f in fields(Laws):
        old, new, unit = (getattr(law, f.name) for law in (laws, asked, first))
        finite = np.isfinite(old)
        if (finite != np.isfinite(new)).any():
            return False
        size = float(unit[np.isfinite(unit)].max(initial=0.0)) or float(new[finite].max(initial=0.0))
        if float(np.abs(new[finite] - old[finite]).max(initial=0.0)) > CONSTANTS_STAY * size:
            return False
    return True
