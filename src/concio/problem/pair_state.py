"""The state of every contact pair: open, sticking, slipping and which way, crushed. One encoding for all rooms.

A state has two sides. Normal: a pair is *open* (at its tensile strength, free to part), *closed*, or *crushed* (at its
cap, free to come closer). Tangential: it slips in a direction, or it does not. :class:`PairState` names the
combinations an engineer reads; the direction stands beside it, for a crushed pair may slip too, and so may an open one
that has strength left. What a method works with are views: :attr:`PairStates.normal` and, in the plane,
:attr:`PairStates.sign`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray


class PairState(IntEnum):
    """State of a contact pair."""

    OPEN = 0
    STICK = 1
    SLIP = 2
    CRUSHED = 3


class Normal(IntEnum):
    """Normal side of a state."""

    OPEN = 0
    CLOSED = 1
    CRUSHED = 2


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class PairStates:
    """States of ``m`` pairs.

    Parameters
    ----------
    normal : (m,) integer array
        Codes of :class:`Normal`.
    direction : (m, d-1) array
        Unit vector along which a pair slips; zero where it does not slip.
    """

    normal: Array
    direction: Array

    @classmethod
    def plane(cls, normal: Array, sign: Array) -> PairStates:
        """Return the states of plane pairs from normal codes (m,) and the sign of their slip (m,): +1, 0, -1."""
        return cls(np.asarray(normal, dtype=np.int8), np.asarray(sign, dtype=float)[:, None])

    def __len__(self) -> int:
        return len(self.normal)

    def __getitem__(self, pick: Array | slice) -> PairStates:
        return PairStates(self.normal[pick], self.direction[pick])

    @property
    def code(self) -> Array:
        """Codes of :class:`PairState`, (m,) integers."""
        closed = np.where(self.slips, PairState.SLIP, PairState.STICK)
        code = np.where(self.crushed, PairState.CRUSHED, np.where(self.open, PairState.OPEN, closed))
        return np.asarray(code, dtype=np.int8)

    @property
    def sign(self) -> Array:
        """Sign of the slip of plane pairs along their tangent: +1, -1, and 0 without slip, (m,) integers."""
        return np.asarray(np.sign(self.direction[:, 0]), dtype=np.int8)

    @property
    def open(self) -> Array:
        """Pairs at their tensile strength, free to part, (m,) booleans."""
        return np.asarray(self.normal == Normal.OPEN)

    @property
    def closed(self) -> Array:
        """Pairs whose gap is held shut, (m,) booleans; crushed ones are not."""
        return np.asarray(self.normal == Normal.CLOSED)

    @property
    def crushed(self) -> Array:
        """Pairs at their cap, (m,) booleans."""
        return np.asarray(self.normal == Normal.CRUSHED)

    @property
    def slips(self) -> Array:
        """Pairs that slip, (m,) booleans, open and crushed ones too."""
        return np.asarray(self.direction.any(axis=1))

    def key(self) -> bytes:
        """Return bytes that two sets of states share only if they are the same."""
        return self.normal.astype(np.int8).tobytes() + (self.direction + 0.0).tobytes()

    def differ(self, other: PairStates) -> Array:
        """Return the pairs whose state is another one in ``other``, (m,) booleans."""
        return np.asarray((self.normal != other.normal) | (self.direction != other.direction).any(axis=1))
