r"""Elastic strip clamped between two plates and pulled at one end: stick and slip zones.

A strip of stiffness EA is pressed by two plates; each transmits at most mu p for each unit of area, together tau for
each unit of length. Pulled with F it slips over a length l and sticks beyond:

* hard joint: l = F / tau, displacement of the end F^2 / (2 EA tau);
* compliant joint (tangential stiffness k for each unit of length): in the stick zone EA u'' = k u, decaying with
  beta = sqrt(k / EA). The slip zone has the length s = F / tau - 1 / beta, its front moves by tau / k, and the end by
  u = tau / k + (tau / beta) s / EA + tau s^2 / (2 EA).

The strip is thin (a fiftieth of the slip length) and nu = 0, so that stresses are uniform across it. Self-weight plays
no part; the pressure comes from the upper plate, which is lowered.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "Shear-lag: O. Volkersen, Luftfahrtforschung 15 (1938); frictional pull-out closed forms derived in the "
    "module's docstring."
)

E, H, LENGTH, MU, PRESSURE, FORCE = 1e6, 0.02, 3.0, 0.5, 100.0, 100.0
TAU = 2 * MU * PRESSURE
EA = E * H
K_T = 2 * 2e5
Kind = Literal["hard", "compliant"]


@cache
def pulled(kind: Kind, elements: int = 120) -> concio.Result:
    law = concio.JointLaw(MU) if kind == "hard" else concio.JointLaw(MU, tangential_stiffness=K_T / 2)
    strip = concio.Body(
        "strip", box(0, LENGTH, 0, H), grid=(np.linspace(0, LENGTH, elements + 1), np.linspace(0, H, 3))
    )
    plates = [
        concio.Body(name, box(0, LENGTH, low, low + 0.1), kind="fixed") for name, low in (("lower", -0.1), ("upper", H))
    ]
    model = concio.Model(
        bodies=(*plates, strip),
        materials={"block": concio.Elastic(E=E, nu=0.0)},
        laws={"joint": law},
        loads=(concio.Load("traction", (-FORCE / H, 0.0), edge=((0, 0), (0, H)), group="pull"),),
        supports=(concio.Support("press", "upper", displacement=(0.0, -PRESSURE * H / E), group="pressure"),),
        element="Q4",
    )
    return concio.solve(model)


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def end_displacement(result: concio.Result) -> float:
    """Mean displacement of the pulled end, outwards positive [m]."""
    at = result.nodes("strip")[:, 0] == 0
    u = -result.node_displacement("strip")[at, 0]
    return float((u[0] + 2 * u[1] + u[2]) / 4)


def slip_length(result: concio.Result) -> float:
    """Length over which the lower joint slips [m]."""
    c = result.contacts

    low = c.point[:, 1] < H / 2
    return float(c.pairs.length[low & (c.state > 1)].sum())


def expected(kind: Kind) -> tuple[float, float]:
    """Slip length and displacement of the end [m]."""
    if kind == "hard":
        return FORCE / TAU, FORCE**2 / (2 * EA * TAU)
    beta = np.sqrt(K_T / EA)
    s = FORCE / TAU - 1 / beta
    return s, TAU / K_T + TAU / beta * s / EA + TAU * s**2 / (2 * EA)


def rows() -> list[Row]:
    found = []
    for kind in ("hard", "compliant"):
        length, end = expected(kind)
        result = pulled(kind)
        element = LENGTH / 120
        found += [
            Row(
                f"length of the slip zone, {kind} joint",
                length,
                slip_length(result),
                1.5 * element,
                "one element and a half",
                "m",
                absolute=True,
            ),
            Row(
                f"displacement of the pulled end, {kind} joint",
                end,
                end_displacement(result),
                0.005,
                "the free end disturbs the pressure over a length h: order h / l = 2 %, of which a quarter",
                "m",
            ),
        ]
    other = concio.solve(pulled("hard").model, method="sparse-lemke")
    found.append(
        Row(
            "displacement of the pulled end, method sparse-lemke",
            end_displacement(other),
            end_displacement(pulled("hard")),
            1e-9,
            "same discrete problem, other algorithm",
            "m",
            check="second method",
        )
    )
    return found


def figure(axes: Any) -> None:
    for kind, mark in (("hard", "o"), ("compliant", "s")):
        c = pulled(kind).contacts
        low = c.point[:, 1] < H / 2
        order = np.argsort(c.point[low, 0])
        axes.plot(
            c.point[low, 0][order],
            np.abs(c.shear[low, 0][order]) / (MU * PRESSURE),
            mark + "-",
            ms=2,
            label=f"{kind} joint",
        )
        axes.axvline(expected(kind)[0], color="k", lw=0.8, ls="--")
    axes.set(xlabel="x [m]", ylabel="friction / (mu p)", xlim=(0, 2))
    axes.legend()
