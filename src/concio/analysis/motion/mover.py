"""One structure as it moves: its steps, smaller where that is needed, ended where bodies meet or ties give way."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.fate import Watch
from concio.analysis.motion.located import ties_give_way
from concio.analysis.motion.meetings import Meetings
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.pace import Pace
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.stepper import Stepper, StepReport
from concio.analysis.motion.structures import Structure
from concio.analysis.motion.tie_cuts import where_ties_give_way
from concio.problem.contact_problem import Engine
from concio.problem.tolerances import CERTIFIED

Array = np.ndarray

HALVINGS = 6
"""Times a step may be halved."""

SUNK = 1e-3
"""Penetration at an impact over the width of a body from which on the step is halved."""

LEAST_CUT = 1e-6
"""Step over that asked for below which it is not cut where a tie gives way."""

SAME = 1e-9
"""Share of a step by which times differ that are one."""


@dataclass(frozen=True, eq=False)
class Row:
    """What a step did, or the steps of all structures to the same time.

    Parameters
    ----------
    residual, depth : float
        Worst of all; depth in m.
    how : str
        What solved the worst.
    factorisations : int
    works : mapping of str to float
        Sums [kN m].
    reactions : (r, d) array
        At the end [kN].
    """

    residual: float
    how: str
    factorisations: int
    depth: float
    works: Mapping[str, float]
    reactions: Array

    def after(self, other: Row) -> Row:
        """Return this row and one before it as one."""
        worst = max(self, other, key=lambda row: row.residual)
        works = {name: value + other.works[name] for name, value in self.works.items()}
        count = self.factorisations + other.factorisations
        return Row(worst.residual, worst.how, count, max(self.depth, other.depth), works, self.reactions)


class Mover:
    """A structure that moves.

    Parameters
    ----------
    structure : Structure
    scheme : Scheme
    factors : mapping of str to float
    step : float
        Largest step [s].
    drive : callable
        What is imposed in a step, of the time when it begins and its length.
    adaptive : bool
        Whether steps are made smaller or cut.
    engine : {"superlu", "pardiso"}, optional
    """

    def __init__(
        self, structure: Structure, scheme: Scheme, factors: Mapping[str, float], step: float,
        drive: Callable[[float, float], Drive], adaptive: bool, engine: Engine | None,
    ) -> None:  # fmt: skip
        self.structure, self.step, self.drive, self.adaptive = structure, step, drive, adaptive
        reference = structure.reference
        self.scheme, self.factors, self.engine = scheme, factors, engine
        self.stepper = Stepper(reference, scheme, engine)
        self.observer = Observer(reference, self.stepper.maker, self.stepper.frames, factors)
        self.meetings = Meetings.of(len(reference.model.bodies), step / 2**HALVINGS)
        self.pace, self.outran = Pace(reference, self.stepper.maker.search.skin), ""
        self.h, self.calm = step, 0

    @property
    def lent(self) -> float:
        """Compliance added to hard joints of rigid bodies [m/kN]."""
        return self.stepper.maker.joints.lent if len(self.structure.reference.rigid) else 0.0

    def begin(self, state: MotionState, origin: Array) -> None:
        """Begin at a state; ``origin`` (B, d): where the centroids stood [m]."""
        self.state = self.stepper.located(state)
        self.watch = Watch(self.observer, self.factors, self.scheme, origin, self.engine)

    def once(self, to: float) -> Row | None:
        """Make a step that ends at a time at the latest; None where none can be solved."""
        left = to - self.state.time
        clipped = left < self.h - SAME * self.step
        h = left if clipped else self.h
        made = self._attempt(self.state, h)
        if made is None:
            return None
        self.state, report, used = made
        if used:
            whole = used >= h
            self.calm = self.calm + 1 if whole else 0
            reached = self.h if clipped and whole else used
            self.h = min(self.step, 2 * reached if self.calm >= 2 else reached)
        found = report.solution
        reactions = self.observer.reactions(found.t, report.pairs, report.frame)
        return Row(found.residual, found.how, found.factorisations, report.depth, report.works, reactions)

    def advance(self, to: float) -> Row | None:
        """Make steps to a time; None where one cannot be solved."""
        row = self.once(to)
        while row is not None and to - self.state.time > LEAST_CUT * self.step:
            more = self.once(to)
            row = more if more is None else more.after(row)
        return row

    def _attempt(self, state: MotionState, h: float) -> tuple[MotionState, StepReport, float] | None:
        """Make a step that ends where a tie gives way, if one does; see :meth:`_made`."""
        made = self._made(state, h)
        if made is None or not self.adaptive or not ties_give_way(state, made[0]):
            return made
        whole, ties = made[0].time - state.time, self.stepper.maker.ties

        def at(length: float) -> tuple[MotionState, StepReport]:
            return self.stepper.step(state, length, self.drive(state.time, length))

        cut = where_ties_give_way(ties, state, made[0], at, whole, LEAST_CUT * self.step)
        if cut is None or cut[1].solution.residual > CERTIFIED:
            return made
        self.meetings.until = max(self.meetings.until, state.time + whole)
        return *cut, 0.0

    def _made(self, state: MotionState, h: float) -> tuple[MotionState, StepReport, float] | None:
        """Make a step, smaller where that is needed; None where none can be solved.

        The third is its length, none where it ended or began with an impact that was located.
        """
        least = self.step / 2**HALVINGS
        meetings = self.meetings
        asked, h = h, meetings.length(state.time, h)
        h = self._paced(state, h, least)
        if self.outran:
            return None
        planned = h != asked
        while True:
            new, report = self.stepper.step(state, h, self.drive(state.time, h))
            solved = report.solution.residual <= CERTIFIED
            late = self.adaptive and report.struck > SUNK * self.stepper.maker.width
            if solved and self.adaptive:
                cut = meetings.located(report.meets, report.part, h)
                if cut is not None:
                    to_it = self.stepper.step(state, cut, self.drive(state.time, cut))
                    if to_it[1].solution.residual <= CERTIFIED:
                        meetings.after(state.time, True, to_it[1].left, h)
                        return *to_it, 0.0
            if (solved and not late) or (solved and h <= least * 1.01):
                meetings.after(state.time, False, np.inf, h)
                return new, report, 0.0 if planned else h
            if not solved and (h <= least * 1.01 or not self.adaptive):
                return None
            h *= 0.5

    def _paced(self, state: MotionState, h: float, least: float) -> float:
        """Return the length of a step up to h, but not below the least, in which no body passes another one unseen."""
        longest = self.pace.longest(state, h)
        self.outran = self.pace.outrun(state, h, least) if longest < h else ""
        while h > longest and h > least * 1.01:
            h *= 0.5
        return h


def shifted(state: MotionState, time: float) -> MotionState:
    """Return the places at a time a little before or after a state, as its velocities have it."""
    late = state.time - time
    if not late:
        return state
    there = state.placement.moved(-late * state.velocity, -late * state.spin)
    return replace(state, time=time, centre=there.centre, rotation=there.rotation)
