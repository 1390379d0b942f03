"""Thrust lines: through the points where the resultants of successive joints act.

A thrust line exists where bodies stand in a row, each touching two others (an arch, a column). Interfaces between the
same two bodies (a joint drawn as several edges) are taken together. Walls have no single line: there force chains show
how the load runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class ThrustLine:
    """One line of thrust.

    Parameters
    ----------
    points : (k, 2) array
        Where the resultant of each joint acts, in order [m].
    force : (k,) array
        Size of each resultant [kN].
    ratio : (k,) array
        Distance from the middle of the joint over half its length: 1 at its edge, where a hinge forms.
    bodies : (k+1,) integer array
        Bodies along the line.
    """

    points: Array
    force: Array
    ratio: Array
    bodies: Array


def thrust_lines(result: Result) -> list[ThrustLine]:
    """Return the lines of thrust of all rows of bodies; an empty list where there is none."""
    joints = result.joints
    merged: dict[tuple[int, int], list[int]] = {}
    least = 1e-9 * np.abs(joints.N).max(initial=0.0)
    force = joints.N
    for k in np.flatnonzero(force > least):
        merged.setdefault((int(joints.body_a[k]), int(joints.body_b[k])), []).append(int(k))
    touching: dict[int, list[int]] = {}
    for a, b in merged:
        touching.setdefault(a, []).append(b)
        touching.setdefault(b, []).append(a)
    neighbours: dict[int, set[int]] = {}
    for a, b in zip(joints.body_a.tolist(), joints.body_b.tolist(), strict=True):
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    fixed = {i for i, b in enumerate(result.model.bodies) if b.kind == "fixed"}

    def inner(b: int) -> bool:
        return b not in fixed and len(touching[b]) == len(neighbours[b]) == 2

    found: list[ThrustLine] = []
    used: set[tuple[int, int]] = set()
    ends = [b for b in touching if not inner(b)]
    for start in ends:
        for following in touching[start]:
            chain = [start, following]
            while inner(chain[-1]):
                a, b = touching[chain[-1]]
                chain.append(b if a == chain[-2] else a)
            steps = list(pairwise(chain))
            if len(chain) < 3 or (min(steps[0]), max(steps[0])) in used or (min(steps[-1]), max(steps[-1])) in used:
                continue
            used.update((min(s), max(s)) for s in steps)
            found.append(_line(result, chain, [merged.get(s) or merged[s[::-1]] for s in steps]))
    return found


def _line(result: Result, chain: list[int], joints: list[list[int]]) -> ThrustLine:
    j = result.joints
    points, force, ratio = [], [], []
    for group in joints:
        N = j.N[group]
        e = np.nan_to_num(j.eccentricity[group])
        place = j.middle[group] + e[:, None] * j.tangent[group]
        points.append((N[:, None] * place).sum(0) / N.sum())
        vector = (N[:, None] * j.normal[group] + j.V[group][:, None] * j.tangent[group]).sum(0)
        force.append(float(np.hypot(*vector)))
        length = float(j.length[group].sum())
        if not length:  # contacts at corners: the thrust stands at their edge
            ratio.append(1.0)
            continue
        middle = (j.length[group][:, None] * j.middle[group]).sum(0) / length
        tangent = j.tangent[group[0]]
        ratio.append(float(2 * abs((points[-1] - middle) @ tangent) / length))
    return ThrustLine(np.array(points), np.array(force), np.array(ratio), np.array(chain))
