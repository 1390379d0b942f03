"""Limit loads of a model: how much of a load it carries, by numbers each of which says what it is.

The *associated multiplier* (:mod:`concio.solvers.statics.associated_limit`) bounds every collapse from above and needs
no stiffness. The *load steps* (:mod:`concio.analysis.load_steps`) show what Coulomb friction carries when the load
grows: a certified lower bound, found quickly. The *path multiplier* (:mod:`concio.analysis.coulomb_path`) is the
largest load met on the exact quasi-static path, controlled by the displacement it works on, so that local slips and
falling branches are passed; it depends on stiffness and history, as friction does. One number needs neither: the
multiplier of a certified Coulomb *collapse state* (:mod:`concio.solvers.statics.collapse_state`), at which the wall can
begin to move; there may be several. None is passed off as another. How far the given load is from all this:
:mod:`concio.analysis.margins`.

Rigid blocks on hard joints have no unique path; their joints are given a compliance
(:mod:`concio.analysis.lent_compliance`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import Literal

import numpy as np

from concio.analysis.beside import Beside
from concio.analysis.coulomb_path import coulomb_path, dead_state, live_load_path
from concio.analysis.entry_point import entry_point, entry_point_in_stages
from concio.analysis.friction_margin import FrictionMargin
from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.limit_result import LimitResult
from concio.analysis.limit_ties import whole_up_to
from concio.analysis.limit_torsion import SPREAD, spread_steps, twisted_joints
from concio.analysis.load_steps import by_scale, in_one_step, load_steps, unit_of_load
from concio.analysis.margin_of import MarginOf
from concio.analysis.tie_forces import without_breakable
from concio.arguments import closest, strict
from concio.contact.assembly import Assembly, as_assembly
from concio.contact.factors import once
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.limits_of_work import (
    COLLAPSE_WORK,
    LARGEST_PATH,
    LARGEST_SEARCH,
    UNASKED_CONES,
    UNASKED_IN_SPACE,
    UNASKED_SPREAD,
    UNASKED_WORK,
)  # fmt: skip
from concio.problem.solution import PROVEN_FAILURES, Progress, ProgressCallback, Status
from concio.solvers.methods import find
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from concio.solvers.statics.collapse_search import find_collapse_state
from concio.solvers.statics.collapse_state import CollapseState
from concio.solvers.statics.existence import find_mechanism
from concio.solvers.statics.friction import smallest_friction
from concio.verdict.limit_verdict import DEAD_NOT_CARRIED
from concio.verdict.not_standing import not_standing, of_the_joints

__all__ = [
    "LimitResult", "coulomb_path", "dead_and_live", "friction_margin", "limit", "limit_stages", "search_collapse"
]  # fmt: skip

Array = np.ndarray

LIVE = "live"
"""Load group that is multiplied unless another is named; generators put their horizontal load there."""

Found = Literal["bound", "friction", "steps", "collapse state", "in one step", "spread", "path"]
"""The numbers of a limit load, in the order in which they are found: the quick ones first."""


@strict
@entry_point
def limit(
    model: Model | Assembly,
    live: str | Sequence[str] = "live",
    *,
    path: bool | None = None,
    steps: bool | None = None,
    search: bool | None = None,
    friction: bool = False,
    progress: ProgressCallback | None = None,
) -> LimitResult:
    """Find the limit multipliers of the live load groups; all other groups act with factor 1.

    Parameters
    ----------
    model : Model or Assembly
    live : str or sequence of str
        Load groups that are multiplied.
    path : bool, optional
        Whether the exact Coulomb path is followed; by default where there are few contact pairs
        (:data:`LARGEST_PATH`).
    steps : bool, optional
        Whether the load grows in certified Coulomb steps; by default where ``path`` was left open and is not followed.
        In space the least load that they did not reach is then applied in one step, by default up to
        :data:`UNASKED_IN_SPACE` pairs, but not where a collapse state is known below what the steps carry: a motion may
        prove that it is not carried.
    search : bool, optional
        Whether collapse states are searched for; by default where ``path`` is not False, and then only as long as the
        other numbers take; in space up to :data:`UNASKED_IN_SPACE` pairs.
    friction : bool
        Whether the smallest friction is found that carries the load as given.
    progress : callable, optional

    Raises
    ------
    InputError
        A group does not exist, or the live groups hold no load.
    NoEquilibriumError
        The dead load alone cannot be carried.

    Examples
    --------
    A pillar tips under a horizontal share of its weight of width over height. The bound and what Coulomb friction
    carries agree:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0)
    >>> found = concio.limit(pillar)
    >>> [round(float(multiplier), 6) for multiplier in found.bracket]
    [0.25, 0.25]
    """
    stages = limit_stages(model, live, path=path, steps=steps, search=search, friction=friction, progress=progress)
    *_, (_, found) = stages
    return found


@strict
@entry_point_in_stages
def limit_stages(
    model: Model | Assembly,
    live: str | Sequence[str] = "live",
    *,
    path: bool | None = None,
    steps: bool | None = None,
    search: bool | None = None,
    friction: bool = False,
    progress: ProgressCallback | None = None,
) -> Iterator[tuple[Found, LimitResult]]:
    """Find the same numbers as :func:`limit` one after the other, the quick ones first.

    Yields
    ------
    name : str
        Which number was found last.
    LimitResult
        All numbers found so far.

    Raises
    ------
    InputError, NoEquilibriumError
        As :func:`limit`.
    """
    assembly = lent_assembly(model)
    dead, load = dead_and_live(assembly, live)
    groups = live_groups(assembly, live)
    tell = _telling(progress)
    tell("associated bound")
    mechanism = find_mechanism(dead)
    if mechanism is not None:
        zero = ", ".join(f"'{group}': 0" for group in groups)
        hint = f"solve the model with factors={{{zero}}} and look at it"
        asked = "the largest multiplier"
        told = not_standing(assembly, asked, DEAD_NOT_CARRIED, multiplied=groups)
        raise NoEquilibriumError(of_the_joints(DEAD_NOT_CARRIED, assembly.detection), hint=hint, verdict=told)
    found = LimitResult(
        assembly, associated_limit(dead, load), groups, lent_compliance=assembly.lent_compliance,
        unit=unit_of_load(dead, load),
    )  # fmt: skip
    if (bare := without_breakable(assembly, dead)) is not None:
        found = replace(found, untied=associated_limit(bare, load))
    yield "bound", found
    if friction:
        tell("smallest friction")
        found = replace(found, friction=smallest_friction(dead.with_loads(dead.f + load)))
        yield "friction", found
    bound = found.associated.multiplier
    if np.isnan(bound):
        none = "not tried: no multiple of the load was found to be in balance"
        yield "bound", replace(found, search=none, path_note=none)
        return
    if path and dead.dim != 2:
        msg = "exact paths are for models in the plane; the model is in space"
        raise InputError(msg, hint="load steps are followed instead: leave path out")
    exact = path if path is not None else dead.dim == 2 and dead.pairs <= LARGEST_PATH
    stepped = steps if steps is not None else path is None and (not exact or found.associated.locked)
    quick = dead.dim == 2 or dead.pairs <= UNASKED_IN_SPACE
    searched, top = bool(search) or (search is None and path is not False and quick), found.associated
    if search is None and path is not False and not quick:
        found = replace(found, search=f"not tried by default: {dead.pairs:,} contact pairs in space; request it")

    def seek(note: ProgressCallback) -> tuple[CollapseState | None, str]:
        work = COLLAPSE_WORK if search else UNASKED_WORK if dead.dim == 2 else UNASKED_CONES
        return search_collapse(dead, load, work=work, bound=top, progress=note)

    with ExitStack() as stack:
        searching = stack.enter_context(Beside(seek)) if searched else None  # both take long, and neither the other
        if stepped and bound > 0:
            tell("load steps")
            found = _with_steps(found, dead, load, progress)
            yield "steps", found
        if searching is not None:
            tell("collapse states")
            state, said = searching.result(progress)
            found = replace(found, collapse_state=state, search=said)
            yield "collapse state", found
    if found.steps is not None and dead.dim == 3 and found.steps.failed < bound:
        if steps or (quick and not _begins_below(found)):
            tell("the least load not reached, in one step")
            found = replace(found, steps=in_one_step(dead, load, found.steps, progress=progress))
        yield "in one step", found
    found = replace(found, twisting=len(cornered := twisted_joints(assembly, _motions(found))))
    joints = cornered or twisted_joints(assembly, _motions(found), SPREAD)
    if joints and found.steps is not None and found.steps.multipliers and 0 < bound < np.inf:
        tell("load steps with pressure spread over the joints")
        most = UNASKED_SPREAD if steps is None else LARGEST_SEARCH
        spread = spread_steps(assembly, groups, bound, most, joints, stated=not cornered, progress=progress)
        found = replace(found, spread=spread)
        yield "spread", found
    if exact:
        tell("Coulomb path")
        start, note = dead_state(dead, progress=progress)
        found = replace(found, path_note=note)
        if start is not None:
            way, shown = live_load_path(dead, load, start, progress=progress)
            first = min((e.parameter for e in way.jumps), default=way.peak)
            found = replace(found, path=way, collapse_shown=shown, first_limit=first, dead=Status.SOLVED)
            found = replace(found, ties_whole=whole_up_to(assembly, way, groups))
        elif found.steps is None and steps is not False and bound > 0:
            tell("load steps")
            found = _with_steps(found, dead, load, progress)
            yield "steps", found
    elif path is None:
        many = f"not followed by default: {dead.pairs:,} contact pairs"
        found = replace(found, path_note=many if dead.dim == 2 else "not tried: exact paths are plane")
    yield "path", found


def _with_steps(
    found: LimitResult, dead: ContactProblem, load: Array, progress: ProgressCallback | None
) -> LimitResult:
    """Return the result with load steps, and with what comes of the dead load alone by whatever it takes."""
    steps = by_scale(dead, load, progress=progress) if found.associated.locked else None
    if steps is None:
        steps = load_steps(dead, load, found.associated.multiplier, progress=progress)
    alone = steps.dead
    if not steps.multipliers and alone is not Status.CANCELLED and alone not in PROVEN_FAILURES:
        alone = find("auto")(dead, progress=progress).status
    return replace(found, steps=steps, dead=alone)


def _begins_below(found: LimitResult) -> bool:
    """Return whether a state begins to move below what the steps carry.

    It makes the design value then, of which a load that the steps did not reach says nothing.
    """
    state, steps = found.collapse_state, found.steps
    return state is not None and steps is not None and found.state_counts and state.multiplier <= steps.carried


def _motions(found: LimitResult) -> list[Array]:
    """Return the motions (N_all,) in which the structure is known to begin to move."""
    motions = [] if found.associated.mechanism is None else [found.associated.mechanism.velocity]
    motions += [] if found.collapse_state is None else [found.collapse_state.velocity]
    return [np.asarray(found.assembly.supported.T @ velocity) for velocity in motions]


def _telling(progress: ProgressCallback | None) -> Callable[[str], None]:
    """Return a function that tells the callback what is being done."""

    def tell(what: str) -> None:
        if progress is not None:
            progress(Progress("limit", 0, float("nan"), what))

    return tell


def search_collapse(
    dead: ContactProblem,
    live: Array,
    *,
    work: int = COLLAPSE_WORK,
    bound: LimitLoad | None = None,
    progress: ProgressCallback | None = None,
) -> tuple[CollapseState | None, str]:
    """Search collapse states where the problem is not too large; return the least one, and what was done in words."""
    if dead.pairs > LARGEST_SEARCH:
        return None, f"not tried: {dead.pairs:,} contact pairs are more than {LARGEST_SEARCH:,}"
    found = find_collapse_state(dead, live, work=work, bound=bound, progress=progress)
    return found.state, found.words


@strict
@entry_point
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

    Examples
    --------
    A block that carries 0.3 of its weight sideways on a friction of 0.6 needs half of it:

    >>> import concio
    >>> block = concio.column(width=2.0, height=1.0, blocks=1, block="rigid", friction=0.6, horizontal=0.3)
    >>> round(concio.friction_margin(block).factor, 6)
    0.5
    """
    assembly = as_assembly(model)
    found = smallest_friction(factored_problem(assembly, live, factor))
    of = MarginOf(assembly, live_groups(assembly, live), "friction", factor)
    return FrictionMargin(found.factor, found.below, found.programmes, of)


def live_groups(assembly: Assembly, live: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of live groups; by default the group "live" where there is one."""
    if live is None:
        return (LIVE,) if LIVE in assembly.groups else ()
    return once(live)


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
    groups = live_groups(assembly, live)
    for group in groups:
        if group not in assembly.groups:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, assembly.groups, names="groups"))
    dead = assembly.problem(dict.fromkeys(groups, 0.0))
    whole = assembly.problem(dict.fromkeys(groups, 1.0), like=dead)
    load = whole.f - dead.f
    if not (np.array_equal(whole.gap, dead.gap) and np.array_equal(whole.slip_origin, dead.slip_origin)):
        msg = f"the live load ({', '.join(groups)}) moves supports, which no load multiplier multiplies"
        raise InputError(msg, hint="give moved supports a group of their own; 'concio path' moves them in a stage")
    if not np.abs(load).any():
        msg = f"the live load ({', '.join(groups)}) is zero"
        raise InputError(msg, hint="give the model a load in that group, for example horizontal = 1.0")
    return dead, load
