r"""Orders of convergence of displacement, contact pressure and settlement.

*Smooth*: two blocks bent through a joint by an eccentric force (nu = 0), whose solution is known: quadratic
displacements, linear pressure. Q4 errs by its parasitic shear; rotation and pressure converge with the second power of
the mesh size.

*Settlement of a panel*: full base, friction, mortar corners. No closed form; singular corners and the ends of slip
zones lower the order below 2. The observed order from three refinements must lie between 1 and 2.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import concio
from validation_cases.patch import bent, cap_rotation
from validation_cases.row import Row

SOURCE = (
    "Approximation theory of finite elements (for instance Brenner and Scott, The Mathematical Theory of Finite "
    "Element Methods)."
)

LEVELS = (1, 2, 4, 8)
KAPPA = 60.0 * 0.05 / (2e6 * 0.6**3 / 12)


def rotation_errors() -> np.ndarray:
    return np.array([abs(cap_rotation(bent("Q4", n)) / (1.2 * KAPPA) - 1) for n in LEVELS])


def pressure_errors() -> np.ndarray:
    """Largest error of the contact pressure between the two blocks, over the mean pressure."""
    found = []
    for n in LEVELS:
        c = bent("Q4", n).contacts
        joint = np.isclose(c.point[:, 1], 0.6)
        exact = 60.0 / 0.6 + 12 * 60.0 * 0.05 / 0.6**3 * c.point[joint, 0]
        inner = (
            np.abs(c.point[joint, 0]) < 0.29
        )  # an end pair carries half an element: its pressure is that of the middle
        found.append(np.abs(c.pressure[joint] - exact)[inner].max() / 100.0)
    return np.array(found)


@cache
def settlements() -> tuple[float, ...]:
    """Mean top settlement of the dry panel at each level [m]."""
    found = []
    for n in LEVELS:
        result = concio.solve(
            concio.running_bond_panel(courses=3, blocks=3, friction=0.6, top_pressure=10.0, refinement=n)
        )
        body = result.body_index("c3-b2")
        x, u = result.nodes(body), result.node_displacement(body)
        top = np.isclose(x[:, 1], x[:, 1].max())
        found.append(-float(u[top, 1].mean()))
    return tuple(found)


def order(errors: np.ndarray) -> float:
    return float(np.log2(errors[-2] / errors[-1]))


def rows() -> list[Row]:
    s = np.array(settlements())
    second = "asymptotic order, read from the two finest of four meshes"
    return [
        Row("order of the rotation, bending, Q4", 2.0, order(rotation_errors()), 0.1, second, absolute=True),
        Row("order of the contact pressure, bending, Q4", 2.0, order(pressure_errors()), 0.2, second, absolute=True),
        Row(
            "order of the settlement of a dry panel",
            1.5,
            order(np.abs(np.diff(s))),
            0.5,
            "between 1 and 2: corners and ends of slip zones",
            absolute=True,
        ),
    ]


def figure(axes: Any) -> None:
    h = 1 / np.array(LEVELS)
    axes.loglog(h, rotation_errors(), "o-", ms=4, label="rotation (bending)")
    axes.loglog(h, pressure_errors(), "s-", ms=4, label="contact pressure (bending)")
    s = np.array(settlements())
    best = s[-1] + (s[-1] - s[-2]) / (2 ** order(np.abs(np.diff(s))) - 1)
    axes.loglog(h[:-1], np.abs(s[:-1] / best - 1), "^-", ms=4, label="settlement of a panel")
    axes.loglog(h, 0.1 * h**2, "k--", lw=0.8, label="slope 2")
    axes.set(xlabel="mesh size / coarsest", ylabel="relative error")
    axes.legend()
