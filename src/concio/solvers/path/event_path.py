r"""Load paths followed exactly, event by event.

Between two changes of contact state the response of elastic bodies with Coulomb joints is linear in the load
parameter. The path is therefore a polygon, and it is followed from corner to corner: solve the rate problem
(:mod:`concio.solvers.path.rates`), find the parameter at which the next pair opens, closes, slips, sticks or crushes,
go there, and begin again. Slip is measured from where a pair last stuck (rate form of friction), so that the path is
the limit of incremental analyses as their steps shrink.

Control is by the load parameter, which ends at the limit point, or by a functional of the displacements (the motion
of a control point), which passes it and follows the falling branch.

Where no rates continue the path it goes on from a certified state at a finite distance, if there is one, and the step
is named as what it is: a jump or a restart (:mod:`concio.solvers.path.restart`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from concio.errors import InputError
from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import LARGEST_VERTEX, MOST_RESTARTS
from concio.problem.solution import Progress, ProgressCallback
from concio.solvers.path.direction import find_direction
from concio.solvers.path.event_words import Moment, changes
from concio.solvers.path.near_forces import solve_near
from concio.solvers.path.path_point import PathPoint
from concio.solvers.path.path_state import (
    CLOSED,
    OPEN,
    STICK,
    LinearPath,
    PathState,
    certify_step,
    plastic_position,
    sizes,
    state_of,
    step_problem,
)
from concio.solvers.path.rates import (
    Rates,
    Values,
    admissible,
    grips,
    rates,
    restore,
    values,
    vertex_size,
    wrong,
)
from concio.solvers.path.ray import homogeneous, ray
from concio.solvers.path.record import Event, EventPath, Outcome
from concio.solvers.path.restart import SHARES, Beyond, load_unit, look_beyond, moves_freely

AT_REST = 1e-9
"""A structure displaced by less than this share of a typical, or of its last, displacement rests."""

CLOSE = 20.0
"""A restart within this many increments of the one before takes a ten times larger increment."""


def follow(
    path: LinearPath,
    start: PathState,
    *,
    until: float,
    control: Array | None = None,
    max_events: int = 20_000,
    progress: ProgressCallback | None = None,
    stop: Callable[[PathState], bool] | None = None,
    looked: bool = False,
) -> EventPath:
    """Follow a path from a state in equilibrium.

    Parameters
    ----------
    path : LinearPath
    start : PathState
        State at ``start.parameter``; at rest without forces where the path begins with the first load.
    until : float
        Load parameter to reach, or with ``control`` the value of ``control @ u`` to reach [m].
    control : (N,) array, optional
        Functional of the displacements that grows (or falls) steadily instead of the load.
    max_events : int
        Corners after which to stop.
    progress : callable, optional
    stop : callable, optional
        Asked at every corner; true ends the path there with outcome REACHED.
    looked : bool
        Whether a path under growing load was lost at ``start``: its search for a state beyond is not made again.
    """
    if path.problem.dim != 2:
        msg = "event-by-event paths are two-dimensional, the problem is in space"
        raise InputError(msg, hint="use load steps")
    return _Follower(path, start, until, control, looked=looked).run(max_events, progress, stop)


class _Follower(PathPoint):
    def __init__(
        self, path: LinearPath, start: PathState, until: float, control: Array | None, *, looked: bool
    ) -> None:
        super().__init__(path, start, until, control)
        self.looked_from = start if looked else None
        self.driven = False  # a pair's slip or opening stands in for the control
        self.restarts, self.restarted, self.share = 0, -np.inf, SHARES[0]
        self.fallen = np.inf

    def run(
        self, max_events: int, progress: ProgressCallback | None, stop: Callable[[PathState], bool] | None
    ) -> EventPath:
        states, events = [self.state], list[Event]()
        known: Rates | None = None
        direction: Array | None = None
        self.put_on_equations()
        for corner in range(max_events):
            self.settle()
            v = values(self.equations, self.x, self.slip, self.offset)
            old = Moment.of(self.equations)
            found, runaway = self.direction(v, known)
            if found is not None:
                named = self.name_events(old, len(states) - 1)
                rate = float(self.control @ found.direction) * self.sense
                left = (self.until - self.given()) * self.sense / rate if rate > found.still else np.inf
                length = self.distance(v, found)
                if not np.isfinite(min(left, length)):
                    return self.finish(states, events + named, Outcome.MECHANISM, found.direction)
                self.advance(found, min(left, length))
                after = self.record()
                if self.sound(states, after):
                    states.append(after)
                    events.extend(named)
                    known, direction = found, found.direction
                    if left <= length or (stop is not None and stop(after)):
                        return self.finish(states, events, Outcome.REACHED, direction)
                    told = f"parameter {self.x[-1]:.6g}, {len(events)} events"
                    note = Progress("event-path", corner, 0.0, told, share=np.nan if self.driven else self.share_gone())
                    if progress is not None and progress(note):
                        return self.finish(states, events, Outcome.CANCELLED, direction)
                    continue
                self.state = states[-1]  # rounding has carried it off: a finite step from the last certified state
            if self.restarts >= MOST_RESTARTS:
                return self.finish(states, events, Outcome.TOO_MANY, direction)
            motion = self.free_motion(runaway)
            beyond = self.beyond(progress, free=motion is not None)
            if beyond.cancelled:
                return self.finish(states, events, Outcome.CANCELLED, direction)
            if beyond.state is None:
                events.extend(self.last_events(v, direction, old, len(states) - 1))
                if motion is not None or beyond.no_equilibrium:
                    motion = beyond.motion if motion is None else motion
                    return self.finish(states, events, Outcome.LIMIT, motion)
                last = direction if runaway is None else runaway
                return self.finish(states, events, Outcome.LOST, last)
            if self.driven:
                self.equations.set_control(self.control)
                self.driven = False
            states.append(self.go_to(beyond.state))
            events.extend(self.name_step(old, beyond, states))
            known, direction = None, None
            if (self.until - self.given()) * self.sense <= 0:
                return self.finish(states, events, Outcome.REACHED, direction)
        return self.finish(states, events, Outcome.TOO_MANY, direction)

    def sound(self, states: list[PathState], after: PathState) -> bool:
        """Tell whether a corner is certified as a step from the one before.

        Where the structure has come back to rest, rounding is not measured against itself.
        """
        if certify_step(self.path, states[-1], after).certified:
            return True
        most = max(self.scaled.length, float(np.abs(states[-1].displacement).max()))
        return float(np.abs(after.displacement).max()) <= AT_REST * most

    def free_motion(self, runaway: Array | None) -> Array | None:
        """Return the rate (N,) that diverged, if the structure can move so at constant load; else None."""
        if runaway is None:
            return None
        v = runaway[: self.equations.n]
        return next((way * v for way in (1.0, -1.0) if moves_freely(self.path, self.state, way * v)), None)

    def beyond(self, progress: ProgressCallback | None, *, free: bool) -> Beyond:
        """Look for a certified state at a finite distance, by a growing load (or, asked to go down, a falling one)."""
        point, sense = self.state, self.sense if self.by_load else 1.0
        walked = abs(point.parameter - self.restarted) / load_unit(self.path, point)
        self.share = min(10 * self.share, SHARES[-1]) if walked <= CLOSE * self.share else SHARES[0]
        end = self.until if self.by_load else np.inf
        straight = self.straight(progress)
        if straight is not None:
            return Beyond(straight)
        quick = free or point is self.looked_from
        found = look_beyond(
            self.path, point, sense, end=end, quick=quick, least=self.share, fallen=self.fallen, progress=progress
        )
        if found.state is None:
            return found
        self.fallen = found.fallen
        if not self.by_load and (self.control @ self.unknowns(found.state) - self.given()) * self.sense <= 0:
            return Beyond(None)  # the control point would go back
        self.restarts, self.restarted = self.restarts + 1, found.state.parameter
        return found

    def straight(self, progress: ProgressCallback | None) -> PathState | None:
        """Return the end of the ray on which the path begins, where no rates were found at rest; else None."""
        rest = self.state
        if not self.by_load or self.until <= 0 or rest.parameter or rest.displacement.any() or rest.normal_force.any():
            return None
        if not homogeneous(self.path):
            return None
        end = ray(self.path, rest, until=min(self.until, 1.0), progress=progress)
        return end if end is not None and certify_step(self.path, rest, end).certified else None

    def name_step(self, old: Moment, beyond: Beyond, states: list[PathState]) -> list[Event]:
        """Name a finite step after the pair that moves most in it, and what changed in it."""
        (n0, t0), (n1, t1) = (plastic_position(self.path, s) for s in states[-2:])
        most = int(np.argmax(np.abs(n1 - n0) + sizes(t1 - t0)))
        parameter, given, step = float(self.x[-1]), self.given() * self.unit, len(states) - 1
        first = Event(parameter, given, most, "jumps" if beyond.jump else "restarts", 0, step)
        return [first, *changes(old, Moment.of(self.equations), parameter, given, step)]

    def direction(self, v: Values, known: Rates | None) -> tuple[Rates | None, Array | None]:
        """Find the way on: under the control; failing that, past a snap-back, driven by a pair that starts to move.

        Under displacement control the structure may snap back: no state continues the path while the control point
        advances, but one does while load and control point retreat and a pair slips or opens on. That pair's motion
        is then prescribed until the control point advances again.
        """
        if self.driven and known is not None and float(self.control @ known.direction) * self.sense > 0:
            self.equations.set_control(self.control)
            self.driven, known = False, None
        sense = 1.0 if self.driven else self.sense
        found, runaway = find_direction(self.equations, v, known, sense)
        if found is None and not self.driven and vertex_size(self.equations, v) > LARGEST_VERTEX:
            found = self.after_small_step(v, sense)
        if found is not None or self.by_load or known is None:
            return found, runaway
        driver = self.equations.control
        for row in self.drivers(v, known.direction):
            self.equations.set_control(row)
            found, _ = find_direction(self.equations, v)
            if found is not None:
                self.driven = True
                return found, None
        self.equations.set_control(driver)
        return None, runaway

    def after_small_step(self, v: Values, sense: float) -> Rates | None:
        """Let the one-step solver take a small step of the load, and try the states it finds there.

        At a vertex with hundreds of critical pairs (a dry wall at rest, its head joints touching without force) this
        is faster than pivoting; the states count only if their rates are consistent, so the path stays exact.
        """
        e = self.equations
        d = e.data
        unit = float(np.abs(d.load).sum()) / (float(np.abs(d.load_rate).sum()) or np.inf) or abs(self.until)
        before = (e.contact.copy(), e.sliding.copy())
        for share in (1e-3, 1e-5):
            parameter = self.state.parameter + share * unit * sense
            point = self.state
            problem = step_problem(self.path, point, parameter)
            solution = solve_near(problem, point.displacement, point.normal_force, point.friction_force)
            if not solution.solved:
                continue
            u, t_n, t_t = solution.displacement, solution.normal_force, solution.friction_force
            guess = state_of(self.path, parameter, u, t_n, t_t, before=self.state)
            restore(e, *admissible(e, v, guess.states.normal, guess.states.sign))
            found, _ = find_direction(e, v, None, sense, vertex=False)
            if found is not None:
                return found
            restore(e, *before)
        return None

    def drivers(self, v: Values, known: Array) -> list[Array]:
        """Return the motions (size,) that the pairs at their bounds would begin, the most urgent first."""
        e = self.equations
        rows = []
        for _, k, contact, sliding in sorted(wrong(e, v, rates(e, known)), reverse=True):
            side = sliding if sliding != STICK else -int(e.sliding[k])
            if contact != OPEN:
                rows += [side * e.slip_of(k), e.opening_of(k), -side * e.slip_of(k)]
            else:
                rows += [e.opening_of(k), e.slip_of(k), -e.slip_of(k)]
        slipping = np.flatnonzero((e.sliding != STICK) & (e.contact == CLOSED) & grips(e))
        speed = e.sliding[slipping] * e.positions(known, rate=True)[1][slipping]
        rows.extend(e.sliding[k] * e.slip_of(int(k)) for k in slipping[np.argsort(-speed)][:5])
        return rows

    def last_events(self, v: Values, direction: Array | None, old: Moment, step: int) -> list[Event]:
        """Name what the pairs at their bounds were about to do where the path ends."""
        if direction is None:
            return []
        for _, k, contact, sliding in wrong(self.equations, v, rates(self.equations, direction)):
            self.equations.set_state(k, contact, sliding)
        return self.name_events(old, step)

    def name_events(self, old: Moment, step: int) -> list[Event]:
        return changes(old, Moment.of(self.equations), float(self.x[-1]), self.given() * self.unit, step)

    def finish(self, states: list[PathState], events: list[Event], outcome: Outcome, last: Array | None) -> EventPath:
        n = self.equations.n
        direction = np.zeros(n) if last is None else last[:n]
        if outcome is Outcome.LOST and self.by_load and float(self.path.load_rate @ direction) * self.sense < 0:
            direction = -direction  # the runaway rate of a nearly singular matrix has either sign
        top = float(np.abs(direction).max(initial=0.0)) or 1.0
        return EventPath(tuple(states), tuple(events), outcome, direction / top, self.equations.factorisations)
