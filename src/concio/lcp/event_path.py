r"""Load paths followed exactly, event by event.

Between two changes of contact state the response of elastic bodies with Coulomb joints is linear in the load
parameter. The path is therefore a polygon, and it is followed from corner to corner: solve the rate problem
(:mod:`concio.lcp.path_rates`), find the parameter at which the next pair opens, closes, slips, sticks or crushes,
go there, and begin again. Slip is measured from where a pair last stuck (rate form of friction), so that the path is
the limit of incremental analyses as their steps shrink.

Control is by the load parameter, which ends at the limit point, or by a functional of the displacements (the motion
of a control point), which passes it and follows the falling branch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from concio.contact.problem import Array
from concio.lcp.methods import find
from concio.lcp.path_direction import LARGEST_VERTEX, find_direction
from concio.lcp.path_equations import PathEquations, Scaled
from concio.lcp.path_events import PairStates, changes
from concio.lcp.path_rates import (
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
from concio.lcp.path_record import Event, EventPath, Outcome
from concio.lcp.path_restart import SHARES, Beyond, load_unit, look_beyond, moves_freely
from concio.lcp.path_state import (
    CLOSED,
    CRUSHED,
    OPEN,
    STICK,
    LinearPath,
    PathState,
    energy_of_step,
    plastic_position,
    state_of,
    step_problem,
)
from concio.lcp.solution import Progress, ProgressCallback

ON_EQUATIONS = 1e-15
"""Residual of the equations of the present states, relative to their largest term, that needs no correction."""


DUST = 1e-16
"""Scaled displacements below this are rounding of zero and are recorded as zero."""

FIRM = 1e-3
"""Compliance lent to hard pairs while the answer of another solver is put on the equations: the rounding of its
displacements contradicts redundant pairs, and over a small compliance it would turn into forces."""

MOST_RESTARTS = 200
"""Finite steps (jumps and restarts) taken on one path before it counts as lost."""

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
    """
    return _Follower(path, start, until, control).run(max_events, progress, stop)


def states_in_use(path: LinearPath, state: PathState) -> tuple[Array, Array]:
    """Return the contact and sliding states (m,) of a state; pairs without grip count as slipping."""
    law = path.problem.laws
    spare = law.cohesion - law.friction * law.tension
    rough = (law.friction > 0) | (law.cohesion > 0)
    contact, sliding = state.contact.astype(np.int8), state.sliding.astype(np.int8)
    return contact, np.where(~rough | ((contact == OPEN) & (spare <= 0)), 1, sliding).astype(np.int8)


