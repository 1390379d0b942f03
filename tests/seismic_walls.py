"""Walls and sites for tests of seismic assessments."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio import Body, JointLaw, Load, Model, Rigid, Site, Support, Tie

HAZARD = {
    "SLD": {"a_g": 0.07, "F0": 2.40, "Tc": 0.28},
    "SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32},
    "SLC": {"a_g": 0.25, "F0": 2.45, "Tc": 0.33},
}


def site(**more: Any) -> Site:
    """Return the site of the worked example."""
    return Site(**{"hazard": HAZARD, "soil": "B", **more})


def ground(x0: float = -1.0, x1: float = 2.0) -> Body:
    """Return a fixed body below the level zero."""
    return Body("ground", np.array([[x0, -0.5], [x1, -0.5], [x1, 0.0], [x0, 0.0]]), kind="fixed", role="ground")


def courses(n: int, height: float, thickness: float) -> list[Body]:
    """Return n rigid courses c1 ... cn from the level zero, between x = 0 and the thickness."""
    h = height / n
    return [
        Body(f"c{i + 1}", np.array([[0, i * h], [thickness, i * h], [thickness, (i + 1) * h], [0, (i + 1) * h]]),
             kind="rigid")
        for i in range(n)
    ]  # fmt: skip


def overturning(
    n: int = 1, *, strength: float | None = None, friction: float = 0.8, ties: tuple[Tie, ...] = ()
) -> Model:
    """Return the wall of the worked example, 6.0 x 0.60 m, in n courses, with a floor and a roof."""
    loads = (
        Load("weight", (0.0, -1.0)),
        Load("point", (0.0, -10.0), bodies=(f"c{max(n // 2, 1)}",), at=(0.45, 3.0)),
        Load("point", (0.0, -6.0), bodies=(f"c{n}",), at=(0.40, 6.0)),
    )
    law = JointLaw(friction, compressive_strength=strength)
    return Model((ground(), *courses(n, 6.0, 0.6)), {"block": Rigid(19.0)}, {"joint": law}, loads=loads, ties=ties)


def bending(n: int, *, N: float = 20.0) -> Model:
    """Return the wall of vertical bending, 4.0 x 0.5 m, W = 38 kN, in n courses, held sideways at its top."""
    loads = [Load("weight", (0.0, -1.0)), Load("weight", (1.0, 0.0), group="live")]
    if N:
        loads.append(Load("point", (0.0, -N), bodies=(f"c{n}",), at=(0.25, 4.0)))
    top = Support("top", f"c{n}", edge=((0.25, 4.0), (0.25, 4.0)), directions="x")
    return Model(
        (ground(), *courses(n, 4.0, 0.5)), {"block": Rigid(19.0)}, {"joint": JointLaw(0.9)}, loads=tuple(loads),
        supports=(top,),
    )  # fmt: skip
