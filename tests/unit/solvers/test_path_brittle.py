"""Joints that lose tensile strength and cohesion once exceeded, against examples solved by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from concio.errors import InputError
from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.methods import find
from concio.solvers.path.path_state import LinearPath, certify_step, elastic_energy
from concio.solvers.path.record import Outcome
from concio.solvers.path.step_path import StepPath, follow_in_steps
from path_helpers import at_rest

K, T, C, MU = 100.0, 2.0, 1.5, 0.5
"""Spring of the body [kN/m], tensile strength and cohesion of its one joint [kN], friction."""


def body_on_springs(weight: float) -> ContactProblem:
    """One body on springs K in both directions, pressed by ``weight`` on a point with tension T and cohesion C."""
    laws = replace(Laws.coulomb(MU, 1), tension=np.array([T]), cohesion=np.array([C]))
    normal, tangential = sp.csr_array(np.array([[0.0, 1.0]])), sp.csr_array(np.array([[1.0, 0.0]]))
    return ContactProblem(
        sp.csr_array(K * np.eye(2)), np.array([0.0, -weight]), normal, tangential, np.zeros(1), laws,
        sp.csc_array(np.zeros((2, 0))), np.array([0, 2]),
    )  # fmt: skip


def walk(path: LinearPath, brittle: bool, steps: int = 8, until: float = 1.0) -> StepPath:
    start = replace(at_rest(path), normal_force=-path.problem.f[[1]])
    return follow_in_steps(
        path, start, until=until, steps=steps, solver=find("interior-point"), brittle=brittle, refine=False
    )


def check(path: LinearPath, found: StepPath) -> None:
    assert found.outcome is Outcome.REACHED
    for a, b in zip(found.states, found.states[1:], strict=False):
        assert certify_step(path, a, b).worst <= 1e-9
        assert b.dissipation >= a.dissipation - 1e-12
    end = found.states[-1]
    assert end.work - end.dissipation == pytest.approx(elastic_energy(path.problem, end), abs=1e-9)


def test_tension_is_lost_for_good():
    """Pulled up by 4: a ductile joint holds 2 of it, one that breaks none; pulled again, it opens at once."""
    path = LinearPath(body_on_springs(0.0), np.array([0.0, 4.0]))
    ductile, brittle = walk(path, brittle=False), walk(path, brittle=True)
    assert ductile.states[-1].displacement[1] == pytest.approx((4 - T) / K, rel=1e-8)
    assert ductile.states[-1].normal_force[0] == pytest.approx(-T, rel=1e-8)
    assert brittle.states[-1].displacement[1] == pytest.approx(4 / K, rel=1e-8)
    assert brittle.states[-1].normal_force[0] == pytest.approx(0.0, abs=1e-8)
    (event,) = [e for e in brittle.events if e.kind == "breaks"]
    assert event.parameter == pytest.approx(0.5)  # the strength of 2 is met there
    after = brittle.states[event.step + 1]
    assert after.parameter == event.parameter  # at the same load, the body jumps to where the spring holds it alone
    assert after.displacement[1] == pytest.approx(2 / K, rel=1e-8)
    for found in (ductile, brittle):
        check(path, found)
    back = follow_in_steps(
        path, brittle.states[-1], until=0.25, steps=3, solver=find("interior-point"), brittle=True, refine=False
    )
    assert back.states[-1].displacement[1] == pytest.approx(1 / K, rel=1e-8)


def test_cohesion_is_lost_where_the_joint_slips():
    """Pressed by 1 and pushed by 4: it slips at c + mu = 2; afterwards only mu = 0.5 is left of that."""
    path = LinearPath(body_on_springs(1.0), np.array([4.0, 0.0]))
    ductile, brittle = walk(path, brittle=False), walk(path, brittle=True)
    assert ductile.states[-1].displacement[0] == pytest.approx((4 - C - MU) / K, rel=1e-8)
    assert brittle.states[-1].displacement[0] == pytest.approx((4 - MU) / K, rel=1e-8)
    assert brittle.states[-1].broken.all()
    (event,) = [e for e in brittle.events if e.kind == "breaks"]
    assert event.parameter == pytest.approx(0.625)  # the first step beyond 0.5, where the strength is met
    for found in (ductile, brittle):
        check(path, found)


def test_nothing_breaks_below_the_strength():
    path = LinearPath(body_on_springs(1.0), np.array([1.9, 0.0]))
    found = walk(path, brittle=True)
    assert [e.kind for e in found.events] == []
    assert np.abs(found.states[-1].displacement).max() <= 1e-10


def test_exact_paths_refuse_to_break():
    from concio import Stage, run_path, wall

    model = wall(length=1.0, height=0.5, friction=0.6)
    with pytest.raises(InputError, match="in steps only"):
        run_path(model, [Stage("weight", {"dead": 1.0})], brittle=True)
    assert run_path(model, [Stage("weight", {"dead": 1.0}, steps=1)], brittle=True, method="steps").complete
