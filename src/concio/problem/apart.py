"""Connected parts of a structure, solved one by one and put together into one answer.

What touches only through fixed bodies is solved as if it stood alone: same units, same arithmetic, same digits. The
whole is in equilibrium where every part is, it collapses where one does, with that part's mechanism or motion and none
elsewhere, and its certificate is the worst of the parts', each in its own units.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from concio.problem.certificate import Certificate, Kinematics
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Part, parts_of
from concio.problem.solution import Departure, Mechanism, PartOutcome, Solution, Status, judge

WORST_FIRST = (
    Status.NO_EQUILIBRIUM,
    Status.COLLAPSES,
    Status.NO_COULOMB_STATE,
    Status.CANCELLED,
    Status.GAVE_UP,
    Status.UNDECIDED,
    Status.SOLVED,
)
"""The status of the whole is the first of these that a part has: what is proven of a part is proven of the whole."""


def solve_apart(problem: ContactProblem, solve: Callable[[Part], Solution]) -> Solution:
    """Solve each connected part of a problem and return the answer of the whole.

    Parameters
    ----------
    problem : ContactProblem
    solve : callable
        Solves one part.

    Returns
    -------
    Solution
        That of the only part as it is; of several, :attr:`Solution.parts` says what became of each.
    """
    parts = parts_of(problem)
    if len(parts) == 1:
        return solve(parts[0])
    found: list[Solution] = []
    for part in parts:
        found.append(solve(part))
        if found[-1].status is Status.CANCELLED:
            break
    return merged(problem, parts[: len(found)], found)


def merged(problem: ContactProblem, parts: Sequence[Part], found: Sequence[Solution]) -> Solution:
    """Return the answer of the whole of the answers of its parts; zero where a part has none yet."""
    status = min((one.status for one in found), key=WORST_FIRST.index)
    decisive = max((k for k, one in enumerate(found) if one.status is status), key=lambda k: parts[k].problem.pairs)
    m, s = problem.pairs, problem.dim - 1
    u, t_n, t_t = np.zeros(problem.unknowns), np.zeros(m), np.zeros((m, s))
    gap, slip, crushing = np.zeros(m), np.zeros((m, s)), np.zeros(m)
    for part, one in zip(parts, found, strict=True):
        u[part.unknowns], t_n[part.pairs], t_t[part.pairs] = one.displacement, one.normal_force, one.friction_force
        kin = one.kinematics
        gap[part.pairs], slip[part.pairs], crushing[part.pairs] = kin.gap, kin.slip, kin.crushing
    return Solution(
        status, u, t_n, t_t, Kinematics(gap, slip, crushing),
        worst_of([one.certificate for one in found]),
        found[decisive].method,
        sum(one.iterations for one in found),
        sum(one.factorisations for one in found),
        _mechanism(problem, parts, found, status),
        _departure(problem, parts, found, status),
        tuple(f"part {k + 1} of {len(parts)}: {line}" for k, one in enumerate(found) for line in one.trace),
        _info(found, decisive),
        tuple(
            PartOutcome(part.bodies, part.pairs, one.status, one.certificate, one.method)
            for part, one in zip(parts, found, strict=True)
        ),
    )  # fmt: skip


def restricted(part: Part, answer: Solution) -> Solution:
    """Return what an answer of the whole says of one part, judged in its units."""
    u, t_n, t_t = own(part, answer.displacement, answer.normal_force, answer.friction_force)
    told = next((one for one in answer.parts if np.array_equal(one.pairs, part.pairs)), None)
    method = answer.method if told is None else told.method
    return judge(part.problem, u, t_n, t_t, method=method)


def worst_of(certificates: Sequence[Certificate]) -> Certificate:
    """Return the certificate whose entries are the worst of several."""
    entries = np.array([list(one.as_dict().values())[:5] for one in certificates])
    return Certificate(*(float(v) for v in np.where(np.isfinite(entries), entries, np.inf).max(axis=0)))


def _mechanism(
    problem: ContactProblem, parts: Sequence[Part], found: Sequence[Solution], status: Status
) -> Mechanism | None:
    """Return the mechanisms of the parts with the status of the whole as one motion, zero elsewhere."""
    velocity, power, violation, any_moves = np.zeros(problem.unknowns), 0.0, 0.0, False
    for part, one in zip(parts, found, strict=True):
        if one.mechanism is not None and one.status is status:
            any_moves = True
            velocity[part.unknowns] = one.mechanism.velocity
            power += one.mechanism.power
            violation = max(violation, one.mechanism.violation)
    return Mechanism(velocity, power, violation) if any_moves else None


def _departure(
    problem: ContactProblem, parts: Sequence[Part], found: Sequence[Solution], status: Status
) -> Departure | None:
    """Return the motions of the parts that move away, and the rest of those in equilibrium."""
    leaving = [one.departure for one in found if one.departure is not None]
    if status is not Status.COLLAPSES or not leaving:
        return None
    m = problem.pairs
    a, u = np.zeros(problem.unknowns), np.zeros(problem.unknowns)
    t_n, t_t = np.zeros(m), np.zeros((m, problem.dim - 1))
    for part, one in zip(parts, found, strict=True):
        state = one if one.departure is None else one.departure
        u[part.unknowns], t_n[part.pairs], t_t[part.pairs] = (
            state.displacement,
            state.normal_force,
            state.friction_force,
        )
        if one.departure is not None:
            a[part.unknowns] = one.departure.acceleration
    return Departure(
        a, problem.inertia, u, t_n, t_t,
        min(one.power for one in leaving),
        max(one.violation for one in leaving),
    )  # fmt: skip


def _info(found: Sequence[Solution], decisive: int) -> dict[str, Any]:
    """Return the numbers of the decisive part, with those that count what was done added up over all parts."""
    info = dict(found[decisive].info)
    for name, value in info.items():
        others = [one.info.get(name) for one in found]
        if type(value) is int and all(type(other) is int for other in others):
            info[name] = sum(others)
    costs = [cost for one in found for cost in one.info.get("cost", ())]
    if costs:
        info["cost"] = tuple(costs)
    return info


def own(part: Part, *arrays: Array) -> tuple[Array, ...]:
    """Return what belongs to a part of arrays u (N,), t_n (m,), t_t (m, d-1) of the whole."""
    u, t_n, t_t = arrays
    return u[part.unknowns], t_n[part.pairs], t_t[part.pairs]
