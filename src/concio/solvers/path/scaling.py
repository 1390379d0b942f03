"""A path in units of its own: displacements and forces of order one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.path.state import LinearPath


@dataclass(frozen=True, eq=False)
class Scaled:
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
    def of(cls, path: LinearPath) -> Scaled:
        """Choose the units: a typical nodal or joint force, and the displacement it causes."""
        problem = path.problem
        loads = np.abs(np.concatenate([problem.f, path.load_rate]))
        force = float(loads[loads > 0].mean()) if loads.any() else 1.0
        diagonal = problem.K.diagonal()
        compliance = problem.laws.normal_compliance
        if (diagonal > 0).any():
            length = force / float(np.median(diagonal[diagonal > 0]))
        elif (compliance > 0).any():
            length = force * float(np.median(compliance[compliance > 0]))
        else:
            length = 1.0
        return cls(path, force, length)

    @cached_property
    def arrays(self) -> dict[str, Array]:
        """Laws, rates and gaps in scaled units, by name."""
        problem, law = self.path.problem, self.path.problem.laws
        soft = self.force / self.length
        return {
            "mu": law.friction,
            "psi": law.dilatancy,
            "c": law.cohesion / self.force,
            "T": law.tension / self.force,
            "N": law.cap / self.force,
            "a_n": law.normal_compliance * soft,
            "a_t": law.tangential_compliance * soft,
            "x": problem.gap / self.length,
            "x_t": problem.slip_origin[:, 0] / self.length,
            "x_rate": self.path.gap_rate / self.length,
            "t_rate": self.path.tangent_rate / self.length,
            "f": problem.f / self.force,
            "g": self.path.load_rate / self.force,
        }
