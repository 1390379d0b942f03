"""Least thickness of a semicircular arch as friction falls, and with vertical in place of radial joints.

Cocchetti and Rizzi (2020) let the friction of the radial joints of a complete semicircular arch fall, under its own
weight. Down to 0.395832 the arch needs the thickness of a purely rotational mechanism; then its springings slide and it
must be thicker; below 0.309215 no thickness is enough, because joints near 28.6 degrees from the crown slide as well.
Their weight acts along the centreline, which moves the least thickness by 5e-5. The forces of all joints are compared
with joints every degree; the slip at the inner joint is stationary there, so that its error is of second order.

Makris and Alexakis (2013): with vertical joints the least thickness is 0.1095 of the radius, with radial ones 0.1075.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

import concio
from concio.solvers.statics.existence import statically_admissible
from validation_cases.row import Row

SOURCE = (
    "G. Cocchetti and E. Rizzi, Frattura ed Integrità Strutturale 51 (2020) 356-375, pages 364, 369 and 372 (table 3);"
    " N. Makris and H. Alexakis, Arch. Appl. Mech. 83 (2013) 1511-1533, abstract."
)

VOUSSOIRS = 180


def radial(ratio: float, friction: float, voussoirs: int = VOUSSOIRS) -> concio.Model:
    """Arch of centreline radius 1 and thickness ``ratio`` with radial joints."""
    return concio.arch(
        span=2 - ratio, ring=ratio, voussoirs=voussoirs, block="rigid", friction=friction, chord_tolerance=1e-5
    )


def vertical(ratio: float, slices: int = 120, friction: float = 100.0) -> concio.Model:
    """Arch of centreline radius 1 and thickness ``ratio`` with vertical joints at equal steps of the angle."""
    outer, inner = 1 + 0.5 * ratio, 1 - 0.5 * ratio
    at = inner * np.cos(np.linspace(np.pi, 0.0, slices + 1))

    def line(radius: float, x0: float, x1: float) -> list[tuple[float, float]]:
        x = np.linspace(x0, x1, 5)
        return list(zip(x, np.sqrt(np.maximum(radius**2 - x**2, 0.0)), strict=True))

    bodies = []
    for k, (x0, x1) in enumerate(pairwise(at)):
        low, high = line(inner, x0, x1), line(outer, x0, x1)[::-1]
        if k == 0:  # the springing: what stands outside the intrados as well
            high += list(zip(*_arc(outer, np.pi - np.arccos(inner / outer), np.pi), strict=True))
        if k == slices - 1:
            high = list(zip(*_arc(outer, 0.0, np.arccos(inner / outer)), strict=True)) + high
        outline = np.array(list(dict.fromkeys((round(float(x), 12), round(float(y), 12)) for x, y in low + high)))
        bodies.append(concio.Body(f"v{k:03d}", outline, kind="rigid"))
    ground = [(-2.0, -0.5), (2.0, -0.5), (2.0, 0.0), (-2.0, 0.0)]
    return concio.Model(
        (concio.Body("ground", ground, kind="fixed"), *bodies), {"block": concio.Rigid(unit_weight=20.0)},
        {"joint": concio.JointLaw(friction)}, loads=(concio.Load("weight", (0.0, -1.0)),),
    )  # fmt: skip


def _arc(radius: float, first: float, last: float) -> tuple[list[float], list[float]]:
    angle = np.linspace(first, last, 9)
    return (radius * np.cos(angle)).tolist(), (radius * np.sin(angle)).tolist()


def stands(model: concio.Model) -> bool:
    """Return whether forces balance the weight."""
    return statically_admissible(concio.assemble(model).problem()).exists


def least(make: Any, low: float, high: float, tolerance: float = 1e-6) -> float:
    """Return the least ratio at which the arch that ``make`` returns stands."""
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(make(middle)) else (middle, high)
    return high


@cache
def thickness(friction: float) -> float:
    return least(lambda ratio: radial(ratio, friction), 0.09, 0.25)


@cache
def friction_needed(ratio: float) -> float:
    return concio.friction_margin(radial(ratio, 1.0)).factor


def thrust(ratio: float, friction: float) -> float:
    """Return the horizontal thrust over weight per length and radius."""
    result = concio.solve(radial(ratio, friction))
    across = max(abs(force[0]) for force in result.reactions.values())
    return across * np.pi / abs(result.total_load[1])


DISCRETE = "joints every degree, and the weight of each voussoir where it is"
LEAST = "the thrust of the thinnest arch moves with the weight of its voussoirs, which is on the centreline there"


def rows() -> list[Row]:
    published = {"check": "published"}
    return [
        Row("least thickness over radius, friction 1", 0.107426, thickness(1.0), 1e-3, DISCRETE, **published),
        Row("friction at which the springings begin to slide, at the least thickness", 0.395832,
            friction_needed(thickness(1.0) * (1 + 1e-6)), 2e-3, LEAST, **published),
        Row("the springings begin to slide, by their mathematical programme", 0.3959,
            friction_needed(thickness(1.0) * (1 + 1e-6)), 2e-3, LEAST, **published),
        Row("least friction of any thickness, thickness 0.25", 0.309215, friction_needed(0.25), 1e-4, DISCRETE,
            **published),
        Row("least friction, by their mathematical programme", 0.3093, friction_needed(0.25), 1e-3, DISCRETE,
            **published),
        Row("least thickness over radius at that friction", 0.200637, thickness(0.3093), 2e-2,
            "friction 0.3093: the thickness changes by 1.4 % for 1e-4 of friction there", **published),
        Row("thrust over weight per length and radius at the least friction", 0.485714, thrust(0.25, 0.3093), 1e-3,
            "friction 0.3093; " + DISCRETE, **published),
        Row("thrust over weight per length and radius, friction 1, least thickness", 0.621772,
            thrust(thickness(1.0) * (1 + 1e-5), 1.0), 2e-3, LEAST, **published),
        Row("thrust at the least friction, of that without sliding", 0.78,
            thrust(0.25, 0.3093) / thrust(thickness(1.0) * (1 + 1e-5), 1.0), 6.5e-3, "two digits are printed",
            **published),
        Row("least thickness at friction 0.3093, of that without sliding", 1.87, thickness(0.3093) / thickness(1.0),
            2e-2, "friction 0.3093: the thickness changes by 1.4 % for 1e-4 of friction there", **published),
        Row("an arch of thickness 0.25 stands with friction 0.30", 0.0, float(stands(radial(0.25, 0.30))), 0.0,
            "yes or no", **published),
        Row("least thickness over radius, vertical joints", 0.1095, least(vertical, 0.09, 0.13, 1e-5), 2e-3,
            "120 slices; the limit is reached from below", **published),
    ]  # fmt: skip
