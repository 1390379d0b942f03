"""Events between two equilibria: joints that open, close, slip, stick or crush, new contacts, ties that give way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.analysis.motion.state import Memory, TieMemory
from concio.analysis.motion.step_pairs import PairMaker
from concio.contact.rows import Rows
from concio.model.model import Model
from concio.problem.pair_state import Normal

Array = np.ndarray


@dataclass(frozen=True)
class JointEvent:
    """A contact that changes its state.

    Parameters
    ----------
    step : int
        Index of the point of the curve from which on the new state holds.
    kind : str
        "opens", "closes", "slips", "sticks", "crushes", "recovers"; "touches" where nothing touched before; of ties
        "yields" and "breaks".
    bodies : (str, str)
        Of a tie its name and the body at its end.
    at : (x, y), in space (x, y, z)
        Where it happens, in the displaced structure [m].
    """

    step: int
    kind: str
    bodies: tuple[str, str]
    at: tuple[float, ...]

    def __str__(self) -> str:
        a, b = self.bodies
        return f"{self.step}: {a} | {b} {self.kind} at ({', '.join(f'{v:.4g}' for v in self.at)})"


def joint_events(
    model: Model, maker: PairMaker, rows: Rows, before: Memory, after: Memory, step: int
) -> list[JointEvent]:
    """Return what changed between two equilibria; ``after`` and ``rows`` belong to the present layout."""
    old = before.carried_to(after.key)
    known = np.isin(after.key, before.key)
    slots = maker.slots
    carries = after.force[:, 0] > 0
    closed = (after.contact != Normal.OPEN) & rows.valid
    was = old.contact != Normal.OPEN
    slips, slipped = after.slip.any(axis=1), old.slip.any(axis=1)
    same = (old.slip == after.slip).all(axis=1)
    kinds = (
        ("opens", known & was & ~closed & (old.force[:, 0] > 0)),
        ("closes", known & ~was & closed & carries),
        ("touches", ~known & closed & carries & ~slots.bonded),
        ("slips", closed & carries & slips & ~(known & same)),
        ("sticks", closed & carries & known & ~slips & slipped),
        ("crushes", (after.contact == Normal.CRUSHED) & ~(known & (old.contact == Normal.CRUSHED))),
        ("recovers", known & (old.contact == Normal.CRUSHED) & (after.contact != Normal.CRUSHED)),
    )
    found = []
    for kind, hit in kinds:
        for i in np.flatnonzero(hit).tolist():
            names = (model.bodies[int(slots.body_a[i])].name, model.bodies[int(slots.body_b[i])].name)
            found.append(JointEvent(step, kind, names, tuple(rows.point[i].tolist())))
    return found


def tie_events(model: Model, places: Array, before: TieMemory, after: TieMemory, step: int) -> list[JointEvent]:
    """Return which ties began to yield or broke between two equilibria.

    Parameters
    ----------
    model : Model
    places : (k, d) array
        Of their first ends [m].
    before, after : TieMemory
    step : int
    """
    kinds = (
        ("yields", (after.plastic > 0) & ~(before.plastic > 0)),
        ("breaks", after.broken & ~before.broken),
    )
    found = []
    for kind, hit in kinds:
        for i in np.flatnonzero(hit).tolist():
            tie = model.ties[i]
            names = (f"tie {tie.name}", tie.body_a or tie.body_b)
            found.append(JointEvent(step, kind, names, tuple(places[i].tolist())))
    return found
