"""Ties that break in a limit load: how far the path goes while they are whole."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from concio.analysis.path_ties import shares
from concio.analysis.tie_forces import break_elongations
from concio.contact.assembly import Assembly
from concio.contact.factors import load_factor
from concio.problem.tolerances import BROKEN_TIE
from concio.solvers.path.record import EventPath


def whole_up_to(assembly: Assembly, path: EventPath | None, live: Sequence[str]) -> float:
    """Return the largest multiplier that an exact path reaches before a tie breaks; nan where none does, or no path.

    Parameters
    ----------
    assembly : Assembly
    path : EventPath or None
        Its parameter is the multiplier.
    live : sequence of str
    """
    if path is None or not np.isfinite(break_elongations(assembly)).any():
        return float("nan")
    groups = tuple(assembly.groups)
    start = {g: 0.0 if g in live else load_factor(None, g) for g in groups}
    end = {g: 1.0 if g in live else start[g] for g in groups}
    most, before = 0.0, None
    for state in path.states:
        share = shares(assembly, state, start, end)
        if (share >= 1 - BROKEN_TIE).any():
            if before is None:
                return 0.0
            last, own = before
            part = float(np.min(np.where(share > own, (1 - own) / np.where(share > own, share - own, 1.0), np.inf)))
            return max(most, last + min(part, 1.0) * (state.parameter - last))
        most, before = max(most, state.parameter), (state.parameter, share)
    return float("nan")
