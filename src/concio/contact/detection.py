"""Interfaces of a model where its bodies were described, with the tolerance within which they touch."""

from __future__ import annotations

import numpy as np

from concio.contact.geometry import GEOMETRIES
from concio.contact.separate import bare, merged, separate_groups
from concio.contact.touching import law_refusal, with_point_contacts
from concio.errors import GeometryError
from concio.model.interfaces.detect import Detection
from concio.model.model import Model


def default_tolerance(model: Model) -> float:
    """Return the distance within which edges touch: the model's, or 1e-6 of its size [m]."""
    if model.gap_tolerance is not None:
        return model.gap_tolerance
    return 1e-6 * model.size


def detect(model: Model) -> Detection:
    """Return the interfaces of a model with the report of what was dropped or overlaps.

    Structures that stand apart are examined one by one: the tolerance of each is 1e-6 of its own size, unless the
    model gives one.
    """
    geometry = GEOMETRIES[model.dim]
    groups = [np.arange(len(model.bodies))] if model.periods is not None else separate_groups(model)
    if not groups or len(groups[0]) == len(model.bodies):
        tolerance = default_tolerance(model)
        whole = geometry.detect(model, tolerance)
        if model.periods is not None:
            return whole
        return with_point_contacts(model, whole, tolerance, law_refusal(model, np.arange(len(model.bodies))))
    found = []
    for group in groups:
        part = bare(model, group)
        tolerance = default_tolerance(part)
        why = law_refusal(model, group)
        found.append((group, with_point_contacts(part, geometry.detect(part, tolerance), tolerance, why)))
    return merged(found)


def detect_without_overlap(model: Model) -> Detection:
    """Return the interfaces of a model whose bodies do not overlap.

    Raises
    ------
    GeometryError
        Two bodies overlap.
    """
    detection = detect(model)
    if detection.overlaps:
        first = detection.overlaps[0]
        others = len(detection.overlaps) - 1
        msg = first.sentence + (f", and {others} more overlap{'s' if others > 1 else ''}" if others else "")
        raise GeometryError(msg, hint="raise gap_tolerance only where the overlap is no more than inaccurate drawing")
    return detection
