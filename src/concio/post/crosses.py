"""Principal-stress crosses: two arms at a point, along the principal directions, as long as the stresses are large."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from concio.fem.constitutive import principal
from concio.kinematics.frames import turned_left
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class Crosses:
    """Principal stresses at c points.

    Parameters
    ----------
    centre : (c, 2) array
        [m].
    s1, s2 : (c,) arrays
        Principal stresses, s1 >= s2, tension positive [kN/m2].
    angle : (c,) array
        From the x axis to the direction of s1 [rad].
    size : (c,) array
        Size of what each cross stands for, the root of its area [m].
    body : (c,) integer array
    """

    centre: Array
    s1: Array
    s2: Array
    angle: Array
    size: Array
    body: Array

    @property
    def largest(self) -> float:
        """Largest principal stress by absolute value [kN/m2]."""
        return float(np.abs(np.concatenate([self.s1, self.s2])).max(initial=0.0))

    def arms(self, scale: float) -> tuple[Array, Array]:
        """Return arms (2c, 2, 2) [m] and their stresses (2c,) [kN/m2]; ``scale`` is the length of 1 kN/m2 [m]."""
        direction = np.column_stack([np.cos(self.angle), np.sin(self.angle)])
        across = turned_left(direction)
        lines = []
        for value, along in ((self.s1, direction), (self.s2, across)):
            half = (0.5 * scale * np.abs(value))[:, None] * along
            lines.append(np.stack([self.centre - half, self.centre + half], axis=1))
        return np.concatenate(lines), np.concatenate([self.s1, self.s2])


def crosses(result: Result, of: Literal["bodies", "elements"] = "bodies") -> Crosses:
    """Return the crosses of mean stresses of every elastic body, or of every element of it."""
    disc = result.assembly.disc
    if of == "bodies":
        body = np.flatnonzero(disc.shape_of >= 0)
        s1, s2, angle = (v[body] for v in result.stress.principal)
        area = np.array([result.model.outlines[b].area for b in body])
        return Crosses(disc.centroids[body], s1, s2, angle, np.sqrt(area), body)
    centre: list[Array] = []
    stress: list[Array] = []
    size: list[Array] = []
    owner: list[Array] = []
    for s, shape in enumerate(disc.shapes):
        el = shape.elements
        count = len(el.cells)
        area = np.bincount(el.cell_of_point, el.weights, count)
        for b in np.flatnonzero(disc.shape_of == s):
            points, values = result.stress.at_points(int(b))
            for array, found in ((points, centre), (values, stress)):
                weighted = el.weights[:, None] * array
                mean = [np.bincount(el.cell_of_point, weighted[:, i], count) / area for i in range(array.shape[1])]
                found.append(np.column_stack(mean))
            size.append(np.sqrt(area))
            owner.append(np.full(count, b))
    if not owner:
        none = np.zeros(0)
        return Crosses(np.zeros((0, 2)), none, none, none, none, none.astype(int))
    s1, s2, angle = principal(np.vstack(stress))
    return Crosses(np.vstack(centre), s1, s2, angle, np.concatenate(size), np.concatenate(owner))
