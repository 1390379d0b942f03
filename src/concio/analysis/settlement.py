"""Imposed movement of supports until it is reached or a mechanism forms, with reactions against the movement."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.analysis.path import PathResult, Stage, run_path
from concio.arguments import strict
from concio.contact.assembly import Assembly, as_assembly
from concio.errors import InputError
from concio.model.model import Model
from concio.problem.solution import ProgressCallback
from concio.read_only import read_only
from concio.representation import short_repr
from concio.verdict.question import movement_words
from concio.verdict.verdict import Verdict
from concio.views import Shown

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class SettlementResult(Shown):
    """Movement of supports after the dead load.

    Parameters
    ----------
    path : PathResult
        Both stages: loads, then movement.
    share : (n,) array
        Share of the movement at each step of the second stage, 0 to 1.
    reactions : mapping of str to (n, 2) array, in space (n, 3)
        Reactions of fixed bodies and supports at the same steps [kN].
    group : str
        Load group of the movement.
    amount : float
        Factor of the movement that was asked for.
    """

    path: PathResult
    share: Array
    reactions: Mapping[str, Array]
    group: str = "settlement"
    amount: float = 1.0

    @property
    def reached(self) -> bool:
        """True when the whole movement was imposed without the structure falling."""
        return self.path.complete

    @property
    def verdict(self) -> Verdict:
        """Whether loads and movement were carried to their end: the verdict of the path of both stages."""
        return self.path.verdict

    @property
    def movement(self) -> tuple[str, ...]:
        """What was to move, in words."""
        return movement_words(self.path.assembly.model, self.group, self.amount)

    def table(self) -> dict[str, Array]:
        """Return the reactions as columns: a row for each support at each share of the movement."""
        names, forces = list(self.reactions), np.array(list(self.reactions.values()), dtype=float)
        columns = dict(zip("xyz", np.moveaxis(forces, 2, 0).reshape(forces.shape[2], -1), strict=False))
        return {
            "support": np.repeat(names, len(self.share)), "share": np.tile(self.share, len(names)),
            **{f"force_{axis}": column for axis, column in columns.items()},
        }  # fmt: skip


def moved_groups(model: Model) -> tuple[str, ...]:
    """Return the load groups that move supports, in the order of the model."""
    return tuple(dict.fromkeys(s.group for s in model.supports if s.moves))


@strict
def settle(
    model: Model | Assembly,
    group: str = "settlement",
    *,
    amount: float = 1.0,
    method: Literal["events", "steps"] | None = None,
    progress: ProgressCallback | None = None,
) -> SettlementResult:
    """Apply all loads, then move the supports of a group.

    Parameters
    ----------
    model : Model or Assembly
    group : str
        Load group of the imposed displacements.
    amount : float
        Factor of the imposed displacements at the end.
    method : {"events", "steps"}, optional
        By default events in the plane, steps in space.
    progress : callable, optional

    Raises
    ------
    InputError
        No support of that group moves, or the amount is not a finite number other than zero.

    Examples
    --------
    An arch whose abutment gives way comes to its least thrust:

    >>> import concio
    >>> import dataclasses
    >>> arch = concio.arch(span=2.0, ring=0.3, voussoirs=9, block="rigid", unit_weight=20.0)
    >>> spread = concio.Support("spread", "left abutment", displacement=(-0.005, 0.0))
    >>> moved = concio.settle(dataclasses.replace(arch, supports=(spread,)))
    >>> moved.reached
    True
    >>> round(float(moved.reactions["left abutment"][-1, 0]), 2)
    2.69
    """
    assembly = as_assembly(model)
    known = moved_groups(assembly.model)
    if group not in known:
        msg = f"no support is moved by the load group '{group}'"
        hint = f"groups that move supports: {', '.join(known)}" if known else (
            "give a [[supports]] entry a displacement or a rotation"
        )  # fmt: skip
        raise InputError(msg, hint=hint)
    if not (math.isfinite(amount) and amount):
        msg = f"the movement is to be multiplied by {amount:g}"
        raise InputError(msg, where="amount", hint="give a number other than zero: 1 is the movement of the file")
    loads = {g: 1.0 for g in assembly.groups if g != group}
    stages = [Stage("loads", loads), Stage("settlement", {group: amount})]
    path = run_path(assembly, stages, method=method, progress=progress)
    last_load = max(i for i, s in enumerate(path.steps) if s.stage == 0)
    chosen = [last_load, *(i for i, s in enumerate(path.steps) if s.stage == 1)]
    results = [path.result(i) for i in chosen]
    names = results[0].reactions
    reactions = {name: np.array([r.reactions[name] for r in results]) for name in names}
    share = np.array([0.0, *(path.steps[i].parameter for i in chosen[1:])])
    return SettlementResult(path, share, reactions, group, amount)
