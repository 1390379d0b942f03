"""alpha_0 by virtual work from the coordinates, beside that of the program; the annex that prints it; its symbols."""

from __future__ import annotations

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid, Tie
from concio.analysis.seismic.assessment_asked import Head
from concio.analysis.seismic.hand_check import hand_check
from concio.analysis.seismic.hand_forces import hand_forces, measured
from concio.contact.applied import applied_forces
from concio.report.assessment_annex import validation_rows
from concio.report.assessment_page import AssessmentReport
from concio.report.typeset import typeset
from concio.verdict.verdict import Outcome
from samples import sample
from seismic_walls import bending, courses, ground, overturning, site

ONE = {"direction": "left", "levels": ["SLV"]}


def agreement(model: Model, **more: object) -> float:
    """Return the largest relative difference between both over all mechanisms that are shown."""
    found = concio.assess(model, **{"site": site(), **ONE, **more})  # type: ignore[arg-type]
    assert found.mechanisms
    assert all(check.agrees for check in found.hand_checks)
    return max(check.difference for check in found.hand_checks)


@pytest.mark.long
@settings(max_examples=sample(3, 8, 20), deadline=None)
@given(
    st.integers(1, 4), st.floats(2.0, 8.0), st.floats(0.3, 0.9), st.floats(0.05, 0.8),
    st.sampled_from([None, 400.0, 4000.0]), st.floats(0.0, 6.0), st.floats(0.001, 0.05),
)  # fmt: skip
def test_virtual_work_gives_the_multiplier_of_the_program(
    n: int, height: float, thickness: float, friction: float, strength: float | None, pull: float, longest: float
) -> None:
    """Hinges, sliding courses, crushing hinges, a tie that yields or breaks, loads at points and on a length."""
    wall = courses(n, height, thickness)
    loads = [Load("weight", (0, -1)), Load("point", (-0.3, -5.0), bodies=(f"c{n}",), at=(0.4 * thickness, height)),
             Load("traction", (0, -20.0), edge=((0.6 * thickness, height), (thickness, height)))]  # fmt: skip
    ties = [Tie("t", f"c{n}", (0, 0.95 * height), "", (5, height), 300.0, yield_force=pull, break_elongation=longest)]
    law = JointLaw(friction, compressive_strength=strength)
    model = Model((ground(), *wall), {"block": Rigid(19.0)}, {"joint": law}, loads=tuple(loads),
                  ties=tuple(ties) if pull > 0.5 else ())  # fmt: skip
    assert agreement(model) < 1e-6


def test_loads_that_push_and_supports_that_hold() -> None:
    assert agreement(bending(8), direction="right", live="live") < 1e-9


@pytest.mark.long  # two assessments in space
@pytest.mark.parametrize("given", [1.0, -1.0])
def test_loads_in_space_push_the_way_that_is_asked_for_whichever_way_they_are_given(given: float) -> None:
    wall = concio.extrude(overturning(2), 0.5)
    live = Load("weight", (given, 0.0, 0.0), group="live")
    model = replace(wall, loads=(*(load for load in wall.loads if load.group != "live"), live))
    assert agreement(model, direction="+x", live="live") < 1e-9


@pytest.mark.long
def test_a_wall_in_space_and_one_whose_courses_slide() -> None:
    bodies = (
        Polyhedron.box("ground", (-1, -1, -0.2), (2, 3, 0), kind="fixed"),
        Polyhedron.box("wall", (0, 0, 0), (0.6, 2, 6), kind="rigid"),
    )
    roof = Load("point", (0, 0, -12.0), bodies=("wall",), at=(0.4, 1.0, 6.0))
    line = Load("traction", (0, 0, -10.0), edge=((0.45, 0, 3.0), (0.45, 2, 3.0)), bodies=("wall",))
    loads = (Load("weight", (0, 0, -1)), roof, line)
    model = Model(bodies, {"block": Rigid(19.0)}, {"joint": JointLaw(0.8)}, loads=loads)
    assert agreement(model, direction="-x") < 1e-8
    sliding = concio.wall(length=1.0, height=0.75, block_size=(0.5, 0.25), friction=0.3, block="rigid")
    assert agreement(sliding, direction="right") < 1e-9


