"""By how much a peak falls short as the joints give way: the chord of what falls, carried back to the peak."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.model.actions import Tie
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.verdict.push_verdict import LENT, _lent


def told(d: list[float], m: list[float], top: int, **changed: object) -> str:
    model = SimpleNamespace(
        laws=changed.pop("laws", {"joint": JointLaw(0.6)}), ties=changed.pop("ties", ()),
        materials=changed.pop("materials", {"stone": Rigid(20.0)}),
    )  # fmt: skip
    given = {"by_load": False, "peak_passed": True} | changed
    return _lent(SimpleNamespace(
        peak_step=top, displacement=np.array(d), multiplier=np.array(m), model=model, **given,
    ))  # fmt: skip


CURVE = ([0.0, 0.02, 0.03, 0.05, 0.2], [0.0, 0.5, 0.48, 0.44, 0.1])


@pytest.mark.parametrize(("sense", "unit"), [(1.0, 1.0), (-1.0, 1.0), (1.0, 1e-3)])
def test_the_chord_is_that_to_a_point_twice_as_far_as_the_peak(sense: float, unit: float) -> None:
    """From 0.02 to 0.05 m it falls by 0.06 of 0.5: carried back over 0.02 m, a share of 8 %."""
    d, m = CURVE
    assert " 8 %" in told([sense * unit * x for x in d], m, 1)
    assert " 8 %" in told(d, [7.0 * x for x in m], 1)


def test_a_curve_that_ends_before_is_taken_to_its_end() -> None:
    """0.02 m at the peak and 0.03 m at the end: 0.02 of 0.5 over a half of the way, 8 % again."""
    assert " 8 %" in told(CURVE[0][:3], CURVE[1][:3], 1)


def test_where_something_else_gives_way_or_nothing_is_seen_no_share_is_told() -> None:
    d, m = CURVE
    soft = {"laws": {"joint": JointLaw(0.6), "bed": JointLaw(0.6, normal_stiffness=1e5)}}
    bar = Tie("t", "a", (0.0, 0.0), "", (1.0, 0.0), stiffness=1.0)
    soil = Tie("t", "a", (0.0, 0.0), "", (1.0, 0.0), stiffness=1.0, kind="soil")
    elastic = {"materials": {"stone": Rigid(20.0), "brick": Elastic(E=1e6, nu=0.2)}}
    for changed in (soft, {"ties": (bar,)}, elastic, {"by_load": True}, {"peak_passed": False}):
        assert told(d, m, 1, **changed) == LENT
    assert told(d, m, 1, ties=(soil,)) != LENT
    assert told(d, [0.0, 0.5, 0.4999, 0.4995, 0.4], 1) == LENT, "a tenth of a per cent"
    assert told([0.0, *d[1:]], [0.5, 0.4, 0.3, 0.2, 0.1], 0) == LENT
    assert told(d, [0.0, -0.5, -0.6, -0.7, -0.8], 1) == LENT
