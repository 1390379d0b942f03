"""The leading number of a state and its derivatives, beside closed forms and differences of solved states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.parameters import parameters_of, stiffnesses_of
from concio.analysis.state_numbers import LeadingNumber, leading_number
from concio.report.page import report_html
from samples import sample


def leading(model: concio.Model) -> LeadingNumber | None:
    result = concio.solve(model)
    return leading_number(result, concio.state_sensitivity(result))


@pytest.mark.long
@settings(max_examples=sample(4, 20), deadline=None)
@given(st.floats(0.5, 4.0), st.floats(5.0, 30.0), st.floats(1.0, 300.0))
def test_a_pillar_shortens_by_weight_and_pressure(height: float, weight: float, pressure: float) -> None:
    stone = concio.Elastic(E=2e6, nu=0.0)
    found = leading(concio.column(width=0.5, height=height, blocks=1, block=stone, unit_weight=weight,
                                  top_pressure=pressure, horizontal=0.0))  # fmt: skip
    assert found is not None
    assert found.kind == "settlement"
    own, top = weight * height**2 / 2 / 2e6, pressure * height / 2e6
    assert found.value == pytest.approx(own + top, rel=1e-9)
    shares = {"unit weight of block": own, "load of top": top, "stiffness of block": -own - top}
    for name, part in shares.items():
        assert found.sensitivity[name].per_percent[1] == pytest.approx(part / (own + top), abs=1e-8), name


@pytest.mark.long
@pytest.mark.parametrize("kind", ["settlement", "force"])
def test_derivatives_are_those_of_the_number_that_is_told(kind: str) -> None:
    """The number is read from results that are solved again, by its words alone."""
    if kind == "settlement":
        model = concio.arch(span=3.0, ring=0.4, voussoirs=6, friction=0.6, crown_load=2.0, unit_weight=25)
    else:
        model = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.5, horizontal=0.1, block="rigid")
    found = leading(model)
    assert found is not None
    assert found.kind == kind

    def told(other: concio.Model) -> float:
        result = concio.solve(other)
        if kind == "settlement":
            return result.max_settlement
        joints = result.tables.joints()
        names = [f"{a} | {b}" for a, b in zip(joints["body_a"], joints["body_b"], strict=True)]
        assert names.count(found.of) == 1
        return float(joints["normal_force"][names.index(found.of)])

    assert told(model) == pytest.approx(found.value, rel=1e-6)
    compared = 0
    for p in (*parameters_of(model), *stiffnesses_of(model)):
        if p.name not in {row.name for row in found.sensitivity.rows}:
            continue
        h = 1e-4 * p.value
        beside = [told(p.change(p.value + k * h)) for k in (-2, -1, 1, 2)]
        rate = (beside[0] - 8 * beside[1] + 8 * beside[2] - beside[3]) / (12 * h)
        assert found.sensitivity[p.name].rate == pytest.approx(rate, abs=1e-7 * found.value / p.value), p.name
        compared += 1
    assert compared >= 4


def test_forces_that_are_not_determined_have_no_derivative_and_displacements_have() -> None:
    """In a bonded elastic wall points of several joints fall together: their forces are shared in many ways."""
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.5, horizontal=0.05)
    found = concio.state_sensitivity(concio.solve(wall))["unit weight of block"]
    assert found.above is not None
    assert np.isnan(found.above.normal_force).any()
    assert np.isfinite(found.above.displacement).all()


@pytest.mark.long
@pytest.mark.parametrize(
    ("language", "heading", "words"),
    [("en", "What this state depends on", "derivatives of the certified state"),
     ("it", "Da che cosa dipende questo stato", "derivate dello stato certificato")],
)  # fmt: skip
def test_the_report_of_a_step_shows_bars_and_a_sentence(language: str, heading: str, words: str) -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=2, unit_weight=20.0, horizontal=0.05)
    page = report_html(concio.solve(pillar), language=language)  # type: ignore[arg-type]
    assert page.index(heading) < page.index(words)
    falls = replace(pillar, loads=(*pillar.loads, concio.Load("weight", (2.0, 0.0))))
    assert heading not in report_html(concio.solve(falls, on_failure="return"), language=language)  # type: ignore[arg-type]
