"""Dry granite walls of Vasconcelos (2005) and Vasconcelos and Lourenço (2009): statics asserted, tests compared."""

from __future__ import annotations

import numpy as np
import pytest
from validation_cases import granite_walls
from validation_cases.row import check

import concio
from concio.analysis.path import Stage, run_path
from concio.solvers.path.record import Outcome


@pytest.mark.long  # their bounds are examined below
def test_rows():
    check(granite_walls.rows())


@pytest.mark.parametrize("n", granite_walls.PEAKS)
def test_no_measured_peak_lies_above_the_upper_bound(n):
    """The bound knows no crushing and no imperfection: a test above it would refute the model."""
    assert granite_walls.PEAKS[n] < granite_walls.bound(n)


@pytest.mark.long
def test_elastic_wall_snaps_and_carries_on():
    """At 20.9 kN a corner of the wall snaps; one step from rest carries more, and so must the path."""
    assembly = concio.assemble(granite_walls.model(100.0, elastic=True))
    assert concio.solve(assembly, factors={"push": 21.5}).solved
    found = run_path(assembly, [Stage("weight", {"dead": 1.0}), Stage("push", {"push": 21.5})])
    assert found.complete
    jumps = [e for e in found.events if e.kind == "jumps"]
    assert jumps
    assert jumps[0].parameter * 21.5 == pytest.approx(20.898, abs=1e-3)
    assert any("jump" in note for note in found.notes)
    assert found.certificate <= 1e-9
    assert found.energy_error <= 1e-9
    assert np.diff([s.state.dissipation for s in found.steps]).min() >= -1e-12
    assert all(abs(v) > 1e-9 or v == 0 for e in found.events for v in e.at)  # no rounding of zero is printed


@pytest.mark.long
def test_elastic_wall_to_its_collapse():
    """The path ends in the collapse state that linear programmes find for rigid blocks without stiffness."""
    assembly = concio.assemble(granite_walls.model(100.0, elastic=True))
    found = run_path(assembly, [Stage("weight", {"dead": 1.0}), Stage("push", {"push": 50.0})])
    assert found.outcomes[-1] is Outcome.LIMIT
    assert found.certificate <= 1e-9
    assert found.energy_error <= 1e-9
    assert 50.0 * found.peak() == pytest.approx(granite_walls.collapse(100.0), rel=1e-6)
    assert 50.0 * found.peak() <= granite_walls.bound(100.0)
