"""Seismic assessment of the local mechanisms of a model: the weakest ones are found, followed, and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Sequence as Several
from typing import Any, Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.seismic.acting import acting_in
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.directions import Direction, pushes
from concio.analysis.seismic.examine import Control, Terms
from concio.analysis.seismic.free_standing import FreeStanding, elements_of
from concio.analysis.seismic.open_items import ELSEWHERE, facades_of
from concio.analysis.seismic.out_of_plane import covered_by, of_strips, strips_assessed
from concio.analysis.seismic.searching import EVERY, Search, search_all
from concio.analysis.seismic.sections import OutOfPlane, strips_of
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.tie_history import with_strength
from concio.analysis.seismic.weakest_mechanism import chosen_bodies
from concio.arguments import closest, strict
from concio.contact.assembly import assemble
from concio.contact.factors import once
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model, require_model
from concio.problem.solution import ProgressCallback

__all__ = ["EVERY", "assess"]

Array = np.ndarray


@strict
@entry_point
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
    elsewhere: Several[str] = (),
    accept_linear: bool = False,
    q: float | None = None,
    participation: float | None = None,
    out_of_plane: OutOfPlane | Mapping[str, Any] | None = None,
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
        Limit states; by default all that the code asks for: those without hazard are reported as not checked.
    mechanisms : mapping, optional
        Beside the weakest mechanism of all: for each name the bodies that move while all others stand: their names
        (``*`` stands for any letters), roles or layers, or ``{"above": 3.0}`` for those whose centroid lies there.
    direction : str, or (x, y) in space
        Which way the earthquake pushes: in the plane "right", "left" or "both", by default both; in space "+x", "-x",
        "+y", "-y", "both" (along x), "all", "corners" (along the diagonals), "every" (those as well) or a horizontal
        vector, by default all four. Where ``live`` is given, in the
        plane "left" is against it; in space both ways along it are examined.
    live : str or sequence of str, optional
        Load groups that push, for a multiplier of one. By default "live" where the model has such a group and it
        pushes sideways; otherwise every weight of the model, imposed loads included, pushes sideways.
    knowledge : str
        Level of knowledge, which gives the confidence factor.
    confidence : float, optional
        Another confidence factor.
    control : (body, point), optional
        Control point of the mechanisms that it moves in; by default the point that moves fastest; where a
        block slides, the centroid of the forces that push it.
    limits : mapping, optional
        For a limit state, the largest displacement of the control point [m], where a floor loses its bearing say.
    curve : {"followed", "straight"}
        Which capacity curve counts; both are found.
    free_standing : mapping, optional
        For the names of mechanisms ("weakest of all" is the one sought among all motions) that are parapets,
        chimneys, gables, free to vibrate: :class:`~concio.analysis.seismic.free_standing.FreeStanding` or its
        arguments, ``{"kind": "cantilever", "E": 900e3}``. Their curve begins with an elastic branch.
    elsewhere : sequence of str
        Checks that are made elsewhere, under the responsibility of the author: "out of plane" of a facade in elevation,
        "height" of mechanisms above the ground without a building, "ties" without yield force.
    accept_linear : bool
        Whether a limit state counts as met where the linear check with the behaviour factor is, as the code allows; by
        default the check in displacements decides wherever there is one.
    q : float, optional
        Behaviour factor of the linear check, at least 1; by default that of the code.
    participation : float, optional
        Share of the mass that takes part, e*, in every mechanism: 1 for all of what moves, which lowers a_0*; by
        default that of the chain of the mechanism.
    out_of_plane : OutOfPlane or mapping, optional
        How a facade drawn in elevation is held out of its plane:
        :class:`~concio.analysis.seismic.sections.OutOfPlane` or its arguments, ``{"held": [3.2, 6.4]}``. By default
        nothing holds it. Its strips are assessed unless ``elsewhere`` leaves them out or ``live`` pushes.
    progress : callable, optional
        Called for each mechanism that is sought and followed.

    Raises
    ------
    InputError
        Something is not known to the code or not in the model; the control point lies on no body.
    NoEquilibriumError
        The model does not stand without an earthquake.
    SolverError
        The callback asked to stop.

    Examples
    --------
    The multiplier of a pillar that tips is width over height. Two limit states are left without hazard:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> site = concio.Site({"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, soil="A")
    >>> found = concio.assess(pillar, site=site, direction="right", elsewhere=("out of plane",))
    >>> round(found.mechanisms[0].multiplier, 4)
    0.25
    >>> found.verdict.outcome.name, found.verdict.unchecked[0][:8]
    ('INCOMPLETE', 'SLD, SLC')
    """
    require_model(model)
    if model.periods is not None:
        msg = "this is a periodic cell, which has no mechanism of a wall"
        raise InputError(msg, hint="assess the wall itself")
    if any(tie.kind == "soil" for tie in model.ties):
        msg = "the fill of this model presses on its blocks, and mechanisms of walls do not include that pressure"
        raise InputError(msg, hint="assess it with passive = 0 in [fill]; 'concio bridge' is for bridges")
    rules = site.rules
    wanted = tuple(site.levels if levels is None else levels)
    for level in wanted:
        rules.pick("levels", level, "limit state")
        site.at(level)
    if not wanted:
        msg = "there is no limit state to check"
        raise InputError(msg, hint="one of " + ", ".join(site.levels))
    _one_of("curve", curve, ("followed", "straight"))
    for item in elsewhere:
        _one_of("check that is made elsewhere", item, ELSEWHERE)
    for level, value in (limits or {}).items():
        rules.pick("levels", level, "limit state")
        if not value > 0:
            msg = f"a largest displacement of {value:g} m must be positive"
            raise InputError(msg, where=f"limit of {level}")
    factor, reason = _confidence(model, rules.tables["knowledge"], knowledge, confidence)
    groups = once(live if live is not None else ())
    sought = {EVERY: (), **(mechanisms or {})}
    elements = elements_of(free_standing or {}, tuple(sought), rules)
    known = tuple(dict.fromkeys(load.group for load in model.loads))
    for group in groups:
        if group not in known:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, known, names="groups"))
    held = with_strength(model)
    ways = pushes(held, direction, groups)
    one = assemble(held) if groups else None
    searches = [Search(p, one or assemble(p.model)) for p in ways]
    if control is not None:
        _check_control(model, control)
    chosen = {name: chosen_bodies(model, name, words) for name, words in sought.items() if name != EVERY}
    terms = Terms(site, wanted, factor, control, limits or {}, curve, accept_linear, *_decided(q, participation))
    acting = acting_in(model, ways)
    facades = facades_of(searches[0].assembly)
    held_out = _held_out(out_of_plane, facades)
    aside = facades if "out of plane" not in elsewhere and not groups else []
    drawn = strips_of(model, held_out, aside)  # before the search: what they refuse is refused at once
    try:
        found = search_all(searches, chosen, terms, elements, progress)
    except NoEquilibriumError as error:
        side = [a.sentence() for a in acting if a.role == "constant" and np.abs(a.force[:-1]).max(initial=0.0) > 0]
        hint = f"{error.hint}; sideways act, as they are: {'; '.join(side)}" if side else error.hint
        raise NoEquilibriumError(error.what, where=error.where, hint=hint) from None
    strips = strips_assessed(drawn, terms, progress)
    beside, rest = of_strips(strips)
    late = (at for s in strips if not s.like for at in s.late)
    ranked = tuple(sorted([*found.shown, *beside], key=lambda m: (m.zeta, m.least, m.multiplier)))
    arguments = {
        "levels": levels, "mechanisms": mechanisms, "direction": direction, "live": live, "knowledge": knowledge,
        "confidence": confidence, "control": control, "limits": limits, "curve": curve,
        "free_standing": free_standing, "elsewhere": tuple(elsewhere), "accept_linear": accept_linear, "q": q,
        "participation": participation, "out_of_plane": out_of_plane,
    }  # fmt: skip
    return Assessment(
        model, site, wanted, ranked, found.locked, knowledge, factor, reason, curve,
        arguments, others=(*found.others, *rest), late=(*found.late, *late), sought=found.sought,
        parts=found.parts, places=found.places, bounds=found.bounds, acting=acting,
        covered=(*found.covered, *covered_by(strips)), assembly=searches[0].assembly, strips=strips,
    )  # fmt: skip


