"""The one list of what is suspicious about a model: each finding once, nothing of a sound model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid, Support, Tie
from concio.cli.check_lines import check_lines
from concio.contact.detection import detect
from concio.verdict.attention import attention_of
from concio.verdict.question import group_words

DOWN = (Load("weight", (0.0, -1.0)),)


def square(name: str, x: float, y: float, kind: str = "rigid", **more: Any) -> Body:
    return Body(name, [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], kind=kind, thickness=0.4, **more)


def stack(**more: Any) -> Model:
    """Return two blocks on the ground with nothing odd about them."""
    ground = Body("ground", [(-1, -1), (3, -1), (3, 0), (-1, 0)], kind="fixed", thickness=0.4)
    given: dict[str, Any] = {
        "bodies": (ground, square("a", 0, 0), square("b", 0, 1)),
        "materials": {"block": Rigid(20.0)},
        "laws": {"joint": JointLaw(0.6)},
        "loads": DOWN,
    }
    return Model(**{**given, **more})


def odd(model: Model) -> tuple[str, ...]:
    return attention_of(model, detect(model))


def tied(**more: Any) -> Model:
    tie = Tie("rod", "b", (0.5, 1.5), "", (5.0, 1.5), 1e4, **{"yield_force": 50.0, **more})
    return stack(ties=(tie,))


def law(**more: Any) -> Model:
    return stack(laws={"joint": JointLaw(**{"friction": 0.6, **more})})


def with_load(**more: Any) -> Model:
    return stack(loads=(*DOWN, Load(**more)))


def light() -> Model:
    made = stack(materials={"block": Rigid(20.0), "light": Rigid()})
    return replace(made, bodies=(*made.bodies[:2], square("b", 0, 1, material="light")))


def lifted(by: float) -> Model:
    made = stack()
    return replace(made, bodies=(*made.bodies[:2], square("b", 0, 1 + by)))


CASES: dict[str, tuple[Callable[[], Model], str]] = {
    "forgotten loads": (lambda: stack(loads=()), "self-weight does not act: 2 blocks have a unit weight"),
    "weights sideways alone": (
        lambda: stack(loads=(Load("weight", (0.1, 0), group="live"),)),
        "self-weight does not act downwards: 2 blocks have a unit weight",
    ),
    "nothing at all": (lambda: stack(loads=(), materials={"block": Rigid()}), "nothing acts: there are no loads"),
    "one material without weight": (light, "'b' has no unit weight, the other 1 have one"),
    "weight of some": (
        lambda: stack(loads=(Load("weight", (0, -1), bodies=("a",)),)),
        "self-weight does not act on 'b'",
    ),
    "gravity in m/s2": (lambda: stack(loads=(Load("weight", (0, -9.81)),)), "acts 9.81 times downwards"),
    "weight twice": (
        lambda: stack(loads=(*DOWN, Load("weight", (0, -1), group="perm"))),
        "acts 2 times downwards by 2 loads of 'dead', 'perm'",
    ),
    "weight upwards": (lambda: stack(loads=(Load("weight", (0, 1)),)), "acts upwards"),
    "friction an angle": (lambda: law(friction=31), "friction 31 is an angle of 88.2 degrees"),
    "strength in MPa": (lambda: law(compressive_strength=2.5), "compressive_strength = 2.5 kN/m2 is below that of any"),
    "cohesion in MPa": (lambda: law(cohesion=0.2), "cohesion = 0.2 kN/m2 is below"),
    "stiffness in N/mm3": (lambda: law(normal_stiffness=10.0), "normal_stiffness = 10 kN/m3 is below"),
    "thick": (
        lambda: replace(stack(), bodies=tuple(replace(b, thickness=40.0) for b in stack().outlines)),
        "a thickness of 40 m is more than that of any wall",
    ),
    "tie without end": (lambda: tied(yield_force=None), "tie 'rod' without a yield_force"),
    "tie too stiff": (lambda: replace(tied(), ties=(replace(tied().ties[0], stiffness=1e12),)), "that of no bar"),
    "half on the edge": (
        lambda: with_load(kind="pressure", value=(10.0,), edge=((0, 2), (2, 2)), group="q"),
        "only 1 m of its 2 m lie on edges of its blocks",
    ),
    "nearly touching": (
        lambda: lifted(0.01),
        "1 joint almost made, but not made or made only in part: 'a' and 'b' at (0.5, 1",
    ),
    "touching nothing": (lambda: lifted(3.0), "'b' is not connected to any support"),
    "large settlement": (
        lambda: stack(supports=(Support("s", "ground", displacement=(0.0, -0.5)),)),
        "support 's' moves 'ground' by 500 mm",
    ),
    "ring thicker than its span": (
        lambda: concio.arch(span=3.0, ring=40.0, voussoirs=5),
        "a ring of 40 m in a span of 3",
    ),
}


def test_a_sound_model_has_nothing_odd() -> None:
    assert odd(stack()) == ()
    assert odd(tied()) == ()
    assert odd(with_load(kind="pressure", value=(10.0,), edge=((0, 2), (1, 2)), group="q")) == ()


def test_that_no_block_has_a_weight_is_assumed_and_told() -> None:
    pressed = (Load("pressure", (10.0,), edge=((0, 2), (1, 2))),)
    for loads, material, told in ((pressed, Rigid(), True), (DOWN, Rigid(20.0), False)):
        model = stack(loads=loads, materials={"block": material})
        lines = check_lines(model, detect(model), {}, every=False)
        assumed = (*concio.solve(model).verdict.question.assumptions, *(x for x in lines if x.startswith("assumed")))
        assert sum("no block has a unit weight" in line for line in assumed) == 2 * told
        assert sum("thickness 0.4 m" in line for line in assumed) == 2


@pytest.mark.parametrize("name", CASES)
def test_what_is_odd_is_told_once(name: str) -> None:
    make, words = CASES[name]
    found = [line for line in odd(make()) if words in line]
    assert len(found) == 1, odd(make())


@pytest.mark.parametrize("name", CASES)
def test_a_solved_step_and_its_summary_carry_the_same_list(name: str) -> None:
    model = CASES[name][0]()
    result = concio.solve(model, on_failure="return")
    assert set(odd(model)) <= set(result.attention)
    assert result.summary()["attention"] == result.summary()["verdict"]["attention"] == list(result.attention)
    assert all(line in result._repr_html_().replace("&#x27;", "'") for line in odd(model))


def test_a_pressure_that_lies_off_a_face_in_space_is_told() -> None:
    ground = Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    block = Polyhedron.box("a", (0, 0, 0), (1, 1, 1), kind="rigid")
    over = ((0.0, 0.0, 1.0), (4.0, 0.0, 1.0), (4.0, 1.0, 1.0), (0.0, 1.0, 1.0))
    loads = (Load("weight", (0, 0, -1)), Load("pressure", (5.0,), polygon=over, group="q"))
    model = Model((ground, block), {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=loads)
    assert any("only 1 m2 of its 4 m2 lie on faces of its blocks" in line for line in odd(model))
    within = replace(model, loads=(loads[0], replace(loads[1], polygon=tuple((x / 4, y, z) for x, y, z in over))))
    assert odd(within) == ()


def test_the_question_tells_every_group_with_its_kilonewtons() -> None:
    model = with_load(kind="point", value=(3.0, -4.0), bodies=("b",), at=(0.5, 2.0), group="q")
    result = concio.solve(model, factors={"q": 0.5})
    acting = {a.group: a for a in result.verdict.question.acting}
    assert np.allclose(acting["dead"].force, (0.0, -2 * 20.0 * 0.4))
    assert np.allclose(acting["q"].force, (3.0, -4.0))
    assert acting["q"].size == pytest.approx(5.0)
    assert acting["q"].factor == 0.5
    assert "dead (16 kN) and q x 0.5 (2.5 kN)" in result.sentence
    off = concio.solve(model, factors={"q": 0.0})
    assert {a.group: a.role for a in off.verdict.question.acting} == {"dead": "constant", "q": "not applied"}
    assert "q x" not in off.sentence


def test_forces_that_balance_are_not_told_as_none() -> None:
    pair = [
        Load("point", (f, 0.0), bodies=(b,), at=at, group="q")
        for f, b, at in ((5.0, "a", (0, 0.5)), (-5.0, "b", (1, 1.5)))
    ]
    result = concio.solve(stack(loads=(*DOWN, *pair)), on_failure="return")
    line = next(a for a in result.verdict.question.acting if a.group == "q")
    assert line.size == pytest.approx(10.0)
    assert "10 kN in forces that balance" in line.sentence()


def test_a_structure_without_any_load_is_told_so() -> None:
    result = concio.solve(stack(loads=()))
    assert "In equilibrium under no load at all" in result.sentence
    assert "Self-weight does not act" in result.sentence


def test_three_groups_are_told_in_a_row() -> None:
    live = [Load("point", (0.0, -1.0), bodies=("b",), at=(0.5, 2.0), group=g) for g in ("q", "s")]
    sentence = concio.solve(stack(loads=(*DOWN, *live))).sentence
    assert "dead (16 kN), q (1 kN) and s (1 kN)" in sentence


@pytest.mark.parametrize("weight", [0.02, 20.0, 2e5])
def test_forces_as_large_as_the_loads_are_not_told_as_huge(weight: float) -> None:
    """What two blocks weigh their joints carry, in any unit of force."""
    result = concio.solve(stack(materials={"block": Rigid(weight)}))
    assert not [line for line in (*result.verdict.limits, *result.attention) if "times all loads" in line]


def test_torsion_is_told_of_blocks_between_parallel_joints_alone() -> None:
    """A block on the ground can turn about its joint; one that leans against a wall as well cannot."""
    ground = Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    wall = Polyhedron.box("wall", (-1, -1, 0), (0, 2, 2), kind="fixed")
    block = Polyhedron.box("a", (0, 0, 0), (1, 1, 1), kind="rigid")
    for bodies, told in (((ground, block), True), ((ground, wall, block), False)):
        model = Model(
            bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=(Load("weight", (0, 0, -1)),),
        )  # fmt: skip
        limits = concio.solve(model).verdict.limits
        assert any("1 block held by parallel joints alone" in line for line in limits) is told


def test_what_belongs_to_a_load_group_is_said_kind_by_kind() -> None:
    column = concio.column(width=0.4, height=1.0, blocks=2, block="rigid", unit_weight=20.0)
    loads = (*column.loads, *(Load("body", (1.0, 0.0), group="live") for _ in range(2)))
    model = replace(column, loads=loads)
    assert group_words(model, "dead") == "self-weight"
    assert group_words(model, "live") == "2 body loads"
    assert group_words(model, "wind") == "nothing"
