"""The paper's panel in four variants, against two other programs.

Numbers from an augmented Lagrangian in GetFEM and from an independent Lemke code, both node to node with the same mesh:
they agree with each other to 1e-6 (full base) and 5e-5 to 5e-4 (no base). What is compared is unique: displacements,
and the thrust on a wall. Blocks 0.2 x 0.1 m, E = 1e5 kN/m2, nu = 0.15, plane stress, 10 kN/m2 on top, no weight.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "A. Ercolano, Un metodo per l'analisi numerica di pannelli murari tramite la complementarità lineare; "
    "reference numbers"
    " by GetFEM and an independent Lemke code."
)

CASES = {
    "dry, mu 0.6, full base": ({"courses": 3, "blocks": 3, "friction": 0.6}, 2.909e-05, 2.8292e-05, None),
    "dry, mu 1.0, full base": ({"courses": 3, "blocks": 3, "friction": 1.0}, 2.8974e-05, 2.7865e-05, None),
    "mortar, mu 1.0, full base": (
        {"courses": 3, "blocks": 3, "friction": 1.0, "joint": 0.02},
        3.2702e-05,
        3.1585e-05,
        None,
    ),
    "dry, mu 0.6, no base": (
        {"courses": 3, "blocks": 6, "friction": 0.6, "base": "none"},
        3.7131e-03,
        2.224e-03,
        1.5796,
    ),
}
"""Arguments, largest and mean settlement of the top nodes [m], thrust on each wall [kN]."""


@cache
def panel(name: str, method: str = "auto") -> concio.Result:
    return concio.solve(concio.running_bond_panel(top_pressure=10.0, **CASES[name][0]), method=method)


def top_settlement(result: concio.Result) -> np.ndarray:
    """Downward displacements of the top nodes, those of two neighbours at a head joint both counted [m]."""
    top = max(b.outline[:, 1].max() for b in result.model.free_bodies)
    found = []
    for i, body in enumerate(result.model.bodies):
        if body.kind == "elastic":
            nodes = result.nodes(i)
            found.append(-result.node_displacement(i)[np.isclose(nodes[:, 1], top), 1])
    return np.concatenate(found)


def rows() -> list[Row]:
    found = []
    for name, (_, largest, mean, thrust) in CASES.items():
        result = panel(name)
        settlement = top_settlement(result)
        tolerance, reason = (5e-5, "five digits") if thrust is None else (5e-4, "agreement of the two other programs")
        found.append(
            Row(
                f"{name}: largest settlement",
                largest,
                float(settlement.max()),
                max(tolerance, 2e-5),
                reason,
                "m",
                check="another program",
            )
        )
        found.append(
            Row(f"{name}: mean settlement", mean, float(settlement.mean()), tolerance, reason, "m",
                check="another program")
        )
        if thrust is not None:
            found.append(
                Row(
                    f"{name}: thrust on a wall",
                    thrust,
                    result.reactions["left wall"][0],
                    tolerance,
                    reason,
                    "kN",
                    check="another program",
                )
            )
    for name in ("dry, mu 0.6, full base", "dry, mu 0.6, no base"):
        a, b = panel(name), panel(name, "lemke")
        gap = float(np.abs(a.displacement - b.displacement).max() / np.abs(a.displacement).max())
        found.append(
            Row(
                f"{name}: displacements less those of method lemke",
                0.0,
                gap,
                1e-8,
                "same discrete problem, other algorithm",
                check="second method",
            )
        )
    return found
