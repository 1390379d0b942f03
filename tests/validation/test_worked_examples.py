"""Worked examples of open textbooks: friction, levers, a ladder, a door, a wedge."""

from __future__ import annotations

import pytest
from validation_cases import worked_examples
from validation_cases.row import check


@pytest.mark.long
def test_what_the_books_print() -> None:
    check(worked_examples.rows())


def test_ladder_and_wedge() -> None:
    """By the books' formulas, with all digits."""
    normal, friction, wall, least = worked_examples.ladder()
    assert normal == pytest.approx(400.0)
    assert friction == pytest.approx(wall)
    assert least == pytest.approx(wall / normal, rel=1e-5)
    assert 5.0 + worked_examples.carried(worked_examples.wedge(5.0, 1.0)) == pytest.approx(9.3484, rel=1e-5)
