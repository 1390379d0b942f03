r"""The least strengthening that brings an associated multiplier to a target: a tie, grout in joints, a load on top.

The yield force of a tie, the cohesion of joints and the factor of a load group are right-hand sides of the limit
programme, of which the multiplier is a concave function of them. Every mechanism that was met gives a line above it,

.. math:: \lambda(p) \le \lambda_i + b_i\,(p - p_i) \quad\text{for every } p,

b_i being the work of the mechanism on one more unit of p. Where the line of the last one meets the target
is the next p to be tried; it never exceeds the least one, and where the forces of the programme reach the target there,
the two coincide. In the plane the function has finitely many pieces, so that the search ends.

Source: J. E. Kelley, The cutting-plane method, J. SIAM 8 (1960), for one variable Newton's method.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from concio.analysis.tie_places import tie_at_height
from concio.arguments import closest
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError, SolverError
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit

Array = np.ndarray
Kind = Literal["tie", "cohesion", "load"]

MET = 1e-11
"""A multiplier that is short of the target by less, relative, has reached it."""

MOST_LINES = 80
"""Programmes at most."""


@dataclass(frozen=True)
class LeastStrengthening:
    """The least strengthening for a target.

    Parameters
    ----------
    kind : {"tie", "cohesion", "load"}
    of : str
        Tie, joint law or load group.
    target : float
        Multiplier that was asked for.
    amount : float
        Yield force [kN], cohesion [kN/m2] or factor of the load; ``inf`` where no amount does.
    least : float
        No smaller amount reaches the target: the mechanisms that were met prove it.
    reached : float
        Multiplier with that amount, from forces in equilibrium.
    before : float
        Multiplier without any.
    programmes : int
    height : float
        Of a tie that was looked for at several heights, the one at which it needs least [m]; else ``nan``.
    by_height : mapping of float to float
        The least force at each of these heights [kN]; ``inf`` where no force does.
    """

    kind: Kind
    of: str
    target: float
    amount: float
    least: float
    reached: float
    before: float
    programmes: int
    height: float = math.nan
    by_height: Mapping[float, float] = field(default_factory=dict)


def least_strengthening(
    assembly: Assembly, groups: Sequence[str], target: float, kind: Kind, of: str
) -> LeastStrengthening:
    """Return the least amount of a strengthening that brings the associated multiplier to a target.

    Parameters
    ----------
    assembly : Assembly
    groups : sequence of str
        Load groups that are multiplied.
    target : float
    kind : {"tie", "cohesion", "load"}
    of : str
        Name of the tie, the joint law or the load group.

    Raises
    ------
    InputError
        There is no such tie, law or group.
    SolverError
        The search did not end.
    """
    problem, slope = _amounts(assembly, groups, kind, of)
    dead = assembly.problem(dict.fromkeys(groups, 0.0))
    live = assembly.problem(dict.fromkeys(groups, 1.0), like=dead).f - dead.f
    p, before, tried = 0.0, math.nan, 0
    for tried in range(1, MOST_LINES + 1):
        found = associated_limit(problem(p), live)
        value = -math.inf if math.isnan(found.multiplier) else found.multiplier
        before = value if tried == 1 else before
        if value >= target - MET * max(abs(target), 1e-3):
            return LeastStrengthening(kind, of, target, p, p, value, before, tried)
        rate, bound = _line(found, live, slope)
        if rate <= 0.0:
            return LeastStrengthening(kind, of, target, math.inf, math.inf, value, before, tried)
        further = p + (target - bound) / rate
        if further <= p * (1 + 1e-13):  # rounding
            return LeastStrengthening(kind, of, target, p, p, value, before, tried)
        p = further
    msg = f"the least {kind} '{of}' was not found within {MOST_LINES} programmes"
    raise SolverError(msg, hint="try another target")


def least_by_height(
    assembly: Assembly, groups: Sequence[str], target: float, tie: str, heights: Sequence[float]
) -> LeastStrengthening:
    """Return the least force of a tie over several heights, each with its proof; the first of those that need the same.

    Raises
    ------
    InputError, SolverError
        As :func:`least_strengthening`; or the tie meets no body at a height.
    """
    if not heights:
        msg = "there is no height at which the tie could be"
        raise InputError(msg, hint="for example heights=[2.5, 5.0]")
    found = {}
    for height in dict.fromkeys(float(h) for h in heights):
        moved = assemble(tie_at_height(assembly.model, tie, height))
        found[height] = least_strengthening(moved, groups, target, "tie", tie)
    best = min(found, key=lambda h: found[h].amount)
    return replace(found[best], height=best, by_height={h: one.amount for h, one in found.items()})


def _line(found: LimitLoad, live: Array, slope: Callable[[Array], float]) -> tuple[float, float]:
    """Return by how much a unit more raises the bound of a mechanism, and that bound.

    Raises
    ------
    InputError
        There is no mechanism: the loads that are not multiplied are not balanced without the strengthening.
    """
    if found.mechanism is None:
        msg = "without the strengthening the constant loads are not balanced: no multiplier exists"
        raise InputError(msg, hint="give the model a strengthening with which it stands, and search from there by hand")
    v = found.mechanism.velocity / float(live @ found.mechanism.velocity)
    return slope(v), found.upper


def _amounts(
    assembly: Assembly, groups: Sequence[str], kind: Kind, of: str
) -> tuple[Callable[[float], ContactProblem], Callable[[Array], float]]:
    """Return the problem with an amount of a strengthening, and the work of a motion (N,) on a unit of it."""
    zero = dict.fromkeys(groups, 0.0)
    dead, pairs, ties = assembly.problem(zero), assembly.pairs, [t.name for t in assembly.model.ties]
    laws, loads = dead.laws, [g for g in assembly.groups if g not in groups]
    known = {"tie": ties, "cohesion": list(pairs.law_names), "load": loads}[kind]
    if of not in known:
        msg = f"there is no {kind} '{of}'"
        raise InputError(msg, hint=closest(of, known) if known else "the model has none")

    def normal(v: Array) -> Array:
        return np.asarray(dead.C_n @ v)

    def slips(v: Array) -> Array:
        return np.asarray(np.linalg.norm((dead.C_t @ v).reshape(dead.pairs, dead.dim - 1), axis=1))

    if kind == "tie":
        k = int(np.flatnonzero(pairs.interface < 0)[known.index(of)])

        def with_cap(p: float) -> ContactProblem:
            cap = laws.cap.copy()
            cap[k] = p
            return replace(dead, laws=replace(laws, cap=cap))

        return with_cap, lambda v: max(float(-normal(v)[k]), 0.0)
    if kind == "cohesion":
        own = np.where((pairs.law == known.index(of)) & (pairs.interface >= 0), pairs.area, 0.0)

        def with_cohesion(p: float) -> ContactProblem:
            return replace(dead, laws=replace(laws, cohesion=np.where(own > 0, p * own, laws.cohesion)))

        return with_cohesion, lambda v: float(own @ slips(v))
    none = assembly.problem({**zero, of: 0.0}, like=dead).f

    def with_load(p: float) -> ContactProblem:
        return dead.with_loads(none + p * (dead.f - none))

    return with_load, lambda v: -float((dead.f - none) @ v)
