"""What the stages of a load path asked of each load group, and what was reached of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from concio.problem.tolerances import APPLIED

if TYPE_CHECKING:
    from concio.analysis.path_result import PathStep
    from concio.model.stages import Stage


@dataclass(frozen=True)
class GroupLoad:
    """What a stage asked of a load group, and what was reached of it.

    Parameters
    ----------
    group : str
    begin, asked : float
        Factor where the stage begins, and the one asked for at its end.
    end : float
        Factor where the stage ended.
    most : float
        The factor met that is farthest on the way from ``begin`` to ``asked``; ``begin`` where none was on that way.
    """

    group: str
    begin: float
    asked: float
    end: float
    most: float

    @property
    def applied(self) -> bool:
        """Whether the factor asked for was reached or passed."""
        left = (self.asked - self.most) / (self.asked - self.begin)
        return bool(left <= APPLIED)

    @property
    def away(self) -> bool:
        """Whether the factor went away from what was asked for only."""
        return self.most == self.begin and self.end != self.begin


def loads_of_stage(stages: Sequence[Stage], steps: Sequence[PathStep], number: int) -> tuple[GroupLoad, ...]:
    """Return what a stage asked of the groups whose factors it changes, in order, and what was reached.

    Parameters
    ----------
    stages : sequence of Stage
    steps : sequence of PathStep
        Of the whole path.
    number : int
        Of a stage that was begun, from 0.
    """
    own = [i for i, step in enumerate(steps) if step.stage == number]
    if not own:
        last = steps[-1].factors if steps else {}
        changed = {g: last.get(g, 0.0) for g, v in stages[number].factors.items() if v != last.get(g, 0.0)}
        return tuple(GroupLoad(g, v, float(stages[number].factors[g]), v, v) for g, v in changed.items())
    own = [own[0] - 1, *own] if own[0] > 0 else own
    first = steps[own[0]].factors
    found = []
    for group, asked in stages[number].factors.items():
        begin = first[group]
        if asked == begin:
            continue
        met = [steps[i].factors[group] for i in own]
        most = max(met) if asked > begin else min(met)
        found.append(GroupLoad(group, begin, float(asked), met[-1], most))
    return tuple(found)
