r"""Stack of elastic blocks between two rigid walls with friction, pressed on top: silo friction.

In a stack that slips down along both walls the vertical force decays as N(z) = N0 exp(-alpha z). Janssen's balance with
a constant ratio k of horizontal to vertical pressure gives alpha = 2 mu k / w; for a laterally confined elastic block
in plane stress k = nu. The elastic solution is sharper: with the stress function exp(-alpha z) (A cos(alpha x) +
B alpha x sin(alpha x)), u_x = 0 and tau = mu sigma_x at x = h = w / 2, alpha is the smallest positive root of

    det [ alpha^2 I_j - nu g_j'(h) ;  g_j'(h) - mu alpha g_j(h) ] = 0,     I_j = integral of g_j from 0 to h.

Both are closed forms, independent of contact algorithms.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import brentq

import concio
from validation_cases.row import Row

SOURCE = (
    "H. A. Janssen, Versuche über Getreidedruck in Silozellen, Z. VDI 39 (1895); the eigenvalue by Airy's stress "
    "function (this project)."
)

WIDTH, HEIGHT, MU, NU, BLOCKS = 0.4, 2.4, 0.5, 0.3, 12


def janssen() -> float:
    """Alpha of Janssen's balance with k = nu [1/m]."""
    return 2 * MU * NU / WIDTH


def elastic_alpha() -> float:
    """Alpha of plane elasticity [1/m]."""
    h = WIDTH / 2

    def determinant(a: float) -> float:
        s = a * h
        cos, sin = np.cos(s), np.sin(s)
        g = np.array([cos, s * sin])
        slope = a * np.array([-sin, sin + s * cos])
        integral = np.array([sin / a, (sin - s * cos) / a])
        first, second = a**2 * integral - NU * slope, slope - MU * a * g
        return float(first[0] * second[1] - first[1] * second[0])

    return float(brentq(determinant, 0.5 * janssen(), 1.5 * janssen(), xtol=1e-14))


@cache
def pressed(refinement: int = 1, method: str = "auto") -> concio.Result:
    """Blocks that stick to each other between rough walls, on a smooth base."""
    model = concio.column(
        width=WIDTH,
        height=HEIGHT,
        blocks=BLOCKS,
        top_pressure=100.0,
        friction=5.0,
        mesh_size=0.1,
        refinement=refinement,
        base_friction=0.0,
        block=concio.Elastic(E=1e6, nu=NU),
    )
    walls = [
        concio.Body(name, np.array([[x0, 0], [x1, 0], [x1, HEIGHT], [x0, HEIGHT]]), kind="fixed", role="side wall")
        for name, x0, x1 in (("left", -WIDTH, -WIDTH / 2), ("right", WIDTH / 2, WIDTH))
    ]
    model = replace(
        model,
        bodies=(*model.bodies, *walls),
        laws={**model.laws, "wall": concio.JointLaw(MU)},
        rules=(*model.rules, concio.JointRule("wall", ("side wall", "*"))),
    )
    return concio.solve(model, method=method)


def bed_forces(result: concio.Result) -> tuple[np.ndarray, np.ndarray]:
    """Depths below the top and normal forces of the bed joints, from above [m], [kN]."""
    j = result.joints
    beds = np.abs(j.normal[:, 1]) > 0.9
    depth, force = HEIGHT - j.middle[beds, 1], j.N[beds]
    order = np.argsort(depth)
    return depth[order], force[order]


def decay(result: concio.Result) -> float:
    """Alpha between two bed joints one width and more away from both ends [1/m]."""
    z, n = bed_forces(result)
    inside = (z > 1.5 * WIDTH - 1e-9) & (z < HEIGHT - 1.5 * WIDTH + 1e-9)
    return float(-np.polyfit(z[inside], np.log(n[inside]), 1)[0])


def rows() -> list[Row]:
    coarse, fine = pressed(1), pressed(2)
    z, n = bed_forces(fine)
    total = 100.0 * WIDTH
    c = fine.contacts
    away = (np.abs(c.pairs.normal[:, 0]) > 0.9) & (c.point[:, 1] > 1e-6) & (c.normal_force > 1e-9 * total)
    used = np.abs(c.friction_force[away, 0]) / (MU * c.normal_force[away])
    other = pressed(1, "lemke")
    return [
        Row(
            "decay alpha, elastic eigenvalue",
            elastic_alpha(),
            decay(fine),
            0.002,
            "four elements across each block",
            "1/m",
        ),
        Row(
            "decay alpha, Janssen with k = nu",
            janssen(),
            decay(fine),
            0.05,
            "Janssen takes stresses uniform across: an error of the order (alpha w)^2 = 9 %, less half",
            "1/m",
        ),
        Row(
            "force on the lowest bed joint, Janssen",
            total * np.exp(-janssen() * z[-2]),
            float(n[-2]),
            0.05,
            "Janssen's assumption, and the two ends",
            "kN",
        ),
        Row(
            "least used share of friction on the walls",
            1.0,
            float(used.min()),
            1e-9,
            "every pressed pair of the walls slips",
        ),
        Row(
            "largest displacement, method lemke",
            float(np.abs(other.displacement).max()),
            float(np.abs(coarse.displacement).max()),
            1e-9,
            "same discrete problem, other algorithm; forces at corners are not unique, displacements are",
            "m",
            check="second method",
        ),
    ]


def figure(axes: Any) -> None:
    z, n = bed_forces(pressed(2))
    s = np.linspace(0, HEIGHT, 50)
    axes.plot(s, np.exp(-janssen() * s), "k--", lw=1, label="Janssen, k = nu")
    axes.plot(z, n / (100 * WIDTH), "o", ms=4, label="concio")
    axes.set(xlabel="depth [m]", ylabel="N / N0", ylim=(0, 1.05))
    axes.legend()
