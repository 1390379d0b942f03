"""Rates of a structure whose pairs keep given states: the linear response between two events."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import LinearPath
from concio.solvers.path.scaling import ScaledPath


@dataclass(frozen=True, eq=False)
class StateRates:
    """Rates for each unit of the parameter of a path.

    Parameters
    ----------
    displacement : (N,) array
        [m].
    normal_force : (m,) array
    friction_force : (m, 1) array
        [kN].
    residual : float
        What the linear equations leave, relative to the rate of the path; not small where the states admit no response.
    """

    displacement: Array
    normal_force: Array
    friction_force: Array
    residual: float


def state_rates(path: LinearPath, states: PairStates) -> StateRates:
    """Return the rates of a path whose pairs keep their states.

    Parameters
    ----------
    path : LinearPath
    states : PairStates
    """
    scaled = ScaledPath.of(path)
    driven = float(max(np.abs(path.gap_rate).max(initial=0.0), np.abs(path.tangent_rate).max(initial=0.0)))
    pushed = float(np.abs(path.load_rate).max(initial=0.0))
    unit = max(driven / scaled.length, pushed / scaled.force) or 1.0
    slow = replace(
        path, load_rate=path.load_rate / unit, gap_rate=path.gap_rate / unit, tangent_rate=path.tangent_rate / unit
    )
    n, m = path.problem.unknowns, path.problem.pairs
    control = np.zeros(n + 2 * m + 1)
    control[-1] = 1.0
    equations = PathEquations(replace(scaled, path=slow), states.normal, states.sign, control)
    x, residual = equations.refined(control)
    length, force = scaled.length * unit, scaled.force * unit
    return StateRates(x[:n] * length, x[n : n + m] * force, x[n + m : -1, None] * force, residual)
