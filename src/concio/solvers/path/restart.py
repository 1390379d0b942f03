r"""Beyond a point where no rates continue a path: finite steps, jumps, and what proves that there is nothing beyond.

The rate problem of Coulomb friction may have no solution at a point though the structure carries more: at the next
load, however near, the only states in equilibrium are a finite distance away (a part of the wall snaps and comes to
rest again). Then the path goes on from there: the one-step problem, slip measured from the last converged state
(10, 11), is solved at slightly larger loads, the smallest increment first. A certified answer is accepted as

* a *jump* where its distance from the point does not shrink with the increment,
* a *restart* where it does: rates exist, though they were not found (vertices with hundreds of critical pairs).

Where no increment has a certified answer the path is at its end, and why is reported: a mechanism proves that the load
beyond has no equilibrium; or the structure, let go under slightly more load, moves away without bound
(:mod:`concio.solvers.relaxation.slow_motion`); or it can move at the very load, friction being what it is; or none of
these is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.error_units import measure
from concio.problem.solution import ProgressCallback, Solution, Status, failed
from concio.problem.tolerances import ACCURATE, AT_BOUND
from concio.solvers.auto import chain as auto
from concio.solvers.interior import engine
from concio.solvers.path.near_forces import Nearby, needed, solve_near
from concio.solvers.path.path_state import LinearPath, PathState, plastic_position, state_of, step_problem
from concio.solvers.statics.existence import find_mechanism

SHARES = (1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 2e-3, 4e-3, 7e-3, 1e-2, 2e-2)
"""Load increments tried in turn, as shares of the present load."""

QUICK = 1
"""Starts of the quick tries."""

NEXT = 1e-4
"""Increment up to which the proof that there is no equilibrium counts for the point itself."""

LET_GO = (1e-5, NEXT, 1e-3, 1e-2)
"""Increments under which the structure is let go where nothing else answers: up to the last but one, the largest that
restarts following one another ask for comes first, then less.

