"""Where to measure next: the place whose reading differs most between the causes that remain, or within the one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.forward import Forward, Prediction
from concio.analysis.cracks.observed import Reading, body_reading, corners, joint_reading, tangent
from concio.model.interfaces.detect import Interface

Array = np.ndarray

NOTHING = 1e-6
"""A spread of so many errors is rounding."""
SAME = 0.25
"""Distance of two places over the size of their joint up to which a measurement at one tells the other."""


@dataclass(frozen=True, eq=False)
class Place:
    """A place that could be measured.

    Parameters
    ----------
    kind : {"opening", "slip", "level", "displacement"}
        Displacements of bodies are named where no opening and no slip tells the causes apart: vertical ones as levels.
    joint : tuple of str
        The two bodies of the joint; of a displacement the body.
    at : (d,) tuple
        [m].
    predicted : tuple of float
        What each cause predicts there [m].
    spread : float
        Largest difference between two causes there; of a single cause twice the standard deviation of its prediction,
        or the difference to motions that the measurements do not distinguish from it [m].
    gain : float
        The same over the error of a measurement.
    direction : tuple of float
        Of a displacement.
    """

    kind: str
    joint: tuple[str, ...]
    at: tuple[float, ...]
    predicted: tuple[float, ...]
    spread: float
    gain: float
    direction: tuple[float, ...] = ()


def all_places(forward: Forward) -> list[tuple[str, Reading]]:
    """Return the opening at every corner and the slip in the middle of every joint that is in the plane."""
    assembly = forward.assembly
    found = []
    for joint in assembly.detection.faces:
        found += [("opening", joint_reading(assembly, joint, point, joint.normal)) for point in corners(joint)]
        if isinstance(joint, Interface):
            found.append(("slip", joint_reading(assembly, joint, (joint.start + joint.end) / 2, tangent(joint))))
    return found


def displacements(forward: Forward) -> list[tuple[str, Reading]]:
    """Return the displacement of the middle of every body along every axis, vertical ones first."""
    assembly = forward.assembly
    axes = np.eye(assembly.model.dim)[::-1]
    return [
        ("level" if along[-1] else "displacement", body_reading(assembly, b, along))
        for along in axes
        for b in range(len(assembly.model.bodies))
    ]


def next_places(
    forward: Forward, causes: Sequence[Cause], error: float, *, known: Sequence[tuple[str, Reading]] = (),
    rivals: Sequence[Prediction] = (), most: int = 5,
) -> tuple[Place, ...]:  # fmt: skip
    """Return the places at which the causes differ most, at most one of a kind at a joint.

    Openings and slips are read afterwards; how far a body has moved is known of few. So displacements are named only
    where no opening and no slip differs by more than an error: of each axis the one that differs most.

    Parameters
    ----------
    forward : Forward
    causes : sequence of Cause
    error : float
        Standard deviation of a measurement of an opening [m].
    known : sequence of (str, Reading)
        Openings and slips that were measured: their places are not named again.
    rivals : sequence of Prediction
        States beside a single cause that the measurements do not distinguish from it.
    most : int
    """
    if not causes:
        return ()
    named = (causes, error, known, rivals)
    at_joints = _ranked(forward, all_places(forward), *named)
    if at_joints and at_joints[0].gain > 1.0:
        return tuple(at_joints[:most])
    moved = [p for p in _ranked(forward, displacements(forward), *named) if p.gain > 1.0]
    first = {p.direction: p for p in reversed(moved)}
    return tuple([*sorted(first.values(), key=lambda p: -p.gain), *at_joints][:most])


def _ranked(
    forward: Forward, places: Sequence[tuple[str, Reading]], causes: Sequence[Cause], error: float,
    known: Sequence[tuple[str, Reading]], rivals: Sequence[Prediction],
) -> list[Place]:  # fmt: skip
    """Return places with their spreads, the largest first, at most one of a kind at a joint."""
    rows = [reading for _, reading in places]
    told = np.array([forward.read(rows, c.prediction.displacement, c.prediction.factors) for c in causes])
    spread = np.ptp(told, axis=0) if len(causes) > 1 else 2.0 * _deviation(forward, causes[0], rows, told[0])
    beside = [forward.read(rows, r.displacement, r.factors) for r in rivals]
    if len(causes) == 1 and beside:
        spread = np.maximum(spread, np.ptp([told[0], *beside], axis=0))
    spread[_measured(places, known)] = 0.0
    bodies = [b.name for b in forward.assembly.model.bodies]
    found: list[Place] = []
    used: set[tuple[str, tuple[int, int], tuple[float, ...]]] = set()
    for i in np.argsort(-spread, kind="stable").tolist():
        kind, reading = places[i]
        along = tuple(reading.along.tolist()) if kind in ("level", "displacement") else ()
        if (kind, reading.bodies, along) in used or spread[i] <= NOTHING * error:
            continue
        used.add((kind, reading.bodies, along))
        joint = tuple(bodies[b] for b in reading.bodies if b >= 0)
        at, values = tuple(reading.at.tolist()), tuple(told[:, i].tolist())
        found.append(Place(kind, joint, at, values, float(spread[i]), float(spread[i]) / error, along))
    return found


def _measured(places: Sequence[tuple[str, Reading]], known: Sequence[tuple[str, Reading]]) -> Array:
    """Return which places (n,) were measured: the same kind at the same joint, nearer than a part of its size."""
    at = np.array([r.at for _, r in places])
    joints = np.array([r.bodies for _, r in places])
    found = np.zeros(len(places), dtype=bool)
    for kind, reading in known:
        own = (joints == reading.bodies).all(axis=1)
        if own.any():
            size = float(np.linalg.norm(np.ptp(at[own], axis=0)))
            same = own & (np.array([k for k, _ in places]) == kind)
            found |= same & (np.linalg.norm(at - reading.at, axis=1) < SAME * size)
    return found


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
