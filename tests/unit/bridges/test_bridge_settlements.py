"""Abutments that give way below fill: soil that presses in settlements, and in what explains cracks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.model.fill import Fill
from concio.model.road.earth import with_fill, without_pressure

ERROR = 0.2e-3


def filled(k: float = 1.0) -> concio.Model:
    """Return a small arch with fill and no vehicle."""
    bare = concio.bridge(span=3.0, rise=0.75, ring=0.215, voussoirs=12, width=2.0, block="rigid", unit_weight=22.0,
                         friction=0.6)  # fmt: skip
    return with_fill(bare, Fill(cover=0.3, unit_weight=20.0, passive=k))


def settled(model: concio.Model, spread: float) -> concio.SettlementResult:
    """Return it with its left abutment moved outwards [m]."""
    support = concio.Support("spread", "left abutment", displacement=(-spread, 0.0))
    return concio.settle(replace(model, supports=(support,)))


@pytest.mark.parametrize("spread", [5e-3, -5e-3])
def test_soil_presses_within_its_caps_and_balances_the_thrust_of_an_arch_that_settles(spread: float) -> None:
    """Soil resists the half that moves into it, and that alone; its pressure is the difference of both thrusts."""
    model = filled()
    found = settled(model, spread)
    assert found.reached
    pressed = found.path.result(len(found.path.steps) - 1).ties.tension
    caps = np.array([t.yield_force for t in model.ties])
    assert (pressed >= -1e-9).all()
    assert (pressed <= caps * (1 + 1e-9)).all()
    halves = pressed[:6].sum(), pressed[6:].sum()
    moved, other = halves if spread > 0 else halves[::-1]
    assert moved > 0
    assert other == pytest.approx(0.0, abs=1e-9)
    left, right = (found.reactions[f"{side} abutment"][-1, 0] for side in ("left", "right"))
    assert left + right + halves[0] - halves[1] == pytest.approx(0.0, abs=1e-6)


def test_with_pressure_that_tends_to_nothing_a_settlement_is_that_under_weight_alone() -> None:
    alone, little = (settled(m, 5e-3) for m in (without_pressure(filled()), filled(1e-9)))
    for name, reaction in alone.reactions.items():
        assert little.reactions[name][-1] == pytest.approx(reaction[-1], rel=1e-6, abs=1e-6)
    assert settled(filled(), 5e-3).reactions["left abutment"][-1, 0] < 0.5 * alone.reactions["left abutment"][-1, 0]


@pytest.mark.long
def test_the_cause_of_what_a_filled_arch_shows_is_found() -> None:
    """What is measured comes from a settlement. Soil moves the hinges: without it nothing explains the levels."""
    model, spread = filled(), 4e-3
    found = settled(model, spread)
    end, begin = found.path.result(len(found.path.steps) - 1), found.path.result(0)
    measured = []
    for name in ("v03", "v06", "v10"):
        at = model.body(name).vertices[0]
        sunk = end.node_displacement(name)[0, 1] - begin.node_displacement(name)[0, 1]
        measured.append(concio.Measurement(name, "level", ERROR, float(sunk), body=name, at=tuple(at)))
    candidates = [
        concio.Candidate("left gives way", body="left abutment", direction=(-1, 0), low=0.0),
        concio.Candidate("right sinks", body="right abutment", direction=(0, -1), low=0.0),
    ]
    told = concio.diagnose(model, measured, candidates, large=False)
    assert [c.names for c in told.causes] == [("left gives way",)]
    assert told.causes[0].motion[0] == pytest.approx(spread, abs=2 * ERROR)
    assert not concio.diagnose(without_pressure(model), measured, candidates, large=False).causes
