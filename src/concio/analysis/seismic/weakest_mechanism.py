"""The weakest mechanism of a model, or of some of its bodies while the others stand: limit analysis, both flows.

The *associated* programme finds the least multiplier over all motions, with a proof from both sides. Where no rough
joint slides in it, it is the multiplier of Coulomb friction too. Where one does, joints would have to open as they
slide; a certified Coulomb collapse state without dilatancy is looked for then, and its multiplier, which is smaller, is
the one that counts. Joints have no tensile strength here, as the codes have it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

import numpy as np
import scipy.sparse as sp

from concio.analysis.seismic.ends_of_joints import Ends, ends_of_joints
from concio.analysis.seismic.macro_blocks import Mechanics, mechanics_of
from concio.arguments import closest
from concio.contact.assembly import Assembly
from concio.errors import InputError, NoEquilibriumError
from concio.fem.discretisation import RIGID
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.limits_of_work import COLLAPSE_WORK, LARGEST_SEARCH, UNASKED_WORK
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from concio.solvers.statics.collapse_search import Tried, find_collapse_state
from concio.solvers.statics.collapse_state import CollapseState, Motion, certify_collapse, judged
from concio.solvers.statics.existence import find_mechanism, statically_admissible
from concio.verdict.not_standing import BY_A_MECHANISM, of_the_joints

Array = np.ndarray

LARGEST = 2.0
"""Multipliers above this are no mechanism of an earthquake: the push would be more than twice the weight."""

FEW = 6
"""Programmes from one start where a mechanism is to be met, not settled."""


BED = 0.5
"""Joints whose normal is more upright than this press under the weight of what stands on them."""


@dataclass(frozen=True, eq=False)
class Found:
    """The weakest mechanism among those in which only some bodies move.

    Parameters
    ----------
    associated : LimitLoad
        With its proof.
    multiplier : float
        alpha_0 that counts: Coulomb's where a joint slides and its state was found, else the associated one; ``inf``
        where nothing can move.
    flow : str
        "no sliding", "Coulomb", or "associated": an upper bound, for a joint slides and no Coulomb state was found.
    velocity : (N_all,) array
        Largest entry 1.
    normal_force : (m,) array
        [kN].
    mechanics : Mechanics or None
        None where nothing can move.
    moving : tuple of int or None
        Bodies that were let move; None for all.
    needs_friction : bool
        Of what is locked: whether only friction holds it, so that the associated programme, in which joints open as
        they slide, does not show what Coulomb friction holds.
    state : CollapseState or None
        That of Coulomb friction whose multiplier counts, of the bodies that were let move.
    """

    associated: LimitLoad
    multiplier: float
    flow: str
    velocity: Array
    normal_force: Array
    mechanics: Mechanics | None
    moving: tuple[int, ...] | None = None
    needs_friction: bool = False
    state: CollapseState | None = None

    @property
    def locked(self) -> bool:
        """True where no push is the last."""
        return self.mechanics is None


def chosen_bodies(model: Model, name: str, wanted: Sequence[str] | Mapping[str, float]) -> tuple[int, ...]:
    """Return the numbers of the bodies that a mechanism is sought among.

    Parameters
    ----------
    model : Model
    name : str
        Of the mechanism, for messages.
    wanted : sequence of str, or mapping
        Names (with ``*`` for any letters), roles or layers; empty for all bodies; ``{"above": 3.0}`` or ``{"below":
        3.0}`` for those whose centroid lies there [m].

    Raises
    ------
    InputError
        A word fits no body that can move.
    """
    bodies = model.bodies
    free = [i for i, b in enumerate(bodies) if b.kind != "fixed"]
    where = f"mechanism '{name}'"
    if isinstance(wanted, Mapping):
        for key in wanted:
            if key not in ("above", "below"):
                msg = f"unknown key '{key}'"
                raise InputError(msg, where=where, hint=closest(key, ("above", "below")))
        low, high = float(wanted.get("above", -np.inf)), float(wanted.get("below", np.inf))
        chosen = [i for i in free if low < float(bodies[i].centroid[-1]) < high]
        if not chosen:
            msg = "no body that can move lies there"
            raise InputError(msg, where=where, hint="heights are in m, those of the centroids of the bodies")
        return tuple(chosen)
    found: set[int] = set()
    for word in wanted:
        fitting = [i for i in free if fnmatchcase(bodies[i].name, word) or word in (bodies[i].role, bodies[i].layer)]
        if not fitting:
            msg = f"'{word}' is not a body that can move, no role and no layer"
            known = dict.fromkeys(w for i in free for w in (bodies[i].role, bodies[i].layer, bodies[i].name) if w)
            raise InputError(msg, where=where, hint=closest(word, known))
        found |= set(fitting)
    return tuple(sorted(found)) if wanted else tuple(free)


def find(assembly: Assembly, live: Iterable[str], moving: Sequence[int] | None = None, sign: float = 1.0) -> Found:
    """Return the weakest mechanism under a push.

    Parameters
    ----------
    assembly : Assembly
    live : iterable of str
        Load groups that push.
    moving : sequence of int, optional
        Bodies that may move; all others are held.
    sign : {1, -1}
        Which way they push.

    Raises
    ------
    NoEquilibriumError
        The bodies do not stand under their own weight.
    """
    return Mechanisms(assembly, tuple(live), sign).find(moving)


class Mechanisms:
    """Finds mechanisms of an assembly under one push: the weakest of all, and those of parts of it.

    Parameters
    ----------
    assembly : Assembly
    groups : tuple of str
        Load groups that push.
    sign : {1, -1}
        Which way they push.
    """

    def __init__(self, assembly: Assembly, groups: tuple[str, ...], sign: float) -> None:
        self.assembly = assembly
        whole = assembly.problem(dict.fromkeys(groups, 0.0))
        self.whole = replace(whole, laws=replace(whole.laws, tension=np.zeros(whole.pairs)))
        self.push = sign * (assembly.problem(dict.fromkeys(groups, 1.0)).f - whole.f)
        self.ends = ends_of_joints(self.whole, assembly.pairs)
        self.stands: set[tuple[int, ...] | None] = set()

    def find(self, moving: Sequence[int] | None = None, *, quick: bool = False) -> Found:
        """Return the weakest mechanism in which only some bodies move.

        Parameters
        ----------
        moving : sequence of int, optional
            Bodies that may move; all others are held.
        quick : bool
            Whether collapse states are looked for with few programmes, from the forces that hold up the weight alone as
            well as from those of the associated limit: enough to meet another mechanism, not to settle its multiplier.

        Raises
        ------
        NoEquilibriumError
            The bodies do not stand under their own weight.
        """
        chosen = None if moving is None else tuple(moving)
        part = self._part(chosen)
        self._check_stands(part.problem, chosen)
        return replace(self._found(part, quick=quick), moving=chosen)

    def sliding(self, moving: Sequence[int], along: Array) -> Found | None:
        """Return the mechanism in which some bodies slide together along a push, all others held; None if none is.

        Parameters
        ----------
        moving : sequence of int
        along : (d,) array
            Horizontal unit vector of the push.
        """
        chosen, disc, T = tuple(moving), self.assembly.disc, self.assembly.supported.T
        every = np.zeros(disc.unknowns)
        for b in chosen:
            own = every[disc.offsets[b] : disc.offsets[b + 1]]
            rigid = disc.shape_of[b] == RIGID
            own[:] = np.append(along, np.zeros(len(own) - len(along))) if rigid else np.resize(along, len(own))
        velocity = T.T @ every
        if not np.allclose(T @ velocity, every, rtol=0.0, atol=1e-9):  # a support holds one of them
            return None
        part = self._part(chosen)
        bound = associated_limit(part.problem, part.push)
        state = certify_collapse(part.problem, part.push, velocity[part.columns], 0)
        return None if state is None else replace(self._of_state(part, bound, state), moving=chosen)

    def _part(self, chosen: tuple[int, ...] | None) -> _Part:
        """Return the bodies that may move, with the pairs at the ends of their joints."""
        columns, rows, problem = _held(self.whole, chosen)
        ends = self.ends.of(rows)
        return _Part(columns, rows, problem, ends, _of_pairs(problem, np.flatnonzero(ends.needed)), self.push[columns])

    def loaded(self, moving: Sequence[int] | None = None) -> tuple[ContactProblem, Array]:
        """Return the problem in which only some bodies may move, under the constant loads, and the push on them."""
        columns, _, problem = _held(self.whole, None if moving is None else tuple(moving))
        return problem, self.push[columns]

    def _check_stands(self, problem: ContactProblem, moving: tuple[int, ...] | None) -> None:
        """Raise where the bodies fall without a push; what stands as a whole stands in parts."""
        if None in self.stands or moving in self.stands:
            return
        if find_mechanism(problem) is not None:
            msg = f"it does not stand under its own weight and the other constant loads: {BY_A_MECHANISM}"
            hint = "look at 'concio run': supports, thrusts and ties without the earthquake"
            raise NoEquilibriumError(of_the_joints(msg, self.assembly.detection), hint=hint)
        self.stands.add(moving)

    def _found(self, part: _Part, *, quick: bool) -> Found:
        bound = associated_limit(part.problem, part.push)
        if bound.mechanism is None or not np.isfinite(bound.multiplier):
            return self._locked(part, bound)
        velocity, forces = self._spread(part, bound.mechanism.velocity, bound.normal_force, bound.friction_force)
        mechanics = mechanics_of(self.assembly, velocity, forces)
        if not mechanics.slides:
            return Found(bound, bound.multiplier, "no sliding", velocity, forces, mechanics)
        state = self._state(part, bound, quick=quick)
        if state is None:
            return Found(bound, bound.multiplier, "associated", velocity, forces, mechanics)
        return self._of_state(part, bound, state)

    def _state(self, part: _Part, bound: LimitLoad, *, quick: bool) -> CollapseState | None:
        """Return the least collapse state met from several starts; None where none is."""
        problem, push = part.problem, part.push
        if problem.pairs > LARGEST_SEARCH:
            return None
        beds = np.abs(self.assembly.pairs.normal[part.rows[part.ends.needed]][:, -1]) > BED
        tried: Tried = {}
        found = _quickly(problem, push, bound, beds, tried, alone=quick)
        if not quick:
            work = COLLAPSE_WORK if problem.dim == 2 else UNASKED_WORK
            starts = None if problem.dim == 2 else 1
            found.append(find_collapse_state(problem, push, starts=starts, work=work, bound=bound, tried=tried).state)
        return min((s for s in found if s is not None), key=lambda s: s.multiplier, default=None)

    def _of_state(self, part: _Part, bound: LimitLoad, state: CollapseState) -> Found:
        state = part.with_every_pair(state)
        every, forces = self._everywhere(part, state.velocity, state.normal_force)
        made = mechanics_of(self.assembly, every, forces)
        return Found(bound, state.multiplier, "Coulomb", every, forces, made, state=state)

    def _locked(self, part: _Part, bound: LimitLoad) -> Found:
        """Return what happens to a push of which the associated programme carries any multiple.

        Without friction that is the last word: no motion that joints allow gains work, with whatever friction. With
        friction it is none, for Coulomb's joints do not open as they slide; collapse states are looked for then.
        """
        problem, zero = part.problem, np.zeros(part.problem.pairs)
        bare = replace(problem, laws=replace(problem.laws, friction=zero, dilatancy=zero, cohesion=zero))
        nothing = Found(bound, np.inf, "no sliding", np.zeros(self.assembly.disc.unknowns), np.zeros(self.whole.pairs),
                        None)  # fmt: skip
        if np.isnan(bound.multiplier) or associated_limit(bare, part.push).locked:
            return nothing
        begin = replace(bound, multiplier=LARGEST)
        state = find_collapse_state(problem, part.push, bound=begin).state
        if state is None:
            return replace(nothing, needs_friction=True)
        return self._of_state(part, bound, state)

    def _spread(self, part: _Part, v: Array, t_n: Array, t_t: Array) -> tuple[Array, Array]:
        """Return velocity (N_all,) and normal forces (m,) of the whole, from those at the ends of joints of a part."""
        return self._everywhere(part, v, part.spread(t_n, t_t)[0])

    def _everywhere(self, part: _Part, v: Array, t_n: Array) -> tuple[Array, Array]:
        """Return the velocity (N_all,) and the normal forces (m,) of the whole that those of a part are."""
        every, forces = np.zeros(self.whole.unknowns), np.zeros(self.whole.pairs)
        every[part.columns], forces[part.rows] = v, t_n
        return self.assembly.supported.T @ every, forces


@dataclass(frozen=True, eq=False)
class _Part:
    """Bodies that may move: their unknowns and pairs, the problem of all pairs, and that of those at ends of joints."""

    columns: Array
    rows: Array
    whole: ContactProblem
    ends: Ends
    problem: ContactProblem
    push: Array

    def spread(self, t_n: Array, t_t: Array) -> tuple[Array, Array]:
        """Return forces of all pairs, from those at the ends of joints."""
        every, across = np.zeros(self.whole.pairs), np.zeros((self.whole.pairs, t_t.shape[1]))
        every[self.ends.needed], across[self.ends.needed] = t_n, t_t
        return self.ends.spread(every, across)

    def with_every_pair(self, state: CollapseState) -> CollapseState:
        """Return a state with the forces of all pairs, its residuals those of the whole problem."""
        if self.ends.needed.all():
            return state
        t_n, t_t = self.spread(state.normal_force, state.friction_force)
        motion = Motion.of(self.whole, state.velocity)
        found = judged(self.whole, self.push, motion, state.multiplier, t_n, t_t, state.iterations)
        if found.certified:
            return found
        t_n, t_t = np.zeros_like(t_n), np.zeros_like(t_t)  # as it was found: none between the ends
        t_n[self.ends.needed], t_t[self.ends.needed] = state.normal_force, state.friction_force
        return judged(self.whole, self.push, motion, state.multiplier, t_n, t_t, state.iterations)


def _quickly(
    problem: ContactProblem, push: Array, bound: LimitLoad, beds: Array, tried: Tried, *, alone: bool
) -> list[CollapseState | None]:
    """Return collapse states met with few programmes, from forces that hold up the weight alone.

    Once as they are, and once without those of vertical joints, ``beds`` (m,) being the others: courses of dry blocks
    press on each other, not sideways, and what only the friction of vertical joints holds is met from there. In the
    plane also from the forces of the associated limit, unless a whole search, which begins there, comes after.
    """
    dead = statically_admissible(problem)
    starts = [dead.normal_force, np.where(beds, dead.normal_force, 0.0)] if dead.exists else []
    if (problem.dim == 2 and alone) or not starts:
        starts.append(bound.normal_force)
    return [
        find_collapse_state(
            problem, push, starts=1, iterations=FEW, bound=replace(bound, normal_force=forces), tried=tried
        ).state
        for forces in starts
    ]


def _of_pairs(problem: ContactProblem, chosen: Array) -> ContactProblem:
    """Return the problem with some of its pairs alone."""
    if chosen.size == problem.pairs:
        return problem
    s = problem.dim - 1
    every = (chosen[:, None] * s + np.arange(s)).ravel()
    return replace(
        problem, C_n=sp.csr_array(problem.C_n[chosen]), C_t=sp.csr_array(problem.C_t[every]), gap=problem.gap[chosen],
        laws=problem.laws[chosen], slip_origin=problem.slip_origin[chosen], area=problem.area[chosen],
    )  # fmt: skip


def _held(problem: ContactProblem, moving: Sequence[int] | None) -> tuple[Array, Array, ContactProblem]:
    """Return the unknowns and the pairs that are left when other bodies are held, and the problem in them."""
    if moving is None:
        return np.arange(problem.unknowns), np.arange(problem.pairs), problem
    columns = np.concatenate([np.arange(problem.bodies[b], problem.bodies[b + 1]) for b in moving])
    C_n, C_t = sp.csc_array(problem.C_n)[:, columns], sp.csc_array(problem.C_t)[:, columns]
    s = problem.dim - 1
    touched = abs(C_n).sum(axis=1) + abs(C_t).sum(axis=1).reshape(-1, s).sum(axis=1)
    rows = np.flatnonzero(touched > 0)
    every = (rows[:, None] * s + np.arange(s)).ravel()
    R = sp.csc_array(sp.csr_array(problem.R)[columns])
    R = sp.csc_array(R[:, np.flatnonzero(abs(R).sum(axis=0) > 0)])
    sizes = [int(problem.bodies[b + 1] - problem.bodies[b]) for b in moving]
    return (
        columns,
        rows,
        replace(
            problem, K=sp.csr_array(sp.csc_array(problem.K)[:, columns].tocsr()[columns]), f=problem.f[columns],
            C_n=sp.csr_array(C_n.tocsr()[rows]), C_t=sp.csr_array(C_t.tocsr()[every]), gap=problem.gap[rows],
            laws=problem.laws[rows], R=R, bodies=np.concatenate([[0], np.cumsum(sizes)]),
            slip_origin=problem.slip_origin[rows], area=problem.area[rows],
            inertia=problem.inertia[columns][:, columns], load=0.0,
        ),
    )  # fmt: skip
