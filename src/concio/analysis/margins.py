"""How far a structure is from its limit, with the load and with friction, by admissible forces and by solving.

Two questions, each answered twice. *How much more load?* *How much less friction?* Linear programming answers for
associated friction: beyond that load, or below that friction, no equilibrium exists, and a mechanism proves it
(:mod:`concio.solvers.statics.associated_limit`). What Coulomb friction carries may be less. So the same question is put
to the solver of a load step, bisecting between what was found to hold and the proven limit:
at one end a certified equilibrium, at the other a load step for which none was found. The set of loads that Coulomb
friction carries need not be an interval, and a solver that finds nothing proves nothing: the pair of numbers is what
was found, no more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.limit import dead_and_live, factored_problem, live_groups
from concio.analysis.margin_of import MarginOf
from concio.arguments import strict
from concio.contact.assembly import Assembly
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Status
from concio.representation import short_repr
from concio.solvers.methods import find
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.friction import smallest_friction
from concio.verdict.limit_words import margin_words
from concio.verdict.margin_verdict import margin_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown

Array = np.ndarray

FAR = 1e6
"""A load that holds at this multiple of all other loads, and that no mechanism bounds, counts as unlimited."""


@short_repr
@dataclass(frozen=True)
class Margin(Shown):
    """Load factor or friction factor at which a structure comes to its limit.

    Parameters
    ----------
    holds : float
        Factor with a certified Coulomb equilibrium, closest to the limit of those tried; ``nan`` where none was found,
        ``inf`` where the load can grow without bound.
    fails : float
        Factor without one, closest to ``holds``; ``nan`` where none was tried.
    outcome : Status or None
        Outcome at ``fails``.
    proven : float
        Associated limit: beyond this load, or below this friction, no equilibrium exists (to rounding).
    solves : int
        Load steps solved.
    of : MarginOf or None
        The structure, its loads, and what grows or falls; None of a bare problem.
    """

    holds: float
    fails: float
    outcome: Status | None
    proven: float
    solves: int
    of: MarginOf | None = field(default=None, repr=False, compare=False)

    @property
    def verdict(self) -> Verdict:
        """The margin with its question, what shows either end, and what it leaves out."""
        return margin_verdict(self)

    @property
    def locked(self) -> bool:
        """True where any multiple of the load is carried: no factor is the last."""
        return self.holds == float("inf")

    @property
    def words(self) -> str:
        """What was found, in words."""
        return margin_words(self)


@strict
@entry_point
def load_margin(model: Model | Assembly, live: str | Sequence[str] = "live", tolerance: float = 1e-3) -> Margin:
    """Return the largest factor of the live load that :func:`concio.solve` was found to carry, in one step.

    The load goes from nothing to its value in one step, without history. On a load path it may be another one.

    Parameters
    ----------
    model : Model or Assembly
    live : str or sequence of str
        Load groups that are multiplied; all others have factor 1.
    tolerance : float
        Width of the final bracket relative to the associated limit.

    Raises
    ------
    InputError
        A group does not exist, or the live groups hold no load.

    Examples
    --------
    A pillar tips under a horizontal share of its weight of width over height:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0)
    >>> margin = concio.load_margin(pillar)
    >>> round(margin.holds, 3), round(margin.proven, 6)
    (0.25, 0.25)
    """
    assembly = lent_assembly(model)
    dead, load = dead_and_live(assembly, live)
    return replace(_load_margin(dead, load, tolerance), of=MarginOf(assembly, live_groups(assembly, live), "load"))


def _load_margin(dead: ContactProblem, load: Array, tolerance: float) -> Margin:
    limit = associated_limit(dead, load).multiplier
    if np.isnan(limit):
        return Margin(float("nan"), float("nan"), None, limit, 0)
    if np.isinf(limit):
        return _without_bound(dead, load, tolerance)
    return _bisect(lambda factor: dead.with_loads(dead.f + factor * load), 0.0, limit, tolerance * abs(limit))


@strict
@entry_point
def friction_by_solving(
    model: Model | Assembly, live: str | Sequence[str] | None = None, factor: float = 1.0, tolerance: float = 1e-3
) -> Margin:
    """Return the smallest common factor of all friction coefficients with which :func:`concio.solve` was found to hold.

    Parameters
    ----------
    model : Model or Assembly
    live : str or sequence of str, optional
        Load groups with another factor than 1; by default "live" where there is such a group.
    factor : float
        Load factor of the live groups; all others have 1.
    tolerance : float
        Width of the final bracket.

    Raises
    ------
    InputError
        A group does not exist, or the live groups hold no load.

    Examples
    --------
    A block that carries 0.3 of its weight sideways on a friction of 0.6 needs half of it:

    >>> import concio
    >>> block = concio.column(width=2.0, height=1.0, blocks=1, block="rigid", friction=0.6, horizontal=0.3)
    >>> round(concio.friction_by_solving(block).holds, 2)
    0.5
    """
    assembly = lent_assembly(model)
    loaded = factored_problem(assembly, live, factor)
    least = smallest_friction(loaded).factor
    found = _bisect(loaded.with_friction, 1.0, least, tolerance)
    return replace(found, of=MarginOf(assembly, live_groups(assembly, live), "friction", factor))


def _without_bound(dead: ContactProblem, load: Array, tolerance: float) -> Margin:
    """Return the margin of a load that associated friction does not bound, which says nothing of Coulomb friction.

    It grows by tens from a share of the other loads on, until one is not found to hold, or :data:`FAR` times them is.
    """
    auto, unit = find("auto"), (float(np.abs(dead.f).sum()) or float(np.abs(load).sum())) / float(np.abs(load).sum())
    safe, count = 0.0, 0
    for factor in (0.0, *(unit * 10.0 ** np.arange(-2, np.log10(FAR) + 1))):
        found = auto(dead.with_loads(dead.f + factor * load))
        count += 1
        if not found.solved and factor == 0.0:
            return Margin(float("nan"), 0.0, found.status, float("inf"), count)
        if not found.solved:
            between = _bisect(lambda f: dead.with_loads(dead.f + f * load), safe, factor, tolerance * factor)
            fails = float(factor) if between.outcome is None else between.fails
            return Margin(between.holds, fails, between.outcome or found.status, float("inf"), count + between.solves)
        safe = float(factor)
    return Margin(float("inf"), float("nan"), None, float("inf"), count)


def _bisect(problem: Callable[[float], ContactProblem], safe: float, limit: float, width: float) -> Margin:
    """Bisect between ``safe``, which ought to hold, and ``limit``, beyond which nothing does."""
    auto = find("auto")
    first = auto(problem(safe))
    if not first.solved:
        return Margin(float("nan"), safe, first.status, limit, 1)
    holds, fails, outcome, count = safe, limit, None, 1
    while abs(fails - holds) > width:
        middle = 0.5 * (holds + fails)
        found = auto(problem(middle))
        count += 1
        if found.solved:
            holds = middle
        else:
            fails, outcome = middle, found.status
    return Margin(holds, fails if outcome is not None else float("nan"), outcome, limit, count)
