r"""The modified MEXE formula, as a line of comparison beside what is computed here.

.. math:: P = \min\left(\frac{740\,(d + h)^2}{L^{1.3}},\; 70\right) F_{sr} F_p F_m F_j F_{cM} \quad [t],

the axle load of a double axle bogie, with span L, ring thickness d and depth of fill over the crown h in metres. It is
an old fit to few bridges and says nothing of position, of several spans or rings, or of the vehicle. Factors that an
inspector judges (material, joints, condition) are the user's; that of the profile is

.. math:: F_p = 2.3 \left(\frac{r_c - r_q}{r_c}\right)^{0.6} \text{ for } r_q > 0.75\,r_c, \quad 1 \text{ else},

and that of flat arches (span over rise above 4), which the codes give as a figure, has to be given.

Source: BA 16/97, The assessment of highway bridges and structures, chapter 3; CS 454 keeps it for first looks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.model.model import Model
from concio.model.road.earth import ground_of
from concio.representation import short_repr

TONNE = 9.81
"""Weight of a tonne [kN]."""
SPANS = (1.5, 18.0)
"""Spans for which the formula was made [m]."""
DEPTHS = (0.25, 1.8)
"""Depths d + h for which it was made [m]."""
MOST = 70.0
"""Largest provisional axle load [t]."""
STEEPEST = 4.0
"""Span over rise up to which the span/rise factor is 1."""


@short_repr
@dataclass(frozen=True)
class Mexe:
    """What the formula gives.

    Parameters
    ----------
    axle : float
        Modified axle load of a double axle bogie [kN]; nan where it does not apply.
    provisional : float
        Before the factors [kN].
    profile : float
        F_p.
    factors : float
        Product of the other factors, which are the user's.
    limits : tuple of str
        What the formula leaves out here, and why it does not apply where it does not.
    """

    axle: float
    provisional: float
    profile: float
    factors: float
    limits: tuple[str, ...]


def mexe(
    span: float, rise: float, quarter_rise: float, ring: float, depth: float, *, span_rise: float | None = None,
    factors: float = 1.0,
) -> Mexe:  # fmt: skip
    """Return the modified MEXE axle load.

    Parameters
    ----------
    span, rise, quarter_rise : float
        Of the intrados; the last at a quarter of the span [m].
    ring, depth : float
        Thickness d and depth of fill over the crown h [m].
    span_rise : float, optional
        Factor of flat arches, from the figure of the code.
    factors : float
        Product of material, joint and condition factors.

    Examples
    --------
    >>> from concio.analysis.bridges.mexe import mexe
    >>> round(mexe(6.0, 1.5, 1.16, 0.45, 0.40).axle, 1)
    482.1
    """
    told = []
    provisional = min(740.0 * (ring + depth) ** 2 / span**1.3, MOST) * TONNE
    if not SPANS[0] <= span <= SPANS[1]:
        told.append(f"a span of {span:.3g} m is outside the formula's {SPANS[0]:g} to {SPANS[1]:g} m")
    if not DEPTHS[0] <= ring + depth <= DEPTHS[1]:
        told.append(f"d + h = {ring + depth:.3g} m is outside the formula's {DEPTHS[0]:g} to {DEPTHS[1]:g} m")
    flat = 1.0 if span_rise is None else span_rise
    if span_rise is None and span / rise > STEEPEST * (1 + 1e-9):
        told.append(f"span over rise is {span / rise:.3g}: the factor of the code's figure has to be given")
    profile = 2.3 * ((rise - quarter_rise) / rise) ** 0.6 if quarter_rise > 0.75 * rise else 1.0
    profile = min(profile, 1.0)
    axle = float("nan") if told else provisional * flat * profile * factors
    if factors == 1.0:
        told.append("material, joint and condition factors are taken as 1")
    return Mexe(axle, provisional, profile, flat * factors, tuple(told))


def mexe_of(model: Model, *, span_rise: float | None = None) -> Mexe | None:
    """Return the formula's answer for a bridge of one span that was made by its span and ring; None for others."""
    given = model.generator.get("arguments")
    if model.generator.get("kind") != "bridge" or not isinstance(given, dict) or len(given["span"]) != 1:
        return None
    surface, road = ground_of(model)
    crown = surface.crown
    depth = float(road.height(crown[:1])[0] - crown[1])
    ring, span = float(sum(given["ring"])), float(given["span"][0])
    free = [b.outline for b in model.outlines if b.kind != "fixed"]
    points = np.vstack(free)
    foot, middle = float(points[:, 1].min()), float(points[:, 0].min() + points[:, 0].max()) / 2
    rise = float(points[:, 1].max()) - ring - foot
    quarter = _underside(free, middle - 0.25 * span) - foot
    found = mexe(span, rise, quarter, ring, depth, span_rise=span_rise)
    if len(given["ring"]) > 1:
        return Mexe(found.axle, found.provisional, found.profile, found.factors,
                    (*found.limits, f"{len(given['ring'])} rings are taken as one"))  # fmt: skip
    return found


def _underside(outlines: list[np.ndarray], x: float) -> float:
    """Return the least height at which a vertical line meets outlines [m]."""
    heights = []
    for p in outlines:
        q = np.roll(p, -1, axis=0)
        hit = (p[:, 0] != q[:, 0]) & ((p[:, 0] - x) * (q[:, 0] - x) <= 0)
        share = (x - p[hit, 0]) / (q[hit, 0] - p[hit, 0])
        heights += (p[hit, 1] + share * (q[hit, 1] - p[hit, 1])).tolist()
    return float(min(heights))
