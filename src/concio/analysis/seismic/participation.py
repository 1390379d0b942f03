r"""The chain of macro-blocks of a mechanism, as the code sees it: participating mass and spectral quantities.

For every weight P that rests on the chain, and Q that pushes but does not rest, the earthquake has a force (P + Q)
times alpha. With delta the displacement of its point of application along the push,

.. math::

    e^* = \frac{(\sum (P+Q)\,\delta)^2}{\sum (P+Q) \sum (P+Q)\,\delta^2}, \qquad a = \frac{\alpha g}{e^* FC}, \qquad
    d = d_C \frac{\sum (P+Q)\,\delta^2}{\delta_C \sum (P+Q)\,\delta}

(C8.7.1.3 to C8.7.1.5). The self-weight of a macro-block acts in its centroid, distributed loads in their middle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.seismic.linkage import Force
from concio.analysis.seismic.macro_blocks import Mechanics, carried
from concio.contact.applied import applied_forces
from concio.model.model import Model

Array = np.ndarray


def along_force(force: Force, mechanics: Mechanics, motion: Array) -> float:
    """Return the displacement of the point of a force along it [m], of a motion (G, 3 or 6) of the macro-blocks."""
    arm = force.point - mechanics.blocks[force.block].centre
    return float(carried(motion[force.block], arm) @ force.force) / math.hypot(*force.force)


def moved_of_masses(
    push: Sequence[Force], mechanics: Mechanics, first: Array, went: Callable[[Force], Array]
) -> float:
    """Return by how much the masses have moved, as a displacement of the control point [m].

    While all move as they did at rest it is that of the control point, and d above holds. Masses that slide move like
    every point; as they rock, a corner at the top goes twice as far as their centroid.

    Parameters
    ----------
    push : sequence of Force
        P + Q.
    mechanics : Mechanics
    first : (G, 3 or 6) array
        The motion at rest, of a control point that moves by one.
    went : callable
        Returns the displacement (d,) of the point of a force [m].
    """
    moved = sums = 0.0
    for force in push:
        delta = along_force(force, mechanics, first)
        moved += delta * float(went(force) @ force.force)
        sums += delta**2 * math.hypot(*force.force)
    return moved / sums if sums else math.inf


@dataclass(frozen=True, eq=False)
class Participant:
    """One force on one macro-block.

    Parameters
    ----------
    block : int
        Macro-block.
    kind : str
        "weight", or the kind and number of the load: "point 3".
    force : (d,) array
        [kN].
    point : (d,) array
        [m].
    delta : float
        Displacement of the point along the force, when the control point moves by one.
    """

    block: int
    kind: str
    force: Array
    point: Array
    delta: float

    @property
    def size(self) -> float:
        """Size of the force [kN]."""
        return math.hypot(*self.force)


@dataclass(frozen=True, eq=False)
class Chain:
    """The forces of the earthquake on a mechanism, and what the code makes of them.

    Parameters
    ----------
    participants : tuple of Participant
    """

    participants: tuple[Participant, ...]

    @property
    def sums(self) -> tuple[float, float, float]:
        """Sums of (P + Q), of (P + Q) delta and of (P + Q) delta^2."""
        f = np.array([p.size for p in self.participants])
        d = np.array([p.delta for p in self.participants])
        return float(f.sum()), float(f @ d), float(f @ d**2)

    @property
    def e_star(self) -> float:
        """Share of the mass that takes part."""
        plain, first, second = self.sums
        return first**2 / (plain * second)

    @property
    def spectral(self) -> float:
        """Spectral displacement over the displacement of the control point."""
        _, first, second = self.sums
        return second / first


def gathered(
    model: Model, mechanics: Mechanics, numbers: Sequence[int], origin: Mapping[int, int] | None = None
) -> list[tuple[str, Force]]:
    """Return the forces of some loads on the macro-blocks; self-weights of a macro-block are one force.

    Parameters
    ----------
    model : Model
    mechanics : Mechanics
    numbers : sequence of int
        Which loads.
    origin : mapping of int to int, optional
        For the number of a load that was made of another one, the number of that.
    """
    origin = origin or {}
    sums: dict[tuple[int, str, bool], list[tuple[Array, Array]]] = {}
    for found in applied_forces(model, numbers):
        block = mechanics.of_body.get(found.body)
        if block is not None and found.force.any():
            kind = model.loads[found.load].kind
            name = "weight" if kind == "weight" else f"{kind} {origin.get(found.load, found.load) + 1}"
            sideways = math.hypot(*found.force[:-1]) > abs(float(found.force[-1]))
            key = (block, name, sideways)
            sums.setdefault(key, []).append((found.force, found.point))
    result = []
    for (block, name, _), parts in sorted(sums.items(), key=lambda item: item[0][:2]):
        forces = np.array([force for force, _ in parts])
        size = np.array([math.hypot(*force) for force in forces])  # no square of a small force vanishes
        point = size @ np.array([point for _, point in parts]) / size.sum()
        result.append((name, Force(block, forces.sum(axis=0), point)))
    return result
