"""The existence tests against cases decided by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from concio.contact.assembly import assemble
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Body, Load, Model
from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.statics.existence import find_mechanism, statically_admissible
from concio.solvers.statics.mechanism import (
    Mechanism,
    mechanism_from,
    polish,
    proves,
    total_load,
    verify_mechanism,
)
from concio.solvers.statics.programme import StaticProgramme
from concio.solvers.statics.sufficient import sufficient_condition
from rigid_walls import FERRIS_TIN_LOI, MU, block_on_incline, running_bond, wall
from samples import sample


def single(f, n=((0.0, 1.0),), mu=0.5, **changes):
    """A rigid point body (2 unknowns) with one smooth or rough pair for each normal given."""
    n = np.array(n, float)
    t = np.column_stack([-n[:, 1], n[:, 0]])
    laws = Laws.coulomb(mu, len(n))
    laws = replace(laws, **{k: np.full(len(n), float(v)) for k, v in changes.items()})
    eye = sp.csc_array(sp.eye_array(2))
    return ContactProblem(
        sp.csr_array((2, 2)), np.array(f, float), sp.csr_array(n), sp.csr_array(t), np.zeros(len(n)), laws, eye,
        np.array([0, 2]),
    )  # fmt: skip


def test_sufficient_condition_of_a_centred_block():
    p = block_on_incline(0.4, 1.0, 0.0).problem(0.5, np.array([0.0, -3.0, 0.0]))
    found = sufficient_condition(p)
    assert found.holds
    assert found.margin == pytest.approx(1.5, rel=1e-12)
    assert found.normal_force == pytest.approx([1.5, 1.5])


def test_sufficient_condition_fails_under_a_horizontal_load():
    p = block_on_incline(0.4, 1.0, 0.0).problem(0.5, np.array([0.1, -3.0, 0.0]))
    found = sufficient_condition(p)
    assert not found.holds
    assert found.margin == -np.inf
    assert statically_admissible(p).exists


def test_sufficient_condition_is_unbounded_between_two_walls():
    p = single([0.1, 0.0], n=[(1.0, 0.0), (-1.0, 0.0)])
    found = sufficient_condition(p)
    assert found.holds
    assert found.margin == np.inf
    assert np.ptp(found.normal_force) == pytest.approx(0.1)


def test_sufficient_condition_stays_below_a_cap():
    p = single([0.1, 0.0], n=[(1.0, 0.0), (-1.0, 0.0)], cap=2.0)
    found = sufficient_condition(p)
    assert found.holds
    # smallest distance from 0 and from the cap: t and t + 0.1 with t = 2 - (t + 0.1)
    assert found.margin == pytest.approx(0.95)


@pytest.mark.parametrize(("share", "proof"), [(0.399, False), (0.401, True)])
def test_block_topples(share, proof):
    p = block_on_incline(0.4, 1.0, 0.0).problem(0.9, np.array([share, -1.0, 0.0]))
    found, state = find_mechanism(p), statically_admissible(p)
    assert state.exists is not proof
    assert state.decided
    assert not replace(state, exists=False, mechanism=None).decided
    assert (found is not None) is proof
    if found is not None:
        assert found.violation <= 1e-12
        assert np.abs(found.velocity).max() == 1.0
        assert found.power > 0


@pytest.mark.parametrize(
    ("load", "changes", "proof"),
    [
        ((0.49, -1.0), {}, False),
        ((0.51, -1.0), {}, True),
        ((0.69, -1.0), {"cohesion": 0.2}, False),
        ((0.71, -1.0), {"cohesion": 0.2}, True),
        ((0.0, 0.29), {"cohesion": 0.2, "tension": 0.3}, False),
        ((0.0, 0.31), {"cohesion": 0.2, "tension": 0.3}, True),
        ((0.0, 0.01), {"cohesion": 0.2}, True),
        ((0.0, -0.99), {"cap": 1.0}, False),
        ((0.0, -1.01), {"cap": 1.0}, True),
        ((0.01, -1.0), {"mu": 0.0}, True),
        ((0.0, -1.0), {"mu": 0.0}, False),
        ((0.09, -1.0), {"mu": 0.0, "cohesion": 0.1}, False),
        ((0.11, -1.0), {"mu": 0.0, "cohesion": 0.1}, True),
        ((0.0, -1.01), {"mu": 0.0, "cap": 1.0}, True),
    ],
)
def test_laws_of_one_pair(load, changes, proof):
    p = single(load, **changes)
    assert (find_mechanism(p) is not None) is proof
    assert statically_admissible(p).exists is not proof


def test_tie_bar_without_tangential_row():
    """A tension-only bar is a smooth pair whose tangential row is zero: it holds up to its strength."""
    p = single([0.0, -1.0], n=[(0.0, 1.0)], mu=0.0)
    p = replace(p, C_t=sp.csr_array((1, 2)))
    assert find_mechanism(p) is None
    assert find_mechanism(p.with_loads(np.array([0.0, 1.0]))) is not None
    assert find_mechanism(p.with_loads(np.array([0.5, -1.0]))) is not None


def test_bodies_that_do_not_float():
    p = replace(single([3.0, 5.0]), K=sp.csr_array(np.eye(2)), R=sp.csc_array((2, 0)))
    assert sufficient_condition(p).holds
    assert statically_admissible(p).exists
    assert find_mechanism(p) is None


def test_a_body_nothing_touches():
    free = ContactProblem(
        sp.csr_array((2, 2)), np.array([0.0, -1.0]), sp.csr_array((0, 2)), sp.csr_array((0, 2)), np.zeros(0),
        Laws.coulomb(np.zeros(0)), sp.csc_array(sp.eye_array(2)), np.array([0, 2]),
    )  # fmt: skip
    found = find_mechanism(free)
    assert found is not None
    assert found.velocity == pytest.approx([0.0, -1.0])
    assert not sufficient_condition(free).holds


def test_three_dimensions_lean_to_the_safe_side():
    """Friction resultant in any direction of the plane: held well inside the circle, mechanism outside."""
    n, m = np.array([[0.0, 0.0, 1.0]]), 1
    for angle in np.linspace(0, 2, 7):
        direction = np.array([np.cos(angle), np.sin(angle)])
        for size, proof in ((0.49, False), (0.51, True)):
            p = ContactProblem(
                sp.csr_array((3, 3)), np.r_[size * direction, -1.0], sp.csr_array(n),
                sp.csr_array(np.eye(3)[:2]), np.zeros(m), Laws.coulomb(0.5, m), sp.csc_array(sp.eye_array(3)),
                np.array([0, 3]),
            )  # fmt: skip
            found = find_mechanism(p)
            assert (found is not None) is proof
            if found is not None:
                w = found.velocity
                assert w[2] >= 0.5 * np.hypot(*w[:2]) - 1e-9


@pytest.mark.parametrize(("name", "limit"), [("wall 1", 0.642859), ("wall 2", 0.579999), ("wall 3", 0.403694)])
def test_walls_either_side_of_their_limit(name, limit):
    a = wall(FERRIS_TIN_LOI[name])
    below = a.problem(MU, a.load(limit * (1 - 1e-5), -1.0))
    assert statically_admissible(below).exists
    assert find_mechanism(below) is None
    above = a.problem(MU, a.load(limit * (1 + 1e-5), -1.0))
    found = find_mechanism(above)
    assert found is not None
    again = verify_mechanism(above, 17.0 * found.velocity)
    assert again.violation <= 1e-9
    assert again.power == pytest.approx(found.power, rel=1e-9)


def stack(x, size=1.0, weight=20.0, lean=0.0):
    """Two blocks on ground of their own at a place, the upper one narrower; ``lean`` is a share of the weight."""

    def block(name, a, b, low, high, kind="rigid"):
        return Body(name, size * np.array([[a, low], [b, low], [b, high], [a, high]]) + [x, 0.0], kind=kind)

    bodies = block("g", -1, 2, -1, 0, "fixed"), block("p", 0, 0.8, 0, 1), block("q", 0.1, 0.7, 1, 1.5)
    return tuple(replace(b, name=f"{b.name} at {x:g}") for b in bodies), (Load("weight", (lean, -1.0)),), weight


def standing(*stacks):
    """The problem of stacks that touch nothing of each other."""
    bodies, loads, materials = [], [], {}
    for k, (own, acting, weight) in enumerate(stacks):
        materials[f"m{k}"] = Rigid(weight)
        bodies += [replace(b, material=f"m{k}") for b in own]
        loads += [replace(q, bodies=tuple(b.name for b in own[1:])) for q in acting]
    return assemble(Model(tuple(bodies), materials, {"joint": JointLaw(0.6)}, loads=tuple(loads))).problem()


@settings(max_examples=sample(8, 24, 60), deadline=None)
@given(st.floats(3.5, 7.0), st.sampled_from([-1.0, 1.0]), st.floats(-0.5, 1.5))
@example(5.0, 1.0, 0.0)
@example(6.0, 1.0, 0.0)
def test_what_stands_at_the_origin_stands_far_from_it(power, sign, size):
    """A vertex of the programme that rounding of coordinates moved leaves too few forces to balance it."""
    assert statically_admissible(standing(stack(sign * 10.0**power, 10.0**size))).exists


@settings(max_examples=sample(4, 16, 40), deadline=None)
@given(st.floats(-7.0, 7.0), st.booleans(), st.sampled_from([0.0, 0.1, 0.9]), st.sampled_from([0.0, 0.9]))
@example(7.0, True, 0.9, 0.0)
def test_what_a_light_structure_lacks_is_no_rounding_of_a_heavy_one(power, first, lean, other):
    """Without its part, an imbalance of 1e-14 of the total load would be called equilibrium."""
    here, there = stack(0.0, lean=lean), stack(20.0, weight=20.0 * 10.0 ** (2 * power), lean=other)
    state = statically_admissible(standing(*((there, here) if first else (here, there))))
    assert state.exists is (lean < 0.3 and other < 0.3)
    assert (state.mechanism is not None) is not state.exists


def test_a_false_mechanism_is_refused():
    a = running_bond(4, 3)
    p = a.problem(0.6, a.load(0.1, -1.0))
    downwards = np.tile([0.0, -1.0, 0.0], a.blocks)
    assert verify_mechanism(p, downwards).violation == pytest.approx(1.0)
    assert not proves(p, verify_mechanism(p, downwards))
    assert mechanism_from(p, downwards) is None
    assert not proves(p, verify_mechanism(p, np.zeros(p.unknowns)))


def test_a_motion_that_strains_a_body_is_refused():
    p = replace(single([1.0, 0.0]), K=sp.csr_array(np.diag([5.0, 0.0])), R=sp.csc_array(np.array([[0.0], [1.0]])))
    assert verify_mechanism(p, np.array([1.0, 0.5])).violation >= 0.99


def test_polish_restores_the_active_pairs():
    a = wall(FERRIS_TIN_LOI["wall 1"])
    p = a.problem(MU, a.load(0.7, -1.0))
    exact = find_mechanism(p)
    assert exact is not None
    rough = exact.velocity + 1e-8 * np.random.default_rng(0).standard_normal(p.unknowns)
    assert not proves(p, verify_mechanism(p, rough))
    assert proves(p, verify_mechanism(p, polish(p, rough)))


@pytest.mark.parametrize("dim", [2, 3])
def test_polish_is_the_nearest_motion_whose_active_pairs_are_exact(dim):
    """Against a dense least-squares projection: two sliding pairs, two that stick, two that open freely."""
    rng = np.random.default_rng(dim)
    m, s, n = 6, dim - 1, 24
    R = np.linalg.qr(rng.standard_normal((n, n - 4)))[0]
    exact = R @ rng.standard_normal(n - 4)
    C_n, C_t = rng.standard_normal((m, n)), rng.standard_normal((m, s, n))
    for row in (*C_n[2:4], *C_t[2:4].reshape(-1, n)):
        row -= (row @ exact) / (exact @ exact) * exact
    C_n *= np.where(C_n @ exact < 0, -1.0, 1.0)[:, None]
    opens, slides = C_n @ exact, C_t @ exact
    mu = opens / np.maximum(np.linalg.norm(slides, axis=1), 1e-9) * np.array([1, 1, 1, 1, 0.5, 0.5])
    mu[2:4] = 0.7
    bodies = np.array([0, n])
    p = ContactProblem(
        sp.csr_array((n, n)), np.ones(n), sp.csr_array(C_n), sp.csr_array(C_t.reshape(-1, n)), np.zeros(m),
        Laws.coulomb(mu, m), sp.csc_array(R), bodies,
    )  # fmt: skip
    size = 1e4 / np.abs(exact).max()
    rough = size * exact + 1e-6 * (R @ rng.standard_normal(n - 4))
    scale = StaticProgramme(p).scale
    w = C_t @ rough
    active = [C_n[k] - mu[k] * (w[k] / np.linalg.norm(w[k])) @ C_t[k] for k in (0, 1)]
    active += [row for k in (2, 3) for row in (C_n[k], *C_t[k])]
    G, alpha = np.array(active) @ R / scale, (R.T @ rough) * scale
    nearest = (R / scale) @ (alpha - np.linalg.pinv(G) @ (G @ alpha))
    for width in (1e-6, 1e-7):
        polished = polish(p, rough, width)
        np.testing.assert_allclose(polished, nearest, rtol=0, atol=1e-10)
    assert 1e-7 < np.abs(polished - rough).max() < 1e-3
    np.testing.assert_array_equal(polish(p, rough, 1e-14), rough)  # none is that close to its cone


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_motion_proves_no_more_than_its_violation_could_hide(unit):
    """Forces do work on what bodies move into each other; in which unit they are measured decides nothing."""
    p = single([unit, -2.0 * unit])
    motion, violation = np.array([1.0, 0.0]), 1e-9
    hidden = violation * total_load(p)
    assert not proves(p, Mechanism(motion, 30.0 * hidden, violation))
    assert proves(p, Mechanism(motion, 300.0 * hidden, violation))
    assert proves(p, Mechanism(motion, 30.0 * hidden, 0.0))
