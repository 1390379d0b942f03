"""Strength of a joint as half-spaces of the traction it transmits."""

from __future__ import annotations

import numpy as np

from concio.model.materials import JointLaw

Array = np.ndarray


def joint_half_planes(law: JointLaw) -> tuple[Array, Array]:
    """Return (m (k, 2), g (k,)): tractions (s, t) with m . (s, t) <= g are carried; s is tension across the joint.

    Friction, cohesion, tensile strength and, where there is one, compressive strength [kN/m2].
    """
    rows = [(law.friction, 1.0, law.cohesion), (law.friction, -1.0, law.cohesion), (1.0, 0.0, law.tensile_strength)]
    if law.compressive_strength is not None:
        rows.append((-1.0, 0.0, law.compressive_strength))
    table = np.array(rows, dtype=float)
    return table[:, :2], table[:, 2]
