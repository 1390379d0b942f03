"""Stages, control points, restart, named events and steps of load paths of models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.limit import friction_margin, limit
from concio.analysis.path import ControlPoint, Stage, run_path
from concio.analysis.settlement import settle
from concio.contact.assembly import assemble
from concio.errors import InputError
from concio.model.actions import Tie
from concio.model.generate.walls import wall
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Body, Support
from concio.solvers.methods import find
from concio.solvers.path.path_state import LinearPath, at_rest
from concio.solvers.path.record import Outcome
from concio.solvers.path.step_path import follow_in_steps

WEIGHT = Stage("weight", {"dead": 1.0}, steps=1)


@pytest.fixture(scope="module")
def small():
    return assemble(wall(length=1.0, height=0.5, horizontal=1.0, friction=0.6, mesh_size=0.125))


@pytest.fixture(scope="module")
def exact(small):
    return run_path(small, [WEIGHT, Stage("push", {"live": 0.5})])


@pytest.fixture(scope="module")
def fallen(small):
    return run_path(small, [WEIGHT, Stage("push", {"live": 1.0}), Stage("never", {"dead": 2.0})])


def test_stages_factors_and_certificates(exact):
    assert exact.complete
    assert exact.notes == ()
    assert exact.steps[-1].factors == {"dead": 1.0, "live": pytest.approx(0.5)}
    stages = [s.stage for s in exact.steps]
    assert stages == sorted(stages)
    assert exact.certificate <= 1e-9
    assert exact.energy_error <= 1e-9
    spent = np.diff([s.state.dissipation for s in exact.steps])
    assert spent.min() >= -1e-12 * max(s.state.work for s in exact.steps)


def test_events_are_named(exact):
    assert exact.events
    names = {b.name for b in exact.assembly.model.bodies}
    for event in exact.events:
        assert set(event.bodies) <= names
        assert event.kind in ("opens", "closes", "slips", "sticks")
        step = exact.steps[event.step]  # the stage begins where the one before ended
        assert event.parameter == pytest.approx(step.parameter if step.stage == event.stage else 0.0)
        assert event.bodies[0] in str(event)


@pytest.mark.long
def test_steps_converge_to_the_exact_path(small, exact):
    errors = []
    for n in (4, 16):
        stages = [WEIGHT, Stage("push", {"live": 0.5}, steps=n)]
        found = run_path(small, stages, method="steps", solver="interior-point")
        assert found.complete
        assert found.certificate <= 1e-9
        assert found.energy_error <= 1e-9
        gap = found.steps[-1].state.displacement - exact.steps[-1].state.displacement
        errors.append(np.abs(gap).max() / np.abs(exact.steps[-1].state.displacement).max())
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 2e-4


def test_without_friction_the_step_size_does_not_matter():
    """Bodies pressed on smooth joints: one step, ten steps and the events end in the same place."""
    model = assemble(wall(length=1.0, height=0.5, friction=0.0, mesh_size=0.125, top_pressure=20.0, side_walls=True))
    stages = [Stage("all", {"dead": 1.0, "top": 1.0})]
    ends = [run_path(model, stages).steps[-1].state.displacement]
    for n in (1, 10):
        one = [replace(stages[0], steps=n)]
        found = run_path(model, one, method="steps", solver="interior-point")
        ends.append(found.steps[-1].state.displacement)
    size = np.abs(ends[0]).max()
    assert np.abs(ends[1] - ends[2]).max() <= 1e-9 * size
    assert np.abs(ends[0] - ends[1]).max() <= 1e-9 * size


def test_control_point_passes_the_peak(small):
    point = ControlPoint("c04-b01", (0.0, 0.5))
    found = run_path(small, [WEIGHT, Stage("push", {"live": 1.0}, control=point, until=2e-5)])
    moved, load = found.curve(point, stage=1)
    assert moved[-1] - moved[0] == pytest.approx(2e-5, rel=1e-9)
    assert load[0] == 0.0
    assert found.peak() <= limit(small, path=False).associated.multiplier * (1 + 1e-9)


@pytest.mark.long  # test_path_report follows a block to its fall
def test_load_that_cannot_be_carried(fallen):
    assert fallen.outcomes[-1] is Outcome.LIMIT
    assert len(fallen.outcomes) == 2
    assert not fallen.complete
    assert fallen.peak() < 0.6 + 1e-9
    assert "grows no further" in fallen.notes[-1]
    assert fallen.events[-1].step == len(fallen.steps) - 1


def test_what_falls_under_its_own_weight_is_not_tried_at_smaller_and_smaller_loads():
    tried = []

    def solver(problem):
        tried.append(problem)
        return find("auto")(problem)

    leaning = assemble(wall(length=1.0, height=0.5, horizontal=1.0, friction=0.6, block="rigid"))
    path = LinearPath(leaning.problem({"dead": 0.0, "live": 0.0}), leaning.problem({"dead": 1.0, "live": 1.0}).f)
    found = follow_in_steps(path, at_rest(path.problem), until=1.0, steps=4, solver=solver)
    assert found.outcome is Outcome.LIMIT
    assert len(found.states) == 1
    assert len(tried) == 1


def test_restart_from_a_step(small, exact):
    middle = len(exact.steps) // 2
    rest = run_path(small, [Stage("push", {"live": 0.5})], restart=(exact, middle))
    gap = rest.steps[-1].state.displacement - exact.steps[-1].state.displacement
    assert np.abs(gap).max() <= 1e-9 * np.abs(exact.steps[-1].state.displacement).max()
    assert rest.steps[-1].state.dissipation == pytest.approx(exact.steps[-1].state.dissipation, rel=1e-9)


def test_unloading_leaves_a_trace(small, exact):
    back = run_path(small, [Stage("off", {"live": 0.0})], restart=(exact, -1))
    weight = next(s for s in exact.steps[::-1] if s.stage == 0)
    assert back.complete
    assert back.steps[-1].factors["live"] == pytest.approx(0.0, abs=1e-12)
    left = back.steps[-1].state.displacement - weight.state.displacement
    assert np.abs(left).max() > 1e-3 * np.abs(exact.steps[-1].state.displacement).max()
    assert back.energy_error <= 1e-9


def test_too_many_events_go_on_in_steps(small):
    found = run_path(
        small, [WEIGHT, Stage("push", {"live": 0.5}, steps=8)], max_events=5, solver="interior-point"
    )  # fmt: skip
    assert found.complete
    assert "steps" in found.notes[0]


def test_result_of_a_step(exact):
    result = exact.result(-1)
    assert result.solved
    assert result.certificate.certified
    weight = -sum(b.area * 20.0 for b in exact.assembly.model.free_bodies)
    assert result.reactions["ground"][1] == pytest.approx(-weight, rel=1e-9)
    assert result.reactions["ground"][0] == pytest.approx(0.5 * weight, rel=1e-9)


@pytest.mark.long
def test_limit_of_rigid_and_elastic_blocks_agree():
    size = {"length": 1.6, "height": 0.8, "block_size": (0.4, 0.2), "mesh_size": 0.2}
    found = [limit(wall(**size, horizontal=1.0, friction=0.65, block=kind)) for kind in ("rigid", "elastic")]
    rigid, elastic = found
    assert rigid.associated.checked
    assert elastic.associated.checked
    assert rigid.associated.multiplier == pytest.approx(elastic.associated.multiplier, rel=1e-9)
    for r in found:
        low, high = r.bracket
        assert 0.5 * high < low <= high * (1 + 1e-9)
        assert r.first_limit <= r.coulomb
        assert r.collapse_state is not None
        assert r.collapse_state.certified
        assert r.summary()["checked"]
    assert rigid.collapse_state.multiplier == pytest.approx(elastic.collapse_state.multiplier, rel=1e-6)
    assert rigid.lent_compliance > 0
    assert elastic.lent_compliance == 0


def test_friction_margin(small):
    """Sliding on the base governs: the smallest friction is the load factor."""
    assert friction_margin(small, factor=0.3).factor * 0.6 == pytest.approx(0.3, abs=1e-6)


def test_settlement_turns_the_base():
    """A wall on a base that tilts by less than friction and slenderness allow stays; reactions keep the weight."""
    tilt = Support("tilt", "ground", rotation=1e-4)
    model = replace(wall(length=1.0, height=0.5, friction=0.65, mesh_size=0.25), supports=(tilt,))
    found = settle(model)
    assert found.reached
    assert found.share[[0, -1]] == pytest.approx([0.0, 1.0])
    assert found.reactions["ground"][:, 1] == pytest.approx(10.0, rel=1e-9)
    assert found.path.certificate <= 1e-9


@pytest.mark.parametrize(
    ("stages", "message"),
    [
        ([], "at least one stage"),
        ([Stage("x", {"wind": 1.0})], "no load group 'wind'"),
        ([Stage("x", {"dead": 1.0}, control=ControlPoint("nobody", (0, 0)), until=1.0)], "no body called 'nobody'"),
        ([Stage("x", {"dead": 1.0}, control=ControlPoint("c01-b01", (0, 0), (0, 0)), until=1.0)], "no length"),
    ],
)
def test_bad_input(small, stages, message):
    with pytest.raises(InputError, match=message):
        run_path(small, stages)
    with pytest.raises(InputError, match="no load group"):
        limit(small, "wind")
    with pytest.raises(InputError, match="no support is moved"):
        settle(small)


def test_rigid_blocks_on_hard_joints_borrow_a_compliance():
    """Their forces are not determined otherwise; the note says how much, and the bound of the load still holds."""
    model = wall(length=1.0, height=0.5, horizontal=1.0, friction=0.6, block="rigid")
    found = run_path(model, [WEIGHT, Stage("push", {"live": 0.3})])
    assert found.complete
    assert "given a compliance" in found.notes[0]
    assert found.certificate <= 1e-9
    assert found.energy_error <= 1e-9
    reaction = found.result().reactions["ground"]
    assert reaction[0] == pytest.approx(-0.3 * reaction[1], rel=1e-9)
    half = assemble(replace(model, bodies=tuple(
        replace(b, kind="elastic", material="elastic") if b.name == "c01-b01" else b for b in model.bodies
    ), materials={**model.materials, "elastic": Elastic(1e6, 0.2, unit_weight=20.0)}))  # fmt: skip
    lent = lent_assembly(half)
    assert lent.lent_compliance > 0
    soft = lent.laws.normal_compliance > 0
    one = [b.name for b in half.model.bodies].index("c01-b01")
    assert (soft == ~((half.pairs.body_a == one) | (half.pairs.body_b == one))).all()


def test_a_stage_that_ends_where_it_begins(small):
    found = run_path(small, [WEIGHT, Stage("push", {"live": 0.1}), Stage("same", {"live": 0.1})])
    assert found.complete
    assert found.peak(1) == pytest.approx(1.0)


@pytest.mark.long
def test_a_support_that_sinks_breaks_the_grip_of_the_joint_above_it():
    """Redundant hard pairs forbid the motion until their self-stress has grown to the sliding strength.

    The blocks of a course that meet above the step of the ground touch it and each other: not one of the three pairs
    of that corner can stay as it is. The path goes on as steps do, which know nothing of rates. One block of the top
    course balances on a single point: its rotation is left open, so that displacements agree less well than forces.
    """
    ground = [Body(n, np.array([[x, -0.2], [x + 0.5, -0.2], [x + 0.5, 0.0], [x, 0.0]]), kind="fixed")
              for n, x in (("left", 0.0), ("right", 0.5))]  # fmt: skip
    sink = Support("sink", "right", displacement=(0.0, -1e-5))
    model = wall(length=1.0, height=0.5, friction=0.6, mesh_size=0.25)
    blocks = [b for b in model.bodies if b.name != "ground"]
    model = assemble(replace(model, bodies=(*blocks, *ground), supports=(sink,)))
    stages = [WEIGHT, Stage("sink", {"settlement": 1.0}, steps=64)]
    found = run_path(model, stages)
    assert found.complete
    assert not found.notes
    assert found.certificate <= 1e-9
    assert found.energy_error <= 1e-9
    first = next(i for i, s in enumerate(found.steps) if s.stage == 1)
    before, after = found.steps[first - 1].state, found.steps[first].state
    assert found.steps[first].parameter == 0.0  # forces change while nothing moves
    assert np.abs(after.displacement - before.displacement).max() <= 1e-12 * np.abs(before.displacement).max()
    assert np.abs(after.friction_force - before.friction_force).max() > 1e-3
    walked = run_path(model, stages, method="steps", solver="interior-point")
    gap = walked.steps[-1].state.displacement - found.steps[-1].state.displacement
    assert np.abs(gap).max() <= 0.1 * 1e-5
    forces = found.steps[-1].state.normal_force
    assert np.abs(walked.steps[-1].state.normal_force - forces).max() <= 1e-4 * np.abs(forces).max()


def test_ties_are_no_hard_joints():
    """Mortar and a tie without shear: nothing is hard; the path said that hard joints were given compliance."""
    mortar = JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)
    tie = Tie("t", "c01-b01", (0.0, 0.1), "", (-2.0, 0.1), stiffness=1e4)
    tied = replace(wall(length=1.0, height=0.2, horizontal=0.3, friction=mortar, block="rigid"), ties=(tie,))
    assert lent_assembly(tied).lent_compliance == 0.0
    assert run_path(tied, [WEIGHT]).notes == ()
    hard = replace(tied, laws={name: replace(law, tangential_stiffness=None) for name, law in tied.laws.items()})
    assert lent_assembly(hard).lent_compliance > 0.0
