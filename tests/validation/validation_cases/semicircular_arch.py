"""Least thickness of a semicircular arch under its own weight.

Milankovitch (1907), with the true line of gravity of each part: t / R = 0.1075, hinges at springings, crown and near
54.5 degrees from the crown. Fewer voussoirs leave fewer places for hinges: thinner arches stand, and the limit is
reached from below. Sliding is excluded by a large friction; with friction 0.5 the thin arch still stands, since its
thrust never leaves the cone.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import concio
from concio.solvers.statics.existence import find_mechanism, statically_admissible
from validation_cases.row import Row

SOURCE = (
    "M. Milankovitch, Theorie der Druckkurven, Z. Math. Phys. 55 (1907); J. Heyman, Int. J. Mech. Sci. 11 (1969);"
    " G. Alexakis and N. Makris, Arch. Appl. Mech. 85 (2015)."
)


def model(voussoirs: int, ratio: float, friction: float = 20.0) -> concio.Model:
    """Arch of centreline radius 1 and thickness ``ratio``."""
    return concio.arch(
        span=2 - ratio, ring=ratio, voussoirs=voussoirs, block="rigid", friction=friction, chord_tolerance=1e-6
    )


def stands(voussoirs: int, ratio: float) -> bool:
    return statically_admissible(concio.assemble(model(voussoirs, ratio)).problem()).exists


@cache
def least(voussoirs: int, tolerance: float = 2e-6) -> float:
    low, high = 0.08, 0.12
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(voussoirs, middle) else (middle, high)
    return high


@cache
def hinges() -> list[float]:
    """Angles of the opening joints from the crown just below the least thickness [degrees]."""
    problem = concio.assemble(model(60, 0.106)).problem()
    mechanism = find_mechanism(problem)
    if mechanism is None:
        return []
    pairs = concio.assemble(model(60, 0.106)).pairs
    opens = problem.C_n @ mechanism.velocity > 1e-6
    angle = np.degrees(np.arctan2(np.abs(pairs.point[opens, 0]), pairs.point[opens, 1]))
    return sorted(set(np.round(angle, 3).tolist()))


def rows() -> list[Row]:
    found = [
        Row(
            "least thickness over radius, 100 voussoirs",
            0.1075,
            least(100),
            0.001,
            "joints every 1.8 degrees, one of them at 54; the limit is reached from below",
            check="published",
        ),
        Row(
            "thickness 0.1076, 61 voussoirs, friction 0.5 stands",
            1.0,
            float(concio.solve(model(61, 0.1076, 0.5), on_failure="return").solved),
            0.0,
            "yes or no",
            check="published",
        ),
    ]
    haunch = [a for a in hinges() if 10 < a < 80]
    found.append(
        Row(
            "angle of the haunch hinge from the crown, 60 voussoirs",
            54.5,
            float(np.mean(haunch)) if haunch else np.nan,
            3.0,
            "joints every 3 degrees",
            "degrees",
            absolute=True,
            check="published",
        )
    )
    return found


def figure(axes: Any) -> None:
    count = [8, 12, 20, 32, 60, 100]
    axes.plot(count, [least(n) for n in count], "o-", ms=4, label="concio")
    axes.axhline(0.1075, color="k", lw=1, label="Milankovitch")
    axes.set(xscale="log", xlabel="voussoirs", ylabel="least t / R")
    axes.legend()
