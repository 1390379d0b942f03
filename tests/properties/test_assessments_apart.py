"""Structures that touch only what is fixed are assessed one by one: another one changes no number of the first."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import concio
from concio import Assessment, Body, JointLaw, Load, Model, Rigid
from samples import sample
from seismic_walls import site


def box(name: str, span: tuple[float, float], rise: tuple[float, float], kind: str = "rigid", *, deep: float) -> Body:
    (a, b), (low, high) = span, rise
    return Body(name, np.array([[a, low], [b, low], [b, high], [a, high]]), kind=kind, thickness=deep)


def wall(shape: str, name: str, x: float, size: float) -> list[Body]:
    """Return a wall on ground of its own, as high as four sizes: a section, or a facade with or without a window."""
    width = {"section": 0.6, "facade": 6.0, "window": 6.0}[shape] * size
    deep = {"section": 1.0, "facade": 0.5, "window": 0.5}[shape] * size
    bodies = [box(f"{name} ground", (x - size, x + width + size), (-size, 0.0), "fixed", deep=deep)]
    for k, (low, high) in enumerate(itertools.pairwise([0.0, 1.5 * size, 2.5 * size, 4.0 * size])):
        spans = [(0.0, 0.3 * width), (0.5 * width, width)] if shape == "window" and k == 1 else [(0.0, width)]
        bodies += [box(f"{name}{k}{i}", (x + a, x + b), (low, high), deep=deep) for i, (a, b) in enumerate(spans)]
    return bodies


def assessed(bodies: list[Body], **more: Any) -> Assessment:
    model = Model(tuple(bodies), {"block": Rigid(19.0)}, {"joint": JointLaw(0.8)}, loads=(Load("weight", (0.0, -1.0)),))
    asked = {"levels": ["SLV"], "direction": "right", "elsewhere": ("height",), **more}
    return concio.assess(model, site=site(), **asked)


def strips(found: list[Assessment]) -> tuple[list[str], list[tuple[float, ...]]]:
    """Return what was found of strips, without the names of their facades."""
    of = sorted((s.strip.sides, s.strip.kind, s.strip.base, s.multiplier, s.zeta) for one in found for s in one.strips)
    return [kind for _, kind, *_ in of], [(*sides, *numbers) for sides, _, *numbers in of]


@pytest.mark.long
@settings(max_examples=sample(1, 1, 10), deadline=None)
@given(
    st.sampled_from(["section", "facade", "window"]), st.sampled_from(["section", "facade", "window"]),
    st.floats(-3, 3), st.booleans(), st.sampled_from([0.3, 40.0, 1e4]),
)  # fmt: skip
@example("window", "section", 3.0, True, 40.0)
@example("section", "facade", -3.0, False, 0.3)
def test_an_assessment_of_two_structures_is_that_of_each(
    shape: str, other: str, power: float, first: bool, gap: float
) -> None:
    size = 10.0**power
    here, there = wall(shape, "a", 0.0, 1.0), wall(other, "b", 10.0 + gap * max(size, 1.0) + size, size)
    alone = [assessed(here), assessed(there)]
    both = assessed([*there, *here] if first else [*here, *there])
    assert both.zeta == pytest.approx(min(one.zeta for one in alone), rel=1e-12)
    (kinds, numbers), (wanted, values) = strips([both]), strips(alone)
    assert kinds == wanted
    np.testing.assert_allclose(np.reshape(numbers, -1), np.reshape(values, -1), rtol=1e-12, atol=1e-12)
    levels = {kind: [one.places.get(kind, (0, 0)) for one in alone] for kind in both.places}
    for kind, places in levels.items():
        assert both.places[kind] == tuple(map(sum, zip(*places, strict=True))), kind
    least = [next(c.multiplier for c in one.covered if c.kind == "whole") for one in alone]
    ways = [m.multiplier for m in (*both.mechanisms, *both.others) if m.name == "weakest of all"]
    assert ways == pytest.approx([min(least)], rel=1e-12)


@pytest.mark.long
@settings(max_examples=sample(4, 12, 40), deadline=None)
@given(st.floats(-3, 3), st.booleans(), st.sampled_from([0.3, 40.0, 1e4]), st.integers(1, 6))
def test_a_section_beside_any_other_structure_stays_a_section(size: float, first: bool, gap: float, many: int) -> None:
    here = wall("section", "a", 0.0, 1.0)
    steps = [10.0 + (gap + 1.0 + 4.0 * k) * 10.0 ** max(size, 0) for k in range(many)]
    there = [b for k, x in enumerate(steps) for b in wall("section", f"b{k}", x, 10.0**size)]
    found = assessed([*there, *here] if first else [*here, *there], levels=["SLD"])
    assert not found.strips
    assert "out of plane" not in [item.kind for item in found.open]
    with pytest.raises(concio.InputError, match="facade drawn in elevation"):
        assessed([*here, *there], out_of_plane={"held": [3.0]})
