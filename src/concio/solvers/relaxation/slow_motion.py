r"""Viscous relaxation: let the structure go and see where it ends, at rest in a Coulomb state or moving without bound.

Where no method finds a Coulomb state, this one follows what the structure would do in a medium that resists its motion
in proportion to the masses M, by implicit steps

.. math:: (K + e M)\, u_{k+1} = f + e M u_k + C^T t_{k+1}, \qquad \text{joint laws at } u_{k+1},

each of them a contact problem of its own (:mod:`concio.solvers.relaxation.slow_step`). K + e M holds every body, so
that a step has a solution whatever the friction, and small steps (large e) have it close by. Steps grow while they
succeed. What stands still is an equilibrium, made exact with the states it has; what becomes a steady motion is a
:class:`concio.problem.solution.Departure`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.solution import Departure
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.run import Run
from concio.solvers.relaxation.slow_step import allowed_factorisations, pivot_to_rest, rest_near, solve_step
from concio.solvers.relaxation.unbounded_motion import unbounded_motion
from concio.solvers.states.state_reading import Finished, natural_residual, read_states

FIRST = {2: 3e-2, 3: 1e-2}
"""Resistance e of the first step by dimension, scaled units."""

GROWTH = 10.0
"""Largest factor by which steps grow after two that succeeded; where a step fails, the factor becomes its root."""

LEAST = 1e-9
"""Least resistance e."""

MOST = {2: 120, 3: 80}
"""Largest number of steps tried, by dimension."""

FAILURES = {2: 45, 3: 12}
"""Largest number of steps that may fail, by dimension: panels with wide friction come to rest after some thirty."""

CHANGES = 0.1
"""Largest relative change of the motion from one step to the next at which it is asked whether it ends."""

STEADY = 1e-6
"""Relative change of the motion from one step to the next below which it goes on as it is until something meets."""

NEARLY, FEW = 0.999, 10.0
"""Share of that way that is taken at once, and the number of steps up to which it is not."""

SLOW = 1e-3
"""Natural-map residual without resistance from which on plane problems try a crossover to rest by pivoting, and again
at each hundredth."""

ENDS = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}
"""Words of the trace."""


def relax(run: Run, u: Array | None = None, t: Array | None = None) -> Finished | Departure | None:
    """Follow the slow motion from ``u`` (N,), scaled, or from rest; return where it ends, or None.

    Parameters
    ----------
    run : Run
        Keeps count and trace.
    u : (N,) array, optional
        Displacements at the beginning.
    t : (m, d) array, optional
        Contact forces at the beginning, scaled: short steps have nearly these, in nearly these states.
    """
    s = run.scaled
    u = np.zeros(len(s.f)) if u is None else u
    pace, failures, taken, close = Pace(FIRST[s.dim]), 0, 0, SLOW
    here = None if t is None else begun(s, u, t)
    ended: Finished | Departure | None = None
    allowed = s.factor.made + allowed_factorisations(s)
    before, velocity = pace.e, np.zeros_like(u)
    while taken + failures < MOST[s.dim] and failures < FAILURES[s.dim] and s.factor.made < allowed:
        e = pace.e
        moved = solve_step(run, s.step_from(u, e), here, before / e)
        if moved is None:
            failures += 1
            pace.failed()
            continue
        u = u + moved.u
        here, taken, before = moved, taken + 1, e
        new = replace(moved, u=u)
        ended = rest_near(run, new)
        velocity, last = e * moved.u, velocity
        if ended is None and (taken == 1 or hardly_changed(velocity, last)):
            ended = unbounded_motion(s, new, velocity)
        if ended is None and s.dim == 2:
            error, _ = natural_residual(s, u, new.t)
            if error < close:
                close, ended = 0.01 * error, pivot_to_rest(run, new)
        if ended is not None:
            break
        if steady(velocity, last):
            u = u + ahead(s, u, new.t, moved.u) * moved.u
        pace.succeeded()
    run.trace.append(f"release: {taken} steps of slow motion, {failures} failed, {ENDS[type(ended)]}")
    return ended


def begun(s: Scaled, u: Array, t: Array) -> Finished:
    """Return the point from which the motion begins as if it were a step that led nowhere."""
    return Finished(np.zeros_like(u), t, read_states(s, u, t), 0.0, 0, np.zeros(0, dtype=int))


def hardly_changed(velocity: Array, last: Array) -> bool:
    """Tell whether the motion (N,) has become so steady that it is asked whether it ever ends."""
    return float(np.abs(velocity - last).max(initial=0.0)) < CHANGES * float(np.abs(velocity).max(initial=0.0))


def steady(velocity: Array, last: Array) -> bool:
    """Tell whether the motion (N,) goes on as it is until something meets or turns."""
    return float(np.abs(velocity - last).max(initial=0.0)) < STEADY * float(np.abs(velocity).max(initial=0.0))


def ahead(s: Scaled, u: Array, t: Array, step: Array) -> float:
    """Return how many equal steps lead almost to where a pair meets or a slip has gone back to its origin; 0 if few.

    Until then nothing changes but places: no force, no state. What comes after is a step like others.
    """
    y, rate = s.position(u, t), s.along(step)
    top = STEADY * float(np.abs(rate).max(initial=0.0))
    meets = (y[:, 0] > 0) & (rate[:, 0] < -top)
    back = (t[:, 0] > 0) & s.rough & ((y[:, 1:] * rate[:, 1:]).sum(axis=1) < 0)
    back &= np.linalg.norm(rate[:, 1:], axis=1) > top
    slip, speed = np.linalg.norm(y[back, 1:], axis=1), np.linalg.norm(rate[back, 1:], axis=1)
    left = float(np.concatenate([y[meets, 0] / -rate[meets, 0], slip / speed]).min(initial=np.inf))
    return NEARLY * left if FEW < left < np.inf else 0.0


@dataclass
class Pace:
    """How long the next step is: longer after two that succeeded, shorter after one that failed.

    Parameters
    ----------
    e : float
        Its resistance.
    """

    e: float
    growth: float = GROWTH
    good: int = 0

    def succeeded(self) -> None:
        """Note a step that was solved."""
        self.good += 1
        if self.good >= 2:
            self.e, self.growth = max(self.e / self.growth, LEAST), min(self.growth * 1.2, GROWTH)

    def failed(self) -> None:
        """Note a step that was not."""
        self.e, self.growth, self.good = self.growth * self.e, max(np.sqrt(self.growth), 1.5), 0
