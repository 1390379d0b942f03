"""Which mistake would explain a measurement that all others contradict: its sign, its unit, its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.measurement import AT_A_JOINT, Measurement
from concio.analysis.cracks.observed import Reading
from concio.analysis.cracks.places import all_places

Array = np.ndarray

Mistake = Literal["sign", "unit", "place", "unknown"]
UNITS = (10.0, 100.0, 1000.0, 0.1, 0.01, 0.001, 25.4, 1 / 25.4)
"""What a value is multiplied by where its unit was mistaken: between mm, cm, dm, m and inches."""
ROUGH = 0.02
"""Relative error of a value in a mistaken unit, which was rounded in that unit."""
CLOSE = 3.0
"""A corrected value agrees with what is predicted within this many standard deviations."""


@dataclass(frozen=True, eq=False)
class Doubt:
    """A measurement that a cause contradicts, which fits all others.

    Parameters
    ----------
    measurement : str
    number : int
    cause : Cause
        With the measurement left out.
    predicted, measured : float
        [m or rad].
    deviations : float
        Their difference over its standard deviation.
    mistake : {"sign", "unit", "place", "unknown"}
    factor : float
        What the value is to be multiplied by, of a mistaken unit.
    place : (str, str) or None
        Joint at which the value would fit, nearest to where it was said to be.
    """

    measurement: str
    number: int
    cause: Cause
    predicted: float
    measured: float
    deviations: float
    mistake: Mistake
    factor: float = 1.0
    place: tuple[str, str] | None = None


def doubts_of(
    forward: Forward, cause: Cause, measurements: Sequence[Measurement], found: Sequence[Reading]
) -> tuple[Doubt, ...]:
    """Return the measurements that a cause leaves out, with the mistake that would explain each.

    Parameters
    ----------
    forward : Forward
    cause : Cause
    measurements : sequence of Measurement
    found : sequence of Reading
        Of the measurements.
    """
    told = []
    for i in cause.left_out:
        m = measurements[i]
        J = cause.slope[i] * m.error
        sigma = float(np.sqrt(m.error**2 + J @ cause.covariance @ J)) if cause.chosen else m.error
        predicted = float(cause.predicted[i])
        mistake, factor, place = _mistake(forward, cause, m, found[i], predicted, sigma)
        away = abs(predicted - m.value) / sigma
        told.append(Doubt(m.name, i, cause, predicted, m.value, away, mistake, factor, place))
    return tuple(told)


def _mistake(
    forward: Forward, cause: Cause, m: Measurement, reading: Reading, predicted: float, sigma: float
) -> tuple[Mistake, float, tuple[str, str] | None]:
    """Return the mistake, the factor of a unit, and the joint of a place."""
    seen = abs(predicted) > CLOSE * sigma
    if seen and abs(predicted + m.value) < CLOSE * sigma:
        return "sign", 1.0, None
    for factor in UNITS:
        if seen and abs(predicted - factor * m.value) < CLOSE * max(sigma, ROUGH * abs(predicted)):
            return "unit", factor, None
    if m.kind in AT_A_JOINT:
        kind = "slip" if m.kind == "slip" else "opening"
        places = [r for k, r in all_places(forward) if k == kind and r.bodies != reading.bodies]
        values = forward.read(places, cause.prediction.displacement, cause.prediction.factors)
        fits = [r for r, v in zip(places, values.tolist(), strict=True) if abs(v - m.value) < CLOSE * sigma]
        if fits and m.value:
            nearest = min(fits, key=lambda r: float(np.linalg.norm(r.at - reading.at)))
            bodies = forward.assembly.model.bodies
            return "place", 1.0, (bodies[nearest.bodies[0]].name, bodies[nearest.bodies[1]].name)
    return "unknown", 1.0, None
