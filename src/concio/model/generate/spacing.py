"""Lines of structured meshes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

Array = np.ndarray


def subdivided(marks: Array, size: float, refinement: int = 1) -> Array:
    """Return increasing lines through ``marks`` whose spans are at most ``size``, each split ``refinement`` times.

    Parameters
    ----------
    marks : (k,) array
        Increasing coordinates that must be lines, k >= 2.
    size : float
        Largest span [m].
    refinement : int
        Further equal splits of each span.
    """
    lines = [marks[:1]]
    for a, b in pairwise(marks):
        n = max(1, int(np.ceil((b - a) / size - 1e-6))) * refinement
        lines.append(a + (b - a) * np.arange(1, n + 1) / n)
    return np.concatenate(lines)
