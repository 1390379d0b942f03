"""Blocks with all joints closed and stuck: what the moduli of a continuum stand for, block by block."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from concio.contact.assembly import Assembly
from concio.problem.pair_state import Normal, PairStates
from concio.problem.tolerances import BONDED_LEFT
from concio.solvers.path.path_state import LinearPath
from concio.solvers.path.state_rates import state_rates

Array = np.ndarray


def bonded_displacement(assembly: Assembly, factors: Mapping[str, float]) -> Array | None:
    """Return the displacements (N_all,) under loads and movements of supports while no joint opens or slips [m].

    None where there are none: supports that move apart tear blocks on hard joints.
    """
    problem = assembly.problem(factors)
    path = LinearPath(problem, problem.f, problem.gap, -problem.slip_origin)
    m = problem.pairs
    found = state_rates(path, PairStates.plane(np.full(m, Normal.CLOSED), np.zeros(m)))
    if found.residual > BONDED_LEFT:
        return None
    u: Array = assembly.supported.T @ found.displacement
    return u
