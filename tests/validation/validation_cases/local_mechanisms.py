"""Local mechanisms of masonry walls under an earthquake: simple overturning and vertical bending.

The quantities are those of the Italian Circolare, C8.7.1.2, worked out by hand for a wall of 6.0 x 0.60 m with a floor
and a roof (per metre of width: 68.4 kN at mid-height, 10 kN at 3.0 m, 6 kN on top), and for a wall of 4.0 x 0.5 m held
sideways at its top under 20 kN. The joint that opens is found by limit analysis over all motions of the courses; the
formula of vertical bending is the minimum over a continuous height, the program's over the joints that there are.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.analysis.seismic.assessment import LocalMechanism
from validation_cases.row import Row

SOURCE = "Circolare C.S.LL.PP. n. 7 of 21 January 2019, C8.7.1.2, formulas C8.7.1.1 to C8.7.1.12; closed forms by hand."

SITE = concio.Site(hazard={"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}, "SLC": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}},
                   soil="B")  # fmt: skip


def courses(n: int, height: float, thickness: float) -> tuple[concio.Body, ...]:
    """Ground and n rigid courses above the level zero."""
    h = height / n
    box = np.array([[0.0, 0.0], [thickness, 0.0], [thickness, h], [0.0, h]])
    ground = concio.Body("ground", np.array([[-1, -0.5], [2, -0.5], [2, 0], [-1, 0.0]]), kind="fixed")
    return (ground, *(concio.Body(f"c{i + 1}", box + np.array([0.0, i * h]), kind="rigid") for i in range(n)))


@cache
def overturning(n: int, curve: Any = "straight") -> LocalMechanism:
    """The wall of simple overturning in n courses."""
    loads = (
        concio.Load("weight", (0.0, -1.0)),
        concio.Load("point", (0.0, -10.0), bodies=(f"c{max(n // 2, 1)}",), at=(0.45, 3.0)),
        concio.Load("point", (0.0, -6.0), bodies=(f"c{n}",), at=(0.40, 6.0)),
    )
    law = {"joint": concio.JointLaw(0.8)}
    model = concio.Model(courses(n, 6.0, 0.6), {"block": concio.Rigid(19.0)}, law, loads=loads)
    found = concio.assess(model, site=SITE, direction="left", control=(f"c{n}", (0.0, 6.0)), curve=curve).worst
    assert found is not None
    return found


@cache
def bending(n: int) -> float:
    """Multiplier of the wall of vertical bending in n courses."""
    loads = (concio.Load("weight", (0.0, -1.0)), concio.Load("weight", (1.0, 0.0), group="live"),
             concio.Load("point", (0.0, -20.0), bodies=(f"c{n}",), at=(0.25, 4.0)))  # fmt: skip
    top = concio.Support("top", f"c{n}", edge=((0.25, 4.0), (0.25, 4.0)), directions="x")
    law = {"joint": concio.JointLaw(0.9)}
    model = concio.Model(courses(n, 4.0, 0.5), {"block": concio.Rigid(19.0)}, law, loads=loads, supports=(top,))
    found = concio.assess(model, site=SITE, direction="right", levels=["SLV"], live="live").worst
    assert found is not None
    return found.multiplier


def best_joint(n: int) -> float:
    """The formula of vertical bending at the joint of n courses where it is least."""
    W, N, t, h = 38.0, 20.0, 0.5, 4.0
    heights = [h * k / n for k in range(1, n)]
    return min(2 * ((W + N) * t / h1 + N * (t - 0.25) / (h - h1)) / W for h1 in heights)


def rows() -> list[Row]:
    wall = overturning(1)
    digits = "all digits given"
    check = next(c for c in wall.checks if c.level == "SLV" and c.kind == "displacement")
    linear = next(c for c in wall.checks if c.level == "SLV" and c.kind == "linear")
    smooth = 2 * (math.sqrt(58 * 0.5) + math.sqrt(20 * 0.25)) ** 2 / (38 * 4)
    return [
        Row("overturning, alpha_0", 27.42 / 271.2, wall.multiplier, 1e-9, "rounding"),
        Row("overturning, alpha_0, thirty courses", 27.42 / 271.2, overturning(30).multiplier, 1e-9, "rounding"),
        Row("overturning, e*", 0.945572, wall.e_star, 1e-6, digits),
        Row("overturning, a_0*", 0.776996, wall.onset, 1e-6, digits, "m/s2"),
        Row("overturning, d_C0", 6 * math.sin(math.atan(27.42 / 271.2)), wall.followed.end, 1e-9, "rounding", "m"),
        Row("overturning, d_0", 0.341839, wall.d0, 2e-6, digits, "m"),
        Row("overturning, d_SLV", 0.136736, wall.limits["SLV"].d, 4e-6, digits, "m"),
        Row("overturning, T_SLV on the straight line", 2.85835, wall.limits["SLV"].T, 2e-6, digits, "s"),
        Row("overturning, T_SLC on the straight line", 3.98127, wall.limits["SLC"].T, 2e-6, digits, "s"),
        Row("overturning, demand at SLV, linear", 1.1772, linear.demand, 1e-6, digits, "m/s2"),
        Row("overturning, demand at SLV, displacement", 0.135969, check.demand, 4e-6, digits, "m"),
        Row("vertical bending, 20 courses", best_joint(20), bending(20), 1e-9, "rounding"),
        Row("vertical bending, 80 courses", best_joint(80), bending(80), 1e-9, "rounding"),
        Row("vertical bending, 80 courses, over the best of all heights", smooth, bending(80), 2e-4,
            "a joint every 5 cm; the best height lies between two"),
    ]  # fmt: skip


def figure(axes: Any) -> None:
    wall = overturning(1, "followed")
    d, alpha = wall.followed.displacement, wall.followed.multiplier
    line = wall.straight
    assert line is not None
    exact = np.tan(np.arctan(27.42 / 271.2) - np.arcsin(d / 6.0))
    straight = np.interp(d, line.displacement, line.multiplier)
    axes.plot(d, 1e4 * (exact - straight), "k-", lw=1, label="closed form")
    axes.plot(d[::6], 1e4 * (alpha - straight)[::6], "o", ms=4, label="followed")
    axes.axhline(0.0, color="k", lw=0.6, ls="--", label="straight line")
    axes.set(xlabel="displacement of the control point [m]", ylabel="alpha less the straight line, times 10 000")
    axes.legend()
