"""The least strengthening for a value of zeta_E: brackets of whole assessments, against closed forms of the onset."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from commands import run
from concio import Body, JointLaw, Load, Model, Rigid, Tie
from concio.analysis.seismic.strengthening import Measure, least_amount, strengthen
from concio.errors import InputError
from concio.model.file.assessment_table import StrengthenTable
from concio.model.file.reading import file_units
from concio.report.assessment_page import AssessmentReport
from samples import sample
from seismic_walls import courses, overturning, site

ONSET = {"SLD": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}


def asked(zeta_at_alpha: float = 0.0, **more: Any) -> dict[str, Any]:
    """Return the arguments of an assessment at the onset alone, in which zeta_E is alpha_0 over what is demanded."""
    return {"site": site(hazard=ONSET), "direction": "left", "elsewhere": ("out of plane", "ties"), **more}


def pillar(width: float = 0.5, height: float = 2.0, n: int = 1, friction: float = 0.8) -> Model:
    ground = Body("ground", np.array([[-6, -0.5], [6, -0.5], [6, 0], [-6, 0.0]]), kind="fixed")
    return Model((ground, *courses(n, height, width)), {"block": Rigid(20.0)}, {"joint": JointLaw(friction)},
                 loads=(Load("weight", (0.0, -1.0)),))  # fmt: skip


@settings(max_examples=sample(6, 60, 200), deadline=None)
@given(st.floats(1e-3, 0.999), st.floats(0.5, 3.0), st.floats(1e-3, 1e3))
def test_the_bracket_holds_the_root_of_a_rising_function(at: float, power: float, most: float) -> None:
    def missing(x: float) -> float:
        return (x / most) ** power - at**power

    found, below = least_amount(missing, most)
    assert missing(found) >= 0 > missing(below)
    assert below < found <= at * most * (1 + 1e-3) + 1e-6 * most
    assert found - below <= 1e-3 * found + 1e-6 * most


def test_none_needed_and_none_that_does() -> None:
    assert least_amount(lambda x: 1.0, 5.0)[0] == 0.0
    assert least_amount(lambda x: -1.0, 5.0) == (math.inf, 5.0)


@pytest.mark.long
def test_a_buttress_widens_the_base() -> None:
    """More than the wall alone carries, less than wall and buttress as one block about the toe of the buttress."""
    model = pillar()
    before = concio.assess(model, **asked())
    wanted = 1.5 * before.least
    found = strengthen(model, Measure("buttress", ("c1",), side="left", unit_weight=20.0), zeta=wanted, **asked())
    assert found.fails_at < found.amount < 2.0
    assert found.trials[found.fails_at] < wanted <= found.trials[found.amount]
    assert found.before is not None
    assert found.before.least == pytest.approx(before.least)
    worst = found.after.worst
    assert worst is not None
    w = found.amount
    together = (w * w / 2 + 0.5 * (w + 0.25)) / (w + 0.5)  # equal heights: both at 1 m
    assert 0.25 < worst.multiplier <= together * (1 + 1e-9)


def test_mass_on_top_of_a_wall_bent_by_wind_holds_it() -> None:
    """Constant wind overturns; weight on the wall resists it, and pushes only by the multiplier."""
    model = pillar()
    wind = Load("pressure", (2.0,), bodies=("c1",), edge=((0.5, 0.0), (0.5, 2.0)), group="wind")
    model = replace(model, loads=(*model.loads, wind))
    wanted = 1.3 * concio.assess(model, **asked()).least
    found = strengthen(model, Measure("mass", ("c1",)), zeta=wanted, largest=200.0, **asked())
    W = 20.0 * 0.5 * 2.0 + found.amount
    worst = found.after.worst
    assert worst is not None
    assert worst.multiplier == pytest.approx((W * 0.25 - 2.0 * 2.0) / W, rel=1e-9)
    assert found.trials[found.fails_at] < wanted <= found.reached


@pytest.mark.long
def test_grout_holds_what_slides_and_not_what_turns() -> None:
    stout = pillar(width=3.0, height=1.0, n=2, friction=0.2)
    before = concio.assess(stout, **asked())
    assert before.worst is not None
    assert before.worst.multiplier == pytest.approx(0.2, rel=1e-6)
    found = strengthen(stout, Measure("grout", ("c*", "ground")), zeta=1.5 * before.least, **asked())
    assert 0 < found.amount < math.inf
    slim = pillar(n=2)
    none = strengthen(slim, Measure("grout", ("c*", "ground")), zeta=2.0 * concio.assess(slim, **asked()).least,
                      **asked())  # fmt: skip
    assert none.amount == math.inf
    assert "no amount up to 500 kN/m2 does" in none.sentence


@pytest.mark.long  # the example of tie_force is run by test_docstring_examples
def test_a_tie_by_either_name_is_the_same() -> None:
    from concio.seismic import tie_force

    tie = Tie("rod", "c1", (0.0, 5.5), "", (-4.0, 5.5), stiffness=1e4, yield_force=1.0)
    model = overturning(ties=(tie,))
    arguments = {"site": site(), "direction": "right", "levels": ["SLV"], "elsewhere": ("out of plane",)}
    one = tie_force(model, "rod", **arguments)
    other = strengthen(model, Measure("tie", ("rod",)), **arguments)
    assert one.force == other.amount
    assert one.reached == other.reached


@pytest.mark.long
def test_the_height_at_which_a_tie_needs_least_is_the_highest_of_a_pillar() -> None:
    """F z is what is missing: W (alpha h/2 - b/2) with alpha at the demand; a lower height after it needs more."""
    tie = Tie("rod", "c2", (0.0, 1.5), "", (-4.0, 1.5), stiffness=1e6, yield_force=1.0)
    model = replace(pillar(n=2), ties=(tie,))
    heights = (0.8, 1.8, 1.4)
    found = strengthen(model, Measure("tie", ("rod",), heights=heights), **asked(direction="right"))
    assert (found.height, found.amount) == (1.8, found.by_height[1.8])
    assert found.by_height[0.8] * 0.8 == pytest.approx(found.amount * 1.8, rel=3e-4)
    assert math.isinf(found.by_height[1.4])
    assert found.reached >= 1.0 > found.trials[found.fails_at]
    assert "at z = 1.8 m" in found.sentence
    assert {t.body_a for t in found.after.model.ties} == {"c2"}
    for language, words in (("en", "height of the tie"), ("it", "quota della catena")):
        page = AssessmentReport(found.after, stronger=found, language=language).html()
        assert words in page
    own = {"kind": "tie", "of": ["rod"], "heights": [0.8, 1.8, 1.4]}
    read = StrengthenTable.model_validate(own, context={"units": file_units({}, "")})
    assert Measure(read.kind, tuple(read.of), heights=tuple(read.heights)).heights == heights


@pytest.mark.parametrize(
    ("measure", "words"),
    [
        (Measure("tie", ("rod",)), "no tie called 'rod'"),
        (Measure("mass", ("roof",)), "'roof' is not a body"),
        (Measure("tie", ("rod",), heights=(1.0,)), "no tie 'rod'"),
        (Measure("buttress", ("c1",), side="right", height=20.0), "no ground under it"),
    ],
)
def test_what_a_model_does_not_have_is_refused(measure: Measure, words: str) -> None:
    with pytest.raises(InputError, match=words):
        strengthen(pillar(), measure, **asked())


NOTHING: list[dict[str, Any]] = [
    {"kind": "wires", "of": ("a",)}, {"kind": "tie", "of": ("a", "b")}, {"kind": "mass", "of": ()},
    {"kind": "buttress", "of": ("a",), "side": "top"}, {"kind": "mass", "of": ("a",), "heights": (1.0,)},
]  # fmt: skip


@pytest.mark.parametrize("given_", NOTHING)
def test_a_measure_that_says_nothing_is_refused(given_: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        Measure(**given_)


@pytest.mark.long
def test_a_file_asks_for_it_and_the_report_shows_before_and_after(tmp_path: Path) -> None:
    assert run("new", "assessment", str(tmp_path / "strip.toml"))[0] == 0
    text = (tmp_path / "strip.toml").read_text(encoding="utf-8")
    text = text.replace('size_tie = "roof tie"                 # find the force that brings zeta_E to one\n', "")
    table = '\n[assessment.strengthen]\nkind = "tie"\nof = ["roof tie"]\nzeta = 0.9\n'
    (tmp_path / "strip.toml").write_text(text + table, encoding="utf-8")
    code, printed, _ = run("assess", str(tmp_path / "strip.toml"), "--out", str(tmp_path / "out"), "--language", "it")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert code in (3, 4)
    assert "strengthening" in printed
    for word in ("Rinforzo", ">prima<", ">dopo<"):
        assert word in page


@pytest.mark.parametrize("kind", ["tie", "mass", "grout"])
@pytest.mark.parametrize("given", [{"side": "right"}, {"height": 3.0}, {"unit_weight": 24.0}])
def test_what_belongs_to_a_buttress_is_refused_elsewhere(kind, given):
    """It was left aside without a word."""
    with pytest.raises(InputError, match=f"a {kind} has no {next(iter(given))}"):
        Measure(kind, ("one",), **given)


@pytest.mark.parametrize("given", [{"height": -1.0}, {"unit_weight": 0.0}])
def test_a_buttress_has_positive_sizes(given):
    with pytest.raises(InputError, match="must be positive"):
        Measure("buttress", ("one",), **given)
