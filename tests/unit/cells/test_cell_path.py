"""Paths of macroscopic strain and stress: unilateral response, control, energy, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.errors import InputError
from concio.solvers.path.record import Outcome

LAW = concio.JointLaw(0.6, normal_stiffness=3e5, tangential_stiffness=1e5)
RIGID = concio.cell(block="rigid", block_size=(0.25, 0.06), friction=LAW, thickness=0.4)
ELASTIC = concio.cell(block=concio.Elastic(1e7, 0.2), block_size=(0.25, 0.125))


def test_a_stack_under_uniaxial_strain_opens_and_closes():
    """One block on compliant joints: kn times the approach in compression, nothing in tension."""
    cell = concio.cell(bond="stack", block="rigid", block_size=(0.3, 0.1), friction=LAW)
    path = concio.strain_path(cell, [{"strain yy": -1e-4}, {"strain yy": 2e-4}, {"strain yy": -1e-4}])
    assert path.complete
    assert path.certificate < 1e-9
    assert np.all(np.abs(path.stress[:, 1] - np.minimum(0.0, 3e5 * 0.1 * path.strain[:, 1])) < 1e-9)
    kinds = [e.kind for e in path.events if e.stage == 1]
    assert kinds.count("opens") == 5  # the pairs of the bed joint, at strain zero
    turn = next(s for s in path.steps if s.stage == 1 and s.parameter > 0)
    assert turn.strain[1] == pytest.approx(0.0, abs=1e-15)
    assert turn.parameter == pytest.approx(1 / 3)


def test_sliding_along_the_beds_begins_where_coulomb_says_and_dissipates():
    cell = concio.cell(bond="stack", block="rigid", block_size=(0.3, 0.1), friction=LAW, thickness=0.4)
    pressed = {"stress yy": -100.0, "stress xx": -100.0}  # heads have to carry the same shear as beds
    path = concio.strain_path(cell, [pressed, {"strain xy": 2e-2}, {"strain xy": -2e-2}])
    assert path.complete
    assert path.stress[:, 2].max() == pytest.approx(0.6 * 100.0)
    assert path.stress[:, 2].min() == pytest.approx(-0.6 * 100.0)
    assert path.stress[1:, 1] == pytest.approx(np.full(len(path.steps) - 1, -100.0))
    assert path.energy_error < 1e-12
    G = 1e5 / (1 / 0.1 + 1 / 0.3)
    slid = 2e-2 - 60.0 / G + 4e-2 - 2 * 60.0 / G
    volume = 0.3 * 0.1 * 0.4
    assert path.steps[-1].state.dissipation == pytest.approx(60.0 * slid * volume)


def test_dry_running_bond_carries_tension_along_the_beds_by_friction():
    """f |S22| b / (2 a), and the load ends there; driven in strain the stress stays there."""
    limit = 0.6 * 100 * 0.25 / (2 * 0.125)
    pulled = concio.strain_path(ELASTIC, [{"stress yy": -100.0}, {"stress xx": 2 * limit}])
    assert pulled.outcomes[-1] is Outcome.LIMIT
    assert not pulled.complete
    assert any("ended at 0.5 of its stage" in note for note in pulled.notes), pulled.notes
    assert pulled.stress[-1] == pytest.approx([limit, -100.0, 0.0], abs=1e-6)
    drawn = concio.strain_path(ELASTIC, [{"stress yy": -100.0}, {"strain xx": 1e-3}])
    assert drawn.complete
    assert drawn.stress[-1] == pytest.approx([limit, -100.0, 0.0], abs=1e-6)
    assert drawn.certificate < 1e-9


def test_the_first_stretch_has_the_homogenised_moduli_and_tangents_follow():
    path = concio.strain_path(ELASTIC, [{"stress yy": -100.0, "stress xx": -30.0}, {"strain xy": 2e-4}])
    moduli = concio.homogenise(ELASTIC)
    assert path.strain[1] == pytest.approx(np.linalg.solve(moduli.matrix, [-30.0, -100.0, 0.0]), rel=1e-9, abs=1e-15)
    for k in range(2, len(path.steps)):
        de, ds = path.strain[k] - path.strain[k - 1], path.stress[k] - path.stress[k - 1]
        if np.abs(de).max() > 1e-9:
            tangent = path.moduli(k).matrix
            assert ds == pytest.approx(tangent @ de, abs=1e-6 * np.abs(tangent).max() * np.abs(de).max())
    assert not path.moduli(-1).closed


@pytest.mark.long
def test_events_and_steps_give_one_answer():
    stages = ({"stress yy": -100.0}, concio.Stage("shear", {"strain xy": 1e-3}, steps=40))
    exact = concio.strain_path(RIGID, stages)
    steps = concio.strain_path(RIGID, stages, method="steps")
    assert exact.complete
    assert steps.complete
    assert steps.stress[-1] == pytest.approx(exact.stress[-1], rel=1e-6, abs=1e-6)


def test_what_a_stage_does_not_name_keeps_its_strain_or_its_stress():
    path = concio.strain_path(RIGID, [{"strain yy": -1e-3}, {"strain xx": -1e-4}, {"stress yy": -5.0}])
    ends = [max(k for k, s in enumerate(path.steps) if s.stage == n) for n in range(3)]
    assert path.strain[ends[1], 1] == pytest.approx(-1e-3)
    assert path.strain[ends[2], 0] == pytest.approx(-1e-4)
    assert path.stress[ends[2], 1] == pytest.approx(-5.0)
    assert path.stress[ends, 2] == pytest.approx(np.zeros(3), abs=1e-12)


def test_rigid_blocks_on_hard_joints_take_stresses_but_no_strains():
    cell = concio.cell(block="rigid", friction=0.6)
    path = concio.strain_path(cell, [{"stress yy": -100.0}, {"stress xy": 100.0}])
    assert path.stress[-1, 2] == pytest.approx(37.5)  # f k + f^2 over k + f, k = 1
    assert "given a compliance" in path.notes[0]
    with pytest.raises(InputError, match="does not determine"):
        concio.strain_path(cell, [{"strain yy": -1e-4}])


def test_a_step_is_a_result_with_tables_and_a_certificate():
    path = concio.strain_path(ELASTIC, [{"stress yy": -100.0}])
    result = path.result()
    assert result.solved
    assert result.factors == pytest.approx({f"strain {c}": v for c, v in zip(("xx", "yy", "xy"), path.strain[-1],
                                                                           strict=True)})  # fmt: skip
    assert {len(column) for column in result.tables.joints().values()} == {6}
    table = path.table()
    assert {len(column) for column in table.values()} == {len(path.steps)}
    assert table["stress_yy"][-1] == pytest.approx(-100.0)
    assert path.summary()["complete"]


def test_stages_come_with_a_file():
    text = """
        [cell]
        block_size = [0.25, 0.125]
        [units]
        force = "N"
        length = "mm"
        [[stages]]
        name = "pressed"
        factors = { "stress yy" = "-100 kPa" }
        [[stages]]
        name = "sheared"
        factors = { "strain xy" = 1e-4, "stress xx" = -0.02 }
    """.replace("[0.25, 0.125]", "[250, 125]")
    model = concio.loads(text)
    pressed, sheared = (dict(s.factors) for s in model.stages)
    assert pressed == {"stress yy": pytest.approx(-100.0)}
    assert sheared == {"strain xy": 1e-4, "stress xx": pytest.approx(-20.0)}
    assert concio.strain_path(model).complete
    again = concio.loads(concio.dumps(model))
    assert [dict(s.factors) for s in again.stages] == [dict(s.factors) for s in model.stages]


@pytest.mark.parametrize(
    ("stages", "words"),
    [
        ((), "at least one stage"),
        (([{}]), "nothing is asked for"),
        (({"strain": 1e-3},), "neither a strain nor a stress"),
        (({"strain zz": 1e-3},), "neither a strain nor a stress"),
        (({"strain xx": 1e-3, "stress xx": 1.0},), "both strain xx and stress xx"),
        (({"strain xx": float("nan")},), "not finite"),
        ((3.0,), "mapping"),
        ((concio.Stage("s", {"strain xx": 1e-3}, concio.ControlPoint("c01-b01", (0, 0)), 0.1),), "control point"),
    ],
)
def test_stages_that_mean_nothing_are_refused(stages, words):
    with pytest.raises(InputError, match=words):
        concio.strain_path(ELASTIC, stages)
    with pytest.raises(InputError, match="no periods"):
        concio.strain_path(concio.running_bond_panel(), {"strain xx": 1e-3})
