"""Exact paths of structures in several connected parts: each part is followed alone, and the polygons are put together.

Parts that touch only through fixed bodies share nothing but the load parameter. Each is followed as if it stood alone,
in units of its own, so that nothing that stands elsewhere changes a digit of it. Between its corners a part is linear
in the load parameter; the path of the whole has the corners of all parts, and ends where the first part ends.

Under displacement control the part that holds the control point leads. The others follow its load parameter up and
down.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.problem.parts import Part, parts_of
from concio.problem.solution import ProgressCallback
from concio.solvers.path.event_path import follow
from concio.solvers.path.path_state import LinearPath, PathState, energy_of_step
from concio.solvers.path.record import Event, EventPath, Outcome

FINITE = ("jumps", "restarts")
"""Events between whose states a part is not linear."""

SAME = 1e-12
"""Clocks that differ by less, relative, are one."""

Stop = Callable[[PathState], bool]


def follow_parts(
    path: LinearPath,
    start: PathState,
    *,
    until: float,
    control: Array | None = None,
    max_events: int = 20_000,
    progress: ProgressCallback | None = None,
    stop: Stop | None = None,
    looked: bool = False,
) -> EventPath:
    """Follow a path from a state in equilibrium, each connected part by itself.

    Parameters
    ----------
    path, start, until, control, max_events, progress, stop, looked
        See :func:`concio.solvers.path.event_path.follow`; ``max_events`` is that of each part. A control that belongs
        to several parts makes them one.
    """
    parts = [part for part in parts_of(path.problem) if part.unknowns.size]
    leader = _leader(parts, control)
    alone = len(parts) == 1 and parts[0].pairs.size == path.problem.pairs
    if alone or (control is not None and leader is None):
        return follow(
            path, start, until=until, control=control, max_events=max_events, progress=progress, stop=stop,
            looked=looked,
        )  # fmt: skip

    def walk(part: Part, begin: PathState, end: float, by: Array | None) -> EventPath:
        asked = None if stop is None else _asked(stop, start, part)
        return follow(
            path_of(path, part), begin, until=end, control=by, max_events=max_events, progress=progress, stop=asked,
            looked=looked,
        )  # fmt: skip

    tracks = []
    if leader is not None and control is not None:
        first = parts[leader]
        tracks.append(_Track.leading(first, walk(first, state_of_part(start, first), until, control[first.unknowns])))
    turns = [start.parameter, until] if not tracks else _turns(tracks[0])
    for k, part in enumerate(parts):
        if k != leader:
            tracks.append(_Track.following(part, state_of_part(start, part), turns, walk))
            if tracks[-1].outcome is Outcome.CANCELLED:
                break
    return _Merged(path, start, tracks, control).path()


def path_of(path: LinearPath, part: Part) -> LinearPath:
    """Return the path of one part."""
    total = path.total_rate
    return LinearPath(
        part.problem, path.load_rate[part.unknowns], path.gap_rate[part.pairs], path.tangent_rate[part.pairs],
        total[part.unknowns] if isinstance(total, np.ndarray) else total,
    )  # fmt: skip


def state_of_part(state: PathState, part: Part) -> PathState:
    """Return a state of one part, whose work and dissipation begin at zero."""
    own, p = part.unknowns, part.pairs
    return PathState(
        state.parameter, state.displacement[own], state.normal_force[p], state.friction_force[p], state.states[p],
        state.slip[p], state.offset[p], broken=None if state.broken is None else state.broken[p],
    )  # fmt: skip


def part_that_moves(path: LinearPath, direction: Array) -> Array:
    """Return the unknowns (N,) of the parts of which a direction (N,) moves anything."""
    found = np.zeros(path.problem.unknowns, dtype=bool)
    for part in parts_of(path.problem):
        if len(direction) and direction[part.unknowns].any():
            found[part.unknowns] = True
    return found


def put_together(whole: PathState, parts: Sequence[Part], states: Sequence[PathState]) -> PathState:
    """Return a state of the whole, as it was but for what states of its parts say, work and dissipation added up."""
    names = ("normal_force", "friction_force", "slip", "offset")
    found = {name: getattr(whole, name).copy() for name in ("displacement", *names)}
    normal, direction = whole.states.normal.copy(), whole.states.direction.copy()
    for part, state in zip(parts, states, strict=True):
        found["displacement"][part.unknowns] = state.displacement
        for name in names:
            found[name][part.pairs] = getattr(state, name)
        normal[part.pairs], direction[part.pairs] = state.states.normal, state.states.direction
    work = whole.work + sum(state.work for state in states)
    dissipation = whole.dissipation + sum(state.dissipation for state in states)
    return replace(whole, states=PairStates(normal, direction), work=work, dissipation=dissipation, **found)


def _asked(stop: Stop, start: PathState, part: Part) -> Stop:
    """Return the question when to stop, of states of one part; the others stand as at the start."""
    return lambda state: stop(replace(put_together(start, [part], [state]), parameter=state.parameter))


def _leader(parts: Sequence[Part], control: Array | None) -> int | None:
    """Return the only part that a control belongs to; None without one, and where it is of several or of none."""
    if control is None:
        return None
    own = [k for k, part in enumerate(parts) if control[part.unknowns].any()]
    return own[0] if len(own) == 1 else None


def _turns(leading: _Track) -> list[float]:
    """Return the load parameters at which a leading part begins, turns and ends."""
    found = [leading.states[0].parameter]
    for state in leading.states[1:]:
        if len(found) > 1 and (state.parameter - found[-1]) * (found[-1] - found[-2]) >= 0:
            found[-1] = state.parameter
        elif state.parameter != found[-1]:
            found.append(state.parameter)
    return found


@dataclass
class _Track:
    """One part followed alone.

    Parameters
    ----------
    part : Part
    states : list of PathState
    clock : list of float
        Way that the load parameter has gone, up or down, at each state.
    finite : set of int
        States reached by a finite step.
    events : list of Event
        With pairs of the part.
    outcome : Outcome
    direction : (n,) array
    factorisations : int
    """

    part: Part
    states: list[PathState]
    clock: list[float]
    finite: set[int] = field(default_factory=set)
    events: list[Event] = field(default_factory=list)
    outcome: Outcome = Outcome.REACHED
    direction: Array = field(default_factory=lambda: np.zeros(0))
    factorisations: int = 0

    @classmethod
    def leading(cls, part: Part, found: EventPath) -> _Track:
        """Return the track of the part that holds the control point."""
        track = cls(part, [found.states[0]], [0.0])
        track.add(found)
        return track

    @classmethod
    def following(
        cls, part: Part, begin: PathState, turns: Sequence[float],
        walk: Callable[[Part, PathState, float, Array | None], EventPath],
    ) -> _Track:  # fmt: skip
        """Return the track of a part under a load parameter that goes from turn to turn."""
        track = cls(part, [begin], [0.0])
        for here, there in pairwise(turns):
            done, way = track.clock[-1], abs(there - here)
            found = walk(part, replace(track.states[-1], parameter=here), there, None)
            track.add(found)
            if found.outcome is not Outcome.REACHED or abs(found.end.parameter - there) > SAME * max(way, abs(there)):
                break
            track.clock[-1] = done + way
        return track

    def add(self, found: EventPath) -> None:
        """Go on with what was followed from the last state."""
        begun = len(self.states) - 1
        for before, after in pairwise(found.states):
            self.states.append(after)
            self.clock.append(self.clock[-1] + abs(after.parameter - before.parameter))
        moved = [replace(e, step=e.step + begun) for e in found.events]
        self.events += moved
        self.finite |= {e.step for e in moved if e.kind in FINITE}
        self.outcome, self.direction = found.outcome, found.direction
        self.factorisations += found.factorisations

    def state_at(self, path: LinearPath, clock: float, at: int) -> PathState:
        """Return the state at a clock between the states ``at`` and the next one, by exact interpolation."""
        before = self.states[at]
        if at + 1 == len(self.states) or clock == self.clock[at]:
            return before
        after, way = self.states[at + 1], self.clock[at + 1] - self.clock[at]
        share = (clock - self.clock[at]) / way if way > 0 else 0.0
        return between(path, before, after, share)


def between(path: LinearPath, before: PathState, after: PathState, share: float) -> PathState:
    """Return the state at a share of the straight line between two corners of an exact path."""
    mixed = {
        name: (1 - share) * getattr(before, name) + share * getattr(after, name)
        for name in ("parameter", "displacement", "normal_force", "friction_force", "slip", "offset")
    }
    state = replace(after, **mixed)
    work, dissipation = energy_of_step(path, before, state)
    return replace(state, work=before.work + work, dissipation=before.dissipation + dissipation)


class _Merged:
    """The path of the whole, of tracks of its parts."""

    def __init__(
        self, path: LinearPath, start: PathState, tracks: Sequence[_Track], control: Array | None
    ) -> None:
        self.whole, self.start, self.tracks, self.control = path, start, tracks, control
        self.paths = [path_of(path, track.part) for track in tracks]
        self.end = min(track.clock[-1] for track in tracks)

    def path(self) -> EventPath:
        """Return states, events and end of the whole."""
        states, at = [self.start], [0] * len(self.tracks)
        where: list[dict[int, int]] = [{0: 0} for _ in self.tracks]
        while (clock := self.following(at)) is not None:
            moved = []
            for k, track in enumerate(self.tracks):
                if at[k] + 1 < len(track.states) and track.clock[at[k] + 1] <= clock * (1 + SAME):
                    at[k] += 1
                    moved.append(k)
                    where[k][at[k]] = len(states)
            if self.between_finite(at, clock):
                continue
            states.append(self.state(clock, at, moved))
        events = self.events(where, states)
        worst = next((t for t in self.tracks if self.stops(t) and t.outcome is not Outcome.REACHED), None)
        outcome = Outcome.REACHED if worst is None else worst.outcome
        direction = self.direction(worst, states)
        return EventPath(tuple(states), events, outcome, direction, sum(t.factorisations for t in self.tracks))

    def following(self, at: Sequence[int]) -> float | None:
        """Return the next clock at which a part has a corner; None past the end of the first part."""
        ahead = [t.clock[i + 1] for t, i in zip(self.tracks, at, strict=True) if i + 1 < len(t.states)]
        clock = min(ahead, default=np.inf)
        return clock if clock <= self.end * (1 + SAME) else None

    def between_finite(self, at: Sequence[int], clock: float) -> bool:
        """Tell whether a part is within a finite step, where it has no state."""
        return any(
            i + 1 in t.finite and t.clock[i] < clock * (1 - SAME) for t, i in zip(self.tracks, at, strict=True)
        )

    def state(self, clock: float, at: Sequence[int], moved: Sequence[int]) -> PathState:
        """Return the state of the whole at a clock, whose parameter is that of the parts that have a corner there."""
        found = [
            track.states[i] if k in moved else track.state_at(own, clock, i)
            for k, (own, track, i) in enumerate(zip(self.paths, self.tracks, at, strict=True))
        ]
        whole = put_together(self.start, [t.part for t in self.tracks], found)
        return replace(whole, parameter=found[moved[0]].parameter)

    def events(self, where: Sequence[dict[int, int]], states: Sequence[PathState]) -> tuple[Event, ...]:
        """Return the events of all parts in the order of their steps."""
        found = []
        for track, known in zip(self.tracks, where, strict=True):
            steps = sorted(known)
            for event in track.events:
                if event.step > steps[-1]:
                    continue
                step = min(known[steps[bisect_right(steps, event.step) - 1]], len(states) - 1)
                moved = event.control if self.control is None else float(self.control @ states[step].displacement)
                found.append(replace(event, pair=int(track.part.pairs[event.pair]), step=step, control=moved))
        return tuple(sorted(found, key=lambda event: event.step))

    def stops(self, track: _Track) -> bool:
        """Tell whether a part ends where the whole does."""
        return track.clock[-1] <= self.end * (1 + SAME)

    def direction(self, worst: _Track | None, states: Sequence[PathState]) -> Array:
        """Return the last rate: the motion of the part that ends the path, or what moved last."""
        found = np.zeros(self.whole.problem.unknowns)
        if worst is not None:
            found[worst.part.unknowns] = worst.direction
            return found
        if len(states) > 1:
            found = states[-1].displacement - states[-2].displacement
        return found / (float(np.abs(found).max(initial=0.0)) or 1.0)
