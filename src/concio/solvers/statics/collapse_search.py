r"""Search for the collapse state of least multiplier, from several starts.

The least multiplier among the collapse states of a structure (:mod:`concio.solvers.statics.collapse_state`) is a
mathematical programme with complementarity constraints (Ferris and Tin-Loi, Int. J. Mech. Sci. 43, 2001); nobody finds
it for sure. The search is the simple iteration on the sliding strength: with the strength frozen at c + mu t_n of the
forces found last, flow is associated and dilatancy zero, a linear programme in the plane and one over second-order
cones in space; its forces, averaged with the old ones, give the next strength (in the spirit of Gilbert, Casapulla and
Ahmed, Comput. Struct. 84, 2006). Where it ends depends on where it begins. So it begins from the forces of the
associated limit, and again from admissible forces drawn at random: those that minimise a random cost under a random
share of the associated load (in space, those that the largest random load leaves beside such a share).

The motion of every iteration is tried, not only that at which it comes to stand: many lead to a state of their own.
What comes out is the least of the states found, each certified for itself; that there is none below is not shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.errors import SolverError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.limits_of_work import COLLAPSE_WORK
from concio.problem.parts import Part, parts_of
from concio.problem.solution import Progress, ProgressCallback
from concio.problem.tolerances import CHECKED, FROZEN_TARGET
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from concio.solvers.statics.collapse_state import CollapseState, Motion, certify_collapse
from concio.solvers.statics.existence import statically_admissible
from concio.solvers.statics.programme import StaticProgramme, optimise

STARTS = {2: 12, 3: 2}
"""Starts at most: the least known state of a published wall is found by one in five of them. In space other starts end
within a thousandth, and cost more."""

MOST, WORK = 25, 350_000
"""Linear programmes from one start at most, and their number times the pairs."""

STILL, PATIENCE = {2: 1e-9, 3: 1e-5}, 3
"""A start is done where the multiplier changes by less than ``STILL`` in ``PATIENCE`` iterations in a row; in space,
where slips turn as they please, it never quite comes to stand."""

SETTLED = 5e-3
"""In space motions are tried only once the multiplier changes by less than this in an iteration, relative: a programme
that finds no forces for a motion costs twice the one that found the motion. Where that leaves no state at all, the
motions passed over are tried from the last back to the first."""

Tried = dict[tuple[int, bytes], CollapseState | None]
"""Motions of a connected part that were tried, by what they ask of its pairs, with the states found."""

AVERAGE, SEED = 0.5, 0
"""Weight of the new forces in the strength; of the random starts: a problem is always searched in the same way."""

SAME = {2: 1e-9, 3: 1e-3}
"""States whose multipliers differ by less, relative, count as one."""


@short_repr
@dataclass(frozen=True, eq=False)
class CollapseSearch:
    """What a search for collapse states found, and how far it looked.

    Parameters
    ----------
    state : CollapseState or None
        The certified one of least multiplier met.
    starts, programmes : int
        Starts made and linear programmes solved.
    multipliers : tuple of float
        Multipliers of all different states met, in rising order.
    cancelled : bool
        Whether it was stopped on request.
    """

    state: CollapseState | None
    starts: int
    programmes: int
    multipliers: tuple[float, ...]
    cancelled: bool = False

    @property
    def words(self) -> str:
        """What was done, in words."""
        looked = f"{self.starts} start{'s' if self.starts > 1 else ''}, {self.programmes} programmes"
        looked += ", stopped on request" if self.cancelled else ""
        if self.state is None:
            return f"none found from {looked}; that proves nothing"
        many = len(self.multipliers)
        return f"the one found from {looked}" if many == 1 else f"least of {many} found from {looked}"


def find_collapse_state(
    problem: ContactProblem,
    live: Array,
    *,
    starts: int | None = None,
    iterations: int | None = None,
    work: int = COLLAPSE_WORK,
    bound: LimitLoad | None = None,
    progress: ProgressCallback | None = None,
    tried: Tried | None = None,
) -> CollapseSearch:
    """Search Coulomb collapse states, of each connected part by itself.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    live : (N,) array
    starts : int, optional
        Starts at most, by default :data:`STARTS`; fewer on large problems.
    iterations : int, optional
        Linear programmes with frozen strength from one start, at most; by default 25, fewer on large problems.
    work : int
        Linear programmes times pairs after which no further start is made; one start alone takes no more either where
        this is less than its own share.
    bound : LimitLoad, optional
        Associated limit of the problem, where it is known already.
    progress : callable, optional
    tried : dict, optional
        Motions that earlier searches of this problem and load tried, with the states found; those of this one are
        added.
    """
    tried = {} if tried is None else tried
    asked = _Asked(starts, iterations, work, progress)
    parts = [part for part in parts_of(problem) if part.unknowns.size]
    if len(parts) <= 1:
        return _of_one(problem, live, bound, asked, tried)
    found: list[CollapseSearch] = []
    parts.sort(key=lambda part: not live[part.unknowns].any())  # those without a load of their own only stand
    for k, part in enumerate(parts):
        if not live[part.unknowns].any() or (found and found[-1].cancelled):
            break
        found.append(_of_one(part.problem, live[part.unknowns], None, asked, tried, k))
    return _of_all(problem, live, parts, found)


@dataclass(frozen=True)
class _Asked:
    """How to search: see :func:`find_collapse_state`."""

    starts: int | None
    iterations: int | None
    work: int
    progress: ProgressCallback | None


def _of_all(
    problem: ContactProblem, live: Array, parts: Sequence[Part], found: Sequence[CollapseSearch]
) -> CollapseSearch:
    """Return what was found of the whole: a part that moves while all others stand, at the least multiplier."""
    states = [(one.state, k) for k, one in enumerate(found) if one.state is not None]
    whole = None
    for state, k in sorted(states, key=lambda pair: pair[0].multiplier):
        whole = _whole(problem, live, parts, state, k)
        if whole is not None:
            break
    met = sorted(x for one in found for x in one.multipliers)
    different = [x for i, x in enumerate(met) if not i or x > met[i - 1] + SAME[problem.dim] * max(1.0, abs(x))]
    return CollapseSearch(
        whole, sum(one.starts for one in found), sum(one.programmes for one in found), tuple(different),
        any(one.cancelled for one in found),
    )  # fmt: skip


def _whole(
    problem: ContactProblem, live: Array, parts: Sequence[Part], state: CollapseState, moving: int
) -> CollapseState | None:
    """Return the state of the whole in which one part begins to move; None where another one is not in balance."""
    t_n, t_t = np.zeros(problem.pairs), np.zeros((problem.pairs, problem.dim - 1))
    velocity, worst = np.zeros(problem.unknowns), state.statics
    velocity[parts[moving].unknowns] = state.velocity
    for k, part in enumerate(parts):
        normal, friction = state.normal_force, state.friction_force
        if k != moving:
            loads = part.problem.f + state.multiplier * live[part.unknowns]
            held = statically_admissible(part.problem.with_loads(loads))
            if not held.exists:
                return None
            normal, friction, worst = held.normal_force, held.friction_force, max(worst, held.residual)
        t_n[part.pairs], t_t[part.pairs] = normal, friction
    return replace(state, normal_force=t_n, friction_force=t_t, velocity=velocity, statics=worst)


def _of_one(
    problem: ContactProblem, live: Array, bound: LimitLoad | None, asked: _Asked, tried: Tried, number: int = 0
) -> CollapseSearch:
    """Search the collapse states of a connected part."""
    starts, iterations, work = asked.starts, asked.iterations, asked.work
    top = associated_limit(problem, live) if bound is None else bound
    search = _Search(problem, live, asked.progress, tried, number)
    search.most = max(top.multiplier, top.upper)
    if np.isnan(top.multiplier):
        return search.outcome(0)
    share = WORK if work >= COLLAPSE_WORK else work
    most = max(1, min(MOST, share // max(problem.pairs, 1))) if iterations is None else iterations
    rng = np.random.default_rng(SEED)
    made, starts = 0, STARTS[problem.dim] if starts is None else starts
    while made < starts and (made == 0 or search.programmes * problem.pairs < work):
        forces = top.normal_force if made == 0 else _drawn(problem, live, top, rng)
        made += 1
        if forces is not None and not search.run(problem.cone.strength(forces), most, made):
            return search.outcome(made, cancelled=True)
    return search.outcome(made)


class _Search:
    """Iterates from one start after another and keeps what was met; no motion is certified twice."""

    def __init__(
        self, problem: ContactProblem, live: Array, progress: ProgressCallback | None, tried: Tried, number: int
    ) -> None:
        self.problem, self.live, self.progress = problem, live, progress
        self.tried, self.number = tried, number
        self.states: list[CollapseState] = []
        self.asked: set[bytes] = set()
        self.programmes = 0
        self.most = np.inf

    def outcome(self, starts: int, *, cancelled: bool = False) -> CollapseSearch:
        """Return what was found so far."""
        multipliers: list[float] = []
        for found in sorted(state.multiplier for state in self.states):
            if not multipliers or found > multipliers[-1] + SAME[self.problem.dim] * max(1.0, abs(found)):
                multipliers.append(found)
        best = min(self.states, key=lambda state: state.multiplier, default=None)
        return CollapseSearch(best, starts, self.programmes, tuple(multipliers), cancelled)

    def run(self, strength: Array, most: int, start: int) -> bool:
        """Iterate from a sliding strength (m,); return False where the callback asked to stop."""
        problem, zero = self.problem, np.zeros(self.problem.pairs)
        last, still = np.inf, 0
        before, passed = len(self.states), list[Array]()
        for count in range(most):
            note = Progress("collapse states", self.programmes, 0.0, f"start {start}, programme {count + 1}")
            if self.progress is not None and self.progress(note):
                return False
            laws = replace(problem.laws, friction=zero, dilatancy=zero, cohesion=strength)
            self.programmes += 1
            try:
                found = associated_limit(replace(problem, laws=laws), self.live, target=FROZEN_TARGET)
            except SolverError:  # a load that presses on joints raises their strength, and that the load, past 1e16
                break
            if not np.isfinite(found.multiplier) or found.mechanism is None:
                break
            change = abs(found.multiplier - last) / max(1.0, abs(last))
            if problem.dim == 2 or change <= SETTLED:
                self.certify(found.mechanism.velocity)
            else:
                passed.append(found.mechanism.velocity)
            still = still + 1 if change <= STILL[problem.dim] else 0
            if still >= PATIENCE:
                break
            last = found.multiplier
            strength = (1 - AVERAGE) * strength + AVERAGE * problem.cone.strength(found.normal_force)
        while passed and len(self.states) == before:
            self.certify(passed.pop())
        return True

    def certify(self, velocity: Array) -> None:
        """Keep the collapse state of a motion (N,), if there is one and its like was not tried before."""
        motion = Motion.of(self.problem, velocity)
        if motion.key in self.asked:
            return
        self.asked.add(motion.key)
        self.programmes += 1
        key = self.number, motion.key
        if key not in self.tried:
            self.tried[key] = certify_collapse(self.problem, self.live, velocity, self.programmes, self.most)
        state = self.tried[key]
        if state is not None and state.multiplier >= 0.0:  # the reverse is another load
            self.states.append(state)


def _drawn(problem: ContactProblem, live: Array, top: LimitLoad, rng: np.random.Generator) -> Array | None:
    """Return normal forces (m,) drawn from those that are admissible under a random share of the associated load."""
    most = top.multiplier
    if not np.isfinite(most):  # locked: shares of a live load as large as the dead one
        most = (float(np.abs(problem.f).sum()) or 1.0) / float(np.abs(live).sum())
    load = problem.f + rng.uniform(0.0, 1.0) * most * live
    if problem.dim == 3:
        return _drawn_in_space(problem, load, live, rng)
    programme = StaticProgramme(problem)
    A, e0 = programme.equilibrium
    force = float(np.abs(load).sum()) or 1.0
    caps = programme.caps
    limits = None if caps is None else (caps[0], caps[1] / force)
    cost = np.abs(rng.normal(size=A.shape[1]))
    bounds = programme.bounds / force
    cost[~np.isfinite(bounds[:, 0])] = 0.0
    result = optimise(cost, (A, -(programme.project(load) + e0) / force), bounds, limits)
    return programme.forces(result.x * force)[0] if result.status == 0 else None


def _drawn_in_space(problem: ContactProblem, load: Array, live: Array, rng: np.random.Generator) -> Array | None:
    """Return normal forces (m,) among the admissible ones under ``load``: those that a random push would end with."""
    away = rng.normal(size=problem.unknowns) * float(np.abs(live).max())
    found = associated_limit(problem.with_loads(load), problem.R @ (problem.R.T @ away))
    forces: Array = found.normal_force
    return forces if np.isfinite(found.multiplier) and found.residual <= CHECKED else None
