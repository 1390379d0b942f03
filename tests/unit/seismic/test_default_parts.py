"""Where parts of a structure begin: levels, lines at which it changes, and structures that do not touch."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.seismic.default_parts import Part, _lines, _pairs_of, _spread, _told_apart, structures_of
from concio.analysis.seismic.searching import SAME, _alike

UP, ALONG = np.array([0.0, 1.0]), np.array([1.0, 0.0])


def slabs(*sizes: tuple[float, float, float, float], scale: float = 1.0) -> SimpleNamespace:
    """Rectangles x0, x1, z0, z1 as bodies of a model."""
    bodies = []
    for x0, x1, z0, z1 in sizes:
        corners = scale * np.array([(x0, z0), (x1, z0), (x1, z1), (x0, z1)])
        bodies.append(SimpleNamespace(vertices=corners, volume=scale**2 * (x1 - x0) * (z1 - z0)))
    return SimpleNamespace(bodies=bodies)


def lines(model: SimpleNamespace, axis: np.ndarray, most: int = 9, *, changes_only: bool = False) -> list[float]:
    return _lines(model, list(range(len(model.bodies))), axis, most, changes_only=changes_only)


@pytest.mark.parametrize("scale", [1.0, 0.125, 64.0])
def test_levels_are_where_bodies_begin_and_changes_where_the_section_does(scale: float) -> None:
    """Two courses of 4 m, one of 2 m, and a stone of 0.5 m beside one of 1.5 m that is higher."""
    wall = slabs((0, 4, 0, 1), (0, 4, 1, 2), (1, 3, 2, 3), (1, 1.5, 3, 3.5), (1.5, 3, 3, 4), scale=scale)
    assert lines(wall, UP) == pytest.approx([1 * scale, 2 * scale, 3 * scale])
    assert lines(wall, UP, changes_only=True) == pytest.approx([2 * scale, 3.5 * scale])
    assert lines(wall, UP, 1) == pytest.approx([2 * scale]), "first where much changes"
    assert lines(wall, UP, 2) == pytest.approx([1 * scale, 2 * scale])
    assert lines(wall, ALONG, changes_only=True) == pytest.approx([1 * scale, 1.5 * scale, 3 * scale])


@pytest.mark.parametrize(
    ("below", "above", "counts"), [(1.0, 0.9803, 0), (0.9803, 1.0, 0), (1.0, 0.97, 1), (0.97, 1.0, 1)]
)
def test_a_change_is_a_share_of_the_larger_section(below: float, above: float, counts: int) -> None:
    wall = slabs((0, below, 0, 1), (0, above, 1, 3))
    assert len(lines(wall, UP, changes_only=True)) == counts


def test_at_most_so_many_are_chosen_evenly() -> None:
    assert _spread(list("abc"), 3) == ["a", "b", "c"]
    assert _spread(list("abc"), 0) == []
    assert _spread(list(range(11)), 1) == [5]
    assert _spread(list(range(11)), 4) == [2, 4, 6, 8]
    assert _spread(list(range(100)), 9) == [10, 20, 30, 40, 50, 59, 69, 79, 89]


def test_structures_touch_through_blocks_and_not_through_the_ground() -> None:
    """Blocks 1 and 3 touch, 2 and 4 stand alone on the ground 0; -1 is a fixed point."""
    pairs = np.array([(0, 1), (0, 1), (1, 3), (0, 2), (2, -1), (4, 0), (3, 1)])
    kinds = ["fixed", "rigid", "rigid", "rigid", "elastic"]
    model = SimpleNamespace(bodies=[SimpleNamespace(kind=k) for k in kinds])
    assembly = SimpleNamespace(model=model, pairs=SimpleNamespace(body_a=pairs[:, 0], body_b=pairs[:, 1]))
    groups = structures_of(assembly)
    assert groups == [(1, 3), (2,), (4,)]
    assert _pairs_of(assembly, groups) == [4, 2, 1]


def test_names_have_as_many_digits_as_tell_them_apart() -> None:
    near = _told_apart((Part("above", 12.34561, (1,)), Part("above", 12.34562, (2,)), Part("past", 1.0, (3,))))
    assert [part.name for part in near] == [
        "above z = 12.34561 m", "above z = 12.34562 m", "past 1 m across the push",
    ]  # fmt: skip
    far = _told_apart((Part("beyond", 12.34561, (1,), "b"), Part("beyond", 12.35, (2,))))
    assert [part.name for part in far] == ["beyond 12.35 m along the push of 'b'", "beyond 12.35 m along the push"]


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_two_searches_met_one_mechanism_where_multiplier_and_blocks_are_the_same(unit: float) -> None:
    def met(multiplier: float, blocks: dict[int, int] | None) -> SimpleNamespace:
        return SimpleNamespace(
            multiplier=unit * multiplier, mechanics=None if blocks is None else SimpleNamespace(of_body=blocks)
        )

    one = met(0.25, {1: 0, 2: 1})
    assert _alike(one, met(0.25 * (1 + 0.5 * SAME), {1: 0, 2: 1}))
    assert not _alike(one, met(0.25, {1: 0, 2: 0}))
    for share in (1 + 2 * SAME, 1 - 2 * SAME, -1.0):
        assert not _alike(one, met(0.25 * share, {1: 0, 2: 1}))
        assert not _alike(met(0.25 * share, {1: 0, 2: 1}), one)
    assert not _alike(one, met(0.25, None))
    assert not _alike(met(0.25, None), met(0.25, None))
