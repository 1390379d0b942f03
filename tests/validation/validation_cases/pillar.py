r"""Pillar without tensile strength under a vertical force N at eccentricity e.

On a section b wide and t = 1 thick, pressures linear across and zero tension:

* e <= b/6: largest pressure N/b (1 + 6 e / b), curvature N e / EI;
* e > b/6: the section is cracked, effective width c = 3 (b/2 - e), largest pressure 2 N / c, curvature
  2 N / (E c^2).

A compliant joint of stiffness k_n between rigid blocks turns by p / (k_n c) in place of the curvature. A pillar of many
elastic blocks shows the curvature as the turn of its cap over its height; cracks can open only at joints, so the
cracked pillar tends to the closed form as blocks become low against the width.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "Statics of no-tension sections; e.g. J. Heyman, The Stone Skeleton (1995), and A. Frisch-Fay, Int. J. Solids"
    " Struct. 11 (1975) for the cracked column."
)

B, N, K_N, E = 0.6, 60.0, 1e6, 2e6
CAP = 0.1


def pressure_and_width(e: float) -> tuple[float, float]:
    """Largest pressure [kN/m2] and width over which pressure falls to zero (larger than b where uncracked) [m]."""
    if e <= B / 6:
        p = N / B * (1 + 6 * e / B)
        return p, p / (12 * N * e / B**3) if e else np.inf
    c = 3 * (B / 2 - e)
    return 2 * N / c, c


@cache
def compliant(e: float, soft: bool = False) -> concio.Result:
    """Rigid block, or a stiff elastic one with 60 contact points, on a compliant joint."""
    stone = concio.Elastic(E=1e10, nu=0.0) if soft else concio.Rigid()
    block = concio.Body(
        "b01",
        box(-B / 2, B / 2, 0.0, 0.3),
        kind="elastic" if soft else "rigid",
        grid=(np.linspace(-B / 2, B / 2, 61), np.linspace(0, 0.3, 2)) if soft else None,
    )
    model = concio.Model(
        bodies=(concio.Body("ground", box(-B / 2, B / 2, -0.1, 0.0), kind="fixed"), block),
        materials={"block": stone},
        laws={"joint": concio.JointLaw(0.5, normal_stiffness=K_N)},
        loads=(concio.Load("point", (0.0, -N), bodies=("b01",), at=(e, 0.3)),),
    )
    return concio.solve(model)


@cache
def elastic(e: float, blocks: int, method: str = "auto") -> concio.Result:
    """Pillar one metre high of elastic blocks under a rigid cap, smooth at cap and ground."""
    size = 1.0 / blocks
    across = np.linspace(-B / 2, B / 2, 25)
    stones = [
        concio.Body(
            f"b{k:02d}",
            box(-B / 2, B / 2, k * size, (k + 1) * size),
            role="stone",
            grid=(across, np.linspace(k * size, (k + 1) * size, max(2, 20 // blocks) + 1)),
        )
        for k in range(blocks)
    ]
    cap = concio.Body("cap", box(-B / 2, B / 2, 1.0, 1.0 + CAP), "cap", "rigid", role="cap")
    ground = concio.Body("ground", box(-B / 2, B / 2, -0.1, 0.0), kind="fixed", role="ground")
    model = concio.Model(
        bodies=(ground, *stones, cap),
        materials={"block": concio.Elastic(E=E, nu=0.0), "cap": concio.Rigid()},
        laws={"joint": concio.JointLaw(0.6), "smooth": concio.JointLaw(0.0)},
        rules=(concio.JointRule("joint"), concio.JointRule("smooth", ("cap", "*"))),
        loads=(concio.Load("point", (0.0, -N), bodies=("cap",), at=(e, 1.0 + CAP)),),
        element="Q4I",
    )
    return concio.solve(model, method=method)


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def turn(result: concio.Result, name: str) -> float:
    """Rotation of a block from its two lower corners, clockwise positive [rad]."""
    x, u = result.nodes(name), result.node_displacement(name)
    low = np.flatnonzero(np.isclose(x[:, 1], x[:, 1].min()))
    a, b = low[np.argmin(x[low, 0])], low[np.argmax(x[low, 0])]
    return float((u[a, 1] - u[b, 1]) / (x[b, 0] - x[a, 0]))


def joint_turn(e: float) -> float:
    p, c = pressure_and_width(e)
    return p / (K_N * c)


def curvature(e: float) -> float:
    p, c = pressure_and_width(e)
    return p / (E * c)


def rows() -> list[Row]:
    uncracked, cracked = 0.08, 0.2
    whole, open_, fine = compliant(uncracked), compliant(0.23), compliant(cracked, True)
    five = "pressure is linear, and the rule of five points integrates its moment exactly"
    found = [
        Row(
            "uncracked, rigid block: largest pressure",
            pressure_and_width(uncracked)[0],
            float(whole.contacts.pressure.max()),
            1e-10,
            five,
            "kN/m2",
        ),
        Row("uncracked, rigid block: rotation", joint_turn(uncracked), turn(whole, "b01"), 1e-10, five, "rad"),
        Row(
            "cracked, 61 contact points: largest pressure",
            pressure_and_width(cracked)[0],
            float(fine.contacts.pressure.max()),
            0.005,
            "the tip of the crack lies between two points: second order in their distance over c = 1/30",
            "kN/m2",
        ),
        Row(
            "cracked, 61 contact points: rotation",
            joint_turn(cracked),
            turn(fine, "b01"),
            0.01,
            "as the pressure",
            "rad",
        ),
        Row(
            "cracked, rigid block, 5 contact points: largest pressure",
            pressure_and_width(0.23)[0],
            float(open_.contacts.pressure.max()),
            0.2,
            "five points on the whole joint, of which two or three carry: coarse by construction",
            "kN/m2",
        ),
        Row(
            "uncracked, 5 elastic blocks: rotation of the cap",
            curvature(uncracked),
            turn(elastic(uncracked, 5), "cap"),
            1e-8,
            "pure bending is in the space of Q4I",
            "rad",
        ),
    ]
    for blocks, tolerance in ((5, 0.02), (20, 0.005)):
        found.append(
            Row(
                f"cracked, {blocks} elastic blocks: rotation of the cap",
                curvature(cracked),
                turn(elastic(cracked, blocks), "cap"),
                tolerance,
                f"blocks {1 / blocks:g} m high against c = 0.3 m: between joints the section is whole",
                "rad",
            )
        )
    found.append(
        Row(
            "cracked, 5 elastic blocks: rotation, method sparse-lemke",
            turn(elastic(cracked, 5, "sparse-lemke"), "cap"),
            turn(elastic(cracked, 5), "cap"),
            1e-9,
            "same discrete problem, other algorithm",
            "rad",
            check="second method",
        )
    )
    return found


def figure(axes: Any) -> None:
    share = np.linspace(0.02, 0.42, 60)
    axes.plot(share, [curvature(s * B) * 1e6 for s in share], "k-", lw=1, label="closed form")
    some = np.array([0.05, 0.12, 0.2, 0.28, 0.34, 0.4])
    for blocks, mark in ((5, "s"), (20, "o")):
        axes.plot(
            some, [turn(elastic(float(s) * B, blocks), "cap") * 1e6 for s in some], mark, ms=4, label=f"{blocks} blocks"
        )
    axes.set(xlabel="e / b", ylabel="rotation of the cap [1e-6 rad]")
    axes.legend()
