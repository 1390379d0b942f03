"""Uniform compression and pure bending through joints: exact solutions the elements and joints must carry."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "Strength of materials: a bar in series, and beam bending (for instance Timoshenko and Goodier, Theory of "
    "Elasticity)."
)

ROUND = "linear displacements are in the element's space: only rounding is left"


@cache
def settled(nu: float) -> concio.Result:
    """Column of three blocks of different modulus under uniform pressure on a smooth base."""
    model = concio.column(width=0.5, height=0.9, blocks=3, top_pressure=100.0, friction=0.0, mesh_size=0.125)
    moduli = (1e6, 3e6, 5e5)
    bodies = tuple(replace(b, material=b.name) if b.kind != "fixed" else b for b in model.bodies)
    materials = {b.name: concio.Elastic(E=E, nu=nu) for b, E in zip(bodies[1:], moduli, strict=True)}
    return concio.solve(replace(model, bodies=bodies, materials=materials, loads=model.loads[1:]))


@cache
def bent(element: str, refinement: int = 1) -> concio.Result:
    """Two blocks bent by an eccentric force on a rigid smooth cap, within the middle third; nu = 0."""
    b, h, force, e = 0.6, 0.6, 60.0, 0.05
    blocks = [concio.Body(f"b{k}", box(-b / 2, b / 2, k * h, (k + 1) * h), mesh_size=0.15) for k in (0, 1)]
    cap = concio.Body("cap", box(-b / 2, b / 2, 2 * h, 2 * h + 0.1), "cap", "rigid")
    ground = concio.Body("ground", box(-b / 2, b / 2, -0.1, 0.0), kind="fixed")
    model = concio.Model(
        bodies=(ground, *blocks, cap),
        materials={"block": concio.Elastic(E=2e6, nu=0.0), "cap": concio.Rigid()},
        laws={"joint": concio.JointLaw(friction=0.0)},
        loads=(concio.Load("point", (0.0, -force), bodies=("cap",), at=(e, 2 * h + 0.1)),),
        element=element,
        refinement=refinement,
    )
    return concio.solve(model)


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def cap_rotation(result: concio.Result) -> float:
    """Rotation of the cap, clockwise positive (the load is right of the axis) [rad]."""
    u = result.node_displacement("cap")
    return float(u[0, 1] - u[1, 1]) / 0.6


def rows() -> list[Row]:
    series = 100.0 * 0.3 * (1 / 1e6 + 1 / 3e6 + 1 / 5e5)
    kappa = 60.0 * 0.05 / (2e6 * 0.6**3 / 12)
    found = []
    for nu in (0.0, 0.3):
        result = settled(nu)
        found.append(
            Row(f"settlement of three blocks in series, nu = {nu}", series, result.max_settlement, 1e-11, ROUND, "m")
        )
    stress = settled(0.3).stress.mean[1:]
    found.append(
        Row(
            "vertical stress, worst block",
            -100.0,
            float(stress[np.abs(stress[:, 1] + 100).argmax(), 1]),
            1e-10,
            ROUND,
            "kN/m2",
        )
    )
    quadratic = "the exact displacement is quadratic and in the element's space"
    for element in ("Q4I", "Q8", "Q9"):
        found.append(
            Row(
                f"rotation of the cap in pure bending, {element}",
                kappa * 1.2,
                cap_rotation(bent(element)),
                1e-9,
                quadratic,
                "rad",
            )
        )
    stress = bent("Q8").stress.at_nodes(1)[:, 1]
    edge = -60.0 / 0.6 - 6 * 60.0 * 0.05 / 0.6**2
    found.append(Row("largest bending stress, Q8", edge, float(stress.min()), 1e-9, quadratic, "kN/m2"))
    return found
