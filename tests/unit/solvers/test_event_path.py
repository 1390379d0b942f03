"""Exact load paths against hand-solved ones."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.errors import InputError
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.pair_state import PairStates
from concio.solvers.path import direction
from concio.solvers.path.event_path import _Follower, follow
from concio.solvers.path.path_state import CRUSHED, OPEN, LinearPath, PathState
from concio.solvers.path.path_state import at_rest as unloaded
from concio.solvers.path.record import Outcome
from path_helpers import at_rest, energy_error, least_dissipation, weight_then, worst_certificate
from rigid_walls import block_on_incline

PUSH = block_on_incline(0.4, 1.0, 0.0)


def test_block_slides():
    """Weight 1 on two corners 0.4 apart, pushed at 0.5: t_n = 0.5 -+ 1.25 lambda, t_t = lambda / 2 each."""
    path, found = weight_then(PUSH, 0.3, PUSH.load(1, 0), compliance=1e-3)
    assert found.outcome is Outcome.LIMIT
    assert [e.kind for e in found.events] == ["slips", "slips"]
    assert [e.pair for e in found.events] == [0, 1]
    assert found.events[0].parameter == pytest.approx(0.3 * 0.5 / (0.5 + 0.3 * 1.25), rel=1e-12)
    assert found.peak == pytest.approx(0.3, rel=1e-12)
    assert worst_certificate(path, found) <= 1e-12
    assert energy_error(path, found) <= 1e-12
    assert found.direction == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)


def test_block_topples_and_the_control_point_goes_on():
    path, found = weight_then(
        PUSH, 0.9, PUSH.load(1, 0), compliance=1e-3, until=0.05, control=np.array([1.0, 0.0, 0.0])
    )  # fmt: skip
    assert found.outcome is Outcome.REACHED
    assert [e.kind for e in found.events] == ["slips", "opens"]
    assert found.peak == pytest.approx(0.4, rel=1e-12)
    assert found.end.parameter == pytest.approx(0.4, rel=1e-12)
    assert found.end.displacement[0] == pytest.approx(0.05, rel=1e-12)
    rotation = found.states[-1].displacement - found.states[-2].displacement
    assert rotation[2] == pytest.approx(-rotation[0] / 0.5, rel=1e-9)  # about the toe
    assert rotation[1] == pytest.approx(rotation[0] * 0.2 / 0.5, rel=1e-9)
    assert worst_certificate(path, found) <= 1e-12


def test_crushing_toe():
    """With a cap of 0.8 the toe crushes at lambda = 0.24 and the block turns about a point between the corners."""
    path, found = weight_then(
        PUSH, 0.9, PUSH.load(1, 0), until=0.02, control=np.array([1.0, 0.0, 0.0]), cap=0.8
    )  # fmt: skip
    assert "crushes" in [e.kind for e in found.events]
    assert found.peak == pytest.approx(0.24, rel=1e-12)
    assert CRUSHED in found.end.contact
    assert OPEN not in found.end.contact
    assert found.end.dissipation > 0
    assert energy_error(path, found) <= 1e-12
    assert worst_certificate(path, found) <= 1e-12


def test_cohesion_and_tension():
    """The heel carries T before it opens: 0.2 W + 0.4 T over 0.5; afterwards it keeps T (ductile)."""
    path, found = weight_then(
        PUSH, 0.9, PUSH.load(1, 0), until=0.02, control=np.array([1.0, 0.0, 0.0]), cohesion=0.1, tension=0.1
    )  # fmt: skip
    assert found.peak == pytest.approx(0.48, rel=1e-12)
    assert found.end.normal_force.min() == pytest.approx(-0.1, rel=1e-12)
    assert worst_certificate(path, found) <= 1e-12
    assert energy_error(path, found) <= 1e-12


@pytest.mark.parametrize(("cap", "mu"), [(0.8, 0.9), (0.62, 0.9), (np.inf, 0.3), (np.inf, 0.9)])
def test_pivots_alone_find_the_way_that_flips_find(cap, mu, monkeypatch):
    """At every corner of a path Lemke's method on all critical pairs: opening, slipping and crushing ones."""
    given = {"until": 0.02, "control": np.array([1.0, 0.0, 0.0]), "cap": cap, "compliance": 1e-3}
    _, flipped = weight_then(PUSH, mu, PUSH.load(1, 0), **given)
    monkeypatch.setattr(direction, "ROUNDS_ALL", 0)
    monkeypatch.setattr(direction, "ROUNDS_ONE", 0)
    path, found = weight_then(PUSH, mu, PUSH.load(1, 0), **given)
    assert found.peak == pytest.approx(flipped.peak, rel=1e-9)
    assert found.end.parameter == pytest.approx(flipped.end.parameter, rel=1e-9)
    assert found.end.displacement == pytest.approx(flipped.end.displacement, rel=1e-7, abs=1e-10)
    assert [(e.kind, e.pair) for e in found.events] == [(e.kind, e.pair) for e in flipped.events]
    assert worst_certificate(path, found) <= 1e-12


