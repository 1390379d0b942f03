"""Associated limit multipliers of walls 1 to 3, the walls built as models of rigid and of elastic blocks.

Blocks 0.4 x 0.175 m, friction 0.65, self-weight and a horizontal force lambda times the weight on every block. The
associated multiplier does not depend on elasticity; the walls of elastic blocks carry three other rigid motions each,
and a contact point at each node.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from validation_cases.row import Row

SOURCE = "M. C. Ferris and F. Tin-Loi, Int. J. Mech. Sci. 43 (2001) 209-224."

HALF_ENDS, FULL = [0.5, 1, 1, 1, 1, 0.5], [1.0] * 5
LOW, LOW_SHIFTED = [1.0] * 4, [0.5, 1, 1, 1, 0.5]
DOOR, DOOR_SHIFTED = [0.5, 1, -1, 1, 0.5], [1, 0.5, -1, 0.5, 1]
WALLS = {
    "wall 1": ([HALF_ENDS, FULL] * 3, 33, 83, 0.64286),
    "wall 2": ([HALF_ENDS, FULL] * 5, 55, 141, 0.58000),
    "wall 3": (
        [LOW, LOW_SHIFTED, LOW, DOOR, DOOR_SHIFTED, DOOR, DOOR_SHIFTED, DOOR, LOW, LOW_SHIFTED, LOW],
        46,
        102,
        0.40369,
    ),
}
"""Courses from the base (negative: opening), blocks, interfaces, multiplier."""


def model(name: str, stiff: bool = False, horizontal: float = 1.0) -> concio.Model:
    block = concio.Elastic(E=1e8, nu=0.2, unit_weight=1.0) if stiff else concio.Rigid(unit_weight=1.0)
    return concio.wall_of_courses(
        WALLS[name][0], block_size=(0.4, 0.175), friction=0.65, block=block, horizontal=horizontal, mesh_size=0.2
    )


@cache
def limit(name: str, stiff: bool = False) -> tuple[LimitLoad, int]:
    """Limit multiplier and number of interfaces."""
    assembly = concio.assemble(model(name, stiff))
    dead, all_ = (assembly.problem({"dead": 1.0, "live": live}).f for live in (0.0, 1.0))
    return associated_limit(assembly.problem({"live": 0.0}), all_ - dead), len(assembly.detection.interfaces)


@cache
def gravity(name: str, stiff: bool) -> concio.Result:
    return concio.solve(model(name, stiff), factors={"live": 0.0})


def rows() -> list[Row]:
    found = []
    for name, (_, blocks, interfaces, multiplier) in WALLS.items():
        load, count = limit(name)
        found += [
            Row(f"{name}: blocks", blocks, len(model(name).free_bodies), 0, "a count", check="published"),
            Row(f"{name}: interfaces", interfaces, count, 0, "a count", check="published"),
            Row(
                f"{name}: multiplier, rigid blocks",
                multiplier,
                load.multiplier,
                5e-6,
                "five digits are quoted",
                absolute=True,
                check="published",
            ),
            Row(
                f"{name}: bound from the mechanism", load.multiplier, load.upper, 1e-9, "duality", check="second method"
            ),
        ]
    found.append(
        Row(
            "wall 1: multiplier, elastic blocks",
            WALLS["wall 1"][3],
            limit("wall 1", True)[0].multiplier,
            5e-6,
            "does not depend on elasticity",
            absolute=True,
            check="published",
        )
    )
    for name in WALLS:
        weight = -gravity(name, False).total_load[1]
        for stiff in (False, True):
            ground = gravity(name, stiff).reactions["ground"]
            found.append(
                Row(
                    f"{name}: base reaction under self-weight, {'elastic' if stiff else 'rigid'} blocks",
                    weight,
                    ground[1],
                    1e-9,
                    "equilibrium",
                    "kN",
                )
            )
    return found


def opening(name: str) -> np.ndarray:
    """Opening velocities of the pairs in the collapse mechanism, for a picture."""
    load, _ = limit(name)
    assembly = concio.assemble(model(name))
    return np.asarray(assembly.problem({"live": 0.0}).C_n @ load.mechanism.velocity) if load.mechanism else np.zeros(0)
