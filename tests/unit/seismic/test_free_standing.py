"""Elements that are free to vibrate: period of a beam, the branch, and what it changes in the checks."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import concio
from concio import JointLaw, Load, Model, Rigid
from concio.analysis.seismic.checks import limit_of
from concio.analysis.seismic.code import find_code
from concio.analysis.seismic.free_standing import FreeStanding
from concio.errors import InputError
from concio.report.assessment_page import AssessmentReport
from seismic_walls import HAZARD, courses, ground, site

E, W, L, T = 0.9e6, 18.0, 3.0, 0.3
"""kN/m2, kN/m3, m, m: a slender parapet of cracked masonry."""


def parapet(n: int = 1) -> Model:
    loads = (Load("weight", (0.0, -1.0)),)
    return Model((ground(), *courses(n, L, T)), {"block": Rigid(W)}, {"joint": JointLaw(0.8)}, loads=loads)


def assessed(**more: Any) -> Any:
    element = {"weakest of all": {"kind": "cantilever", "E": E}}
    arguments = {"site": site(), "direction": "left", "free_standing": element, **more}
    return concio.assess(parapet(), **arguments).worst


@pytest.mark.parametrize(
    ("kind", "root"),
    [("cantilever", brentq(lambda x: math.cos(x) * math.cosh(x) + 1.0, 1.5, 2.2)), ("supported", math.pi)],
)
def test_kappa_is_that_of_the_first_period_of_a_beam(kind: str, root: float) -> None:
    """T = 2 pi L^2 / root^2 sqrt(m / E I) of a beam with m = W t / g and I = t^3 / 12 per unit width."""
    g = 9.81
    period = 2.0 * math.pi * L**2 / root**2 * math.sqrt((W * T / g) / (E * T**3 / 12.0))
    kappa = find_code("ntc2018").tables["free_standing"]["kappa"][kind]
    assert kappa * (L / T) * L * math.sqrt(W / (E * g)) == pytest.approx(period, rel=3e-3)


def test_the_branch_meets_the_curve_of_one_block_in_closed_form() -> None:
    """For one block a = tan(theta_0 - asin(d_C/h)) g/FC, with e* = 1 and d = d_C/2: one equation in d_y."""
    worst = assessed()
    branch, h = worst.branch, L
    FC, g = 1.35, 9.81
    T0 = 6.2 * (L / T) * L * math.sqrt(W / (E * g))

    def over(d: float) -> float:
        rocking = math.tan(math.atan(T / L) - math.asin(2.0 * d / h)) * g / FC
        return rocking - (2.0 * math.pi / T0) ** 2 * d

    d_y = brentq(over, 0.0, 0.1)
    assert worst.e_star == pytest.approx(1.0)
    assert pytest.approx(T0, rel=1e-12) == branch.T0
    assert branch.d == pytest.approx(d_y, rel=2e-4)  # the curve is a polygon of some hundred points
    assert branch.a == pytest.approx((2.0 * math.pi / T0) ** 2 * d_y, rel=2e-4)
    assert branch.a < worst.onset


def test_the_onset_is_felt_at_the_own_period_and_the_displacement_between_both() -> None:
    free, rigid = assessed(), assessed(free_standing=None)
    place = site()
    demand = {(c.level, c.kind): c for c in free.checks}
    spectrum = place.spectrum(place.at("SLD"))
    felt = float(spectrum.acceleration(free.branch.T0, 5.0))
    assert demand["SLD", "onset"].demand == pytest.approx(felt)
    assert demand["SLD", "onset"].capacity == free.branch.a
    assert "C8.7.1.9" in demand["SLD", "onset"].clause
    assert demand["SLV", "linear"].demand == pytest.approx(
        float(place.spectrum(place.at("SLV")).acceleration(free.branch.T0, 5.0)) / 2.0
    )
    plain = {(c.level, c.kind): c for c in rigid.checks}
    assert "C8.7.1.8" in plain["SLD", "onset"].clause
    assert felt > 1.5 * plain["SLD", "onset"].demand  # the spectrum amplifies
    # spectra of the code grow with the period, so the largest between T_0 and T_SLV is that at T_SLV
    assert demand["SLV", "displacement"].demand == pytest.approx(plain["SLV", "displacement"].demand)
    assert demand["SLV", "displacement"].least < plain["SLV", "displacement"].least


def test_the_report_shows_the_branch_with_its_clauses() -> None:
    found = concio.assess(
        parapet(), site=site(building={"height": 6.5, "storeys": 2, "base": -6.5}), direction="left",
        free_standing={"weakest of all": {"kind": "cantilever", "E": E}},
    )  # fmt: skip
    text = AssessmentReport(found, language="it").html()
    for words in ("ramo elastico", "mensola", "[C8.7.1.7]", "[C8.7.1.9]", "snellezza"):
        assert words in text
    assert found.worst is not None
    assert found.worst.level == pytest.approx(6.5)


def test_what_is_not_given_is_taken_from_the_blocks_that_move() -> None:
    element = FreeStanding("cantilever", "900 MPa", length=2.0, thickness="40 cm", unit_weight=20.0)  # type: ignore
    branch = assessed(free_standing={"weakest of all": element}).branch
    assert (branch.length, branch.thickness, branch.unit_weight) == (2.0, pytest.approx(0.4), 20.0)
    own = assessed().branch
    assert (own.length, own.thickness, own.unit_weight) == (pytest.approx(3.0), pytest.approx(0.3), pytest.approx(18.0))


def test_an_element_so_soft_that_it_stays_elastic_is_secant_to_its_branch() -> None:
    soft = assessed(free_standing={"weakest of all": {"kind": "cantilever", "E": 1.0e4}})
    limit = soft.limits["SLV"]
    assert limit.d < soft.branch.d
    assert limit.a == pytest.approx(soft.branch.stiffness * limit.d)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"chimney": {"kind": "cantilever", "E": E}}, "no mechanism 'chimney'"),
        ({"weakest of all": {"kind": "canteliver", "E": E}}, "no kind 'canteliver'"),
        ({"weakest of all": {"kind": "cantilever", "E": 900.0}}, "not a modulus of masonry"),
        ({"weakest of all": {"kind": "cantilever", "E": E, "length": -1.0}}, "must be positive"),
        ({"weakest of all": {"kind": "cantilever", "E": E, "t": 0.3}}, "'t'"),
        ({"weakest of all": {"kind": "cantilever"}}, "E"),
    ],
)
def test_bad_elements_are_refused_in_a_sentence(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as error:
        assessed(free_standing=given)
    assert said in str(error.value)


def test_slo_is_checked_where_asked_and_left_out_of_tables_of_return_periods() -> None:
    slo = {"a_g": 0.05, "F0": 2.4, "Tc": 0.27}
    worst = assessed(site=site(hazard={"SLO": slo, **HAZARD}))
    onset = {c.level: c for c in worst.checks if c.kind == "onset"}
    assert onset["SLO"].capacity == onset["SLD"].capacity
    assert onset["SLO"].demand < onset["SLD"].demand
    rows = [{"T_R": T_R, "a_g": a, "F0": 2.4, "Tc": 0.3} for T_R, a in ((30, 0.05), (475, 0.2), (2475, 0.3))]
    place = site(hazard=rows)
    assert place.levels == ("SLD", "SLV", "SLC")
    assert pytest.approx(30.1, abs=0.05) == place.rules.return_period("SLO", 50.0)
    assert {c.level for c in assessed(site=place, levels=["SLO"]).checks} == {"SLO"}


def test_a_code_laid_over_another_changes_single_numbers(tmp_path: Any) -> None:
    own = tmp_path / "region.toml"
    own.write_text("base = 'ntc2018'\n[levels.SLV]\nq = 1.5\n[clauses]\nlinear = 'own'\n", encoding="utf-8")
    rules = find_code(str(own))
    assert rules.tables["levels"]["SLV"]["q"] == 1.5
    assert rules.tables["levels"]["SLV"]["share"] == 0.40
    assert rules.clause("linear") == "own"
    assert "C8.7.1.5" in rules.clause("share")
    for text, said in (("[levels.SLV]\nQ = 1.5", "no key 'Q'"), ("[level.SLV]\nq = 1.5", "'level'")):
        own.write_text(f"base = 'ntc2018'\n{text}\n", encoding="utf-8")
        with pytest.raises(InputError, match=said):
            find_code(str(own))
    assert np.isfinite(rules.gravity)


@pytest.mark.parametrize("stiffness", [0.1, 1e6])
def test_a_wall_is_nowhere_stiffer_than_its_elastic_branch(stiffness: float) -> None:
    """The acceleration at the limit is the lesser of curve and branch, and the period follows from it."""
    curve = SimpleNamespace(end=1.0, at=lambda _: 0.1)
    rule = {"share": 0.5, "period": 2.0, "damping": 0.05}
    found = limit_of("LSLS", rule, curve, 0.8, 10.0, branch=SimpleNamespace(stiffness=stiffness))
    assert (found.control, found.d) == pytest.approx((0.5, 0.4))
    assert found.a == pytest.approx(min(1.0, stiffness * 0.4))
    assert pytest.approx(2.0 * np.pi * np.sqrt(found.d / found.a)) == found.T