@settings(max_examples=sample(5, 12, 40), deadline=None)
@given(st.floats(0.0, 0.7), st.floats(0.1, 0.9), st.floats(-30.0, 30.0), st.sampled_from(["pressure", "traction"]),
       st.sampled_from([None, "lower", "upper", "both"]), st.floats(0.2, 2.0))  # fmt: skip
def test_forces_are_those_of_the_program(
    start: float, share: float, size: float, kind: str, face: str | None, deep: float
) -> None:
    """Two integrations that share no line: loads in a joint on either face, weight of a body with a hole."""
    outline = np.array([[0, 0], [1.0, 0], [1.2, 1.0], [0, 1.0]])
    hole = np.array([[0.3, 0.3], [0.6, 0.3], [0.6, 0.6], [0.3, 0.6]])
    low = Body("low", outline, kind="elastic", thickness=deep, holes=(hole,))
    top = Body("top", np.array([[0, 1.0], [1.2, 1.0], [1.0, 2.0], [0.1, 2.0]]), kind="elastic", thickness=deep)
    edge = ((start, 1.0), (start + share * (1.2 - start), 1.0))
    value = (size,) if kind == "pressure" else (0.3 * size, size)
    loads = [Load("weight", (0.1, -1)), Load(kind, value, edge=edge, face=face), Load("body", (1.0, 2.0), ("t*",))]  # type: ignore[arg-type]
    model = Model((ground(), low, top), {"block": concio.Elastic(1e6, 0.2, 18.0)}, {"joint": JointLaw(0.5)},
                  loads=tuple(loads))  # fmt: skip
    mine = {(f.load, f.body): f for f in hand_forces(model)}
    theirs = [f for f in applied_forces(model, range(len(loads))) if f.force.any()]
    assert len(mine) == len(theirs)
    for f in theirs:
        own = mine[f.load, f.body]
        assert own.force == pytest.approx(f.force, rel=1e-9, abs=1e-9)
        assert own.point == pytest.approx(f.point, rel=1e-9)


