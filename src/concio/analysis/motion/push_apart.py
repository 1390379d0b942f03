"""A push of structures that stand apart: one leads, the others follow its multiplier.

They share nothing but the multiplier. The one that holds the point of control leads, and without a point that with the
least peak: the curve, its displacement and its steps are those that it has alone. The others stand at its multipliers,
up and down. Structures that come near each other as they move are pushed as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.joint_events import JointEvent
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.push_asked import positive, what_moves
from concio.analysis.motion.push_curve import PushCurve
from concio.analysis.motion.push_result import PushEnding
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.start_on_moved_supports import begun
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Balanced, Statics
from concio.analysis.motion.structures import Structure, near_now, structures_of, together
from concio.contact.reference import Reference
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.solution import ProgressCallback

Array = np.ndarray

STEP = 1 / 20
"""Step over the median width of the bodies where none is given."""

LOAD_STEP = 0.05
"""Step of the multiplier under load control where none is given."""

PARTS = 4096
"""Parts at most in which a structure follows a step of the one that leads, and to which the end is found."""


class NoStartError(Exception):
    """No equilibrium of a structure was found before it is pushed.

    Parameters
    ----------
    message : str
    moving : tuple of str
        Bodies that move away.
    away : bool
        Whether they were followed for half the width of a body.
    share : float
        Part of the motion of supports at which an equilibrium was found last.
    """

    def __init__(self, message: str, moving: tuple[str, ...], *, away: bool, share: float) -> None:
        super().__init__(message)
        self.moving, self.away, self.share = moving, away, share


@dataclass(frozen=True, eq=False)
class PushAsked:
    """What is asked of a push.

    Parameters
    ----------
    reference : Reference
        With the load that grows.
    scheme : Scheme
    factors : mapping of str to float
    groups : tuple of str
        That the multiplier scales.
    control : ControlPoint or None
    by_load : bool
    step, given : float or None
        Largest step and where to end, as given.
    smallest, sign : float
    engine : {"superlu", "pardiso"} or None
    progress : callable or None
    """

    reference: Reference
    scheme: Scheme
    factors: dict[str, float]
    groups: tuple[str, ...]
    control: ControlPoint | None
    by_load: bool
    step: float | None
    given: float | None
    smallest: float
    sign: float
    engine: Engine | None
    progress: ProgressCallback | None

    def __post_init__(self) -> None:
        for value, name in ((self.step, "step"), (self.given, "until")):
            if value is not None:
                positive(value, name)

    @property
    def until(self) -> float:
        """Controlled displacement [m], or multiplier, at which to stop."""
        return np.inf if self.given is None else float(self.given)

    def holds(self, reference: Reference) -> bool:
        """Return whether a reference has the point of control."""
        return self.control is not None and self.control.body in {b.name for b in reference.model.bodies}

    def statics(self, reference: Reference) -> Statics:
        """Return what finds equilibria of a structure."""
        control = self.control if self.holds(reference) else None
        return Statics(reference, self.scheme, self.factors, self.groups, control, self.engine, sign=self.sign)

    def curve(self, reference: Reference, statics: Statics) -> PushCurve:
        """Return a curve of a structure without points."""
        step = (LOAD_STEP if self.by_load else STEP * statics.width) if self.step is None else float(self.step)
        return PushCurve(reference, statics, self.factors, step, self.until, self.smallest, self.progress)


@dataclass
class Followed:
    """The points of a push, of all structures together.

    Parameters
    ----------
    ending : PushEnding
    displacement, multiplier, residual : lists of float
    states : list of MotionState
    reactions : list of (r, d) arrays
    reactions_of : tuple of str
    events : list of JointEvent
    notes : list of str
    lent : float
        Compliance added to hard joints of rigid bodies [m/kN].
    structures : tuple of tuples of int
        Bodies of each structure.
    """

    ending: PushEnding
    displacement: list[float]
    multiplier: list[float]
    residual: list[float]
    states: list[MotionState]
    reactions: list[Array]
    reactions_of: tuple[str, ...]
    events: list[JointEvent]
    notes: list[str]
    lent: float
    structures: tuple[tuple[int, ...], ...] = field(default=())


@dataclass
class _One:
    """A structure, and its equilibrium before it is pushed."""

    structure: Structure
    statics: Statics
    start: Balanced
    pushed: bool


def followed(asked: PushAsked, interruption: Interruption) -> Followed:
    """Push structures over.

    Parameters
    ----------
    asked : PushAsked
    interruption : Interruption

    Raises
    ------
    NoStartError
    """
    reference = asked.reference
    structures = structures_of(reference)
    if asked.control is not None and not any(asked.holds(one.reference) for one in structures if _free(asked, one)):
        structures = [Structure.of(reference, np.arange(len(reference.model.bodies)))]
    while True:
        found = _apart(asked, structures, interruption)
        apart = structures
        for state in found.states if len(structures) > 1 else ():
            apart = near_now(apart, state)
        if len(apart) == len(structures):
            return found
        structures = apart


def _free(asked: PushAsked, one: Structure) -> bool:
    """Return whether the point of control is on a body of a structure that moves."""
    model = one.reference.model
    return asked.control is not None and any(b.name == asked.control.body for b in model.free_bodies)


def _apart(asked: PushAsked, structures: Sequence[Structure], interruption: Interruption) -> Followed:
    """Push structures, the first that carries least leading."""
    ones = [_begun(asked, one) for one in structures]
    pushed = [one for one in ones if one.pushed]
    holding = [one for one in ones if asked.holds(one.structure.reference)]
    best: tuple[_One, PushCurve, PushEnding] | None = None
    for one in holding or pushed:
        run = asked.curve(one.structure.reference, one.statics)
        run.interruption = interruption
        run.beyond = np.inf if best is None else max(best[1].multiplier)
        run.keep(one.start, 0.0)
        ending = run.by_load() if asked.by_load else run.by_displacement()
        if best is None or (max(run.multiplier) < run.beyond and not interruption.wanted):
            best = one, run, ending
    assert best is not None
    leader, curve, ending = best
    others = [one for one in ones if one is not leader]
    runs = {id(one): _following(asked, one, curve.multiplier) for one in others}
    count = min([len(run.multiplier) for run in runs.values()], default=len(curve.multiplier))
    if count < len(curve.multiplier):
        ending = PushEnding.NO_LARGER_LOAD if asked.by_load else PushEnding.NO_EQUILIBRIUM
        short = [one for one in others if len(runs[id(one)].multiplier) == count]
        least = min((_reached(one, runs[id(one)], curve.multiplier[count]) for one in short),
                    key=lambda load: abs(load - curve.multiplier[count - 1]))  # fmt: skip
        count = _cut(leader, curve, count, least)
        runs = {id(one): _following(asked, one, curve.multiplier[:count]) for one in others}
        count = min(len(run.multiplier) for run in runs.values())
    return _merged(asked, ones, [runs.get(id(one), curve) for one in ones], leader, ending, count)


def _cut(leader: _One, curve: PushCurve, count: int, load: float) -> int:
    """Let a curve end at a multiplier after its first points; return how many points it has."""
    state, statics = curve.states[count - 1], leader.statics
    found = statics.balance(state, load)
    moved = statics.work_displacement(state, found)
    if statics.control is not None:
        moved = statics.controlled_at(found.state) - statics.controlled_at(state)
    displacement = curve.displacement[count - 1] + moved
    for values in (curve.displacement, curve.multiplier, curve.residual, curve.states, curve.reactions):
        del values[count:]
    curve.events = [event for event in curve.events if event.step < count]
    if found.found:
        curve.keep(found, displacement)
    return len(curve.multiplier)


def _begun(asked: PushAsked, structure: Structure) -> _One:
    """Return a structure in equilibrium before it is pushed."""
    reference = structure.reference
    statics = asked.statics(reference)
    start, share, _ = begun(statics, MotionState.at_rest(reference))
    if not start.found:
        words, moving = what_moves(reference, start)
        msg = f"the structure does not stand before it is pushed{words}"
        if 0.0 < share < 1.0:
            msg += f", where its supports have moved by {share:.3g} of what was asked for"
        away = float(abs(start.moved).max(initial=0.0)) > statics.far
        raise NoStartError(msg, moving, away=away, share=share)
    unit = statics.unit(reference.at_rest().placement.turns)
    return _One(structure, statics, start, bool(unit.any()))


def _following(asked: PushAsked, one: _One, multipliers: Sequence[float]) -> PushCurve:
    """Return the equilibria of a structure at the multipliers of another one's curve, as far as there are any."""
    run = asked.curve(one.structure.reference, one.statics)
    run.keep(one.start, 0.0)
    for wanted in multipliers[1:]:
        found = _at(one, run, wanted)[0] if one.pushed else replace(one.start, multiplier=wanted)
        if found is None:
            break
        run.keep(found, 0.0)
    return run


