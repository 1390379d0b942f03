"""Other assessments of the same model: with other strengths of the joints, and with the tie force that is needed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from concio.analysis.entry_point import entry_point
from concio.analysis.seismic.assess import EVERY, assess
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.directions import Direction
from concio.analysis.seismic.strengthening import Measure, strengthen
from concio.analysis.seismic.what_if import way_of
from concio.arguments import strict
from concio.errors import NoEquilibriumError
from concio.model.model import Model
from concio.problem.solution import ProgressCallback

SHARES = {"friction": (0.8, 1.2), "strength": (0.5, 2.0)}
"""Factors of the friction and of the compressive strength of all joints."""


@dataclass(frozen=True, eq=False)
class TieForce:
    """The force of a tie that brings zeta_E to a value.

    Parameters
    ----------
    tie : str
    wanted : float
        zeta_E.
    force : float
        Yield force [kN]; zero where none is needed, ``inf`` where none does.
    reached : float
        zeta_E with it, or with the largest force that was tried.
    largest : float
        Largest force that was tried [kN].
    assessment : Assessment
        With that force.
    """

    tie: str
    wanted: float
    force: float
    reached: float
    largest: float
    assessment: Assessment


@strict
@entry_point
def tie_force(model: Model, tie: str, *, zeta: float = 1.0, largest: float | None = None, **arguments: Any) -> TieForce:
    """Return the yield force of a tie that brings the least zeta_E of all mechanisms to ``zeta``, by solving.

    It is the least over all limit states asked for. Every trial searches the mechanisms again, since the weakest one
    changes with the force. A tie that breaks before it yields has no more than its force at break, however large the
    yield force that is tried.

    Parameters
    ----------
    model : Model
    tie : str
        Name of one of its ties; its own yield force does not count.
    zeta : float
    largest : float, optional
        Largest force to try [kN]; by default the weight of the model.
    **arguments
        Of :func:`concio.assess`.

    Raises
    ------
    InputError
        There is no such tie; or as :func:`concio.assess`.

    Examples
    --------
    A tie holds a pillar near its head. The force that brings the weakest mechanism to zeta_E = 1:

    >>> import concio
    >>> import dataclasses
    >>> from concio.seismic import tie_force
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> tie = concio.Tie("t1", "b01", (-0.25, 1.8), "", (-3.0, 1.8), stiffness=10e3, yield_force=5.0)
    >>> site = concio.Site({"SLV": {"a_g": 0.30, "F0": 2.45, "Tc": 0.32}}, soil="C")
    >>> held = dataclasses.replace(pillar, ties=(tie,))
    >>> found = tie_force(held, "t1", site=site, levels=("SLV",), direction="right", elsewhere=("out of plane",))
    >>> round(found.force, 1), round(found.reached, 3)
    (1.7, 1.0)
    """
    made = strengthen(model, Measure("tie", (tie,)), zeta=zeta, largest=largest, **arguments)
    return TieForce(tie, zeta, made.amount, made.reached, made.largest if made.amount else 0.0, made.after)


@dataclass(frozen=True)
class Variation:
    """The weakest mechanism with one property of all joints changed.

    Parameters
    ----------
    what : {"friction", "strength"}
    factor : float
    multiplier, zeta : float
        alpha_0 and zeta_E of that mechanism; ``nan`` where the model does not stand, ``inf`` without mechanism.
    name : str
        Of that mechanism, which may be another one; empty without mechanism.
    """

    what: str
    factor: float
    multiplier: float
    zeta: float
    name: str = ""


@entry_point
def variations(found: Assessment, progress: ProgressCallback | None = None) -> tuple[Variation, ...]:
    """Return how the weakest mechanism changes with the friction and, where joints crush, with their strength.

    It is sought again under its push, in all parts of the structure; of the named mechanisms only itself.

    Examples
    --------
    A pillar tips whatever its friction:

    >>> import concio
    >>> from concio.seismic import variations
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> site = concio.Site({"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, soil="A")
    >>> found = concio.assess(pillar, site=site, direction="right", levels=("SLV",), elsewhere=("out of plane",))
    >>> [(v.what, v.factor, round(v.multiplier, 4)) for v in variations(found)]
    [('friction', 0.8, 0.25), ('friction', 1.2, 0.25)]
    """
    result: list[Variation] = []
    worst = found.worst
    if worst is None:
        return ()
    asked = dict(found.arguments)
    asked["mechanisms"] = {k: v for k, v in (asked["mechanisms"] or {}).items() if k == worst.name}
    asked["free_standing"] = {k: v for k, v in (asked["free_standing"] or {}).items() if k in (EVERY, worst.name)}
    asked["direction"] = _way_of(found, worst.direction)
    asked["elsewhere"] = (*asked["elsewhere"], "out of plane")  # the one that is varied is of the plane, or a section
    asked["out_of_plane"] = None
    whole = found.model if worst.section is None else worst.section
    if worst.section is not None:
        asked |= {"mechanisms": None, "free_standing": None, "control": None, "direction": way_of(worst.direction)}
    crush = any(law.compressive_strength is not None for law in whole.laws.values())
    for what, factors in SHARES.items():
        if what == "strength" and not crush:
            continue
        for factor in factors:
            model = replace(whole, laws=_changed(whole, what, factor))
            try:
                other = assess(model, site=found.site, progress=progress, **asked)
            except NoEquilibriumError:
                result.append(Variation(what, factor, math.nan, math.nan))
                continue
            weakest = other.worst
            alpha = math.inf if weakest is None else weakest.multiplier
            result.append(Variation(what, factor, alpha, other.zeta, "" if weakest is None else weakest.name))
    return tuple(result)


def _way_of(found: Assessment, name: str) -> Direction | None:
    """Return the direction of a push of an assessment as it is asked for."""
    if len({m.direction for m in found.mechanisms} | {n.direction for n in found.locked}) == 1:
        asked: Direction | None = found.arguments["direction"]
        return asked
    return way_of(name)


def _changed(model: Model, what: str, factor: float) -> Mapping[str, Any]:
    def law(old: Any) -> Any:
        if what == "friction":
            mu = factor * old.friction
            tension = min(old.tensile_strength, old.cohesion / mu) if mu > 0 else old.tensile_strength
            return replace(old, friction=mu, dilatancy=min(old.dilatancy, mu), tensile_strength=tension)
        if old.compressive_strength is None:
            return old
        return replace(old, compressive_strength=factor * old.compressive_strength)

    return {name: law(old) for name, old in model.laws.items()}
