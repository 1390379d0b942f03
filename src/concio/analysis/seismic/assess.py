"""Seismic assessment of the local mechanisms of a model: the weakest ones are found, followed, and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from concio.analysis.seismic.applied import EARTHQUAKE, pushed, pushes_sideways
from concio.analysis.seismic.assessment import Assessment, LocalMechanism, NoMechanism
from concio.analysis.seismic.chain import Chain, Participant, gathered
from concio.analysis.seismic.checks import Displacement, checks_of, limit_of
from concio.analysis.seismic.curve import follow, not_followed, straight
from concio.analysis.seismic.linkage import Force, Linkage
from concio.analysis.seismic.macro_blocks import GROUND
from concio.analysis.seismic.mechanism import LARGEST, Found, chosen_bodies, find
from concio.analysis.seismic.pushed_curve import pushed_curve
from concio.analysis.seismic.site import STRONG, Site
from concio.arguments import closest, strict
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model, require_model
from concio.model.stages import ControlPoint

Array = np.ndarray
Direction = Literal["right", "left", "both"]
Control = tuple[str, tuple[float, float]]

LIVE = "live"
EVERY = "weakest of all"
"""Name of the mechanism that is sought among all motions."""

SAME = 1e-6
"""Relative difference below which the multipliers of the limit programme and of its linkage are the same."""

BARELY = 1e-3
"""Curves that end before this share of the size of the mechanism are no curves: other joints take over at once."""

SIGNS = {"right": (1.0,), "left": (-1.0,), "both": (1.0, -1.0)}


@strict
def assess(
    model: Model,
    *,
    site: Site,
    levels: Sequence[str] | None = None,
    mechanisms: Mapping[str, Sequence[str] | Mapping[str, float]] | None = None,
    direction: Direction = "both",
    live: str | Sequence[str] | None = None,
    knowledge: str = "LC1",
    confidence: float | None = None,
    control: Control | None = None,
    limits: Mapping[str, float] | None = None,
    curve: Literal["followed", "straight"] = "followed",
) -> Assessment:
    """Find the local mechanisms of a plane model and check them against the demand of a site.

    Parameters
    ----------
    model : Model
        Plane: a facade in its plane, or a vertical strip of a wall.
    site : Site
        Hazard, soil, code.
    levels : sequence of str, optional
        Limit states; by default all whose hazard is known.
    mechanisms : mapping, optional
        Beside the weakest mechanism of all: for each name the bodies that move while all others stand: their names
        (``*`` stands for any letters), roles or layers, or ``{"above": 3.0}`` for those whose centroid lies there.
    direction : {"both", "right", "left"}
        Which way the earthquake pushes along x; where ``live`` is given, "left" is against it.
    live : str or sequence of str, optional
        Load groups that push, for a multiplier of one. By default "live" where the model has such a group and it
        pushes sideways; otherwise every weight of the model, imposed loads included, pushes sideways.
    knowledge : str
        Level of knowledge, which gives the confidence factor.
    confidence : float, optional
        Another confidence factor.
    control : (body, (x, y)), optional
        Control point of the mechanisms that it moves in; by default the point that moves fastest.
    limits : mapping, optional
        For a limit state, the largest displacement of the control point [m], where a floor loses its bearing say.
    curve : {"followed", "straight"}
        Which capacity curve counts; both are found.

    Raises
    ------
    InputError
        Something is not known to the code or not in the model; the control point lies on no body.
    NoEquilibriumError
        The model does not stand without an earthquake.
    """
    require_model(model)
    _ = model.outlines
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
    _one_of("direction", direction, tuple(SIGNS))
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
    assemblies: dict[float, tuple[Assembly, tuple[str, ...], float]] = {}
    for sign in SIGNS[direction]:
        if groups:
            assemblies[sign] = (next(iter(assemblies.values()))[0] if assemblies else assemble(model), groups, sign)
        else:
            assemblies[sign] = (assemble(pushed(model, sign)), (EARTHQUAKE,), 1.0)
    for group in groups:
        known = next(iter(assemblies.values()))[0].groups
        if group not in known:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, known, names="groups"))
    if control is not None:
        _check_control(model, control)
    for name, words in sought.items():
        for sign, (assembly, push, factor_of_push) in assemblies.items():
            way = "right" if sign > 0 else "left"
            moving = None if name == EVERY else chosen_bodies(assembly, name, words)
            try:
                found = find(assembly, push, moving, factor_of_push)
            except NoEquilibriumError as error:
                raise NoEquilibriumError(error.what, where=None if name == EVERY else name, hint=error.hint) from None
            if found.locked or found.multiplier > LARGEST:
                locked.append(NoMechanism(name, way, found.multiplier))
                continue
            made.append(
                _examined(
                    assembly, found, push, factor_of_push, name=name, way=way, site=site, levels=wanted,
                    confidence=factor, control=control, limits=limits or {}, curve=curve,
                )
            )  # fmt: skip
    made.sort(key=lambda m: (m.zeta, m.multiplier))
    arguments = {
        "levels": wanted, "mechanisms": mechanisms, "direction": direction, "live": live, "knowledge": knowledge,
        "confidence": confidence, "control": control, "limits": limits, "curve": curve,
    }  # fmt: skip
    return Assessment(
        model, site, wanted, tuple(made), tuple(locked), knowledge, factor, reason, curve, tuple(notes), arguments
    )


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
    if point.shape != (2,) or (point < low - slack).any() or (point > high + slack).any():
        place = ", ".join(f"{v:g}" for v in point)
        msg = f"({place}) lies outside '{body.name}'"
        span = f"x from {low[0]:g} to {high[0]:g}, y from {low[1]:g} to {high[1]:g} m"
        raise InputError(msg, where=where, hint=f"the body reaches {span}")


def _examined(
    assembly: Assembly,
    found: Found,
    groups: Sequence[str],
    sign: float,
    *,
    name: str,
    way: str,
    site: Site,
    levels: Sequence[str],
    confidence: float,
    control: Control | None,
    limits: Mapping[str, float],
    curve: str,
) -> LocalMechanism:
    """Return a mechanism with its curves and checks."""
    model, mechanics = assembly.model, found.mechanics
    assert mechanics is not None
    live = [k for k, load in enumerate(model.loads) if load.group in groups]
    rest = [k for k in range(len(model.loads)) if k not in live]
    push = [(kind, Force(f.block, sign * f.force, f.point)) for kind, f in gathered(model, mechanics, live)]
    dead = gathered(model, mechanics, rest)
    total = np.sum([f.force for _, f in push], axis=0)
    along = total / float(np.hypot(*total))
    number = {b.name: i for i, b in enumerate(model.bodies)}
    ties = []
    for tie in model.ties:
        a, b = (mechanics.of_body.get(number.get(word, -1), GROUND) for word in (tie.body_a, tie.body_b))
        bar = any(j.kind == "bar" and np.array_equal(j.point, np.array(tie.at_a)) for j in mechanics.joints)
        if a != b and not bar:
            ties.append((tie, a, b))
    chosen = _control_of(assembly, found, control, number, along)
    block = mechanics.of_body[number[chosen[0]]]
    at = np.array(chosen[1], dtype=float)
    linkage = Linkage(mechanics, tuple(f for _, f in dead), tuple(f for _, f in push), tuple(ties), (block, at, along))
    linkage = linkage.set_back()
    still = np.zeros((len(mechanics.blocks), 3))
    alpha, velocity = found.multiplier, np.concatenate([b.motion for b in mechanics.blocks])
    onset = linkage.balance(still, plastic=True) if linkage.freedom == 1 else None
    crushes = any(j.inward is not None for j in mechanics.joints)
    if onset is not None and crushes:
        alpha = onset.multiplier
    if onset is None:
        followed = not_followed("several motions" if linkage.freedom != 1 else "no forces")
    elif abs(onset.multiplier - alpha) > SAME * abs(alpha):
        followed = not_followed("no forces")  # of a dilatant motion: the joints that slide do not stay closed in it
    else:
        velocity = linkage.velocity(still)
        followed = follow(linkage)
    velocity = velocity / float(linkage.row(still, block, at, along) @ velocity)
    chain = Chain(
        tuple(
            Participant(f.block, kind, f.force, f.point,
                        float(linkage.row(still, f.block, f.point, f.force) @ velocity) / float(np.hypot(*f.force)))
            for kind, f in push
        )
    )  # fmt: skip
    if not followed.points or followed.end < BARELY * linkage.size:
        free = tuple(i for i, b in enumerate(model.bodies) if b.kind != "fixed")
        moving = free if found.moving is None else found.moving
        point = ControlPoint(chosen[0], (float(at[0]), float(at[1])), (float(along[0]), float(along[1])))
        followed = pushed_curve(model, groups, sign, moving, point) or followed
    line = straight(alpha, followed.end) if followed.ends else None
    used = followed if curve == "followed" else line
    factor = site.rules.gravity / (chain.e_star * confidence)
    z = linkage.mechanics.level - min((b.base for b in site.building if hasattr(b, "base")), default=0.0)
    reached: dict[str, Displacement] = {}
    checks = []
    for level in levels:
        rule = site.rules.tables["levels"][level]
        limit = None
        if used is not None and used.ends and rule["kind"] != "onset":
            limit = limit_of(level, rule, used, chain.spectral, factor, limits.get(level, math.inf))
            reached[level] = limit
        checks += checks_of(site, level, z, onset=alpha * factor, limit=limit)
    return LocalMechanism(
        name=name, direction=way, found=found, assembly=assembly, linkage=linkage, chain=chain, dead=tuple(dead),
        control=(chosen[0], tuple(at.tolist())), level=z, multiplier=alpha, confidence=confidence,
        factor=factor, followed=followed, straight=line, limits=reached, checks=tuple(checks),
        periods={level: site.at(level) for level in levels}, site=site, velocity=velocity,
    )  # fmt: skip


def _control_of(
    assembly: Assembly, found: Found, control: Control | None, number: Mapping[str, int], along: Array
) -> Control:
    """Return the control point: the one given where it moves, else the corner that moves fastest, furthest out."""
    assert found.mechanics is not None
    mechanics = found.mechanics
    top = float(np.abs(found.velocity).max())

    def speed(b: int, point: Array) -> float:
        block = mechanics.blocks[mechanics.of_body[b]]
        arm = point - block.centre
        moved = block.motion[:2] + block.motion[2] * np.array([-arm[1], arm[0]])
        return float(moved @ along)

    if control is not None and number[control[0]] in mechanics.of_body:
        point = np.array(control[1], dtype=float)
        if speed(number[control[0]], point) > 1e-6 * top:
            return control
    corners = [
        (speed(b, v), float(v[1]), float(v @ along), assembly.model.bodies[b].name, (float(v[0]), float(v[1])))
        for b in mechanics.of_body
        for v in np.asarray(assembly.model.bodies[b].vertices)
    ]
    fastest = max(c[0] for c in corners)
    best = max((c for c in corners if c[0] >= (1 - 1e-6) * fastest), key=lambda c: (round(c[1], 9), round(c[2], 9)))
    return best[3], best[4]
