"""What a path leaves behind: dilatant opening of every slip, and energy that joints take and give back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio import Stage
from concio.problem.certificate import kinematics
from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.methods import find
from concio.solvers.path.event_path import follow
from concio.solvers.path.path_state import LinearPath
from concio.solvers.path.step_path import follow_in_steps
from path_helpers import at_rest

K, W = 100.0, 2.0


def block_on_springs(f, **law):
    """A block (x, y) held by springs K on one joint that it presses with W, with its laws."""
    laws = replace(Laws.coulomb(0.5, 1), **{name: np.array([value]) for name, value in law.items()})
    return ContactProblem(
        sp.csr_array(K * np.eye(2)), np.array(f), sp.csr_array([[0.0, 1.0]]), sp.csr_array([[1.0, 0.0]]), np.zeros(1),
        laws, sp.csc_array(np.zeros((2, 0))), np.array([0, 2]),
    )  # fmt: skip


@pytest.mark.parametrize("method", ["events", "steps"])
def test_a_closed_joint_has_no_gap_after_slipping_forth_and_back(method):
    """Dilatancy opened with both slips; counted from the slip that is left, the closed joint showed a gap."""
    block = concio.column(
        width=0.6, height=0.2, blocks=1, friction=concio.JointLaw(0.5, dilatancy=0.2), unit_weight=20, mesh_size=0.1
    )
    push = concio.Load("traction", (5.0, 0.0), edge=((-0.3, 0.0), (-0.3, 0.2)), group="push")
    stages = [Stage("weight", {"dead": 1.0}), Stage("push", {"push": 0.8}), Stage("back", {"push": -0.8})]
    path = concio.run_path(replace(block, loads=(*block.loads, push)), stages, method=method)
    assert path.complete
    shown = []
    for step in range(len(path.steps)):
        contacts, u = path.result(step).contacts, path.steps[step].state.displacement
        closed, size = contacts.normal_force > 1e-9, np.abs(u).max() or 1.0
        assert np.abs(contacts.gap[closed]).max(initial=0.0) <= 1e-12 * size
        assert contacts.gap.min() >= -1e-12 * size
        state = path.steps[step].state
        problem = path.assembly.problem(path.steps[step].factors)
        one_way = kinematics(problem, u, state.normal_force, state.friction_force)
        shown.append(np.abs(one_way.gap[closed]).max(initial=0.0) / size)
    assert max(shown) > 1e-3  # slips did turn round


def test_opening_at_the_tensile_strength_is_given_back_on_closing():
    """Ductile tension holds while the joint opens and while it closes: T times the opening is taken, then returned."""
    T = 0.8
    problem = block_on_springs([0.0, 0.0], tension=T, cohesion=1.0)
    path = LinearPath(problem, np.array([0.0, 1.0]))
    up = follow(path, at_rest(path), until=3.0)
    opened = (3.0 - T) / K
    assert up.end.displacement[1] == pytest.approx(opened, rel=1e-12)
    assert up.end.dissipation == pytest.approx(T * opened, rel=1e-12)
    down = follow(path, up.end, until=0.0)
    assert down.end.displacement[1] == pytest.approx(0.0, abs=1e-15)
    assert down.end.dissipation == pytest.approx(0.0, abs=1e-15)
    assert down.end.work == pytest.approx(0.0, abs=1e-15)


def test_dissipation_of_finite_steps_is_that_of_straight_lines():
    """Associated slip (friction = dilatancy = 10) dissipates nothing; a step that begins to slip counts a share below.

    Followed by events it is zero to rounding; what finite steps lose goes with their size.
    """
    problem = block_on_springs([0.0, -W], friction=10.0, dilatancy=10.0)
    path = LinearPath(problem, np.array([80.0, 0.0]))
    start = replace(at_rest(path), normal_force=np.array([W]))
    exact = follow(path, start, until=1.0)
    assert exact.end.slip[0] > 0.001
    assert abs(exact.end.dissipation) <= 1e-12 * exact.end.work
    lost = []
    for steps in (3, 6, 12, 24):
        found = follow_in_steps(path, start, until=1.0, steps=steps, solver=find("interior-point"), refine=False)
        np.testing.assert_allclose(found.states[-1].displacement, exact.end.displacement, rtol=1e-9)
        lost.append(-found.states[-1].dissipation / found.states[-1].work)
    assert lost[0] > 1e-6
    assert all(-1e-12 <= loss <= lost[0] for loss in lost)
    assert lost[-1] < 0.3 * lost[0]