K1, K2, H1, H2 = 10.0, 20.0, 2.0, 1.0
"""Two blocks on rough ground in a row: ground - k1 - block 1 - k2 - block 2, friction strengths h1, h2."""


def two_blocks() -> LinearPath:
    k_x = np.array([[K1 + K2, -K2], [-K2, K2]])
    K = sp.csr_array(np.kron(k_x, np.diag([1.0, 0.0])))
    up, along = np.array([[0, 1.0, 0, 0], [0, 0, 0, 1.0]]), np.array([[-1.0, 0, 0, 0], [0, 0, -1.0, 0]])
    mu = 0.5
    problem = ContactProblem(
        K, np.array([0, -H1 / mu, 0, -H2 / mu]), sp.csr_array(up), sp.csr_array(along), np.zeros(2),
        Laws.coulomb(mu, 2), sp.csc_array(up.T), np.array([0, 4]),
    )  # fmt: skip
    return LinearPath(problem, np.array([0.0, 0.0, 1.0, 0.0]))


def standing(path: LinearPath) -> PathState:
    return replace(at_rest(path), normal_force=-path.problem.f[[1, 3]])


def test_two_block_cycle_by_hand():
    """Load 0 to 7 and back to 0: block 2 turns back 2 h2 below the top, block 1 another 2 h1 below."""
    path = two_blocks()
    up = follow(path, standing(path), until=7.0)
    assert [(e.parameter, e.pair, e.kind) for e in up.events] == [
        (pytest.approx(H2), 1, "slips"),
        (pytest.approx(H1 + H2), 0, "slips"),
    ]
    u1, u2 = up.end.displacement[[0, 2]]
    assert u1 == pytest.approx((7 - H1 - H2) / K1)
    assert u2 == pytest.approx(u1 + (7 - H2) / K2)
    assert up.end.dissipation == pytest.approx(H1 * u1 + H2 * u2)
    down = follow(path, up.end, until=0.0)
    assert down.outcome is Outcome.REACHED
    assert [(e.parameter, e.pair, e.kind) for e in down.events] == [
        (pytest.approx(7.0), 0, "sticks"),
        (pytest.approx(7.0), 1, "sticks"),
        (pytest.approx(7 - 2 * H2), 1, "slips"),
        (pytest.approx(7 - 2 * H2 - 2 * H1), 0, "slips"),
    ]
    v1, v2 = down.end.displacement[[0, 2]]
    assert v1 == pytest.approx((H2 + H1) / K1)  # spring 2 carries h2, spring 1 the strengths of both
    assert v2 == pytest.approx(v1 + H2 / K2)
    assert down.end.dissipation == pytest.approx(H1 * (2 * u1 - v1) + H2 * (2 * u2 - v2))
    assert np.abs(down.end.displacement).max() > 0.1  # though the load is what it was at the beginning
    for part in (up, down):
        assert worst_certificate(path, part) <= 1e-12
        assert least_dissipation(path, part) >= -1e-14
        assert energy_error(path, part) <= 1e-12


def test_a_closed_cycle_dissipates_the_same_each_time():
    path = two_blocks()
    state = follow(path, standing(path), until=7.0).end
    spent = []
    for _ in range(3):
        before = state.dissipation
        state = follow(path, follow(path, state, until=-7.0).end, until=7.0).end
        spent.append(state.dissipation - before)
    u1 = (7 - H1 - H2) / K1
    u2 = u1 + (7 - H2) / K2
    assert spent == pytest.approx([4 * (H1 * u1 + H2 * u2)] * 3, rel=1e-12)


def test_interrupted_path_continues_where_it_was():
    path = two_blocks()
    whole = follow(path, standing(path), until=7.0)
    half = follow(path, follow(path, standing(path), until=2.2).end, until=7.0)
    assert half.end.displacement == pytest.approx(whole.end.displacement, rel=1e-13)
    assert half.end.dissipation == pytest.approx(whole.end.dissipation, rel=1e-13)
    assert whole.at(2.2).displacement == pytest.approx(half.states[0].displacement, rel=1e-13)


