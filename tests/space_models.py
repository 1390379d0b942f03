"""Models of the blocks of the problems in space: the same bodies, joints and loads, described to concio."""

from __future__ import annotations

import numpy as np

import concio
from space_problems import Built

Array = np.ndarray
UNIT = 20.0
"""Weight of the stones [kN/m3]; a block has the size that the grid gives it, in m."""
WAYS = (((0, 1), 2), ((1, 2), 0), ((2, 0), 1))


def stone(name: str, grid: Array) -> concio.Polyhedron:
    """A rigid block with the quadrilaterals on the outside of a grid (nx+1, ny+1, nz+1, 3), flat ones joined."""
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    faces = []
    for (one, two), across in WAYS:
        for end in (0, -1):
            sheet = np.moveaxis(number.take(end, axis=across), (0, 1) if one < two else (1, 0), (0, 1))
            for i in range(sheet.shape[0] - 1):
                for j in range(sheet.shape[1] - 1):
                    ring = [sheet[i, j], sheet[i + 1, j], sheet[i + 1, j + 1], sheet[i, j + 1]]
                    faces.append(tuple(int(v) for v in (ring if end else ring[::-1])))
    used = sorted({v for face in faces for v in face})
    place = {v: k for k, v in enumerate(used)}
    vertices = grid.reshape(-1, 3)[used]
    return concio.Polyhedron(name, vertices, tuple(tuple(place[v] for v in face) for face in faces), kind="rigid")


def model_of(case: Built, *, mu: float, push: Array | tuple[float, float, float], kn: float = 0.0) -> concio.Model:
    """The model of a built case on a floor, under its weights and ``push`` (3,) times them; kn [kN/m3] or hard."""
    low = np.min([g.reshape(-1, 3).min(axis=0) for g in case.grids], axis=0)
    high = np.max([g.reshape(-1, 3).max(axis=0) for g in case.grids], axis=0)
    size = float((high - low).max())
    floor = concio.Polyhedron.box("floor", (*(low[:2] - size), -0.1 * size), (*(high[:2] + size), 0.0), kind="fixed")
    law = concio.JointLaw(mu, normal_stiffness=kn, tangential_stiffness=0.4 * kn) if kn else concio.JointLaw(mu)
    down = (*(float(v) for v in push[:2]), float(push[2]) - 1.0)
    stones = [stone(f"s{k:03}", grid) for k, grid in enumerate(case.grids)]
    load, rigid = concio.Load("weight", down), concio.Rigid(unit_weight=UNIT)
    return concio.Model((floor, *stones), {"block": rigid}, {"joint": law}, loads=(load,))
