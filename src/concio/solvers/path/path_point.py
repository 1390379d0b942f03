"""A point of an exact path: its unknowns, kept on the equations of its pairs' states, and how far these states last."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import (
    CLOSED,
    CRUSHED,
    OPEN,
    STICK,
    LinearPath,
    PathState,
    certify_step,
    energy_of_step,
)
from concio.solvers.path.rates import Rates, Values, grips, holds
from concio.solvers.path.scaling import ScaledPath

ON_EQUATIONS = 1e-14
"""Residual of the equations of the present states, relative to their largest term, that needs no correction."""

FAR = 1e5
"""Scaled displacements above this are so large that their rounding is not a rounding of forces any more."""

DUST = 1e-16
"""ScaledPath displacements below this are rounding of zero and are recorded as zero."""

ALL_DUST = 1e-13
"""Where all scaled displacements are below this, nothing has moved."""

FIRM = 1e-3
"""Compliance added to hard pairs while the answer of another solver is put on the equations: the rounding of its
displacements contradicts redundant pairs, and over a small compliance it would turn into forces."""


ROUNDED = 1e-12
"""Certificate entries below this are rounding."""


def states_in_use(path: LinearPath, state: PathState) -> tuple[Array, Array]:
    """Return normal states (m,) of a state and signs of its slips (m,); pairs without grip count as slipping."""
    contact = state.states.normal.astype(np.int8)
    return contact, np.where(holds(path.problem.cone, contact), state.states.sign, 1).astype(np.int8)


class PathPoint:
    """The present point of a path that is followed, in scaled units.

    Parameters
    ----------
    path : LinearPath
    start : PathState
    until : float
        Value of what is controlled at which the path ends.
    control : (N,) array or None
        Functional of the displacements that is controlled; None for the load parameter.
    """

    def __init__(self, path: LinearPath, start: PathState, until: float, control: Array | None) -> None:
        self.path, self.state = path, start
        self.scaled = ScaledPath.of(path)
        functional = None if control is None else np.asarray(control, dtype=float)
        contact, sliding = states_in_use(path, start)
        self.by_load = functional is None
        self.unit = 1.0 if functional is None else self.scaled.length
        self.control = np.zeros(path.problem.unknowns + 2 * path.problem.pairs + 1)
        if functional is None:
            self.control[-1] = 1.0
        else:
            self.control[: functional.size] = functional
        self.equations = PathEquations(self.scaled, contact, sliding, self.control)
        self.slip, self.offset = start.slip[:, 0] / self.scaled.length, start.offset / self.scaled.length
        self.x = self.unknowns(start)
        self.until = until / self.unit
        self.begun = self.given()
        self.sense = 1.0 if self.until >= self.begun else -1.0

    def given(self) -> float:
        """Return the present value of what is controlled."""
        return float(self.control @ self.x)

    def share_gone(self) -> float:
        """Return the share of the way that is gone; nan where it has no end."""
        whole = self.until - self.begun
        return (self.given() - self.begun) / whole if whole and np.isfinite(whole) else np.nan

    def put_on_equations(self) -> None:
        """Correct the point where rounding has carried it off the equations of its states (little, or not at all)."""
        b = self.right_hand_side()
        size = float(np.abs(self.x).max(initial=0.0)) + float(np.abs(b).max(initial=0.0))
        left = b - self.equations.multiply(self.x)
        if float(np.abs(left).max()) > ON_EQUATIONS * size:
            change, _ = self.equations.refined(left)  # of least size where forces are not unique
            if np.abs(change).max() <= 1e-6 * size:
                self.x = self.x + change
        if float(np.abs(self.x[: self.equations.n]).max(initial=0.0)) > FAR:
            self.balance_forces(b)

    def balance_forces(self, b: Array) -> None:
        """Correct the forces alone, where displacements have grown so large that their rounding moves forces.

        Of a stiff pair a force is a displacement over its compliance; rounding of u, which nothing is left of in a gap
        measured by u, would be found again in the balance of forces.
        """
        e, n, m = self.equations, self.equations.n, self.equations.m
        t_n, t_t = self.x[n : n + m], self.x[n + m : -1]
        used = e.sliding * e.data.cone.friction * t_n + t_t
        left = b - e.multiply(self.x)
        left[n : n + m] = np.where(e.contact != CLOSED, b[n : n + m] - t_n, 0.0)
        left[n + m : -1] = np.where(e.sliding != STICK, b[n + m : -1] - used, 0.0)
        left[-1] = 0.0
        size = float(np.abs(self.x[n:]).max(initial=0.0)) + float(np.abs(b[:n]).max(initial=0.0))
        if float(np.abs(left).max()) > ON_EQUATIONS * size:
            change, _ = e.refined(left)
            if np.abs(change[n:]).max() <= 1e-6 * size:
                self.x = self.x + change

    def right_hand_side(self) -> Array:
        """Return the right-hand side (size,) of the equations of the present states at the present control."""
        return self.equations.right_hand_side(self.slip, self.offset, float(self.equations.control @ self.x))

    def settle(self) -> None:
        """Let slip and offset follow what has slipped or been crushed."""
        self.slip, self.offset = self.moved()

    def moved(self) -> tuple[Array, Array]:
        """Return slip and offset at the present point, scaled: dilatancy lifts wherever a pair slips, open or not."""
        e = self.equations
        opening, position = e.positions(self.x)
        moving = e.sliding != STICK
        offset = self.offset - np.where(moving, e.data.dilatancy * np.abs(position - self.slip), 0.0)
        exact = (e.contact == CRUSHED) | ((e.contact == CLOSED) & moving & (e.data.dilatancy > 0))
        return np.where(moving, position, self.slip), np.where(exact, -opening, offset)

    def unknowns(self, state: PathState) -> Array:
        """Return the scaled unknowns (size,) of a state."""
        force, length = self.scaled.force, self.scaled.length
        forces = np.concatenate([state.normal_force, state.friction_force[:, 0]]) / force
        return np.concatenate([state.displacement / length, forces, [state.parameter]])

    def go_to(self, state: PathState) -> PathState:
        """Take over a certified state and the states of its pairs; return it as put on the exact equations of these.

        The answer as it came is kept where its states turn out not to be exactly those.
        """
        before, length = self.state, self.scaled.length
        contact, sliding = states_in_use(self.path, state)
        self.equations.set_states(contact, sliding, lent=FIRM)
        self.x = self.unknowns(state)
        self.slip, self.offset = state.slip[:, 0] / length, state.offset / length
        self.put_on_equations()
        self.equations.set_states(contact, sliding)
        exact = self.record()
        exact = replace(exact, states=state.states)
        if certify_step(self.path, before, exact).worst > certify_step(self.path, before, state).worst + ROUNDED:
            self.x, exact = self.unknowns(state), state
        self.state = exact
        return exact

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
        """Make the present point the last state, with the work and the dissipation of the way there, and return it."""
        e, force, length = self.equations, self.scaled.force, self.scaled.length
        n, m = e.n, e.m
        slip, offset = self.moved()
        u = self.x[:n]
        dust = np.abs(u) < (DUST if float(np.abs(u).max(initial=0.0)) > ALL_DUST else ALL_DUST)
        after = PathState(
            parameter=float(self.x[-1]),
            displacement=np.where(dust, 0.0, u) * length,
            normal_force=self.x[n : n + m] * force,
            friction_force=self.x[n + m : -1, None] * force,
            states=PairStates.plane(e.contact.copy(), e.sliding),
            slip=slip[:, None] * length,
            offset=offset * length,
            broken=self.state.broken,
        )
        work, dissipation = energy_of_step(self.path, self.state, after)
        after = replace(after, work=self.state.work + work, dissipation=self.state.dissipation + dissipation)
        self.state = after
        return after
