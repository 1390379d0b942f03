"""Every state of a cell's path is checked in the cell's own problem, never in what the path interpolated."""

from __future__ import annotations

from dataclasses import replace

import pytest

import concio
from concio.analysis.cells import path as paths

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
