r"""``sparse-lemke``: complementary pivoting on the sparse mixed form, from any starting states.

Nothing is eliminated and no tableau is kept: u, K and C stay sparse, and the basis of Lemke's method is the state of
every pair (:mod:`concio.lcp.pair_rows`), factorised sparsely and updated by single rows
(:mod:`concio.lcp.updated_factor`). The start is the wall glued together: every pair sticks under a prestress that grows
with what its joint cannot carry. The prestress is then driven to zero along a piecewise linear path
(:mod:`concio.lcp.state_path`); there are as many pivots as pairs change state, not as there are unknowns.

Given ``start_states``, the path starts there instead, with shifts that cover just what is violated: a cheap and exact
crossover from an approximate answer. Without violations there is nothing to do but one linear solve.

The compliance that keeps redundant corner pairs regular is taken out at the end by iterative refinement, and the answer
is judged by the certificate as always. Where a path fails, others are tried: more and other prestress,
swollen joints, blocks held apart by friction on the ground that fades away, and weak springs that the finish removes.

Parameters of :func:`solve`
---------------------------
start_states : (m,) array of PairState, optional
start : (u, t_n, t_t), optional
    An approximate answer; the sign of its slips tells the direction in which open pairs would slide.
limit : int, optional
    Largest number of pivots of one path, default 20 m + 500.
tries : int, default 7
    Cold starts that may be tried.
refresh : int, default 74
    Rows replaced between factorisations.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from concio.contact.problem import Array, ContactProblem
from concio.errors import InputError
from concio.lcp.covering import cold_states, cover_states, named_states, open_states
from concio.lcp.lemke_basis import SingularBasisError
from concio.lcp.lemke_outcome import no_solution
from concio.lcp.pair_rows import PairSystem
from concio.lcp.solution import ProgressCallback, Solution, Status, failed
from concio.lcp.state_path import PathEnd, StatePath
from concio.lcp.state_solution import finish

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


@dataclass(frozen=True)
class _Attempt:
    name: str
    options: dict[str, Any]
    states: tuple[Array, Array] | None = None


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
    start_states: Array | None = None,
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
    system = PairSystem(problem)
    if start_states is not None and np.shape(start_states) != (problem.pairs,):
        msg = f"start_states has shape {np.shape(start_states)}, expected ({problem.pairs},)"
        raise InputError(msg)
    work, m = _Work(), problem.pairs
    most = limit or 20 * problem.pairs + 500
    attempts = [_Attempt(name, options) for name, options in COLD[: max(tries, 0)]]
    if start_states is not None:
        named = named_states(system, start_states, start)
        solution = _as_given(system, named, work)
        if solution is not None and solution.solved:
            return solution
        attempts.insert(0, _Attempt("given states", {}, named))
    for attempt in attempts:
        name, states = attempt.name, attempt.states or cold_states(system)
        options = dict(attempt.options)
        proximal = options.pop("proximal", 0.0)
        if proximal:
            if work.velocity is not None:
                break
            system = PairSystem(problem, proximal)
        if options.pop("ground", False):
            held = PairSystem(problem, ground=True)
            states = open_states(held)
        else:
            held = system
        try:
            start_of_path = cover_states(held, *states, **options)
            path = StatePath(held, *start_of_path, refresh=refresh)
        except SingularBasisError:
            work.trace.append(f"{name}: the starting states leave a body loose.")
            continue
        end = path.follow(most, progress)
        work.events += end.events
        work.factorisations += end.factorisations
        work.trace.append(f"{name}: {end.outcome} after {end.events} pivots.")
        if end.outcome == "cancelled":
            return failed(problem, Status.CANCELLED, method=METHOD, **work.extra())
        if end.outcome == "solution":
            try:
                solution = finish(system, end.normal[:m], end.tangential[:m], method=METHOD, **work.extra(start=name))
            except SingularBasisError:
                work.trace.append(f"{name}: its final states leave a body loose.")
                continue
            if solution.solved:
                return solution
            work.trace.append(f"{name}: its end is exact only to {solution.certificate.worst:.1e}.")
        elif end.outcome == "ray":
            first = work.velocity is None
            work.velocity = _velocity(end, problem.unknowns)
            if first:  # a way to fall: does it prove that the structure must?
                verdict = no_solution(problem, METHOD, velocity=work.velocity, **work.extra())
                if verdict.status is Status.NO_EQUILIBRIUM:
                    return verdict
    return no_solution(problem, METHOD, velocity=work.velocity, **work.extra())


def _as_given(system: PairSystem, states: tuple[Array, Array], work: _Work) -> Solution | None:
    """Try whether the given states are those of the answer."""
    work.factorisations += 1
    try:
        return finish(system, *states, method=METHOD, **work.extra(start="given states, no pivot needed"))
    except SingularBasisError:
        return None


def _velocity(end: PathEnd, n: int) -> Array | None:
    u = end.direction[:n]
    size = float(np.abs(u).max(initial=0.0))
    return u / size if size > 1e-9 * float(np.abs(end.direction).max()) else None
