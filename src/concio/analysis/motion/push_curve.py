"""A capacity curve as it is computed: equilibria of one structure under a growing displacement or load."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.joint_events import JointEvent, joint_events, tie_events
from concio.analysis.motion.located import bars_give_way, highest, meetings, touching
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.push_result import PushEnding
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Balanced, Statics
from concio.contact.reference import Reference
from concio.problem.solution import Progress, ProgressCallback

Array = np.ndarray

FIRST = 1e-3
"""First step over the others: rigid structures reach their peak at once."""

GROWTH = 3.0
"""Factor by which steps grow after an equilibrium was found at the first attempt."""

SMALLEST = 1e-6
"""Step over that asked for below which no equilibrium can be followed."""

LOCKED = 1e4
"""Multiplier above which a structure locks."""

MOST_FAILED = 20
"""Attempts without an equilibrium, since the last step as long as that asked for, after which it is not followed."""

CREEPING = 1e-2
"""Steps over that asked for which, one after the other, lead nowhere; :data:`MOST_CREEPING` of them are enough."""

MOST_CREEPING = 25

MOST_POINTS = 5000
"""Points of a curve at most."""

LOCATED = 1e-9
"""Steps over that asked for to which the yielding and breaking of ties is located, and where bodies meet and part."""

PEAK = 2e-7
"""Share of the peak to which it is looked for between two points of the curve."""

ENDS = 1e-9
"""Error of the last multiplier over the peak."""


UNSTABLE = (
    "equilibria of the curve are unstable aside from the displacement that grows: a disturbance leads away from them"
)
"""What is said of a curve with such points."""


@dataclass
class PushCurve:
    """A curve as it is computed.

    Parameters
    ----------
    reference : Reference
    statics : Statics
    factors : mapping of str to float
    step, until : float
        Of the controlled displacement [m], or of the multiplier.
    smallest : float
        Multiplier at which the strength counts as lost.
    progress : callable, optional
    beyond : float
        Multiplier above which the curve is of no interest: it stops there.
    """

    reference: Reference
    statics: Statics
    factors: dict[str, float]
    step: float
    until: float
    smallest: float
    progress: ProgressCallback | None
    beyond: float = np.inf
    displacement: list[float] = field(default_factory=list)
    multiplier: list[float] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)
    states: list[MotionState] = field(default_factory=list)
    reactions: list[Array] = field(default_factory=list)
    events: list[JointEvent] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    met: set[frozenset[int]] = field(default_factory=set)
    gave: bool = False
    interruption: Interruption = field(default_factory=Interruption)

    def __post_init__(self) -> None:
        self.observer = Observer(self.reference, self.statics.maker, self.statics.frames, self.factors)

    def keep(self, found: Balanced, displacement: float) -> None:
        """Keep a point; tell where the first one is unstable."""
        if found.unstable and UNSTABLE not in self.notes:
            self.notes.append(UNSTABLE)
        self.statics.go_back(found)
        rows = self.observer.rows(found.state)
        if self.states:
            self.events += joint_events(
                self.reference.model, self.statics.maker, rows, self.states[-1].memory, found.state.memory,
                len(self.states),
            )  # fmt: skip
            self.events += tie_events(
                self.reference.model, self._tie_ends(found.state), self.states[-1].ties, found.state.ties,
                len(self.states),
            )  # fmt: skip
        self.displacement.append(displacement)
        self.multiplier.append(found.multiplier)
        self.residual.append(found.residual)
        self.states.append(found.state)
        self.reactions.append(self.observer.reactions(found.force, found.pairs, rows.frame))

    def told(self, share: float) -> bool:
        """Tell how far it is; return whether to stop."""
        if self.multiplier[-1] > self.beyond:
            return True
        if self.progress is None:
            return self.interruption.wanted
        message = f"multiplier {self.multiplier[-1]:.4g} at {self.displacement[-1]:.4g} m"
        return bool(self.progress(Progress("push", len(self.states), 1.0 - share, message))) or self.interruption.wanted

    def by_displacement(self) -> PushEnding:
        """Let the controlled displacement grow."""
        step, creeping, failed, growth = FIRST * self.step, 0, 0, GROWTH
        while len(self.states) < MOST_POINTS:
            here, d, load = self.states[-1], self.displacement[-1], self.multiplier[-1]
            if d >= self.until * (1 - 1e-12):
                return PushEnding.REACHED
            wanted = min(step, self.until - d)
            found = self.statics.balance(here, load, target=wanted)
            if not found.found:
                step, failed, growth = 0.5 * step, failed + 1, 1.0
                if step < SMALLEST * self.step or failed > MOST_FAILED:
                    return PushEnding.NO_EQUILIBRIUM
                continue
            failed = 0 if wanted >= CREEPING * self.step else failed
            if found.multiplier > LOCKED:
                return PushEnding.LOCKED
            gave = self._gives_way(here, found.state)
            if found.multiplier <= self.smallest < load and not gave:
                return self._last(here, d, load, found, wanted)
            pairs = self._meeting(here, found.state)
            if gave or pairs:
                found, wanted = self._where_it_changes(here, load, found, wanted, pairs)
                gave = self._gives_way(here, found.state)
            self.keep(found, d + wanted)
            self._sharpen(located=gave)
            if self.told(min(d / self.until, 1 - max(found.multiplier, 0.0) / max(self.multiplier[1:]))):
                return PushEnding.STOPPED
            creeping = creeping + 1 if wanted < CREEPING * min(self.step, self.until - d) else 0
            if creeping > MOST_CREEPING:
                return PushEnding.NO_EQUILIBRIUM
            step, growth = FIRST * self.step if gave else min(growth * step, self.step), GROWTH
        self.notes.append(f"{MOST_POINTS:,} points were computed")
        return PushEnding.STOPPED

    def _tie_ends(self, state: MotionState) -> Array:
        """Return where the first ends of the ties are (k, d) [m]."""
        return self.statics.maker.ties.a.positions(state.placement, state.strain)

    def _gives_way(self, before: MotionState, after: MotionState) -> bool:
        """Return whether a bar begins to yield or breaks between two equilibria."""
        return bars_give_way(self.statics.maker.ties, before, after)

    def _meeting(self, before: MotionState, after: MotionState) -> set[frozenset[int]]:
        """Return the pairs of bodies that begin or cease to touch between two equilibria; each is located once."""
        pairs = meetings(self.reference, before, after) - self.met
        self.met |= pairs
        return pairs

    def _changes(self, before: MotionState, after: MotionState, pairs: set[frozenset[int]]) -> bool:
        """Return whether a tie gives way between two equilibria, or one of some pairs begins or ceases to touch."""
        old, new = touching(self.reference, before), touching(self.reference, after)
        return self._gives_way(before, after) or any((pair in old) != (pair in new) for pair in pairs)

    def _sharpen(self, *, located: bool) -> None:
        """Look for the peak between the points beside the largest, once the curve falls behind it; keep it.

        Parameters
        ----------
        located : bool
            Whether the last point is one at which a tie gave way: what falls behind it is not a top.
        """
        top = len(self.multiplier) - 2
        gave, self.gave = self.gave, located
        if top < 1 or gave or self.multiplier[top] <= max(*self.multiplier[:top], self.multiplier[-1], 0.0):
            return
        start, d, load = self.states[top - 1], self.displacement[top - 1], self.multiplier[top - 1]

        def at(share: float) -> float:
            trial = self.statics.balance(start, load, target=share)
            fine = trial.found and not self._gives_way(start, trial.state)
            return trial.multiplier if fine else -np.inf

        known = [(x - d, f) for x, f in zip(self.displacement[top - 1 :], self.multiplier[top - 1 :], strict=True)]
        best = highest(at, known, PEAK)
        if best is None:
            return
        found = self.statics.balance(start, load, target=best)
        if found.found and found.multiplier > self.multiplier[top]:
            self._insert(found, d + best, top if d + best < self.displacement[top] else top + 1)

    def _insert(self, found: Balanced, displacement: float, at: int) -> None:
        """Put a point between others."""
        self.statics.go_back(found)
        rows = self.observer.rows(found.state)
        reaction = self.observer.reactions(found.force, found.pairs, rows.frame)
        kept: tuple[tuple[list[Any], Any], ...] = (
            (self.displacement, displacement), (self.multiplier, found.multiplier), (self.residual, found.residual),
            (self.states, found.state), (self.reactions, reaction),
        )  # fmt: skip
        for values, value in kept:
            values.insert(at, value)
        self.events = [replace(e, step=e.step + 1) if e.step >= at else e for e in self.events]

    def _where_it_changes(
        self, here: MotionState, load: float, found: Balanced, wanted: float, pairs: set[frozenset[int]]
    ) -> tuple[Balanced, float]:
        """Return the first equilibrium at which a tie yields or breaks or bodies meet or part, and its distance [m].

        A tie that breaks within a step would pull to its end, further than it can be stretched; what meets within a
        step would carry from its beginning.
        """
        low = 0.0
        while wanted - low > LOCATED * self.step:
            middle = 0.5 * (low + wanted)
            trial = self.statics.balance(here, load, target=middle)
            if trial.found and self._changes(here, trial.state, pairs):
                found, wanted = trial, middle
            elif trial.found:
                low = middle
            else:
                break
        return found, wanted

    def _last(self, here: MotionState, d: float, load: float, found: Balanced, wanted: float) -> PushEnding:
        """Find the displacement at which the multiplier has fallen to the smallest one."""
        low, above = 0.0, load
        high, below = wanted, found.multiplier
        peak = max(self.multiplier)
        best, at = found, wanted
        for k in range(40):
            if abs(best.multiplier - self.smallest) <= ENDS * peak or high - low <= 1e-13 * max(d, self.step):
                break
            share = (above - self.smallest) / (above - below)
            middle = low + (high - low) * (0.5 if k % 4 == 3 else min(max(share, 0.01), 0.99))
            trial = self.statics.balance(here, load, target=middle)
            if not trial.found:
                break
            if trial.multiplier > self.smallest:
                low, above = middle, trial.multiplier
            else:
                high, below = middle, trial.multiplier
            best, at = trial, middle
        self.keep(best, d + at)
        self._sharpen(located=False)
        return PushEnding.LOST

    def _load_where_it_changes(
        self, here: MotionState, load: float, found: Balanced, pairs: set[frozenset[int]]
    ) -> Balanced:
        """Return the first equilibrium under a growing load at which a tie gives way or bodies meet or part."""
        low = load
        while found.multiplier - low > LOCATED * self.step:
            trial = self.statics.balance(here, 0.5 * (low + found.multiplier))
            if trial.found and self._changes(here, trial.state, pairs):
                found = trial
            elif trial.found:
                low = trial.multiplier
            else:
                break
        return found

    def by_load(self) -> PushEnding:
        """Let the load grow."""
        step, moved = self.step, 0.0
        followed = self.statics.control
        while len(self.states) < MOST_POINTS:
            here, load = self.states[-1], self.multiplier[-1]
            if load >= self.until * (1 - 1e-12):
                return PushEnding.REACHED
            found = self.statics.balance(here, min(load + step, self.until))
            if not found.found:
                step *= 0.5
                if step < SMALLEST * self.step:
                    return PushEnding.NO_LARGER_LOAD
                continue
            assert followed is None
            pairs = self._meeting(here, found.state)
            if pairs or self._gives_way(here, found.state):
                found = self._load_where_it_changes(here, load, found, pairs)
            moved += self.statics.work_displacement(here, found)
            self.keep(found, moved)
            if found.multiplier > LOCKED:
                return PushEnding.LOCKED
            if self.told(min(load / self.until, 1.0)):
                return PushEnding.STOPPED
        self.notes.append(f"{MOST_POINTS:,} points were computed")
        return PushEnding.STOPPED
