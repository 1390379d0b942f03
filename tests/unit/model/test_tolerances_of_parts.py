"""The tolerance of one part closes no gap of another when parts are put together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.contact.detection import detect
from samples import sample


def pair(gap: float, tolerance: float | None, name: str, x: float, *, space: bool) -> concio.Model:
    """Return two blocks on a floor with a gap between them."""
    floor = concio.Body("floor", [(-0.5, -0.5), (3.5, -0.5), (3.5, 0), (-0.5, 0)], kind="fixed")
    blocks = [
        concio.Body(f"b{k}", [(s, 0), (s + 1, 0), (s + 1, 1), (s, 1)], material="stone", kind="rigid")
        for k, s in enumerate((0.0, 1.0 + gap))
    ]
    model = concio.Model((floor, *blocks), {"stone": concio.Rigid(unit_weight=20.0)}, {"dry": concio.JointLaw(0.6)},
                         rules=(concio.JointRule("dry"),), gap_tolerance=tolerance)  # fmt: skip
    model = concio.extrude(model, 1.0) if space else model
    return concio.place(replace(model, gap_tolerance=tolerance), at=(x, 0.0, 0.0) if space else (x, 0.0), name=name)


def joints(model: concio.Model) -> set[tuple[str, str, bool]]:
    """Return the names of the bodies of every joint, and whether it has an initial gap."""
    names = [b.name for b in model.bodies]
    return {(names[face.a], names[face.b], bool(np.any(face.gap))) for face in detect(model).interfaces}


@pytest.mark.parametrize("space", [False, True])
@settings(max_examples=sample(6, 40), deadline=None)
@given(gap=st.floats(1e-4, 0.05), tolerance=st.floats(1e-4, 0.05), first=st.booleans(), none=st.booleans())
def test_a_gap_of_a_part_stays_or_is_refused(
    space: bool, gap: float, tolerance: float, first: bool, none: bool
) -> None:
    other = None if none else 1e-5
    parts = [pair(gap, other, "a", 0.0, space=space), pair(0.0, tolerance, "b", 20.0, space=space)]
    parts = parts if first else parts[::-1]
    if gap < tolerance * (1 - 1e-6):
        refused = r"'a-b0' and 'a-b1' of part [12] do not touch in it"
        with pytest.raises(concio.InputError, match=refused) as caught:
            concio.merge(*parts)
        assert f"{tolerance:g} m" in str(caught.value)
        return
    if gap > tolerance * (1 + 1e-6):
        assert joints(concio.merge(*parts)) == joints(parts[0]) | joints(parts[1])
