"""A joint law in one file: cohesion and tensile strength that are lost in proportion to slip."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.changing_laws import Undergone
from concio.problem.contact_problem import Laws


@dataclass(frozen=True)
class CohesionLost:
    """c (1 - s / s_0), nothing left from a slip of s_0 on; the tensile strength likewise.

    Parameters
    ----------
    slip : float
        s_0 [m].
    """

    slip: float

    def __call__(self, law: Laws, seen: Undergone) -> Laws:
        left = np.maximum(1.0 - seen.slip / self.slip, 0.0)
        return replace(law, cohesion=left * law.cohesion, tension=left * law.tension)
