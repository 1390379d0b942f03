"""Blocks that cannot yield and are forced together: where supports move, and the added compliance makes the room."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.assembly import Assembly
from concio.contact.factors import load_factor
from concio.contact.pairs import pair_laws

if TYPE_CHECKING:
    from concio.analysis.path_result import PathResult

FORCED = 1e-2
"""Share of the largest displacement that an added compliance takes up where rigid blocks are forced together; of blocks
that can move aside it takes up a share that falls with the compliance added, some 1e-4."""

BEYOND_LOADS = 3.0
"""A movement that raises the force of a joint by more than this many times all loads has more to work against than
these."""


def forced_together(compliance: float) -> str:
    """Return what forces of rigid blocks that are forced together depend on.

    Parameters
    ----------
    compliance : float
        What was added to their joints [m/kN].
    """
    return (
        "blocks that cannot yield are forced together: the forces between them grow without bound as joints become "
        f"stiffer, and those given belong to a compliance of {compliance:.3g} m/kN"
    )


def forced_on_path(found: PathResult) -> tuple[str, ...]:
    """Return a sentence on a path whose stages force rigid blocks together, else none.

    Parameters
    ----------
    found : PathResult
    """
    assembly = found.assembly
    if not (assembly.lent_compliance and found.steps):
        return ()
    laws = assembly.laws
    added = np.where(pair_laws(assembly.model, assembly.pairs).normal_compliance == 0, laws.normal_compliance, 0.0)
    before = found.steps[0]
    for step in {step.stage: step for step in found.steps}.values():
        more = step.state.normal_force - before.state.normal_force
        movement = _movement(assembly, before.factors, step.factors)
        loads = assembly.problem(step.factors).total_load
        if (added * more).max(initial=0.0) > FORCED * movement > 0 and more.max() > BEYOND_LOADS * loads:
            return (forced_together(assembly.lent_compliance),)
        before = step
    return ()


def _movement(assembly: Assembly, before: Mapping[str, float], after: Mapping[str, float]) -> float:
    """Return the largest movement that supports and moved obstacles impose on a pair between some factors [m]."""
    pairs = assembly.pairs
    largest = 0.0
    for group in {*assembly.moved, *assembly.supported.imposed}:
        change = abs(load_factor(after, group) - load_factor(before, group))
        found = [*assembly.moved.get(group, ())]
        if (u := assembly.supported.imposed.get(group)) is not None:
            found += [pairs.C_n @ u, pairs.C_t @ u]
        largest += change * max(float(np.abs(v).max(initial=0.0)) for v in found)
    return largest
