r"""What a certified state depends on: derivatives of its displacements and forces with respect to numbers of the model.

Near a state none of whose pairs is about to change, the states of the pairs stay as they are, and the answer
z = (u, t_n, t_t) solves smooth equations r(z, p) = 0: balance, and of every pair whether it is closed, open or crushed,
sticks or slips. Hence

.. math::

    \frac{\partial r}{\partial z}\,\frac{dz}{dp} = -\frac{\partial r}{\partial p} ,

one solve for each number. Models at four values of p near its own give dr/dp at the state as it is; no state is solved
again. Where pairs are about to change (closed without force, at the limit of friction without slip), the answer has
another derivative to either side. The states of the pairs are then read from an answer beside, which is solved, and its
equations hold at the model as it is too.

Source: A. Klarbring, Derivation and analysis of rate boundary-value problems of frictional contact, Eur. J. Mech.
A/Solids 9 (1990) 53-85.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.lent_compliance import lend
from concio.analysis.linearised_state import LinearisedState, Rates
from concio.analysis.parameters import Parameter, own_parameters, parameters_of, row_named, stiffnesses_of
from concio.analysis.sensitivity import BESIDE, STEP
from concio.analysis.step import solve
from concio.arguments import strict
from concio.contact.assembly import assemble_beside
from concio.errors import ConcioError, InputError
from concio.problem.contact_problem import ContactProblem
from concio.read_only import read_only

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.model import Model

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class StateRow:
    """Derivatives of a state with respect to one number of the model.

    Parameters
    ----------
    name, kind, of : str
        As :class:`~concio.analysis.parameters.Parameter`.
    value : float
    unit : str
    below, above : Rates or None
        As the number falls and as it grows, one object where they are the same; None where there is none to that side.
    """

    name: str
    kind: str
    of: str
    value: float
    unit: str
    below: Rates | None
    above: Rates | None

    @property
    def one_sided(self) -> bool:
        """Whether pairs are about to change, so that each side has its own derivatives."""
        return self.below is not self.above


@dataclass(frozen=True, eq=False)
@read_only
class StateSensitivity:
    """What a certified state depends on.

    Parameters
    ----------
    rows : tuple of StateRow
    about_to_change : (k,) integer array
        Numbers of the pairs that are about to change their state.
    normal_force : (m,) array
        Of the state whose derivatives these are [kN]: that of the result, or with a compliance added to hard joints.

    Examples
    --------
    The forces in a pillar are in proportion to its weight:

    >>> import concio
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0))
    >>> row = concio.state_sensitivity(result)["unit weight of block"]
    >>> bool(abs(row.value * row.above.normal_force - result.solution.normal_force).max() < 1e-9)
    True
    """

    rows: tuple[StateRow, ...]
    about_to_change: Array
    normal_force: Array

    def __getitem__(self, name: str) -> StateRow:
        """Return the row of a name.

        Raises
        ------
        InputError
            There is none.
        """
        return row_named(self.rows, name)


@strict
def state_sensitivity(
    result: Result, changes: Mapping[str, Callable[[float], Model]] | None = None
) -> StateSensitivity:
    """Return the derivatives of a certified state with respect to every number of the model.

    Numbers are friction, strengths and stiffnesses of joints, unit weights and Young's moduli of materials, loads,
    ties, lengths and thicknesses. Where rigid blocks have hard joints, displacements are those of a vanishing
    compliance and only the forces mean something.

    Parameters
    ----------
    result : Result
        Of a solved load step.
    changes : mapping of str to callable, optional
        Numbers of your own in place of those of the model: for each name what returns the model that a change by so
        much makes, 0.0 being none. Its blocks and joints must stay in their order.

    Returns
    -------
    StateSensitivity

    Raises
    ------
    InputError
        There is no certified state.

    Examples
    --------
    An elastic pillar shortens by weight times height over two E A. One per cent more stiffness is one per cent less:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, unit_weight=20.0, horizontal=0.0)
    >>> result = concio.solve(pillar)
    >>> row = concio.state_sensitivity(result)["stiffness of block"]
    >>> u, rate = result.solution.displacement, row.above.displacement
    >>> bool(abs(row.value * rate + u).max() < 1e-9 * abs(u).max())
    True
    """
    if not result.solved:
        msg = "there is no certified state to depend on anything"
        raise InputError(msg, hint="a limit load has derivatives of its own: concio.limit(model).sensitivity()")
    model = result.model
    numbers = (*parameters_of(model), *stiffnesses_of(model)) if changes is None else own_parameters(changes)
    here = LinearisedState.of(result)
    return StateSensitivity(tuple(_row(p, result, here) for p in numbers), np.flatnonzero(here.about), here.t_n)


def _row(p: Parameter, result: Result, here: LinearisedState) -> StateRow:
    """Return the derivatives with respect to one number."""
    size = abs(p.value) or 1.0

    @cache
    def at(k: int) -> ContactProblem:
        value = p.value + k * STEP * size
        problem = lend(assemble_beside(result.assembly, p.change(value))).problem(result.factors)
        if problem.pairs != here.problem.pairs or problem.unknowns != here.problem.unknowns:
            msg = "models beside this one have other joints"
            raise InputError(msg)
        return problem

    sides: list[Rates | None] = []
    for sign in (-1.0, 1.0) if here.about.any() else (0.0,):
        try:
            state = here
            if sign:
                beside = assemble_beside(result.assembly, p.change(p.value + sign * BESIDE * size))
                state = here.with_states_of(solve(beside, factors=result.factors))
            sides.append(state.rates(_slope(state, at) / (STEP * size)))
        except (ConcioError, ValueError):
            sides.append(None)
    return StateRow(p.name, p.kind, p.of, p.value, p.unit, sides[0], sides[-1])


def _slope(state: LinearisedState, at: Callable[[int], ContactProblem]) -> Array:
    """Return h dr/dp at the state as it is, from models at multiples of h beside it.

    Two of them say all of what is linear in the number; a curvature that they show brings in two others.
    """
    low, here, high = state.residual(at(-2)), state.residual(state.problem), state.residual(at(2))
    if state.is_rounding(low - 2 * here + high):
        found: Array = (high - low) / 4
    else:
        found = (low - 8 * state.residual(at(-1)) + 8 * state.residual(at(1)) - high) / 12
    return found
