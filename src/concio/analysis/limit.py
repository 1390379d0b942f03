"""Limit loads of a model: the associated bound and the multiplier its Coulomb load path reaches, as a bracket.

The *associated multiplier* (:mod:`concio.solvers.statics.limit`) bounds every collapse from above and needs no
stiffness. The
*path multiplier* is the largest load met on the exact quasi-static path (:mod:`concio.solvers.path.event_path`): own
weight and
whatever else is dead first, then the live load, controlled by the displacement it works on, so that local slips and
falling branches are passed. It depends on stiffness and history, as friction does. A third number needs neither: the
multiplier of a certified Coulomb *collapse state* (:mod:`concio.solvers.statics.collapse_state`), at which the wall can
begin to move; there may be several. None is passed off as another. How far the given load is from all this:
:mod:`concio.analysis.margin`.

Rigid blocks on hard joints have no unique path; their joints are lent a compliance
(:mod:`concio.analysis.lent_compliance`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from concio.analysis.lent_compliance import lent_assembly
from concio.arguments import closest, strict
from concio.contact.assembly import Assembly, as_assembly
from concio.errors import InputError, NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback
from concio.solvers.path.event_path import follow
from concio.solvers.path.record import EventPath, Outcome
from concio.solvers.path.state import CLOSED, OPEN, LinearPath, PathState
from concio.solvers.statics.collapse_state import CollapseState, find_collapse_state
from concio.solvers.statics.existence import find_mechanism
from concio.solvers.statics.friction import FrictionMargin, smallest_friction
from concio.solvers.statics.limit import LimitLoad, associated_limit

Array = np.ndarray

LARGEST_SEARCH = 15_000
"""Collapse states are searched for in problems of up to this number of pairs: about a minute there."""

MOST_PROGRAMMES, SEARCH_WORK = 60, 350_000
"""Linear programmes of that search at most, and their number times the pairs."""

LIVE = "live"
"""Load group that is multiplied unless another is named; generators put their horizontal load there."""

FAR = 50.0
"""The path is followed to this multiple of the displacement at its first limit point."""


@dataclass(frozen=True, eq=False)
class LimitResult:
    """Limit multipliers of the live load.

    Parameters
    ----------
    assembly : Assembly
    associated : LimitLoad
        Upper bound with forces and mechanism.
    path : EventPath or None
        The Coulomb path under displacement control; None where it was not asked for or the bound is infinite.
    collapse_state : CollapseState or None
        Certified state in which the structure can begin to move under Coulomb friction, the least found.
    search : str
        What the search for collapse states did, or why it was not tried.
    path_note : str
        Why there is no path, where there is none.
    first_limit : float
        Multiplier at which the path under growing load first finds no continuous way on: that of its first jump, or
        its end; ``nan`` without a path.
    collapse_shown : bool
        Whether the largest multiplier of the path is shown to be that of its collapse: the structure can move at it,
        or a mechanism proves that it carries no more, or the load falls as the structure moves far beyond it. A path
        that was lost shows only what the structure carries.
    lent_compliance : float
        Normal compliance lent to hard joints of rigid blocks [m/kN]; 0 where none was needed.
    """

    assembly: Assembly
    associated: LimitLoad
    path: EventPath | None
    collapse_state: CollapseState | None
    first_limit: float
    collapse_shown: bool
    lent_compliance: float
    search: str = "not asked for"
    path_note: str = ""

    @property
    def carried(self) -> float:
        """Largest multiplier met on the Coulomb path, collapse or not; ``nan`` without a path."""
        return self.path.peak if self.path is not None else float("nan")

    @property
    def coulomb(self) -> float:
        """Collapse multiplier of the Coulomb path; ``nan`` without a path and where none was shown."""
        return self.carried if self.collapse_shown else float("nan")

    @property
    def bracket(self) -> tuple[float, float]:
        """(least Coulomb multiplier found, associated multiplier): path peak or collapse state, whichever is less.

        The peak of a path that was lost counts: the structure carries it, and collapses at it or above.
        """
        state = self.collapse_state.multiplier if self.collapse_state is not None else np.inf
        path = self.carried if self.path is not None else np.inf
        low = min(path, state)
        return (low if np.isfinite(low) else float("nan")), self.associated.multiplier

    def mechanism(self) -> Array | None:
        """Velocity (N_all,) of the associated mechanism on all unknowns, largest entry 1; None where there is none."""
        if self.associated.mechanism is None:
            return None
        velocity: Array = self.assembly.supported.T @ self.associated.mechanism.velocity
        return velocity

    def collapse_motion(self) -> Array | None:
        """Last rate of displacement (N_all,) of the Coulomb path, largest entry 1; None without a path."""
        if self.path is None:
            return None
        velocity: Array = self.assembly.supported.T @ self.path.direction
        return velocity

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        a = self.associated
        return {
            "associated": "locked" if a.locked else "bounded",
            "associated_multiplier": _number(a.multiplier),
            "associated_upper_bound": _number(a.upper),
            "duality_gap": a.gap,
            "static_residual": a.residual,
            "mechanism_violation": None if a.mechanism is None else a.mechanism.violation,
            "checked": a.checked,
            "coulomb_path_multiplier": self.coulomb if self.collapse_shown else None,
            "coulomb_path_carries": None if self.path is None else self.carried,
            "collapse_state_multiplier": None if self.collapse_state is None else self.collapse_state.multiplier,
            "collapse_state_search": self.search,
            "coulomb_first_limit": None if self.path is None else self.first_limit,
            "path_note": self.path_note,
            "path_outcome": None if self.path is None else self.path.outcome.name.lower(),
            "path_events": None if self.path is None else len(self.path.events),
            "path_jumps": None if self.path is None else len(self.path.jumps),
            "lent_compliance": self.lent_compliance,
        }


def _number(value: float) -> float | None:
    """Return a number, or None for what is none: a word beside it says which."""
    return value if np.isfinite(value) else None


@strict
def limit(
    model: Model | Assembly,
    live: str | Sequence[str] = "live",
    *,
    path: bool = True,
    search: bool | None = None,
    progress: ProgressCallback | None = None,
) -> LimitResult:
    """Find the limit multipliers of the live load groups; all other groups act with factor 1.

    Parameters
    ----------
    model : Model or Assembly
    live : str or sequence of str
        Load groups that are multiplied.
    path : bool
        Whether the Coulomb path is followed too.
    search : bool, optional
        Whether collapse states are searched for; by default where the path is followed.
    progress : callable, optional

    Raises
    ------
    InputError
        A group does not exist, or the live groups hold no load.
    NoEquilibriumError
        The dead load alone cannot be carried.
    """
    assembly = lent_assembly(model)
    dead, load = dead_and_live(assembly, live)
    mechanism = find_mechanism(dead)
    if mechanism is not None:
        msg = "the dead load alone cannot be carried: a mechanism proves it"
        raise NoEquilibriumError(msg, hint="solve the model with the live load factor 0 and look at the mechanism")
    bound = associated_limit(dead, load)
    lent = assembly.lent_compliance
    if not np.isfinite(bound.multiplier):
        none = "not tried: no load is the last"
        return LimitResult(assembly, bound, None, None, float("nan"), False, lent, search=none, path_note=none)
    first, found, shown, note = float("nan"), None, False, "not asked for"
    if path:
        weight = dead_load_path(dead, progress=progress)
        note = _not_begun(weight)
        if not note:
            found, shown = live_load_path(dead, load, weight.end, progress=progress)
            first = min((e.parameter for e in found.jumps), default=found.peak)
    state, said = search_collapse(dead, load) if (path if search is None else search) else (None, "not asked for")
    return LimitResult(assembly, bound, found, state, first, shown, lent, search=said, path_note=note)


def _not_begun(weight: EventPath) -> str:
    """Return why a path of the live load was not begun; nothing where that of the dead load reached its end."""
    if weight.outcome is Outcome.REACHED:
        return ""
    if weight.outcome is Outcome.CANCELLED:
        return "stopped on request before the dead load was reached"
    return (
        f"not begun: growing from nothing, the dead load itself is followed to {weight.end.parameter:.4g} of its value "
        "only; that proves nothing about another history"
    )


def search_collapse(dead: ContactProblem, live: Array) -> tuple[CollapseState | None, str]:
    """Search a collapse state where the problem is not too large; return it, and what was done in words."""
    if dead.dim != 2:
        return None, "not tried: the search handles plane problems"
    if dead.pairs > LARGEST_SEARCH:
        return None, f"not tried: {dead.pairs:,} contact pairs are more than {LARGEST_SEARCH:,}"
    most = min(MOST_PROGRAMMES, SEARCH_WORK // max(dead.pairs, 1))
    state = find_collapse_state(dead, live, iterations=most)
    if state is None:
        return None, f"none found in {most} linear programmes; that proves nothing"
    return state, f"least of those found, in programme {state.iterations} of at most {most}"


@strict
def friction_margin(
    model: Model | Assembly, live: str | Sequence[str] | None = None, factor: float = 1.0
) -> FrictionMargin:
    """Return the smallest common factor of all friction coefficients that still admits equilibrium.

    Parameters
    ----------
    model : Model or Assembly
    live : str or sequence of str, optional
        Load groups with another factor than 1; by default "live" where there is such a group.
    factor : float
        Load factor of the live groups; all others have 1.

    Raises
    ------
    InputError
        A group does not exist; or a factor is given, and there is no live group to multiply.
    """
    return smallest_friction(factored_problem(as_assembly(model), live, factor))


def factored_problem(assembly: Assembly, live: str | Sequence[str] | None, factor: float) -> ContactProblem:
    """Return the problem with the live groups at ``factor`` and all others at 1; without live groups as it is."""
    if live is None:
        if LIVE in assembly.groups:
            live = LIVE
        elif factor == 1.0:
            return assembly.problem()
        else:
            msg = f"there is no load group '{LIVE}' that the factor {factor:g} could multiply"
            raise InputError(msg, hint="name one with live=...; groups: " + ", ".join(assembly.groups))
    dead, load = dead_and_live(assembly, live)
    return dead.with_loads(dead.f + factor * load)


def dead_and_live(assembly: Assembly, live: str | Sequence[str]) -> tuple[ContactProblem, Array]:
    """Return the problem without the live groups, and their loads (N,) for factor 1."""
    groups = (live,) if isinstance(live, str) else tuple(live)
    for group in groups:
        if group not in assembly.groups:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, assembly.groups, names="groups"))
    dead = assembly.problem(dict.fromkeys(groups, 0.0))
    load = assembly.problem(dict.fromkeys(groups, 1.0)).f - dead.f
    if not np.abs(load).any():
        msg = f"the live load ({', '.join(groups)}) is zero"
        raise InputError(msg, hint="give the model a load in that group, for example horizontal = 1.0")
    return dead, load


def dead_load_path(problem: ContactProblem, *, progress: ProgressCallback | None = None) -> EventPath:
    """Follow the load of a problem from nothing to its value."""
    zero = np.zeros(problem.pairs)
    touching = np.where(problem.gap > 0, OPEN, CLOSED).astype(np.int8)
    rest = PathState(0.0, np.zeros(problem.unknowns), zero, zero, touching, zero.astype(np.int8), zero, zero)
    return follow(LinearPath(problem.with_loads(0.0 * problem.f), problem.f), rest, until=1.0, progress=progress)


def coulomb_path(
    problem: ContactProblem, live: Array, *, progress: ProgressCallback | None = None
) -> tuple[EventPath, bool]:
    """Follow dead load, then live load, to collapse; return the path, and whether its peak is shown to be collapse.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    live : (N,) array
    progress : callable, optional

    Raises
    ------
    SolverError
        The path of the dead load itself comes to an end, which proves nothing about another history.
    """
    weight = dead_load_path(problem, progress=progress)
    if weight.outcome is not Outcome.REACHED:
        msg = f"the dead load is not reached on its own path: {weight.outcome.value}"
        raise SolverError(msg, hint=f"it stops at {weight.end.parameter:.4g} of the dead load")
    return live_load_path(problem, live, weight.end, progress=progress)


def live_load_path(
    problem: ContactProblem, live: Array, start: PathState, *, progress: ProgressCallback | None = None
) -> tuple[EventPath, bool]:
    """Follow the live load to collapse; return the path, and whether its peak is shown to be collapse.

    Under growing load the path goes as far as certified states go, over jumps; from there the displacement that the
    load works on is controlled, to see the structure move.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    live : (N,) array
    start : PathState
        State under the dead load, the end of :func:`dead_load_path`.
    progress : callable, optional
    """
    path = LinearPath(problem, live)
    start = replace(start, parameter=0.0, work=0.0, dissipation=0.0)
    growing = follow(path, start, until=1e6, progress=progress)
    shown = growing.outcome is Outcome.LIMIT
    control = live / float(np.abs(live).sum())
    moved = float(control @ (growing.end.displacement - start.displacement))
    if growing.outcome not in (Outcome.LIMIT, Outcome.LOST) or not moved > 0:
        return growing, shown or growing.outcome is Outcome.MECHANISM
    until = float(control @ start.displacement) + FAR * moved
    falling = follow(path, growing.end, until=until, control=control, progress=progress)
    whole = EventPath(
        growing.states + falling.states[1:],
        growing.events + tuple(replace(e, step=e.step + len(growing.states) - 1) for e in falling.events),
        falling.outcome,
        falling.direction,
        growing.factorisations + falling.factorisations,
    )
    higher = falling.peak > growing.peak * (1 + 1e-9)
    return whole, falling.outcome in (Outcome.REACHED, Outcome.MECHANISM) or (shown and not higher)
