r"""Flat arch whose abutments give way: least thrust.

Rigid voussoirs between abutments that spread turn about two lower corners at the springings and the upper edge of the
crown joint. Moments of half the arch about its springing corner give the thrust

.. math:: H h = \gamma b \int_0^h \int_0^{s/2 + y \cot\theta} (s/2 - x)\,dx\,dy
              = \gamma b \left(\frac{s^2 h}{8} - \frac{h^3 \cot^2\theta}{6}\right).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = "Equilibrium of three hinges by hand; flat arches: J. Heyman, The Stone Skeleton (1995)."

SPAN, RING, SKEW, GAMMA = 1.2, 0.3, 70.0, 20.0


@cache
def spread(movement: float = 1e-3, voussoirs: int = 6, method: str = "auto") -> concio.Result:
    """Flat arch of rigid voussoirs; each abutment moves outwards."""
    model = concio.arch(
        shape="flat",
        span=SPAN,
        ring=RING,
        voussoirs=voussoirs,
        skew=SKEW,
        block="rigid",
        friction=2.0,
        unit_weight=GAMMA,
    )
    supports = tuple(
        concio.Support(f"{side} spread", f"{side} abutment", displacement=(sign * movement, 0.0))
        for side, sign in (("left", -1.0), ("right", 1.0))
    )
    return concio.solve(replace(model, supports=supports), method=method)


def least_thrust() -> float:
    cot = 1 / np.tan(np.deg2rad(SKEW))
    return float(GAMMA * (SPAN**2 / 8 - RING**2 * cot**2 / 6))


def rows() -> list[Row]:
    result = spread()
    thrust = result.reactions["left abutment"][0]
    crown = np.flatnonzero(np.abs(result.joints.middle[:, 0]) < 1e-9)[0]
    half = GAMMA * RING * (SPAN / 2 + RING / 2 / np.tan(np.deg2rad(SKEW)))
    centre = result.joints.middle[crown, 1] + result.joints.eccentricity[crown] * result.joints.tangent[crown, 1]
    sink = 1e-3 * SPAN / 2 / RING
    crown_sink = -max(result.node_displacement(name)[:, 1].min() for name in ("v03", "v04"))
    return [
        Row("least thrust", least_thrust(), thrust, 1e-9, "rigid bodies: only rounding", "kN"),
        Row(
            "vertical reaction of an abutment",
            half,
            result.reactions["left abutment"][1],
            1e-9,
            "half of the weight",
            "kN",
        ),
        Row("height of the thrust at the crown", RING, float(centre), 1e-9, "hinge at the extrados", "m"),
        Row(
            "sinking of the crown",
            sink,
            float(crown_sink),
            1e-9,
            "spread x (s / 2) / h, for a hinge at each springing",
            "m",
        ),
        Row(
            "least thrust, method lemke",
            thrust,
            spread(method="lemke").reactions["left abutment"][0],
            1e-9,
            "another algorithm",
            "kN",
            check="second method",
        ),
    ]
