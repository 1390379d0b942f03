"""Pushing a structure over: equilibria at large displacements, past the peak, until nothing is carried any more."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.joint_events import JointEvent, joint_events, tie_events
from concio.analysis.motion.located import highest, meetings, ties_give_way, touching
from concio.analysis.motion.moved_supports import begun
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.push_asked import (
    control_asked,
    direction_asked,
    factors_asked,
    live_asked,
    positive,
    side_asked,
    what_moves,
)
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Balanced, Statics
from concio.analysis.motion.stepper import at_rest
from concio.arguments import strict
from concio.contact.applied import free_group, pushed
from concio.contact.assembly import assemble
from concio.contact.moving.points import Followed
from concio.contact.moving.reference import Reference
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.solution import Progress, ProgressCallback
from concio.units import GRAVITY
from concio.verdict.not_standing import not_standing

Array = np.ndarray

STEP = 1 / 20
"""Step over the median width of the bodies where none is given."""

FIRST = 1e-3
"""First step over the others: rigid structures reach their peak at once."""

GROWTH = 3.0
"""Factor by which steps grow after an equilibrium was found at the first attempt."""

SMALLEST = 1e-6
"""Step over that asked for below which no equilibrium can be followed."""

LOAD_STEP = 0.05
"""Step of the multiplier under load control where none is given."""

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


@strict
@entry_point
def push(
    model: Model,
    *,
    control: ControlPoint | Literal["load"] | None = None,
    live: str | Sequence[str] | None = None,
    direction: float | Sequence[float] | None = None,
    step: float | None = None,
    until: float | None = None,
    smallest: float = 0.0,
    factors: Mapping[str, float] | None = None,
    points: Sequence[ControlPoint] = (),
    gravity: float = GRAVITY,
    brittle: bool = True,
    engine: Engine | None = None,
    progress: ProgressCallback | None = None,
) -> PushResult:
    """Push a structure over: statics at large displacements, past the peak, until its strength is lost.

    Contacts are looked for where the bodies stand, loads act where they are, and every point of the curve is checked
    against the equations of the displaced structure.

    Parameters
    ----------
    model : Model
        Plane; elastic, rigid and fixed bodies, with every joint law, support, tie and load.
    control : ControlPoint or "load", optional
        What grows: the displacement of a point, the load, or by default the mean displacement on which the load works
        (for a share of the weights, the mean displacement of the masses).
    live : str or sequence of str, optional
        Load groups that the multiplier scales. By default the group "live", and where a model has none a share of all
        weights along ``direction``: self-weights and loads from above, as in :func:`concio.assess`.
    direction : float or (x, y), optional
        Direction of that share, by default along x; 1 or -1 is along x. Of load groups that are multiplied, the side to
        which they push: where their resultant points to the other side they grow with the opposite sign.
    step : float, optional
        Largest step of the controlled displacement [m], default a twentieth of the bodies' width; under load control
        of the multiplier, default 0.05.
    until : float, optional
        Controlled displacement [m], or multiplier, at which to stop.
    smallest : float
        Multiplier at which the strength counts as lost.
    factors : mapping of str to float, optional
        Factors of load groups; groups not named have 1.
    points : sequence of ControlPoint
        Points to follow besides.
    gravity : float
        Turns weights into masses, of which only ratios matter here [m/s2].
    brittle : bool
        Whether joints lose cohesion and tensile strength for good once either was used up.
    engine : {"superlu", "pardiso"}, optional
        What factorises linear systems; by default that of the model.
    progress : callable, optional
        Called at every point; true stops, and what was computed is kept. So does Ctrl-C.

    Returns
    -------
    PushResult

    Raises
    ------
    InputError
        The model or an argument cannot be used.
    NoEquilibriumError
        The structure does not stand at multiplier zero.

    Examples
    --------
    A block, 0.5 m wide and 2 m high, begins to turn over at 0.25 of its weight. It falls once its centroid has
    moved by half its width:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> pushed = concio.push(pillar)
    >>> round(float(pushed.peak), 4), round(float(pushed.capacity), 4)
    (0.25, 0.25)
    """
    reference = Reference.of(model, gravity)
    chosen = factors_asked(reference, factors)
    groups = stated = live_asked(reference, live)
    along = direction_asked(1.0 if direction is None else direction)
    sign = side_asked(reference, groups, chosen, None if direction is None else along)
    if not stated:
        groups = (free_group(model),)
        reference = Reference.of(pushed(model, along.tolist(), groups[0], chosen), gravity)
    point, by_load = control_asked(control)
    scheme = Scheme(brittle=brittle)
    statics = Statics(reference, scheme, chosen, groups, point, engine, sign=sign)
    if by_load:
        step = LOAD_STEP if step is None else positive(step, "step")
    else:
        step = STEP * statics.width if step is None else positive(step, "step")
    until = np.inf if until is None else positive(until, "until")
    unit = statics.unit(reference.at_rest().placement.turns)
    if not unit.any():
        msg = "what is to be multiplied has no force: there is nothing to push with"
        raise InputError(msg, hint="give materials a unit_weight, or name the groups to multiply (live)")
    Followed.of(reference, *points)  # what cannot be followed is said before anything moves
    clock_begun = clock.perf_counter()
    start, share, _ = begun(statics, at_rest(reference))
    if not start.found:
        msg = "the structure does not stand before it is pushed" + what_moves(reference, start)
        if 0.0 < share < 1.0:
            msg += f", where its supports have moved by {share:.3g} of what was asked for"
        hint = "see 'concio run' for its collapse; the factors of dead loads may be meant otherwise"
        asked = "a capacity curve at large displacements"
        told = not_standing(assemble(model), asked, msg, factors=chosen, multiplied=stated)
        raise NoEquilibriumError(msg, hint=hint, verdict=told)
    run = _Push(reference, statics, chosen, step, until, float(smallest), progress)
    run.keep(start, 0.0)
    with Interruption() as run.interruption:
        ending = run.by_load() if by_load else run.by_displacement()
    return PushResult(
        model=model, gravity=gravity, ending=ending, displacement=np.array(run.displacement),
        multiplier=np.array(run.multiplier), residual=np.array(run.residual),
        centre=np.array([s.centre for s in run.states]), rotation=np.array([s.rotation for s in run.states]),
        strain=np.array([s.strain for s in run.states]), reaction=np.array(run.reactions),
        reactions_of=run.observer.names, events=tuple(run.events), live=stated, direction=along,
        force=unit[statics.frames.places].sum(axis=0), factors=chosen, control=point, points=tuple(points),
        notes=tuple(run.notes), seconds=clock.perf_counter() - clock_begun,
        lent_compliance=statics.maker.joints.lent if len(reference.rigid) else 0.0, end=run.states[-1],
        until=until if np.isfinite(until) else None, by_load=by_load, reversed=sign < 0,
    )  # fmt: skip


@dataclass
class _Push:
    """A curve as it is computed."""

    reference: Reference
    statics: Statics
    factors: dict[str, float]
    step: float
    until: float
    smallest: float
    progress: ProgressCallback | None
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
        """Keep a point."""
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
        self.reactions.append(self.observer.reactions(found.force, found.pairs, rows.normal))

    def told(self, share: float) -> bool:
        """Tell how far it is; return whether to stop."""
        if self.progress is None:
            return self.interruption.wanted
        message = f"multiplier {self.multiplier[-1]:.4g} at {self.displacement[-1]:.4g} m"
        return bool(self.progress(Progress("push", len(self.states), 1.0 - share, message))) or self.interruption.wanted

    def by_displacement(self) -> PushEnding:
        """Let the controlled displacement grow."""
        step, creeping, failed = FIRST * self.step, 0, 0
        while len(self.states) < MOST_POINTS:
            here, d, load = self.states[-1], self.displacement[-1], self.multiplier[-1]
            if d >= self.until * (1 - 1e-12):
                return PushEnding.REACHED
            wanted = min(step, self.until - d)
            found = self.statics.balance(here, load, target=wanted)
            if not found.found:
                step, failed = 0.5 * step, failed + 1
                if step < SMALLEST * self.step or failed > MOST_FAILED:
                    return PushEnding.NO_EQUILIBRIUM
                continue
            failed = 0 if wanted >= self.step else failed
            if found.multiplier > LOCKED:
                return PushEnding.LOCKED
            gave = ties_give_way(here, found.state)
            if found.multiplier <= self.smallest < load and not gave:
                return self._last(here, d, load, found, wanted)
            pairs = self._meeting(here, found.state)
            if gave or pairs:
                found, wanted = self._where_it_changes(here, load, found, wanted, pairs)
                gave = ties_give_way(here, found.state)
            self.keep(found, d + wanted)
            self._sharpen(located=gave)
            if self.told(min(d / self.until, 1 - max(found.multiplier, 0.0) / max(self.multiplier[1:]))):
                return PushEnding.STOPPED
            creeping = creeping + 1 if wanted < CREEPING * min(self.step, self.until - d) else 0
            if creeping > MOST_CREEPING:
                return PushEnding.NO_EQUILIBRIUM
            step = FIRST * self.step if gave else min(GROWTH * step, self.step)
        self.notes.append(f"{MOST_POINTS:,} points were computed")
        return PushEnding.STOPPED

    def _tie_ends(self, state: MotionState) -> Array:
        """Return where the first ends of the ties are (k, 2) [m]."""
        return self.statics.maker.ties.a.positions(state.placement, state.strain)

    def _meeting(self, before: MotionState, after: MotionState) -> set[frozenset[int]]:
        """Return the pairs of bodies that begin or cease to touch between two equilibria; each is located once."""
        pairs = meetings(self.reference, before, after) - self.met
        self.met |= pairs
        return pairs

    def _changes(self, before: MotionState, after: MotionState, pairs: set[frozenset[int]]) -> bool:
        """Return whether a tie gives way between two equilibria, or one of some pairs begins or ceases to touch."""
        old, new = touching(self.reference, before), touching(self.reference, after)
        return ties_give_way(before, after) or any((pair in old) != (pair in new) for pair in pairs)

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
            fine = trial.found and not ties_give_way(start, trial.state)
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
        rows = self.observer.rows(found.state)
        reaction = self.observer.reactions(found.force, found.pairs, rows.normal)
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
            if pairs or ties_give_way(here, found.state):
                found = self._load_where_it_changes(here, load, found, pairs)
            moved += self.statics.work_displacement(here, found)
            self.keep(found, moved)
            if found.multiplier > LOCKED:
                return PushEnding.LOCKED
            if self.told(min(load / self.until, 1.0)):
                return PushEnding.STOPPED
        self.notes.append(f"{MOST_POINTS:,} points were computed")
        return PushEnding.STOPPED
