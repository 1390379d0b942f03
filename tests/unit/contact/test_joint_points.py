"""Contact points along a joint: shares that sum to one, symmetric, exact in moments, and numbers that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from concio.contact.joint_points import CRUSHING, LEAST_GRADED, graded_rule, joint_rule


@pytest.mark.parametrize("points", [2, 3, 5, 9, LEAST_GRADED, 12, CRUSHING, 40])
def test_every_rule_stands_for_the_whole_joint_from_edge_to_edge(points: int) -> None:
    x, share = joint_rule(points)
    assert len(x) == len(share) == points
    assert x[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert (np.diff(x) > 0).all()
    assert (share > 0).all()
    assert share.sum() == pytest.approx(1.0)
    assert x + x[::-1] == pytest.approx(np.ones(points))
    assert share == pytest.approx(share[::-1])
    if points > 2:  # as stiff in bending as a joint of springs
        assert share @ (x - 0.5) ** 2 == pytest.approx(1 / 12)


@pytest.mark.parametrize("points", [LEAST_GRADED - 2, LEAST_GRADED - 1, LEAST_GRADED + 1, 21])
def test_odd_or_few_points_are_not_graded(points: int) -> None:
    with pytest.raises(ValueError, match=f"{points} points cannot be graded"):
        graded_rule(points)
