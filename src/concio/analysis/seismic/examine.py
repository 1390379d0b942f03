"""One mechanism, examined: its chain of forces, its capacity curve, its limits and checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Sequence as Several
from dataclasses import dataclass

import numpy as np

from concio.analysis.seismic.checks import Check, Displacement, checks_of, limit_of, onset_zeta
from concio.analysis.seismic.curve import CapacityCurve, follow, not_followed, straight
from concio.analysis.seismic.directions import Push
from concio.analysis.seismic.free_standing import FreeStanding, branch_of
from concio.analysis.seismic.linkage import Force, Linkage, merged
from concio.analysis.seismic.local_mechanism import LocalMechanism
from concio.analysis.seismic.macro_blocks import GROUND, Mechanics, carried
from concio.analysis.seismic.macro_contacts import contacts_of
from concio.analysis.seismic.participation import Chain, Participant, along_force, gathered
from concio.analysis.seismic.rocking_on import followed_on
from concio.analysis.seismic.sequence import Sequence, follow_in_steps
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.tie_history import together
from concio.analysis.seismic.weakest_mechanism import Found
from concio.contact.assembly import Assembly
from concio.contact.separate import surroundings
from concio.model.model import Tie

Array = np.ndarray
Control = tuple[str, tuple[float, ...]]

SAME = 1e-6
"""Relative difference below which the multipliers of the limit programme and of its linkage are the same."""

BARELY = 1e-3
"""Curves that end before this share of the size of the structure are not curves: other joints take over at once."""

REACHED = 0.9
"""A curve that is cut before it comes to this share of alpha_0 is none."""

STILL = 1e-6
"""A block whose rotation moves its points by less than this share of the fastest motion slides without turning."""

LONGER = 1e-9
"""Ties that get longer by less than this, as the control point moves by one, keep their length."""


@dataclass(frozen=True, eq=False)
class Terms:
    """On what terms mechanisms are checked: the arguments of an assessment that are common to all of them.

    Parameters
    ----------
    site : Site
    levels : tuple of str
    confidence : float
        FC.
    control : (body, point) or None
    limits : mapping
    curve : {"followed", "straight"}
    accept_linear : bool
        Whether the linear check decides where it is met.
    q : float or None
        Behaviour factor of the linear check; None for that of the code.
    participation : float or None
        e* of every mechanism; None for that of its chain.
    """

    site: Site
    levels: tuple[str, ...]
    confidence: float
    control: Control | None
    limits: Mapping[str, float]
    curve: str
    accept_linear: bool = False
    q: float | None = None
    participation: float | None = None

    def share(self, chain: Chain) -> float:
        """Return the e* that counts: that of a chain, or what the author has decided."""
        return chain.e_star if self.participation is None else self.participation


@dataclass(frozen=True, eq=False)
class Prepared:
    """A mechanism with all that is known before it is followed.

    Parameters
    ----------
    name : str
    push : Push
    assembly : Assembly
    found : Found
    dead, pushing : tuple of (str, Force)
    ties : tuple of (Tie, int, int)
        That join different macro-blocks.
    control : (body, point)
    linkage : Linkage or Sequence
    sequence : Sequence
    multiplier : float
        alpha_0, with ties as far as they pull together.
    motion : (G, 3 or 6) array
        For a control point that moves by one.
    chain : Chain
    unfollowed : CapacityCurve or None
        None where its linkage can be followed; else the empty curve that says why not.
    stretched : bool
        Whether ties get longer, so that motion begins before they pull with all they have.
    """

    name: str
    push: Push
    assembly: Assembly
    found: Found
    dead: tuple[tuple[str, Force], ...]
    pushing: tuple[tuple[str, Force], ...]
    ties: tuple[tuple[Tie, int, int], ...]
    control: Control
    linkage: Linkage | Sequence
    sequence: Sequence
    multiplier: float
    motion: Array
    chain: Chain
    unfollowed: CapacityCurve | None
    stretched: bool

    def level(self, site: Site) -> float:
        """Return the height at which the mechanism starts, above the base of the building [m]."""
        return self.linkage.mechanics.level - min((b.base for b in site.building if hasattr(b, "base")), default=0.0)

    def factor(self, terms: Terms) -> float:
        """Return spectral acceleration over alpha: g / (e* FC) [m/s2]."""
        return terms.site.rules.gravity / (terms.share(self.chain) * terms.confidence)

    def least(self, terms: Terms) -> dict[str, float]:
        """Return for each limit state a zeta_E that following the mechanism cannot fall below: that of its onset."""
        if self.stretched:
            return dict.fromkeys(terms.levels, 0.0)
        z, onset = self.level(terms.site), self.multiplier * self.factor(terms)
        return {level: onset_zeta(terms.site, level, z, onset) for level in terms.levels}


def prepared(assembly: Assembly, found: Found, push: Push, name: str, control: Control | None) -> Prepared:
    """Return a mechanism with its forces, its multiplier and its chain, in the plane as a linkage."""
    model, mechanics = assembly.model, found.mechanics
    assert mechanics is not None
    rest = [k for k in range(len(model.loads)) if k not in push.numbers]
    pushing = tuple((kind, Force(f.block, push.sign * f.force, f.point))
                    for kind, f in gathered(model, mechanics, push.numbers, push.origin))  # fmt: skip
    dead = tuple(gathered(model, mechanics, rest))
    total = np.sum([f.force for _, f in pushing], axis=0)
    along = total / float(np.linalg.norm(total))
    number = {b.name: i for i, b in enumerate(model.bodies)}

    def block_of(name: str) -> int:
        return mechanics.of_body.get(number.get(name, -1), GROUND)

    every = [(t, block_of(t.body_a), block_of(t.body_b)) for t in model.ties]
    ties = tuple((t, a, b) for t, a, b in every if a != b)
    chosen = _control_of(assembly, found, control, number, along, [f for _, f in pushing])
    block = mechanics.of_body[number[chosen[0]]]
    at = np.array(chosen[1], dtype=float)
    forces = merged([f for _, f in dead]), merged([f for _, f in pushing])
    alpha, motion = found.multiplier, np.array([b.motion for b in mechanics.blocks])
    contacts = contacts_of(assembly, mechanics, found.normal_force)
    sequence = Sequence(mechanics, contacts, *forces, ties, (block, at, along), model.engine)
    linkage: Linkage | Sequence = sequence
    unfollowed: CapacityCurve | None = not_followed("several motions")
    if model.dim == 2:
        linkage, alpha, motion, unfollowed = _as_linkage(mechanics, forces, ties, (block, at, along), alpha, motion)
    motion = motion / float(carried(motion[block], at - mechanics.blocks[block].centre) @ along)
    chain = Chain(
        tuple(Participant(f.block, kind, f.force, f.point, along_force(f, mechanics, motion)) for kind, f in pushing)
    )
    less, stretched = _not_together(mechanics, motion, ties, chain)
    return Prepared(
        name, push, assembly, found, dead, pushing, ties, (chosen[0], tuple(at.tolist())), linkage, sequence,
        alpha - less, motion, chain, unfollowed, stretched,
    )  # fmt: skip


def _not_together(
    mechanics: Mechanics, motion: Array, ties: Several[tuple[Tie, int, int]], chain: Chain
) -> tuple[float, bool]:
    """Return what alpha_0 loses as ties do not reach their strength together, and whether any gets longer."""
    rates = np.zeros(len(ties))
    for k, (tie, a, b) in enumerate(ties):
        ends = np.array([tie.at_a, tie.at_b], dtype=float)
        along = (ends[1] - ends[0]) / float(np.linalg.norm(ends[1] - ends[0]))
        speeds = [carried(motion[g], p - mechanics.blocks[g].centre) if g != GROUND else np.zeros(len(p))
                  for g, p in zip((a, b), ends, strict=True)]  # fmt: skip
        rates[k] = float((speeds[1] - speeds[0]) @ along)
    longer = [k for k in range(len(ties)) if rates[k] > LONGER]
    if not longer:
        return 0.0, False
    own = [ties[k][0] for k in longer]
    _, forces = together(own, rates[longer])
    strength = np.array([t.strength for t in own])
    if not np.isfinite(strength).all():  # such a tie keeps its length at the onset
        return 0.0, True
    return float((strength - forces) @ rates[longer]) / chain.sums[1], True


def examined(ready: Prepared, terms: Terms, element: FreeStanding | None = None) -> LocalMechanism:
    """Return a mechanism with its curves and checks."""
    model, site, levels = ready.assembly.model, terms.site, terms.levels
    alpha, chain, factor, z = ready.multiplier, ready.chain, ready.factor(terms), ready.level(site)
    followed, size = ready.unfollowed, surroundings(model).of(list(ready.sequence.mechanics.of_body))
    if followed is None:
        assert isinstance(ready.linkage, Linkage)
        followed = follow(ready.linkage)
        if not ready.ties:
            followed = followed_on(ready.linkage, followed)
    if all(site.rules.tables["levels"][level]["kind"] == "onset" for level in levels):
        followed = followed if followed.points else not_followed("not asked")
    elif not followed.points or followed.end < BARELY * size:
        steps = follow_in_steps(ready.sequence, alpha)
        followed = steps if steps.end >= BARELY * size else not_followed(steps.reason)
    if ready.stretched and followed.reason != "falls" and float(followed.multiplier.max()) < REACHED * alpha:
        followed = not_followed(followed.reason)  # cut before its ties pull: it tells nothing
    line = straight(alpha, followed.end) if followed.ends else None
    used = followed if terms.curve == "followed" else line
    start = alpha
    if ready.stretched and used is followed:  # ties pull only as they get longer
        start = max(min(alpha, float(followed.multiplier[0])), 0.0)
    branch = None
    if element is not None:
        along = ready.sequence.control[2]
        branch = branch_of(
            element, site.rules, model, ready.linkage.mechanics, along, used, onset=alpha * factor,
            spectral=chain.spectral, factor=factor,
        )  # fmt: skip
    reached: dict[str, Displacement] = {}
    checks: list[Check] = []
    for level in levels:
        rule = site.rules.tables["levels"][level]
        limit = None
        if used is not None and used.ends and rule["kind"] != "onset":
            given = followed.within(terms.limits.get(level, math.inf))
            limit = limit_of(level, rule, used, chain.spectral, factor, given, branch)
            reached[level] = limit
        checks += checks_of(site, level, z, onset=alpha * factor, limit=limit, branch=branch, start=start * factor,
                            q=terms.q)  # fmt: skip
    return LocalMechanism(
        name=ready.name, direction=ready.push.way, found=ready.found, assembly=ready.assembly, linkage=ready.linkage,
        chain=chain, dead=ready.dead, control=ready.control, level=z, multiplier=alpha, confidence=terms.confidence,
        factor=factor, followed=followed, straight=line, limits=reached, checks=tuple(checks),
        periods={level: site.at(level) for level in levels}, site=site, velocity=ready.motion.ravel(),
        branch=branch, accept_linear=terms.accept_linear, q=terms.q, e_star=terms.share(chain),
    )  # fmt: skip


def _as_linkage(
    mechanics: Mechanics,
    forces: tuple[tuple[Force, ...], tuple[Force, ...]],
    ties: Several[tuple[Tie, int, int]],
    control: tuple[int, Array, Array],
    alpha: float,
    motion: Array,
) -> tuple[Linkage, float, Array, CapacityCurve | None]:
    """Return a plane mechanism as a linkage, with its multiplier, motion (G, 3), and why it is not to be followed."""
    bars = [j.point for j in mechanics.joints if j.kind == "bar"]
    free = tuple(t for t in ties if not any(np.array_equal(p, np.array(t[0].at_a)) for p in bars))
    linkage = Linkage(mechanics, *forces, free, control).set_back()
    still = np.zeros((len(mechanics.blocks), 3))
    onset = linkage.balance(still, plastic=True) if linkage.freedom == 1 else None
    if onset is None:
        return linkage, alpha, motion, not_followed("several motions" if linkage.freedom != 1 else "no forces")
    if any(j.inward is not None for j in mechanics.joints):
        alpha = onset.multiplier
    if abs(onset.multiplier - alpha) > SAME * abs(alpha):  # of a dilatant motion: joints that slide do not stay closed
        return linkage, alpha, motion, not_followed("no forces")
    return linkage, alpha, linkage.velocity(still).reshape(-1, 3), None


def _control_of(
    assembly: Assembly,
    found: Found,
    control: Control | None,
    number: Mapping[str, int],
    along: Array,
    pushing: Several[Force],
) -> Control:
    """Return the control point: the one given where it moves, else the corner that moves fastest, furthest out.

    Where that slides without turning all of its points move alike: it is the centroid of what pushes it.
    """
    assert found.mechanics is not None
    mechanics = found.mechanics
    top = float(np.abs(found.velocity).max())

    def speed(b: int, point: Array) -> float:
        return float(mechanics.blocks[mechanics.of_body[b]].velocity(point) @ along)

    if control is not None and number[control[0]] in mechanics.of_body:
        point = np.array(control[1], dtype=float)
        if speed(number[control[0]], point) > 1e-6 * top:
            return control
    corners = [
        (speed(b, v), float(v[-1]), float(v @ along), assembly.model.bodies[b].name, tuple(v.tolist()))
        for b in mechanics.of_body
        for v in np.asarray(assembly.model.bodies[b].vertices)
    ]
    fastest = max(c[0] for c in corners)
    best = max((c for c in corners if c[0] >= (1 - 1e-6) * fastest), key=lambda c: (round(c[1], 9), round(c[2], 9)))
    block = mechanics.of_body[number[best[3]]]
    own = [f for f in pushing if f.block == block]
    turns = float(np.abs(mechanics.blocks[block].motion[len(along) :]).max())
    if not own or turns * mechanics.reach([np.array(c[4]) for c in corners]) > STILL * top:
        return best[3], best[4]
    size = np.array([math.hypot(*f.force) for f in own])
    point = size @ np.array([f.point for f in own]) / size.sum()
    bodies = [assembly.model.bodies[b] for b, g in mechanics.of_body.items() if g == block]
    return min(bodies, key=lambda b: (round(math.dist(b.centroid, point), 9), b.name)).name, tuple(point.tolist())
