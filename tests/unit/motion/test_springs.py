"""Springs of compliant joints in a motion: energy, and the damping that goes with their stiffness."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import concio
from concio.analysis.motion.springs import Springs
from motion_models import G, standing
from samples import sample


def test_springs_store_the_work_that_deforms_them():
    """Integral of the force over the deformation, which ends where the tensile strength is reached."""
    springs = Springs(
        normal=np.array([True, True, False, True]), shear=np.array([True, False, True, False]),
        a_n=np.array([2e-3, 5e-4, 0.0, 1e-3]), a_t=np.array([7e-3, 0.0, 3e-3, 0.0]),
        longest=np.array([1e-3, 0.0, 0.0, 2e-3]),
    )  # fmt: skip
    sunk, stretch = np.array([-4e-3, 3e-3, -5e-3, 9e-3]), np.array([-6e-3, 8e-3, 2e-3, 1e-3])
    path = np.linspace(0.0, 1.0, 2001)[:, None]
    deformed = np.where(springs.normal, np.minimum(sunk * path, springs.longest), 0.0)
    sheared = np.where(springs.shear, stretch * path, 0.0)
    force_n = np.where(springs.normal, deformed / np.where(springs.normal, springs.a_n, 1.0), 0.0)
    force_t = np.where(springs.shear, sheared / np.where(springs.shear, springs.a_t, 1.0), 0.0)
    along_n, along_t = np.trapezoid(force_n, deformed, axis=0), np.trapezoid(force_t, sheared, axis=0)
    found = springs.parts(sunk, stretch[:, None])
    assert found[0] == pytest.approx(along_n, rel=1e-9, abs=1e-15)
    assert found[1] == pytest.approx(along_t, rel=1e-9, abs=1e-15)
    assert springs.stored(sunk, stretch[:, None]) == pytest.approx(along_n + along_t, rel=1e-9)
    assert found[0] == pytest.approx([4e-3, 0.0, 0.0, 2e-3], rel=1e-9, abs=1e-15)
    in_space = np.column_stack([0.6 * stretch, -0.8 * stretch])
    assert springs.stored(sunk, in_space) == pytest.approx(springs.stored(sunk, stretch[:, None]), rel=1e-12)
    assert springs.loaded(sunk).tolist() == [True, False, False, False]
    assert springs.broken(np.array([True, False, False, True])).longest.tolist() == [0.0, 0.0, 0.0, 0.0]


@pytest.mark.long
@pytest.mark.parametrize("start", [(0.02, 0.0), (0.0, -0.01)][: sample(1, 2)])
def test_damping_in_proportion_to_joints_against_the_exact_motion_of_a_block(start):
    """M q'' + b K q' + K q = 0 about the rest, K = C' k C of the joint in statics; normal and tangential springs."""
    law = concio.JointLaw(1.0, normal_stiffness=2e3, tangential_stiffness=6e2)
    model, beta, end = standing(width=1.5, height=0.5, friction=law), 8e-3, 0.16
    problem = concio.assemble(model).problem()
    C_n, C_t = problem.C_n.toarray(), problem.C_t.toarray()
    K = C_n.T @ (C_n / problem.laws.normal_compliance[:, None])
    K += C_t.T @ (C_t / problem.laws.tangential_compliance[:, None])
    inverse = np.linalg.inv(problem.inertia.toarray())
    n = len(K)
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, -beta * inverse @ K]])
    first = np.zeros(2 * n)
    first[n : n + 2] = start
    exact = (expm(end * system) @ first)[:2]
    undamped = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, np.zeros((n, n))]])
    assert np.abs((expm(end * undamped) @ first)[:2] - exact).max() > 0.2 * np.abs(exact).max()
    found = concio.dynamics(
        model, duration=end, step=2e-4, gravity=G, velocities={"block": start}, stiffness_damping=beta, every=end
    )
    moved = found.end.centre[1] - found.shots.centre[0, 1]
    assert found.certified
    assert moved == pytest.approx(exact, rel=1e-2, abs=2e-3 * np.abs(exact).max())
    kinetic = 0.5 * problem.inertia.diagonal()[0] * (start[0] ** 2 + start[1] ** 2)
    assert 0.1 * kinetic < found.energy["damping"][-1] < kinetic