@settings(max_examples=sample(5, 12, 40), deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(1e-5, 2e-4), st.sampled_from(["lower", "upper"]))
def test_loads_on_drawn_lines_are_those_of_the_program(seed: int, tolerance: float, face: str) -> None:
    """Corners of a drawing and the line of a load lie beside each other by the gap tolerance."""
    rng = np.random.default_rng(seed)

    def drawn(points: list[tuple[float, float]]) -> np.ndarray:
        return np.array(points) + rng.uniform(-0.5, 0.5, (len(points), 2)) * tolerance

    low = [Body(f"low{k}", drawn([(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]), kind="rigid") for k in range(3)]
    top = [Body(f"top{k}", drawn([(k, 1), (k + 1, 1), (k + 1, 2), (k, 2)]), kind="rigid") for k in range(3)]
    edge = tuple(map(tuple, drawn([(0.25, 1.0), (2.6, 1.0)])))
    loads = (Load("weight", (0, -1)), Load("traction", (3.0, -10.0), edge=edge, face=face))  # type: ignore[arg-type]
    model = Model((*low, *top), {"block": Rigid(18.0)}, {"joint": JointLaw(0.5)}, loads=loads, gap_tolerance=tolerance)
    mine = {(f.load, f.body): f for f in hand_forces(model)}
    theirs = [f for f in applied_forces(model, range(len(loads))) if f.force.any()]
    assert len(mine) == len(theirs) == 9
    for f in theirs:
        own = mine[f.load, f.body]
        assert own.force == pytest.approx(f.force, rel=1e-6, abs=1e-6)
        assert own.point == pytest.approx(f.point, rel=1e-7, abs=1e-7)


@pytest.mark.long  # an assessment of 182 stones
def test_the_check_by_hand_of_the_facade_of_the_examples_agrees() -> None:
    """Coordinates of the drawing are rounded, floors and roof load it along lines, and joints slide."""
    model = concio.load(Path(__file__).parents[3] / "examples" / "facade.toml")
    dead = replace(model, loads=tuple(load for load in model.loads if load.group != "live"))
    found = concio.assess(dead, site=site(), direction="right", levels=["SLV"])
    assert any(check.part("load") for check in found.hand_checks)
    assert any(check.part("joint") for check in found.hand_checks)
    assert all(check.agrees for check in found.hand_checks)
    assert 1e-6 < max(check.left_open for check in found.hand_checks) < 1e-3
    assert "Friction of joints that stick leaves up to" in AssessmentReport(found).html()


def test_volumes_of_blocks_in_space_are_sums_of_tetrahedra() -> None:
    box = Polyhedron.box("b", (1, 2, 3), (2, 4, 6))
    volume, centroid = measured(box)
    assert volume == pytest.approx(6.0, rel=1e-14)
    assert centroid == pytest.approx([1.5, 3.0, 4.5], rel=1e-14)


@pytest.mark.parametrize("share", [1.001, 0.7])
def test_what_does_not_agree_is_left_open(share: float) -> None:
    """The model in the check is heavier than the one that was searched: the outcome is never that all is well."""
    weak = concio.Site({"SLV": {"a_g": 0.02, "F0": 2.45, "Tc": 0.32}}, soil="A")
    found = concio.assess(overturning(), site=weak, **ONE)  # type: ignore[arg-type]
    assert found.verdict.outcome is Outcome.HOLDS
    other = replace(found, model=replace(found.model, materials={"block": Rigid(19.0 * share)}))
    assert not hand_check(found.mechanisms[0], other.model).agrees
    assert other.verdict.outcome is Outcome.INCOMPLETE
    assert any("virtual work" in line for line in other.verdict.unchecked)


@pytest.mark.long
@pytest.mark.parametrize("language", ["en", "it"])
def test_the_annex_holds_what_the_code_asks_for(language: str) -> None:
    found = concio.assess(overturning(3), site=site(), direction="left")
    head = Head(author="NN", revision="2", judgement="acceptable, for reasons")
    text = AssessmentReport(found, head=head, language=language).html()
    annex = text[text.index("<section id=annex") :]
    words = {"en": ("signature", "stamp", "authors", "revision"), "it": ("firma", "timbro", "autori", "revisione")}
    assert all(word in text for word in words[language])
    assert concio.__version__ in annex
    assert "NTC 2018, 10.2" in annex
    assert "acceptable, for reasons" in annex
    shown = re.sub(r"<[^>]*>", "", annex)
    by_hand = f"{found.hand_checks[0].alpha:.9f}".rstrip("0")
    assert by_hand.replace(".", "," if language == "it" else ".") in shown
    block = found.model.body("c2")
    weight = f"{19.0 * block.volume:.6g}".replace(".", "," if language == "it" else ".")
    assert re.search(rf"c2: (weight|peso)\s*{weight}\s*\(", re.sub(r"<[^>]*>", " ", annex))


def test_symbols_are_set_as_print_has_them() -> None:
    assert typeset("<b title='a_g'>a_g, zeta_E, T_C* of block_1 [m/s2], 1e-14</b>") == (
        "<b title='a_g'>a<sub>g</sub>, ζ<sub>E</sub>, T*<sub>C</sub> of block_1 [m/s²], 1·10<sup>−14</sup></b>"
    )


@pytest.mark.long
def test_the_rows_in_the_annex_are_those_of_the_book(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "validation")
    local_mechanisms = import_module("validation_cases.local_mechanisms")

    shown = {row["name"]: row for row in validation_rows()["local_mechanisms"]["rows"]}
    rows = local_mechanisms.rows()
    assert set(shown) == {r.name for r in rows}
    for row in rows:
        assert shown[row.name]["expected"] == pytest.approx(row.expected, rel=1e-9)
        assert shown[row.name]["computed"] == pytest.approx(row.computed, rel=1e-8)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("angle", "word"), [(0.0, "a_shifts"), (1e-8, "a_shifts"), (1e-5, "a_turns")])
def test_a_block_turns_where_its_turn_moves_it_beside_its_shift_at_any_size_of_the_motion(unit, angle, word):
    from concio.report.assessment_annex import _motion
    from concio.report.assessment_texts import Texts

    body = SimpleNamespace(vertices=np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    block = SimpleNamespace(bodies=[0], centre=np.array([1.0, 0.5]))
    motion = SimpleNamespace(
        assembly=SimpleNamespace(model=SimpleNamespace(dim=2, bodies=[body])),
        mechanics=SimpleNamespace(blocks=[block]), velocity=unit * np.array([1.0, 0.0, angle]),
    )  # fmt: skip
    texts = Texts("en")
    assert _motion(texts, motion, 0).startswith(texts.words[word].split("{")[0])
