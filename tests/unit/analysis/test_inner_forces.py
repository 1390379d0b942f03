"""Forces moved inside of what the joint laws allow, and which pairs are about to change with them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import concio
from concio.analysis import inner_forces as inner
from concio.analysis.inner_forces import inner_forces
from concio.analysis.linearised_state import LinearisedState

WALL = {"length": 1.5, "height": 0.75, "block_size": (0.5, 0.25), "friction": 0.4}


@pytest.mark.parametrize("horizontal", [0.05, 0.2])
def test_corners_where_blocks_meet_are_not_about_to_change(horizontal: float) -> None:
    """The least forces leave pairs there at the edge of their cones without slip; other forces hold each of them."""
    result = concio.solve(concio.wall(**WALL, horizontal=horizontal))
    problem, solution = result.assembly.problem(result.factors), result.solution
    touches = np.abs(problem.gap + problem.C_n @ solution.displacement) < 1e-12
    room = 0.4 * solution.normal_force - np.abs(solution.friction_force).ravel()
    assert (touches & (np.abs(problem.C_t @ solution.displacement) < 1e-14) & (room < 1e-9)).any()
    state = LinearisedState.of(result)
    assert not state.about.any()
    left = problem.K @ state.u - problem.f - problem.C_n.T @ state.t_n - problem.C_t.T @ state.t_t.ravel()
    assert np.abs(left).max() < 1e-10 * np.abs(problem.f).sum()
    assert (state.t_n >= 0).all()
    assert (np.abs(state.t_t[:, 0]) <= 0.4 * state.t_n * (1 + 1e-12)).all()
    assert (state.t_n[touches] > 1e-8 * state.force).all()


def test_forces_that_equilibrium_determines_stay() -> None:
    """A block pushed to its limit of friction is about to slide whatever the other forces are."""
    block = concio.column(width=1.0, height=0.5, blocks=1, block="rigid", friction=0.3, horizontal=0.3)
    state = LinearisedState.of(concio.solve(block))
    assert state.about.any()
    problem = state.problem
    t = np.column_stack([state.t_n, state.t_t])
    touches, none = np.ones(problem.pairs, dtype=bool), np.zeros((problem.pairs, 1))
    moved = inner_forces(problem, t, touches, none)
    assert problem.C_n.T @ moved[:, 0] + problem.C_t.T @ moved[:, 1] == pytest.approx(
        problem.C_n.T @ t[:, 0] + problem.C_t.T @ t[:, 1], abs=1e-12 * np.abs(t).max()
    )


def test_in_space_forces_move_inside_of_round_cones() -> None:
    """Two opposite corners carry a slab: the other two are given some of it."""
    ground = concio.Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    slab = concio.Polyhedron.box("slab", (0, 0, 0), (1, 1, 0.2), kind="rigid", material="stone")
    model = concio.Model((ground, slab), {"stone": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.5)},
                         loads=(concio.Load("weight", (0, 0, -1)),))  # fmt: skip
    problem = concio.assemble(model).problem({"dead": 1.0})
    C = problem.C_n.toarray()
    opposite = next(k for k in range(1, problem.pairs) if np.allclose((C[0] + C[k]) * 2.0, -problem.f))
    forces = np.zeros((problem.pairs, 3))
    forces[[0, opposite], 0] = 2.0
    moved = inner_forces(problem, forces, np.ones(problem.pairs, dtype=bool), np.zeros((problem.pairs, 2)))
    assert problem.C_n.T @ moved[:, 0] + problem.C_t.T @ moved[:, 1:].ravel() == pytest.approx(-problem.f, abs=1e-12)
    assert (moved[:, 0] > 1e-5).all()
    assert (np.linalg.norm(moved[:, 1:], axis=1) < 0.5 * moved[:, 0]).all()


def test_forces_that_a_programme_finds_balance_to_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """A linear programme balances to its tolerance: what it leaves is taken off again."""
    result = concio.solve(concio.wall(**WALL, horizontal=0.1))
    problem, solution = result.assembly.problem(result.factors), result.solution
    forces = np.column_stack([solution.normal_force, solution.friction_force])
    rng, exact = np.random.default_rng(5), inner.optimise

    def rough(*asked: Any, **options: Any) -> Any:
        answer = exact(*asked, **options)
        return replace(answer, x=answer.x + 1e-7 * rng.standard_normal(len(answer.x)))

    monkeypatch.setattr(inner, "optimise", rough)
    touches = np.abs(problem.gap + problem.C_n @ solution.displacement) < 1e-12
    moved = inner_forces(problem, forces, touches, np.zeros((problem.pairs, 1)))
    change = moved - forces
    assert np.abs(change).max() > 1e-3 * np.abs(forces).max()
    left = problem.C_n.T @ change[:, 0] + problem.C_t.T @ change[:, 1]
    assert np.abs(left).max() < 1e-12 * np.abs(forces).max()
