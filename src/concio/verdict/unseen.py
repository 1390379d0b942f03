"""Bodies whose loads are too small beside those of their part for a certificate to see: whether they are held is open.

Errors are measured by the loads of a connected part (:mod:`concio.problem.error_units`). Where the loads of a body are
less than what passes as an error of its part, leaving them out of the balance would not be noticed. Every command that
says that something holds asks here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

import numpy as np

from concio.contact.factors import load_factor
from concio.model.interfaces.detect import Detection
from concio.model.model import Model
from concio.problem.tolerances import CERTIFIED
from concio.verdict.connection import connected_bodies
from concio.verdict.question import Loaded

SEEN = 2.0 * CERTIFIED
"""Loads of a body below this share of those of its part would leave no trace if they were not balanced."""

NAMED = 5
"""More bodies than this are counted."""


class LoadedJoints(Loaded, Protocol):
    """Something whose loads can be reported, with its interfaces."""

    @property
    def detection(self) -> Detection:
        """Its interfaces."""


def unseen(
    loaded: LoadedJoints, *factors: Mapping[str, float] | None, groups: Sequence[Sequence[int]] = ()
) -> tuple[str, ...]:
    """Return a sentence on the bodies that no certificate can see under loads at any of given factors, if any are.

    Parameters
    ----------
    loaded : Assembly
        Or anything else with its loads.
    factors : mappings of str to float
        Load factors at which something is said to hold; a group that is not named has 1, and so have all with None.
    groups : sequence of sequences of int
        Bodies that were solved as one, where these are not the connected parts.
    """
    return unseen_words(unseen_bodies(loaded, factors, groups))


def unseen_words(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the sentence on bodies that no certificate can see; none where there are none."""
    if not names:
        return ()
    verb = "is" if len(names) == 1 else "are"
    return (
        f"whether {listed(names)} {verb} held: the loads there are less than {SEEN:.0e} of those of the structure "
        "around, below the resolution of the residuals",
    )


def listed(names: tuple[str, ...]) -> str:
    """Return names in a row, with a count of those beyond the first."""
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def unseen_bodies(
    loaded: LoadedJoints, factors: Iterable[Mapping[str, float] | None], groups: Sequence[Sequence[int]] = ()
) -> tuple[str, ...]:
    """Return the names of the bodies that no certificate can see at some of the given factors, in their order."""
    model, offsets = loaded.model, loaded.disc.offsets
    part = _numbers(groups, len(model.bodies)) if groups else connected(model, loaded.detection)
    found: set[int] = set()
    for at in factors:
        f = np.zeros(int(offsets[-1]))
        for group, load in loaded.loads.items():
            f += load_factor(at, group) * load
        own = np.add.reduceat(np.append(np.abs(f), 0.0), offsets[:-1]) * (np.diff(offsets) > 0)
        total = np.bincount(part, weights=own)[part]
        found |= set(np.flatnonzero((own > 0) & (own < SEEN * total)).tolist())
    return tuple(model.bodies[b].name for b in sorted(found))


def _numbers(groups: Sequence[Sequence[int]], count: int) -> np.ndarray:
    """Return the number of the group of each body (B,); fixed bodies may have any."""
    found = np.zeros(count, dtype=int)
    for k, group in enumerate(groups):
        found[list(group)] = k
    return found


def connected(model: Model, detection: Detection) -> np.ndarray:
    """Return the number of the connected part of each body (B,); what is fixed connects nothing."""
    free = [body.kind != "fixed" for body in model.bodies]
    number = {body.name: k for k, body in enumerate(model.bodies)}
    links = [(i.a, i.b) for i in detection.interfaces]
    links += [(number[t.body_a], number[t.body_b]) for t in model.ties if {t.body_a, t.body_b} <= {*number}]
    return connected_bodies([(a, b) for a, b in links if free[a] and free[b]], len(free))