class _Follower:
    def __init__(self, path: LinearPath, start: PathState, until: float, control: Array | None) -> None:
        self.path, self.state = path, start
        self.scaled = Scaled.of(path)
        functional = None if control is None else np.asarray(control, dtype=float)
        contact, sliding = states_in_use(path, start)
        self.restarts, self.restarted, self.share = 0, -np.inf, SHARES[0]
        self.by_load = functional is None
        self.unit = 1.0 if functional is None else self.scaled.length
        self.control = np.zeros(path.problem.unknowns + 2 * path.problem.pairs + 1)
        if functional is None:
            self.control[-1] = 1.0
        else:
            self.control[: functional.size] = functional
        self.equations = PathEquations(self.scaled, contact, sliding, self.control)
        self.driven = False  # a pair's slip or opening stands in for the control
        self.slip, self.offset = start.slip / self.scaled.length, start.offset / self.scaled.length
        self.x = np.concatenate(
            [
                start.displacement / self.scaled.length,
                start.normal_force / self.scaled.force,
                start.friction_force / self.scaled.force,
                [start.parameter],
            ]
        )
        self.until = until / self.unit
        self.sense = 1.0 if self.until >= self.given() else -1.0

    def given(self) -> float:
        """Return the present value of what is controlled."""
        return float(self.control @ self.x)

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
            old = PairStates.of(self.equations)
            found, runaway = self.direction(v, known)
            if found is None:
                beyond = self.beyond(progress)
                if beyond.cancelled:
                    return self.finish(states, events, Outcome.CANCELLED, direction)
                if beyond.state is None:
                    events.extend(self.last_events(v, direction, old, len(states) - 1))
                    return self.end_of_path(states, events, direction, runaway, beyond)
                states.append(self.go_to(beyond.state))
                events.extend(self.name_step(old, beyond, states))
                known, direction = None, None
                if (self.until - self.given()) * self.sense <= 0:
                    return self.finish(states, events, Outcome.REACHED, direction)
                continue
            events.extend(self.name_events(old, len(states) - 1))
            known, direction = found, found.direction
            rate = float(self.control @ direction) * self.sense
            left = (self.until - self.given()) * self.sense / rate if rate > found.still else np.inf
            length = self.distance(v, found)
            reached = left <= length
            if not np.isfinite(min(left, length)):
                return self.finish(states, events, Outcome.MECHANISM, direction)
            self.advance(found, min(left, length))
            states.append(self.record())
            if reached or (stop is not None and stop(states[-1])):
                return self.finish(states, events, Outcome.REACHED, direction)
            note = Progress("event-path", corner, 0.0, f"parameter {self.x[-1]:.6g}, {len(events)} events")
            if progress is not None and progress(note):
                return self.finish(states, events, Outcome.CANCELLED, direction)
        return self.finish(states, events, Outcome.TOO_MANY, direction)

    def beyond(self, progress: ProgressCallback | None) -> Beyond:
        """Look for a certified state at a finite distance, by a growing load (or, asked to go down, a falling one)."""
        if self.restarts >= MOST_RESTARTS:
            return Beyond(None)
        point, sense = self.state, self.sense if self.by_load else 1.0
        walked = abs(point.parameter - self.restarted) / load_unit(self.path, point)
        self.share = 10 * self.share if walked <= CLOSE * self.share else SHARES[0]
        found = look_beyond(self.path, point, sense, least=self.share, progress=progress)
        if found.state is None:
            return found
        if self.by_load and (self.until - found.state.parameter) * self.sense < 0:
            return Beyond(None)
        if not self.by_load and self.control[:-1] @ self.unknowns(found.state)[:-1] * self.sense <= self.given():
            return Beyond(None)  # the control point would go back
        self.restarts, self.restarted = self.restarts + 1, found.state.parameter
        return found

    def unknowns(self, state: PathState) -> Array:
        """Return the scaled unknowns (size,) of a state."""
        force, length = self.scaled.force, self.scaled.length
        forces = np.concatenate([state.normal_force, state.friction_force]) / force
        return np.concatenate([state.displacement / length, forces, [state.parameter]])

    def go_to(self, state: PathState) -> PathState:
        """Take over a certified state and the states of its pairs."""
        if self.driven:
            self.equations.set_control(self.control)
            self.driven = False
        contact, sliding = states_in_use(self.path, state)
        self.equations.set_states(contact, sliding, lent=FIRM)
        self.x = self.unknowns(state)
        self.slip, self.offset = state.slip / self.scaled.length, state.offset / self.scaled.length
        self.state = state
        self.put_on_equations()
        self.equations.set_states(contact, sliding)
        return state

    def name_step(self, old: PairStates, beyond: Beyond, states: list[PathState]) -> list[Event]:
        """Name a finite step after the pair that moves most in it, and what changed in it."""
        (n0, t0), (n1, t1) = (plastic_position(self.path, s) for s in states[-2:])
        most = int(np.argmax(np.abs(n1 - n0) + np.abs(t1 - t0)))
        parameter, given, step = float(self.x[-1]), self.given() * self.unit, len(states) - 1
        first = Event(parameter, given, most, "jumps" if beyond.jump else "restarts", 0, step)
        return [first, *changes(old, PairStates.of(self.equations), parameter, given, step)]

    def end_of_path(
        self,
        states: list[PathState],
        events: list[Event],
        direction: Array | None,
        runaway: Array | None,
        beyond: Beyond,
    ) -> EventPath:
        """Finish where nothing continues the path: LIMIT where that is shown, LOST where it is not."""
        last = direction if runaway is None else runaway
        for way in (1.0, -1.0):
            if runaway is not None and moves_freely(self.path, self.state, way * runaway[: self.equations.n]):
                return self.finish(states, events, Outcome.LIMIT, way * runaway)
        if beyond.no_equilibrium:
            return self.finish(states, events, Outcome.LIMIT, beyond.motion)
        return self.finish(states, events, Outcome.LOST, last)

    def put_on_equations(self) -> None:
        """Correct the point where rounding has carried it off the equations of its states (little, or not at all)."""
        b = self.right_hand_side()
        size = float(np.abs(self.x).max(initial=0.0)) + float(np.abs(b).max(initial=0.0))
        left = b - self.equations.multiply(self.x)
        if float(np.abs(left).max()) <= ON_EQUATIONS * size:
            return
        change, _ = self.equations.solve(left)  # of least size where forces are not unique
        if np.abs(change).max() <= 1e-6 * size:
            self.x = self.x + change

    def right_hand_side(self) -> Array:
        return self.equations.right_hand_side(self.slip, self.offset, float(self.equations.control @ self.x))

    def settle(self) -> None:
        """Let slip and offset follow what has slipped or been crushed."""
        self.slip, self.offset = self.moved()

    def moved(self) -> tuple[Array, Array]:
        """Return slip and offset at the present point, scaled: dilatancy lifts wherever a pair slips, open or not."""
        e = self.equations
        opening, position = e.positions(self.x)
        moving = e.sliding != STICK
        offset = self.offset - np.where(moving, e.data["psi"] * np.abs(position - self.slip), 0.0)
        exact = (e.contact == CRUSHED) | ((e.contact == CLOSED) & moving & (e.data["psi"] > 0))
        return np.where(moving, position, self.slip), np.where(exact, -opening, offset)

    def direction(self, v: Values, known: Rates | None) -> tuple[Rates | None, Array | None]:
        """Find the way on: under the control; failing that, past a snap-back, driven by a pair that wants to move.

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
        unit = float(np.abs(d["f"]).sum()) / (float(np.abs(d["g"]).sum()) or np.inf) or abs(self.until)
        before = (e.contact.copy(), e.sliding.copy())
        for share in (1e-3, 1e-5):
            parameter = self.state.parameter + share * unit * sense
            solution = find("interior-point")(step_problem(self.path, self.state, parameter))
            if not solution.solved:
                continue
            u, t_n, t_t = solution.displacement, solution.normal_force, solution.friction_force
            guess = state_of(self.path, parameter, u, t_n, t_t, before=self.state)
            restore(e, *admissible(e, v, guess.contact, guess.sliding))
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

    def distance(self, v: Values, r: Rates) -> float:
        """Return how far the control can go until a pair meets the next bound of its state."""
        e = self.equations
        grip = grips(e)
        ways = [
            (v.gap, r.opening, e.contact == OPEN, r.still),
            (v.force, r.force, e.contact == CLOSED, r.calm),
            (v.room, -r.force, e.contact == CLOSED, r.calm),
            (v.plus, r.plus, (e.sliding == STICK) & grip, r.calm),
            (v.minus, r.minus, (e.sliding == STICK) & grip, r.calm),
        ]
        best = np.inf
        for value, rate, mask, still in ways:
            use = mask & (rate < -still) & np.isfinite(value)
            if use.any():
                best = min(best, float((np.maximum(value[use], 0.0) / -rate[use]).min()))
        return best

    def advance(self, r: Rates, length: float) -> None:
        """Go along the direction and put the point back on the exact equations."""
        self.x = self.x + length * r.direction
        self.put_on_equations()

    def record(self) -> PathState:
        e, force, length = self.equations, self.scaled.force, self.scaled.length
        n, m = e.n, e.m
        slip, offset = self.moved()
        after = PathState(
            parameter=float(self.x[-1]),
            displacement=np.where(np.abs(self.x[:n]) < DUST, 0.0, self.x[:n]) * length,
            normal_force=self.x[n : n + m] * force,
            friction_force=self.x[n + m : -1] * force,
            contact=e.contact.copy(),
            sliding=e.sliding.copy(),
            slip=slip * length,
            offset=offset * length,
        )
        work, dissipation = energy_of_step(self.path, self.state, after)
        after = replace(after, work=self.state.work + work, dissipation=self.state.dissipation + dissipation)
        self.state = after
        return after

    def last_events(self, v: Values, direction: Array | None, old: PairStates, step: int) -> list[Event]:
        """Name what the pairs at their bounds were about to do where the path ends."""
        if direction is None:
            return []
        for _, k, contact, sliding in wrong(self.equations, v, rates(self.equations, direction)):
            self.equations.set_state(k, contact, sliding)
        return self.name_events(old, step)

    def name_events(self, old: PairStates, step: int) -> list[Event]:
        return changes(old, PairStates.of(self.equations), float(self.x[-1]), self.given() * self.unit, step)

    def finish(self, states: list[PathState], events: list[Event], outcome: Outcome, last: Array | None) -> EventPath:
        n = self.equations.n
        direction = np.zeros(n) if last is None else last[:n]
        if outcome is Outcome.LOST and self.by_load and float(self.path.load_rate @ direction) * self.sense < 0:
            direction = -direction  # the runaway rate of a nearly singular matrix has either sign
        top = float(np.abs(direction).max(initial=0.0)) or 1.0
        return EventPath(tuple(states), tuple(events), outcome, direction / top, self.equations.factorisations)