def test_moving_obstacle_does_work():
    """Pushing the ground under block 2 sideways drags it until friction is used up."""
    path = replace(two_blocks(), load_rate=np.zeros(4), tangent_rate=np.array([[0.0], [1.0]]))
    found = follow(path, standing(path), until=1.0)
    assert [(e.pair, e.kind) for e in found.events] == [(1, "slips")]
    # t points to -x: the ground moves to +x... the block follows by h2 / k2 while block 1 is held by its own friction
    assert found.events[0].parameter == pytest.approx(H2 / K2)
    assert found.end.displacement[2] == pytest.approx(H2 / K2)
    assert found.end.dissipation == pytest.approx(H2 * (1 - H2 / K2))
    assert energy_error(path, found) <= 1e-12


def test_gap_closes_and_opens_again():
    """A bar end with a gap: free, then stopped; the same on the way back, as nothing slips."""
    problem = ContactProblem(
        sp.csr_array(np.diag([5.0, 5.0])), np.zeros(2), sp.csr_array(np.array([[-1.0, 0.0]])),
        sp.csr_array(np.array([[0.0, -1.0]])), np.array([0.1]), Laws.coulomb(0.3, 1), sp.csc_array((2, 0)),
        np.array([0, 2]),
    )  # fmt: skip
    path = LinearPath(problem, np.array([1.0, 0.0]))
    start = replace(at_rest(path), states=PairStates.plane(np.array([OPEN]), np.zeros(1)))
    found = follow(path, start, until=2.0)
    assert [(e.parameter, e.kind) for e in found.events] == [(pytest.approx(0.5), "closes")]
    assert found.end.normal_force == pytest.approx([1.5])
    back = follow(path, found.end, until=0.0)
    assert [(e.parameter, e.kind) for e in back.events] == [(pytest.approx(0.5), "opens")]
    assert back.end.displacement == pytest.approx([0, 0], abs=1e-15)


def test_three_dimensions_are_refused():
    p = ContactProblem(
        sp.csr_array((3, 3)), np.zeros(3), sp.csr_array(np.eye(3)[2:]), sp.csr_array(np.eye(3)[:2]), np.zeros(1),
        Laws.coulomb(0.5, 1), sp.csc_array(np.eye(3)), np.array([0, 3]),
    )  # fmt: skip
    path = LinearPath(p, np.zeros(3))
    with pytest.raises(InputError, match="two-dimensional"):
        follow(path, unloaded(p), until=1.0)


def test_cancelling():
    path = two_blocks()
    found = follow(path, standing(path), until=7.0, progress=lambda _: True)
    assert found.outcome is Outcome.CANCELLED
    assert len(found.states) == 2


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("outcome", [Outcome.LOST, Outcome.LIMIT])
def test_the_last_direction_of_a_lost_path_goes_with_its_load(sense: float, outcome: Outcome) -> None:
    """The runaway rate of a matrix that is nearly singular has either sign; a mechanism has its own."""
    load = np.array([3.0, -1.0])
    equations, path = SimpleNamespace(n=2, factorisations=7), SimpleNamespace(load_rate=load)
    follower = SimpleNamespace(equations=equations, by_load=True, sense=sense, path=path)
    for way in (1.0, -1.0):
        rate = way * np.array([0.5, 2.0, 9.0])  # the last is no displacement
        moved = _Follower.finish(follower, [], [], outcome, rate).direction  # type: ignore[arg-type]
        assert np.abs(moved).max() == 1.0
        assert np.abs(moved) == pytest.approx([0.25, 1.0])
        along = load @ moved * sense
        assert along > 0 if outcome is Outcome.LOST else along * sense * (load @ rate[:2]) > 0
        by_motion = SimpleNamespace(**{**vars(follower), "by_load": False})
        kept = _Follower.finish(by_motion, [], [], outcome, rate)  # type: ignore[arg-type]
        assert kept.direction == pytest.approx(rate[:2] / 2.0)
    nothing = _Follower.finish(follower, [], [], outcome, None)  # type: ignore[arg-type]
    assert (nothing.direction == 0.0).all()
    assert nothing.factorisations == 7


@pytest.mark.parametrize("size", [6, 10])
def test_a_dry_panel_at_rest_has_an_exact_path(size: int) -> None:
    """Hundreds of pairs touch without force: which of them slip first is found by a small step, not by a finite one."""
    sizes = {"courses": size, "blocks": size, "joint": 0.0, "base": "full"}
    panel = concio.running_bond_panel(**sizes, friction=0.6, top_pressure=10.0)
    found = concio.run_path(panel, [concio.Stage("top", {"top": 1.0})])
    assert found.complete
    kinds = [event.kind for event in found.events]
    assert "restarts" not in kinds
    assert "jumps" not in kinds
    assert all(event.parameter == 0.0 for event in found.events), "nothing changes on a ray"
