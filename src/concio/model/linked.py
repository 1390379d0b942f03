"""What is near to what, and what is connected: SciPy's trees and graphs, loaded when first asked for.

A model is read and its picture drawn before any of this is needed, and SciPy takes longer to load than both.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def pairs_within(points: Array, distance: float, box: Array | None = None) -> Array:
    """Return the pairs (n, 2) of points (m, d) that are no farther apart than a distance.

    Parameters
    ----------
    points : (m, d) array
    distance : float
    box : (d,) array, optional
        Periods, where the points repeat.
    """
    from scipy.spatial import cKDTree

    found: Array = cKDTree(points, boxsize=box).query_pairs(distance, output_type="ndarray")
    return found


def nearest(points: Array, asked: Array) -> Array:
    """Return the index (k,) of the point (m, d) nearest to each of those asked for (k, d)."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(points).query(asked)[1])


def linked(pairs: Array, count: int) -> Array:
    """Return the number of the group (count,) of each of so many things that pairs (n, 2) link, from 0.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.model.linked import linked
    >>> linked(np.array([[0, 2], [1, 3]]), 5).tolist()
    [0, 1, 0, 1, 2]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    first, second = np.reshape(pairs, (-1, 2)).T
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    found: Array = connected_components(graph, directed=False)[1]
    return found
