r"""``exhaustive``: find an equilibrium of a small problem or, excluding all joint states, prove that none exists.

Friction is not associated, so no theorem of alternatives says which loads a structure carries: statically admissible
forces may exist and no Coulomb state. What remains is to try the states of the pairs, open, stick, slip + and slip -,
4^m of them, without trying them one by one:

1. some states are assumed, the conditions of all others are relaxed to a linear programme
   (:mod:`.relaxation`);
2. if it has no solution, Farkas' multipliers, rechecked on the original equations, name the few assumptions that
   exclude each other; that clause holds whatever the rest of the structure does, and is kept
   (:mod:`.clauses`);
3. if its solution obeys all conditions, it is a state: solved for exactly and judged, it is the answer;
4. otherwise a condition it violates is decided, and so on. Before the first decision both answers of every violated
   condition are tried alone, the worst first; what fails is settled for good.

The search ends with an answer, with the proof that there is none (the clauses admit no combination of states;
``Status.NO_COULOMB_STATE``), or at its limits, undecided. The proof excludes states whose displacements and forces stay
below ``info["reach"]``, at least 1e7, of the problem's own units. Only pairs of plane problems without cohesion,
tension, dilatancy and cap.

Parameters of :func:`solve`
---------------------------
time_limit : float, default 30
    Seconds after which the search ends undecided.
node_limit : int, optional
    Linear programmes after which the search ends undecided; unlike time, the same on every machine.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Progress, ProgressCallback, Solution, Status, failed, judge
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.exhaustive.clauses import Clause, ClauseSearch
from concio.solvers.methods.exhaustive.state_questions import Empty, Point, StateQuestions
from concio.solvers.states.settle import Settler

ZERO = 1e-9
"""Forces and gaps below this, scaled, count as zero when a point is read as a state; the answer is judged anyway."""

REPORT = 20
"""Nodes between two calls of the progress callback."""


def available() -> bool:
    """Return whether the linear programming code (HiGHS, package highspy) is installed."""
    return find_spec("highspy") is not None


def supports(problem: ContactProblem) -> bool:
    """Return whether the method can treat a problem: plane, no cohesion, tension, dilatancy or cap."""
    law = problem.laws
    plain = not (law.cohesion.any() or law.tension.any() or law.dilatancy.any() or np.isfinite(law.cap).any())
    return problem.dim == 2 and problem.pairs > 0 and plain


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    time_limit: float = 30.0,
    node_limit: int | None = None,
) -> Solution:
    """Solve by excluding joint states; see the module for the parameters.

    Returns
    -------
    Solution
        SOLVED, NO_COULOMB_STATE, UNDECIDED at a limit, or CANCELLED; ``info`` holds nodes, leaves (proofs that a
        combination of states is empty), depth, time, reach, and doubtful linear programmes.

    Raises
    ------
    MethodError
        The problem is not plane, or has cohesion, tension, dilatancy or a cap; or highspy is not installed.
    """
    if not available():
        msg = "exhaustive search needs the package highspy"
        raise MethodError(msg, hint="pip install highspy")
    if not supports(problem):
        msg = "exhaustive search treats plane problems with pairs and without cohesion, tension, dilatancy and cap"
        raise MethodError(msg, hint="use auto")
    return Search(problem).run(progress, time_limit, np.inf if node_limit is None else node_limit)


class Search:
    """One run of the search.

    Parameters
    ----------
    problem : ContactProblem
    """

    def __init__(self, problem: ContactProblem) -> None:
        from concio.solvers.methods.exhaustive.relaxation import Relaxation  # loads HiGHS

        self.problem = problem
        self.scaled: Scaled = scale(problem)
        self.settler = Settler(self.scaled)
        self.lp = Relaxation(problem)
        self.questions = StateQuestions(self.lp.m, self.lp.reduction.rough)
        self.clauses = ClauseSearch(self.questions.count)
        for clause in self.questions.clauses():
            self.clauses.add(clause)
        self.nodes = self.leaves = self.depth = self.doubts = 0
        self.reach = np.inf
        self.worst = np.inf

    def run(self, progress: ProgressCallback | None, time_limit: float, node_limit: float) -> Solution:
        """Search until decided or a limit is reached."""
        begin = time.perf_counter()
        for answer in self.steps():
            spent = time.perf_counter() - begin
            if answer is not None:
                return judge(self.problem, *answer, method="exhaustive", iterations=self.nodes, info=self.info(spent))
            if self.cancelled(progress):
                return self.without_answer(Status.CANCELLED, spent)
            if spent > time_limit or self.nodes >= node_limit:
                return self.without_answer(Status.UNDECIDED, spent)
        status = Status.UNDECIDED if self.doubts else Status.NO_COULOMB_STATE
        return self.without_answer(status, time.perf_counter() - begin)

    def cancelled(self, progress: ProgressCallback | None) -> bool:
        """Tell every few nodes how far the search is; return whether it is asked to end."""
        if progress is None or self.nodes % REPORT != 1:
            return False
        message = f"{self.leaves} combinations of states excluded"
        return bool(progress(Progress("exhaustive", self.nodes, self.worst, message)))

    def without_answer(self, status: Status, spent: float) -> Solution:
        """Return the end of a search that met no equilibrium, after so many seconds."""
        return failed(self.problem, status, method="exhaustive", iterations=self.nodes, info=self.info(spent))

    def info(self, spent: float) -> dict[str, Any]:
        """Return what the search cost, after so many seconds, and up to where its proofs hold."""
        return {
            "nodes": self.nodes,
            "leaves": self.leaves,
            "depth": self.depth,
            "time": spent,
            "reach": self.reach,
            "doubtful": self.doubts,
            "programmes": self.lp.solves,
        }

    def steps(self) -> Iterator[tuple[Any, Any, Any] | None]:
        """Yield None after each node, or (u, t_n, t_t) of an equilibrium; end where nothing is left to try."""
        yield from self.probe()
        if self.clauses.impossible:
            return
        while True:
            conflict = self.clauses.propagate()
            if conflict is None:
                self.nodes += 1
                self.depth = max(self.depth, self.clauses.level)
                found = self.lp.point(self.questions.fixed(self.clauses.trail))
                if isinstance(found, Empty):
                    conflict = self.excluded(found)
                else:
                    answer = self.look(found)
                    yield answer
                    if not self.branch(found):
                        self.doubts += 1  # every state is fixed, yet neither answer nor proof: leave it, and say so
                        conflict = [self.clauses.trail[at] ^ 1 for at in self.clauses.starts]
            if conflict is not None and not self.clauses.learn(conflict):
                return

    def probe(self) -> Iterator[None]:
        """Before any decision, try both answers of the questions the relaxation violates, the worst first.

        An answer that is excluded leaves the other one for good, and the relaxation is solved again.
        """
        clauses, questions = self.clauses, self.questions
        found: Point | Empty | None = None
        order: list[int] = []
        while True:
            if clauses.propagate() is not None:
                clauses.impossible = True
                return
            if not order:
                if found is not None:
                    return
                found = self.lp.point(questions.fixed(clauses.trail))
                if not isinstance(found, Point):
                    return
                order = self.violated(found)
                if not order:
                    return
            literal = order.pop()
            if clauses.holds(literal) is not None:
                continue
            clauses.decide(literal)
            conflict = clauses.propagate()
            if conflict is None:
                self.nodes += 1
                trial = self.lp.point(questions.fixed(clauses.trail))
                conflict = self.excluded(trial) if isinstance(trial, Empty) else None
                yield None
            if conflict is None:
                clauses.back(0)
                continue
            if not clauses.learn(conflict):
                return
            clauses.back(0)
            found, order = None, []

    def violated(self, found: Point) -> list[int]:
        """Return both answers of each question that a point violates as literals, the worst last, its likelier one too.

        The likelier answer keeps the larger of force and gap.
        """
        force, gap = self.questions.products(found.columns)
        least = np.minimum(force, gap)
        worst = np.argsort(-least, kind="stable")
        worst = worst[least[worst] > ZERO]
        return [2 * int(q) + int(side) for q in worst for side in (force[q] < gap[q], force[q] >= gap[q])][::-1]

    def excluded(self, found: Empty) -> Clause:
        """Return the clause that a proof of emptiness teaches: one of its reasons must not hold."""
        self.leaves += 1
        self.reach = min(self.reach, found.reach)
        return [int(literal) ^ 1 for literal in self.questions.literal[found.reasons]]

    def look(self, found: Point | None) -> tuple[Any, Any, Any] | None:
        """Return displacements and forces where a point is, or leads to, an equilibrium; else None."""
        if found is None:
            return None
        force, gap = self.questions.products(found.columns)
        self.worst = float(np.minimum(force, gap).max(initial=0.0))
        if self.worst > ZERO * max(1.0, float(found.columns.max(initial=0.0))):
            return None
        red, s = self.lp.reduction, self.scaled
        u, (t_n, t_t) = red.displacement(found.t, found.alpha), red.forces(found.t)
        if np.abs(u).max(initial=0.0) < ZERO * s.length:
            u = np.zeros_like(u)  # nothing moves: rounding has no length to be measured by
        if judge(self.problem, u, t_n, t_t, method="exhaustive").solved:
            return u, t_n, t_t
        close = self.settler.settle(s, *s.bring(u, t_n, t_t))
        answer = s.restore(close.u, close.t)
        return answer if judge(self.problem, *answer, method="exhaustive").solved else None

    def branch(self, found: Point | None) -> bool:
        """Decide a question; return False where all are answered.

        Among the conditions the point violates, the one that took part most in recent dead ends; the larger of its
        force and gap stays.
        """
        free = np.array(self.clauses.answer) < 0
        if not free.any():
            return False
        busy = self.clauses.activity / (self.clauses.activity.max(initial=0.0) or 1.0)
        if found is None:
            question = int(np.where(free, busy, -1.0).argmax())
            self.clauses.decide(2 * question + 1)
            return True
        force, gap = self.questions.products(found.columns)
        both = np.minimum(force, gap)
        both /= both.max(initial=0.0) or 1.0
        question = int(np.where(free, busy + 1e-3 * both + (both > ZERO), -1.0).argmax())
        self.clauses.decide(2 * question + int(force[question] >= gap[question]))
        return True
