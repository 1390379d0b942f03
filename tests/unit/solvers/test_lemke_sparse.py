"""Pivoting on the states of the pairs: laws, warm starts, jammed arches, falls, rigid bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from concio.contact.assembly import assemble
from concio.errors import InputError, MethodError
from concio.model.generate.panel import running_bond_panel
from concio.problem.certificate import certify
from concio.problem.pair_state import Normal, PairState, PairStates
from concio.problem.solution import Status, pair_states
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.updated_factor import UpdatedFactor
from concio.solvers.methods import find
from concio.solvers.pivoting.covering import cover_point, named_states
from concio.solvers.pivoting.pair_rows import PairSystem
from concio.solvers.pivoting.sparse_lemke import solve
from concio.solvers.pivoting.state_path import StatePath
from contact_problems import rigid, wall
from lcp_problems import small_wall
from samples import first, sample


def test_rows_replaced_one_by_one_give_the_inverse_of_the_new_matrix() -> None:
    rng = np.random.default_rng(0)
    n = 40
    dense = np.where(rng.random((n, n)) < 0.15, rng.normal(size=(n, n)), 0.0) + 3 * np.eye(n)

    def row(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.flatnonzero(values), values[values != 0]

    factor = UpdatedFactor([row(r) for r in dense], refresh=7)
    for k in range(30):
        place = int(rng.integers(n)) if k % 3 else 5  # some places more than once
        new = np.where(rng.random(n) < 0.2, rng.normal(size=n), 0.0)
        new[place] += 3.0
        dense[place] = new
        factor.replace(place, row(new))
        b = rng.normal(size=n)
        np.testing.assert_allclose(factor.solve(b), np.linalg.solve(dense, b), atol=1e-8)
        np.testing.assert_allclose(factor.column(3), np.linalg.solve(dense, np.eye(n)[3]), atol=1e-8)
    assert factor.factorisations > 1
    np.testing.assert_array_equal(factor.matrix().toarray(), dense)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_digits_survive_a_nearly_singular_matrix_on_the_way(unit: float) -> None:
    """In any unit; a matrix that was never nearly singular is not factorised again."""
    rng = np.random.default_rng(1)
    n = 30
    dense = unit * rng.normal(size=(n, n))
    good = dense[7].copy()
    everything = np.arange(n)
    regular = UpdatedFactor([(everything, row.copy()) for row in dense])
    regular.replace(7, (everything, good[::-1]))
    regular.column(8)
    assert regular.factorisations == 1
    dense[7] = dense[8] + 1e-12 * good  # singular but for the last digits
    factor = UpdatedFactor([(everything, row.copy()) for row in dense])
    factor.replace(7, (everything, good))
    dense[7] = good
    wanted = np.linalg.solve(dense, np.eye(n)[8])
    np.testing.assert_allclose(factor.column(8), wanted, rtol=0, atol=1e-11 / unit)
    assert factor.factorisations == 2


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 1000),
    st.sets(st.sampled_from(["cohesion", "tension", "dilatancy", "springs", "cap", "gap", "origin"])),
    st.floats(0.0, 0.5),
    st.floats(0.2, 1.2),
)
def test_every_answer_is_certified_or_a_proven_fall(seed: int, laws: set[str], alpha: float, mu: float) -> None:
    problem = small_wall(seed, *sorted(laws), alpha=alpha, mu=mu)
    answer = solve(problem)
    assert answer.status in (Status.SOLVED, Status.NO_EQUILIBRIUM, Status.UNDECIDED)
    if answer.solved:
        assert answer.certificate.worst <= 1e-9
    if "dilatancy" not in laws and "cap" not in laws and alpha <= 0.2 and mu >= 0.5:
        assert answer.solved, answer.trace


def test_the_ground_holds_each_rigid_motion_by_a_pair_of_its_own() -> None:
    """Its row of C is nothing along the normal and the motion itself along the tangent; it has no cap, no strength."""
    s = scale(wall(2, 2, sides=True))
    system = PairSystem(s, ground=True)
    r = s.problem.rigid_motions
    own = system.C[2 * s.pairs :].toarray()
    assert own.shape == (2 * r, len(s.f))
    assert not own[0::2].any()
    np.testing.assert_array_equal(own[1::2], s.problem.R.T.toarray())
    assert (system.C[: 2 * s.pairs] != s.C).nnz == 0
    assert (system.m, system.size) == (s.pairs + r, len(s.f) + 2 * (s.pairs + r) + 1)
    assert (system.x[s.pairs :] == [1.0, 0.0]).all()
    assert np.isinf(system.cone.cap[s.pairs :]).all()
    assert not system.cone.cohesion[s.pairs :].any()


@pytest.mark.parametrize("pressed", [0.0, 0.5, 1.0, 3.0])
def test_closed_pairs_begin_inside_of_their_strengths(pressed: float) -> None:
    """Whatever the point they are taken from: on its path the cover vanishes, and states change from inside."""
    problem = wall(2, 2, sides=True)
    problem = replace(problem, laws=replace(problem.laws, cap=np.full(problem.pairs, 2.0)))
    system = PairSystem(scale(problem))
    m, u = system.m, np.linspace(-1.0, 1.0, system.n)
    p, r = pressed * system.cone.cap, np.linspace(-9.0, 9.0, m)
    states = np.full(m, int(Normal.CLOSED))
    cover_point(system, states, np.zeros(m, dtype=int), u, p, r)
    place = (system.C @ u).reshape(-1, 2) + system.x
    soft = np.asarray(system.a + system.delta)
    forces = -(place + np.column_stack([system.cover.g, system.cover.h])) / soft
    assert (forces[:, 0] > 0).all()
    assert (forces[:, 0] < system.cone.cap).all()
    assert (np.abs(forces[:, 1]) < system.cone.linear_strength(forces[:, 0]) + 1e-9).all()


LAWS = [set(), {"tension", "cohesion"}, {"dilatancy", "gap"}, {"springs", "cap", "origin"}]


@pytest.mark.parametrize("laws", LAWS, ids=lambda laws: "+".join(sorted(laws)) or "plain")
@pytest.mark.parametrize("proximal", [0.02, 1.0])
def test_a_covered_system_has_the_point_for_its_answer(laws: set[str], proximal: float) -> None:
    """In its states, whatever they are; all that would end them is strictly away, and springs are at rest there."""
    problem = small_wall(3, *laws, alpha=0.2)
    for seed in range(3):
        rng = np.random.default_rng(seed)
        system = PairSystem(scale(problem), proximal)
        m, cap = system.m, system.cone.cap
        u, p, r = rng.normal(size=system.n), rng.uniform(0.0, 2.0, m), rng.normal(size=m)
        kinds = [Normal.CLOSED, Normal.OPEN] + ([Normal.CRUSHED] if np.isfinite(cap).all() else [])
        sign = np.where(system.frictionless, 1, rng.integers(-1, 2, m))
        normal, sign = cover_point(system, rng.choice(kinds, m), sign, u, p, r)
        path = StatePath(system, normal, sign)
        assert path.v[-1] == 1.0
        np.testing.assert_allclose(path.v[: system.n], u, atol=1e-8)
        np.testing.assert_allclose(system.anchored, proximal * u)
        slack, closed, stick = system.slacks(path.v, sign), normal == Normal.CLOSED, sign == 0
        slides = ~stick & ~system.frictionless
        assert (slack["p"][closed] > 0).all()
        assert (slack["room"][closed] > 0).all()
        assert (slack["y_n"][normal == Normal.OPEN] > 0).all()
        assert (slack["y_n"][normal == Normal.CRUSHED] < 0).all()
        assert (np.minimum(slack["plus"], slack["minus"])[stick & closed] > 0).all()
        assert ((sign * slack["y_t"])[slides] > 0).all()


def test_named_states_are_those_that_the_point_shows() -> None:
    """Pairs at their bounds slide to where force or slip point, others stick; without a point nothing open slides."""
    problem = wall(2, 2)
    m = problem.pairs
    problem = replace(problem, laws=replace(problem.laws, friction=np.full(m, 0.5), cap=np.full(m, 4.0)))
    cases = [  # normal, sign, N, T, slip -> normal, sign
        (Normal.CLOSED, 0, 2.0, 0.5, 0.0, Normal.CLOSED, 0),
        (Normal.CLOSED, 0, 2.0, 1.0, 0.0, Normal.CLOSED, -1),
        (Normal.CLOSED, 0, 2.0, -1.0, 0.0, Normal.CLOSED, 1),
        (Normal.CLOSED, 1, 2.0, -1.0, 1.0, Normal.CLOSED, 1),
        (Normal.CLOSED, -1, 2.0, 1.0, -1.0, Normal.CLOSED, -1),
        (Normal.OPEN, 0, 0.0, 0.0, 1.0, Normal.OPEN, 1),
        (Normal.OPEN, 0, 0.0, 0.0, -1.0, Normal.OPEN, -1),
        (Normal.CLOSED, 0, 4.0, 0.0, 0.0, Normal.CRUSHED, 0),
    ]
    assert m >= len(cases)
    rows = [cases[k % len(cases)] for k in range(m)]
    normal, sign, t_n, t_t, slip, wanted, side = (np.array([row[k] for row in rows]) for k in range(7))
    u = np.linalg.lstsq(problem.C_t.toarray(), slip, rcond=None)[0]
    problem = replace(problem, slip_origin=(problem.C_t @ u - slip)[:, None])
    system = PairSystem(scale(problem))
    found = named_states(system, PairStates.plane(normal, sign), (u, t_n, t_t[:, None]))
    assert found[0].tolist() == wanted.tolist()
    assert found[1].tolist() == side.tolist()
    alone = named_states(system, PairStates.plane(normal, sign), None)
    assert alone[0].tolist() == normal.tolist()
    still = (sign == 0) & (normal == Normal.CLOSED)
    assert (alone[1][still] == 0).all()


def test_crushing_stops_at_the_cap() -> None:
    problem = wall(2, 2, sides=True)
    free = solve(problem)
    law = replace(problem.laws, cap=np.full(problem.pairs, 0.9 * free.normal_force.max()))
    capped = solve(replace(problem, laws=law))
    assert capped.solved
    assert capped.normal_force.max() == pytest.approx(law.cap[0], rel=1e-12)
    assert capped.kinematics.crushing.max() > 0
    assert capped.normal_force[free.normal_force.argmax()] < free.normal_force.max()


def test_crushed_pairs_let_go_along_the_path() -> None:
    """From the states under a low cap to those under a high one, without another start to fall back on."""
    problem = wall(2, 2, sides=True)
    free = solve(problem)
    low, high = (
        replace(problem, laws=replace(problem.laws, cap=np.full(problem.pairs, share * free.normal_force.max())))
        for share in (0.7, 2.0)
    )
    crushed = solve(low)
    states = pair_states(low, crushed)
    assert (states.code == PairState.CRUSHED).sum() > 0
    start = crushed.displacement, crushed.normal_force, crushed.friction_force
    warm = solve(high, start_states=states, start=start, tries=0)
    assert warm.solved, warm.trace
    assert warm.info["start"] == "given point"
    assert warm.iterations > 0
    np.testing.assert_allclose(warm.displacement, free.displacement, atol=1e-9 * np.abs(free.displacement).max())


def test_warm_start_from_the_answer_needs_no_pivot() -> None:
    problem = wall(5, 5, alpha=0.25)
    cold = solve(problem)
    assert cold.iterations > 0
    start = cold.displacement, cold.normal_force, cold.friction_force
    warm = solve(problem, start_states=pair_states(problem, cold), start=start)
    assert warm.solved
    assert warm.iterations == 0
    np.testing.assert_allclose(warm.displacement, cold.displacement, atol=1e-12 * np.abs(cold.displacement).max())


def test_a_state_is_carried_to_another_load() -> None:
    """From the answer under a smaller push: the loads between fade in, fewer pairs change than from the glued wall."""
    near, problem = solve(wall(5, 5, alpha=0.2)), wall(5, 5, alpha=0.3)
    cold = solve(problem)
    start = near.displacement, near.normal_force, near.friction_force
    warm = solve(problem, start_states=pair_states(wall(5, 5, alpha=0.2), near), start=start, tries=0)
    assert warm.solved
    assert warm.info["start"] == "given point"
    assert 0 < warm.iterations < cold.iterations
    np.testing.assert_allclose(warm.displacement, cold.displacement, atol=1e-9 * np.abs(cold.displacement).max())


@settings(max_examples=sample(5, 15), deadline=None)
@given(st.integers(0, 10_000))
def test_crossover_from_wrong_states_reaches_the_same_answer(seed: int) -> None:
    problem = wall(4, 4, alpha=0.25)
    cold = solve(problem)
    states = pair_states(problem, cold)
    rng = np.random.default_rng(seed)
    wrong = rng.choice(problem.pairs, 6, replace=False)
    normal, sign = states.normal.copy(), states.sign.copy()
    normal[wrong], sign[wrong] = rng.integers(0, 2, 6), rng.integers(-1, 2, 6)
    given = PairStates.plane(normal, sign)
    warm = solve(problem, start_states=given, start=(cold.displacement, cold.normal_force, cold.friction_force))
    assert warm.solved
    np.testing.assert_allclose(warm.displacement, cold.displacement, atol=1e-9 * np.abs(cold.displacement).max())


@pytest.mark.parametrize(("friction", "joint"), first(2, [(1.0, 0.0), (0.6, 0.02), (0.6, 0.0), (1.0, 0.02)]))
def test_arch_between_walls_with_nothing_below(friction: float, joint: float) -> None:
    """Jammed states, which iterative methods lose; the split form of Lee is an independent check."""
    model = running_bond_panel(
        courses=3, blocks=6, joint=joint, friction=friction, base="none", side_walls=True, top_pressure=10.0,
        elements_per_block=(4, 2),
    )  # fmt: skip
    problem = assemble(model).problem()
    answer = solve(problem)
    assert answer.certificate.worst <= 1e-10
    if joint:
        return
    other = find("lee")(problem)
    assert other.certificate.worst <= 1e-10
    np.testing.assert_allclose(answer.displacement, other.displacement, atol=1e-9 * np.abs(other.displacement).max())


def test_wall_pushed_over_falls_at_the_first_ray() -> None:
    answer = solve(wall(4, 3, alpha=0.9))
    assert answer.status is Status.NO_EQUILIBRIUM
    assert len([line for line in answer.trace if "ray" in line]) == 1


def test_rigid_blocks_at_rest() -> None:
    problem = rigid(wall(3, 3, alpha=0.1))
    answer = solve(problem)
    assert answer.solved
    assert np.abs(answer.displacement).max() <= 1e-9
    assert certify(problem, answer.displacement, answer.normal_force, answer.friction_force).worst <= 1e-9


def test_loose_block_without_load_is_left_alone() -> None:
    """A body that touches nothing and carries nothing makes every matrix singular; weak springs hold it meanwhile."""
    problem = wall(1, 2)
    free = wall(1, 1, base=False)
    K = sp.csr_array(sp.block_diag([problem.K, free.K]))
    n = free.unknowns
    pad = sp.csr_array((problem.pairs, n))
    joined = replace(
        problem, K=K, f=np.concatenate([problem.f, np.zeros(n)]),
        C_n=sp.csr_array(sp.hstack([problem.C_n, pad])), C_t=sp.csr_array(sp.hstack([problem.C_t, pad])),
        R=sp.csc_array(sp.block_diag([problem.R, free.R])), bodies=np.append(problem.bodies, K.shape[0]),
        inertia=np.ones(K.shape[0]),
    )  # fmt: skip
    answer = solve(joined)
    assert answer.solved
    np.testing.assert_allclose(answer.displacement[-n:], 0.0, atol=1e-12)


def test_answers_do_not_depend_on_units() -> None:
    problem = wall(3, 3, alpha=0.2)
    length, force = 1e3, 1e-6
    scaled = replace(problem, K=problem.K * (force / length), f=problem.f * force)
    one, two = solve(problem), solve(scaled)
    assert one.iterations == two.iterations
    np.testing.assert_allclose(
        two.displacement, one.displacement * length, rtol=0, atol=1e-10 * length * np.abs(one.displacement).max()
    )


def test_cancel_limit_and_bad_input() -> None:
    problem = wall(6, 6, alpha=0.3)
    assert solve(problem, progress=lambda p: True).status is Status.CANCELLED
    assert solve(problem, limit=3, tries=1).status is Status.GAVE_UP
    with pytest.raises(InputError, match="start_states"):
        solve(problem, start_states=np.zeros(3))
    flat = wall(1, 1)
    space = replace(flat, C_t=sp.csr_array(sp.vstack([flat.C_t, flat.C_t])), slip_origin=np.zeros((flat.pairs, 2)))
    with pytest.raises(MethodError, match="plane"):
        solve(space)
