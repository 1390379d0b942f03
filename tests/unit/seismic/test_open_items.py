"""Mechanisms that were found and not examined to their end leave an assessment incomplete, with a list."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from commands import run
from concio import Assessment, JointLaw, Load, Model, Rigid
from concio.analysis.seismic import examine
from concio.analysis.seismic.curve import CapacityCurve, not_followed
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.report.assessment_page import AssessmentReport
from concio.verdict.verdict import Outcome
from pillars import pillar
from seismic_walls import HAZARD, courses, ground, site

WEAK = {"SLV": {"a_g": 0.05, "F0": 2.45, "Tc": 0.32}, "SLC": {"a_g": 0.15, "F0": 2.45, "Tc": 0.33}}
"""An earthquake under which the strips and the pillar begin to move at SLC and that nothing fails under."""
SITE = """
[site]
soil = "B"
[site.hazard]
SLV = { a_g = 0.05, F0 = 2.45, Tc = 0.32 }
SLC = { a_g = 0.2, F0 = 2.45, Tc = 0.33 }
[assessment]
direction = "left"
levels = ["SLV", "SLC"]
elsewhere = ["out of plane"]
"""


def beside(friction: float = 0.8) -> Model:
    """Return two strips on one ground that do not touch; the second, beyond x = 7 m, is the thicker one."""
    second = [replace(b, name="d1", outline=b.outline + np.array([8.0, 0.0])) for b in courses(1, 4.0, 0.6)]
    bodies = (ground(-2, 20), *courses(1, 4.0, 0.5), *second)
    return Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(friction)}, loads=(Load("weight", (0, -1)),))


def assessed(model: Model, **more: Any) -> Assessment:
    given = {"site": site(hazard=WEAK), "direction": "left", "levels": ["SLV", "SLC"], "elsewhere": ("out of plane",)}
    return concio.assess(model, **{**given, **more})


def lose_curves(monkeypatch: pytest.MonkeyPatch, beyond: float = -1e9) -> None:
    """Let no curve be followed of mechanisms whose first block lies beyond some x."""
    for name in ("follow", "follow_in_steps"):
        known = getattr(examine, name)

        def followed(made: Any, *more: Any, known: Any = known) -> CapacityCurve:
            if float(made.mechanics.blocks[0].centre[0]) > beyond:
                return not_followed("no forces")
            curve: CapacityCurve = known(made, *more)
            return curve

        monkeypatch.setattr(examine, name, followed)


def test_a_mechanism_without_a_curve_leaves_its_limit_state_open(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = assessed(beside())
    assert (whole.verdict.outcome, whole.open) == (Outcome.HOLDS, ())
    lose_curves(monkeypatch)
    found = assessed(beside())
    assert {item.kind for item in found.open} == {"curve"}
    assert [m.name for m in found.mechanisms] == ["weakest of all", "'d1' and what it touches"], "neither was looked at"
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert (found.verdict.exit_code, found.verdict.status, found.holds) == (4, "incomplete", False)
    assert found.verdict.headline.startswith("Incomplete")
    for m in found.mechanisms:
        assert m.unchecked == ("SLC",), "the code has a check without displacements for SLV"
        line = f"'{m.name}', push left, at SLC: its curve is not conclusive (its joints carry no forces in equilibrium)"
        assert line in found.verdict.unchecked
        assert line in found.verdict.sentence
    assert "SLC not checked" in found.verdict.answer, "what was not checked is not unlimited"
    for language, words in (("en", "SLC not checked"), ("it", "SLC non esaminato")):
        page = AssessmentReport(found, language=language)
        assert words in page.top()


def test_one_part_without_a_curve_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was followed is verified, and it is the weaker part that was: the list names the other one."""
    lose_curves(monkeypatch, beyond=7.0)
    found = assessed(beside(), mechanisms={"thick": ["d1"]})
    assert [m.name for m in found.mechanisms if m.unchecked] == ["thick"]
    (item,) = found.open
    assert (item.kind, item.values["name"], item.values["levels"]) == ("curve", "thick", "SLC")
    assert 1 < found.zeta < np.inf
    assert found.verdict.exit_code == 4
    assert "'thick'" in found.verdict.unchecked[0]


def test_what_fails_beside_a_part_without_a_curve_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    lose_curves(monkeypatch, beyond=7.0)
    strong = {"SLV": HAZARD["SLV"], "SLC": {"a_g": 0.5, "F0": 2.47, "Tc": 0.33}}
    found = assessed(beside(), site=site(hazard=strong), mechanisms={"thick": ["d1"]})
    assert found.verdict.outcome is Outcome.FAILS
    assert found.verdict.exit_code == 3
    assert "'thick'" in found.verdict.unchecked[0], "the list stays"


def test_the_command_ends_with_4_and_the_list(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = tmp_path / "pillar.toml"
    path.write_text(pillar(more=SITE))
    lose_curves(monkeypatch)
    code, out, _ = run("assess", path)
    told = json.loads(run("assess", path, "--json")[1])["verdict"]
    assert (code, told["exit_code"], told["outcome"]) == (4, 4, "incomplete")
    assert all("its curve is not conclusive" in line for line in told["unchecked"])
    assert told["unchecked"][0] in " ".join(out.split())


def test_a_bound_without_a_collapse_state_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """The associated limit is an upper bound where joints slide: that nothing moves below it was not shown."""
    one = Model((ground(), *courses(1, 4.0, 0.8)), {"block": Rigid(20.0)}, {"joint": JointLaw(0.12)},
                loads=(Load("weight", (0, -1)),))  # fmt: skip
    monkeypatch.setattr(Mechanisms, "_state", lambda *_, **__: None)
    found = assessed(one, site=site(), levels=["SLD"])
    (m,) = found.mechanisms
    assert m.multiplier == pytest.approx(0.12, rel=1e-9)
    assert (m.found.flow, m.complete, m.unchecked) == ("associated", False, ())
    assert [item.kind for item in found.open] == ["bound"]
    assert (found.verdict.outcome, found.verdict.exit_code) == (Outcome.INCOMPLETE, 4)
    assert "'weakest of all', push left, begins to move below 0.12" in found.verdict.unchecked[0]
    assert "is an upper bound only" in found.verdict.proof


def test_a_limit_state_of_which_nothing_was_checked_has_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """It had stood there as unlimited."""
    lose_curves(monkeypatch)
    found = assessed(beside(), levels=["SLC"])
    assert found.verdict.headline == "Incomplete: zeta_E at SLC was not checked"
    assert found.verdict.answer.startswith("zeta_E at SLC was not checked of 'weakest of all', push left, alpha_0 0.12")
    page = AssessmentReport(found, language="it")
    assert "Incompleto: zeta_E allo SLC non è stato esaminato" in page.top()
    for text in (found.verdict.sentence, found.verdict.headline, page.top(), page.search()):
        assert "unlimited" not in text
        assert "nessuna fino a" not in text
