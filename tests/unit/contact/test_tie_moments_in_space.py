"""A tie has the moment of its force about the axes of the model, whatever the shape of its block."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid, Tie


def held(size: tuple[float, float, float], height: float, way: int, force: float = 1.0) -> Model:
    """Return a block on the ground, pushed at its top along x or y and held there by a tie of 3 kN at some height."""
    a, b, c = size
    middle = np.array([a / 2, b / 2, 0.0])
    along = np.eye(3)[way]
    side = middle - 0.5 * size[way] * along
    bodies = (
        Polyhedron.box("floor", (-9, -9, -1), (9, 9, 0), kind="fixed"),
        Polyhedron.box("b", (0, 0, 0), (a, b, c), kind="rigid"),
    )
    top = middle + np.array([0.0, 0.0, c])
    push = Load("point", tuple((force * along).tolist()), bodies=("b",), at=tuple(top.tolist()),
                group="live")  # fmt: skip
    at = side + np.array([0.0, 0.0, height])
    tie = Tie("rod", "b", tuple(at.tolist()), "", tuple((at - along).tolist()), stiffness=1000.0, yield_force=3.0)
    return Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(3.0)}, loads=(Load("weight", (0, 0, -1)), push),
                 ties=(tie,))  # fmt: skip


@pytest.mark.parametrize("way", [0, 1])
@pytest.mark.parametrize("size", sorted(set(permutations((0.5, 1.0, 1.0))) | set(permutations((0.4, 0.7, 1.2)))))
def test_the_limit_of_a_block_held_by_a_tie_is_that_of_its_moments(size: tuple[float, float, float], way: int) -> None:
    """About the toe: weight at half the width and the tie at its height carry the push at the top.

    The moment stood about another axis where principal axes come in another order: 4 kN for 4.75.
    """
    weight, height = 20.0 * float(np.prod(size)), 0.75 * size[2]
    by_hand = (weight * size[way] / 2 + 3.0 * height) / size[2]
    found = concio.limit(held(size, height, way), path=False, steps=False, search=False)
    assert found.associated.multiplier == pytest.approx(by_hand, rel=1e-9)


@pytest.mark.parametrize(("share", "holds"), [(0.99, True), (1.01, False)])
def test_a_load_step_with_a_tie_in_space_stands_as_long_as_moments_balance(share: float, holds: bool) -> None:
    assert concio.solve(held((0.5, 1.0, 1.0), 0.75, 0, 4.75 * share), on_failure="return").solved == holds
