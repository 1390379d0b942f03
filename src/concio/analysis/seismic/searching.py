"""The search for mechanisms: whole, named, and in parts; what of all that is followed, and what is the weakest.

What is called the weakest of all has the least multiplier of everything that was found for its push: it is never above
a mechanism that was named, nor above one that was met in a part of the structure. A mechanism of a part is followed
unless its onset alone shows that it cannot be what decides: what does not begin to move before others have failed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from concio.analysis.seismic.coverage import Covered, Sought, covered, motion_of
from concio.analysis.seismic.default_parts import Part, parts_of
from concio.analysis.seismic.directions import Push
from concio.analysis.seismic.examine import Prepared, Terms, examined, prepared
from concio.analysis.seismic.free_standing import FreeStanding
from concio.analysis.seismic.local_mechanism import LocalMechanism, NoMechanism
from concio.analysis.seismic.sliding_parts import sliding_parts
from concio.analysis.seismic.weakest_mechanism import LARGEST, Found, Mechanisms
from concio.contact.assembly import Assembly
from concio.errors import NoEquilibriumError, SolverError
from concio.problem.solution import Progress, ProgressCallback
from concio.solvers.statics.associated_limit import LimitLoad

EVERY = "weakest of all"
"""Name of the mechanism of least multiplier, sought among all motions and in all parts."""

ALL_FREE = "all blocks free"
"""Name of what the search among all motions ended at, where a part of the structure is weaker."""

SAME = 1e-6
"""Multipliers that differ by less, relative, are those of one mechanism where the same bodies move."""


@dataclass(frozen=True, eq=False)
class Search:
    """One push with the assembly it acts on."""

    push: Push
    assembly: Assembly

    @property
    def along(self) -> np.ndarray:
        """Unit vector (d,) of the push."""
        total = np.sum([force for force, _ in self.push.by_group().values()], axis=0)
        found: np.ndarray = total / (float(np.linalg.norm(total)) or 1.0)
        return found


@dataclass(frozen=True, eq=False)
class Searched:
    """What all searches found.

    Parameters
    ----------
    shown : tuple of LocalMechanism
        The weakest of each push, the named ones, and those of parts that decide something; by zeta_E.
    others : tuple of LocalMechanism
        Mechanisms of parts that were followed and decide nothing.
    late : tuple of (str, float)
        Parts whose mechanism begins to move too late to be followed, and the height at which it starts [m].
    locked : tuple of NoMechanism
    sought : int
        Searches made.
    parts : tuple of str
        Names of the parts that were searched.
    places : mapping of str to (int, int)
        For "levels", "openings" (lines of them), "returns" (faces of them) and "changes": how many were sought at, and
        how many there are, over all pushes.
    bounds : mapping of str to LimitLoad
        For each way of pushing the associated limit over all motions.
    covered : tuple of Covered
        What was covered, kind by kind.
    """

    shown: tuple[LocalMechanism, ...]
    others: tuple[LocalMechanism, ...]
    late: tuple[tuple[str, float], ...]
    locked: tuple[NoMechanism, ...]
    sought: int
    parts: tuple[str, ...]
    places: Mapping[str, tuple[int, int]]
    bounds: Mapping[str, LimitLoad]
    covered: tuple[Covered, ...]


class _Teller:
    """Tells the callback of each search and each curve."""

    def __init__(self, progress: ProgressCallback | None, steps: int) -> None:
        self.progress, self.steps, self.done = progress, steps, 0

    def tell(self, what: str) -> None:
        """Tell what is done next.

        Raises
        ------
        SolverError
            The callback asked to stop.
        """
        left = 1.0 - min(self.done / self.steps, 1.0)
        if self.progress is not None and self.progress(Progress("assessment", self.done, left, what)):
            msg = "the assessment was stopped on request"
            raise SolverError(msg, hint="nothing was written")
        self.done += 1


def search_all(
    searches: list[Search],
    named: Mapping[str, tuple[int, ...]],
    terms: Terms,
    elements: Mapping[str, FreeStanding],
    progress: ProgressCallback | None = None,
) -> Searched:
    """Search every push: whole, named bodies, parts; follow what may decide.

    Parameters
    ----------
    searches : list of Search
    named : mapping of str to tuple of int
        Bodies that move, by the name of their mechanism.
    terms : Terms
    elements : mapping of str to FreeStanding
    progress : callable, optional

    Raises
    ------
    NoEquilibriumError
        The model does not stand without an earthquake.
    SolverError
        The callback asked to stop.
    """
    cuts = [parts_of(s.assembly, s.along) for s in searches]
    parts = [c.parts for c in cuts]
    teller = _Teller(progress, sum(2 * (1 + len(named)) + len(p) for p in parts))
    shown: list[LocalMechanism] = []
    locked: list[NoMechanism] = []
    waiting: list[Prepared] = []
    bounds: dict[str, LimitLoad] = {}
    records: list[Sought] = []
    for search, own in zip(searches, parts, strict=True):
        ready, none, candidates, bounds[search.push.way] = _of_push(search, named, own, terms, teller, records)
        locked += none
        waiting += candidates
        for one in ready:
            teller.tell(f"{one.name}, push {search.push.way}: followed")
            shown.append(examined(one, terms, elements.get(one.name)))
    followed, late = _followed(waiting, shown, terms, teller)
    deciding = [m for m in followed if _decides(m, shown)]
    others = tuple(m for m in followed if m not in deciding)
    ranked = sorted([*shown, *deciding], key=lambda m: (m.zeta, m.least, m.multiplier))
    names = tuple(dict.fromkeys(p.name for own in parts for p in own))
    sought = sum(1 + len(named) + len(own) for own in parts)
    kinds = dict.fromkeys(kind for c in cuts for kind in c.there)
    places = {kind: (sum(c.sought.get(kind, 0) for c in cuts), sum(c.there.get(kind, 0) for c in cuts))
              for kind in kinds}  # fmt: skip
    what = covered(records, places)
    return Searched(tuple(ranked), others, late, tuple(locked), sought, names, places, bounds, what)


def _of_push(
    search: Search, named: Mapping[str, tuple[int, ...]], parts: tuple[Part, ...], terms: Terms, teller: _Teller,
    records: list[Sought],
) -> tuple[list[Prepared], list[NoMechanism], list[Prepared], LimitLoad]:  # fmt: skip
    """Return of one push: the mechanisms to follow, what gave none, those of parts, and the bound of all motions."""
    way, assembly = search.push.way, search.assembly
    seek = Mechanisms(assembly, search.push.groups, search.push.sign)
    every: dict[str, Found] = {}
    for name, moving in ((EVERY, None), *named.items()):
        teller.tell(f"{name}, push {way}: sought")
        try:
            every[name] = seek.find(moving)
        except NoEquilibriumError as error:
            raise NoEquilibriumError(error.what, where=None if name == EVERY else name, hint=error.hint) from None
    met: dict[str, Found] = {}
    for part in parts:
        teller.tell(f"{part.name}, push {way}: sought")
        met[part.name] = seek.find(part.bodies, quick=part.kind != "alone")  # a structure is a model of its own
    records += [Sought("whole" if n == EVERY else "named", n, way, f.multiplier, motion_of(f, search.along))
                for n, f in every.items()]  # fmt: skip
    records += [Sought(p.what, p.name, way, met[p.name].multiplier, motion_of(met[p.name], search.along))
                for p in parts]  # fmt: skip
    candidates = {n: f for n, f in met.items() if not f.locked and f.multiplier <= LARGEST and f.flow != "associated"}
    sure = [f for n, f in (*every.items(), *candidates.items()) if not f.locked and f.flow != "associated"]
    least = min([*sure, every[EVERY]], key=lambda f: f.multiplier)
    if every[EVERY].flow == "associated" and sure:
        least = min(sure, key=lambda f: f.multiplier)
    whole, every[EVERY] = every[EVERY], least
    if whole is not least and not whole.locked and whole.multiplier <= LARGEST and whole.flow != "associated":
        candidates[ALL_FREE] = whole
    ready: list[Prepared] = []
    none: list[NoMechanism] = []
    for name, found in every.items():
        if found.locked or found.multiplier > LARGEST:
            doubtful = found.needs_friction or found.flow == "associated"
            none.append(NoMechanism(name, way, found.multiplier, doubtful))
        else:
            ready.append(prepared(assembly, found, search.push, name, terms.control))
    candidates |= _sliding(search, seek, (*every.values(), *candidates.values()), teller)
    waiting: list[Prepared] = []
    for name, found in candidates.items():
        if not any(_alike(found, other) for other in (*every.values(), *(w.found for w in waiting))):
            waiting.append(prepared(assembly, found, search.push, name, None))
    return ready, none, waiting, whole.associated


def _sliding(search: Search, seek: Mechanisms, known: tuple[Found, ...], teller: _Teller) -> dict[str, Found]:
    """Return the least parts that slide, where a mechanism slides: those that begin to at its multiplier."""
    slides = [f.multiplier for f in known if f.mechanics is not None and f.mechanics.slides and f.flow != "associated"]
    found: dict[str, Found] = {}
    parts = sliding_parts(search.assembly, search.along) if slides else {}
    for bodies, name in parts.items():
        teller.tell(f"{name}, push {search.push.way}: sought")
        one = seek.sliding(bodies, search.along)
        if one is not None and any(abs(one.multiplier - at) <= SAME * abs(at) for at in slides):
            found[name] = one
    return found


def _alike(a: Found, b: Found) -> bool:
    """Return whether two searches met the same mechanism."""
    if a.mechanics is None or b.mechanics is None:
        return False
    near = abs(a.multiplier - b.multiplier) <= SAME * max(abs(a.multiplier), abs(b.multiplier))
    return near and a.mechanics.of_body == b.mechanics.of_body


def _followed(
    waiting: list[Prepared], shown: list[LocalMechanism], terms: Terms, teller: _Teller
) -> tuple[list[LocalMechanism], tuple[tuple[str, float], ...]]:
    """Follow mechanisms of parts, the lowest onset first; return them, and what begins to move too late to decide."""
    best = {level: min((m.zeta_at(level) for m in shown), default=np.inf) for level in terms.levels}
    found, late = [], dict[tuple[str, float], None]()
    onsets = [one.least(terms) for one in waiting]
    for k in sorted(range(len(waiting)), key=lambda k: min(onsets[k].values())):
        one, onset = waiting[k], onsets[k]
        if all(onset[level] >= best[level] for level in terms.levels):
            late[one.name, one.level(terms.site)] = None
            continue
        teller.tell(f"{one.name}, push {one.push.way}: followed")
        made = examined(one, terms)
        found.append(made)
        for level in terms.levels:
            best[level] = min(best[level], made.zeta_at(level))
    return found, tuple(late)


def _decides(m: LocalMechanism, shown: list[LocalMechanism]) -> bool:
    """Return whether a mechanism is worse than those shown at some limit state, or could not be checked at one."""
    if not m.complete:
        return True
    return any(m.zeta_at(level) < min((s.zeta_at(level) for s in shown), default=np.inf) for level in m.periods)
