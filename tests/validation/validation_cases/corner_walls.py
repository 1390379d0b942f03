"""Walls with corners: bricks 2 x 1 x 1 in running bond that turns the corner, pushed by a share of their weight.

A facade along y with returns along x, fixed ground, rigid bricks, contact at the corners of each patch. The multipliers
of associated flow were computed beforehand by an independent program from the same description (facade x in [0, 1];
even courses: the facade runs from corner to corner, returns start behind it; odd courses are reversed; runs are
cut into bricks of 2 from their start). Forces and mechanism of each are rechecked from the original data. Friction
along the returns holds the facade: outward it falls with a part of them, and less friction holds less of them.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from concio.solvers.statics.associated_limit import associated_limit
from space_problems import corner_bricks
from validation_cases.row import Row

SOURCE = "computed independently beforehand (interior-point cone programme); no closed form."

DIRECTIONS = {
    "-x": (-1.0, 0.0, 0.0), "+x": (1.0, 0.0, 0.0), "-y": (0.0, -1.0, 0.0), "45": (-(0.5**0.5), -(0.5**0.5), 0.0)
}  # fmt: skip

STONE = {"stone": concio.Rigid(unit_weight=1.0)}


@cache
def model(courses: int, facade: int, returns: int, legs: int, mu: float) -> concio.Model:
    """Wall with one or two returns under its weight and a horizontal load of each direction in a group."""
    bodies = [concio.Polyhedron.box("ground", (-2.0, -2.0, -1.0), (12.0, 12.0, 0.0), kind="fixed")]
    for k, (x, y, z) in enumerate(corner_bricks(courses, facade, returns, legs=legs)):
        low, high = zip(x, y, z, strict=True)
        bodies.append(concio.Polyhedron.box(f"b{k}", low, high, kind="rigid", material="stone"))
    loads = [concio.Load("weight", (0.0, 0.0, -1.0))]
    loads += [concio.Load("weight", direction, group=name) for name, direction in DIRECTIONS.items()]
    return concio.Model(tuple(bodies), STONE, {"joint": concio.JointLaw(friction=mu)}, loads=tuple(loads))


@cache
def assembled(courses: int, facade: int, returns: int, legs: int, mu: float) -> concio.Assembly:
    return concio.assemble(model(courses, facade, returns, legs, mu))


def multiplier(courses: int, facade: int, returns: int, legs: int, mu: float, live: str) -> float:
    assembly = assembled(courses, facade, returns, legs, mu)
    factors = dict.fromkeys(DIRECTIONS, 0.0)
    dead, with_live = assembly.problem(factors), assembly.problem({**factors, live: 1.0})
    found = associated_limit(dead, with_live.f - dead.f)
    return found.multiplier if found.checked else np.nan


PUBLISHED = (
    ("U wall, friction 0.6, outward", 0.28694, (10, 8, 5, 2, 0.6, "-x")),
    ("U wall, friction 0.6, inward", 0.48918, (10, 8, 5, 2, 0.6, "+x")),
    ("U wall, friction 0.4, outward", 0.27881, (10, 8, 5, 2, 0.4, "-x")),
    ("U wall, friction 0.4, inward", 0.39195, (10, 8, 5, 2, 0.4, "+x")),
    ("U wall, friction 0.3, outward", 0.27427, (10, 8, 5, 2, 0.3, "-x")),
    ("U wall, friction 0.3, inward", 0.30000, (10, 8, 5, 2, 0.3, "+x")),
    ("L wall, friction 0.6, along a leg", 0.31134, (10, 7, 7, 1, 0.6, "-y")),
    ("L wall, friction 0.6, along -(x + y)", 0.40511, (10, 7, 7, 1, 0.6, "45")),
)


def rows() -> list[Row]:
    assembly = assembled(10, 8, 5, 2, 0.6)
    bricks = float(len(assembly.model.bodies) - 1)
    found = [Row("bricks of the U wall", 85.0, bricks, 0.0, "a count", check="second method")]
    faces = float(len(assembly.detection.patches))
    found.append(Row("faces on which they meet", 227.0, faces, 0.0, "a count", check="second method"))
    return found + [
        Row(name, value, multiplier(*case), 2e-5, "five digits were kept", check="second method")
        for name, value, case in PUBLISHED
    ]
