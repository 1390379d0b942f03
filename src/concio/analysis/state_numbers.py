"""The number of a certified state that an engineer reads first, with its derivatives: a settlement, or a joint force.

Elastic blocks have the largest settlement, at the node where it is. Where that is none, and of rigid blocks with hard
joints, it is the normal force of the joint that carries most. A joint whose force is shared by forces that nothing
determines has no derivative here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from concio.analysis.linearised_state import Rates
from concio.analysis.sensitivity import Sensitivity, SensitivityRow
from concio.analysis.state_sensitivity import StateSensitivity

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

SAME = 1e-6
"""A joint force of the equations with added compliance is that of the state where they differ by less, relative."""


@dataclass(frozen=True)
class LeadingNumber:
    """A number of a state with what it depends on.

    Parameters
    ----------
    kind : {"settlement", "force"}
    of : str
        The block that settles, or the two blocks of the joint.
    value : float
        [m] or [kN].
    sensitivity : Sensitivity
        Its ``multiplier`` is ``value``.
    """

    kind: Literal["settlement", "force"]
    of: str
    value: float
    sensitivity: Sensitivity


def leading_number(result: Result, found: StateSensitivity) -> LeadingNumber | None:
    """Return the largest settlement, or the largest normal force of a joint, with its derivatives.

    Parameters
    ----------
    result : Result
    found : StateSensitivity
        Of the same state.

    Returns
    -------
    LeadingNumber or None
        None where neither has derivatives.

    Examples
    --------
    A pillar of half the stiffness settles twice as much:

    >>> import concio
    >>> from concio.analysis.state_numbers import leading_number
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=1, unit_weight=20.0, horizontal=0.0))
    >>> number = leading_number(result, concio.state_sensitivity(result))
    >>> number.kind, round(number.sensitivity["stiffness of block"].per_percent[1], 6)
    ('settlement', -1.0)
    """
    return _settlement(result, found) or _force(result, found)


def _settlement(result: Result, found: StateSensitivity) -> LeadingNumber | None:
    """Return the largest settlement; of a node of an elastic block alone."""
    disc, down = result.assembly.disc, result.max_settlement
    if result.lent_compliance or not down > 0.0:
        return None
    elastic = np.repeat(disc.shape_of >= 0, np.diff(disc.offsets))
    heights = np.flatnonzero(elastic).reshape(-1, disc.dim)[:, -1]
    if not len(heights) or -float(result.displacement[heights].min()) != down:
        return None
    lowest = int(heights[result.displacement[heights].argmin()])
    row = result.assembly.supported.T[[lowest]]
    body = int(np.searchsorted(disc.offsets, lowest, side="right")) - 1
    return _number("settlement", result.model.bodies[body].name, down, found,
                   lambda rates: -float((row @ rates.displacement)[0]))  # fmt: skip


def _force(result: Result, found: StateSensitivity) -> LeadingNumber | None:
    """Return the normal force of the joint that carries most."""
    pairs = result.assembly.pairs
    force = np.asarray(result.solution.normal_force)
    own = np.flatnonzero(pairs.interface >= 0)
    if not len(own):
        return None
    sums = np.bincount(pairs.interface[own], weights=force[own])
    most = int(sums.argmax())
    pick = np.flatnonzero(pairs.interface == most)
    apart = abs(float(found.normal_force[pick].sum()) - sums[most])
    if not sums[most] > 0.0 or not apart <= SAME * sums[most]:
        return None
    joint = result.assembly.detection.interfaces[most]
    names = " | ".join(result.model.bodies[b].name for b in (joint.a, joint.b))
    return _number("force", names, float(sums[most]), found, lambda rates: float(rates.normal_force[pick].sum()))


def _number(
    kind: Literal["settlement", "force"], of: str, value: float, found: StateSensitivity, part: Callable[[Rates], float]
) -> LeadingNumber | None:
    """Return a number with the derivatives that it has."""

    def rate(rates: Rates | None) -> float:
        return float("nan") if rates is None else part(rates)

    rows = [SensitivityRow(r.name, r.kind, r.of, r.value, r.unit, rate(r.below), rate(r.above), value)
            for r in found.rows]  # fmt: skip
    known = [r for r in rows if np.isfinite([r.below, r.above]).any()]
    known.sort(key=lambda r: -np.nanmax(np.abs((*r.per_percent, 0.0))))
    none = tuple(r for r in rows if not np.isfinite([r.below, r.above]).any())
    return LeadingNumber(kind, of, value, Sensitivity(value, tuple(known), none)) if known else None
