"""Where bodies meet without a joint of their own: what other joints at the same place already connect.

Where four blocks of a stack bond meet, those across touch in a corner. They bear nothing there: each is joined to a
block that is joined to the other, and the joints end at that very place. Such a corner is reported only where no chain
of joints at the place connects the two bodies.
"""

from __future__ import annotations

import numpy as np

from concio.model.linked import linked

Array = np.ndarray


def connected_at(bodies: Array, place: Array, joined: Array, count: int) -> Array:
    """Return which pairs of bodies are connected by joints at a place of their own (k,).

    Parameters
    ----------
    bodies : (k, 2) integer array
        The two bodies at each place.
    place : (j,) integer array
        Place of each joint that reaches one; a joint may be there for several places.
    joined : (j, 2) integer array
        The bodies of each such joint.
    count : int
        Number of bodies of the model.
    """
    if not len(place) or not len(bodies):
        return np.zeros(len(bodies), dtype=bool)
    ends = place[:, None] * np.int64(count) + joined
    asked = np.arange(len(bodies))[:, None] * np.int64(count) + bodies
    names, number = np.unique(np.concatenate([ends.ravel(), asked.ravel()]), return_inverse=True)
    part = linked(number.ravel()[: ends.size], len(names))
    own = part[number.ravel()[ends.size :]].reshape(-1, 2)
    return np.asarray(own[:, 0] == own[:, 1])
