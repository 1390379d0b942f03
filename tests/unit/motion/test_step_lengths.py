"""How long the steps of a motion are, what two of them are together, and how far another structure follows."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from concio.analysis.motion import mover as movers
from concio.analysis.motion.mover import CERTIFIED, HALVINGS, SUNK, Mover, Row
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


def maker(
    monkeypatch: pytest.MonkeyPatch,
    residual: Callable[[float], float],
    *,
    adaptive: bool = True,
    struck: Callable[[float], float] = lambda h: 0.0,
    allowed: float = np.inf,
    meets: float | None = None,
    longest: float = np.inf,
) -> tuple[Mover, SimpleNamespace]:
    """Return what makes steps whose residual depends on their length, and what it did."""
    done = SimpleNamespace(tried=[], told=[])
    mover: Mover = object.__new__(Mover)
    mover.step, mover.h, mover.calm, mover.adaptive, mover.outran = 1.0, 1.0, 0, adaptive, ""
    mover.drive = lambda time, h: (time, h)  # type: ignore[assignment, return-value]

    def step(state: SimpleNamespace, h: float, driven: tuple[float, float]) -> tuple[SimpleNamespace, SimpleNamespace]:
        assert driven == (state.time, h)
        done.tried.append(h)
        solution = SimpleNamespace(residual=residual(h))
        return SimpleNamespace(time=state.time + h), SimpleNamespace(
            solution=solution, struck=struck(h), meets=None, part=None, left=0.5
        )

    def located(found: object, part: object, h: float) -> float | None:
        return meets if meets is not None and h > meets else None

    mover.stepper = SimpleNamespace(step=step, maker=SimpleNamespace(width=4.0, ties=None))  # type: ignore[assignment]
    mover.meetings = SimpleNamespace(  # type: ignore[assignment]
        length=lambda time, h: min(h, allowed), located=located, after=lambda *told: done.told.append(told), until=0.0
    )
    mover.pace = SimpleNamespace(  # type: ignore[assignment]
        longest=lambda state, h: longest, outrun=lambda state, h, least: "b" if longest < least else ""
    )
    return mover, done


BEGIN = SimpleNamespace(time=2.0)


def test_a_step_is_halved_until_it_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    mover, done = maker(monkeypatch, lambda h: 0.5 * CERTIFIED if h <= 0.3 else 2 * CERTIFIED)
    made = mover._made(BEGIN, 1.0)  # type: ignore[arg-type]
    assert made is not None
    assert (made[0].time, made[2], done.tried) == (2.25, 0.25, [1.0, 0.5, 0.25])
    assert done.told == [(2.0, False, np.inf, 0.25)]
    stiff, done = maker(monkeypatch, lambda h: 2 * CERTIFIED)
    assert stiff._made(BEGIN, 1.0) is None  # type: ignore[arg-type]
    assert done.tried == [0.5**k for k in range(HALVINGS + 1)]
    fixed, done = maker(monkeypatch, lambda h: 2 * CERTIFIED, adaptive=False)
    assert fixed._made(BEGIN, 1.0) is None  # type: ignore[arg-type]
    assert done.tried == [1.0]


def test_a_step_in_which_a_body_sinks_in_is_halved_and_kept_where_it_is_the_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for far, count in ((0.3, 3), (0.0, HALVINGS + 1)):
        mover, done = maker(monkeypatch, lambda h: 0.0, struck=lambda h, far=far: SUNK * (8.0 if h > far else 2.0))
        made = mover._made(BEGIN, 1.0)  # type: ignore[arg-type]
        assert made is not None
        assert len(done.tried) == count
        assert made[0].time == 2.0 + 0.5 ** (count - 1)
    fixed, done = maker(monkeypatch, lambda h: 0.0, struck=lambda h: 8.0 * SUNK, adaptive=False)
    assert fixed._made(BEGIN, 1.0)[2] == 1.0  # type: ignore[arg-type, index]


def test_an_impact_ends_a_step_where_the_step_to_it_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    mover, done = maker(monkeypatch, lambda h: 0.0, meets=0.4)
    made = mover._made(BEGIN, 1.0)  # type: ignore[arg-type]
    assert made is not None
    assert (made[0].time, made[2], done.tried) == (2.4, 0.0, [1.0, 0.4])
    assert done.told == [(2.0, True, 0.5, 1.0)]
    other, done = maker(monkeypatch, lambda h: 2 * CERTIFIED if h == 0.4 else 0.0, meets=0.4)
    made = other._made(BEGIN, 1.0)  # type: ignore[arg-type]
    assert made is not None
    assert (made[0].time, made[2], done.tried) == (3.0, 1.0, [1.0, 0.4])
    fixed, done = maker(monkeypatch, lambda h: 0.0, meets=0.4, adaptive=False)
    assert fixed._made(BEGIN, 1.0)[2] == 1.0  # type: ignore[arg-type, index]


def test_steps_that_meetings_or_speed_make_shorter(monkeypatch: pytest.MonkeyPatch) -> None:
    """They say nothing of the length of the next one; what outruns the least step cannot be followed."""
    mover, done = maker(monkeypatch, lambda h: 0.0, allowed=0.7)
    assert mover._made(BEGIN, 1.0)[2] == 0.0  # type: ignore[arg-type, index]
    assert done.tried == [0.7]
    fast, done = maker(monkeypatch, lambda h: 0.0, longest=0.3)
    assert fast._made(BEGIN, 1.0)[2] == 0.0  # type: ignore[arg-type, index]
    assert done.tried == [0.25]
    faster, done = maker(monkeypatch, lambda h: 0.0, longest=1e-9)
    assert faster._made(BEGIN, 1.0) is None  # type: ignore[arg-type]
    assert (faster.outran, done.tried) == ("b", [])


@pytest.mark.parametrize(("error", "taken"), [(0.5, True), (2.0, False)])
def test_a_step_is_cut_where_a_tie_gives_way_if_the_cut_is_certified(
    monkeypatch: pytest.MonkeyPatch, error: float, taken: bool
) -> None:
    mover, _ = maker(monkeypatch, lambda h: error * CERTIFIED if h == 0.3 else 0.0)
    monkeypatch.setattr(movers, "ties_give_way", lambda before, after: after.time > 2.3)
    asked: list[tuple[float, float]] = []

    def where(
        ties: object, before: object, after: object, at: Callable[[float], Any], whole: float, least: float
    ) -> Any:
        asked.append((whole, least))
        return at(0.3)

    monkeypatch.setattr(movers, "where_ties_give_way", where)
    made = mover._attempt(BEGIN, 1.0)  # type: ignore[arg-type]
    assert made is not None
    assert asked == [(1.0, movers.LEAST_CUT)]
    assert (made[0].time, made[2]) == ((2.3, 0.0) if taken else (3.0, 1.0))
    assert mover.meetings.until == (3.0 if taken else 0.0)
    mover._attempt(BEGIN, 0.2)  # type: ignore[arg-type]
    mover.adaptive = False
    mover._attempt(BEGIN, 1.0)  # type: ignore[arg-type]
    assert len(asked) == 1  # none gave way, or steps are as long as they are
