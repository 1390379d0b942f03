"""How far a point is from the joint laws, and the states it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem import natural_map
from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import CERTIFIED, EXACT
from concio.solvers.algebra.scaled import Scaled


@dataclass(frozen=True, eq=False)
class Finished:
    """A point in given states, scaled units, and how exact it is.

    Parameters
    ----------
    u, t : arrays
        Shapes (N,), (m, d).
    states : PairStates
    error : float
        Natural-map residual: largest of imbalance and of the violation of the joint laws, relative.
    solves : int
        Linear systems solved for given states.
    undecided : (k,) integer array
        Pairs whose states the point contradicts; empty when exact.
    """

    u: Array
    t: Array
    states: PairStates
    error: float
    solves: int
    undecided: Array

    @property
    def settled(self) -> bool:
        """Whether the states are the right ones: the error is rounding, or the point contradicts none of them.

        Where joints are all but redundant refinement stops a little above rounding; the certificate judges the rest.
        """
        return self.error <= EXACT or (not self.undecided.size and self.error <= CERTIFIED)


def sizes(u: Array, t: Array) -> tuple[float, float]:
    """Return the largest force and the largest displacement, at least one."""
    return max(1.0, float(np.abs(t).max(initial=0.0))), max(1.0, float(np.abs(u).max(initial=0.0)))


def natural_residual(s: Scaled, u: Array, t: Array) -> tuple[float, Array]:
    """Return the largest relative violation of equilibrium and joint laws, and that of the laws for each pair (m,).

    Forces count relative to the largest force, lengths relative to the largest displacement.
    """
    force, length = sizes(u, t)
    laws: Array = np.abs(s.natural_map(u, t, force / length)).max(axis=1, initial=0.0) / force
    return max(s.unbalanced(u, t, force), float(laws.max(initial=0.0))), laws


def read_states(s: Scaled, u: Array, t: Array) -> PairStates:
    """Return the states that the natural map assigns to a point (:func:`concio.problem.natural_map.read_states`)."""
    force, length = sizes(u, t)
    return natural_map.read_states(s.cone, s.weighted(u, t, force / length), t, s.dilatancy)
