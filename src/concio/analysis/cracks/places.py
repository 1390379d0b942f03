"""Where to measure next: the place whose reading differs most between the causes that remain, or within the one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.observed import Reading, corners, joint_reading, tangent
from concio.model.interfaces.detect import Interface

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Place:
    """A place that could be measured.

    Parameters
    ----------
    kind : {"opening", "slip"}
    joint : (str, str)
    at : (d,) tuple
        [m].
    predicted : tuple of float
        What each cause predicts there [m].
    spread : float
        Largest difference between two causes there, or of a single cause twice the standard deviation of its
        prediction [m].
    gain : float
        The same over the error of a measurement.
    """

    kind: str
    joint: tuple[str, str]
    at: tuple[float, ...]
    predicted: tuple[float, ...]
    spread: float
    gain: float


def all_places(forward: Forward) -> list[tuple[str, Reading]]:
    """Return the opening at every corner and the slip in the middle of every joint that is in the plane."""
    assembly = forward.assembly
    found = []
    for joint in assembly.detection.faces:
        found += [("opening", joint_reading(assembly, joint, point, joint.normal)) for point in corners(joint)]
        if isinstance(joint, Interface):
            found.append(("slip", joint_reading(assembly, joint, (joint.start + joint.end) / 2, tangent(joint))))
    return found


def next_places(forward: Forward, causes: Sequence[Cause], error: float, most: int = 5) -> tuple[Place, ...]:
    """Return the places at which the causes differ most, at most one of a kind at a joint.

    Parameters
    ----------
    forward : Forward
    causes : sequence of Cause
    error : float
        Standard deviation of a measurement of an opening [m].
    most : int
    """
    if not causes:
        return ()
    places = all_places(forward)
    rows = [reading for _, reading in places]
    told = np.array([forward.read(rows, c.prediction.displacement, c.prediction.factors) for c in causes])
    spread = np.ptp(told, axis=0) if len(causes) > 1 else 2.0 * _deviation(forward, causes[0], rows, told[0])
    bodies = [b.name for b in forward.assembly.model.bodies]
    found: list[Place] = []
    used: set[tuple[str, tuple[int, int]]] = set()
    for i in np.argsort(-spread, kind="stable").tolist():
        kind, reading = places[i]
        if (kind, reading.bodies) in used or spread[i] <= 0:
            continue
        used.add((kind, reading.bodies))
        a, b = reading.bodies
        at = tuple(reading.at.tolist())
        found.append(
            Place(kind, (bodies[a], bodies[b]), at, tuple(told[:, i].tolist()), float(spread[i]), spread[i] / error)
        )
        if len(found) == most:
            break
    return tuple(found)


def _deviation(forward: Forward, cause: Cause, rows: Sequence[Reading], here: Array) -> Array:
    """Return the standard deviation of what a cause predicts at some places (n,), to first order."""
    if not cause.chosen:
        return np.zeros(len(rows))
    columns = []
    for c, near in zip(cause.chosen, cause.neighbours, strict=True):
        if near is None:
            columns.append(np.zeros(len(rows)))
            continue
        there = forward.read(rows, near.displacement, near.factors)
        columns.append((there - here) / (near.motions[c] - cause.motions[c]))
    J = np.column_stack(columns)
    variance: Array = np.einsum("ni,ij,nj->n", J, cause.covariance, J)
    deviation: Array = np.sqrt(np.maximum(variance, 0.0))
    return deviation
