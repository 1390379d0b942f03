"""From slots and contact points to rows: relative velocities of pairs on the unknowns of the bodies, gaps and areas.

Every row is kept dense on the few unknowns it meets: ``columns`` (m, w) and ``values`` (m, d, w), normal first; a
column number one past the last stands for unknowns that do not move. All that a step does with them are products of
small dense blocks, in the plane and in space alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.moving.edges import as_vectors, dot
from concio.contact.moving.slots import MeshedSide, Slots
from concio.contact.moving.touch import Touch, Toucher
from concio.fem.discretisation import RIGID, Discretisation

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Rows:
    """Pairs of a placement.

    Parameters
    ----------
    columns : (m, w) integer array
    values : (m, d, w) array
        Relative velocity b - a along normal and tangents.
    gap : (m,) array
        [m].
    imposed : (m, d) array
        Relative velocity by bodies that are moved [m/s].
    turning : (m, d) array
        What turning adds to the relative velocity, per time [m/s2].
    valid : (m,) boolean array
        Pairs whose two sides stand over each other.
    area : (m,) array
        Tributary area [m2].
    point, normal : (m, d) arrays
    """

    columns: Array
    values: Array
    gap: Array
    imposed: Array
    turning: Array
    valid: Array
    area: Array
    point: Array
    normal: Array


class RowMaker:
    """Writes the rows of slots; what does not change between two searches is worked out once.

    Parameters
    ----------
    disc : Discretisation
    slots : Slots
    toucher : Toucher
    node_column : (nodes + 1, 2) integer array
        Unknowns of the nodes of all meshed bodies.
    """

    def __init__(self, disc: Discretisation, slots: Slots, toucher: Toucher, node_column: Array) -> None:
        self.slots, self.toucher = slots, toucher
        n = disc.unknowns
        rigid = disc.shape_of == RIGID
        first = np.where(rigid, disc.offsets[:-1], n)
        columns = np.where(rigid[:, None], first[:, None] + np.arange(3), n)
        a, b = slots.body_a, slots.body_b
        self.reach_a, self.reach_b = disc.reach[a], disc.reach[b]
        self.moved = ~rigid & (disc.shape_of < 0)  # bodies that are moved, not free
        self.plain = not ((slots.fraction > 0) & (slots.fraction < 1)).any() and slots.side_a is None
        self.end = np.where(slots.fraction >= 1, slots.high, slots.low)
        parts = [columns[a], columns[b]]
        self.node_column = node_column
        for side in (slots.side_a, slots.side_b):
            if side is not None:
                parts.append(node_column[side.node].reshape(len(slots), -1))
        self.columns = np.concatenate(parts, axis=1)
        if slots.side_a is not None and slots.side_b is not None:
            self.columns[slots.side_a.meshed, :3] = n
            self.columns[slots.side_b.meshed, 3:6] = n

    def rows(
        self,
        touch: Touch,
        centre: Array,
        turn: Array,
        velocity: Array,
        spin: Array,
        strain: Array | None,
        *,
        turning: bool = True,
    ) -> Rows:
        """Return the rows of a placement.

        Parameters
        ----------
        touch : Touch
        centre, turn, velocity : (B,) complex arrays
            Centroids, rotations e^(i angle), velocities of the centroids.
        spin : (B,) array
        strain : (nodes + 1,) complex array or None
            Displacements of nodes in the frames of their bodies, the last one zero.
        turning : bool
            Whether what turning adds is wanted.
        """
        slots = self.slots
        if self.plain:
            pick = self.end
            point, normal, gap = touch.point[pick], touch.normal[pick], touch.gap[pick] + slots.opening
            valid = touch.valid[pick]
        else:
            s, low, high = slots.fraction, slots.low, slots.high
            point = (1 - s) * touch.point[low] + s * touch.point[high]
            normal = (1 - s) * touch.normal[low] + s * touch.normal[high]
            normal /= np.abs(normal)
            gap = (1 - s) * touch.gap[low] + s * touch.gap[high] + slots.opening
            valid = touch.valid[low] & touch.valid[high]
        a, b = slots.body_a, slots.body_b
        m, w = self.columns.shape
        values = np.zeros((m, 2, w))
        x, y = normal.real, normal.imag
        arm_a, arm_b = point - centre[a], point - centre[b]
        values[:, 0, 0], values[:, 0, 1] = -x, -y
        values[:, 1, 0], values[:, 1, 1] = y, -x
        turned = np.conj(arm_a) * normal / self.reach_a
        values[:, 0, 2], values[:, 1, 2] = -turned.imag, -turned.real
        values[:, 0, 3], values[:, 0, 4] = x, y
        values[:, 1, 3], values[:, 1, 4] = -y, x
        turned = np.conj(arm_b) * normal / self.reach_b
        values[:, 0, 5], values[:, 1, 5] = turned.imag, turned.real
        imposed = np.zeros((m, 2))
        if velocity[self.moved].any():
            for body, sign in ((a, -1.0), (b, 1.0)):  # fixed bodies never turn
                v = np.where(self.moved[body], velocity[body], 0.0)
                imposed[:, 0] += sign * dot(normal, v)
                imposed[:, 1] += sign * dot(1j * normal, v)
        if slots.side_a is not None and slots.side_b is not None:
            assert strain is not None
            at = 6
            for side, body, sign in ((slots.side_a, a, -1.0), (slots.side_b, b, 1.0)):
                at, moved = self._meshed(side, body, sign, turn, normal, values, at, strain)
                gap = gap + moved
            values[slots.side_a.meshed, :, :3] = 0.0
            values[slots.side_b.meshed, :, 3:6] = 0.0
        extra = np.zeros((m, 2))
        if turning and spin.any():
            along_n, along_t = self.toucher.turning(touch, centre, velocity, spin)
            if self.plain:
                extra[:, 0], extra[:, 1] = along_n[self.end], along_t[self.end]
            else:
                extra[:, 0] = (1 - s) * along_n[low] + s * along_n[high]
                extra[:, 1] = (1 - s) * along_t[low] + s * along_t[high]
        length = np.where(slots.face >= 0, touch.length[slots.face], 1.0) if len(touch.length) else 1.0
        area = slots.share * length * slots.thickness
        return Rows(
            self.columns, values, gap, imposed, extra, valid, area,
            as_vectors(point), as_vectors(normal),
        )  # fmt: skip

    def _meshed(
        self,
        side: MeshedSide,
        body: Array,
        sign: float,
        turn: Array,
        normal: Array,
        values: Array,
        at: int,
        strain: Array,
    ) -> tuple[int, Array]:
        """Write the entries of meshed sides; return where the next begin, and the gap that strains add (m,)."""
        k = side.node.shape[1]
        local = np.conj(turn[body]) * normal
        weight = sign * side.weight
        for axis, (n_part, t_part) in enumerate(((local.real, -local.imag), (local.imag, local.real))):
            values[:, 0, at + axis : at + 2 * k : 2] = weight * n_part[:, None]
            values[:, 1, at + axis : at + 2 * k : 2] = weight * t_part[:, None]
        moved = (weight * dot(local[:, None], strain[side.node])).sum(1)
        return at + 2 * k, moved
