"""Ties on their way: what they have been through decides what they pull, and where they yield and break.

A tie is elastic up to its strength, yields there, unloads parallel to its first branch, and pulls no more once it was
longer than its elongation at break, whatever happens to its length afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.model.model import Model, Tie

Array = np.ndarray

MET = 1e-8
"""A tie that came as near to its elongation at yield, relative, has yielded."""


def with_strength(model: Model) -> Model:
    """Return a model whose ties yield at their strength: a tie carries at most what it has when it breaks."""
    return replace(model, ties=tuple(replace(t, yield_force=t.strength) if t.strength < t.most else t
                                     for t in model.ties))  # fmt: skip


@dataclass(frozen=True, eq=False)
class TieHistory:
    """What ties have been through.

    Parameters
    ----------
    longest : (n,) array
        Largest elongation of each [m].
    broken : (n,) boolean array
    """

    longest: Array
    broken: Array

    @classmethod
    def none(cls, count: int) -> TieHistory:
        """Return that of ties that have not moved."""
        return cls(np.zeros(count), np.zeros(count, dtype=bool))

    def force(self, k: int, tie: Tie, elongation: float) -> float:
        """Return the tension [kN] of tie k at an elongation [m]."""
        if self.broken[k]:
            return 0.0
        plastic = max(0.0, max(float(self.longest[k]), elongation) - yields_at(tie))
        return min(max(tie.prestress + tie.stiffness * (elongation - plastic), 0.0), tie.strength)

    def after(self, elongation: Array, breaking: Sequence[int] = ()) -> TieHistory:
        """Return it with elongations (n,) reached, and with the ties numbered in ``breaking`` broken."""
        broken = self.broken.copy()
        broken[list(breaking)] = True
        return TieHistory(np.maximum(self.longest, elongation), broken)

    def next_event(self, ties: Sequence[Tie], before: Array, after: Array) -> tuple[int, float, bool] | None:
        """Return the first tie to yield or break between elongations (n,), taken as a line.

        Returns
        -------
        tuple or None
            Its number, the elongation at which it does [m], and whether it breaks.
        """
        found: list[tuple[float, int, float, bool]] = []
        for k, tie in enumerate(ties):
            if self.broken[k] or after[k] <= before[k]:
                continue
            ends = [(yields_at(tie), False)] if self.longest[k] < yields_at(tie) * (1 - MET) else []
            if tie.break_elongation is not None:
                ends = [*(e for e in ends if e[0] < tie.break_elongation), (tie.break_elongation, True)]
            found += [((limit - before[k]) / (after[k] - before[k]), k, limit, breaks) for limit, breaks in ends
                      if before[k] < limit <= after[k]]  # fmt: skip
        return min(found)[1:] if found else None


def yields_at(tie: Tie) -> float:
    """Return the elongation at which a tie yields [m]; ``inf`` where it never does."""
    return (tie.most - tie.prestress) / tie.stiffness


def together(ties: Sequence[Tie], rates: Array) -> tuple[float, Array]:
    """Return the displacement at which ties do the most work together, and their forces (n,) there [kN].

    Ties that get longer at different rates yield and break at different displacements: what each can carry for itself
    they need not carry at once.

    Parameters
    ----------
    ties : sequence of Tie
    rates : (n,) array
        Elongation of each as the control point moves by one; those that get shorter do not pull.
    """
    ends = [limit / rates[k] for k, tie in enumerate(ties) if rates[k] > 0
            for limit in (yields_at(tie), tie.break_elongation or np.inf) if np.isfinite(limit)]  # fmt: skip
    best, forces = 0.0, np.zeros(len(ties))
    most = -1.0
    for d in ends or [np.inf]:
        now = np.array([
            0.0 if rates[k] <= 0 or (t.break_elongation is not None and rates[k] * d > t.break_elongation * (1 + 1e-12))
            else min(t.prestress + t.stiffness * rates[k] * d, t.strength)
            for k, t in enumerate(ties)
        ])  # fmt: skip
        work = float(now @ np.maximum(rates, 0.0))
        if work > most:
            best, forces, most = d, now, work
    return best, forces
