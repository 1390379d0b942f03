r"""The checks of one mechanism: onset, with the behaviour factor, and in displacements; on the ground and at a height.

.. math::

    T = 1.68\,\pi \sqrt{d_{SLV}/a(d_{SLV})}, \qquad S_{De}(T, \xi) \le d_{SLV}

and so on, with the factors of the code's table. An element that is free to vibrate feels its onset at its own period,
:math:`S_e(T_0) \le a_y`, and its demand in displacement is the largest between T_0 and T. The acceleration a site could
have is found by scaling its a_g (or, in a table of return periods, by the return period) until demand meets capacity;
the least one counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from concio.analysis.seismic.curve import CapacityCurve
from concio.analysis.seismic.free_standing import ElasticBranch
from concio.analysis.seismic.site import LARGEST, Hazard, Site

Array = np.ndarray
Kind = Literal["onset", "linear", "displacement"]
Place = Literal["ground", "height"]

PERIODS = 200
"""Periods between T_0 and that of a limit state at which the demand of a free-standing element is read."""

GRID = 150
"""Accelerations that are tried between nothing and the largest before bisection."""


@dataclass(frozen=True)
class Check:
    """One line "capacity / demand".

    Parameters
    ----------
    level : str
        Limit state.
    kind : {"onset", "linear", "displacement"}
    place : {"ground", "height"}
        Which spectrum the demand comes from.
    capacity, demand : float
        In m/s2, or in m for displacements.
    a_g : float
        Acceleration on rock at which demand meets capacity [g]; ``inf`` where none does.
    zeta : float
        That over the acceleration of the site, zeta_E.
    clause : str
    T : float
        Period at which the demand was read [s], of displacements the secant one; 0 for an acceleration of the ground
        or the floor.
    xi : float
        Damping [%].
    least : float
        Of a check in displacements: a_g at which the mechanism begins to move, below which it cannot be [g].
    site_a_g : float
        a_g of the site [g].
    """

    level: str
    kind: Kind
    place: Place
    capacity: float
    demand: float
    a_g: float
    zeta: float
    clause: str
    T: float = 0.0
    xi: float = 5.0
    least: float = 0.0
    site_a_g: float = math.inf

    @property
    def at_rest(self) -> bool:
        """Of a check in displacements: whether the mechanism does not even begin to move at the a_g of the site."""
        return self.kind == "displacement" and self.least >= self.site_a_g

    @property
    def ratio(self) -> float:
        """Capacity over demand."""
        return self.capacity / self.demand if self.demand > 0 else math.inf

    @property
    def holds(self) -> bool:
        """Whether capacity is not less than demand, or nothing moves that would be demanded of."""
        return self.demand <= self.capacity or self.at_rest

    @property
    def unit(self) -> str:
        """Of capacity and demand."""
        return "m" if self.kind == "displacement" else "m/s2"


@dataclass(frozen=True)
class Displacement:
    """A limit of displacement on a capacity curve.

    Parameters
    ----------
    level : str
    control : float
        Displacement of the control point [m].
    d : float
        Spectral displacement [m].
    a : float
        Spectral acceleration there [m/s2].
    T : float
        Secant period [s].
    xi : float
        Damping [%].
    why : str
        What sets it: "share", "ties" or "given".
    """

    level: str
    control: float
    d: float
    a: float
    T: float
    xi: float
    why: str


def limit_of(
    level: str,
    rule: Mapping[str, Any],
    curve: CapacityCurve,
    spectral: float,
    factor: float,
    given: float = math.inf,
    branch: ElasticBranch | None = None,
) -> Displacement:
    """Return the limit of displacement of a limit state.

    Parameters
    ----------
    level : str
    rule : mapping
        Its entry in the code's table ``[levels]``.
    curve : CapacityCurve
        That ends.
    spectral : float
        Spectral displacement over that of the control point.
    factor : float
        Spectral acceleration over alpha [m/s2].
    given : float
        Displacement of the control point that the user does not want exceeded [m].
    branch : ElasticBranch, optional
        With which the curve begins.
    """
    choices = [(rule["share"] * curve.end, "share"), (given, "given")]
    if rule.get("mark") == "ties":
        choices.append((curve.first_below_half_after_a_break(), "ties"))
    control, why = min(choices)
    a = max(curve.at(control), 0.0) * factor
    d = spectral * control
    if branch is not None:
        a = min(a, branch.stiffness * d)
    T = rule["period"] * math.pi * math.sqrt(d / a) if a > 0 else math.inf
    return Displacement(level, control, d, a, T, float(rule["damping"]), why)


def checks_of(
    site: Site,
    level: str,
    z: float,
    *,
    onset: float,
    limit: Displacement | None,
    branch: ElasticBranch | None = None,
    start: float | None = None,
    q: float | None = None,
) -> list[Check]:
    """Return the checks of a limit state.

    A limit state that asks for displacements alone is met without a curve where the mechanism does not begin to move:
    that check is made where there is no curve, and kept where it is met.

    Parameters
    ----------
    site : Site
    level : str
    z : float
        Height at which the mechanism starts [m].
    onset : float
        a_0* [m/s2].
    limit : Displacement or None
        None where there is no curve that ends, or for the limit state of onset.
    branch : ElasticBranch, optional
        Of an element that is free to vibrate: a_y is its capacity then, and the demand is read at its own period.
    start : float, optional
        Spectral acceleration at which the mechanism begins to move [m/s2], by default that of the onset; less where
        ties pull only as they get longer.
    q : float, optional
        Behaviour factor of the linear check; by default that of the code.
    """
    start = onset if start is None else min(start, onset)
    places: list[Place] = ["ground"]
    if site.at_height(site.spectrum(site.at(level)), z) is not None:
        places.append("height")
    made = [check for place in places for check in _checks_at(place, site, level, z, onset, limit, branch, start, q)]
    return made if {check.place for check in made} == set(places) else []


def onset_zeta(site: Site, level: str, z: float, onset: float) -> float:
    """Return the zeta_E at which a mechanism begins to move: what its checks cannot fall below.

    Parameters
    ----------
    site : Site
    level : str
    z : float
        Height at which it starts [m].
    onset : float
        a_0* [m/s2].
    """
    hazard = site.at(level)

    def at_ground(h: Hazard) -> float:
        return float(site.spectrum(h).acceleration(0.0, 5.0))

    def at_height(h: Hazard) -> float:
        floor = site.at_height(site.spectrum(h), z)
        return 0.0 if floor is None else float(floor.acceleration(0.0, 5.0))

    return min(capacity_acceleration(site, hazard, onset, felt) for felt in (at_ground, at_height)) / hazard.a_g


def _checks_at(
    place: Place, site: Site, level: str, z: float, onset: float, limit: Displacement | None,
    branch: ElasticBranch | None, start: float, given: float | None,
) -> list[Check]:  # fmt: skip
    """Return the checks of a limit state with the spectrum of the ground, or with that at the height z."""
    own, xi = (0.0, 5.0) if branch is None else (branch.T0, branch.xi)
    onset, start = (onset, start) if branch is None else (branch.a, branch.a)
    rules, hazard = site.rules, site.at(level)
    rule = rules.tables["levels"][level]
    floor = "; " + rules.clause("floor") if place == "height" else ""
    found = []

    def spectrum(h: Hazard) -> Any:
        ground = site.spectrum(h)
        return site.at_height(ground, z) if place == "height" else ground

    def begins(h: Hazard) -> float:
        return float(spectrum(h).acceleration(own, xi))

    kind: Kind = "onset" if rule["kind"] == "onset" else "linear"
    if kind == "onset" or "q" in rule:
        q = 1.0 if "q" not in rule else float(rule["q"]) if given is None else given
        free = "" if branch is None else "; " + rules.clause("onset_free")
        clause = rules.clause("onset_free") if branch and kind == "onset" else rules.clause(kind) + free
        made = _check(site, level, kind, place, onset, lambda h: begins(h) / q, hazard, clause + floor)
        found.append(replace(made, T=own, xi=xi))
    elif limit is None:
        clause = rules.clause("onset") + floor
        still = _check(site, level, "onset", place, start, begins, hazard, clause)
        found += [replace(still, T=own, xi=xi)] if still.holds else []
    if limit is not None and kind != "onset":
        at = limit

        def moved(h: Hazard) -> float:
            if not math.isfinite(at.T):
                return math.inf
            periods = np.linspace(min(own, at.T), at.T, PERIODS) if own > 0 else at.T
            return float(np.max(spectrum(h).displacement(periods, at.xi)))

        clause = rules.clause("height" if place == "height" else "displacement") + floor
        made = _check(site, level, "displacement", place, at.d, moved, hazard, clause)
        least = capacity_acceleration(site, hazard, start, begins)
        found.append(replace(made, T=at.T, xi=at.xi, least=least))
    return found


def _check(
    site: Site,
    level: str,
    kind: Kind,
    place: Place,
    capacity: float,
    demand: Callable[[Hazard], float],
    hazard: Hazard,
    clause: str,
) -> Check:
    a_g = capacity_acceleration(site, hazard, capacity, demand)
    return Check(level, kind, place, capacity, demand(hazard), a_g, a_g / hazard.a_g, clause, site_a_g=hazard.a_g)


BEYOND = 1e3
"""Times the largest acceleration of a site up to which the one that a mechanism bears is sought."""


def capacity_acceleration(site: Site, hazard: Hazard, capacity: float, demand: Callable[[Hazard], float]) -> float:
    """Return the least a_g [g] at which the demand reaches the capacity; ``inf`` where none does.

    Along a table of return periods all its quantities change; from hazards by limit state, and beyond the table, only
    a_g does.
    """
    scaled = hazards(site, hazard)
    shares = np.concatenate([np.linspace(0.0, 1.0, GRID + 1)[1:], np.geomspace(1.0, BEYOND, GRID + 1)[1:]])
    low = 0.0
    for share in shares:
        if demand(scaled(float(share))) > capacity:
            high = float(share)
            for _ in range(45):
                middle = (low + high) / 2
                low, high = (low, middle) if demand(scaled(middle)) > capacity else (middle, high)
            return scaled(low).a_g if low > 0 else 0.0
        low = float(share)
    return math.inf


class _Scaled(Hazard):
    """A hazard with another acceleration, which may be larger than that of any site."""

    def __post_init__(self) -> None:
        """Check nothing: all else is that of a hazard."""


def _scaled(hazard: Hazard, a_g: float) -> Hazard:
    return _Scaled(math.nan, a_g, hazard.F0, hazard.T_star, hazard.filled)


def hazards(site: Site, hazard: Hazard) -> Callable[[float], Hazard]:
    """Return the hazards of a site by a share, 1 being the largest acceleration of a site, or the end of its table.

    Beyond it a_g alone grows with the share: no site shakes so hard, but zeta_E is a ratio, and has no end there.
    """
    if isinstance(site.hazard, Mapping):
        return lambda share: _scaled(hazard, max(share, 1e-9) * LARGEST)
    rows: tuple[Hazard, ...] = site.hazard
    first, last = math.log(rows[0].T_R), math.log(rows[-1].T_R)
    low = rows[0].a_g

    def along(share: float) -> Hazard:
        # below the table a_g alone falls; the first tenth of the way is for that
        if share < 0.1:
            return _scaled(rows[0], max(share, 1e-9) / 0.1 * low)
        if share > 1.0:
            return _scaled(rows[-1], share * rows[-1].a_g)
        return site.interpolated(math.exp(first + (last - first) * (share - 0.1) / 0.9))

    return along


def return_period(site: Site, a_g: float) -> float:
    """Return the return period [years] of an acceleration, between the hazards known; ``nan`` where there is none.

    Linear in the logarithms between limit states or rows of the table; beyond them it is not known.
    """
    given = [site.at(level) for level in site.levels] if isinstance(site.hazard, Mapping) else list(site.hazard)
    known = sorted({(h.a_g, h.T_R) for h in given})
    if len(known) < 2 or not known[0][0] <= a_g <= known[-1][0]:
        return math.nan
    logs = np.log(np.array(known))
    return float(np.exp(np.interp(math.log(a_g), logs[:, 0], logs[:, 1])))
