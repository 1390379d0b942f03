"""Programmes asked for answers below a ceiling alone: the same answer where there is one, an early end else."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

import concio
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.collapse_search import find_collapse_state
from concio.solvers.statics.collapse_state import certify_collapse
from concio.solvers.statics.linear_interior import solve_interior

SEEDS = st.integers(0, 10_000)


def programme(seed: int) -> tuple[np.ndarray, tuple[sp.csc_array, np.ndarray], np.ndarray]:
    """Return a random programme with an answer; some columns have upper bounds, the last one has none at all."""
    rng = np.random.default_rng(seed)
    rows, columns = 6, 20
    A = rng.normal(size=(rows, columns)) * (rng.random((rows, columns)) < 0.6)
    bounds = np.column_stack([np.zeros(columns), np.where(rng.random(columns) < 0.4, 2.0, np.inf)])
    inside = np.minimum(rng.random(columns), bounds[:, 1])
    bounds[-1] = [-np.inf, np.inf]
    y, reduced = rng.normal(size=rows), rng.random(columns)
    reduced[-1] = 0.0
    return A.T @ y + reduced, (sp.csc_array(A), A @ inside), bounds


@pytest.mark.long
@given(SEEDS)
def test_a_ceiling_above_the_optimum_changes_nothing_and_one_below_ends_the_search(seed: int) -> None:
    cost, (A, b), bounds = programme(seed)
    known = linprog(cost, A_eq=A, b_eq=b, bounds=bounds)
    assert known.status == 0
    free = solve_interior(cost, (A, b), bounds)
    assert free is not None
    same = solve_interior(cost, (A, b), bounds, known.fun)
    assert same is not None
    assert np.array_equal(free.x, same.x)
    scale = np.abs(b).max() * np.abs(cost).max()
    assert solve_interior(cost, (A, b), bounds, known.fun - 0.1 * (scale + abs(known.fun))) is None


@given(SEEDS)
def test_a_programme_without_an_answer_ends_early(seed: int) -> None:
    cost, (A, b), bounds = programme(seed)
    closed = sp.csc_array(sp.vstack([A, sp.csr_array(np.r_[np.ones(len(cost) - 1), 0.0][None])]))
    found = solve_interior(cost, (closed, np.append(b, -1.0)), bounds, 10.0)  # a sum of what is positive below zero
    assert found is None


@pytest.mark.long
def test_motions_of_a_wall_are_certified_alike_below_its_bound() -> None:
    wall = concio.wall(length=2.0, height=1.25, block_size=(0.5, 0.25), friction=0.6, horizontal=1.0, block="rigid")
    assembly = concio.assemble(wall)
    dead, live = assembly.problem({"dead": 1.0, "live": 0.0}), assembly.load({"dead": 0.0, "live": 1.0})
    bound = associated_limit(dead, live)
    state = find_collapse_state(dead, live).state
    assert state is not None
    told = certify_collapse(dead, live, state.velocity, 0, bound.upper)
    alone = certify_collapse(dead, live, state.velocity, 0)
    assert told is not None
    assert alone is not None
    assert told.multiplier == pytest.approx(alone.multiplier, rel=1e-9)
    assert told.multiplier <= bound.upper * (1 + 1e-9)
