"""What statics at large displacements is made of: small frictional problems, slips of turned bodies, moved supports."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
import concio.solvers.stepping.solver as step_solver
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.analysis.motion.step_pairs import relative
from concio.contact.reference import Reference
from concio.kinematics.rigid import rigid_row
from concio.problem.cone import Cone
from concio.problem.pair_state import PairState, PairStates
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import StepProblem
from concio.solvers.stepping.small import by_pivoting, by_states, solve_small
from concio.solvers.stepping.solver import StepSolver
from motion_models import G, standing


@pytest.mark.parametrize("solve", [solve_small, by_states, by_pivoting])
@pytest.mark.parametrize("seed", range(12))
def test_small_problems_obey_the_joint_law(seed, solve):
    """y = q + W t with normals opened by dilatancy, pressed together where crushed; friction against the slip."""
    rng = np.random.default_rng(seed)
    v = int(rng.integers(1, 5))
    B = rng.normal(size=(2 * v, 2 * v + 1))
    W, q = B @ B.T, rng.normal(size=2 * v) - np.tile([0.8, 0.0], v)
    mu = rng.uniform(0.2, 0.8, v)
    tension = rng.uniform(0.0, 0.2, v) * (rng.random(v) < 0.5)
    cohesion = mu * tension + rng.uniform(0.0, 0.3, v)
    cap = np.where(rng.random(v) < 0.5, rng.uniform(0.05, 0.4, v), np.inf)
    dilatancy = rng.uniform(0.1, 0.9, v) * mu
    forces = solve(W, q, Cone(mu, cohesion, tension, cap), dilatancy)
    assert forces is not None
    t_n, t_t = forces.T
    y_n, y_t = (q + W @ forces.ravel()).reshape(v, 2).T
    y_n = y_n - dilatancy * np.abs(y_t)
    small = 1e-9
    assert (t_n >= -tension - small).all()
    assert (t_n <= cap + small).all()
    assert (np.abs(t_t) <= cohesion + mu * t_n + small).all()
    assert (np.minimum(y_n, t_n + tension) <= small).all()
    assert np.abs(y_n[(t_n > -tension + small) & (t_n < cap - small)]).max(initial=0.0) <= small
    assert (y_n[t_n < cap - small] >= -small).all()
    slides = np.abs(y_t) > small
    assert t_t[slides] == pytest.approx((-np.sign(y_t) * (cohesion + mu * t_n))[slides], abs=small)


def test_pairs_without_compliance_of_their_own_are_lent_a_share_of_their_flexibility():
    """A millionth of it, or of a thousandth of the mean; a pair whose own is above a thousandth of that gets none."""
    lent, enough = 1e-6, 1e-3
    weight = np.array([0.01, 0.1, 10.0, 1e7, 0.01])  # of five bodies of one unknown: the flexibilities are 1 / weight
    values = np.stack([np.ones((5, 1)), np.sqrt(2.0) * np.ones((5, 1))], axis=1)
    zero = np.zeros(5)

    def of(own_n, own_t):
        return StepProblem(
            matrix=StepMatrix(sp.csr_array(np.diag(weight))), b=zero, columns=np.arange(5)[:, None], values=values,
            gap=zero, origin=zero[:, None], cone=Cone(zero, zero, zero, zero + np.inf), a_n=own_n, a_t=own_t,
            dilatancy=zero, active=np.ones(5, dtype=bool), force=1.0, length=1.0,
        ).added  # fmt: skip

    share = lent * np.maximum(1.0 / weight, 1e-3 * np.mean(1.0 / weight))
    normal, tangential = of(zero, zero)
    assert normal == pytest.approx(share, rel=1e-12)
    assert tangential == pytest.approx(2.0 * share, rel=1e-12)
    few = np.array([0.0, 1.1, 0.9, 1e9, 0.9]) * enough * share
    normal, tangential = of(few, 0.9 * enough * lent / weight.max() + zero)
    assert normal == pytest.approx(np.where([1, 0, 1, 0, 1], share, 0.0), rel=1e-12)
    assert tangential == pytest.approx(2.0 * share, rel=1e-12)
    assert not np.any(of(1.1 * enough * share.max() + zero, 2.2 * enough * share.max() + zero))
    normal, tangential = of(0.9 * enough * share.max() + zero, zero + 1.0)
    assert normal == pytest.approx(np.where([1, 0, 0, 0, 1], share, 0.0), rel=1e-12)
    assert not tangential.any()


def test_the_flexibility_of_a_pair_in_space_is_one_for_both_tangents():
    """The larger of both: a pair reads its slip in it, whose direction stays."""
    zero, m = np.zeros(2), 2
    values = np.array([[[1.0, 2.0], [0.5, 0.0], [0.0, 3.0]], [[2.0, 0.0], [4.0, 1.0], [1.0, 1.0]]])
    p = StepProblem(
        matrix=StepMatrix(sp.csr_array(np.diag([2.0, 5.0]))), b=zero, columns=np.tile(np.arange(2), (m, 1)),
        values=values, gap=zero, origin=np.zeros((m, 2)), cone=Cone(zero, zero, zero, zero + np.inf), a_n=zero,
        a_t=zero, dilatancy=zero, active=np.ones(m, dtype=bool), force=1.0, length=1.0,
    )  # fmt: skip
    by_hand = [[1 / 2 + 4 / 5, 9 / 5, 9 / 5], [4 / 2, 16 / 2 + 1 / 5, 16 / 2 + 1 / 5]]
    assert p.flexibility == pytest.approx(np.array(by_hand), rel=1e-14)
    assert not p.dilates
    assert replace(p, dilatancy=np.array([0.0, 0.1])).dilates


def test_pivoting_goes_on_from_the_states_a_step_has_reached(monkeypatch):
    """Where nothing else ends, pairs that slip are handed on as slipping, not as crushed."""
    arm = np.array([[-0.5, -1.0], [0.5, -1.0]])
    values = np.stack([rigid_row(np.broadcast_to(direction, arm.shape), arm, 1.0) for direction in np.eye(2)[::-1]], 1)
    zero, m = np.zeros(2), 2
    p = StepProblem(
        matrix=StepMatrix(sp.csr_array(np.diag([2.0, 2.0, 0.7]))), b=np.array([4.0, -5.0, 0.3]),
        columns=np.tile(np.arange(3), (m, 1)), values=values, gap=zero, origin=np.zeros((m, 1)),
        cone=Cone(np.full(m, 0.3), zero, zero, np.full(m, np.inf)), a_n=zero, a_t=zero, dilatancy=zero,
        active=np.ones(m, dtype=bool), force=5.0, length=2.0,
    )  # fmt: skip
    all_closed = PairStates.plane(np.ones(m), zero)
    answer = StepSolver().step(p, all_closed, np.zeros(3), np.zeros((m, 2)))
    assert answer.residual < 1e-12
    assert (answer.states.code == PairState.SLIP).all()

    handed = []
    near = SimpleNamespace(
        displacement=answer.x, normal_force=answer.t[:, 0] + 1e-6, friction_force=answer.t[:, 1:] - 3e-7
    )
    pivot = step_solver.sparse_lemke.solve
    monkeypatch.setattr(step_solver, "STEP_FACTORISATIONS", 0)
    monkeypatch.setattr(step_solver.interior, "solve", lambda _: near)
    monkeypatch.setattr(
        step_solver.sparse_lemke, "solve", lambda problem, **known: handed.append(known) or pivot(problem, **known)
    )
    found = StepSolver().step(p, all_closed, np.zeros(3), np.zeros((m, 2)))
    assert (handed[0]["start_states"].code == PairState.SLIP).all()
    assert found.how == "pivoting"
    assert found.residual < 1e-12
    assert found.x == pytest.approx(answer.x, abs=1e-12)


def test_turned_blocks_slip_by_what_their_points_move_along_the_joint():
    """First order from the rows, the rest from finite rotations: together the chords of the points of both sides."""
    stack = concio.column(width=0.4, height=1.2, blocks=2, block="rigid", friction=0.5)
    statics = Statics(Reference.of(stack, G), Scheme(), {})
    rest = MotionState.at_rest(statics.reference)
    look = statics.look(rest, rest.memory, np.zeros(0), 0.0)
    before = statics.moved(rest, np.array([2e-4, 1e-4, 5e-4, 1e-4, 0.0, -2e-4]), look)
    look = statics.look(before, look.memory, np.zeros(0), 0.0)
    x = np.array([0.03, -0.02, 0.2, -0.01, 0.04, -0.3])
    after = statics.moved(before, x, look)

    def chord(body):
        w = after.rotation[body] - before.rotation[body]
        arm = look.point - before.centre[body]
        turned = np.column_stack([np.cos(w) * arm[:, 0] - np.sin(w) * arm[:, 1], np.sin(w) * arm[:, 0]])
        turned[:, 1] += np.cos(w) * arm[:, 1]
        return after.centre[body] - before.centre[body] + turned - arm

    slots = statics.maker.slots
    assert np.abs((after.rotation - before.rotation)[1:]).min() > 0.1
    tangent = look.frame[:, 1]
    exact = ((chord(slots.body_b) - chord(slots.body_a)) * tangent).sum(1)
    first = relative(look.data.columns, look.data.values, x)[:, 1]
    assert len(exact) == 4
    assert np.abs(exact - first).min() > 1e-4
    assert first + statics.swung(look, before, after)[:, 0] == pytest.approx(exact, abs=1e-12)
    assert not statics.swung(look, before, before).any()


def test_a_support_moves_by_the_multiplier_times_the_factor_of_its_group():
    model = standing(1.0, 0.5, friction=0.2)
    pull = concio.Support("pull", "block", directions="x", displacement=(0.03, 0.0), group="live")
    load = concio.Load("weight", (0.01, 0.0), bodies=("block",), group="live")
    model = replace(model, supports=(pull,), loads=(*model.loads, load))
    found = concio.push(model, live="live", control="load", step=0.25, until=0.5, factors={"live": 2.0})
    assert found.multiplier[-1] == pytest.approx(0.5)
    assert found.centre[-1, 1, 0] - found.centre[0, 1, 0] == pytest.approx(0.5 * 2.0 * 0.03, rel=1e-6)
