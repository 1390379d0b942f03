r"""Walls that stand on their base and are pushed at the top.

*Elastic*: a wall held on its base, P at the top: Timoshenko's beam with shear, P h^3 / 3EI + 6 P h / (5 G A); the held
base stiffens it a little.

*Dry*, of rigid blocks in stack bond, one block a course: turns about the toe at P h = W b / 2, whatever the number of
courses, unless the top block, which alone is pushed, slides first at P = mu W / n.

*Uncracked dry wall*: while the resultant stays within the middle third of every joint nothing opens, and the dry
elastic wall is the monolithic one. By beam theory the first joint opens
when P h = N b / 6 (precompressed, no weight). Contact is stated on nodal forces: the force of the heel's pair,
(2 p1 + p2) h / 6 for elements of length h = b / 4, vanishes at 1.2 times that.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import concio
from concio.solvers.statics.associated_limit import associated_limit
from validation_cases.row import Row

SOURCE = "S. Timoshenko, Phil. Mag. 41 (1921), for the shear of beams; statics by hand."

B, H, E, NU, P = 0.5, 4.0, 3e6, 0.0, 1.0


@cache
def elastic(element: str) -> concio.Result:
    """One elastic body held on its base."""
    body = concio.Body("wall", box(-B / 2, B / 2, 0.0, H), mesh_size=0.125)
    shear = concio.Body("cap", box(-B / 2, B / 2, H, H + 0.1), "cap", "rigid")
    model = concio.Model(
        bodies=(body, shear),
        materials={"block": concio.Elastic(E=E, nu=NU), "cap": concio.Rigid()},
        laws={"joint": concio.JointLaw(1e3)},
        supports=(concio.Support("base", "wall", edge=((-B / 2, 0.0), (B / 2, 0.0))),),
        loads=(
            concio.Load("point", (P, 0.0), bodies=("cap",), at=(0.0, H)),
            concio.Load("point", (0.0, -1000.0), bodies=("cap",), at=(0.0, H)),
        ),
        element=element,
    )
    return concio.solve(model)


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def beam() -> float:
    """Displacement of the top by Timoshenko's beam [m]."""
    inertia, shear = B**3 / 12, E / (2 * (1 + NU))
    return P * H**3 / (3 * E * inertia) + 6 * P * H / (5 * shear * B)


def sway(result: concio.Result, body: str) -> float:
    x, u = result.nodes(body), result.node_displacement(body)
    return float(u[np.isclose(x[:, 1], x[:, 1].min()), 0].mean())


@cache
def overturning(courses: int, mu: float = 0.7) -> float:
    """Limit of P for rigid blocks in stack bond, weight 20 kN/m3 [kN]."""
    base = concio.column(width=B, height=H, blocks=courses, block="rigid", friction=mu)
    push = concio.Load("point", (1.0, 0.0), bodies=(base.bodies[-1].name,), at=(-B / 2, H), group="live")
    assembly = concio.assemble(replace(base, loads=(*base.loads, push)))
    dead = assembly.problem({"live": 0.0})
    return associated_limit(dead, assembly.problem().f - dead.f).multiplier


@cache
def dry(share: float) -> concio.Result:
    """Dry column of eight elastic blocks under a rigid cap with N = 100 kN and ``share`` of the first-crack force."""
    base = concio.column(
        width=B, height=H, blocks=8, friction=0.7, block=concio.Elastic(E=E, nu=NU), element="Q4I", mesh_size=0.125
    )
    cap = concio.Body("cap", box(-B / 2, B / 2, H, H + 0.1), "cap", "rigid")
    crack = 100.0 * B / 6 / H
    loads = (
        concio.Load("point", (0.0, -100.0), bodies=("cap",), at=(0.0, H)),
        concio.Load("point", (share * crack, 0.0), bodies=("cap",), at=(0.0, H)),
    )
    model = replace(base, bodies=(*base.bodies, cap), materials={**base.materials, "cap": concio.Rigid()}, loads=loads)
    return concio.solve(model)


def lowest_open(result: concio.Result) -> int:
    """Open pairs of the joint on the ground."""
    c = result.contacts
    low = c.point[:, 1] < 1e-9
    return int((low & (c.state == 0)).sum())


def rows() -> list[Row]:
    weight = 20.0 * B * H
    scale = 100.0 * B / 6 / H / P
    nodal = "a count; with four elements the heel's nodal force (2 p1 + p2) h / 6 vanishes at 1.2"
    found = [
        Row(
            f"elastic wall held on its base, {element}: sway",
            beam(),
            sway(elastic(element), "cap"),
            0.005,
            "plane problem against beam theory: held base and cap stiffen over a length b/8 or so",
            "m",
        )
        for element in ("Q4I", "Q8")
    ]
    found += [
        Row(
            f"rigid blocks, {n} courses: {'overturning' if n < 12 else 'sliding of the top block'}",
            min(weight * B / (2 * H), 0.7 * weight / n),
            overturning(n),
            1e-9,
            "statics",
            "kN",
        )
        for n in (1, 4, 12)
    ]
    found += [
        Row(
            "dry elastic wall before the first crack: sway",
            0.9 * scale * beam(),
            sway(dry(0.9), "cap"),
            0.005,
            "nothing opens, so the monolithic beam",
            "m",
        ),
        Row("open pairs of the lowest joint at 1.19 of the first-crack force", 0.0, lowest_open(dry(1.19)), 0.0, nodal),
        Row("open pairs of the lowest joint at 1.21 of the first-crack force", 1.0, lowest_open(dry(1.21)), 0.0, nodal),
    ]
    return found
