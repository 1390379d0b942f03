"""The smooth equations that a certified state solves while its pairs keep their states, and their linear answers.

Balance, and of every pair whether it is closed, open or crushed, sticks or slips;
:mod:`concio.analysis.state_sensitivity` asks them how a state changes with a number of the model.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from concio.analysis.inner_forces import inner_forces
from concio.analysis.lent_compliance import lend
from concio.errors import InputError
from concio.problem.contact_problem import ContactProblem
from concio.read_only import read_only
from concio.solvers.methods import find

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.problem.solution import Solution

Array = np.ndarray

ABOUT = 1e-8
"""A pair is about to change where what keeps it in its state is below this share of the largest of its kind."""
SOLVED = 1e-9
"""Largest relative error of the linear equations of a derivative."""
SOFT, ROUNDS = 1e-8, 20
"""Compliance added to closed joints of the scaled equations, which corrections remove, and these at most."""
ROUNDING = 1e-12
"""Change of r, beside forces or displacements, that is rounding."""
HUGE, OPEN = 1e12, 1e-6
"""Motions this large say that a structure moves; forces of this share in a null vector are not determined."""


@dataclass(frozen=True, eq=False)
@read_only
class Rates:
    """Derivatives of a state to one side.

    Parameters
    ----------
    displacement : (N,) array
        Of the free unknowns [m/unit].
    normal_force : (m,) array
        [kN/unit].
    friction_force : (m, d-1) array
        [kN/unit]; ``nan`` where the forces of a state are not determined, as at corners where several joints meet.
    """

    displacement: Array
    normal_force: Array
    friction_force: Array


@dataclass(frozen=True, eq=False)
class LinearisedState:
    """An answer with the states of its pairs."""

    problem: ContactProblem
    u: Array
    t_n: Array
    t_t: Array
    closed: Array
    crushed: Array
    sticks: Array
    about: Array

    @classmethod
    def of(cls, result: Result) -> LinearisedState:
        """Return that of a certified step, with the states that its forces and gaps show."""
        problem, solution = yielding_problem(result)
        t_t = np.asarray(solution.friction_force).reshape(problem.pairs, problem.dim - 1)
        state = cls._read(problem, np.asarray(solution.displacement), np.asarray(solution.normal_force), t_t)
        return state._inside() if state.about.any() else state

    @classmethod
    def _read(cls, problem: ContactProblem, u: Array, t_n: Array, t_t: Array) -> LinearisedState:
        """Return the states that forces and gaps show."""
        law = problem.laws
        slip = _slip(problem, u, t_t)
        moved = np.linalg.norm(slip, axis=1)
        gap = problem.gap + problem.C_n @ u + law.normal_compliance * t_n - law.dilatancy * moved
        room = problem.cone.linear_strength(t_n) - np.linalg.norm(t_t, axis=1)
        force = float(np.abs(t_n).max(initial=0.0)) or 1.0
        far = max(float(np.abs(u).max(initial=0.0)), float(np.abs(gap).max(initial=0.0))) or 1.0
        press, under = (t_n + law.tension) / force, np.where(np.isfinite(law.cap), law.cap - t_n, np.inf) / force
        closed = press >= gap / far
        crushed = closed & (under < -gap / far)
        sticks = room / force >= moved / far
        held = np.maximum(press, gap / far)
        stuck = np.maximum(room / force, moved / far)
        edge = np.where(np.isfinite(under), np.maximum(under, -gap / far), 1.0)
        radius = problem.cone.linear_strength(t_n) > ABOUT * force
        about = (held < ABOUT) | (closed & (edge < ABOUT)) | (radius & (stuck < ABOUT))
        return cls(problem, u, t_n, t_t, closed, crushed, sticks & closed, about)

    def _inside(self) -> LinearisedState:
        """Return this state with forces that equilibrium leaves open moved away from where pairs change."""
        (way, size), law = self.way, self.problem.laws
        gap = self.problem.gap + self.problem.C_n @ self.u + law.normal_compliance * self.t_n - law.dilatancy * size
        touches = (np.abs(gap) < ABOUT * self.far) & ~self.crushed
        moves = np.where((size > ABOUT * self.far)[:, None], way, 0.0)
        inner = inner_forces(self.problem, np.column_stack([self.t_n, self.t_t]), touches, moves)
        other = self._read(self.problem, self.u, inner[:, 0], inner[:, 1:])
        return other if other.about.sum() < self.about.sum() else self

    def with_states_of(self, other: Result) -> LinearisedState:
        """Return this answer with the states of the pairs that are about to change as another answer has them."""
        if not other.solved or len(other.solution.normal_force) != self.problem.pairs:
            msg = "the model beside this one has no certified state with the same joints"
            raise InputError(msg)
        beside, pick = LinearisedState.of(other), self.about
        return replace(
            self,
            closed=np.where(pick, beside.closed, self.closed),
            crushed=np.where(pick, beside.crushed, self.crushed),
            sticks=np.where(pick, beside.sticks, self.sticks),
        )

    @property
    def force(self) -> float:
        """Size of the contact forces [kN]."""
        return float(np.abs(self.t_n).max(initial=0.0)) or 1.0

    @property
    def far(self) -> float:
        """Size of the displacements [m]."""
        return float(np.abs(self.u).max(initial=0.0)) or 1.0

    @property
    def way(self) -> tuple[Array, Array]:
        """Directions (m, d-1) and sizes (m,) of slips; the direction of none opposes its friction."""
        slip = _slip(self.problem, self.u, self.t_t)
        size = np.linalg.norm(slip, axis=1)
        pull = np.linalg.norm(self.t_t, axis=1)
        by_force = -self.t_t / np.where(pull > 0, pull, 1.0)[:, None]
        return np.where((size > 0)[:, None], slip / np.where(size > 0, size, 1.0)[:, None], by_force), size

    def residual(self, problem: ContactProblem) -> Array:
        """Return r of this answer in the equations of a model near its own, in the order of the unknowns."""
        law, way = problem.laws, self.way[0]
        balance = problem.K @ self.u - problem.f - problem.C_n.T @ self.t_n - problem.C_t.T @ self.t_t.ravel()
        slip = _slip(problem, self.u, self.t_t)
        moved = np.where(self.sticks, 0.0, (way * slip).sum(axis=1))
        gap = problem.gap + problem.C_n @ self.u + law.normal_compliance * self.t_n - law.dilatancy * moved
        normal = np.where(self.crushed, self.t_n - np.where(self.crushed, law.cap, 0.0),
                          np.where(self.closed, gap, self.t_n + law.tension))  # fmt: skip
        radius = problem.cone.linear_strength(self.t_n)
        now = slip / np.where(np.linalg.norm(slip, axis=1) > 0, np.linalg.norm(slip, axis=1), 1.0)[:, None]
        turned = now if self.problem.dim == 3 else way
        along = np.where(self.sticks[:, None], slip, self.t_t + radius[:, None] * turned)
        return np.concatenate([balance, normal, along.ravel()])

    def is_rounding(self, change: Array) -> bool:
        """Return whether a change of r is no more than rounding of forces, and of motions, leaves."""
        closed = self.closed & ~self.crushed
        motions = np.concatenate([np.zeros(self.problem.unknowns, bool), closed,
                                  np.repeat(self.sticks, self.problem.dim - 1)])  # fmt: skip
        inner = float(np.abs(self.problem.K @ self.u).max(initial=0.0)) + self.force
        return bool(np.abs(change[motions]).max(initial=0.0) <= ROUNDING * self.far
                    and np.abs(change[~motions]).max(initial=0.0) <= ROUNDING * inner)  # fmt: skip

    def rates(self, slope: Array) -> Rates:
        """Return dz/dp for dr/dp.

        Raises
        ------
        InputError
            The equations have no answer: the structure can move with these states.
        """
        n, m = self.problem.unknowns, self.problem.pairs
        z = self._equations.answer(-slope)
        return Rates(z[:n], z[n : n + m], z[n + m :].reshape(m, self.problem.dim - 1))

    @cached_property
    def _equations(self) -> _Equations:
        columns = np.repeat([self.far, self.force], [self.problem.unknowns, self.problem.pairs * self.problem.dim])
        return _Equations(self.jacobian(), columns, self.problem.unknowns)

    def jacobian(self) -> sp.csr_array:
        """Return dr/dz."""
        p, law = self.problem, self.problem.laws
        m, s = p.pairs, p.dim - 1
        way, size = self.way
        spread = sp.csr_array((way.ravel(), (np.repeat(np.arange(m), s), np.arange(m * s))), shape=(m, m * s))
        sticks, slips = self.sticks.astype(float), 1.0 - self.sticks
        gaps = (self.closed & ~self.crushed).astype(float)
        one = sp.diags_array
        dilates = one(gaps * slips * law.dilatancy) @ spread
        soft = one(np.repeat(law.tangential_compliance, s))
        pressed = one(gaps * law.normal_compliance + (1.0 - gaps))
        normal = [one(gaps) @ p.C_n - dilates @ p.C_t, pressed, -dilates @ soft]
        radius = p.cone.linear_strength(self.t_n)
        bend = np.where(slips * size > 0, radius / np.where(size > 0, size, 1.0), 0.0)
        across = one(np.repeat(bend, s)) @ (sp.eye_array(m * s) - spread.T @ spread) if s > 1 else sp.csr_array((m, m))
        stuck, moves = one(np.repeat(sticks, s)), one(np.repeat(slips, s))
        tangent = [
            stuck @ p.C_t + moves @ across @ p.C_t, moves @ spread.T @ one(law.friction),
            stuck @ soft + moves @ (sp.eye_array(m * s) + across @ soft),
        ]  # fmt: skip
        return sp.csr_array(sp.block_array([[p.K, -p.C_n.T, -p.C_t.T], normal, tangent]))


def yielding_problem(result: Result) -> tuple[ContactProblem, Solution]:
    """Return the problem of a step and its answer; of hard joints of rigid blocks with the compliance added to them.

    Raises
    ------
    InputError
        With that compliance there is no answer.
    """
    if not result.lent_compliance or result.assembly.lent_compliance:
        return result.assembly.problem(result.factors), result.solution
    problem = lend(result.assembly).problem(result.factors)
    solution = find("auto")(problem)
    if not solution.solved:
        msg = "the state with a compliance added to hard joints was not found again"
        raise InputError(msg)
    return problem, solution


def _slip(problem: ContactProblem, u: Array, t_t: Array) -> Array:
    """Return y_t (m, d-1) of displacements and friction forces [m]."""
    slip = (problem.C_t @ u).reshape(problem.pairs, problem.dim - 1) + problem.laws.tangential_compliance[:, None] * t_t
    origin = problem.slip_origin
    found: Array = slip if origin is None else slip - np.asarray(origin).reshape(slip.shape)
    return found


class _Equations:
    """The equations dr/dz x = wanted, scaled, with a factor that forces which nothing determines do not stop.

    Parameters
    ----------
    J : (n + m d, n + m d) sparse array
    columns : (n + m d,) array
        Size of each unknown.
    n : int
        Unknowns that are displacements.

    Raises
    ------
    InputError
        The structure can move.
    """

    def __init__(self, J: sp.csr_array, columns: Array, n: int) -> None:
        scaled = sp.csc_array(J @ sp.diags_array(columns))
        self.columns, self.rows = columns, 1.0 / np.maximum(abs(scaled).max(axis=1).toarray().ravel(), 1e-300)
        self.J = sp.csc_array(sp.diags_array(self.rows) @ scaled)
        soft = SOFT * (np.arange(len(columns)) >= n)
        msg = "the structure can move with the states that its joints have"
        try:
            self.factor = spl.splu(sp.csc_array(self.J + sp.diags_array(soft)))
        except RuntimeError:
            raise InputError(msg) from None
        null = self.factor.solve(np.random.default_rng(0).standard_normal(len(columns)))
        if not np.isfinite(null).all() or np.abs(null[:n]).max(initial=0.0) > HUGE:
            raise InputError(msg)
        null /= np.abs(null).max(initial=1e-300)
        for _ in range(6):  # what is determined fades, what is not stays
            null = self.factor.solve(soft * null)
        self.open = (np.abs(null) > OPEN) & (soft > 0)

    def answer(self, wanted: Array) -> Array:
        """Return x, ``nan`` where it is not determined.

        Raises
        ------
        InputError
            There is none.
        """
        right = self.rows * wanted
        size, x = float(np.abs(right).max(initial=0.0)) or 1.0, np.zeros(len(right))
        left = right
        for _ in range(ROUNDS):
            x = x + self.factor.solve(left)
            new = right - self.J @ x
            done, left = not np.abs(new).max(initial=0.0) < 0.5 * np.abs(left).max(initial=0.0), new
            if done:
                break
        if not np.isfinite(x).all() or float(np.abs(left).max(initial=0.0)) > SOLVED * size:
            msg = "the states of the joints do not determine how the answer changes"
            raise InputError(msg)
        found: Array = np.where(self.open, np.nan, self.columns * x)
        return found
