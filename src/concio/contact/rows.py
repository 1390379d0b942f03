"""From slots and contact points to rows: relative velocities of pairs on the unknowns of the bodies, gaps and areas.

Every row is kept dense on the few unknowns it meets: ``columns`` (m, w) and ``values`` (m, d, w), normal first; a
column number one past the last stands for unknowns that do not move. All that a step does with them are products of
small dense blocks, in the plane and in space alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.slots import MeshedSide, Slots
from concio.contact.solid_touch import SolidTouch, SolidToucher
from concio.contact.touch import Touch, Toucher
from concio.fem.discretisation import RIGID, Discretisation
from concio.kinematics.frames import components, dot, frames, norm
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions, swept, write_rigid_rows
from concio.kinematics.spins import SpinAxes
from concio.kinematics.turns import Turns

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
    point : (m, d) array
        [m].
    frame : (m, d, d) array
        Normal and tangents, as rows.
    """

    columns: Array
    values: Array
    gap: Array
    imposed: Array
    turning: Array
    valid: Array
    area: Array
    point: Array
    frame: Array

    @property
    def normal(self) -> Array:
        """Unit normals from side a to side b (m, d)."""
        return np.asarray(self.frame[:, 0])


class RowMaker:
    """Writes the rows of slots; what does not change between two searches is worked out once.

    Parameters
    ----------
    disc : Discretisation
    slots : Slots
    toucher : Toucher or SolidToucher
    node_column : (nodes + 1, d) integer array
        Unknowns of the nodes of all meshed bodies.
    axes : SpinAxes
        Along which rotations of rigid bodies are unknowns.
    """

    def __init__(
        self, disc: Discretisation, slots: Slots, toucher: Toucher | SolidToucher, node_column: Array, axes: SpinAxes
    ) -> None:
        self.slots, self.toucher, self.axes = slots, toucher, axes
        n = disc.unknowns
        rigid = disc.shape_of == RIGID
        first = np.where(rigid, disc.offsets[:-1], n)
        self.dim, self.rigid_motions = disc.dim, motions(disc.dim)
        columns = np.where(rigid[:, None], first[:, None] + np.arange(self.rigid_motions), n)
        a, b = slots.body_a, slots.body_b
        self.reach_a, self.reach_b = disc.reach[a], disc.reach[b]
        self.moved = ~rigid & (disc.shape_of < 0)  # bodies that are moved, not free
        between = ((slots.fraction > 0) & (slots.fraction < 1)).any()
        self.plain = not between and (slots.side_a is None or bool((slots.low == slots.high).all()))
        self.end = np.where(slots.fraction >= 1, slots.high, slots.low)
        parts = [columns[a], columns[b]]
        self.node_column = node_column
        for side in (slots.side_a, slots.side_b):
            if side is not None:
                parts.append(node_column[side.node].reshape(len(slots), self.dim * side.node.shape[1]))
        self.columns = np.concatenate(parts, axis=1)
        if slots.side_a is not None and slots.side_b is not None:
            k = self.rigid_motions
            self.columns[slots.side_a.meshed, :k] = n
            self.columns[slots.side_b.meshed, k : 2 * k] = n

    def rows(
        self, touch: Touch | SolidTouch, placement: Placement, velocity: Array, spin: Array, strain: Array, *,
        turning: bool = True,
    ) -> Rows:  # fmt: skip
        """Return the rows of a placement.

        Parameters
        ----------
        touch : Touch
        placement : Placement
        velocity : (B, d) array
            Of the centroids [m/s].
        spin : (B,) array in the plane, (B, 3) in space
            [rad/s].
        strain : (nodes, d) array
            Displacements of nodes in the frames of their bodies [m].
        turning : bool
            Whether what turning adds is wanted.
        """
        slots = self.slots
        gap, valid = self.gaps(touch)
        if self.plain:
            point, normal = touch.point[self.end], touch.normal[self.end]
        else:
            point, normal = self._between(touch.point), self._between(touch.normal)
            normal /= norm(normal)[:, None]
        a, b = slots.body_a, slots.body_b
        (m, w), d, k = self.columns.shape, self.dim, self.rigid_motions
        frame = frames(normal) if touch.frame is None else touch.frame[self.end]
        values = np.zeros((m, d, w))
        write_rigid_rows(values[:, :, :k], -frame, point - placement.centre[a], self.reach_a)
        write_rigid_rows(values[:, :, k : 2 * k], frame, point - placement.centre[b], self.reach_b)
        if d == 3:
            axes = self.axes.placed(np.arange(len(placement.centre)), placement.turns)
            for at, body in ((0, a), (k, b)):
                turns = values[:, :, at + d : at + k]
                turns[:] = turns @ axes[body]
        imposed = np.zeros((m, d))
        if velocity[self.moved].any() or spin[self.moved].any():
            for body, sign in ((a, -1.0), (b, 1.0)):
                v = velocity[body] + swept(spin[body], point - placement.centre[body])
                imposed += sign * components(np.where(self.moved[body, None], v, 0.0), frame)
        if slots.side_a is not None and slots.side_b is not None:
            at, padded = 2 * k, np.concatenate([strain, np.zeros((1, d))])
            for side, body, sign in ((slots.side_a, a, -1.0), (slots.side_b, b, 1.0)):
                wide = d * side.node.shape[1]
                moved = self._meshed(side, sign, placement.turns[body], frame, values[:, :, at : at + wide], padded)
                at, gap = at + wide, gap + moved
            values[slots.side_a.meshed, :, :k] = 0.0
            values[slots.side_b.meshed, :, k : 2 * k] = 0.0
        extra = np.zeros((m, d))
        if turning and spin.any():
            added = self.toucher.turning(touch, placement, velocity, spin)  # type: ignore[arg-type]  # made by itself
            if self.plain:
                extra = components(added[self.end], frame)
            else:
                extra = self._between(components(added, frames(touch.normal)))
        length = np.where(slots.face >= 0, touch.length[slots.face], 1.0) if len(touch.length) else 1.0
        area = slots.share * length * slots.thickness
        return Rows(self.columns, values, gap, imposed, extra, valid, area, point, frame)

    def gaps(self, touch: Touch | SolidTouch) -> tuple[Array, Array]:
        """Return the gaps (m,) of rigid sides [m], and which pairs (m,) touch something."""
        slots = self.slots
        if self.plain:
            return touch.gap[self.end] + slots.opening, touch.valid[self.end]
        s, low, high = slots.fraction, slots.low, slots.high
        return (1 - s) * touch.gap[low] + s * touch.gap[high] + slots.opening, touch.valid[low] & touch.valid[high]

    def _between(self, ends: Array) -> Array:
        """Return what slots (m, ...) have of vectors at the contact points, linear between two of them."""
        s = self.slots.fraction[:, None]
        return np.asarray((1 - s) * ends[self.slots.low] + s * ends[self.slots.high])

    def _meshed(
        self, side: MeshedSide, sign: float, turn: Turns, frame: Array, values: Array, strain: Array
    ) -> Array:
        """Write the entries of meshed sides into ``values`` (m, d, d k); return the gap that strains add (m,)."""
        local, weight = turn.undo(frame), sign * side.weight
        values[:] = (weight[:, None, :, None] * local[:, :, None]).reshape(values.shape)
        return np.asarray((weight * dot(local[:, :1], strain[side.node])).sum(1))
