"""Derivatives of alpha_0 where joints slide, beside differences of collapse states that are sought again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.coulomb_sensitivity import coulomb_sensitivity
from concio.analysis.parameters import parameters_of
from concio.analysis.seismic.assessment_asked import Head
from concio.analysis.seismic.local_mechanism import LocalMechanism
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.analysis.sensitivity import Sensitivity
from concio.contact.assembly import assemble
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.report.assessment_page import AssessmentReport
from concio.solvers.statics.collapse_search import find_collapse_state
from concio.solvers.statics.collapse_state import CollapseState
from samples import sample
from seismic_walls import overturning, site

CENTRAL = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0


def asked(model: Model, **more: object) -> tuple[LocalMechanism, Sensitivity | None]:
    found = concio.assess(model, site=site(), direction="left", levels=["SLD"], elsewhere=("out of plane",), **more)  # type: ignore[arg-type]
    assert found.worst is not None
    return found.worst, found.sensitivity()


@pytest.mark.long
@settings(max_examples=sample(2, 4, 10), deadline=None)
@given(st.floats(0.05, 0.09), st.integers(2, 4), st.floats(15.0, 25.0))
def test_a_wall_that_slides_on_its_foot(friction: float, n: int, weight: float) -> None:
    """alpha_0 = mu: every weight rests on the joint that slides; nothing else matters."""
    model = replace(overturning(n, friction=friction), materials={"block": concio.Rigid(weight)})
    here, told = asked(model)
    assert here.found.flow == "Coulomb"
    assert told is not None
    assert told["friction of joint"].rate == pytest.approx(1.0, abs=1e-8)
    assert told["unit weight of block"].rate == pytest.approx(0.0, abs=1e-8)
    assert told["length of y"].rate == pytest.approx(0.0, abs=1e-8)


@pytest.mark.long
@settings(max_examples=sample(1, 2, 8), deadline=None)
@given(st.floats(0.31, 0.45), st.floats(0.42, 0.6), st.floats(1.0, 6.0))
def test_walls_whose_blocks_slide_and_turn(friction: float, length: float, load: float) -> None:
    """Each model beside has its own search; what is not given is not compared."""
    wall = concio.wall(length=2 * length, height=0.5, block_size=(length, 0.25), friction=friction, block="rigid",
                       horizontal=1.0)  # fmt: skip
    top = max(wall.bodies, key=lambda b: (float(b.centroid[1]), float(b.centroid[0])))
    point = concio.Load("point", (0.0, -load), bodies=(top.name,), at=tuple(top.centroid.tolist()), group="roof")
    model = replace(wall, loads=(*wall.loads, point))

    def loaded(changed: Model) -> tuple[ContactProblem, np.ndarray]:
        return Mechanisms(assemble(changed), ("live",), 1.0).loaded()

    def state(changed: Model) -> CollapseState | None:
        return find_collapse_state(*loaded(changed)).state

    here = state(model)
    assert here is not None
    told = coulomb_sensitivity(*loaded(model), here, loaded, parameters_of(model, ("live",)))
    if told is None:
        return
    for p in parameters_of(model, ("live",)):
        row = next((r for r in told.rows if r.name == p.name), None)
        beside = [] if row is None else [state(p.change(p.value * (1 + 1e-3 * k))) for k in (-2, -1, 1, 2)]
        if row is None or any(s is None for s in beside):
            continue
        slope = float(CENTRAL @ [s.multiplier for s in beside if s is not None]) / (1e-3 * p.value)
        assert row.rate == pytest.approx(slope, abs=1e-8 * max(abs(row.rate), here.multiplier / p.value)), p.name


@pytest.mark.long
def test_the_report_of_a_wall_that_slides_has_bars_and_a_sentence() -> None:
    found = concio.assess(overturning(3, friction=0.08), site=site(), direction="left", levels=["SLV"])
    told = found.sensitivity()
    assert told is not None
    for language, words in (("en", "by virtual work"), ("it", "con i lavori virtuali")):
        text = AssessmentReport(found, head=Head(), sensitivity=told, language=language).html()
        assert words in text
        assert "figure class=\"bars\"" in text


@pytest.mark.long
def test_a_corner_in_space_that_slides_without_pressure() -> None:
    """Only lengths matter where no friction does work; scaling both axes leaves alpha_0 as it is."""
    corner = concio.walls(lines=[((0, 0), (0, 1.5)), ((0, 0), (1.5, 0))], height=1.0, block_size=(0.5, 0.25, 0.25),
                          block="rigid", friction=0.6)  # fmt: skip
    found = concio.assess(corner, site=site(), direction="-x", levels=["SLD"])
    worst, told = found.worst, found.sensitivity()
    assert worst is not None
    assert worst.found.flow == "Coulomb"
    assert told is not None
    alpha = worst.multiplier
    assert told["length of x"].rate + told["length of y"].rate + told["length of z"].rate == pytest.approx(0, abs=1e-6)
    assert told["unit weight of block"].rate * 20.0 == pytest.approx(0.0, abs=1e-6 * alpha)
