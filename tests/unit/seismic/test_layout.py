"""Openings, returns and cross walls read from blocks, and the parts that mechanisms are sought in beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid
from concio.analysis.seismic.default_parts import parts_of
from concio.analysis.seismic.layout import leaves_of, openings_of, returns_of
from concio.contact.assembly import assemble
from concio.verdict.assessment_words import EN, IT
from samples import sample
from seismic_walls import site

X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
WINDOW = {"x": 1.75, "y": 1.0, "width": 0.75, "height": 1.0, "lintel": 0.25}
DOOR = {"x": 1.5, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": 0.25}


def corner() -> Model:
    return concio.walls(
        lines=[{"start": (0, 0), "end": (4, 0), "openings": [WINDOW]},
               {"start": (0, 0), "end": (0, 4), "openings": [DOOR]}],
        height=3.0, block_size=(0.75, 0.5, 0.25), block="rigid", unit_weight=20.0, friction=0.6,
    )  # fmt: skip


def wall(*rectangles: tuple[float, float, float, float], dim: int = 2) -> Model:
    """Return rectangles (x0, z0, x1, z1) on the ground, in space 0.3 m thick along y."""
    if dim == 2:
        bodies = tuple(Body(f"b{k}", np.array([[a, b], [c, b], [c, d], [a, d]]), kind="rigid")
                       for k, (a, b, c, d) in enumerate(rectangles))  # fmt: skip
        ground = Body("ground", np.array([[-9.0, -1], [99, -1], [99, 0], [-9, 0]]), kind="fixed")
        weight = (Load("weight", (0, -1)),)
        return Model((*bodies, ground), {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=weight)
    boxes = tuple(Polyhedron.box(f"b{k}", (a, 0, b), (c, 0.3, d), kind="rigid")
                  for k, (a, b, c, d) in enumerate(rectangles))  # fmt: skip
    base = Polyhedron.box("ground", (-9, -9, -1), (99, 9, 0), kind="fixed")
    return Model((*boxes, base), {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=(Load("weight", (0, 0, -1)),))


@settings(max_examples=sample(10, 20, 60), deadline=None)
@given(st.lists(st.tuples(st.floats(0.3, 2.0), st.floats(0.3, 2.0)), min_size=1, max_size=4),
       st.floats(0.5, 2.0), st.floats(0.2, 0.6), st.sampled_from([2, 3]))  # fmt: skip
def test_openings_are_where_they_were_left(
    widths: list[tuple[float, float]], height: float, lintel: float, dim: int
) -> None:
    """Piers and openings of any width under one lintel: each opening once, with its sides."""
    rectangles, sides, at = [], [], 0.0
    for pier, opening in widths:
        rectangles.append((at, 0.0, at + pier, height))
        sides.append((at + pier, at + pier + opening))
        at += pier + opening
    rectangles += [(at, 0.0, at + 0.5, height), (0.0, height, at + 0.5, height + lintel)]
    model = wall(*rectangles, dim=dim)
    axis = np.eye(dim)[0]
    found = openings_of(model, range(len(rectangles)), axis)
    assert [o.sides for o in sorted(found, key=lambda o: o.sides)] == [pytest.approx(s) for s in sides]
    assert all(o.heights == pytest.approx((0.0, height)) for o in found)
    push = axis if dim == 2 else Y
    parts = parts_of(assemble(model), push)
    assert parts.there["openings"] == parts.sought["openings"] == 2 * len(sides)


@settings(max_examples=sample(5, 10, 30), deadline=None)
@given(st.integers(0, 2**31), st.sampled_from([1e-5, 1e-4, 3e-4]))
def test_what_a_drawing_is_out_by_is_no_opening_and_no_level(seed: int, out_by: float) -> None:
    """Corners that are out by some tenths of a millimetre leave slits between stones, at the top of a wall too."""
    model = concio.wall(length=4.0, height=3.0, block_size=(0.5, 0.25), block="rigid", friction=0.6,
                        openings=[WINDOW, DOOR | {"x": 3.0, "width": 0.75}])  # fmt: skip
    rng = np.random.default_rng(seed)
    drawn = replace(model, gap_tolerance=4 * out_by, bodies=tuple(
        b if b.kind == "fixed" else replace(b, outline=b.vertices + rng.uniform(-out_by, out_by, b.vertices.shape))
        for b in model.bodies))  # fmt: skip
    free = [i for i, b in enumerate(model.bodies) if b.kind != "fixed"]
    axis = np.array([1.0, 0.0])
    exact, found = openings_of(model, free, axis), openings_of(drawn, free, axis)
    assert len(exact) == 2
    assert [(*o.sides, *o.heights) for o in found] == [pytest.approx((*o.sides, *o.heights), abs=2.1 * out_by)
                                                      for o in exact]  # fmt: skip
    parts, those = parts_of(assemble(drawn), axis), parts_of(assemble(model), axis)
    assert parts.there == those.there


def test_a_window_between_blocks_of_many_courses_is_one_opening() -> None:
    model = corner()
    free = [i for i, b in enumerate(model.bodies) if b.kind != "fixed"]
    front = next(leaf for leaf in leaves_of(model, free, -Y, X))
    (window,) = openings_of(model, front, X)
    assert window.sides == pytest.approx((1.75, 2.5))
    assert window.heights == pytest.approx((1.0, 2.0))


def test_a_return_is_where_the_wall_is_deep() -> None:
    model = corner()
    free = [i for i, b in enumerate(model.bodies) if b.kind != "fixed"]
    for along, across in ((-Y, X), (-X, Y)):
        (face,) = returns_of(model, free, along, across)
        assert face == pytest.approx((-0.25, 0.25))
    alone = concio.walls(lines=[((0, 0), (3, 0))], height=1.0, block_size=(0.75, 0.5, 0.25), block="rigid")
    assert returns_of(alone, [i for i, b in enumerate(alone.bodies) if b.kind != "fixed"], -Y, X) == ()


def test_parts_stand_beside_every_line_and_are_counted_by_kind() -> None:
    parts = parts_of(assemble(corner()), -Y)
    names = {p.name for p in parts.parts}
    assert {"past 1.75 m across the push", "short of 1.75 m across the push", "past 2.5 m across the push",
            "past 0.25 m across the push", "beyond -1.5 m along the push"} <= names  # fmt: skip
    assert (parts.there["openings"], parts.there["returns"]) == (4, 1)
    assert (parts.sought["openings"], parts.sought["returns"]) == (4, 1)
    assert parts.sought["levels"] < parts.there["levels"]
    assert len({p.bodies for p in parts.parts}) == len(parts.parts)


@pytest.mark.long
def test_the_sentence_counts_each_kind() -> None:
    model = wall((0, 0, 0.5, 1.0), (1.2, 0, 1.7, 1.0), (0, 1.0, 1.7, 1.4))
    found = concio.assess(model, site=site(), levels=["SLV"], direction="right", elsewhere=("height", "out of plane"))
    assert found.places["openings"] == (2, 2)
    assert found.places["levels"] == (1, 1)
    assert found.summary()["sought_at"]["openings"] == {"sought": 2, "there": 2}
    told = " ".join(found.verdict.limits)
    assert "beside lines of openings (2)" in told
    assert "too large for all" not in told
    for words in (EN, IT):
        assert all("{" + kind + "}" in words["sought"] for kind in ("levels", "openings", "returns", "changes"))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 1, 3)))
def test_naming_any_part_of_a_corner_never_worsens_the_outcome(seed: int) -> None:
    """Random rows and ranges of blocks of a corner that is torn off its return, against the outcome without a name."""
    rng = np.random.default_rng(seed)
    model = concio.walls(lines=[((0, 0), (0, 1.5)), ((0, 0), (1.0, 0))], height=1.5, block_size=(0.75, 0.25, 0.5),
                         block="rigid", unit_weight=18.0, friction=0.6)  # fmt: skip
    free = [b for b in model.bodies if b.kind != "fixed"]
    axis, at = rng.normal(size=3), free[int(rng.integers(len(free)))].centroid
    names = [b.name for b in free if float((np.asarray(b.centroid) - at) @ axis) >= 0]
    asked = {"site": site(), "levels": ["SLV"], "direction": "-x", "elsewhere": ("height",)}
    alone, named = (concio.assess(model, mechanisms=m, **asked) for m in (None, {"some": names}))
    assert named.zeta >= alone.zeta * (1 - 1e-6)
    assert named.verdict.outcome is alone.verdict.outcome
    every = next(m for m in named.mechanisms if m.name == "weakest of all")
    assert all(every.multiplier <= m.multiplier * (1 + 1e-9) for m in named.mechanisms)
