"""Wall friction in a stack between two walls: Janssen (1895), and the elastic eigenvalue."""

from __future__ import annotations

from validation_cases import stack_between_walls
from validation_cases.row import check


def test_rows():
    check(stack_between_walls.rows())


def test_refinement_approaches_the_eigenvalue():
    wanted = stack_between_walls.elastic_alpha()
    errors = [abs(stack_between_walls.decay(stack_between_walls.pressed(n)) - wanted) for n in (1, 2, 3)]
    assert errors[2] < errors[1] < errors[0]
