"""Every result has a verdict, and its view in a notebook begins with the verdict's sentence and its question."""

from __future__ import annotations

import ast
import html
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill
from concio.model.road.earth import with_fill, with_vehicle
from concio.studies.compare import compare
from concio.verdict.verdict import Outcome, Verdict
from models import box, model_of, weight
from motion_models import G, standing
from pillars import pillar, point, sideways
from seismic_walls import overturning, site

CONTINUUM = {"length": 0.8, "height": 0.4, "block_size": (0.4, 0.2), "friction": 0.6, "unit_weight": 20.0}


def classes() -> Iterator[tuple[str, set[str], bool]]:
    """Yield the public classes of the package with their bases, and whether each has a property ``verdict``."""
    for path in sorted(Path(concio.__file__).parent.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if "def verdict(" not in text and "Shown" not in text:
            continue
        for node in ast.parse(text).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                own = [f for f in node.body if isinstance(f, ast.FunctionDef) and f.name == "verdict"]
                yield node.name, {ast.unparse(base) for base in node.bases}, any(f.decorator_list for f in own)


SETTLING = pillar(more='[[supports]]\nname = "s"\nbody = "floor"\ndisplacement = [0.0, -0.01]\ngroup = "settlement"\n')
TWIN: dict[str, Any] = {"mesh_size": 0.4, "strength": False}


def pushed() -> concio.Model:
    return concio.loads(pillar(sideways(0.2)))


def wall(n: int = 1) -> concio.Model:
    return concio.wall(**CONTINUUM | {"block_size": (0.4 / n, 0.2 / n)}, top_pressure=10.0)


def two_methods() -> object:
    solved = concio.solve(pushed())
    return compare(solved.assembly.problem(), ["sparse-lemke"], decided=solved.verdict)


def two_runs() -> object:
    friction = concio.variable("friction", keys="joints.dry.friction", low=0.6, high=0.8)
    return concio.study(pushed(), [friction], ["stands"], size=2)


def tilted_ground() -> object:
    level = [concio.Measurement(f"{x}", "level", 1e-4, -x / 100, body="a", at=(x, 1.0)) for x in (0.1, 0.2, 0.3)]
    stone, ground = {"kind": "rigid", "material": "stone"}, box("ground", 0, 1, -1, 0, kind="fixed")
    turns = concio.Candidate("ground turns", body="ground", rotation=1.0, about=(0.0, 0.0))
    return concio.diagnose(model_of(ground, box("a", 0, 1, 0, 1, **stone), loads=(weight(),)), level, [turns])


def crossed() -> object:
    bridge = concio.bridge(span=3.0, rise=0.75, ring=0.3, voussoirs=8, block="rigid", unit_weight=22.0, friction=0.6)
    vehicle = Vehicle("one axle", (Axle(0.0, 10.0),))
    model = with_vehicle(with_fill(bridge, Fill(cover=0.3, unit_weight=20.0)), vehicle)
    return concio.assess_bridge(model, step=1.5, fine=1.0, worst=1, checked=1, sensitivity=False)


STAGES = [concio.Stage("dead", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})]
MAKE: dict[str, Callable[[], Any]] = {
    "Result": lambda: concio.solve(pushed()),
    "PathResult": lambda: concio.run_path(pushed(), STAGES),
    "LimitResult": lambda: concio.limit(pushed()),
    "SettlementResult": lambda: concio.settle(concio.loads(SETTLING)),
    "Margin": lambda: concio.load_margin(pushed()),
    "FrictionMargin": lambda: concio.friction_margin(pushed()),
    "PushResult": lambda: concio.push(standing(), gravity=G, until=0.01),
    "RockingResult": lambda: concio.rock(standing(), step=0.05),
    "DynamicsResult": lambda: concio.dynamics(standing(), duration=0.02, step=0.01, gravity=G),
    "LetGo": lambda: concio.let_go(concio.solve(pushed())),
    "Moduli": lambda: concio.homogenise(concio.cell(friction=0.6)),
    "StrengthDomain": lambda: concio.strength(concio.cell(friction=0.6), [(0.0, -1.0, 0.2)], coulomb=False),
    "CellPath": lambda: concio.strain_path(concio.cell(friction=0.6), [concio.Stage("press", {"stress yy": -10.0})]),
    "ContinuumComparison": lambda: concio.compare_with_continuum(wall(), **TWIN),
    "BlockHalving": lambda: concio.halve_blocks(wall, sizes=[1], **TWIN),
    "ComparisonTable": two_methods,
    "Assessment": lambda: concio.assess(overturning(), site=site()),
    "StudyResult": two_runs,
    "Diagnosis": tilted_ground,
    "BridgeResult": crossed,
}
"""A result of every class that has a verdict."""


