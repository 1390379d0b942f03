"""Parts that slide: one block, what lies on it, and what stands in the way of either.

Where joints slide, parts of many shapes begin to move at one multiplier, that of their friction, and fare otherwise in
their checks. A search of collapse states ends at one of them, another one with another order of the blocks. A part
slides as one where it takes along what lies on it and what stands before it: every such part is a union of the least
ones, one for each block. These are followed, so that none of them is better off than what is reported.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import breadth_first_order

from concio.contact.assembly import Assembly
from concio.problem.limits_of_work import MOST_SLIDING

Array = np.ndarray

LEAN = 0.1
"""Joints whose normal leans from the horizontal, or from the line across the push, by more take bodies along."""


def sliding_parts(assembly: Assembly, along: Array) -> dict[tuple[int, ...], str]:
    """Return the least parts that can slide along a push, with their names; none where there are too many.

    Parameters
    ----------
    assembly : Assembly
    along : (d,) array
        Horizontal unit vector of the push.
    """
    model, pairs = assembly.model, assembly.pairs
    if model.dim != 2:
        return {}
    count = len(model.bodies)
    a, b = np.asarray(pairs.body_a), np.asarray(pairs.body_b)
    real = (a >= 0) & (b >= 0) & (a < count) & (b < count)
    a, b, normal = a[real], b[real], np.asarray(pairs.normal)[real]
    rises, ahead = normal[:, -1], normal @ along
    takes = (rises > LEAN) | (ahead > LEAN)  # a moves, and b lies on it or stands before it
    taken = (rises < -LEAN) | (ahead < -LEAN)
    start, end = np.concatenate([a[takes], b[taken]]), np.concatenate([b[takes], a[taken]])
    graph = sp.csr_array((np.ones(len(start)), (start, end)), shape=(count, count))
    fixed = {i for i, body in enumerate(model.bodies) if body.kind == "fixed"}
    found: dict[tuple[int, ...], str] = {}
    for i in sorted(set(range(count)) - fixed, key=lambda i: model.bodies[i].name):
        part = {int(k) for k in breadth_first_order(graph, i, return_predecessors=False)}
        if not part & fixed:
            found.setdefault(tuple(sorted(part)), f"{model.bodies[i].name} and what slides with it")
    return found if len(found) <= MOST_SLIDING else {}
