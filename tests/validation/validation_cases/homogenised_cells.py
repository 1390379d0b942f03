r"""Homogenised running bond: moduli and strength from one periodic cell.

Rigid blocks b long and a high, half a block of lap, unit thickness. Bed joints have the stiffnesses k_n, k_s for each
area, head joints k_n', k_s'. With P = b k_s' + k_n b^2 / (4a) and Q = a k_s

.. math:: A_{xxxx} = b k_n' + k_s b^2 / (4a), \quad A_{yyyy} = a k_n, \quad A_{xyxy} = P Q / (P + Q),

and no coupling between x and y: blocks shift and turn. With Coulomb joints of friction f <= 1, cohesion c and tensile
strength c/f, and k = b / (2a), the stresses carried are those with

.. math:: |S_{xy}| + f S_{yy} \le c, \quad f(k+f)|S_{xy}| + f S_{xx} + f^2 k S_{yy} \le c(1 + fk), \quad
          (1+fk)|S_{xy}| + f S_{xx} + k S_{yy} \le c(1 + k/f).

Brickwork with mortar bonded to the bricks is compared with one mesh over the whole cell, periodic by elimination,
without contact.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from cells import periodic_elements
from validation_cases.row import Row

SOURCE = (
    "P. de Buhan and G. de Felice, A homogenization approach to the ultimate strength of brick masonry, J. Mech. Phys."
    " Solids 45 (1997) 1085-1104, for the strength domain; moduli derived by hand; periodic elements by scikit-fem."
)

A, B, KN, KS, KN_HEAD, KS_HEAD = 0.06, 0.25, 3000.0, 1200.0, 2000.0, 700.0
BRICK = (0.21, 0.052, 0.01)
"""Length, height and joint of the brickwork [m]."""


@cache
def moduli(repeat: tuple[int, int]) -> concio.analysis.cells.moduli.Moduli:
    bed = concio.JointLaw(0.6, normal_stiffness=KN, tangential_stiffness=KS)
    head = concio.JointLaw(0.6, normal_stiffness=KN_HEAD, tangential_stiffness=KS_HEAD)
    return concio.homogenise(concio.cell(block="rigid", block_size=(B, A), friction=bed, head=head, repeat=repeat))


@cache
def brickwork(ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Moduli of brickwork with mortar ``ratio`` times softer, from blocks in contact and from one mesh."""
    length, tall, joint = BRICK
    brick, mortar = concio.Elastic(E=1.1e7, nu=0.2), concio.Elastic(E=1.1e7 / ratio, nu=0.2)
    cell = concio.cell(block_size=(length, tall), joint=joint, block=brick, mortar=mortar, mesh_size=0.02)
    pitch = length + joint

    def young(p: np.ndarray) -> np.ndarray:
        course, y = p[1] // (tall + joint), p[1] % (tall + joint)
        x = (p[0] + joint / 2 - pitch / 2 * course) % pitch
        return np.where((y < tall) & (x > joint), brick.E, mortar.E)

    marks = np.unique(np.round(np.concatenate([b.grid[0] % pitch for b in cell.bodies]), 9))
    ys = np.unique(np.round(np.concatenate([b.grid[1] for b in cell.bodies]), 9))
    other = periodic_elements(np.concatenate([marks, [pitch + marks[0]]]), ys, young, 0.2)
    return concio.homogenise(cell).matrix, other


def rows() -> list[Row]:
    exact = "closed form, linear equations solved to rounding"
    P, Q = B * KS_HEAD + KN * B**2 / (4 * A), A * KS
    found = []
    for repeat in ((1, 1), (2, 1), (3, 2)):
        word = f"cell of {repeat[0]} x {2 * repeat[1]} blocks"
        matrix = moduli(repeat).matrix
        for name, k, value in (
            ("A_xxxx", 0, B * KN_HEAD + KS * B**2 / (4 * A)),
            ("A_yyyy", 1, A * KN),
            ("A_xyxy", 2, P * Q / (P + Q)),
        ):
            found.append(Row(f"{word}: {name}", value, float(matrix[k, k]), 1e-10, exact, "kN/m2"))
    a, b, f = 0.175, 0.4, 0.65
    k = b / (2 * a)
    law = concio.JointLaw(f, cohesion=1.0, tensile_strength=1.0 / f)
    cell = concio.cell(block="rigid", block_size=(b, a), friction=law)
    directions = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -1, 0), (-1, -1, 1)]
    rays = concio.strength(cell, directions, coulomb=False, faces=False).rays
    domain = [
        (np.array([0, f, 1]), 1.0),
        (np.array([f, f * f * k, f * (k + f)]), 1 + f * k),
        (np.array([f, k, 1 + f * k]), 1 + k / f),
    ]
    for ray in rays:
        D = np.array([*ray.direction[:2], abs(ray.direction[2])])
        value = min(h / (n @ D) for n, h in domain if n @ D > 0)
        name = ", ".join(f"{v:g}" for v in ray.direction)
        found.append(
            Row(f"strength along ({name})", value, ray.multiplier, 1e-9, "linear programme, checked from both sides")
        )
    dry = concio.strength(
        concio.cell(block="rigid", block_size=(b, a), friction=f), [(1, 0, 0)], stress=(0, -100, 0), coulomb=False,
        faces=False,
    )  # fmt: skip
    found.append(
        Row(
            "dry bond under 100 kN/m2: tension along the beds by friction alone", f * 100 * k, dry.rays[0].multiplier,
            1e-9, "linear programme, checked from both sides", "kN/m2",
        )
    )  # fmt: skip
    for ratio in (5.0, 100.0):
        own, other = brickwork(ratio)
        for name, i in (("A_xxxx", 0), ("A_yyyy", 1), ("A_xyxy", 2)):
            found.append(
                Row(
                    f"brickwork, mortar {ratio:g} times softer: {name}", float(other[i, i]), float(own[i, i]), 1e-9,
                    "same mesh and elements, bonded through joints or by common nodes", "kN/m2", check="second method",
                )
            )  # fmt: skip
    return found
