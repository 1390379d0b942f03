"""How long the steps of a motion are, what two of them are together, and how far another structure follows."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.motion.mover import Mover, Row
from concio.analysis.motion.push_apart import PARTS, _at


def test_two_steps_together_are_as_bad_as_the_worse_one_and_did_what_both_did() -> None:
    first = Row(3e-9, "states", 2, 0.1, {"friction": 1.0, "damping": -2.0}, np.array([[1.0, 2.0]]))
    second = Row(1e-9, "cones", 5, 0.4, {"friction": 0.25, "damping": 8.0}, np.array([[3.0, 4.0]]))
    for a, b in ((first, second), (second, first)):
        both = b.after(a)
        assert (both.residual, both.how) == (3e-9, "states")
        assert (both.factorisations, both.depth) == (7, 0.4)
        assert both.works == {"friction": 1.25, "damping": 6.0}
        assert both.reactions is b.reactions


def moved(monkeypatch: pytest.MonkeyPatch, step: float, most: list[float]) -> Mover:
    """Return what makes steps of the lengths that were asked for, but not above the next of those given."""
    mover: Mover = object.__new__(Mover)
    mover.step, mover.h, mover.calm = step, step, 0
    mover.state = SimpleNamespace(time=0.0)  # type: ignore[assignment]
    solution = SimpleNamespace(t=None, residual=0.0, how="", factorisations=1)
    report = SimpleNamespace(solution=solution, pairs=None, frame=None, depth=0.0, works={})
    mover.observer = SimpleNamespace(reactions=lambda *_: None)  # type: ignore[assignment]
    mover.made = []  # type: ignore[attr-defined]

    def attempt(state: SimpleNamespace, h: float) -> tuple[SimpleNamespace, SimpleNamespace, float]:
        used = min(h, most.pop(0) if most else np.inf)
        mover.made.append(used)  # type: ignore[attr-defined]
        return SimpleNamespace(time=state.time + used), report, used

    monkeypatch.setattr(mover, "_attempt", attempt)
    return mover


def test_steps_that_were_too_long_stay_short_until_two_went_well(monkeypatch: pytest.MonkeyPatch) -> None:
    mover = moved(monkeypatch, 1.0, [0.25])
    for _ in range(8):
        assert mover.once(100.0) is not None
    assert mover.made == [0.25, 0.25, 0.25, 0.5, 1.0, 1.0, 1.0, 1.0]  # type: ignore[attr-defined]


def test_a_step_that_an_end_cuts_says_nothing_of_the_next_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is as long as before; one that was too long all the same leaves the next one as short as itself."""
    mover = moved(monkeypatch, 1.0, [])
    for end in (0.9, 1.0, 2.5, 9.0):
        mover.advance(end)
    assert mover.made == pytest.approx([0.9, 0.1, 1.0, 0.5, *[1.0] * 6, 0.5])  # type: ignore[attr-defined]
    short = moved(monkeypatch, 1.0, [0.2])
    short.once(0.8)
    assert short.h == 0.2


@pytest.mark.parametrize("reach", [10.0, 1.0, 0.3, 0.1, 0.07])
@pytest.mark.parametrize(("begin", "wanted"), [(0.0, 0.7), (0.3, 0.1), (-0.2, 0.5), (0.4, 0.4)])
def test_a_structure_follows_to_a_multiplier_in_as_many_parts_as_it_needs(
    begin: float, wanted: float, reach: float
) -> None:
    asked: list[float] = []

    def balance(state: float, there: float) -> SimpleNamespace:
        asked.append(there)
        return SimpleNamespace(found=abs(there - state) <= reach, state=there)

    one, run = (
        SimpleNamespace(statics=SimpleNamespace(balance=balance)),
        SimpleNamespace(states=[begin], multiplier=[begin]),
    )
    found, got = _at(one, run, wanted)  # type: ignore[arg-type]
    assert found is not None
    assert (found.state, got) == (wanted, wanted)
    low, high = sorted((begin, wanted))
    assert all(low <= there <= high for there in asked)
    assert len(asked) <= 4 + 2 * abs(wanted - begin) / reach + np.log2(1 + abs(wanted - begin) / reach)


@pytest.mark.parametrize(("begin", "wanted", "end"), [(0.0, 0.7, 0.4), (0.5, -0.5, 0.2), (0.1, 0.9, 0.1)])
def test_where_a_structure_stops_following_is_told_to_a_small_part_of_the_way(
    begin: float, wanted: float, end: float
) -> None:
    way = np.sign(wanted - begin)

    def balance(state: float, there: float) -> SimpleNamespace:
        return SimpleNamespace(found=way * (there - end) <= 0, state=there)

    one, run = (
        SimpleNamespace(statics=SimpleNamespace(balance=balance)),
        SimpleNamespace(states=[begin], multiplier=[begin]),
    )
    found, got = _at(one, run, wanted)  # type: ignore[arg-type]
    assert found is None
    assert 0 <= way * (end - got) <= 2 * abs(wanted - begin) / PARTS
