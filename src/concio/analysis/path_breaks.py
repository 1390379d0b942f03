"""Load paths past a tie that breaks: the nearest equilibrium without it, from which the path goes on.

Under a growing load the load stays as it is when the tie goes. Under the motion of a point the point stays where it is,
and the load falls: it is the largest at which the structure without the tie is in equilibrium and the point has not
passed its place. Either is a finite step; what the sudden break does to masses is not followed, and the energy that
neither work nor bodies account for is counted as dissipated.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.contact.assembly import Assembly
from concio.problem.contact_problem import ContactProblem
from concio.problem.limits_of_work import BREAK_HALVINGS
from concio.problem.solution import Solver
from concio.solvers.path.near_forces import needed, solve_near
from concio.solvers.path.path_state import (
    LinearPath,
    PathState,
    elastic_energy,
    energy_of_step,
    state_of,
    step_problem,
    weakened,
)

Array = np.ndarray


def marked(assembly: Assembly, state: PathState, pair: int) -> PathState:
    """Return a state from which on the tie of a pair is gone."""
    broken = np.zeros(len(assembly.pairs), dtype=bool) if state.broken is None else state.broken.copy()
    broken[pair] = True
    return replace(state, broken=broken)


def without_gone(path: LinearPath, state: PathState, ties: Array) -> LinearPath:
    """Return a path without the ties, by the numbers of their pairs (k,), that are gone in a state."""
    if state.broken is None or not state.broken[ties].any():
        return path
    gone = np.zeros(path.problem.pairs, dtype=bool)
    gone[ties] = state.broken[ties]
    gap_rate, tangent_rate = np.where(gone, 0.0, path.gap_rate), np.where(gone[:, None], 0.0, path.tangent_rate)
    return replace(path, problem=weakened(path.problem, gone), gap_rate=gap_rate, tangent_rate=tangent_rate)


def released(path: LinearPath, state: PathState, control: Array | None, solver: Solver) -> PathState | None:
    """Return the equilibrium nearby from which a path goes on when a tie is gone; None where none was found.

    Parameters
    ----------
    path : LinearPath
        Without the tie.
    state : PathState
        The last one with it, in which it is marked as gone.
    control : (N,) array or None
        Functional of the displacements that is controlled; None for the load.
    solver : callable
        Solves what is not found near the state.
    """
    if control is None:
        return _at(path, state, state.parameter, solver)
    place, best = float(control @ state.displacement), None
    low, high = 0.0, state.parameter
    for _ in range(BREAK_HALVINGS):
        middle = 0.5 * (low + high)
        found = _at(path, state, middle, solver if best is None else None)
        if found is not None and float(control @ found.displacement) <= place:
            best, low = found, middle
        else:
            high = middle
        if high - low <= 1e-12 * abs(state.parameter):
            break
    return best


def _at(path: LinearPath, state: PathState, parameter: float, solver: Solver | None) -> PathState | None:
    """Return the state of the step to a value of the parameter, or None."""
    problem = _settled(step_problem(path, state, parameter), path.problem)
    force = state.normal_force if state.broken is None else np.where(state.broken, 0.0, state.normal_force)
    near = state.displacement, force, state.friction_force
    found = solve_near(problem, *near)
    if not found.solved and solver is not None and needed(problem):
        found = solver(problem)
    if not found.solved:
        return None
    after = state_of(path, parameter, found.displacement, found.normal_force, found.friction_force, before=state)
    work, _ = energy_of_step(path, state, after)
    stored = elastic_energy(path.problem, after) - elastic_energy(path.problem, state)
    return replace(after, dissipation=state.dissipation + work - stored, broken=state.broken)


def _settled(problem: ContactProblem, without: ContactProblem) -> ContactProblem:
    """Return the problem of a step with the gaps of ties that are gone as they are, whatever they had yielded."""
    gone = np.diff(without.C_n.indptr) == 0
    return replace(problem, gap=np.where(gone, without.gap, problem.gap))
