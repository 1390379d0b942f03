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

from concio.analysis.limit import UNASKED_WORK, search_collapse
from concio.analysis.seismic.macro_blocks import Mechanics, mechanics_of
from concio.arguments import closest
from concio.contact.assembly import Assembly
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.collapse_search import WORK_OF_ALL
from concio.solvers.statics.existence import find_mechanism
from concio.solvers.statics.limit import LimitLoad, associated_limit

Array = np.ndarray

LARGEST = 2.0
"""Multipliers above this are no mechanism of an earthquake: the push would be more than twice the weight."""


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
    """

    associated: LimitLoad
    multiplier: float
    flow: str
    velocity: Array
    normal_force: Array
    mechanics: Mechanics | None
    moving: tuple[int, ...] | None = None

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
            msg = f"'{word}' is no body that can move, no role and no layer"
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
    found = _found(assembly, tuple(live), moving, sign)
    return replace(found, moving=None if moving is None else tuple(moving))


def _found(assembly: Assembly, groups: tuple[str, ...], moving: Sequence[int] | None, sign: float) -> Found:
    whole = assembly.problem(dict.fromkeys(groups, 0.0))
    whole = replace(whole, laws=replace(whole.laws, tension=np.zeros(whole.pairs)))
    push = sign * (assembly.problem(dict.fromkeys(groups, 1.0)).f - whole.f)
    columns, rows, problem = _held(whole, moving)
    push = push[columns]
    falling = find_mechanism(problem)
    if falling is not None:
        msg = "it does not stand under its own weight and whatever else is dead: a mechanism proves it"
        raise NoEquilibriumError(msg, hint="look at 'concio run': supports, thrusts and ties without the earthquake")
    bound = associated_limit(problem, push)
    if bound.mechanism is None or not np.isfinite(bound.multiplier):
        return Found(bound, np.inf, "no sliding", np.zeros(assembly.disc.unknowns), np.zeros(whole.pairs), None)

    def spread(v: Array, t_n: Array) -> tuple[Array, Array]:
        every, forces = np.zeros(whole.unknowns), np.zeros(whole.pairs)
        every[columns], forces[rows] = v, t_n
        return assembly.supported.T @ every, forces

    velocity, forces = spread(bound.mechanism.velocity, bound.normal_force)
    mechanics = mechanics_of(assembly, velocity, forces)
    if not mechanics.slides:
        return Found(bound, bound.multiplier, "no sliding", velocity, forces, mechanics)
    state, _ = search_collapse(problem, push, work=WORK_OF_ALL if problem.dim == 2 else UNASKED_WORK)
    if state is None:
        return Found(bound, bound.multiplier, "associated", velocity, forces, mechanics)
    velocity, forces = spread(state.velocity, state.normal_force)
    return Found(bound, state.multiplier, "Coulomb", velocity, forces, mechanics_of(assembly, velocity, forces))


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
            slip_origin=problem.slip_origin[rows], area=problem.area[rows], inertia=problem.inertia[columns], load=0.0,
        ),
    )  # fmt: skip
