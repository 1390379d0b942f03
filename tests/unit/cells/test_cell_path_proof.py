"""Every state of a cell's path is checked in the cell's own problem, never in what the path interpolated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis.cells import cell_path as paths

LAW = concio.JointLaw(0.6, normal_stiffness=3e5, tangential_stiffness=1e5)
CELL = concio.cell(block="rigid", block_size=(0.25, 0.06), friction=LAW, thickness=0.4)
STAGES = [{"stress yy": -100.0, "stress xx": -20.0}, {"strain xy": 2e-4}, {"stress yy": -60.0, "strain xy": 3e-4}]

WRONG = {
    "slips go the other way": lambda path: {"tangent_rate": -path.tangent_rate},
    "half the opening": lambda path: {"gap_rate": 0.5 * path.gap_rate},
    "no opening": lambda path: {"gap_rate": 0.0 * path.gap_rate},
    "a thousandth of the stress": lambda path: {"load_rate": 1.001 * path.load_rate},
}


@pytest.mark.parametrize("name", WRONG)
def test_a_path_that_interpolates_wrongly_is_not_certified(name, monkeypatch):
    right = paths._linear

    def wrong(*arguments):
        path, lent = right(*arguments)
        return replace(path, **WRONG[name](path)), lent

    assert concio.strain_path(CELL, STAGES).certificate <= 1e-9
    monkeypatch.setattr(paths, "_linear", wrong)
    stages = [*STAGES, {"strain yy": -1e-3}]
    assert concio.strain_path(CELL, stages).certificate > 1e-6


def test_lent_compliance_is_the_same_in_every_stage():
    """Joints of unequal length, rigid blocks: what was stored in one stage is got back in the next."""
    cell = concio.cell(block="rigid", block_size=(0.3, 0.05), lap=0.3, friction=0.7)
    path = concio.strain_path(cell, [{"stress yy": -100.0}, {"stress yy": -200.0}, {"stress yy": -100.0}])
    assert path.complete
    assert path.certificate <= 1e-9
    ends = [max(i for i, s in enumerate(path.steps) if s.stage == k) for k in (0, 2)]
    first, last = (path.steps[i].stored for i in ends)
    assert last == pytest.approx(first, rel=1e-9)
    assert path.energy_error <= 1e-9


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_stress_that_did_not_come_out_stands_in_the_certificate_as_its_share(scale):
    """100 kN/m2 were asked for and 99 came out: one per cent of the largest contact force, at any size of the cell."""
    law = concio.JointLaw(0.6, normal_stiffness=3e5 / scale, tangential_stiffness=1e5 / scale)
    size = (0.25 * scale, 0.06 * scale)
    cell = concio.cell(block="rigid", bond="stack", block_size=size, friction=law, thickness=0.4 * scale)
    path = concio.strain_path(cell, {"stress yy": -100.0})
    last = path.steps[-1]
    wanted = last.stress - np.array([0.0, 1.0, 0.0])
    (again,) = paths._certified(path.cell, path.cell.assembly.laws, [last], [wanted])
    points = (last.state.normal_force > 0).sum()
    share = 0.25 * 0.4 * scale**2 / last.state.normal_force.max()  # force that 1 kN/m2 is, over the largest
    assert points > 1
    assert again.certificate.equilibrium == pytest.approx(share * 0.06 * scale / path.cell.size, rel=1e-6)
