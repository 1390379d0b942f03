"""Seismic assessment of the local mechanisms of a model: the weakest ones are found, followed, and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Sequence as Several
from typing import Any, Literal

import numpy as np

from concio.analysis.engine import by_its_engine
from concio.analysis.seismic.applied import pushes_sideways
from concio.analysis.seismic.assessment import Assessment, LocalMechanism, NoMechanism
from concio.analysis.seismic.chain import Chain, Participant, gathered
from concio.analysis.seismic.checks import Displacement, checks_of, limit_of
from concio.analysis.seismic.curve import CapacityCurve, follow, not_followed, straight
from concio.analysis.seismic.directions import Direction, pushes
from concio.analysis.seismic.free_standing import FreeStanding, branch_of, elements_of
from concio.analysis.seismic.linkage import Force, Linkage
from concio.analysis.seismic.macro_blocks import GROUND, Mechanics, carried
from concio.analysis.seismic.mechanism import LARGEST, Found, chosen_bodies, find
from concio.analysis.seismic.placed import contacts_of
from concio.analysis.seismic.sequence import Sequence, follow_in_steps
from concio.analysis.seismic.site import STRONG, Site
from concio.arguments import closest, strict
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError, NoEquilibriumError, SolverError
from concio.model.model import Model, Tie, require_model
from concio.problem.solution import Progress, ProgressCallback

Array = np.ndarray
Control = tuple[str, tuple[float, ...]]

LIVE = "live"
EVERY = "weakest of all"
"""Name of the mechanism that is sought among all motions."""

SAME = 1e-6
"""Relative difference below which the multipliers of the limit programme and of its linkage are the same."""

BARELY = 1e-3
"""Curves that end before this share of the size of the mechanism are no curves: other joints take over at once."""


@strict
@by_its_engine
def assess(
    model: Model,
    *,
    site: Site,
    levels: Several[str] | None = None,
    mechanisms: Mapping[str, Several[str] | Mapping[str, float]] | None = None,
    direction: Direction | None = None,
    live: str | Several[str] | None = None,
    knowledge: str = "LC1",
    confidence: float | None = None,
    control: Control | None = None,
    limits: Mapping[str, float] | None = None,
    curve: Literal["followed", "straight"] = "followed",
    free_standing: Mapping[str, FreeStanding | Mapping[str, Any]] | None = None,
    progress: ProgressCallback | None = None,
) -> Assessment:
    """Find the local mechanisms of a model and check them against the demand of a site.

    Parameters
    ----------
    model : Model
        In the plane a facade in its plane, or a vertical strip of a wall; in space walls with returns and corners.
    site : Site
        Hazard, soil, code.
    levels : sequence of str, optional
        Limit states; by default all whose hazard is known.
    mechanisms : mapping, optional
        Beside the weakest mechanism of all: for each name the bodies that move while all others stand: their names
        (``*`` stands for any letters), roles or layers, or ``{"above": 3.0}`` for those whose centroid lies there.
    direction : str, or (x, y) in space
        Which way the earthquake pushes: in the plane "right", "left" or "both", by default both; in space "+x", "-x",
        "+y", "-y", "both" (along x), "all" or a horizontal vector, by default all four. Where ``live`` is given, in the
        plane "left" is against it; in space both ways along it are looked at.
    live : str or sequence of str, optional
        Load groups that push, for a multiplier of one. By default "live" where the model has such a group and it
        pushes sideways; otherwise every weight of the model, imposed loads included, pushes sideways.
    knowledge : str
        Level of knowledge, which gives the confidence factor.
    confidence : float, optional
        Another confidence factor.
    control : (body, point), optional
        Control point of the mechanisms that it moves in; by default the point that moves fastest.
    limits : mapping, optional
        For a limit state, the largest displacement of the control point [m], where a floor loses its bearing say.
    curve : {"followed", "straight"}
        Which capacity curve counts; both are found.
    free_standing : mapping, optional
        For the names of mechanisms ("weakest of all" is the one sought among all motions) that are parapets,
        chimneys, gables, free to vibrate: :class:`~concio.analysis.seismic.free_standing.FreeStanding` or its
        arguments, ``{"kind": "cantilever", "E": 900e3}``. Their curve begins with an elastic branch.
    progress : callable, optional
        Told of each mechanism that is sought and followed.

    Raises
    ------
    InputError
        Something is not known to the code or not in the model; the control point lies on no body.
    NoEquilibriumError
        The model does not stand without an earthquake.
    SolverError
        The callback asked to stop.
    """
    require_model(model)
    if model.periods is not None:
        msg = "this is a periodic cell, which has no mechanism of a wall"
        raise InputError(msg, hint="assess the wall itself")
    rules = site.rules
    wanted = tuple(site.levels if levels is None else levels)
    for level in wanted:
        rules.pick("levels", level, "limit state")
        site.at(level)
    if not wanted:
        msg = "there is no limit state to check"
        raise InputError(msg, hint="one of " + ", ".join(site.levels))
    _one_of("curve", curve, ("followed", "straight"))
    for level, value in (limits or {}).items():
        rules.pick("levels", level, "limit state")
        if not value > 0:
            msg = f"a largest displacement of {value:g} m must be positive"
            raise InputError(msg, where=f"limit of {level}")
    notes = [
        f"a_g = {site.at(level).a_g:g} g on rock at {level} is more than any site in Italy has; check that g was meant"
        for level in wanted
        if site.at(level).a_g > STRONG
    ]
    factor, reason = _confidence(model, rules.tables["knowledge"], knowledge, confidence)
    groups = (live,) if isinstance(live, str) else tuple(live) if live is not None else ()
    if not groups and pushes_sideways(model, LIVE):
        groups = (LIVE,)
    made: list[LocalMechanism] = []
    locked: list[NoMechanism] = []
    sought = {EVERY: (), **(mechanisms or {})}
    elements = elements_of(free_standing or {}, tuple(sought), rules)
    known = tuple(dict.fromkeys(load.group for load in model.loads))
    for group in groups:
        if group not in known:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, known, names="groups"))
    ways = pushes(model, direction, groups)
    one = assemble(model) if groups else None
    assemblies = {p.way: (p, one or assemble(p.model)) for p in ways}
    if control is not None:
        _check_control(model, control)
    chosen = {name: None if name == EVERY else chosen_bodies(model, name, words) for name, words in sought.items()}
    steps = 2 * len(chosen) * len(assemblies)
    for name, moving in chosen.items():
        for way, (push, assembly) in assemblies.items():
            done = 2 * (len(made) + len(locked))
            _tell(progress, done, steps, f"{name}, push {way}: sought")
            try:
                found = find(assembly, push.groups, moving, push.sign)
            except NoEquilibriumError as error:
                raise NoEquilibriumError(error.what, where=None if name == EVERY else name, hint=error.hint) from None
            if found.locked or found.multiplier > LARGEST:
                locked.append(NoMechanism(name, way, found.multiplier))
                continue
            _tell(progress, done + 1, steps, f"{name}, push {way}: followed")
            made.append(
                _examined(
                    assembly, found, push.groups, push.sign, name=name, way=way, site=site, levels=wanted,
                    confidence=factor, control=control, limits=limits or {}, curve=curve, element=elements.get(name),
                )
            )  # fmt: skip
    made.sort(key=lambda m: (m.zeta, m.multiplier))
    arguments = {
        "levels": wanted, "mechanisms": mechanisms, "direction": direction, "live": live, "knowledge": knowledge,
        "confidence": confidence, "control": control, "limits": limits, "curve": curve,
        "free_standing": free_standing,
    }  # fmt: skip
    return Assessment(
        model, site, wanted, tuple(made), tuple(locked), knowledge, factor, reason, curve, tuple(notes), arguments
    )


def _tell(progress: ProgressCallback | None, done: int, steps: int, what: str) -> None:
    if progress is not None and progress(Progress("assessment", done, 1.0 - done / steps, what)):
        msg = "the assessment was stopped on request"
        raise SolverError(msg, hint="nothing was written")


def _one_of(what: str, word: str, known: tuple[str, ...]) -> None:
    if word not in known:
        msg = f"there is no {what} '{word}'"
        raise InputError(msg, hint=closest(word, known))


def _confidence(model: Model, table: Mapping[str, Any], knowledge: str, given: float | None) -> tuple[float, str]:
    """Return the confidence factor and where it comes from: "given", "knowledge" or "crushing"."""
    known = [key for key in table if key != "clause"]
    if knowledge not in known:
        msg = f"there is no level of knowledge '{knowledge}'"
        raise InputError(msg, hint=closest(knowledge, known))
    if given is not None:
        if not 1.0 <= given < math.inf:
            msg = f"a confidence factor of {given:g} must be at least 1"
            raise InputError(msg)
        return float(given), "given"
    used = {rule.law for rule in model.rules}
    if any(model.laws[name].compressive_strength is None for name in used):
        return max(float(table[key]) for key in known), "crushing"
    return float(table[knowledge]), "knowledge"


def _check_control(model: Model, control: Control) -> None:
    """Refuse a control point that lies on no free body.

    Raises
    ------
    InputError
    """
    body = model.body(control[0])
    point = np.array(control[1], dtype=float)
    where = "control point"
    if body.kind == "fixed":
        msg = f"'{body.name}' is fixed and moves in no mechanism"
        raise InputError(msg, where=where, hint="choose a point of the part that falls")
    low, high = body.vertices.min(0), body.vertices.max(0)
    slack = 1e-6 * model.size
    if point.shape != (model.dim,) or (point < low - slack).any() or (point > high + slack).any():
        place = ", ".join(f"{v:g}" for v in point)
        msg = f"({place}) lies outside '{body.name}'"
        span = ", ".join(f"{k} from {a:g} to {b:g}" for k, a, b in zip("xyz", low, high, strict=False))
        raise InputError(msg, where=where, hint=f"the body reaches {span} m")


def _examined(
    assembly: Assembly,
    found: Found,
    groups: Several[str],
    sign: float,
    *,
    name: str,
    way: str,
    site: Site,
    levels: Several[str],
    confidence: float,
    control: Control | None,
    limits: Mapping[str, float],
    curve: str,
    element: FreeStanding | None,
) -> LocalMechanism:
    """Return a mechanism with its curves and checks."""
    model, mechanics = assembly.model, found.mechanics
    assert mechanics is not None
    live = [k for k, load in enumerate(model.loads) if load.group in groups]
    rest = [k for k in range(len(model.loads)) if k not in live]
    push = [(kind, Force(f.block, sign * f.force, f.point)) for kind, f in gathered(model, mechanics, live)]
    dead = gathered(model, mechanics, rest)
    total = np.sum([f.force for _, f in push], axis=0)
    along = total / float(np.linalg.norm(total))
    number = {b.name: i for i, b in enumerate(model.bodies)}
    ties = []
    for tie in model.ties:
        a, b = (mechanics.of_body.get(number.get(word, -1), GROUND) for word in (tie.body_a, tie.body_b))
        if a != b:
            ties.append((tie, a, b))
    chosen = _control_of(assembly, found, control, number, along)
    block = mechanics.of_body[number[chosen[0]]]
    at = np.array(chosen[1], dtype=float)
    forces = tuple(f for _, f in dead), tuple(f for _, f in push)
    alpha, motion = found.multiplier, np.array([b.motion for b in mechanics.blocks])
    contacts = contacts_of(assembly, mechanics, found.normal_force)
    sequence = Sequence(mechanics, contacts, *forces, tuple(ties), (block, at, along))
    linkage: Linkage | Sequence = sequence
    followed = not_followed("several motions")
    if model.dim == 2:
        linkage, alpha, motion, followed = _as_linkage(mechanics, forces, ties, (block, at, along), alpha, motion)
    if all(site.rules.tables["levels"][level]["kind"] == "onset" for level in levels):
        followed = followed if followed.points else not_followed("not asked")
    elif not followed.points or followed.end < BARELY * model.size:
        steps = follow_in_steps(sequence, alpha)
        followed = steps if steps.end >= BARELY * model.size else not_followed(steps.reason)
    motion = motion / float(carried(motion[block], at - mechanics.blocks[block].centre) @ along)
    chain = Chain(
        tuple(
            Participant(f.block, kind, f.force, f.point,
                        float(carried(motion[f.block], f.point - mechanics.blocks[f.block].centre) @ f.force)
                        / float(np.linalg.norm(f.force)))
            for kind, f in push
        )
    )  # fmt: skip
    line = straight(alpha, followed.end) if followed.ends else None
    used = followed if curve == "followed" else line
    factor = site.rules.gravity / (chain.e_star * confidence)
    z = linkage.mechanics.level - min((b.base for b in site.building if hasattr(b, "base")), default=0.0)
    branch = None
    if element is not None:
        branch = branch_of(
            element, site.rules, model, mechanics, along, used, onset=alpha * factor, spectral=chain.spectral,
            factor=factor,
        )  # fmt: skip
    reached: dict[str, Displacement] = {}
    checks = []
    for level in levels:
        rule = site.rules.tables["levels"][level]
        limit = None
        if used is not None and used.ends and rule["kind"] != "onset":
            limit = limit_of(level, rule, used, chain.spectral, factor, limits.get(level, math.inf), branch)
            reached[level] = limit
        checks += checks_of(site, level, z, onset=alpha * factor, limit=limit, branch=branch)
    return LocalMechanism(
        name=name, direction=way, found=found, assembly=assembly, linkage=linkage, chain=chain, dead=tuple(dead),
        control=(chosen[0], tuple(at.tolist())), level=z, multiplier=alpha, confidence=confidence,
        factor=factor, followed=followed, straight=line, limits=reached, checks=tuple(checks),
        periods={level: site.at(level) for level in levels}, site=site, velocity=motion.ravel(),
        branch=branch,
    )  # fmt: skip


def _as_linkage(
    mechanics: Mechanics,
    forces: tuple[tuple[Force, ...], tuple[Force, ...]],
    ties: Several[tuple[Tie, int, int]],
    control: tuple[int, Array, Array],
    alpha: float,
    motion: Array,
) -> tuple[Linkage, float, Array, CapacityCurve]:
    """Return a plane mechanism as a linkage, with its multiplier, motion (G, 3) and curve."""
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
    return linkage, alpha, linkage.velocity(still).reshape(-1, 3), follow(linkage)


def _control_of(
    assembly: Assembly, found: Found, control: Control | None, number: Mapping[str, int], along: Array
) -> Control:
    """Return the control point: the one given where it moves, else the corner that moves fastest, furthest out."""
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
    return best[3], best[4]