def test_every_class_with_a_verdict_is_shown_by_it() -> None:
    own = {name for name, bases, _ in classes() if "Shown" in bases} - {"Model"}
    assert own == set(MAKE), "a result whose view was not examined"
    told = {name for name, bases, has in classes() if has and "Protocol" not in bases}
    assert told == own, "a class with a verdict of its own that notebooks show without it"


@pytest.mark.parametrize("name", MAKE)
def test_a_view_begins_with_the_sentence_and_the_question(name: str) -> None:
    found = MAKE[name]()
    verdict = found.verdict
    assert type(found).__name__ == name
    assert isinstance(verdict, Verdict)
    for view in ("plot", "tables"):
        assert not hasattr(type(found), view) or getattr(found, view) is not None, "a view that nothing makes"
    page = html.unescape(found._repr_html_())
    assert page.startswith("<div>")
    places = [page.index(text) for text in (verdict.headline, verdict.sentence, verdict.proof, verdict.question.asked)]
    assert places == sorted(places)
    assert page[: places[-1]].count("<tr>") == 1, "the question is the first row"
    for line in (*verdict.limits, *verdict.unchecked, *verdict.attention, *verdict.question.assumptions):
        assert line in page


def test_the_margin_of_a_load_is_a_verdict() -> None:
    """The pillar tips at 0.25 of its weight: 1.25 times a load of 0.2, and nothing is added where it tips already."""
    model = concio.loads(pillar(sideways(0.2)))
    verdict = concio.load_margin(model).verdict
    assert verdict.outcome is Outcome.HOLDS
    (live,) = (a for a in verdict.question.acting if a.role == "multiplied")
    assert live.factor == pytest.approx(1.25, rel=2e-3)
    assert live.force == pytest.approx((0.2 * 12.8, 0.0))
    assert f"at {live.factor:.6g} times the load given" in verdict.answer
    tipping = concio.loads(pillar(sideways(0.1) + sideways(0.3, "dead")))
    none = concio.load_margin(tipping).verdict
    assert (none.outcome, none.status) == (Outcome.FAILS, "no_equilibrium")
    assert "nothing to spare" in none.answer
    locked = concio.load_margin(concio.loads(pillar(point(0.0, -5.0, (0.0, 1.6))))).verdict
    assert locked.outcome is Outcome.HOLDS
    assert locked.answer.startswith("Any multiple")
    assert any("says nothing of Coulomb friction" in line for line in locked.limits)


@pytest.mark.parametrize("margin", [concio.friction_margin, concio.friction_by_solving])
def test_the_margin_of_friction_is_a_verdict(margin: Any) -> None:
    """0.2 of the weight needs friction 0.2 of 0.7; a pillar that tips is helped by none."""
    found = margin(concio.loads(pillar(sideways(0.2))))
    verdict = found.verdict
    assert verdict.outcome is Outcome.HOLDS
    assert "all friction coefficients" in verdict.question.asked
    assert {a.group: a.role for a in verdict.question.acting} == {"dead": "constant", "live": "constant"}
    tips = margin(concio.loads(pillar(sideways(0.3)))).verdict
    assert tips.outcome is Outcome.FAILS
    assert tips.exit_code == 3
    twice = margin(concio.loads(pillar(sideways(0.15))), factor=1.0).verdict
    acting = margin(concio.loads(pillar(sideways(0.05))), factor=3.0).verdict.question.acting
    assert {a.group: a.factor for a in acting} == {"dead": 1.0, "live": 3.0}
    assert twice.holds


def test_friction_above_what_there_is_is_told() -> None:
    found = concio.friction_margin(concio.loads(pillar(sideways(0.2), friction=0.1)))
    assert found.factor == pytest.approx(2.0, rel=1e-5)
    assert found.verdict.outcome is Outcome.FAILS
    assert "2 times the friction given" in found.verdict.answer
    lost = concio.friction_by_solving(concio.loads(pillar(sideways(0.2), friction=0.1)))
    assert math.isnan(lost.holds)
    assert lost.verdict.outcome is Outcome.FAILS


def test_a_margin_carries_what_is_odd_about_its_model() -> None:
    model = concio.loads(pillar(sideways(0.2), friction=3.0))
    odd = concio.solve(model).verdict.attention
    assert any("friction 3" in line for line in odd)
    for found in (concio.load_margin(model), concio.friction_margin(model), concio.friction_by_solving(model)):
        assert set(odd) <= set(found.verdict.attention)


def test_a_load_that_all_multiples_fail_of_says_how() -> None:
    """A text once printed the name of its variable."""
    from concio.verdict.limit_words import limit_lines

    for path in sorted((Path(concio.__file__).parent / "verdict").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
            assert not re.search(r"\{[a-z_.]+\(", text), f"{path.name}:{node.lineno}: {text}"
    found = concio.limit(concio.loads(pillar(sideways(1.0)).replace('group = "dead"', 'group = "live"')))
    assert "{" not in "\n".join(limit_lines(found))
    assert np.isfinite(found.associated.multiplier)
