"""Round cones: certified answers, collapse proven, motions that never end, nothing that depends on the frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

import concio
from concio.kinematics.rigid import rotation_matrix
from concio.problem.solution import Departure, Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.auto.strategies import best_point_met
from concio.solvers.interior.interior_point import InteriorPoint
from concio.solvers.interior.newton import NewtonStep, Products
from concio.solvers.interior.point import Residuals
from concio.solvers.interior.run import STARTS, Run, starts_for
from concio.solvers.methods import find
from concio.solvers.relaxation import slow_step as one_step
from concio.solvers.relaxation.single_steps import at_once
from concio.solvers.relaxation.slow_motion import relax
from concio.solvers.states.redundant_forces import least_forces
from concio.solvers.states.state_reading import Finished, natural_residual, read_states
from concio.solvers.statics.associated_limit import associated_limit
from space_problems import barrel, dome, wall

TURN = rotation_matrix(np.array([0.4, -1.1, 0.7]))
STIFF = {"kn": 1e3}


def relative(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


CASES = {
    "rigid blocks, joints with stiffness": lambda: wall(3, 4, **STIFF).at(0.4),
    "elastic blocks": lambda: wall(3, 4, elastic=True).at(0.4),
    "wedged between sides, without a base": lambda: wall(4, 4, elastic=True, sides=True).at(0.0),
    "dome": lambda: dome(4, 8, **STIFF).at(0.2),
    "elastic barrel": lambda: barrel(8, 3, elastic=True).at(0.1),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["interior-point", "alart-curnier"])
def test_answers_are_certified_and_two_methods_agree(name: str, method: str) -> None:
    problem = CASES[name]()
    found = find(method)(problem)
    assert found.solved
    reference = find("auto")(problem)
    assert reference.certificate.worst < 1e-11
    assert relative(found.displacement, reference.displacement) < 1e-7


@pytest.mark.parametrize("elastic", [False, True])
def test_turning_the_structure_in_space_changes_nothing(elastic: bool) -> None:
    options = {"elastic": True} if elastic else STIFF
    there = find("auto")(wall(3, 3, leaves=2, direction=(0.6, 0.8, 0.0), **options).at(0.15))
    turned = find("auto")(wall(3, 3, leaves=2, direction=(0.6, 0.8, 0.0), turned=TURN, **options).at(0.15))
    assert there.solved
    assert turned.solved
    if elastic:
        moved = (there.displacement.reshape(-1, 3) @ TURN.T).ravel()
        assert relative(turned.displacement, moved) < 1e-9
    assert relative(turned.normal_force, there.normal_force) < 1e-9
    size = [np.linalg.norm(a.friction_force, axis=1) for a in (turned, there)]
    assert relative(*size) < 1e-9


def test_forces_of_redundant_pairs_are_the_least_of_all() -> None:
    """Any self-stress that the laws allow may be added; the answer does not change by it, and no other is smaller."""
    problem = wall(3, 3, leaves=2, elastic=True, direction=(0.6, 0.8, 0.0)).at(0.15)
    s = scale(problem)
    found = find("interior-point")(problem)
    u, t = s.bring(found.displacement, found.normal_force, found.friction_force)
    inside = np.flatnonzero((t[:, 0] > 0.02) & (np.linalg.norm(t[:, 1:], axis=1) < 0.9 * 0.6 * t[:, 0]))
    idle = null_space(s.C[(3 * inside[:, None] + np.arange(3)).ravel()].T.toarray())
    assert idle.shape[1] >= 3
    rng = np.random.default_rng(2)
    norm = float((t * t / s.share[:, None]).sum())
    for _ in range(3):
        other = t.copy()
        other[inside] += 1e-3 * (idle @ rng.standard_normal(idle.shape[1])).reshape(-1, 3)
        error, _ = natural_residual(s, u, other)
        assert error < 1e-11
        assert float((other**2 / s.share[:, None]).sum()) > norm
        point = Finished(u, other, read_states(s, u, other), error, 0, np.zeros(0, dtype=int))
        assert np.abs(least_forces(s, point).t - t).max() < 1e-9 * np.abs(t).max()


def test_every_joint_law_in_space() -> None:
    problem = wall(3, 3, leaves=2, kn=1e3, direction=(0.6, 0.8, 0.0)).at(0.1)
    m, rng = problem.pairs, np.random.default_rng(5)
    law = replace(
        problem.laws,
        tension=0.01 * rng.random(m),
        cohesion=0.02 + 0.03 * rng.random(m),
        dilatancy=0.3 * rng.random(m),
        cap=0.05 + 2.0 * rng.random(m),
    )
    gap, origin = 1e-5 * rng.normal(size=m), 1e-5 * rng.normal(size=(m, 2))
    found = find("auto")(replace(problem, laws=law, gap=gap, slip_origin=origin))
    assert found.solved
    assert found.certificate.worst < 1e-10
    assert (found.normal_force > law.cap - 1e-9).any(), "no pair is crushed"
    assert (found.normal_force < -1e-4).any(), "no pair is pulled"


@pytest.mark.parametrize("share", [0.97, 0.99, 1.01])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_near_the_limit(share: float, direction: tuple[float, float, float]) -> None:
    built = wall(3, 4, kn=1e3, direction=direction)
    limit = associated_limit(built.problem, built.live)
    assert limit.checked
    found = find("auto")(built.at(share * limit.multiplier))
    if share < 1.0:
        assert found.solved
        return
    assert found.status is Status.NO_EQUILIBRIUM
    assert found.mechanism is not None
    assert found.mechanism.violation < 1e-11
    assert found.mechanism.power > 0


@pytest.mark.long
def test_between_the_limits_letting_go_decides() -> None:
    """A wall of headers: associated flow carries more than Coulomb friction does; forces exist, no state was found."""
    built = wall(5, 6, leaves=3, kn=1e3)
    limit = associated_limit(built.problem, built.live)
    assert limit.checked
    found = find("auto")(built.at(0.9 * limit.multiplier))
    assert found.status is Status.COLLAPSES
    assert found.departure is not None
    assert found.departure.certified
    assert found.info["strategy"] == "release, single steps"
    assert any("statically admissible forces exist" in line for line in found.trace)


def test_single_long_steps_from_rest_show_the_motion_that_never_ends() -> None:
    """Between the Coulomb and the associated limit they move away; under half the load they come to rest."""
    built = wall(6, 6, kn=1e3)
    limit = associated_limit(built.problem, built.live).multiplier
    moves = at_once(Run(scale(built.at(0.995 * limit))))
    assert isinstance(moves, Departure)
    assert moves.certified
    rests = at_once(Run(scale(built.at(0.5 * limit))))
    assert isinstance(rests, Finished)


@pytest.mark.long
def test_a_dome_close_to_its_limit_moves_away() -> None:
    """Only the small steps from the longest one solved show the motion."""
    built = dome(6, 16, kn=1e3)
    limit = associated_limit(built.problem, built.live).multiplier
    moves = at_once(Run(scale(built.at(0.985 * limit))))
    assert isinstance(moves, Departure)
    assert moves.certified


def test_letting_go_ends_after_the_work_that_is_allowed(monkeypatch) -> None:
    built = wall(4, 6, **STIFF)
    limit = associated_limit(built.problem, built.live).multiplier
    monkeypatch.setattr(one_step, "MOST_WORK", 1)
    monkeypatch.setattr(one_step, "LEAST_WORK", 1)
    for follow, said in ((at_once, "single steps down to a resistance of 1e-02, no end"), (relax, "1 steps of slow")):
        run = Run(scale(built.at(0.995 * limit)))
        assert follow(run) is None
        assert said in run.trace[-1]


def test_stiff_joints_start_from_nearby_and_hard_ones_from_far() -> None:
    """Both orders hold the same starts; the first one differs."""
    soft, hard = starts_for(scale(wall(2, 2, **STIFF).problem)), starts_for(scale(wall(2, 2, elastic=True).problem))
    assert set(soft) == set(hard) == set(STARTS)
    assert (soft[0].length, hard[0].length) == (10.0, 100.0)


def test_a_run_from_nearby_begins_inside_the_cones_and_ends_sooner() -> None:
    structure = wall(4, 5, leaves=2, direction=(0.6, 0.8, 0.0), **STIFF)
    here, there = structure.at(0.10), structure.at(0.14)
    state = find("auto")(here)
    s = scale(there)
    u, t = s.bring(state.displacement, state.normal_force, state.friction_force)
    z = InteriorPoint(s).near(u, t)
    assert z.t[:, 0].min() > 0
    assert z.y_n.min() > 0
    assert (s.cone.strength(z.t[:, 0]) > np.linalg.norm(z.t[:, 1:], axis=1)).all()
    assert (z.eta[:, 0] > np.linalg.norm(z.eta[:, 1:], axis=1)).all()
    near, far = Run(s), Run(s)
    found, other = near.from_near(u, t), far.from_start(STARTS[0])
    assert found is not None
    assert other is not None
    assert relative(found.u, other.u) < 1e-9
    assert near.iterations < far.iterations


def test_newton_direction_solves_the_linearised_equations() -> None:
    """What the elimination returns is checked against the equations before any is eliminated."""
    s = scale(dome(3, 8, **STIFF).at(0.1))
    it = InteriorPoint(s)
    z, _ = it.run(it.start(10.0, 100.0), most=3, target=0.0)
    for theta in (0.0, 1.0):
        dilatancy = it.dilatancy(theta)
        residuals = Residuals.of(s, z, dilatancy)
        newton = NewtonStep.at(s, z, residuals, dilatancy, 1e-13)
        assert newton is not None
        rc_n = 0.3 - z.t[:, 0] * z.y_n
        d = newton.direction(Products(rc_n, np.zeros_like(z.t), None if newton.products.q is None else 0.0 * rc_n))
        assert d is not None
        size = max(float(np.abs(d.u).max()), 1.0)
        assert np.abs(s.elastic(d.u) - s.pull(d.t) + residuals.u).max() < 1e-8
        moved = s.along(d.u) + s.compliance * d.t
        moved[:, 0] -= dilatancy * d.eta[:, 0]
        assert np.abs(moved[:, 0] - d.y_n + residuals.n).max() < 1e-9 * size
        assert np.abs(moved[:, 1:] - d.eta[:, 1:] + residuals.t).max() < 1e-9 * size
        assert np.abs(z.t[:, 0] * d.y_n + z.y_n * d.t[:, 0] - rc_n).max() < 1e-9 * size


def test_a_model_in_space_is_solved_and_hard_joints_keep_their_exact_answer() -> None:
    plane = concio.wall(length=2.0, height=1.0, block="rigid", horizontal=0.2)
    result = concio.solve(concio.extrude(plane, 0.3))
    assert result.solved
    assert result.lent_compliance > 0
    assert not result.displacement.any(), "rigid blocks on hard joints do not move"
    weight = result.contacts.force_on_b
    assert weight.shape[1] == 3


def test_sliding_joints_of_rigid_blocks_have_their_limit() -> None:
    """Nothing moves in the limit of stiff joints, and the forces are certified there, though solves do not reach it."""
    model = concio.walls(
        lines=[((0, 0), (0, 1.5)), ((0, 0), (1.5, 0)), ((0, 1.5), (1.5, 1.5))], height=1.5,
        block_size=(0.5, 0.25, 0.25), block="rigid", friction=0.3, horizontal=1.0, towards=(-1, 0),
    )  # fmt: skip
    result = concio.solve(model, factors={"live": 0.15})
    assert result.solved
    assert result.assembly.lent_compliance == 0.0
    assert result.attention == ()


def test_collapse_of_a_model_in_space() -> None:
    tall = concio.column(width=0.5, height=3.0, blocks=3, block="rigid", friction=0.6, horizontal=0.3)
    result = concio.solve(concio.extrude(tall, 0.4), on_failure="return")
    assert result.status is Status.NO_EQUILIBRIUM
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(concio.extrude(tall, 0.4))


def test_the_best_point_met_is_an_answer_only_where_it_is_certified() -> None:
    """Newton's method left it at 1e-11, which the certificate grants; at 1e-3 it does not."""
    run = Run(scale(wall(3, 3, **STIFF).at(0.2)))
    assert best_point_met(run) is None
    found = run.from_start(STARTS[2])
    assert found is not None
    for size, solved in ((1e-11, True), (1e-3, False)):
        run.best = replace(found, u=found.u * (1 + size), error=size)
        assert (best_point_met(run) is not None) is solved


@pytest.mark.parametrize("build", [lambda: wall(2, 3, elastic=True).at(0.4), lambda: wall(2, 3, **STIFF).at(0.4)])
def test_a_direction_meets_both_of_its_equations(build, monkeypatch: pytest.MonkeyPatch) -> None:
    """Balance and opening, written out again: refinement ends where both are met, not where one is."""
    missed = []
    solve = NewtonStep.increments

    def watched(self: NewtonStep, r: np.ndarray, b: np.ndarray):
        found = solve(self, r, b)
        assert found is not None
        (du, dt), s = found, self.s
        balance = r - s.K @ du + s.C.T @ dt.ravel()
        opening = b - (s.C @ du).reshape(dt.shape) - np.einsum("mij,mj->mi", self.H, dt)
        missed.append(max(np.abs(balance).max(), np.abs(opening[s.rough]).max() / self.residuals.length) / self.enough)
        return found

    monkeypatch.setattr(NewtonStep, "increments", watched)
    Run(scale(build())).from_start(STARTS[0])
    assert len(missed) > 5
    assert max(missed) < 1.5
