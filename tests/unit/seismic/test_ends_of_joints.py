"""Rigid blocks need the pairs at the ends of their joints alone, and forces go back to all of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import Model
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.ends_of_joints import Ends, ends_of_joints
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.contact.assembly import Assembly, assemble
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.collapse_state import Motion, judged


def elastic_wall() -> Model:
    """Return six courses of elastic bricks whose joints have several nodes each."""
    stone = concio.Elastic(E=1e6, nu=0.2, unit_weight=20.0)
    return concio.wall(length=1.5, height=1.5, block_size=(0.5, 0.25), block=stone, friction=0.5)


def searched(model: Model) -> tuple[Assembly, Mechanisms]:
    (push,) = pushes(model, "right", ())
    assembly = assemble(push.model)
    return assembly, Mechanisms(assembly, push.groups, push.sign)


def test_two_pairs_of_a_joint_are_left() -> None:
    assembly, seek = searched(elastic_wall())
    ends = seek.ends
    joints = assembly.pairs.interface
    assert (np.bincount(joints) > 2).any()
    assert (np.bincount(joints[ends.needed]) == 2).all()
    rows = (seek.whole.C_n @ seek.whole.R).toarray()
    for k in np.flatnonzero(~ends.needed):
        s, a, b = ends.share[k], ends.first[k], ends.last[k]
        assert rows[k] == pytest.approx((1 - s) * rows[a] + s * rows[b], abs=1e-12)


def test_pairs_with_cohesion_are_all_needed() -> None:
    assembly, seek = searched(elastic_wall())
    sticky = replace(seek.whole, laws=replace(seek.whole.laws, cohesion=np.ones(seek.whole.pairs)))
    assert ends_of_joints(sticky, assembly.pairs).needed.all()


@pytest.mark.long
def test_all_pairs_have_the_same_limit_and_the_state_is_one_of_all() -> None:
    _, seek = searched(elastic_wall())
    found = seek.find()
    assert found.associated.multiplier == pytest.approx(associated_limit(seek.whole, seek.push).multiplier, rel=1e-8)
    assert found.flow == "Coulomb"
    state = found.state
    assert state is not None
    motion = Motion.of(seek.whole, state.velocity)
    again = judged(seek.whole, seek.push, motion, state.multiplier, state.normal_force, state.friction_force, 0)
    assert again.certified
    assert (state.normal_force[~seek.ends.needed] > 0).any()


def test_spread_forces_keep_their_resultants() -> None:
    rng = np.random.default_rng(3)
    needed = np.array([True, False, False, True, True, False, True])
    share = np.array([0.0, 0.2, 0.7, 0.0, 0.0, 0.5, 0.0])
    ends = Ends(needed, np.array([0, 0, 0, 3, 4, 4, 6]), np.array([0, 3, 3, 3, 4, 6, 6]), share)
    at = np.array([0.0, 0.2, 0.7, 1.0, 0.0, 0.5, 1.0])
    for _ in range(50):
        t_n = np.where(needed, 10.0 ** rng.uniform(-9, 1, 7), 0.0)
        t_t = (0.5 * t_n * rng.uniform(-1, 1, 7))[:, None]
        n, t = ends.spread(t_n, t_t)
        assert (n >= 0).all()
        assert (np.abs(t[:, 0]) <= 0.5 * n * (1 + 1e-12)).all()
        for joint in (slice(0, 4), slice(4, 7)):
            assert n[joint].sum() == pytest.approx(t_n[joint].sum(), rel=1e-12)
            assert n[joint] @ at[joint] == pytest.approx(t_n[joint] @ at[joint], abs=1e-12 * t_n[joint].sum())
            assert t[joint].sum() == pytest.approx(t_t[joint].sum(), abs=1e-12 * t_n[joint].sum())


@pytest.mark.parametrize("right", [1.0, 0.0])
def test_a_resultant_close_to_an_end_is_spread_without_overflow(right: float) -> None:
    """A third pair a hundredth of the joint from its end: pressures fall there by the exponential of hundreds."""
    share = np.array([0.0, 0.99 if right else 0.01, 0.0])
    ends = Ends(np.array([True, False, True]), np.array([0, 0, 2]), np.array([0, 2, 2]), share)
    for off in (1e-3, 2e-4, 1e-4):
        t_n = 5.0 * np.array([off, 0.0, 1.0 - off] if right else [1.0 - off, 0.0, off])
        n, _ = ends.spread(t_n, np.zeros((3, 1)))
        assert np.isfinite(n).all()
        assert (n >= 0).all()
        assert n.sum() == pytest.approx(5.0, rel=1e-12)
        assert n @ np.array([0.0, share[1], 1.0]) == pytest.approx(t_n[2], rel=1e-9)