def _reached(one: _One, run: PushCurve, wanted: float) -> float:
    """Return how far towards a multiplier a structure follows from its last point."""
    return _at(one, run, wanted)[1]


def _at(one: _One, run: PushCurve, wanted: float) -> tuple[Balanced | None, float]:
    """Return the equilibrium at a multiplier, in parts where it needs them, or None; and how far it got."""
    state, load, share = run.states[-1], run.multiplier[-1], 1.0
    begin, way = load, wanted - load
    while True:
        there = wanted if not way or (load - begin) / way + share >= 1.0 else load + share * way
        found = one.statics.balance(state, there)
        if found.found and there == wanted:
            return found, wanted
        if found.found:
            state, load = found.state, there
        elif share * PARTS <= 1.0:
            return None, load
        else:
            share *= 0.5


def _merged(
    asked: PushAsked, ones: Sequence[_One], runs: Sequence[PushCurve], leader: _One, ending: PushEnding, count: int
) -> Followed:
    """Return the points of all structures together."""
    structures, reference = [one.structure for one in ones], asked.reference
    curve = runs[ones.index(leader)]
    lent = max(
        (one.statics.maker.joints.lent for one in ones if len(one.structure.reference.rigid)), default=0.0
    )  # fmt: skip
    groups = tuple(tuple(one.bodies.tolist()) for one in structures)
    if len(ones) == 1 and structures[0].alone:
        return Followed(
            ending, curve.displacement, curve.multiplier, curve.residual, curve.states, curve.reactions,
            curve.observer.names, curve.events, curve.notes, lent, groups,
        )  # fmt: skip
    whole = asked.statics(reference)
    observer = Observer(reference, whole.maker, whole.frames, asked.factors)
    rows = [observer.rows_of(run.observer, one) for run, one in zip(runs, structures, strict=True)]
    rest, states, reactions = MotionState.at_rest(reference), [], []
    for k in range(count):
        states.append(together(structures, [run.states[k] for run in runs], rest))
        total = np.zeros((len(observer.names), reference.model.dim))
        for run, own in zip(runs, rows, strict=True):
            np.add.at(total, own, run.reactions[k])
        reactions.append(total)
    why = "holds the point of control" if asked.holds(leader.structure.reference) else "has the least peak"
    note = (
        f"{len(ones)} structures stand apart: the displacement is that of the one around '{leader.structure.name}', "
        f"which {why}; the others follow its multiplier"
    )
    events = sorted((e for run in runs for e in run.events if e.step < count), key=lambda e: e.step)
    return Followed(
        ending, curve.displacement[:count], curve.multiplier[:count],
        [max(run.residual[k] for run in runs) for k in range(count)], states, reactions, observer.names, events,
        [*curve.notes, note], lent, groups,
    )  # fmt: skip
