"""What acts in an assessment: the push that is multiplied, with its kN by load group, and what acts as it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from concio.analysis.seismic.directions import Push
from concio.contact.applied import resultants
from concio.display import number
from concio.model.model import Model
from concio.verdict.question import Acting, group_words


def acting_in(model: Model, ways: Sequence[Push]) -> tuple[Acting, ...]:
    """Return one entry for each way of pushing, multiplied, and one for each load group that acts as it is.

    Parameters
    ----------
    model : Model
        As it was given.
    ways : sequence of Push
    """
    found = []
    for push in ways:
        parts = push.by_group()
        total = np.sum([force for force, _ in parts.values()], axis=0)
        sizes = {group: float(np.linalg.norm(force)) for group, (force, _) in parts.items()}
        words = ", ".join(f"{group} {number(force, 4)} kN" for group, force in sizes.items())
        what = f"weights of {words}" if push.origin else words
        size = sum(size for _, size in parts.values())
        found.append(Acting(f"push {push.way}", what, tuple(total.tolist()), size, float("nan"),
                            "multiplied"))  # fmt: skip
    pushing = set() if ways[0].origin else set(ways[0].groups)
    numbers = [k for k, load in enumerate(model.loads) if load.group not in pushing]
    forces = resultants(model, numbers)
    for group in dict.fromkeys(model.loads[k].group for k in numbers):
        force, size = forces.get(group, (np.zeros(model.dim), 0.0))
        found.append(Acting(group, group_words(model, group), tuple(force.tolist()), size))
    return tuple(found)
