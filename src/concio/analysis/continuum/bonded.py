"""Blocks with all joints closed and stuck: what the moduli of a continuum stand for, block by block."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from concio.contact.assembly import Assembly
from concio.errors import SolverError
from concio.solvers.path.state import CLOSED, STICK, LinearPath
from concio.solvers.path.state_rates import state_rates

Array = np.ndarray

LEFT = 1e-8
"""Residual of the linear equations above which there is no such state."""


def bonded_displacement(assembly: Assembly, factors: Mapping[str, float]) -> Array:
    """Return the displacements (N_all,) under loads and movements of supports while no joint opens or slips [m].

    Raises
    ------
    SolverError
        There are none: supports move rigid blocks on hard joints apart.
    """
    problem = assembly.problem(factors)
    path = LinearPath(problem, problem.f, problem.gap, -problem.slip_origin[:, 0])
    m = problem.pairs
    found = state_rates(path, np.full(m, CLOSED, dtype=np.int8), np.full(m, STICK, dtype=np.int8))
    if found.residual > LEFT:
        msg = "with all joints closed and stuck the blocks cannot follow their supports"
        raise SolverError(msg, hint="give the joints stiffness, or make the blocks elastic")
    u: Array = assembly.supported.T @ found.displacement
    return u
