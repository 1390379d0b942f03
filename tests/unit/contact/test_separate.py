"""Which bodies stand apart: by the size of the smaller one, whatever the unit and whatever else there is."""

from __future__ import annotations

import numpy as np
import pytest

from concio.contact.separate import grouped


def cubes(*boxes: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the boxes of cubes in a row, each from where it begins and with its side."""
    low = np.array([(x, 0.0, 0.0) for x, _ in boxes])
    return low, low + np.array([(side, side, side) for _, side in boxes])


@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("large", [1.0, 50.0])
def test_bodies_stand_apart_from_a_tenth_of_the_smaller_one_on(size: float, large: float) -> None:
    for gap, groups in ((0.05, 1), (0.2, 2)):
        low, high = cubes((-large * size, large * size), (gap * size, size))
        found = grouped(low, high, np.ones(2, dtype=bool), 1e-9 * size)
        assert len(found) == groups
        assert sorted(np.concatenate(found).tolist()) == [0, 1]


def test_what_a_fixed_body_or_a_tie_connects() -> None:
    """Two cubes on one ground stand apart, each with the ground; a tie makes them one, a named group too."""
    low, high = cubes((0.0, 1.0), (5.0, 1.0), (0.0, 6.0))
    low[2, 2], high[2, 2] = -1.0, 0.0
    free = np.array([True, True, False])
    assert [group.tolist() for group in grouped(low, high, free, 1e-9)] == [[0, 2], [1, 2]]
    assert [g.tolist() for g in grouped(low, high, free, 1e-9, tied=np.array([[0, 1]]))] == [[0, 1, 2]]
    assert [g.tolist() for g in grouped(low, high, free, 1e-9, known=[np.array([0, 1])])] == [[0, 1, 2]]
    assert len(grouped(low, high, free, 5.0)) == 1