def _decided(q: float | None, participation: float | None) -> tuple[float | None, float | None]:
    """Return what the author decided of both, checked.

    Raises
    ------
    InputError
        One is not a number that it can be.
    """
    if q is not None and not 1.0 <= q < math.inf:
        msg = f"a behaviour factor q of {q:g} must be at least 1"
        raise InputError(msg)
    if participation is not None and not 0.0 < participation <= 1.0:
        msg = f"a share of the mass that takes part, {participation:g}, must lie above 0 and not above 1"
        raise InputError(msg, hint="participation = 1 takes all of the mass that moves")
    return q, participation


def _held_out(given: OutOfPlane | Mapping[str, Any] | None, facades: Several[tuple[int, ...]]) -> OutOfPlane:
    """Return how a facade is held out of its plane.

    Raises
    ------
    InputError
        A key is not known, or the model is not a facade in elevation.
    """
    if given is None or isinstance(given, OutOfPlane):
        made = given or OutOfPlane()
    else:
        for key in given:
            _one_of("key of out_of_plane", key, tuple(OutOfPlane.__dataclass_fields__))
        made = OutOfPlane(**given)
    if given is not None and not facades:
        msg = "out_of_plane is for a facade drawn in elevation, wider than it is thick"
        raise InputError(msg, hint="in space and in sections walls leave their plane by themselves")
    return made


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
    slack = 1e-6 * float(np.ptp(body.vertices, axis=0).max())
    if point.shape != (model.dim,) or (point < low - slack).any() or (point > high + slack).any():
        place = ", ".join(f"{v:g}" for v in point)
        msg = f"({place}) lies outside '{body.name}'"
        span = ", ".join(f"{k} from {a:g} to {b:g}" for k, a, b in zip("xyz", low, high, strict=False))
        raise InputError(msg, where=where, hint=f"the body reaches {span} m")
