"""Steps in the plane are settled from states of another step, by small problems on one factor."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.problem.pair_state import Normal, PairStates
from concio.problem.tolerances import STEP_SETTLED
from concio.solvers.interior import engine as interior
from concio.solvers.stepping.problem import StepProblem
from concio.solvers.stepping.settle_step import LinearStep, PairsAsked, Settled, settle
from concio.solvers.stepping.solver import StepSolver
from concio.solvers.stepping.states import across_slip, laws_of_step
from samples import sample

G = 9.81


@pytest.fixture(scope="module")
def problems() -> list[StepProblem]:
    """Return the steps of a stack that rocks and slides."""
    wall = concio.column(blocks=4, width=0.5, height=1.6, block="rigid", friction=0.35, unit_weight=20.0)
    found: list[StepProblem] = []
    step = StepSolver.step

    def kept(self, p, states, x, t):
        found.append(p)
        return step(self, p, states, x, t)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(StepSolver, "step", kept)
        concio.dynamics(wall, concio.Pulse("sine", 0.5 * G, 0.4), duration=0.6, step=5e-3, stop_overturned=False)
    return found


def settled_from(p: StepProblem, states: PairStates) -> Settled:
    """Return a step settled from given states, and zero velocities and forces."""
    solver = StepSolver()
    solver._take(p)
    factor = solver.factor
    assert factor is not None
    x, t = np.zeros(len(p.b)), np.zeros((p.pairs, 2))
    laws = laws_of_step(p, states, across_slip(p, x, t))
    D = laws.blocks()
    factor.factorise(D)
    x, t, errors = LinearStep(laws, factor, D).refined(p, x, t)
    return settle(p, PairsAsked(p, factor), laws, states, x, t, errors)


@pytest.mark.parametrize("closed", [True, False])
def test_a_step_is_settled_from_pairs_that_all_stick_or_are_all_open(problems: list[StepProblem], closed: bool) -> None:
    """Velocities are those of the interior point."""
    used = problems[:: max(1, len(problems) // sample(12, 40))]
    moved = 0
    for p in used:
        normal = np.where(p.active & closed, Normal.CLOSED, Normal.OPEN).astype(np.int8)
        states = PairStates(normal, np.zeros((p.pairs, 1)))
        found = settled_from(p, states)
        assert found.residual < STEP_SETTLED
        assert p.residual(found.x, found.t)[0] == pytest.approx(found.residual, abs=1e-12)
        moved += bool(found.states.differ(states).any())
        other = interior.solve(p.contact_problem()).displacement
        np.testing.assert_allclose(found.x, other, atol=1e-8 * max(float(np.abs(other).max()), p.length))
    assert moved > len(used) // 2
