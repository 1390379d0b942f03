"""Method ``auto``: the engine first, proof of collapse where it fails, pivoting last.

The order is fixed, so that the same problem always goes the same way:

1. interior point with exact finish, from the usual start and from one ten times further out (jammed structures want
   it); where the finish leaves a few pairs undecided, pivoting from its states settles them (crossover);
2. a linear programme: either a mechanism, rechecked, proves that there is no equilibrium, or there are statically
   admissible forces; where no body has to move under them (rigid blocks), they are the answer;
3. interior point from other starts; the same structure with a little more or less friction, its state carried over
   (:mod:`concio.solvers.auto.friction_neighbours`); then the dilatancy homotopy;
4. release: the structure is let go and followed in slow motion, from rest and from the state in which associated flow
   jams; it comes to rest, which is an equilibrium, or settles into a motion without end, which is kept;
5. pivoting from nothing, dense and sparse, where the problem is small enough; what it finds comes before a motion;
6. the motion kept from step 4, if there is one, is the answer;
7. on small problems, exhaustive search over the states of the pairs, which finds one or proves that there is none.

What was tried is the solution's trace. An answer is called solved by its certificate alone, a collapse by its mechanism
or its motion alone, a load that no Coulomb state carries by exhaustion alone; everything else is undecided.
"""

from __future__ import annotations

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Departure, Mechanism, ProgressCallback, Solution, Status, failed, judge
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.sparse_factor import Engine
from concio.solvers.auto.friction_neighbours import from_neighbours
from concio.solvers.exhaustive import search as exhaustive
from concio.solvers.forms import lemke
from concio.solvers.interior.engine import STARTS, Cancelled, Run, at_rest
from concio.solvers.motion.release import associated_state, release
from concio.solvers.pivoting import sparse_lemke
from concio.solvers.states.reading import Finished
from concio.solvers.statics.existence import statically_admissible

OTHERS = (3.0, 30.0, 300.0)
"""Sizes of starting points tried before anything slower: jammed structures have several states, and none suits all."""

DENSE = 450
"""Largest number of pairs for which the dense method of Lemke is tried."""

SPARSE = 3000
"""Largest number of pairs for which sparse pivoting is tried from nothing."""

SMALL = 200
"""Largest number of pairs for which joint states are searched exhaustively."""

SEARCH = 6000
"""Nodes of the exhaustive search up to 60 pairs, fewer with their square beyond; some 10 to 20 s on any problem."""

PATIENCE = 120.0
"""Seconds after which the exhaustive search ends all the same; met only where linear programmes run into trouble."""

