"""A joint law in one file: a joint whose closure approaches a largest one, stiffer the more it is pressed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from concio.analysis.changing_laws import Undergone
from concio.problem.contact_problem import Laws


@dataclass(frozen=True)
class StiffnessHardens:
    """Pressure over closure k + p / v: the hyperbola p = k w / (1 - w / v) of closures w.

    Parameters
    ----------
    largest : float
        v, the closure under any pressure at most [m].
    """

    largest: float

    def __call__(self, law: Laws, seen: Undergone) -> Laws:
        stiffness = 1.0 / law.normal_compliance + seen.pressure.clip(min=0.0) / self.largest
        return replace(law, normal_compliance=1.0 / stiffness)
