"""Contact pressure as a diagram standing on the joints, and as line pieces with a value."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.post.joint_lines import JointLines

Array = np.ndarray


def pressure_diagrams(result: Result, pieces: JointLines, scale: float) -> list[Array]:
    """Return one polygon (n, 2) for each loaded joint: pressure at its pairs, drawn from the joint towards side b [m].

    Parameters
    ----------
    result : Result
    pieces : JointLines
        Of the undeformed joints.
    scale : float
        Length that shows 1 kN/m2 [m].
    """
    pairs = result.assembly.pairs
    if not len(pieces.pair):
        return []
    pressure = np.maximum(result.contacts.pressure[pieces.pair], 0.0)
    face = pairs.interface[pieces.pair]
    cuts = np.flatnonzero(np.diff(face)) + 1
    found = []
    for part in np.split(np.arange(len(face)), cuts):
        value = pressure[part]
        if not value.max() > 0:
            continue
        point = pairs.point[pieces.pair[part]]
        top = point + scale * value[:, None] * pairs.normal[pieces.pair[part]]
        start, end = pieces.ends[part[0], 0], pieces.ends[part[-1], 1]
        found.append(np.vstack([start, top, end]))
    return found