CLOSE = 0.05
"""Residual of an exact finish below which its states are worth a crossover."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine = "superlu",
    pivoting: bool = True,
) -> Solution:
    """Solve one load step by whatever it takes.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}
    pivoting : bool
        Whether steps 5 and 7 are tried.

    Returns
    -------
    Solution
        SOLVED, NO_EQUILIBRIUM with its mechanism, COLLAPSES with its motion, NO_COULOMB_STATE, or UNDECIDED with
        what was tried.
    """
    if not problem.pairs:
        return sparse_lemke.solve(problem, progress=progress)  # linear, or a mechanism
    rest = at_rest(problem)
    if rest is not None:
        return rest
    run = Run(scale(problem, engine), progress)
    try:
        for start in STARTS[:2]:
            found = run.plain(start)
            if found is not None:
                return run.solution(found)
            crossed = crossover(run, progress)
            if crossed is not None:
                return crossed
        decided = statics(run)
        if decided is not None:
            return decided
        for start in (*STARTS[2:], *OTHERS):
            found = found or run.plain(start)
        if found is not None:
            return run.solution(found)
        crossed = crossover(run, progress) or carried(run, progress)
        if crossed is None:
            found = run.homotopy()
            if found is not None:
                return run.solution(found)
            crossed = crossover(run, progress) or last_resorts(run, progress, pivoting)
        if crossed is not None:
            return crossed
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(None, Status.UNDECIDED, method="auto")


def last_resorts(run: Run, progress: ProgressCallback | None, pivoting: bool) -> Solution | None:
    """Take steps 4 to 7: let the structure go, but look for an equilibrium by pivoting before a motion is believed."""
    ended = release(run) or release(run, associated_state(run))
    if isinstance(ended, Finished):
        return run.solution(ended)
    answer = pivot(run, progress) if pivoting else None
    if answer is None and ended is not None:
        return moves_away(run, ended)
    return answer or (exhaust(run, progress) if pivoting else None)


def let_go(problem: ContactProblem, u: Array, progress: ProgressCallback | None = None) -> Solution:
    """Follow the slow motion from given displacements: the answer where it comes to rest, or COLLAPSES, or UNDECIDED.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        Displacements from which the structure is let go [m].
    progress : callable, optional
    """
    run = Run(scale(problem), progress)
    try:
        ended = release(run, u / run.scaled.length)
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    if isinstance(ended, Departure):
        return moves_away(run, ended)
    return run.solution(ended, Status.UNDECIDED, method="release")


def moves_away(run: Run, motion: Departure) -> Solution:
    """Return the verdict of a certified motion."""
    problem = run.scaled.problem
    top = float(np.abs(motion.acceleration).max())
    direction = motion.acceleration / top
    mechanism = Mechanism(direction, float(problem.f @ direction), motion.violation)
    answer = failed(problem, Status.COLLAPSES, method="", mechanism=mechanism, departure=motion)
    return merged(run, answer, "release")


def crossover(run: Run, progress: ProgressCallback | None) -> Solution | None:
    """Settle by pivoting the pairs that the exact finish left undecided; None where it was not close or it fails."""
    best: Finished | None = run.best
    if best is None or best.error > CLOSE or run.crossed is best:
        return None
    run.crossed = best
    s = run.scaled
    if not s.problem.laws.plain:
        return None
    answer = sparse_lemke.pivot(
        s, start_states=best.states, start=s.restore(best.u, best.t), limit=500, tries=0, progress=progress
    )
    if answer.status is Status.CANCELLED:
        raise Cancelled
    run.trace.append(f"crossover by pivoting: {answer.iterations} pivots, {answer.status.name.lower()}")
    return merged(run, answer, "interior-point + pivoting") if answer.solved else None


def carried(run: Run, progress: ProgressCallback | None) -> Solution | None:
    """Take part of step 3: solve with a little more or less friction and carry the state over; None if that fails."""
    answer = from_neighbours(run, progress)
    return None if answer is None else merged(run, answer, "interior-point + pivoting")


def statics(run: Run) -> Solution | None:
    """Decide by a linear programme: collapse with its mechanism, or equilibrium without motion; None for neither."""
    problem = run.scaled.problem
    state = statically_admissible(problem)
    if state.exists:
        run.trace.append("statically admissible forces exist")
        rest = judge(
            problem, np.zeros(problem.unknowns), state.normal_force, state.friction_force, method="linear-programme"
        )
        return merged(run, rest, "linear-programme") if rest.solved else None
    mechanism = state.mechanism
    if mechanism is None:
        run.trace.append("no statically admissible forces found, but no mechanism could be verified either")
        return None
    run.trace.append("no statically admissible forces: mechanism found and rechecked")
    return merged(run, failed(problem, Status.NO_EQUILIBRIUM, method="", mechanism=mechanism), "mechanism")


def pivot(run: Run, progress: ProgressCallback | None) -> Solution | None:
    """Try pivoting methods from nothing, as far as the size of the problem allows; None where they fail."""
    problem = run.scaled.problem
    for module, most in ((lemke, DENSE), (sparse_lemke, SPARSE)):
        if problem.pairs > most:
            continue
        name = module.__name__.rsplit(".", 1)[-1].replace("_", "-")
        try:
            answer = module.solve(problem, progress=progress)
        except MethodError as error:
            run.trace.append(f"{name}: does not apply, {error.what}")
            continue
        run.trace.append(f"{name}: {answer.iterations} pivots, {answer.status.name.lower()}")
        if answer.status is Status.CANCELLED:
            raise Cancelled
        if answer.solved:
            return merged(run, answer, name)
    return None


def exhaust(run: Run, progress: ProgressCallback | None) -> Solution | None:
    """Search the states of the pairs of a small problem; None where it is not small or the search does not end."""
    problem = run.scaled.problem
    if problem.pairs > SMALL or not exhaustive.supports(problem):
        return None
    if not exhaustive.available():
        run.trace.append("exhaustive search: not tried, the package highspy is not installed")
        return None
    limit = int(SEARCH * min(1.0, (60.0 / problem.pairs) ** 2))
    answer = exhaustive.solve(problem, progress=progress, time_limit=PATIENCE, node_limit=limit)
    if answer.status is Status.CANCELLED:
        raise Cancelled
    nodes, leaves = answer.info["nodes"], answer.info["leaves"]
    run.trace.append(
        f"exhaustive search: {nodes} nodes, {leaves} combinations of states excluded, {answer.status.name.lower()}"
    )
    return None if answer.status is Status.UNDECIDED else merged(run, answer, "exhaustive")


def merged(run: Run, answer: Solution, method: str) -> Solution:
    """Return an answer of another method with this run's work and trace."""
    return Solution(
        answer.status,
        answer.displacement,
        answer.normal_force,
        answer.friction_force,
        answer.kinematics,
        answer.certificate,
        method,
        iterations=run.iterations + answer.iterations,
        factorisations=run.scaled.factor.count + answer.factorisations,
        mechanism=answer.mechanism,
        departure=answer.departure,
        trace=tuple(run.trace),
        info={"history": tuple(run.history), **answer.info},
    )
