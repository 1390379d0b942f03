r"""``sparse-lemke``: complementary pivoting on the sparse mixed form, from any starting states.

Nothing is eliminated and no tableau is kept: u, K and C stay sparse, and the basis of Lemke's method is the state of
every pair (:mod:`concio.solvers.pivoting.pair_rows`), factorised sparsely and updated by single rows
(:mod:`concio.solvers.algebra.updated_factor`). The start is the wall glued together: every pair sticks under a
prestress that grows
with what its joint cannot carry. The prestress is then driven to zero along a piecewise linear path
(:mod:`concio.solvers.pivoting.state_path`); there are as many pivots as pairs change state, not as there are unknowns.

Given ``start_states``, the path starts there instead: a cheap and exact crossover from an approximate answer. Without
violations there is nothing to do but one linear solve. Where the answer near is given too (``start``), the path leads
from it through loads and gaps that make it exact and fade away; if that fails, or without it, from the states with
shifts that cover what is violated (:mod:`concio.solvers.pivoting.covering`).

The compliance that keeps redundant corner pairs regular is taken out at the end by iterative refinement, and the answer
is judged by the certificate as always. Where a path fails, others are tried: more and other prestress,
swollen joints, blocks held apart by friction on the ground that fades away, and weak springs that the finish removes.

Parameters of :func:`solve`
---------------------------
start_states : PairStates, optional
start : (u, t_n, t_t), optional
    An approximate answer; the sign of its slips tells the direction in which open pairs would slide.
limit : int, optional
    Largest number of pivots of one path, default 20 m + 500.
tries : int, default 7
    Cold starts that may be tried.
refresh : int, default 64
    Rows replaced between factorisations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import PairStates
from concio.problem.solution import ProgressCallback, Solution, Status, failed
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.algebra.scales import require_plane
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.pivoting.covering import cold_states, cover_point, cover_states, named_states, open_states
from concio.solvers.pivoting.lemke_outcome import no_solution
from concio.solvers.pivoting.pair_rows import PairSystem
from concio.solvers.pivoting.state_path import PathEnd, StatePath
from concio.solvers.pivoting.state_solution import finish

METHOD = "sparse-lemke"

Start = tuple[Array, Array, Array]


COLD: tuple[tuple[str, dict[str, Any]], ...] = (
    ("cohesion", {"base": 1.0, "glue": 10.0}),
    ("little prestress", {}),
    ("swollen joints", {"swelling": 1.0}),
    ("more cohesion", {"base": 10.0, "glue": 10.0, "seed": 1}),
    ("blocks apart, held by the ground", {"ground": True, "base": 1.0, "glue": 5.0}),
    ("other prestress", {"base": 0.5, "seed": 3}),
    ("held by weak springs", {"proximal": 1e-8}),
)
"""Starts tried in this order: how the joints are covered."""

ANCHOR = 1e-9
"""Stiffness of the springs that hold what is loose near a given point, in units of the typical stiffness."""

AGAIN = 3
"""Times a path that ended near the answer is followed by another from there, its springs anchored again."""


@dataclass(frozen=True)
class _Attempt:
    """Where a path starts: states (of a cold start if None), and for a start from a point u, p, r in system units."""

    name: str
    options: dict[str, Any]
    states: tuple[Array, Array] | None = None
    point: Start | None = None
    again: int = 0


@dataclass
class _Work:
    """What the paths tried so far have cost."""

    events: int = 0
    factorisations: int = 0
    trace: list[str] = field(default_factory=list)
    velocity: Array | None = None

    def extra(self, **info: Any) -> dict[str, Any]:
        return {
            "iterations": self.events,
            "factorisations": self.factorisations,
            "trace": tuple(self.trace),
            "info": {"pivots": self.events, **info},
        }


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    start_states: PairStates | None = None,
    start: Start | None = None,
    limit: int | None = None,
    tries: int = 7,
    refresh: int = 64,
) -> Solution:
    """Solve by pivoting on the states of the pairs; see the module for the parameters.

    Raises
    ------
    MethodError
        The problem is not plane.
    InputError
        ``start_states`` has not one entry for each pair.
    """
    require_plane(problem)
    if start_states is not None and len(start_states) != problem.pairs:
        msg = f"start_states holds {len(start_states)} states, expected {problem.pairs}"
        raise InputError(msg)
    scaled = scale(problem)
    return pivot(
        scaled, progress=progress, start_states=start_states, start=start, limit=limit, tries=tries, refresh=refresh
    )


def pivot(
    scaled: Scaled,
    *,
    progress: ProgressCallback | None = None,
    start_states: PairStates | None = None,
    start: Start | None = None,
    limit: int | None = None,
    tries: int = 7,
    refresh: int = 64,
) -> Solution:
    """Solve a problem in units of its own by pivoting; see the module for the parameters."""
    problem, system = scaled.problem, PairSystem(scaled)
    work, m = _Work(), problem.pairs
    most = limit or 20 * problem.pairs + 500
    attempts = [_Attempt(name, options) for name, options in COLD[: max(tries, 0)]]
    if start_states is not None:
        named = named_states(system, start_states, start)
        solution = _as_given(system, named, work)
        if solution is not None and solution.solved:
            return solution
        attempts.insert(0, _Attempt("given states", {}, named))
        if start is not None:
            u, t = scaled.bring(*start)
            point = (u, t[:, 0], t[:, 1])
            attempts.insert(0, _Attempt("given point", {"proximal": ANCHOR}, named, point))
    while attempts:
        attempt = attempts.pop(0)
        name = attempt.name
        if "proximal" in attempt.options and attempt.point is None and work.velocity is not None:
            break
        try:
            held, states = _covered(system, attempt)
            path = StatePath(held, *states, refresh=refresh)
        except SingularMatrixError:
            work.trace.append(f"{name}: the starting states leave a body loose.")
            continue
        end = path.follow(most, progress)
        work.events += end.events
        work.factorisations += end.factorisations
        work.trace.append(f"{name}: {end.outcome} after {end.events} pivots.")
        if end.outcome == "cancelled":
            return failed(problem, Status.CANCELLED, method=METHOD, **work.extra())
        if end.outcome == "solution":
            ends = end.normal[:m], end.sign[:m]
            try:
                solution = finish(system if held.ground else held, *ends, method=METHOD, **work.extra(start=name))
            except SingularMatrixError:
                work.trace.append(f"{name}: its final states leave a body loose.")
                continue
            if solution.solved:
                return solution
            work.trace.append(f"{name}: its end is exact only to {solution.certificate.worst:.1e}.")
            if attempt.point is not None and attempt.again < AGAIN:
                p, r = end.unknowns[held.n : -1].reshape(-1, 2).T
                point = (end.unknowns[: held.n], p, r)
                again = replace(attempt, name="from there", states=ends, point=point, again=attempt.again + 1)
                attempts.insert(0, again)
        elif end.outcome == "ray":
            first = work.velocity is None
            work.velocity = _velocity(end, problem.unknowns)
            if first:  # a way to fall: does it prove that the structure must?
                verdict = no_solution(problem, METHOD, velocity=work.velocity, **work.extra())
                if verdict.status is Status.NO_EQUILIBRIUM:
                    return verdict
    return no_solution(problem, METHOD, velocity=work.velocity, **work.extra())


def _covered(system: PairSystem, attempt: _Attempt) -> tuple[PairSystem, tuple[Array, Array]]:
    """Return the covered system of an attempt, and its states."""
    options = dict(attempt.options)
    proximal = options.pop("proximal", 0.0)
    states = attempt.states or cold_states(system)
    if options.pop("ground", False):
        system = PairSystem(system.s, ground=True)
        states = open_states(system)
    elif proximal:
        system = PairSystem(system.s, proximal)
    if attempt.point is not None:
        return system, cover_point(system, *states, *attempt.point)
    return system, cover_states(system, *states, **options)


def _as_given(system: PairSystem, states: tuple[Array, Array], work: _Work) -> Solution | None:
    """Try whether the given states are those of the answer."""
    work.factorisations += 1
    try:
        return finish(system, *states, method=METHOD, **work.extra(start="given states, no pivot needed"))
    except SingularMatrixError:
        return None


def _velocity(end: PathEnd, n: int) -> Array | None:
    u = end.direction[:n]
    size = float(np.abs(u).max(initial=0.0))
    return u / size if size > 1e-9 * float(np.abs(end.direction).max()) else None
