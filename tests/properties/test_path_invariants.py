"""What every load path must obey: energy, dissipation, the joint laws, and the associated bound."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.solvers.path.record import Outcome
from concio.solvers.statics.associated_limit import associated_limit
from path_helpers import energy_error, least_dissipation, weight_then, worst_certificate
from rigid_walls import running_bond
from samples import sample

sizes = st.tuples(st.floats(0.5, 2.0), st.floats(0.3, 1.0))
walls = st.builds(running_bond, st.integers(1, 3), st.integers(1, 4), sizes)
few = st.builds(running_bond, st.integers(1, 3), st.integers(1, 3), sizes)


@pytest.mark.long
@settings(max_examples=sample(8, 12, 25), deadline=None)
@given(walls, st.floats(0.2, 0.9), st.sampled_from([1.0, -1.0]), st.floats(0.5, 4.0))
def test_pushover_of_small_walls(assembly, mu, side, ratio):
    push = assembly.load(side, 0)
    control = np.abs(push) * np.sign(push) / np.abs(push).sum()
    path, found = weight_then(assembly, mu, push, ratio=ratio, until=0.01, control=control)
    bound = associated_limit(path.problem, push).multiplier
    assert found.outcome in (Outcome.REACHED, Outcome.LOST, Outcome.MECHANISM)
    assert found.peak <= bound * (1 + 1e-9)
    assert worst_certificate(path, found) <= 1e-9
    assert energy_error(path, found) <= 1e-9
    assert least_dissipation(path, found) >= -1e-10


@settings(max_examples=sample(4, 10), deadline=None)
@given(few, st.floats(0.3, 0.8))
def test_mirror_image(assembly, mu):
    """Pushed from the other side the wall does the same; walls of running bond are symmetric."""
    ends = []
    for side in (1.0, -1.0):
        push = assembly.load(side, 0)
        control = push / np.abs(push).sum()
        ends.append(weight_then(assembly, mu, push, until=0.002, control=control)[1])
    a, b = (f.at(0.5 * min(f.peak for f in ends)) for f in ends)
    here, there = (np.abs(f.displacement.reshape(-1, 3)).sum(axis=0) for f in (a, b))
    assert np.abs(here - there).max() <= 1e-9 * here.sum()
    assert abs(ends[0].peak - ends[1].peak) <= 1e-9


@settings(max_examples=sample(1, 3, 8), deadline=None)
@given(few, st.floats(0.3, 0.8), st.floats(1e-6, 1e-2))
def test_stiffness_of_the_joints_scales_displacements_only(assembly, mu, compliance):
    """Without gaps, rigid blocks on joints ten times softer move ten times as much at the same load."""
    push = assembly.load(1, 0)
    one, two = (weight_then(assembly, mu, push, compliance=c)[1] for c in (compliance, 10 * compliance))
    assert abs(one.peak - two.peak) <= 1e-9
    a, b = one.at(0.5 * one.peak), two.at(0.5 * one.peak)
    assert np.abs(10 * a.displacement - b.displacement).max() <= 1e-9 * np.abs(b.displacement).max()


@pytest.mark.parametrize("seed", range(sample(1, 3, 6)))
def test_slips_and_offsets_of_a_state_are_those_of_its_displacements(seed: int) -> None:
    """What a pair has slipped for good is its motion less what its compliance gives back, in metres, of any size."""
    rng = np.random.default_rng([18, seed])
    size = float(2.0 ** rng.integers(-6, 7))
    model = concio.running_bond_panel(
        courses=2, blocks=2, block_size=(0.4 * size, 0.2 * size), block=concio.Rigid(20.0), horizontal=1.0, base="full",
        friction=float(rng.uniform(0.3, 0.6)), side_walls=False,
    )  # fmt: skip
    path = concio.run_path(model, [concio.Stage("dead", {"dead": 1.0}), concio.Stage("live", {"live": 1.0})])
    slipped = 0
    for step in path.steps[1:]:
        state, problem = step.state, path.assembly.problem(step.factors)
        closed = state.contact != 0
        moved = (problem.C_t @ state.displacement)[:, None] - problem.slip_origin
        moved = moved + problem.laws.tangential_compliance[:, None] * state.friction_force
        unit = float(np.abs(state.displacement).max())
        np.testing.assert_allclose(state.slip[closed], moved[closed], rtol=1e-9, atol=1e-9 * unit)
        slipped += int((np.abs(state.slip[closed]) > 1e-6 * unit).sum())
    assert slipped > 0
