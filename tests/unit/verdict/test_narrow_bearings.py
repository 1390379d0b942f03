"""Blocks that rest on joints of a few millimetres alone draw attention; films of mortar and wide bearings do not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid
from concio.verdict.italian import italian


def box(name: str, low: tuple[float, float], high: tuple[float, float], kind: str = "rigid") -> Body:
    return Body(name, [low, (high[0], low[1]), high, (low[0], high[1])], kind=kind)  # type: ignore[arg-type]


def told(*bodies: Body | Polyhedron) -> list[str]:
    down = (0.0,) * (bodies[0].vertices.shape[1] - 1) + (-1.0,)
    model = Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=(Load("weight", down),))
    found = concio.solve(model)
    assert found.solved
    return [line for line in found.verdict.attention if "rest" in line]


def beam(bearing: float) -> list[Body]:
    """Return a beam over two blocks on the ground, which bear it at its ends."""
    ground = box("ground", (-1.0, -0.2), (4.0, 0.0), "fixed")
    left, right = box("left", (0.0, 0.0), (1.0, 0.5)), box("right", (2.0, 0.0), (3.0, 0.5))
    return [ground, left, right, box("beam", (1.0 - bearing, 0.5), (2.0 + bearing, 1.0))]


@pytest.mark.parametrize(("bearing", "narrow"), [(0.001, True), (0.008, True), (0.012, False), (0.2, False)])
def test_a_beam_on_millimetres_is_told(bearing: float, narrow: bool) -> None:
    """The verdict was an equilibrium on two edges of 1 mm without a word."""
    found = told(*beam(bearing))
    assert bool(found) is narrow
    if narrow:
        said = f"1 block rests on joints narrower than 0.01 m alone: 'beam' ({bearing:g} m): are these bearings meant?"
        assert found == [said]
        assert [piece.language for piece in italian(found[0])] == ["it"]


@pytest.mark.parametrize(
    "held",
    [
        {"supports": (concio.Support("prop", "beam", edge=((0.998, 0.5), (2.002, 0.5)), directions="y"),)},
        {"ties": (concio.Tie("rod", body_a="beam", at_a=(1.5, 1.0), body_b="", at_b=(1.5, 3.0), stiffness=1e3),)},
    ],
)
def test_what_a_support_or_a_tie_holds_does_not_rest_on_its_joints_alone(held: dict[str, Any]) -> None:
    bodies = tuple(beam(0.002))
    model = Model(
        bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=(Load("weight", (0.0, -1.0)),)
    )  # fmt: skip
    assert any("rest" in line for line in concio.solve(model).verdict.attention)
    assert not any("rests on joints" in line for line in concio.solve(replace(model, **held)).verdict.attention)


def test_a_bearing_in_pieces_and_a_film_are_wide_enough() -> None:
    """Collinear vertices divide a bearing of 0.1 m; a film of 1 mm has end joints as narrow as it is thin."""
    ground = box("ground", (-1.0, -0.2), (3.0, 0.0), "fixed")
    steps = [(0.005 * k, 0.5) for k in range(20, -1, -1)]
    pieces = Body("pieces", [(0.0, 0.0), (0.1, 0.0), *steps], kind="rigid")
    above = box("above", (0.0, 0.5), (0.1, 1.0))
    film = box("film", (0.0, 1.0), (0.1, 1.001))
    assert told(ground, pieces, above, film) == []


def test_in_space_the_width_of_a_joint_counts() -> None:
    ground = Polyhedron.box("ground", (-1, -1, -1), (3, 2, 0), kind="fixed")
    block = Polyhedron.box("block", (0, 0, 0), (1, 1, 0.5), kind="rigid")
    other = replace(block, name="other", vertices=block.vertices + np.array([1.5, 0.0, 0.0]))
    beams = [Polyhedron.box("beam", (1 - w, 0.2, 0.5), (1.5 + w, 0.8, 1.0), kind="rigid") for w in (0.002, 0.1)]
    assert "'beam' (0.002 m)" in told(ground, block, other, beams[0])[0]
    assert told(ground, block, other, beams[1]) == []


def test_several_are_counted() -> None:
    rows = [
        replace(b, name=f"{b.name}{k}", outline=b.outline + np.array([5.0 * k, 0.0]))
        for k in range(5) for b in beam(0.002)
    ]  # fmt: skip
    found = told(*rows)[0]
    assert found.startswith("5 blocks rest on joints narrower than 0.01 m alone: 'beam0' (0.002 m); 'beam1'")
    assert "'beam2' (0.002 m) and 2 more: are these" in found
    said = italian(found)
    assert [piece.language for piece in said] == ["it"]
    assert "'beam2' (0.002 m) e altri 2: sono appoggi voluti?" in said[0].text