Forces out of balance by a millionth of the load are lost among the errors of the steps: a wall whose limit the path had
reached was released without a result.
"""

TENTH = 0.1
"""Share of an increment at which it is seen whether its answer is a jump."""

SHRINKS = 0.3
"""An answer whose distance shrinks by this factor under a tenth of the increment is not a jump."""

FREE = 1e-6
"""Largest relative residual of a motion that needs no change of forces."""


How = Literal["near", "let go"]
"""How a load step is solved: from the point it starts from, or by letting the structure go there."""


@dataclass(frozen=True, eq=False)
class Beyond:
    """What lies beyond a point of a path.

    Parameters
    ----------
    state : PathState or None
        Certified state to go on from.
    jump : bool
        Whether it is a finite distance away, however small the increment.
    no_equilibrium : bool
        Where there is no state: whether a mechanism proves that the load beyond cannot be carried, or an unbounded
        motion that the structure, released at the point under slightly more load, does not come to rest.
    motion : (N,) array or None
        That mechanism or motion.
    cancelled : bool
    fallen : float
        Least load parameter, in the sense of the path, at which the structure moved away; inf where at none.
    """

    state: PathState | None
    jump: bool = False
    no_equilibrium: bool = False
    motion: Array | None = None
    cancelled: bool = False
    fallen: float = np.inf


def look_beyond(
    path: LinearPath,
    point: PathState,
    sense: float,
    *,
    end: float = np.inf,
    quick: bool = False,
    least: float = 0.0,
    fallen: float = np.inf,
    progress: ProgressCallback | None = None,
) -> Beyond:
    """Look for a certified state slightly beyond a point at which no rates were found.

    Parameters
    ----------
    path : LinearPath
    point : PathState
        Last converged state; slip is measured from it.
    sense : float
        +1 or -1: the load parameter grows or falls.
    end : float
        Load parameter not to be passed.
    quick : bool
        Whether only quick tries are made: the structure is known to move freely at the point, or was examined before.
    least : float
        Share of the present load below which increments are tried last, where restarts have followed one another
        closely.
    fallen : float
        Load parameter, in the sense of the path, from which on the structure moved away when it was let go before:
        increments that reach it are the last under which it is let go again.
    progress : callable, optional
    """
    unit = load_unit(path, point)
    shares = sorted(SHARES, key=lambda share: (share < min(least, SHARES[-1]), share))
    tries: list[tuple[float, How]] = [(share, "near") for share in shares]
    if not quick:
        order = _in_order(LET_GO, min(least, LET_GO[-2]))
        order.sort(key=lambda share: sense * point.parameter + share * unit >= fallen)
        tries += [(share, "let go") for share in order]
    proof: Solution | None = None
    lost, beyond = 0, np.inf
    for share, how in tries:
        if share >= beyond or (lost and np.isfinite(beyond)):
            continue  # what lies beyond has no equilibrium: one release says whether the point is the last one
        parameter = point.parameter + sense * min(share * unit, abs(end - point.parameter))
        solution = solve_step(path, point, parameter, progress, how)
        if solution.status is Status.CANCELLED:
            return Beyond(None, cancelled=True)
        if solution.status in (Status.NO_EQUILIBRIUM, Status.COLLAPSES):
            if share <= NEXT:
                proof = solution
                break
            beyond = min(share, beyond)  # that says nothing of the loads between
            fallen = min(sense * parameter, fallen)
            continue
        lost += how == "let go" and not solution.solved
        if solution.solved and solution.certificate.worst > ACCURATE:
            solution = settled(path, point, parameter, solution)
        if not solution.solved or solution.certificate.worst > ACCURATE:
            continue
        state = state_of(
            path, parameter, solution.displacement, solution.normal_force, solution.friction_force, before=point
        )
        return Beyond(state, is_jump(path, point, state, progress, how), fallen=fallen)
    motion = proof.mechanism.velocity if proof is not None and proof.mechanism is not None else None
    return Beyond(None, no_equilibrium=proof is not None, motion=motion)


def _in_order(shares: Sequence[float], least: float) -> list[float]:
    """Return increments as they are tried: from the least wanted downwards, then the larger ones upwards."""
    return sorted(shares, key=lambda share: (share > least, share if share > least else -share))


def load_unit(path: LinearPath, point: PathState) -> float:
    """Return the change of the parameter that brings as much load as there is; 1 where no load changes."""
    changing = float(np.abs(path.load_rate).sum())
    present = float(np.abs(path.problem.f + point.parameter * path.load_rate).sum())
    return (present or changing) / changing if changing else 1.0


def solve_step(
    path: LinearPath, point: PathState, parameter: float, progress: ProgressCallback | None, how: How = "near"
) -> Solution:
    """Solve one load step: quickly from a point, or by a proof of collapse or by letting the structure go."""
    problem = step_problem(path, point, parameter)
    near = (point.displacement, point.normal_force, point.friction_force)
    if how == "let go":
        mechanism = find_mechanism(problem)
        if mechanism is not None:
            return failed(problem, Status.NO_EQUILIBRIUM, method="mechanism", mechanism=mechanism)
        return auto.let_go(problem, *near, progress)
    solution = solve_near(problem, *near, starts=QUICK, progress=progress)
    if solution.solved or solution.status is Status.CANCELLED or not needed(problem):
        return solution
    return engine.solve(problem, homotopy=False, starts=QUICK, progress=progress)


def settled(path: LinearPath, point: PathState, parameter: float, solution: Solution) -> Solution:
    """Solve one load step again from the contact states of an answer less accurate than the states of a path."""
    begin = (solution.displacement, solution.normal_force, solution.friction_force)
    return Nearby().answer(step_problem(path, point, parameter), begin) or solution


def is_jump(
    path: LinearPath, point: PathState, state: PathState, progress: ProgressCallback | None, how: How = "near"
) -> bool:
    """Tell whether a state stays away from the point when the increment becomes ten times smaller."""
    nearer = point.parameter + TENTH * (state.parameter - point.parameter)
    between = step_between(path, point, state, nearer)
    if between is not None and shrinks(point, state, between):
        return False
    return not shrinks(point, state, solve_step(path, point, nearer, progress, how))


def step_between(path: LinearPath, point: PathState, state: PathState, parameter: float) -> Solution | None:
    """Solve a load step to between a point and a state: near the line that joins them, in the states of its end."""
    here = (point.displacement, point.normal_force, point.friction_force)
    there = (state.displacement, state.normal_force, state.friction_force)
    begin = tuple(a + TENTH * (b - a) for a, b in zip(here, there, strict=True))
    return Nearby().answer(step_problem(path, point, parameter), begin)


def shrinks(point: PathState, state: PathState, closer: Solution) -> bool:
    """Tell whether a certified answer to a tenth of the increment lies closer to the point than the state."""
    far = float(np.abs(state.displacement - point.displacement).max(initial=0.0))
    near = float(np.abs(closer.displacement - point.displacement).max(initial=0.0))
    return closer.solved and near <= SHRINKS * far


def moves_freely(path: LinearPath, point: PathState, velocity: Array) -> bool:
    """Tell whether a motion (N,) is possible at constant load and constant forces, friction opposing every slip.

    It must strain no body, pull no closed pair together, open only pairs without force and slide only pairs whose
    friction is used up against it; and loads that grow must drive it.
    """
    problem, law = path.problem, path.problem.laws
    size = float(np.abs(velocity).max(initial=0.0))
    if not size > 0 or not np.isfinite(size):
        return False
    v = velocity / size
    stiff = float(np.abs(problem.K.diagonal()).max(initial=0.0))
    if stiff and float(np.abs(problem.K @ v).max()) > FREE * stiff:
        return False
    units = measure(path.at(point.parameter), point.displacement, point.normal_force, point.friction_force)
    force, length = units.pair_force, units.pair_length
    opening, _ = plastic_position(path, point)
    w_n, w_t = problem.C_n @ v, problem.C_t @ v
    touching = opening + point.offset <= AT_BOUND * length
    rough = problem.cone.rough
    strength = problem.cone.strength(point.normal_force)
    lifted = w_n - np.where(rough, law.dilatancy * np.abs(w_t), 0.0)
    carried = point.normal_force + law.tension > AT_BOUND * force
    crushed = law.cap - point.normal_force <= AT_BOUND * force
    resisting = np.abs(point.friction_force[:, 0] + np.sign(w_t) * strength) > AT_BOUND * force
    wrong = touching & (lifted < -FREE) & ~crushed
    wrong |= carried & (lifted > FREE)
    wrong |= rough & carried & (np.abs(w_t) > FREE) & resisting
    return not wrong.any()
