"""Contact results as a table of pairs, and resultants joint by joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.pairs import Pairs
from concio.kinematics.frames import turned_left
from concio.problem.pair_state import PairState, PairStates
from concio.problem.tolerances import UNLOADED
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray

STATE_NAMES = tuple(state.name.lower() for state in PairState)
"""Name of each pair state code."""


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Contacts:
    """State of every contact pair, m in all; ties are the pairs whose ``pairs.interface`` is -1.

    Parameters
    ----------
    pairs : Pairs
        Geometry: points, frames, areas, bodies.
    normal_force : (m,) array
        t_n, compression positive [kN].
    friction_force : (m, d-1) array
        t_t on side b along the tangents [kN].
    gap : (m,) array
        y_n [m].
    slip : (m, d-1) array
        y_t along the tangents [m].
    states : PairStates

    Examples
    --------
    A pillar of 20 kN presses its base of 0.5 m2 with 40 kN/m2:

    >>> import concio
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid", unit_weight=20.0))
    >>> base = result.contacts.pairs.body_a == result.body_index("ground")
    >>> result.contacts.pressure[base].round(6).tolist()
    [40.0, 40.0]
    """

    pairs: Pairs
    normal_force: Array
    friction_force: Array
    gap: Array
    slip: Array
    states: PairStates

    def __len__(self) -> int:
        return len(self.normal_force)

    @property
    def state(self) -> Array:
        """Codes of :class:`concio.problem.pair_state.PairState`: 0 open, 1 stick, 2 slip, 3 crushed; (m,) integers."""
        return self.states.code

    @property
    def slip_direction(self) -> Array:
        """Unit vectors along which pairs slip, zero where they do not, (m, d-1)."""
        return self.states.direction

    @property
    def point(self) -> Array:
        """Positions (m, d) [m]."""
        return self.pairs.point

    @property
    def area(self) -> Array:
        """Tributary area (m,) [m2]; zero of contacts at corners and along edges, nan of ties."""
        return np.where(self.pairs.interface >= 0, self.pairs.area, np.nan)

    @property
    def pressure(self) -> Array:
        """Contact pressure t_n over tributary area (m,), compression positive [kN/m2]; nan where there is no area."""
        return _over(self.normal_force, self.area)

    @property
    def shear(self) -> Array:
        """Friction stress t_t over tributary area (m, d-1) [kN/m2]; nan where there is no area."""
        return _over(self.friction_force, self.area[:, None])

    @property
    def force_on_b(self) -> Array:
        """Force on side b of each pair (m, d) [kN]."""
        pairs = self.pairs
        tangential = np.einsum("mt,mtd->md", self.friction_force, pairs.tangents)
        force: Array = self.normal_force[:, None] * pairs.normal + tangential
        return force

    def count(self, name: str) -> int:
        """Return how many pairs of joints are in the state called "open", "stick", "slip" or "crushed"; no ties."""
        return int(((self.state == STATE_NAMES.index(name)) & (self.pairs.interface >= 0)).sum())

    @property
    def counted(self) -> str:
        """How many pairs are in each state, in words; crushed ones are named where there are any."""
        words = [name for name in STATE_NAMES if name != "crushed" or self.count(name)]
        return ", ".join(f"{self.count(name)} {name}" for name in words)


def _over(force: Array, area: Array) -> Array:
    return np.asarray(np.divide(force, area, out=np.full(force.shape, np.nan), where=area > 0))


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class JointResultants:
    """Resultants of each interface, on side b, about the middle of the interface; j interfaces.

    Parameters
    ----------
    body_a, body_b : (j,) integer arrays
    middle : (j, 2) array
        [m].
    normal, tangent : (j, 2) arrays
    length : (j,) array
        [m].
    area : (j,) array
        Length times thickness [m2].
    N, V : (j,) arrays
        Normal force (compression positive) and shear force along t, signed [kN]. :attr:`shear_vector`,
        :attr:`shear_size`, :attr:`force` and :attr:`point` mean the same in :class:`.SpaceResultants`.
    M : (j,) array
        Moment about the middle of the joint, anticlockwise [kN m]. Where a joint pulls, it can have a moment without a
        normal force.
    eccentricity : (j,) array
        Distance of the resultant from the middle along t [m]; nan where N is zero.
    open_share : (j,) array
        Share of the length whose pairs are open; of contacts without length the share of the pairs.
    slipping : (j,) boolean array
        True where every closed pair slips.

    Examples
    --------
    Each joint of a pillar carries the weight above it:

    >>> import concio
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid", unit_weight=20.0))
    >>> result.joints.N.round(6).tolist()
    [20.0, 15.0, 10.0, 5.0]
    """

    body_a: Array
    body_b: Array
    middle: Array
    normal: Array
    tangent: Array
    length: Array
    area: Array
    N: Array
    V: Array
    M: Array
    eccentricity: Array
    open_share: Array
    slipping: Array

    @property
    def shear_vector(self) -> Array:
        """Shear force V t on side b (j, 2) [kN]."""
        shear: Array = self.V[:, None] * self.tangent
        return shear

    @property
    def shear_size(self) -> Array:
        """Size of the shear force (j,) [kN]."""
        return np.asarray(np.abs(self.V))

    @property
    def force(self) -> Array:
        """Resultant N n + V t on side b (j, 2) [kN]."""
        force: Array = self.N[:, None] * self.normal + self.shear_vector
        return force

    @property
    def point(self) -> Array:
        """Where the resultant meets the joint (j, 2), the middle where N is zero [m]."""
        point: Array = self.middle + np.nan_to_num(self.eccentricity)[:, None] * self.tangent
        return point



def loaded(N: Array, size: Array) -> Array:
    """Return which joints carry a normal force, (j,) booleans.

    Parameters
    ----------
    N : (j,) array
        Normal force of each joint [kN].
    size : (j,) array
        Sum of the sizes of the forces that N is the sum of: in bending N is the rounding of tension and compression.
    """
    return np.asarray(np.abs(N) > UNLOADED * float(size.max(initial=0.0)))


def joint_resultants(contacts: Contacts) -> JointResultants:
    """Sum contact forces interface by interface; ties are left out."""
    pairs = contacts.pairs
    at = pairs.interface
    inside = at >= 0
    number = int(at.max(initial=-1)) + 1
    index = at[inside]

    def total(values: Array) -> Array:
        return np.bincount(index, weights=values[inside], minlength=number)

    length = total(pairs.length)
    weight = pairs.length.copy()
    weight[inside] = np.where(length[index] == 0, 1.0, weight[inside])  # contacts at corners count by their pairs
    safe = np.maximum(total(weight), 1e-300)
    first = np.zeros(number, dtype=int)
    first[index[::-1]] = np.flatnonzero(inside)[::-1]
    tangent = pairs.tangent[first]
    low, high = np.full(number, np.inf), np.full(number, -np.inf)
    along = (pairs.point * pairs.tangent).sum(1)
    np.minimum.at(low, index, along[inside])
    np.maximum.at(high, index, along[inside])
    centre = (low + high) / 2
    normal_part = (pairs.point[first] * pairs.normal[first]).sum(1)
    middle = centre[:, None] * tangent + normal_part[:, None] * pairs.normal[first]
    N, V = total(contacts.normal_force), total(contacts.friction_force[:, 0])
    arm = np.zeros(len(pairs))
    arm[inside] = along[inside] - centre[index]
    pressed = total(contacts.normal_force * arm)
    carries = loaded(N, total(np.abs(contacts.normal_force)))
    turning = np.zeros(len(pairs))
    turning[inside] = (turned_left(pairs.point[inside] - middle[index]) * contacts.force_on_b[inside]).sum(1)
    touching, slips = ~contacts.states.open, contacts.states.slips
    return JointResultants(
        body_a=pairs.body_a[first],
        body_b=pairs.body_b[first],
        middle=middle,
        normal=pairs.normal[first],
        tangent=tangent,
        length=length,
        area=total(pairs.area),
        N=N,
        V=V,
        M=total(turning),
        eccentricity=np.where(carries, pressed / np.where(carries, N, 1.0), np.nan),
        open_share=total(weight * ~touching) / safe,
        slipping=(total((touching & ~slips).astype(float)) == 0) & (total(touching.astype(float)) > 0),
    )
