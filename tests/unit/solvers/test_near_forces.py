"""Forces of redundant corners: load steps and exact path make the same choice."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.lent_compliance import lend
from concio.analysis.path import Stage, run_path
from concio.problem.certificate import certify
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.interior import engine
from concio.solvers.methods import find
from concio.solvers.path.near_forces import Nearby, needed, solve_near

PUSH = 0.4


def dry_wall(courses, blocks, horizontal):
    """Running bond with three pairs at every inner corner, for the two motions a corner has."""
    return concio.running_bond_panel(
        courses=courses,
        blocks=blocks,
        block_size=(1.0, 0.5),
        thickness=1.0,
        block=concio.Elastic(E=1e5, nu=0.15, unit_weight=20.0),
        friction=0.6,
        side_walls=False,
        horizontal=horizontal,
        elements_per_block=(2, 2),
    )


@pytest.fixture(scope="module")
def panel():
    return concio.assemble(dry_wall(5, 4, 1.0))


def stages(steps: int) -> list[Stage]:
    return [Stage("weight", {"dead": 1.0}, steps=1), Stage("push", {"live": PUSH}, steps=steps)]


@pytest.fixture(scope="module")
def exact(panel):
    found = run_path(panel, stages(1))
    assert found.complete
    assert found.certificate <= 1e-9
    assert found.energy_error <= 1e-9
    return found.steps[-1].state


def test_corner_pairs_are_redundant(panel):
    problem = panel.problem()
    assert needed(problem)
    assert np.linalg.matrix_rank(problem.C.toarray()) < 2 * problem.pairs


@pytest.mark.long
def test_steps_go_to_the_exact_path_as_they_shrink(panel, exact):
    """Displacements and forces, those of the redundant pairs too; least-norm forces stay 2 % away at any step."""
    apart = []
    for steps in (4, 16, 64):
        state = run_path(panel, stages(steps), method="steps", solver="interior-point").steps[-1].state
        forces = np.abs(state.normal_force - exact.normal_force).max() / np.abs(exact.normal_force).max()
        motions = np.abs(state.displacement - exact.displacement).max() / np.abs(exact.displacement).max()
        apart.append((forces, motions))
    (f4, u4), (f16, u16), (f64, u64) = apart
    assert f64 < f16 < 0.3 * f4
    assert u64 < u16 < 0.3 * u4
    assert f64 < 1e-4
    assert u64 < 2e-5


def self_stress(panel, problem, t_n, t_t):
    """Forces in equilibrium with themselves at a corner whose three pairs can take them and stick all the same."""
    m, points = problem.pairs, panel.pairs.point
    for point in np.unique(points.round(9), axis=0):
        pairs = np.flatnonzero(np.abs(points - point).max(axis=1) < 1e-6)
        if pairs.size < 3:
            continue
        null = np.linalg.svd(problem.C.toarray()[np.concatenate([pairs, m + pairs])].T)[2][-1]
        for part in (0.1 * null, -0.1 * null):
            left = 0.6 * (t_n[pairs] + part[: pairs.size]) - np.abs(t_t[pairs] + part[pairs.size :])
            if left.min() > 1e-3:
                stress = np.zeros(2 * m)
                stress[np.concatenate([pairs, m + pairs])] = part
                return stress
    pytest.fail("no corner sticks with all its pairs")
    return None


def test_a_step_without_change_changes_no_forces(panel, exact):
    problem = panel.problem({"dead": 1.0, "live": PUSH})
    first = engine.solve(problem)
    assert first.solved
    t_n, t_t = first.normal_force, first.friction_force[:, 0]
    m, stress = problem.pairs, self_stress(panel, problem, t_n, t_t)
    assert np.abs(problem.C.T @ stress).max() <= 1e-12  # no force on any body
    given_n, given_t = t_n + stress[:m], t_t + stress[m:]
    assert ((0.6 * given_n > np.abs(given_t)) | (stress[:m] == 0)).all()
    near = solve_near(problem, first.displacement, given_n, given_t)
    assert near.solved
    assert np.abs(near.normal_force - given_n).max() <= 1e-8
    assert np.abs(near.friction_force[:, 0] - given_t).max() <= 1e-8
    assert np.abs(stress[:m]).max() >= 1e-3


def state_of(solution):
    return solution.displacement, solution.normal_force, solution.friction_force


@pytest.mark.parametrize("dim", [2, 3])
def test_the_next_step_is_found_from_the_last_without_an_iteration(dim):
    """Mortar of a stiffness of its own, so that forces are unique; other loads, the same factors."""
    model = concio.wall(length=1.5, height=0.75, block="rigid", friction=0.6, horizontal=0.2)
    assembly = lend(concio.assemble(model if dim == 2 else concio.extrude(model, 0.3)))
    nearby, problem = Nearby(), assembly.problem({"live": 0.5})
    assert nearby.answer(problem, tuple(np.zeros_like(part) for part in state_of(find("auto")(problem)))) is None
    for factor in (0.51, 0.53):
        last, problem = find("auto")(problem), assembly.problem({"live": factor})
        found, fresh = nearby.answer(problem, state_of(last)), find("interior-point")(problem)
        assert found is not None
        assert found.solved
        assert found.iterations == 0 < fresh.iterations
        assert found.factorisations < fresh.factorisations / 2
        for mine, other in zip(state_of(found), state_of(fresh), strict=True):
            assert np.abs(mine - other).max() <= 1e-9 * np.abs(other).max()


@pytest.mark.parametrize("kept", [False, True])
def test_a_step_counts_what_it_factorises_and_no_other_step(panel, monkeypatch, kept):
    """The softened step and the one without its compliance; what earlier steps factorised with the same is theirs."""
    made, nearby = [], Nearby() if kept else None
    factorise = BlockFactor.factorise

    def counted(self, *args, **options):
        made.append(self)
        return factorise(self, *args, **options)

    monkeypatch.setattr(BlockFactor, "factorise", counted)
    last = state_of(engine.solve(panel.problem({"dead": 1.0, "live": 0.5 * PUSH})))
    for live in (0.5, 0.55, 0.7, -0.7):  # the last one so far away that a try is given up
        made.clear()
        found = solve_near(panel.problem({"dead": 1.0, "live": live * PUSH}), *last, nearby=nearby)
        assert found.solved
        assert found.factorisations == len(made)
        last = state_of(found)
    assert made


def test_a_state_far_away_is_no_excuse_for_a_wrong_answer(panel):
    nearby, problem = Nearby(), panel.problem({"dead": 1.0, "live": PUSH})
    last = state_of(engine.solve(problem))
    for live in (-PUSH, 0.0, 2 * PUSH):
        other = panel.problem({"dead": 1.0, "live": live})
        found = nearby.answer(other, last)
        assert (found is None) == (live != 0.0)
        assert found is None or certify(other, *state_of(found)).worst <= 1e-9


@pytest.mark.long
def test_steps_from_the_last_keep_to_the_exact_path_where_stones_come_loose():
    """From nothing, the last of twenty steps ends in another equilibrium: a loose stone 5 % of the motion away.

    The load ends before the path jumps, at 0.999: what is reached behind a jump is one of several equilibria.
    """
    model = dry_wall(10, 8, 0.5)
    weight = Stage("weight", {"dead": 1.0}, steps=1)
    path = run_path(model, [weight, Stage("push", {"live": 0.99})])
    assert not any(event.kind == "jumps" for event in path.events)
    steps = run_path(model, [weight, Stage("push", {"live": 0.99}, steps=20)], method="steps").steps[-1].state
    exact = path.steps[-1].state
    assert np.abs(steps.displacement - exact.displacement).max() <= 2e-3 * np.abs(exact.displacement).max()
