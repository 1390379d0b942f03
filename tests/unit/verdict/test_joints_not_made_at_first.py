"""What does not stand before anything is multiplied or moved does so with the joints that were made, and says so."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import concio
from concio import Body, JointLaw, Load, Model, NoEquilibriumError, Rigid
from seismic_walls import site

ASKED: dict[str, Callable[[Model], Any]] = {
    "limit": lambda m: concio.limit(m, "live"),
    "assess": lambda m: concio.assess(m, site=site(), live="live", levels=["SLV"], elsewhere=("height",)),
}


def beam_on_knives(strength: float | None, turned: float = 0.0) -> Model:
    """A beam on two knife edges; where joints crush none is made at a corner."""
    outlines = {"k1": [[0, 0], [0.4, 0], [0.2, 0.5]], "k2": [[1.5, 0], [1.9, 0], [1.7, 0.5]],
                "beam": [[-0.1, 0.5], [2.0, 0.5], [2.0, 0.8], [-0.1, 0.8]]}  # fmt: skip
    bodies = [Body("floor", np.array([[-3.0, -1.0], [3.0, -1.0], [3.0, 0.0], [-3.0, 0.0]]), kind="fixed")]
    bodies += [Body(name, np.add(outline, [turned, 0.0]), kind="rigid") for name, outline in outlines.items()]
    loads = Load("weight", (0.0, -1.0)), Load("weight", (1.0, 0.0), group="live")
    law = JointLaw(0.6, compressive_strength=strength)
    return Model(tuple(bodies), {"block": Rigid(20.0)}, {"joint": law}, loads=loads)


@pytest.mark.parametrize("command", list(ASKED))
@pytest.mark.parametrize("place", [0.0, 0.7])
def test_a_mechanism_is_one_of_the_joints_that_were_made(command: str, place: float) -> None:
    with pytest.raises(NoEquilibriumError) as caught:
        ASKED[command](beam_on_knives(2000.0, place))
    told = [str(caught.value)]
    if caught.value.verdict is not None:
        told += [caught.value.verdict.sentence, caught.value.verdict.proof]
    for text in told:
        assert "with the joints that were made: a mechanism proves it. 2 joints almost made" in text
        assert "'k1' and 'beam'" in text


def test_where_every_joint_was_made_nothing_is_added() -> None:
    fallen = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    loads = Load("weight", (0.9, -1.0)), Load("weight", (1.0, 0.0), group="live")
    model = Model(fallen.bodies, fallen.materials, fallen.laws, loads=loads, rules=fallen.rules)
    with pytest.raises(NoEquilibriumError, match=r"cannot be carried: a mechanism proves it \(solve"):
        concio.limit(model, "live")
