"""More friction and the headline of an assessment: curves that ended without a reason, states that were missed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.examine import prepared
from concio.analysis.seismic.sequence import Sequence
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.contact.assembly import assemble
from concio.contact.face_points import stated
from concio.solvers.statics.cone_statics import ConeStatics
from samples import sample
from seismic_walls import site


def corner(friction: float) -> Model:
    """Return the corner of a facade and its return that is shipped as an example."""
    return concio.walls(lines=[((0, 0), (0, 2.0)), ((0, 0), (1.5, 0))], height=2.0, block_size=(1.0, 0.25, 0.5),
                        block="rigid", unit_weight=18.0, friction=friction)  # fmt: skip


@cache
def assessed(friction: float) -> Assessment:
    return concio.assess(corner(friction), site=site(), levels=["SLV"], direction="-x", elsewhere=("height",))


@pytest.mark.long
@pytest.mark.parametrize("times", sample([1.2], [1.2], [1.1, 1.2, 1.35, 1.5]))
def test_more_friction_never_lowers_the_headline_of_the_corner(times: float) -> None:
    """With 1.2 times the friction zeta_E fell by 15 %: a curve ended at 5 cm where a contact only touched."""
    assert assessed(0.6 * times).zeta >= assessed(0.6).zeta * (1 - 1e-6)


@pytest.mark.long
def test_a_mechanism_without_friction_in_it_is_met_whatever_the_friction() -> None:
    """The facade tears off its return at 0.13307, with teeth that lift: 1.35 times the friction had given 0.17409."""
    for friction in (0.6, 0.81):
        worst = min(m.multiplier for m in assessed(friction).mechanisms)
        assert worst == pytest.approx(0.1330701, rel=1e-6)


def rocking() -> Sequence:
    """Return a block that rocks about an edge, as a mechanism."""
    box = Polyhedron.box
    bodies = (box("ground", (-3, -1, -0.2), (3, 2, 0), kind="fixed"), box("b", (0, 0, 0), (0.4, 1, 2), kind="rigid"))
    model = Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.9)}, loads=(Load("weight", (0, 0, -1)),))
    push = pushes(model, "-x", ())[0]
    assembly = assemble(push.model)
    found = Mechanisms(assembly, push.groups, push.sign).find(None)
    return prepared(assembly, found, push, "b", None).sequence


def test_what_a_step_left_of_overlap_in_a_contact_without_force_does_not_end_the_curve() -> None:
    """Steps get shorter, and with them the overlap that is left to them: what was there before must be put back."""
    sequence = rocking()
    state = sequence.state(sequence.at_rest(), sequence.contacts.force)
    assert state is not None
    sunk = state.q.moved(np.array([[0.0, 0.0, -1e-6, 0.0, 0.0, 0.0]]), 1.0)
    state = sequence.state(sunk, sequence.contacts.force)
    assert state is not None
    none = np.zeros(len(state.normal_force))
    touches = replace(state, normal_force=none, stays=none > 0)
    for length in (1e-3, 1e-5, 1e-7):
        q = sequence.step(touches, length)
        assert q is not None
        assert stated(sequence.contacts, q, sequence.size).gap.min() > -1e-9 * sequence.size


@pytest.mark.parametrize("seed", range(sample(4, 12, 40)))
def test_a_search_that_ends_early_without_forces_agrees_with_one_that_does_not(seed: int) -> None:
    """Where no forces balance the loads, the bound of the motions falls without bound; elsewhere nothing changes."""
    rng = np.random.default_rng(seed)
    bodies = (Polyhedron.box("g", (-1, -1, -0.2), (2, 2, 0), kind="fixed"),
              Polyhedron.box("b", (0, 0, 0), rng.uniform(0.3, 1.0, 3), kind="rigid"))  # fmt: skip
    loads = (Load("weight", (0, 0, -1)), Load("weight", rng.normal(size=3), group="live"))
    assembly = assemble(Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.5)}, loads=loads))
    dead = assembly.problem({"live": 0.0})
    live = assembly.problem({"live": 1.0}).f - dead.f
    pulled = dead.with_loads(-dead.f)
    down, sideways = np.array(dead.f), live * np.array([1.0, 1.0, 0.0, 1.0, 1.0, 1.0])
    for problem, push in ((dead, live), (pulled, live), (pulled, sideways), (dead, down), (pulled, -down)):
        whole, early = ConeStatics(problem).largest(push), ConeStatics(problem).largest(push, -1e4)
        if early.multiplier == -np.inf:
            assert whole.residual > 1e-9
        else:
            assert early.multiplier == whole.multiplier
    assert ConeStatics(pulled).largest(sideways, -1e4).multiplier == -np.inf  # pulled up from a floor without tension
