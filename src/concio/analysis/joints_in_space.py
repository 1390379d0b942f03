"""Resultants of joints in space: normal force, shear, bending and torsion of each interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.contacts import Contacts, loaded
from concio.kinematics.frames import cross
from concio.model.interfaces.detect import Interface
from concio.model.interfaces.patch import Patch
from concio.model.interfaces.point_contact import PointContact
from concio.problem.pair_state import PairState
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray
Joint = Interface | Patch | PointContact


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class SpaceResultants:
    """Resultants of each interface in space, on side b; j interfaces.

    Parameters
    ----------
    body_a, body_b : (j,) integer arrays
    normal : (j, 3) array
    area : (j,) array
        [m2].
    N : (j,) array
        Normal force, compression positive [kN].
    V : (j, 3) array
        Force in the plane of the joint [kN].
    M : (j, 3) array
        Moment about the middle of the joint [kN m]; its part along the normal is the torsion of the joint.
    force : (j, 3) array
        N normal + V [kN].
    middle : (j, 3) array
        Centroid of the joint [m].
    point : (j, 3) array
        Where the resultant meets the joint, the centre of pressure; the middle where N is zero [m].
    open_share : (j,) array
        Share of the area whose pairs are open; of contacts without area the share of the pairs.
    slipping : (j,) boolean array
        True where every closed pair slips.

    Examples
    --------
    Each joint of a pillar carries the weight above it:

    >>> import concio
    >>> plane = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", unit_weight=20.0)
    >>> pillar = concio.extrude(plane, thickness=1.0)
    >>> concio.solve(pillar).joints_in_space.N.round(6).tolist()
    [20.0, 15.0, 10.0, 5.0]
    """

    body_a: Array
    body_b: Array
    normal: Array
    area: Array
    N: Array
    V: Array
    M: Array
    force: Array
    middle: Array
    point: Array
    open_share: Array
    slipping: Array

    @property
    def torsion(self) -> Array:
        """Moment about the normal (j,) [kN m]."""
        twist: Array = (self.M * self.normal).sum(1)
        return twist

    @property
    def shear_vector(self) -> Array:
        """Shear force V on side b (j, 3) [kN], as in :class:`.JointResultants`."""
        return self.V

    @property
    def shear_size(self) -> Array:
        """Size of the shear force (j,) [kN]."""
        return np.asarray(np.linalg.norm(self.V, axis=1))


def joint_resultants_in_space(contacts: Contacts, joints: Sequence[Joint]) -> SpaceResultants:
    """Return the resultants of all interfaces of a structure in space."""
    pairs = contacts.pairs
    patches = [joint for joint in joints if not isinstance(joint, Interface)]
    j = len(patches)
    own = np.flatnonzero(pairs.interface >= 0)
    of = pairs.interface[own]
    middle = np.array([p.middle for p in patches]).reshape(-1, 3)
    normal = np.array([p.normal for p in patches]).reshape(-1, 3)

    def summed(values: Array) -> Array:
        total = np.zeros((j, *values.shape[1:]))
        np.add.at(total, of, values)
        return total

    force = contacts.force_on_b[own]
    total = summed(force)
    moment = summed(cross(pairs.point[own] - middle[of], force))
    N = (total * normal).sum(1)
    carries = loaded(N, summed(np.abs(contacts.normal_force[own])))
    safe = np.where(carries, N, 1.0)
    # the normal forces alone place the resultant in the plane of the joint
    pressed = summed(contacts.normal_force[own, None] * (pairs.point[own] - middle[of]))
    point = middle + np.where(carries[:, None], pressed / safe[:, None], 0.0)
    bare = np.array([p.area == 0 for p in patches], dtype=bool)
    weight = np.where(bare[of], 1.0, pairs.area[own])  # contacts at corners and edges count by their pairs
    area = summed(weight)
    closed, slips = ~contacts.states.open[own], contacts.states.slips[own]
    opened = summed(weight * (contacts.state[own] == PairState.OPEN))
    return SpaceResultants(
        np.array([p.a for p in patches], dtype=int),
        np.array([p.b for p in patches], dtype=int),
        normal,
        np.array([p.area for p in patches]),
        N,
        total - N[:, None] * normal,
        moment,
        total,
        middle,
        point,
        opened / np.where(area > 0, area, 1.0),
        (summed(closed & ~slips) == 0) & (summed(closed) > 0),
    )
