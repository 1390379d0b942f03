"""A path in units of its own: displacements and forces of order one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.solvers.path.path_state import LinearPath

APART = 1e4
"""Ratio of compliances above which the unit of length lies between them."""


@dataclass(frozen=True, eq=False)
class ScaledData:
    """What the equations of a plane path are made of, in scaled units.

    Parameters
    ----------
    cone : Cone
    dilatancy : (m,) array
    a_n, a_t : (m,) arrays
        Compliances.
    gap, origin : (m,) arrays
        x_n and x_t at parameter 0.
    gap_rate, tangent_rate : (m,) arrays
        Their movement for each unit of the parameter.
    load, load_rate : (N,) arrays
    """

    cone: Cone
    dilatancy: Array
    a_n: Array
    a_t: Array
    gap: Array
    origin: Array
    gap_rate: Array
    tangent_rate: Array
    load: Array
    load_rate: Array


@dataclass(frozen=True, eq=False)
class ScaledPath:
    """The path in scaled units: displacement unit ``length``, force unit ``force``; tau as it is.

    Parameters
    ----------
    path : LinearPath
    force, length : float
        Units [kN], [m].
    """

    path: LinearPath
    force: float
    length: float

    @classmethod
    def of(cls, path: LinearPath) -> ScaledPath:
        """Choose the units: a typical nodal or joint force, and the displacement it causes.

        Where joints are much softer than what is typical, such as a tie beside joints of rigid blocks that were given a
        compliance, the unit lies between both. Else the stiffness of the tie, which may be all that holds the
        structure as it slides, would be less than what is added to the factors, and would pass for none.
        """
        problem = path.problem
        loads = np.abs(np.concatenate([problem.f, path.load_rate]))
        force = float(loads[loads > 0].mean()) if loads.any() else 1.0
        diagonal = problem.K.diagonal()
        compliance = problem.laws.normal_compliance
        soft = compliance[compliance > 0]
        if (diagonal > 0).any():
            typical = 1.0 / float(np.median(diagonal[diagonal > 0]))
        elif soft.size:
            typical = float(np.median(soft))
        else:
            return cls(path, force, 1.0)
        softest = float(soft.max(initial=0.0))
        if softest > APART * typical:
            typical = float(np.sqrt(typical * softest))
        return cls(path, force, force * typical)

    @cached_property
    def data(self) -> ScaledData:
        """Laws, rates and gaps in scaled units."""
        path, problem, law = self.path, self.path.problem, self.path.problem.laws
        soft = self.force / self.length
        return ScaledData(
            problem.cone.in_units(self.force), law.dilatancy, law.normal_compliance * soft,
            law.tangential_compliance * soft, problem.gap / self.length, problem.slip_origin[:, 0] / self.length,
            path.gap_rate / self.length, path.tangent_rate[:, 0] / self.length, problem.f / self.force,
            path.load_rate / self.force,
        )  # fmt: skip
