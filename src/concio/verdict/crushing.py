"""What is known of the strength of joints that crush: how far the points they stand on tell it."""

from __future__ import annotations

import numpy as np

from concio.contact.assembly import Assembly
from concio.contact.joint_points import CRUSHING, EDGE, LEAST_GRADED, edge, graded_error
from concio.contact.pairs import CONTACT_MODELS
from concio.contact.patch_points import CRUSHING as CRUSHING_IN_SPACE


def crushing(assembly: Assembly) -> tuple[str, ...]:
    """Return in a sentence how well joints that crush are resolved; none where none crushes.

    Parameters
    ----------
    assembly : Assembly
    """
    model = assembly.model
    stated = [CONTACT_MODELS.index(name) for name in ("points along the joint", "points over the patch")]
    if not bool((np.isfinite(assembly.laws.cap) & np.isin(assembly.pairs.rule, stated)).any()):
        return ()
    if model.dim == 2:
        return (
            f"joints of rigid blocks that crush stand on {CRUSHING} points: their strength is right to "
            f"{100 * graded_error(CRUSHING):.0f} % where the force acts further than {100 * EDGE:g} % of the "
            f"width from an "
            "edge, and too large nearer to it",
        )
    n = CRUSHING_IN_SPACE if isinstance(model.contact_points, str) else model.contact_points + model.contact_points % 2
    if model.contact_points == "corners" or n < LEAST_GRADED:
        return ("joints that crush stand on too few points near their edges: leave contact_points out",)
    return (
        f"joints of rigid blocks that crush stand on {n} x {n} points: their strength is right to "
        f"{100 * graded_error(n):.0f} % where the force acts further than {100 * edge(n):.1f} % of the width from "
        f"an edge, "
        "and too large nearer to it; contact_points = 20 gives 2 %",
    )
