"""Fill as Coulomb blocks behind an arch, beside the rule that caps its pressure."""

from __future__ import annotations

import pytest
from validation_cases import fill_as_blocks
from validation_cases.row import check


def test_without_friction_the_blocks_are_the_fluid_of_k_1() -> None:
    check([fill_as_blocks.fluid()])


@pytest.mark.parametrize("angle", [20.0, 30.0])
def test_columns_carry_more_the_more_they_rub_and_the_rule_lies_between(angle: float) -> None:
    """The rule lies between fill that slips off a smooth arch and fill on a rough one."""
    rough = [fill_as_blocks.bound("blocks", angle, columns, 1.0) for columns in (0.0, 0.5, 1.0)]
    assert rough == sorted(rough)
    smooth = fill_as_blocks.bound("blocks", angle, 0.0, 0.0)
    assert fill_as_blocks.bound("weight") < smooth < fill_as_blocks.bound("rule", angle) < rough[0]


@pytest.mark.long
def test_rows() -> None:
    check(fill_as_blocks.rows())
