"""Models, loads and stages are values: what they were made of may change afterwards."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import concio

COLUMN = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", unit_weight=20.0, horizontal=0.1)

MADE: dict[str, tuple[Any, Callable[[Any], Any], Callable[[Any], Any]]] = {
    "laws": (dict(COLUMN.laws), lambda v: replace(COLUMN, laws=v), lambda v: v.update(joint=concio.JointLaw(0.01))),
    "materials": (dict(COLUMN.materials), lambda v: replace(COLUMN, materials=v), lambda v: v.clear()),
    "bodies": (list(COLUMN.bodies), lambda v: replace(COLUMN, bodies=v), lambda v: v.pop()),
    "rules": (list(COLUMN.rules), lambda v: replace(COLUMN, rules=v), lambda v: v.append(concio.JointRule("joint"))),
    "factors": ({"live": 1.0}, lambda v: concio.Stage("push", v), lambda v: v.update(live=9.0)),
    "value": (np.array([1.0, 0.0]), lambda v: concio.Load("weight", v), lambda v: v.fill(9.0)),
    "edge": (np.array([[0.0, 0.0], [1.0, 0.0]]), lambda v: concio.Load("pressure", (1.0,), edge=v),
             lambda v: v.fill(9.0)),
    "ends": (np.array([0.0, 0.5]), lambda v: concio.Tie("t", "b01", v, "", (1.0, 0.5), 1e3), lambda v: v.fill(9.0)),
    "point": ([0.0, 0.5], lambda v: concio.ControlPoint("b01", v), lambda v: v.reverse()),
    "spread": ({"along": 1.0, "across": 1.0}, lambda v: concio.Fill(cover=0.3, spread=v),
               lambda v: v.update(along=9.0)),
}  # fmt: skip


@pytest.mark.parametrize("sort", MADE)
def test_what_a_value_was_made_of_may_change(sort: str) -> None:
    """A loop that changed one dictionary of laws gave all models of the loop its last law, and their results too."""
    given, make, change = MADE[sort]
    kept = make(given)
    before = concio.dumps(kept) if isinstance(kept, concio.Model) else repr(kept)
    change(given)
    assert (concio.dumps(kept) if isinstance(kept, concio.Model) else repr(kept)) == before


def test_models_of_a_loop_have_laws_of_their_own() -> None:
    laws, models = {}, []
    for friction in (0.2, 0.6):
        laws["joint"] = concio.JointLaw(friction)
        models.append(replace(COLUMN, laws=laws))
    found = [concio.limit(model, path=False, search=False).associated.multiplier for model in models]
    assert found == pytest.approx([2.0, 5.0], rel=1e-6)
