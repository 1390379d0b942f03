"""Supports that force rigid blocks together: reactions of a settlement then belong to a compliance that nobody gave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from models import box, weight

A, B, HEIGHT, UNIT_WEIGHT = 0.8, 1.2, 0.5, 20.0


def hinged(dx: float, dy: float, *, left: float = 0.0) -> concio.Model:
    """Two unequal rigid blocks between two abutments: the right one moves by (dx, dy), the left one goes up first."""
    fixed = [box("left", -0.5, 0.0, -0.2, 0.7, kind="fixed"), box("right", A + B, A + B + 0.5, -0.2, 0.7, kind="fixed")]
    blocks = [box("a", 0.0, A, 0.0, HEIGHT, kind="rigid"), box("b", A, A + B, 0.0, HEIGHT, kind="rigid")]
    supports = [concio.Support("right moves", "right", displacement=(dx, dy))]
    if left:
        supports.append(concio.Support("left rises", "left", displacement=(0.0, left), group="earlier"))
    return concio.Model(
        (*blocks, *fixed), {"block": concio.Rigid(unit_weight=UNIT_WEIGHT)}, {"joint": concio.JointLaw(1.3)},
        loads=(weight(),), supports=tuple(supports),
    )  # fmt: skip


def test_an_abutment_that_gives_way_opens_three_hinges():
    """Hinges at (0, 0), (A, H) and (A + B, 0): thrust by statics, openings by kinematics of two rigid bars."""
    dx, dy = 0.01, -0.004
    found = concio.settle(hinged(dx, dy))
    assert found.verdict.attention == ()
    weight_a, weight_b = UNIT_WEIGHT * HEIGHT * A, UNIT_WEIGHT * HEIGHT * B
    upwards = (weight_a * (B + 0.5 * A) + weight_b * 0.5 * B) / (A + B)
    thrust = (upwards * A - weight_a * 0.5 * A) / HEIGHT
    assert found.reactions["left"][-1] == pytest.approx([thrust, upwards])
    turned = np.linalg.solve([[HEIGHT, HEIGHT], [-A, B]], [dx, dy])  # clockwise, anticlockwise
    opened = sorted(found.path.result().contacts.gap)[-3:]
    assert opened == pytest.approx(sorted([HEIGHT * turned[0], HEIGHT * turned[1], HEIGHT * turned.sum()]), rel=1e-3)


@pytest.mark.parametrize("share", [1.0, 0.01])
def test_an_abutment_that_approaches_forces_blocks_together_which_is_said(share):
    """80,000 kN of thrust stood there without a word: a stiffer joint gives ten times as much."""
    found = concio.settle(hinged(0.01, -0.004), amount=-share)
    assert found.reactions["left"][-1, 0] > 10 * found.reactions["left"][0, 0]
    (told,) = found.verdict.attention
    assert "forced together" in told
    assert told[1:] in found.verdict.next_steps[0]


def test_what_an_earlier_stage_forces_together_is_said():
    found = concio.settle(hinged(0.01, -0.004, left=0.005))
    assert found.reactions["left"][0, 0] > 1000.0
    assert "forced together" in found.verdict.attention[0]


def test_elastic_blocks_that_are_pressed_are_not_forced_together():
    model = hinged(-1e-4, 0.0)
    bodies = tuple(replace(b, kind="elastic") if b.kind == "rigid" else b for b in model.bodies)
    stone = concio.Elastic("1 GPa", 0.0, unit_weight=UNIT_WEIGHT)
    found = concio.settle(replace(model, bodies=bodies, materials={"block": stone}))
    assert found.verdict.attention == ()
